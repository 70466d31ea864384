#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
# Every command of the pages is run, page by page, in a new and empty folder; a page that names a clone begins in one.
# Changes that shorten a run (a coarser terrain, 1,000 pulses) are in comments that readers do not see; they make no file, and nothing
# is shortened whose numbers the page shows. type_pages.py runs the pages without them. The command of a study is given to `make -n`.
#
# The tutorial's raster is generated, not shipped: a script makes the same cratered plain on any machine.
#
# Blocks that take minutes run on request (`LANDFALL_TEST_LONG=1`), unchanged and without smaller arguments; otherwise
# the test names each block that it skips. Commands that change the system's packages run in the bare Debian of
# `scripts/test-deb`, which takes them from the page. CI runs `scripts/test`, the one command that runs the tests of the
# pages.
"""Runs every command of the documentation: the blocks of each page, in order, in one new folder.

    run_docs_test.py GROUP            the pages of a group, as ctest does
    run_docs_test.py PAGE ...         README.md, docs/user/cli.md, ...
    run_docs_test.py --write PAGE ... also updates the output blocks of the page
    LANDFALL_TEST_LONG=1 run_docs_test.py PAGE    also runs the blocks that take minutes, and prints their times

Shell blocks run in one `bash -euo pipefail` with the tools on PATH. The Python blocks of a page run in one
python3 that finds the package landfall. page.py describes the comments that annotate blocks.
"""
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
import unittest

import page as pages

ROOT = os.path.abspath(os.environ["LANDFALL_ROOT"])
BIN = os.path.abspath(os.environ["LANDFALL_BIN"])
HERE = os.path.dirname(os.path.abspath(__file__))
# Pages of a group run one after the other, groups in parallel. A page belongs to the first group that matches it.
GROUPS = {"readme": r"(docs/)?\w+\.md$", "lidar": r"docs/user/lidar/", "terrain": r"docs/user/terrain/", "files": r"docs/user/files/",
          "studies": r"docs/user/studies/", "guides": r"docs/user/(tutorial|usability|gallery)", "tools": r"docs/user/",
          "quality": r"docs/(reference|quality)/"}
PAGE_TIMEOUT_S = 7200 if pages.LONG else 300


def group_of(name):
    return next(group for group, pattern in GROUPS.items() if re.match(pattern, name))


def python_commands(block, number, folder):
    """Writes a Python block to a file, and returns the command that runs it."""
    path = os.path.join(folder, f"{number}.py")
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n" * (block.line - 1) + block.text)  # messages give the lines of the page
    return f"python_block '{path}' '{folder}/{number}.out'\n"


def commands_of(blocks, number, folder):
    """The bash commands of a block; empty for one that is only shown."""
    block = blocks[number]
    text = ""
    if "file" in block.notes or "check" in block.notes:
        path = os.path.join(folder, str(number))
        with open(path, "w", encoding="utf-8") as file:
            file.write(block.text)
        if "file" in block.notes:
            text += f"mkdir -p \"$(dirname '{block.notes['file']}')\" && cp '{path}' '{block.notes['file']}'\n"
        if "check" in block.notes:
            text += f"command {block.notes['check']} -c '{path}' --check\n"
    if block.is_run:
        text += python_commands(block, number, folder) if block.language == "python" else block.text
    return text


def without_files(setup):
    """The commands of a setup, which fail if they make, change or remove a file."""
    return f"files=$(find . -printf '%p %T@ ')\n{setup}[[ $files == \"$(find . -printf '%p %T@ ')\" ]] || {{ echo 'a setup makes files'; false; }}\n"


