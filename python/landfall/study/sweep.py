# SPDX-License-Identifier: GPL-3.0-or-later
"""Plans a study, shows it, and gathers its results (docs/user/studies/README.md).

  landfall study list STUDY                        its cases
  landfall study show STUDY CASE                   a shell script that makes one case by hand
  landfall study cost STUDY [-j N]                 its time and memory, by a trial of the first case, and its disk space
  landfall study prune DIR                         removes files that the plan does not name any more

Called by Makefile.studies alone:
  sweep.py plan STUDY.json --out DIR --bin DIR     configurations and make rules, written only when changed
  sweep.py studies DIR                             the studies of a folder: name, number of cases, title
  sweep.py status DIR                              what is done, failed and left
  sweep.py collect DIR                             results.csv and results.h5
  sweep.py begin DIR                               removes temporary files that killed processes have left, ends times in the future
  sweep.py tidy DIR                                removes shared files that no stage needs any more
"""
import argparse
import contextlib
import glob
import json
import os
import re
import shlex
import sys
import time

from landfall import tools
from landfall.command import Parser, write_text
from landfall.errors import ToolError, UsageError, printable
from landfall.schema import read_json, shown
from landfall.study import model, names, reader, rules, session, stages
from landfall.study.cost import cost_text
from landfall.study.names import counted

MAX_CHECKS_PER_AXIS = 100
TRIAL_STAGES = 50  # of a study that begins with a trial of its first case
# Top-level keys that a study has, and no configuration of a single tool.
STUDY_KEYS = {"base", "axes", "repeat"}
FUTURE_NS = 10 * 10**9  # clocks of network file systems differ by less
# One process at a time works in a study's folder, under this lock, which Makefile.studies takes too.
PYTHON = os.path.join(os.path.dirname(os.path.realpath(__file__)), "..", "..")
LOCKED, SWEEP = os.path.join(PYTHON, "..", "studies", "runners", "locked"), os.path.join(PYTHON, "commands", "sweep.py")


def study_file(name):
    """The file of a study, which may be given by its name if it ships with landfall."""
    shipped = os.path.join(tools.SHARE, "studies", f"{name}.json")
    return shipped if os.path.basename(name) == name and not os.path.exists(name) and os.path.exists(shipped) else name


def add_trial_options(command, jobs):
    command.add_argument("-j", "--jobs", metavar="N", type=int, default=jobs, help="stages at a time")
    command.add_argument("--threads", metavar="N", type=int, default=1, help="of each stage (1)")
    command.add_argument("--runner", metavar="COMMAND", default="", help="command that runs each stage")


def parse(arguments):
    parser = Parser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True, parser_class=Parser)
    plan = commands.add_parser("plan", help="write configurations and make rules")
    plan.add_argument("study", metavar="STUDY.json")
    plan.add_argument("--out", metavar="DIR", required=True, help="the study's folder")
    plan.add_argument("--bin", metavar="DIR", required=True, help="where the tools are")
    plan.add_argument("--keep", metavar="LIST", default="", help="files to keep: all, or a list of scan, dem, eval, hazard, draws")
    plan.add_argument("--no-check", action="store_true", help="do not check the values with the tools")
    add_trial_options(plan, 0)
    for name, text in (("list", "print the cases"), ("show", "print how one case is made"), ("cost", "print time, memory and disk space")):
        command = commands.add_parser(name, help=text)
        command.add_argument("study", metavar="STUDY", type=study_file, help="a file, or the name of a study that ships")
        if name == "show":
            command.add_argument("case", type=int, metavar="CASE", help="number, as list prints it")
        if name == "cost":
            command.add_argument("--bin", metavar="DIR", default=tools.BIN, help="where the tools are")
            add_trial_options(command, 1)
    for name, text in (("studies", "print the studies of a folder"), ("status", "print what is done"), ("collect", "write results.csv and results.h5"),
                       ("begin", "remove temporary files of processes that have ended"), ("tidy", "remove shared files that no stage needs any more"),
                       ("prune", "remove files that are no longer in the plan")):
        command = commands.add_parser(name, help=text)
        command.add_argument("folder", metavar="DIR")
        if name == "collect":
            command.add_argument("--partial", action="store_true", help="leave out cases that are not done")
    return parser.parse_args(arguments)


# plan


def kept(text):
    """The set of --keep: names separated by commas or blanks."""
    names, known = text.replace(",", " ").split(), rules.KEEPABLE
    for name in names:
        if name not in (*known, "all"):
            raise UsageError(f"--keep: '{name}' is not one of {', '.join(known)}, all")
    return frozenset(known if "all" in names else names)


