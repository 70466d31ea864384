#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
# All mutants are compiled into one program and selected by the environment: a separate build for each of them would
# take days. The disadvantage is that compile-time constants (array sizes, template arguments) cannot be mutated, and
# that vectorised loops run slower.
#
# A mutant that hangs or reads past an array is killed. The second needs libstdc++'s index checks, with which the
# mutants are built; without them the result would depend on the memory behind the array. Equivalent survivors count as
# survivors in the first percentage, and are excluded from the second.
#
# Mutants and their tests are timed by CPU time, with a wall-clock limit twenty times as long for those that sleep: on a
# busy machine, a wall clock excludes tests as too slow, and counts mutants as hanging that are not.
#
# Parts of the window quantile are tested alone (sorted tails, their members, the cursor, the traversal), each against
# its definition, in milliseconds: bit-exact tests of whole maps take seconds, which is too slow for thousands of
# mutants.
"""Mutation testing of lib/gridding, lib/evaluation, lib/error_models, lib/geometry, lib/hazards and lib/campaign.

    mutate.py write | build | trace | run | chain | report     in this order; each continues where it was stopped

All files are written to build/mutation. `report` prints the numbers, and the survivors for which survivors.json has no reason.
docs/quality/mutation.md describes the method and the results.
"""
import argparse
import collections
import concurrent.futures
import json
import os
import random
import re
import subprocess
import sys

import programs
import schema

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))
WORK = os.path.join(ROOT, "build", "mutation")
SURVIVORS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "survivors.json")  # {key of a mutant: why it survives}
DATABASE = os.path.join(ROOT, "build", "dev", "compile_commands.json")
LIBRARIES = ["geometry", "error_models", "gridding", "evaluation", "hazards", "campaign"]
# Headers of lib/geometry are included everywhere. Their mutants are built separately, with few tests, so that the rest of
# the project need not be built again.
TREES = {"sources": lambda file: not re.match(r"lib/geometry/.*\.h", file), "headers": lambda file: re.match(r"lib/geometry/.*\.h", file)}
TESTS = {"sources": ["geometry_test", "error_models_test", "gridding_test", "evaluation_test", "simulation_test", "config_test",
                     "hazards_test", "campaign_test"],
         "headers": ["geometry_test", "error_models_test"]}
SEED = 20261121
SLOWEST_S = 20  # slower tests are excluded, because they would run for thousands of mutants
IMPOSSIBLE, UNCOMPILABLE = "not possible with these types", "does not compile"
TOOLS = ["terrain-gen", "scan-sim", "regrid", "dem-eval", "monte-carlo", "landfall-info", "landfall-export"]


def path(*names):
    return os.path.join(WORK, *names)


def load(name, default=None):
    if not os.path.exists(path(name)):
        return default
    with open(path(name), encoding="utf-8") as file:
        return json.load(file)


def save(name, value):
    os.makedirs(WORK, exist_ok=True)
    with open(path(name + ".new"), "w", encoding="utf-8") as file:
        json.dump(value, file, indent=0)
    os.replace(path(name + ".new"), path(name))


def write_sources():
    finders = {}
    for library in LIBRARIES:
        finders.update(schema.find_points(ROOT, library, DATABASE, path("found")))
    mutants = schema.number_mutants(finders, ROOT)
    for mutant in mutants:
        mutant["tree"] = next(tree for tree, holds in TREES.items() if holds(mutant["file"]))
    save("mutants.json", mutants)
    keys = {m["key"]: m["id"] for m in mutants}
    dropped = {keys[key] for key, why in load("dropped.json", {}).items() if key in keys and why == UNCOMPILABLE}
    for tree, holds in TREES.items():
        schema.write_tree(ROOT, path(tree), {f: finder for f, finder in finders.items() if holds(f)}, dropped)
    return mutants


def build(targets):
    """Builds the trees. Mutants that do not compile are excluded, and the build is repeated."""
    for tree, names in targets.items():
        while names:
            mutants = write_sources()
            status, log = build_tree(tree, names)
            refused = refusals(log, [m for m in mutants if m["tree"] == tree], tree)
            dropped = load("dropped.json", {})
            save("dropped.json", {**dropped, **refused})
            print(f"{tree}: status {status}, {len(refused)} mutants refused", flush=True)
            if status == 0:
                break
            if not set(refused) - set(dropped):
                raise SystemExit(log[-5000:])