class Run:
    """Runs one page in bash: the exit `code`, and what each block printed. With `as_shown` the setups, which make runs smaller, are left out."""

    def __init__(self, page, as_shown=False):
        self.page, self.blocks, self.as_shown = page, page.blocks, as_shown
        self.folder = tempfile.mkdtemp(prefix="landfall-docs-")
        try:
            self._run()
        finally:
            shutil.rmtree(self.folder)

    def _run(self):
        aside, work = os.path.join(self.folder, "aside"), os.path.join(self.folder, "work")
        os.mkdir(aside)
        os.mkdir(work)
        os.mkdir(os.path.join(aside, "bin"))
        os.symlink("/usr/bin/python3", os.path.join(aside, "bin", "python3"))
        # Variables of the shell, not of the environment: the commands of a page do not see them.
        script = [f"LANDFALL_ROOT='{ROOT}' LANDFALL_BIN='{BIN}' AS_SHOWN={'1' if self.as_shown else ''}", f". '{HERE}/setup.sh'"]
        if self.page.needs_clone():
            script.append("clone" if pages.LONG else "checkout")
        of_folder = os.path.join(pages.NOTES, os.path.dirname(self.page.name), "setup.sh")
        if os.path.exists(of_folder) and not self.as_shown:
            script.append(without_files(f". '{of_folder}'\n"))
        for number, block in enumerate(self.blocks):
            text = commands_of(self.blocks, number, aside)
            is_setup = block.language in ("setup", "long setup")
            if text and not (is_setup and self.as_shown):
                if block.language == "setup":
                    text = without_files(text)
                # Empty lines come first, so that bash reports the line numbers of the page.
                with open(os.path.join(aside, f"{number}.sh"), "w", encoding="utf-8") as file:
                    file.write("\n" * (block.line - 1 - (block.language == "setup")) + text)
                script.append(f". '{aside}/{number}.sh' > '{aside}/{number}.out' 2>&1")
                script.append(f": > '{aside}/{number}.end'")
        self._start(script, aside, work)

    def _start(self, script, aside, work):
        environment = dict(os.environ, MPLBACKEND="Agg", PYTHONDONTWRITEBYTECODE="1",
                           PYTHONPATH=os.path.join(ROOT, "python"),
                           PATH=os.pathsep.join([os.path.join(aside, "bin"), BIN, os.environ["PATH"]]))
        # The variables of the tests, and those of make if it started ctest, must not affect the commands of the page.
        for name in ("LANDFALL_ROOT", "LANDFALL_BIN", "MAKEFLAGS", "MFLAGS", "MAKELEVEL"):
            environment.pop(name, None)
        started = time.time()
        result = subprocess.run(["bash", "-euo", "pipefail", "-c", "\n".join(script)], cwd=work, env=environment,
                                stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=PAGE_TIMEOUT_S, check=False)
        self.code, self.message = result.returncode, result.stderr
        self.printed, self.seconds = {}, {}
        for number in range(len(self.blocks)):
            path = os.path.join(aside, f"{number}.out")
            if os.path.exists(path):
                with open(path, encoding="utf-8", errors="replace") as file:
                    self.printed[number] = file.read().replace(f"{aside}/", "")
            if os.path.exists(os.path.join(aside, f"{number}.end")):
                self.seconds[number] = os.path.getmtime(os.path.join(aside, f"{number}.end")) - started
                started += self.seconds[number]
        self.last = max(self.printed, default=None)

    def output_before(self, number):
        """The output of the last visible command before block `number`; None if this run skips it."""
        before = max((n for n in range(number) if self.blocks[n].is_command or self.blocks[n].notes.keys() & {"file", "check"}), default=None)
        return self.printed.get(before)

    def is_shown(self, number):
        """Whether block `number` shows the actual output."""
        printed = self.output_before(number)
        return printed is None or shows(self.blocks[number].text, printed)


def steady(text):
    """The text without revisions, file ids and file sizes, which differ between versions."""
    for pattern in (r"\(git [^)]*\)", r"\b([0-9a-f]{32}|[0-9a-f]{12})\b", r"\b[\d.]+ [kM]B\b"):
        text = re.sub(pattern, "?", text)
    return text


def shows(shown, printed):
    """Whether `shown` equals `printed` except for what `steady` removes; a line `...` in `shown` matches any lines."""
    shown, printed = steady(shown), steady(printed)
    pattern = "".join(r"(?:.*\n)*?" if line.strip() == "..." else re.escape(line.rstrip()) + r" *\n" for line in shown.splitlines())
    return re.fullmatch(pattern, printed if printed.endswith("\n") or not printed else printed + "\n") is not None


def rewrite(page, run):
    """Updates the output blocks of the page that differ from the actual output."""
    path = os.path.join(ROOT, page.name)
    with open(path, encoding="utf-8") as file:
        lines = file.read().split("\n")
    for number in reversed(range(len(page.blocks))):
        block = page.blocks[number]
        if "output" in block.notes and not run.is_shown(number):
            first = block.line - 1
            printed = [line.rstrip() for line in run.output_before(number).splitlines()]
            lines[first:first + block.text.count("\n")] = printed
    with open(path, "w", encoding="utf-8") as file:
        file.write("\n".join(lines))


class Commands(unittest.TestCase):
    names = []
    write = False

    def test_each_page(self):
        for name in self.names:
            with self.subTest(name):
                started = time.monotonic()
                page = pages.Page(name)
                self.assertEqual(page.faults, [])
                run = Run(page)
                self.check(page, run)
                print(f"{name}: {sum(block.is_run for block in page.blocks)} blocks, {time.monotonic() - started:.1f} s", file=sys.stderr)
                self.report_long_blocks(page, run)

    @staticmethod
    def report_long_blocks(page, run):
        for number, block in enumerate(page.blocks):
            if "long" in block.notes:
                what = f"{run.seconds[number]:.0f} s" if block.is_run else f"skipped ({block.notes['long']}); LANDFALL_TEST_LONG=1 runs it"
                print(f"{page.name}:{block.line}: {what}", file=sys.stderr)

    def check(self, page, run):
        if run.code:
            block = page.blocks[run.last] if run.last is not None else None
            self.fail(f"{page.name}:{block.line if block else 1}: exit {run.code} of\n{block.text if block else ''}\n"
                      f"{run.printed.get(run.last, '')}{run.message}")
        if self.write:
            return rewrite(page, run)
        for number, block in enumerate(page.blocks):
            if {"output", "full output" if run.as_shown else "output"} & block.notes.keys() and not run.is_shown(number):
                self.fail(f"{page.name}:{block.line}: the page shows\n{block.text}\nwhere the command printed\n{run.output_before(number)}")
            if block.language == "json":
                json.loads(block.text)
        return None


def main():
    arguments = sys.argv[1:]
    Commands.write = "--write" in arguments
    wanted = [argument for argument in arguments if argument != "--write"]
    Commands.names = [name for name in pages.names() if name in wanted or group_of(name) in wanted]
    if not Commands.names:
        sys.exit(f"run_docs_test.py: no page of {wanted}; groups are {', '.join(GROUPS)}")
    unittest.main(argv=sys.argv[:1])


if __name__ == "__main__":
    main()
