#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Names and contents of files cannot make a script run commands or open other files."""
import ast
import json
import os
import random
import re
import shutil
import subprocess
import sys
import unittest

import h5py

ROOT = os.environ["LANDFALL_ROOT"]
sys.path.insert(0, os.path.join(ROOT, "tests", "studies"))
# pylint: disable=wrong-import-position
from harness import write_file
from harness.commands import run_command
from case import BIN, PYTHON, SIGMAS, StudyTest, read, study

HOSTILE = "a b'\"$(touch hacked)`touch hacked`;-x"
MARKUP = "</script><img src=x onerror=alert(1)>"
HIDDEN = "\x1b[31m\u202eh\x07"
# Calls that execute text as a program or that are unsafe.
FORBIDDEN_CALLS = {"eval", "exec", "compile", "os.system", "os.popen", "subprocess.getoutput", "subprocess.getstatusoutput",
                   "tempfile.mktemp", "pickle.load", "pickle.loads", "yaml.load"}
FORBIDDEN_SHELL = re.compile(r"(^|[;&|({]\s*)eval\s|\b(ba|da)?sh\s(-\w+\s)*-c\s+\"\w*[^\"]*\s")


def shipped(*folders):
    """The Python and bash programs of the repository, recognised by their first line or their extension."""
    for top in folders:
        for folder, _, names in os.walk(os.path.join(ROOT, top)):
            for name in names:
                path = os.path.join(folder, name)
                head = read(path)[:64].split(b"\n", 1)[0]
                yield path, name.endswith(".py") or b"python" in head and head.startswith(b"#!"), b"bash" in head


def dangerous_calls(text):
    """The lines of Python code that execute text, or that run a command through a shell."""
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Call):
            shell = any(word.arg == "shell" and not (isinstance(word.value, ast.Constant) and word.value.value is False)
                        for word in node.keywords)
            if shell or ast.unparse(node.func) in FORBIDDEN_CALLS:
                yield node.lineno


def places(tree, here=()):
    """The paths of all values of a tree."""
    inner = tree.items() if isinstance(tree, dict) else enumerate(tree) if isinstance(tree, list) else ()
    return [here] * bool(here) + [place for key, value in inner for place in places(value, (*here, key))]


def replaced(tree, place, value):
    """The tree with another value at a path."""
    copy = json.loads(json.dumps(tree))
    inner = copy
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    return copy


class Programs(unittest.TestCase):
    def test_no_program_executes_text(self):
        found, count = [], 0
        for path, is_python, is_bash in shipped("python", "scripts", "studies", "bench", "examples", "packaging", "cmake"):
            count += is_python or is_bash
            text = read(path).decode(errors="replace")
            if is_python:
                found += [f"{path}:{line}" for line in dangerous_calls(text)]
            if is_bash:
                found += [f"{path}:{number}" for number, line in enumerate(text.splitlines(), 1)
                          if not line.startswith("#") and FORBIDDEN_SHELL.search(line)]
        self.assertEqual(found, [])
        self.assertGreater(count, 30)

    def test_the_check_finds_dangerous_code(self):
        for text in ("subprocess.run('ls ' + name, shell=True)", "os.system(name)", "eval(name)", "pickle.load(file)"):
            self.assertEqual(list(dangerous_calls(text)), [1], text)
        for text in ("eval \"$line\"", "bash -c \"ls $name\"", "sh -c \"cd $x; ls\"", "true; eval $x"):
            self.assertTrue(FORBIDDEN_SHELL.search(text), text)


