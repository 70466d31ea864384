#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs each tool with each kind of fault, and checks each run against the guarantees of docs/quality/tests.md.

    tests/faults/try_faults.py --bin build/release/bin              # all faults, about half an hour
    tests/faults/try_faults.py --bin build/release/bin --only signals memory
    tests/faults/try_faults.py --bin build/release/bin --write      # also writes the tables of docs/quality/tests.md

Small disks and the limits of other users require root. The exit code is 1 if a guarantee was violated.
"""
import argparse
import os
import random
import sys
import time

sys.dont_write_bytecode = True
# pylint: disable=wrong-import-position
import calls
import disks
import folders
import limits
import page
import resources
import signals
import studies
import surroundings
from workshop import Workshop

KINDS = {
    "calls": lambda w, r, o: calls.try_all_calls(w, calls.build_library(w.folder), o.calls),
    "disks": lambda w, r, o: disks.try_disks(w),
    "folders": lambda w, r, o: folders.try_folders(w, r, o.count, o.rounds),
    "signals": lambda w, r, o: signals.try_signals(w, r, o.kills, o.count),
    "resources": lambda w, r, o: resources.try_resources(w),
    "surroundings": lambda w, r, o: surroundings.try_surroundings(w, calls.build_library(w.folder)),
    "limits": None,
    "studies": lambda w, r, o: studies.try_studies(w, r, max(1, o.count // 10)),
}


def parse(arguments):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", required=True, help="folder of the tools")
    parser.add_argument("--only", nargs="+", choices=KINDS, default=list(KINDS))
    parser.add_argument("--seed", type=int, default=20261122)
    parser.add_argument("--kills", type=int, default=400, help="SIGKILL at so many random moments")
    parser.add_argument("--count", type=int, default=60, help="other signals, vanishing folders: so many of each")
    parser.add_argument("--calls", type=int, default=150, help="failing calls tried per task, of more a spread")
    parser.add_argument("--rounds", type=int, default=2, help="rounds of several writers of one output")
    parser.add_argument("--messages", action="store_true", help="also print every message that was seen")
    parser.add_argument("--write", action="store_true", help="write the tables of docs/quality/tests.md")
    return parser.parse_args(arguments)


def main(arguments):
    options = parse(arguments)
    print(f"seed {options.seed}", flush=True)
    workshop, broken = Workshop(options.bin), []
    for kind in options.only:
        start, judges = time.time(), []
        if kind == "limits":
            lines, faults = limits.try_limits(workshop)
            broken += faults
            print(*lines, sep="\n", flush=True)
            if options.write:
                page.write(page.with_table(page.read(), page.LIMITS, lines))
            continue
        for judge in KINDS[kind](workshop, random.Random(options.seed), options):
            judges.append(judge)
            print(page.row(judge), flush=True)
            if options.messages:
                print(*(f"    {count:5} {text}" for text, count in judge.messages.most_common()), sep="\n", flush=True)
        broken += [text for judge in judges for text in judge.broken]
        print(f"{kind}: {time.time() - start:.0f} s", flush=True)
        if options.write:
            page.write(page.with_rows(page.read(), page.FAULTS, map(page.row, judges)))
    workshop.remove()
    print(f"{len(broken)} violated guarantees", *broken, sep="\n")
    return 1 if broken else 0


if __name__ == "__main__":
    os.umask(0o022)
    sys.exit(main(sys.argv[1:]))
