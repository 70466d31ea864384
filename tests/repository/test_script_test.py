#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/test and the presets in a project with two tests: it runs after any earlier build, and no test at all is a failure."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
PROJECT = """cmake_minimum_required(VERSION 3.25)
project(one_test LANGUAGES NONE)
option(LANDFALL_BUILD_TESTS "" ON)
if(LANDFALL_BUILD_TESTS)
  enable_testing()
  add_test(NAME quick COMMAND ${CMAKE_COMMAND} -E RESULT)
  add_test(NAME long COMMAND ${CMAKE_COMMAND} -E true)
  set_tests_properties(long PROPERTIES LABELS "studies;slow")
endif()
"""


class TestScript(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="landfall-test-script-")))
        (self.folder / "scripts").mkdir()
        shutil.copy(ROOT / "scripts" / "test", self.folder / "scripts")
        shutil.copy(ROOT / "CMakePresets.json", self.folder)
        install = self.folder / "scripts" / "install-packages"
        install.write_text("#!/bin/sh\n", encoding="utf-8")
        install.chmod(0o755)

    def execute(self, *command):
        return subprocess.run([str(part) for part in command], cwd=self.folder, capture_output=True, text=True, check=False)

    def project(self, result="true"):
        (self.folder / "CMakeLists.txt").write_text(PROJECT.replace("RESULT", result), encoding="utf-8")

    def test_runs_tests_after_a_build_without_tests(self):
        self.project()
        self.assertEqual(self.execute("cmake", "--preset", "release", "-DLANDFALL_BUILD_TESTS=OFF").returncode, 0)
        result = self.execute(self.folder / "scripts" / "test")
        self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
        self.assertIn("100% tests passed, 0 tests failed out of 2", result.stdout)

    def test_commit_leaves_out_slow_tests(self):
        self.project()
        for options in [], ["-R", "quick"]:
            result = self.execute(self.folder / "scripts" / "test", "--commit", *options)
            self.assertEqual(result.returncode, 0, result.stdout + result.stderr)
            self.assertIn("100% tests passed, 0 tests failed out of 1", result.stdout)
        self.assertNotEqual(self.execute(self.folder / "scripts" / "test", "--commit", "-R", "long").returncode, 0)

    def test_fails_if_a_test_fails(self):
        self.project(result="false")
        self.assertNotEqual(self.execute(self.folder / "scripts" / "test").returncode, 0)

    def test_fails_without_tests(self):
        self.project()
        result = self.execute(self.folder / "scripts" / "test", "-R", "another")
        self.assertNotEqual(result.returncode, 0)
        self.assertIn("No tests were found", result.stdout + result.stderr)


if __name__ == "__main__":
    unittest.main()