class Names(StudyTest):
    def setUp(self):
        super().setUp()
        self.hostile = self.path(HOSTILE)
        os.mkdir(self.hostile)

    def assert_nothing_ran(self):
        for folder, folders, files in os.walk(self.folder):
            self.assertNotIn("hacked", folders + files, folder)
        self.assertFalse(os.path.exists(os.path.join(ROOT, "hacked")))

    def run_in(self, folder, *command, code=0):
        result = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=300, env=self.environment(),
                                check=False)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def test_a_study_is_made_in_a_folder_of_any_name(self):
        for name in ("python", "schemas", "studies", "lib/app/report/web"):
            shutil.copytree(os.path.join(ROOT, name), os.path.join(self.hostile, name), symlinks=True)
        shutil.copy(os.path.join(ROOT, "Makefile.studies"), self.hostile)
        tree = study({**SIGMAS, "values": [0.01, 0.02], "label": MARKUP}, title=MARKUP + HIDDEN, description="$(touch hacked) " + MARKUP + HIDDEN)
        write_file(os.path.join(self.hostile, "studies", "tiny.json"), json.dumps(tree))
        self.run_in(self.hostile, "make", "-f", "Makefile.studies", "study", "STUDY=tiny", f"BIN={BIN}")
        self.assert_nothing_ran()
        made = os.path.join(self.hostile, "runs", "studies", "tiny")
        self.assertEqual(len(read(os.path.join(made, "results.csv")).splitlines()), 3)
        page = read(os.path.join(made, "report.html")).decode()
        self.assertIn("onerror=alert(1)", page)
        self.assertNotIn(MARKUP, page)
        self.assertNotIn("<img src=x", page)
        self.assertIn("\\u001b[31m\\u202e", page)
        self.assertNotRegex(page, "[\x1b\u202e\x07]")

    def test_a_plot_takes_a_file_of_any_name(self):
        terrain, picture = (os.path.join(self.hostile, name) for name in ("-t'\"$(touch hacked).h5", "-p'\"$(touch hacked).png"))
        self.run_in(self.hostile, os.path.join(BIN, "terrain-gen"), "--half-width", "2", "--resolution", "0.5", "-o", terrain)
        self.run_in(self.hostile, PYTHON, os.path.join(ROOT, "python", "commands", "plot_terrain.py"), terrain, "-o", picture)
        self.assertTrue(os.path.exists(picture))
        self.assert_nothing_ran()

    def test_make_refuses_names_with_special_characters(self):
        for name, value in [("RUNS", "a b"), ("RUNS", HOSTILE), ("DEM", "$(touch hacked).tif"), ("DEM", "$(shell touch hacked)"),
                            ("STUDY", "x`touch hacked`"), ("BIN", "a;touch hacked"), ("RUNS", "-x"), ("THREADS", "0;touch hacked"),
                            ("SCRATCH", "x|y"), ("KEEP", "$(touch hacked)")]:
            command = ["make", "-C", ROOT, "-n", "-f", "Makefile.studies", "studies", f"{name}={value}"]
            result = self.run_in(self.folder, *command, code=2)
            self.assertIn(f"{name} is \"{value}\"", result.stderr)
        self.assert_nothing_ran()

    def test_file_names_that_make_would_split_are_refused(self):
        for name in ("a b.tif", "$(shell touch hacked)", "a\nb", "`touch hacked`", "a;b", "a#b"):
            write_file(self.path(name), "")
            tree = study(SIGMAS)
            tree["base"]["terrain"]["base"] = {"type": "dem", "path": name}
            result = self.sweep("plan", self.write(tree), "--out", self.out(), "--bin", BIN, code=2)
            self.assertIn("make cannot take this file name", result.stderr)
        self.assert_nothing_ran()

    def test_a_shown_case_runs_only_the_four_tools(self):
        variants = {"$(touch hacked)": {"scan.seed": 1}, "b": {"scan.seed": 2}}
        tree = study({"name": "seed", "variants": variants},
                     {"key": "scan.noise.a\n touch hacked #", "values": [1, 2]})
        script = write_file(self.path("case.sh"), self.sweep("show", self.write(tree), 0).stdout)
        stubs = self.path("stubs")
        os.mkdir(stubs)
        for name in ("terrain-gen", "scan-sim", "regrid", "dem-eval"):
            os.symlink("/bin/true", os.path.join(stubs, name))
        subprocess.run(["bash", script], cwd=self.hostile, check=True, env={"PATH": stubs + ":/usr/bin:/bin"})
        self.assert_nothing_ran()

    def test_files_outside_the_study_folder_are_refused(self):
        folder = self.plan(study(SIGMAS))
        path = os.path.join(folder, "cases.json")
        for name in ("../../secret.json", "/etc/passwd"):
            cases = json.loads(read(path))
            cases["cases"][0][-1] = name
            write_file(path, json.dumps(cases))
            self.assertIn(f"\"{name}\" is not in the study's folder", self.sweep("collect", folder, code=2).stderr)

    def test_values_of_other_types_in_the_files_of_a_study(self):
        """One line says what is wrong, or the value is not needed."""
        folder = self.plan(study(SIGMAS))
        for name in json.loads(read(os.path.join(folder, "cases.json")))["cases"]:
            os.makedirs(os.path.dirname(os.path.join(folder, name[-1])), exist_ok=True)
            metrics = {"format": "landfall.metrics", "version": 1, "pass": True, "coverage": {"invalid_frac": 0.1}}
            write_file(os.path.join(folder, name[-1]), json.dumps(metrics))
        choose = random.Random(os.environ.get("LANDFALL_TEST_SEED", "1"))
        for name in ("cases.json", json.loads(read(os.path.join(folder, "cases.json")))["cases"][0][-1]):
            path = os.path.join(folder, name)
            intact = json.loads(read(path))
            changes = [(place, value) for place in places(intact) for value in (None, "", "a", [], {}, -1, 2.5, True, 1e300)]
            for place, value in choose.sample(changes, min(len(changes), 400 if os.environ.get("LANDFALL_TEST_LONG") else 8)):
                write_file(path, json.dumps(replaced(intact, place, value)))
                for command in ("collect", "status") if name == "cases.json" else ("collect",):
                    with self.subTest(file=name, place=place, value=value, command=command):
                        result = self.collect(folder, command)
                        self.assertIn(result.returncode, (0, 1, 2), result.stderr)
                        self.assertRegex(result.stderr, r"\A(landfall study: [^\n]*\n)?\Z")
            write_file(path, json.dumps(intact))

    @staticmethod
    def collect(folder, command="collect"):
        return run_command("sweep", command, folder)

    def test_a_plot_follows_no_link(self):
        target, terrain = self.path("target.h5"), self.path("terrain.h5")
        os.mkfifo(target)  # opening it would block
        for link, words in ((h5py.ExternalLink(target, "/z"), "/z is a link to another file, "), (h5py.SoftLink("/y"), "/z is a soft link, to /y")):
            self.run_in(self.folder, os.path.join(BIN, "terrain-gen"), "--half-width", "2", "--resolution", "0.5", "-O", "-o", terrain)
            with h5py.File(terrain, "a") as file:
                del file["z"]
                file["z"] = link
            result = self.run_in(self.folder, PYTHON, os.path.join(ROOT, "python", "commands", "plot_terrain.py"), terrain, "-o",
                                 self.path("t.png"), code=1)
            self.assertIn(words, result.stderr)


if __name__ == "__main__":
    unittest.main()
