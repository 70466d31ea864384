#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Which lines, branches and error paths of lib/ and tools/ the tests run (docs/quality/coverage.md), by clang's own counters.

    coverage.py build | run | page     one after the other; all that is made lies in build/coverage
    coverage.py lines lib/io           lines of these files that no test runs
    coverage.py fuzz                   what the fuzz targets reach: the table of docs/quality/fuzzing.md

`page` writes the tables, and fails where an error path that no test runs is not in uncovered.json.
"""
import argparse
import glob
import json
import os
import subprocess
import sys

import page

ROOT = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
BUILD = os.path.join(ROOT, "build", "coverage")
PROFILES = os.path.join(BUILD, "profiles")
MERGED = os.path.join(BUILD, "tests.profdata")
TOOLS = ["terrain-gen", "scan-sim", "regrid", "dem-eval", "landfall-info", "landfall-export"]
FUZZ_TARGETS = ["config", "table", "mesh", "hdf5"]


def build():
    subprocess.run(["cmake", "--preset", "coverage"], cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
    subprocess.run(["cmake", "--build", "--preset", "coverage"], cwd=ROOT, check=True)


def run(arguments):
    """Every test, or those that `arguments` of ctest choose; what earlier runs counted is forgotten."""
    os.makedirs(PROFILES, exist_ok=True)
    os.chmod(PROFILES, 0o1777)  # tests become other users
    for old in glob.glob(os.path.join(PROFILES, "*")):
        os.remove(old)
    # Processes of one program add to one file.
    environment = {**os.environ, "LLVM_PROFILE_FILE": os.path.join(PROFILES, "%4m.profraw")}
    status = subprocess.run(["ctest", "--preset", "coverage", "-j2", *arguments], cwd=ROOT, env=environment, check=False).returncode
    subprocess.run(["llvm-profdata", "merge", "-o", MERGED, *glob.glob(os.path.join(PROFILES, "*.profraw"))], check=True)
    return status


def programs_of_tests():
    return [*(os.path.join(BUILD, "bin", tool) for tool in TOOLS), os.path.join(BUILD, "lib", "landfall", "landfall-gdal.so"),
            *sorted(glob.glob(os.path.join(BUILD, "tests", "*_test")))]


def counted(merged, programs):
    """What llvm-cov says of each file of lib/ and tools/ in these programs: {path from the root: its record}."""
    objects = [word for program in programs[1:] for word in ("-object", program)]
    text = subprocess.run(["llvm-cov", "export", "-instr-profile", merged, "-skip-expansions", "-skip-functions", programs[0], *objects,
                           "-ignore-filename-regex", "^/usr/"], check=True, stdout=subprocess.PIPE).stdout
    # ccache makes names relative to the build folder.
    records = {os.path.relpath(os.path.join(BUILD, record["filename"]), ROOT): record for record in json.loads(text)["data"][0]["files"]}
    return {path: record for path, record in records.items() if path.startswith(("lib/", "tools/"))}


def fuzz():
    """What each target's test reaches, the corpus and its mutations: {target: records}."""
    found = {}
    for target in FUZZ_TARGETS:
        raw = os.path.join(BUILD, f"fuzz_{target}.profraw")
        subprocess.run(["ctest", "--preset", "coverage", "-R", f"^fuzz_{target}$"], cwd=ROOT, check=True,
                       env={**os.environ, "LLVM_PROFILE_FILE": raw})
        merged = raw.removesuffix("raw") + "data"
        subprocess.run(["llvm-profdata", "merge", "-o", merged, raw], check=True)
        found[target] = counted(merged, [os.path.join(BUILD, "tests", "fuzz_" + target)])
    return found


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("step", choices=["build", "run", "page", "lines", "fuzz"])
    parser.add_argument("arguments", nargs="*", help="of run: options for ctest, after --; of lines: how paths begin")
    options = parser.parse_args()
    if options.step == "build":
        build()
    elif options.step == "run":
        return run(options.arguments)
    elif options.step == "fuzz":
        page.write_fuzz(ROOT, fuzz())
    elif options.step == "lines":
        for path, record in sorted(counted(MERGED, programs_of_tests()).items()):
            if path.startswith(tuple(options.arguments)):
                page.print_lines(ROOT, path, record)
    else:
        return page.write(ROOT, counted(MERGED, programs_of_tests()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
