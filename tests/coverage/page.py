# SPDX-License-Identifier: GPL-3.0-or-later
"""The tables of docs/quality/coverage.md, from llvm-cov's records and from uncovered.json: {key of an error path: why no test runs it};
and that of docs/quality/fuzzing.md."""
import bisect
import collections
import json
import os
import re
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "pages"))
# pylint: disable=wrong-import-position
from sections import rewrite

REASONS = os.path.join(os.path.dirname(os.path.abspath(__file__)), "uncovered.json")
ERROR = re.compile(r"\bthrow\b|\bcatch\s*\(")
# Comments and texts: `throw` within them is none.
OTHER = re.compile(r'//[^\n]*|/\*.*?\*/|R"(\w*)\(.*?\)\1"|"(?:[^"\\\n]|\\.)*"|\'(?:[^\'\\\n]|\\.)\'', re.S)


class Counts:
    """How often each place of a file ran, by the regions that llvm-cov tells: [line, column, count, counted, begins, gap]."""

    def __init__(self, record):
        self.segments = record["segments"]
        self.places = [(s[0], s[1]) for s in self.segments]

    def at(self, line, column):
        """None where nothing is counted."""
        i = bisect.bisect_right(self.places, (line, column)) - 1
        return self.segments[i][2] if i >= 0 and self.segments[i][3] else None


def error_paths(text):
    """[(line, column, key)] of each throw and handler; the key is its text, numbered where a file has it twice."""
    plain = OTHER.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)
    lines, seen, found = text.split("\n"), collections.Counter(), []
    for match in ERROR.finditer(plain):
        line = plain.count("\n", 0, match.start())
        start = match.start() - (plain.rfind("\n", 0, match.start()) + 1)
        # What follows a handler's name is counted from its brace on.
        place = plain.find("{", match.start()) if match[0] != "throw" else match.start()
        at_line, at_column = plain.count("\n", 0, place) + 1, place - plain.rfind("\n", 0, place)
        key = re.sub(r"\s+", " ", " ".join([lines[line][start:], *lines[line + 1:line + 3]])).split("; ")[0][:70].strip(" ;{}")
        seen[key] += 1
        found.append((at_line, at_column, key if seen[key] == 1 else f"{key} #{seen[key]}"))
    return found


def uncovered_paths(root, records):
    """[(file, line, key)] of error paths that never ran, and how many there are by library."""
    missed, total = [], collections.Counter()
    for path, record in sorted(records.items()):
        with open(os.path.join(root, path), encoding="utf-8") as file:
            paths = error_paths(file.read())
        counts = Counts(record)
        for line, column, key in paths:
            count = counts.at(line, column)
            total[library(path)] += count is not None
            if count == 0:
                missed.append((path, line, key))
    return missed, total


def library(path):
    return "/".join(path.split("/")[:2]) if path.startswith("lib/") else "tools"


def write(root, records):
    """Returns 1, and names them, where an error path never runs that uncovered.json does not know, or one of it does run."""
    with open(REASONS, encoding="utf-8") as file:
        reasons = json.load(file)
    missed, total = uncovered_paths(root, records)
    known = {f"{path}: {key}" for path, _, key in missed}
    rewrite(os.path.join(root, "docs", "quality", "coverage.md"),
            {"Results": table(records, missed, total), "Error paths that no test runs": paths_table(missed, reasons)})
    unknown = [(path, line, key) for path, line, key in missed if f"{path}: {key}" not in reasons]
    gone = sorted(set(reasons) - known)
    for path, line, key in unknown:
        print(f"{path}:{line}: {key}")
    for key in gone:
        print("runs, or is no more:", key)
    return 1 if unknown or gone else 0


def write_fuzz(root, records_by_target):
    """Lines of each library that is part of a fuzz target, and how many of them its inputs reach."""
    sums = {target: sums_by_library(records) for target, records in records_by_target.items()}
    lines = [f"| | {' | '.join(f'`fuzz_{target}`' for target in sums)} |", "|---" * (1 + len(sums)) + "|"]
    for name in sorted({name for of_target in sums.values() for name in of_target} - {"all"}):
        cells = [f"{share(s[name], 'lines')} of {s[name]['lines']:,}" if s[name]["lines"] else "" for s in sums.values()]
        lines.append(f"| {name} | {' | '.join(cells)} |")
    rewrite(os.path.join(root, "docs", "quality", "fuzzing.md"), {"What it reaches": lines})


def sums_by_library(records):
    """{library, or "all": {"lines": how many, "lines run": ..., "branches": ...}}"""
    sums = collections.defaultdict(collections.Counter)
    for path, record in records.items():
        for group in (library(path), "all"):
            for kind in ("lines", "branches", "functions"):
                summary = record["summary"][kind]
                sums[group][kind] += summary["count"]
                sums[group][kind + " run"] += summary["covered"]
    return sums


def table(records, missed, total):
    sums = sums_by_library(records)
    by_library = collections.Counter(library(path) for path, _, _ in missed)
    lines = ["| | lines | run | branches | taken | functions | run | error paths | run |", "|---|---|---|---|---|---|---|---|---|"]
    for name in [*sorted(set(sums) - {"all"}), "all"]:
        errors = sum(total.values()) if name == "all" else total[name]
        errors_run = errors - (len(missed) if name == "all" else by_library[name])
        cells = [cell for kind in ("lines", "branches", "functions") for cell in (f"{sums[name][kind]:,}", share(sums[name], kind))]
        lines.append(f"| {name} | {' | '.join(cells)} | {errors:,} | {percent(errors_run, errors)} |")
    return lines


def share(sums, kind):
    return percent(sums[kind + " run"], sums[kind])


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def paths_table(missed, reasons):
    lines, last = [], None
    for path, _, key in missed:
        if path != last:
            lines += ["", f"**{path}**", "", "| error path | why no test runs it |", "|---|---|"]
            last = path
        lines.append("| `{}` | {} |".format(key.replace("|", "\\|"), reasons.get(f"{path}: {key}", "")))
    return lines[1:]


def print_lines(root, path, record):
    """Lines in which something never ran, with the columns where that begins."""
    with open(os.path.join(root, path), encoding="utf-8") as file:
        lines = file.read().split("\n")
    counts = Counts(record)
    for number, text in enumerate(lines, 1):
        begin = len(text) - len(text.lstrip()) + 1
        columns = [begin] + [s[1] for s in record["segments"] if s[0] == number and s[3] and not s[5]]
        if text.strip() and any(counts.at(number, column) == 0 for column in columns):
            print(f"{path}:{number}: {text}")