def build_tree(tree, targets):
    folder = path(tree, "build", "dev")
    if not os.path.exists(folder + "/build.ninja"):
        # The tests of the mutated libraries have options of their own, which the precompiled headers of all tests do not have.
        subprocess.run(["cmake", "--preset", "dev", "-DCMAKE_CXX_COMPILER_LAUNCHER=ccache", "-DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON"],
                       cwd=path(tree), check=True, stdout=subprocess.DEVNULL)
    with open(path(tree + ".log"), "w", encoding="utf-8") as file:
        status = subprocess.run(["cmake", "--build", folder, "--", "-k", "0", *targets], stdout=file, stderr=subprocess.STDOUT,
                                check=False).returncode
    with open(path(tree + ".log"), encoding="utf-8") as file:
        return status, file.read()


def refusals(log, mutants, tree):
    """{key: reason} of the mutants that are impossible with their types, and of those on lines with errors."""
    by_id = {m["id"]: m for m in mutants}
    refused = {}
    for found in re.finditer(r"impossible\(\) \[with int id = (\d+)\]|impossible<(\d+)>", log):
        mutant = by_id.get(int(found[1] or found[2]))
        if mutant:
            refused[mutant["key"]] = IMPOSSIBLE
    for block in re.split(r"\n(?=FAILED: )", log):
        for found in re.finditer(r"(lib/\w+/\w+\.(?:cpp|h)):(\d+):\d+: (?:error|  required from)", block):
            if ": error" in block:
                for mutant in mutants:
                    if mutant["file"] == found[1] and mutant["line"] == int(found[2]):
                        refused[mutant["key"]] = UNCOMPILABLE
    return refused


def trace(wanted, workers):
    mutants = load("mutants.json")
    traces = load("traces.json", {})
    for tree, names in TESTS.items():
        for name in names:
            if wanted and name not in wanted:
                continue
            program = path(tree, "build", "dev", "tests", name)
            if not os.path.exists(program):
                print(name, "is not built")
                continue
            traces = {t: traced for t, traced in traces.items() if not t.startswith(f"{tree}/{name}:")}
            tests = programs.tests_of(program)
            with concurrent.futures.ThreadPoolExecutor(workers) as pool:
                found = list(pool.map(lambda test, p=program: programs.trace([p, f"--gtest_filter={test}"], SLOWEST_S), tests))
            for test, traced in zip(tests, found):
                if traced is None:
                    print(f"{name}: {test} fails without a mutant, or is too slow: excluded")
                else:
                    traces[f"{tree}/{name}:{test}"] = traced
            save("traces.json", traces)
            print(name, len(tests), "tests", flush=True)
    print(len(mutants), "mutants,", len({i for t in traces.values() for i in t["reached"]}), "reached")


def live_mutants():
    dropped = load("dropped.json", {})
    return [m for m in load("mutants.json") if m["key"] not in dropped]


def kill(workers, again, only, slowest_s):
    """Runs, for each mutant in random order, the unit tests that reach it; `again` also repeats survivors."""
    traces, results = load("traces.json"), load("results.json", {})
    reaching = collections.defaultdict(list)
    for test, traced in traces.items():
        for mutant in traced["reached"]:
            reaching[test.split("/")[0], mutant].append(test)

    def one(mutant):
        tests = [t.split("/", 1)[1] for t in reaching[mutant["tree"], mutant["id"]] if traces[t]["seconds"] <= slowest_s]
        known = {t.split("/", 1)[1]: traced for t, traced in traces.items() if t.startswith(mutant["tree"] + "/")}
        return mutant["key"], {"by": programs.killer(mutant["id"], tests, known, path(mutant["tree"], "build", "dev", "tests")),
                               "covered": bool(tests)}

    todo = [m for m in live_mutants() if m["file"].startswith(tuple(only)) and
            (m["key"] not in results or (again and not results[m["key"]]["by"]))]
    random.Random(SEED).shuffle(todo)  # so that an interrupted run is a random sample
    print(f"seed {SEED}, {len(todo)} mutants", flush=True)
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        running = [pool.submit(one, mutant) for mutant in todo]
        for number, done in enumerate(concurrent.futures.as_completed(running)):
            key, result = done.result()
            results[key] = {**results.get(key, {}), **result}
            if number % 20 == 19 or number == len(todo) - 1:
                save("results.json", results)
                print(number + 1, "of", len(todo), sum(not r["by"] for r in results.values()), "survivors", flush=True)


