#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Provokes every error message of tests/cli/catalogue.json and compares exit code and text.

usage: catalogue_test.py [--write]

--write puts the present messages into the catalogue; review the difference. scripts/site/errors.py makes a page of it.

A case has the command (`run`), the `text` on stderr and, where needed, `files` (name and content), `stdin`, `stdout`, `env`
`limit` (of the process: file_bytes, memory_bytes), and `needs`, a file without which it is skipped. It runs in a folder with the files of catalogue_files.py, so that
the file names in messages are short and constant.

The catalogue lacks messages that no command line provokes:
- errors of lib/ that the configuration's schema or another check prevents (a direct caller of the library sees them);
- errors of the library's interface (lib/app/host), which tests/chain/host_test.py and tests/unit/app/host provoke;
- sizes beyond 2^31 vertices, triangles, pulses or returns of a DEM or in a bin of a plan, rows beyond 10^8, blocks of more than 256 MiB;
- failures of the system during a run (a compressor without memory, a failing HDF5 call, a file that shrinks while it is
  read, an output that appears during the run, a refused rename or thread), which tests/faults provokes;
- a GDAL without its COG or GPKG driver, a plugin of another version, and a file without read permission, because root can read it.
"""
import json
import os
import re
import resource
import shlex
import shutil
import subprocess
import sys
import tempfile
import unittest

from catalogue_files import make_files
from harness import ROOT, SANITIZED, read_bytes, tool, write_file

CATALOGUE = os.path.join(ROOT, "tests", "cli", "catalogue.json")
LIMITS = {"file_bytes": resource.RLIMIT_FSIZE, "memory_bytes": resource.RLIMIT_AS}
# Identifiers of libraries and of our own code, which mean nothing to a user.
JARGON = ["H5D", "H5F", "std::", "nlohmann", "CLI::", "basic_", "null pointer", "internal error", "0x", "bad_alloc",
          "json.exception"]


def read_catalogue():
    return json.loads(read_bytes(CATALOGUE))


def with_version(text, before, after):
    """Replaces the version, the only part of a message that changes with a release."""
    return text.replace(f"this is {before}", f"this is {after}")


def program_version():
    return subprocess.run([tool("dem-eval"), "--version"], capture_output=True, text=True, check=True).stdout.split()[2]


def cases_of(catalogue):
    """All cases, each with the fault that it belongs to."""
    return [(fault, case) for section in catalogue for fault in section["faults"] for case in fault["cases"]]


def set_limits(limits):
    for name, value in limits.items():
        resource.setrlimit(LIMITS[name], (value, value))


def can_run(case):
    return os.path.exists(case.get("needs", "/"))


def provoke(case):
    """Runs a case in the current folder."""
    for name, text in case.get("files", {}).items():
        write_file(name, text)
    name, *arguments = shlex.split(case["run"])
    limits = case.get("limit")
    limit = (lambda: set_limits(limits)) if limits else None  # with a function, Python copies its address space for each run
    with open(case.get("stdout", os.devnull), "w", encoding="utf-8") as stdout:
        return subprocess.run([tool(name), *arguments], input=case.get("stdin", ""), stdout=stdout,
                              stderr=subprocess.PIPE, text=True, timeout=30, check=False,
                              env={**os.environ, **case.get("env", {})},
                              preexec_fn=limit)


class Folder:
    """A temporary folder with the files; it is the working folder inside `with`."""

    def __enter__(self):
        self.before, self.path = os.getcwd(), tempfile.mkdtemp(prefix="landfall-catalogue-")
        os.chdir(self.path)
        make_files()
        return self

    def __exit__(self, *unused):
        os.chdir(self.before)
        shutil.rmtree(self.path)


def state():
    """{path: (size, time)} of all files."""
    found = {}
    for folder, _, names in os.walk("."):
        for name in names:
            path = os.path.normpath(os.path.join(folder, name))
            status = os.lstat(path)
            found[path] = (status.st_size, status.st_mtime_ns)
    return found


def tidy(made):
    """Removes the files that a case has made."""
    for path in state():
        if path not in made:
            os.remove(path)


class Catalogue(unittest.TestCase):
    def test_every_message(self):
        version = program_version()
        with Folder():
            made = state()
            for fault, case in cases_of(read_catalogue()):
                with self.subTest(case["run"]):
                    if SANITIZED and "memory_bytes" in case.get("limit", {}):
                        self.skipTest("a sanitizer reserves terabytes of address space")
                    if SANITIZED and "LD_PRELOAD" in case.get("env", {}):
                        self.skipTest("a sanitizer must be preloaded first")
                    if not can_run(case):
                        self.skipTest(f"there is no {case['needs']}")
                    result = provoke(case)
                    self.assertEqual(result.stderr, with_version(case["text"], "VERSION", version) + "\n")
                    self.assertEqual(result.returncode, fault["exit"])
                    changed = {path for path, there in state().items() if made.get(path) != there}
                    # The outputs are written even if a requirement is missed.
                    outputs = {name for name in ("out.json", "out.h5") if name in case["run"].split()}
                    written = set(case.get("files", {})) | (outputs if fault["exit"] == 3 else set())
                    self.assertEqual(changed, written)
                tidy(made)

    def test_an_option_in_a_text_is_one_of_the_tool_that_is_named_before_it(self):
        """So that a reader can give it: the tool that prints the text, or one that the text names. An option of the command itself may be wrong."""
        rows = [row["name"] for row in json.loads(read_bytes(os.path.join(ROOT, "schemas", "dictionary", "tools.json")))["tools"]]
        names = [name for name in rows if name == "landfall run" or " " not in name and name != "landfall"]
        helps = {name: subprocess.run([tool(name.split()[0]), *name.split()[1:], "--help"], capture_output=True, text=True, check=True).stdout for name in names}
        options = {name: set(re.findall(r"(?<![\w-])--[a-z][a-z0-9-]*", text)) for name, text in helps.items()}
        words = re.compile("|".join([*sorted(names, key=len, reverse=True), r"(?<![\w-])--[a-z][a-z0-9-]*"]))
        count = 0
        for _, case in cases_of(read_catalogue()):
            given, named = [word.split("=")[0] for word in case["run"].split()], None
            for word in words.findall(case["text"]):
                named = named if word.startswith("--") else word
                if word.startswith("--") and word not in given and named:
                    count += 1
                    self.assertIn(word, options[named], case)
        self.assertGreater(count, 50)

    def test_the_texts_have_one_form(self):
        for _, case in cases_of(read_catalogue()):
            with self.subTest(case["text"]):
                words = case["run"].split()
                self.assertTrue(case["text"].startswith((words[0] + ": ", " ".join(words[:2]) + ": ")))
                self.assertNotIn("\n", case["text"])
                self.assertRegex(case["text"], r"([^.]|\.\.\.)\Z")
                for word in JARGON:
                    self.assertNotIn(word, case["text"])


def write():
    catalogue, version = read_catalogue(), program_version()
    with Folder():
        made = state()
        for fault, case in cases_of(catalogue):
            if not can_run(case):
                continue
            result = provoke(case)
            tidy(made)
            case["text"] = with_version(result.stderr.rstrip("\n"), version, "VERSION")
            if result.returncode != fault["exit"]:
                print(f"exit {result.returncode}, not {fault['exit']}: {case['run']}", file=sys.stderr)
    write_file(CATALOGUE, as_text(catalogue))


def as_text(catalogue):
    """The catalogue as JSON with one case per line."""
    parts = []
    for section in catalogue:
        faults = []
        for fault in section["faults"]:
            cases = ",\n".join("      " + json.dumps(case) for case in fault["cases"])
            head = ", ".join(f"{json.dumps(key)}: {json.dumps(fault[key])}" for key in ("cause", "do", "exit"))
            faults.append(f'    {{{head}, "cases": [\n{cases}]}}')
        parts.append(f'  {{"section": {json.dumps(section["section"])}, "faults": [\n' + ",\n".join(faults) + "]}")
    return "[\n" + ",\n".join(parts) + "\n]\n"


if __name__ == "__main__":
    if "--write" in sys.argv:
        write()
    else:
        unittest.main()
