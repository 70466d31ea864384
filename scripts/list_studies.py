#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Lists the studies of a folder: name, number of cases, title."""
import glob
import os
import sys

sys.dont_write_bytecode = True
import landfall_study_file
from landfall_schema import ConfigError, read_json

# Top-level keys that a study has, and no configuration of a single tool.
STUDY_KEYS = {"base", "axes", "repeat"}


def studies(folder):
    """(name, cases, title) of each file that is a study, by name."""
    found = []
    for path in sorted(glob.glob(os.path.join(folder, "*.json"))):
        tree = read_json(path)
        if isinstance(tree, dict) and STUDY_KEYS & tree.keys() and not path.endswith((".terrain.json", ".scan.json")):
            study = landfall_study_file.read_study(path)
            found.append((study.name, sum(1 for _ in study.cases()), study.title))
    return found


def main():
    if len(sys.argv) != 2:
        print("usage: list_studies.py FOLDER", file=sys.stderr)
        sys.exit(2)
    try:
        found = studies(sys.argv[1])
    except ConfigError as error:
        print(f"list_studies.py: {error}", file=sys.stderr)
        sys.exit(2)
    width = max((len(name) for name, _, _ in found), default=0)
    for name, cases, title in found:
        print(f"{name:{width}}  {cases:4} case{'s' if cases != 1 else ' '}  {title}")


if __name__ == "__main__":
    main()