def plan(options):
    if any(character.isspace() or character in "$#%:;|\\*?[]~'\"" for character in options.out):
        raise UsageError(f"--out {options.out}: make cannot take this name")
    layout = rules.Layout(kept(options.keep))
    study = reader.read_study(options.study)
    versions = "".join(tool_output(options.bin, model.TOOLS[stage], "--version") for stage in study.base)
    if not options.no_check:
        check_with_tools(study, options.bin)
    graph = stages.build(study)
    fragment = rules.Fragment(graph, layout, study.options)
    need_lock(options.out)
    is_first = not os.path.exists(os.path.join(options.out, "cases.json"))
    written = write_plan(options, study, graph, fragment, versions)
    print(f"{printable(study.name)}: {counted(len(graph.cases), 'case')}: {counted(len(graph.terrain), 'terrain')}, "
          f"{counted(len(graph.truth), 'truth')}, {counted(len(graph.scan), 'scan')}, {counted(len(graph.regrid), 'DEM')}, "
          f"{counted(len(graph.eval), 'evaluation')}" + (f", {counted(len(graph.hazard), 'hazard map')}" if graph.hazard else "") +
          (f", {counted(len(graph.draws), 'monte-carlo run')}" if graph.draws else "") +
          f"; {written} files written")
    print(rules.disk_text(graph, layout.keep))
    if options.jobs and is_first:
        count = stages.count(graph)
        sys.stdout.flush()
        print(printable(cost_text(study, graph, options, os.path.join(options.out, "scratch")) if count >= TRIAL_STAGES else
                        f"cost: {counted(count, 'stage')}; landfall study cost {options.study} tries the first case"))


def need_lock(folder):
    """Returns if make holds the lock of the folder for this process; else starts the command again, under the lock."""
    if os.environ.get("STUDY_LOCK") != folder:
        sys.stdout.flush()
        os.execv(LOCKED, [LOCKED, folder, sys.executable, SWEEP, *sys.argv[1:]])


def write_plan(options, study, graph, fragment, versions):
    """Writes what changed and returns how many files that were; study.mk, after all others are on the disk, always gets a new time."""
    for folder in rules.folders(graph):
        os.makedirs(os.path.join(options.out, folder), exist_ok=True)
    files = {f"readers/{os.path.basename(name)}": "\n".join(readers) + "\n" for name, readers in fragment.readers.items()}
    files |= {"tools.txt": versions, "targets.txt": fragment.targets(), "names.txt": rules.names_text(study, graph),
              "cases.json": rules.cases_text(study, graph, fragment.layout, common_limits(options.bin, graph))}
    # The plan depends on its files; a missing one causes a new plan, not an error.
    inputs = " ".join(os.path.relpath(path) for path in study.files)
    rules_text = fragment.text(study.name, options.keep, options.bin) + f"$O/study.mk: {inputs}\n{inputs}:\n"
    written = sum(rules.write_if_changed(os.path.join(options.out, name), text) for name, text in files.items())
    written += write_configs(options.out, graph)
    os.sync()
    written += rules.write_if_changed(os.path.join(options.out, "study.mk"), rules_text)
    os.utime(os.path.join(options.out, "study.mk"))
    return written


def write_configs(out, graph):
    """They get the time of tools.txt: one that was lost and is the same again, as its name says, causes no stage to run again."""
    age = session.age(os.path.join(out, "tools.txt"))
    written = 0
    for (tool, config_id), text in graph.configs.items():
        path = os.path.join(out, "config", tool, config_id + ".json")
        if rules.write_if_changed(path, text):
            os.utime(path, ns=(age, age))
            written += 1
    return written


def tool_output(folder, tool, *arguments, **options):
    return tools.run_tool(tools.find(tool, folder), *arguments, **options).stdout


def common_limits(folder, graph):
    """The limits of dem-eval that are the same in all cases."""
    defaults = json.loads(tool_output(folder, "dem-eval", "--print-config"))["limits"]
    all_limits = [defaults | json.loads(text).get("limits", {}) for (tool, _), text in graph.configs.items() if tool == "eval"]
    return {key: value for key, value in defaults.items()
            if len({limits[key] for limits in all_limits}) == 1 for value in [all_limits[0][key]]}


def check_with_tools(study, folder):
    """Asks the tools whether they take the base, and each axis' values with the others at their first ones.

    Only the first and the last of numbers are checked. A value that a tool refuses only together with others
    fails when its stage is run.
    """
    first = [0] * len(study.dimensions)
    asked = set()
    ask(study, folder, first, "the first case", asked)
    for index, dimension in enumerate(study.dimensions):
        last = len(dimension[0].points) - 1
        numeric = all(axis.is_numeric() for axis in dimension)
        for point in [last] if numeric else range(1, min(last + 1, MAX_CHECKS_PER_AXIS)):
            values = ", ".join(f"{axis.name} = {shown(axis.points[point].value)}" for axis in dimension)
            ask(study, folder, [*first[:index], point, *first[index + 1:]], values, asked)