def chain(count, workers):
    """Runs random configurations through the tools and tests/oracle, for each mutant of the sources that survived unit tests."""
    command = ["/usr/bin/python3", os.path.join(ROOT, "tests", "oracle", "chain_test.py")]
    usual = {"LANDFALL_BIN": path("sources", "build", "dev", "bin"), "LANDFALL_ROOT": ROOT, "PYTHONPATH": os.path.join(ROOT, "tests"), "PYTHONDONTWRITEBYTECODE": "1",
             "LANDFALL_PROOF_CASES": str(count)}
    cases = [{**usual, "LANDFALL_PROOF_ONLY": str(number)} for number in range(count)]
    traces = load("chain.json", [])
    for case in cases[len(traces):]:
        traces.append(programs.trace(command, environment=case))
        save("chain.json", traces)
    results = load("results.json")

    def one(mutant):
        for number in sorted(range(count), key=lambda n: traces[n]["seconds"]):
            if mutant["id"] in traces[number]["reached"]:
                status = programs.run(command, {**cases[number], "LANDFALL_MUTANT": str(mutant["id"])},
                                      programs.GRACE_S + programs.PATIENCE * traces[number]["seconds"])
                if status != 0:
                    return mutant["key"], f"chain: case {number}"
        return mutant["key"], ""

    reached = {i for traced in traces for i in traced["reached"]}
    todo = [m for m in live_mutants() if not results[m["key"]]["by"] and m["tree"] == "sources" and m["id"] in reached
            and results[m["key"]].get("chain", 0) < count]
    with concurrent.futures.ThreadPoolExecutor(workers) as pool:
        for key, by in pool.map(one, todo):
            results[key].update(by=by, chain=count)
            save("results.json", results)
    print(len(todo), "tried,", sum(results[m["key"]]["by"] != "" for m in todo), "killed")


def report():
    """Prints the results by library. If the survivors differ from survivors.json, prints the differences and returns 1."""
    with open(SURVIVORS, encoding="utf-8") as file:
        reasons = json.load(file)
    results, dropped = load("results.json"), load("dropped.json", {})
    mutants = [m for m in live_mutants() if m["key"] in results]
    alive = [m for m in mutants if not results[m["key"]]["by"]]
    libraries = sorted({m["file"].split("/")[1] for m in mutants})
    print("| library | mutants | killed | of these by the chain | survive | equivalent | left out |", "|---|---|---|---|---|---|---|", sep="\n")
    for name in libraries:
        mine = lambda key, prefix=f"lib/{name}/": key.startswith(prefix)
        killers = [results[m["key"]]["by"] for m in mutants if mine(m["key"])]
        killed, lived = len([by for by in killers if by]), [m["key"] for m in alive if mine(m["key"])]
        equivalent = sum(reasons.get(key, "").startswith("equivalent: ") for key in lived)
        print(f"| lib/{name} | {len(killers):,} | {killed:,}, {100 * killed / len(killers):.1f} % | "
              f"{sum(by.startswith('chain') for by in killers)} | {len(lived)} | {equivalent} | {sum(map(mine, dropped))} |")
    unknown = [m for m in alive if m["key"] not in reasons]
    for m in unknown:
        print(f"{m['file']}:{m['line']}: {m['key']}{'' if results[m['key']]['covered'] else ' (not covered)'}")
    gone = sorted(key for key in set(reasons) - {m["key"] for m in alive} if key.split("/")[1] in libraries)
    for key in gone:
        print("no longer a survivor:", key)
    return 1 if unknown or gone else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("step", choices=["write", "build", "trace", "run", "chain", "report"])
    parser.add_argument("names", nargs="*", help="of build: targets; of trace: test programs; of run: libraries")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--slowest", type=float, default=1e9, help="of run: seconds of a test that is still run (a first pass)")
    parser.add_argument("--cases", type=int, default=10, help="of chain: configurations")
    parser.add_argument("--again", action="store_true", help="run: also the mutants that survived before")
    options = parser.parse_args()
    if options.step == "write":
        mutants = write_sources()
        for row in sorted(collections.Counter((m["file"].split("/")[1], m["kind"]) for m in mutants).items()):
            print(*row)
    elif options.step == "build":
        names = options.names or [name for tests in TESTS.values() for name in tests]
        build({tree: [n for n in names if n in TESTS[tree] or n in TOOLS and tree == "sources"] for tree in TREES})
    elif options.step == "trace":
        trace(options.names, options.workers)
    elif options.step == "run":
        kill(options.workers, options.again, [f"lib/{name}" for name in options.names or LIBRARIES],
             options.slowest)
    elif options.step == "chain":
        chain(options.cases, options.workers)
    else:
        return report()
    return 0


if __name__ == "__main__":
    sys.exit(main())