def ask(study, folder, indices, name, asked):
    for stage in study.base:
        text = json.dumps(stages.configuration(study, stage, indices))
        if (stage, text) in asked:
            continue
        asked.add((stage, text))
        try:
            with tools.naming_input(f"/{stage}"):
                tool_output(folder, model.TOOLS[stage], "--check", "-c", "-", input=text)
        except ToolError as error:
            raise UsageError(f"{study.path}: {name}: {error}") from error


# studies, list, show


def studies_of(folder):
    """The studies among the JSON files of a folder, by name."""
    found = []
    for path in sorted(glob.glob(os.path.join(folder, "*.json"))):
        tree = read_json(path)
        if isinstance(tree, dict) and STUDY_KEYS & tree.keys() and not path.endswith((".terrain.json", ".scan.json", ".draws.json", ".sensitivity.json", ".design.json")):
            found.append(reader.read_study(path))
    return found


def list_studies(options):
    found = studies_of(options.folder)
    width = max((len(study.name) for study in found), default=0)
    for study in found:
        count = study.case_count()
        print(printable(f"{study.name:{width}}  {count:4} case{'s' if count != 1 else ' '}  {study.title}"))


def list_cases(options):
    study = reader.read_study(options.study)
    print("\t".join(["case", *(printable(axis.name) for axis in study.axes())]))
    for number, indices in enumerate(study.cases()):
        print("\t".join([str(number), *(printable(value if isinstance(value, str) else json.dumps(value))
                                        for value in study.values(indices))]))


def cost(options):
    if options.jobs < 1:
        raise UsageError(f"--jobs {options.jobs}: is not >= 1")
    study = reader.read_study(options.study)
    graph = stages.build(study)
    print(f"{printable(study.name)}: {counted(len(graph.cases), 'case')}; {printable(cost_text(study, graph, options))}; {rules.disk_text(graph, frozenset())}")


def show(options):
    study = reader.read_study(options.study)
    cases = list(study.cases())
    if not 0 <= options.case < len(cases):
        raise UsageError(f"{study.path}: case {options.case} is not in [0, {len(cases) - 1}]")
    indices = cases[options.case]
    values = zip((axis.name for axis in study.axes()), study.values(indices))
    title = f"{study.name}, case {options.case}: " + ", ".join(f"{name} = {shown(value)}" for name, value in values)
    print("#!/bin/bash\n# " + printable(title))
    print("set -euo pipefail")
    for stage in study.base:
        config = json.dumps(stages.configuration(study, stage, indices), sort_keys=True)
        print(f"echo {shlex.quote(config)} > {stage}.json")
    regrid = "".join(" " + option for option in study.options.get("regrid", []))
    print("terrain-gen -c terrain.json -o terrain.h5\n"
          "scan-sim -c scan.json --terrain terrain.h5 -o scan.h5\n"
          f"regrid scan.h5 -c regrid.json --terrain terrain.h5 -o dem.h5{regrid}\n"
          "dem-eval dem.h5 -c eval.json -o eval.h5 --metrics metrics.json")
    if "hazard" in study.base:
        print("hazard-map dem.h5 -c hazard.json --terrain terrain.h5 -o hazards.h5 --score score.json --sites sites.json")
    if study.traces:
        print("monte-carlo -c draws.json -o draws.h5 --verdict verdict.json")
    elif "draws" in study.base:
        truth = json.dumps(stages.truth_config(model.configuration(study, "scan", indices)), sort_keys=True)
        print(f"echo {shlex.quote(truth)} > truth.json\n"
              "scan-sim -c truth.json --terrain terrain.h5 -o truth.h5\n"
              "monte-carlo truth.h5 -c draws.json --terrain terrain.h5 -o draws.h5 --verdict verdict.json")


# begin


# Python writes files under such names first; the number is the thread's or the process's.
TEMPORARY = re.compile(r"\..*\.(?P<part>\d+)\.part|.*\.(?P<figure>\d+)\.tmp")


def begin(options):
    """Removes temporary files of processes that have ended. Those of the tools lie elsewhere and are the tools' own."""
    for folder, folders, files in os.walk(options.folder):
        if folder == options.folder:
            folders[:] = {"config", "readers", "figures"}.intersection(folders)
        for name in files:
            match = TEMPORARY.fullmatch(name)
            if match and not os.path.exists(f"/proc/{match['part'] or match['figure']}"):
                os.remove(os.path.join(folder, name))
    end_future(options.folder)


def end_future(folder):
    """Files made while a clock was ahead would be newer than what has changed since, and make would keep them: they become the oldest, in their order."""
    latest_ns = time.time_ns() + FUTURE_NS
    files = [(file, session.age(file)) for where, _, found in os.walk(folder) for file in (os.path.join(where, name) for name in found)]
    times = {age: 10**18 + 1000 * number for number, age in enumerate(sorted({age for _, age in files if age > latest_ns}))}
    for file, age in files:
        if age in times:
            with contextlib.suppress(FileNotFoundError):  # of what a killed make has left running
                os.utime(file, ns=(times[age], times[age]))


# status, collect, tidy, prune


def status(options):
    cases = read_folder(options.folder)
    done, failed, left = states(options.folder, [case[len(cases["axes"]):] for case in cases["cases"]])
    failures = sum(map(len, failed.values()))
    print(f"{len(done)} done, {failures} failed, {len(left)} left, of {counted(len(cases['cases']), 'case')}")
    by_values = names.CaseNames(cases["axes"], cases["cases"])
    for reason, numbers in failed.items():
        count = f" ({counted(len(numbers), 'case')})" if len(numbers) > 1 else ""
        print(printable(f"{by_values.of_cases(numbers)}{count}: {reason}"))


def states(folder, results):
    """Numbers of the cases that are done, {how a stage failed: numbers}, and of those that are left, by the files of their results."""
    missing = set(session.missing_targets(folder))
    made_by = {name: [*((need, f"log/{session.kind_of(need)}-{os.path.basename(need).split('.', 1)[0]}.log") for need in needs), (name, log)]
               for name, log, *needs in session.read_targets(folder)}
    done, failed, left, reasons = [], {}, [], {}
    for number, of_case in enumerate(results):
        lacking = [name for name in of_case if name in missing]
        if not lacking:
            done.append(number)
            continue
        logs = list(dict.fromkeys(log for name in lacking for need, log in made_by.get(name, []) if need in missing))
        for log in logs:
            if log not in reasons:
                reasons[log] = failure(folder, log)
        reason = next((reasons[log] for log in logs if reasons[log]), None)
        (failed.setdefault(reason, []) if reason else left).append(number)
    return done, failed, left


def read_folder(folder):
    from landfall.study import results  # needs h5py, which a plan does not
    return results.read_cases(folder)


def failure(folder, log):
    """How the recipe with this log failed; empty where it did not."""
    path = os.path.join(folder, log)
    end, messages = session.read_log(path)
    if not end or end.startswith("exit 0 "):
        return ""
    return f"{end}: {messages[-1] if messages else 'no message'} ({path})"


def collect(options):
    from landfall.study import results
    cases = results.read_cases(options.folder)
    rows = results.rows_of(options.folder, cases, options.partial)
    table = results.Table(cases, rows)
    with open(os.path.join(options.folder, "tools.txt"), encoding="utf-8") as file:
        version = file.readline().strip()
    # The table that make looks at comes last.
    results.write_h5(table, os.path.join(options.folder, "results.h5"), version)
    write_text(os.path.join(options.folder, "results.csv"), table.csv())
    tidy(options)
    left_out = len(cases["cases"]) - len(rows)
    print(f"{printable(os.path.join(options.folder, 'results.csv'))}: {counted(len(rows), 'case')}, "
          f"{len(table.columns)} columns" + (f"; {left_out} not done" if left_out else ""))


def tidy(options):
    """Removes what waits in shared/ for readers that are all done."""
    if session.missing_targets(options.folder):
        return
    shared = os.path.join(options.folder, "shared")
    for name in os.listdir(shared) if os.path.isdir(shared) else []:
        os.remove(os.path.join(shared, name))


def prune(options):
    """Removes what an earlier plan of the study made and this one does not name."""
    read_folder(options.folder)
    need_lock(options.folder)
    with open(os.path.join(options.folder, "study.mk"), encoding="utf-8") as file:
        named = {word[3:] for line in file for word in line.replace(":", " ").split() if word.startswith("$O/")}
    stages = {name.split("/", 1)[1].split(".", 1)[0] for name in named if "/" in name and name.split("/", 1)[0] != "config"}
    count = size = 0
    for top in ("config", "terrain", "truth", "scan", "dem", "eval", "metrics", "hazard", "score", "sites", "draws", "verdict", "shared", "readers", "log",
                "scratch"):
        for folder, _, files in os.walk(os.path.join(options.folder, top)):
            for file in files:
                path = os.path.join(folder, file)
                name = os.path.relpath(path, options.folder)
                if name in named or (top == "log" and file.rsplit(".", 1)[0].rsplit("-", 1)[-1] in stages) or \
                        (top == "readers" and f"shared/{file}" in named):
                    continue
                count, size = count + 1, size + os.path.getsize(path)
                os.remove(path)
    print(f"{counted(count, 'file')} removed, {size / 1e6:.1f} MB")


def main(arguments):
    options = parse(arguments)
    {"plan": plan, "studies": list_studies, "list": list_cases, "show": show, "cost": cost, "status": status, "collect": collect, "tidy": tidy,
     "prune": prune, "begin": begin}[options.command](options)
