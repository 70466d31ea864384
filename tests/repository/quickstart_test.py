#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/quickstart with commands that only write down that they ran: what it calls, in which order, and what it leaves behind."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
RECORDS = '#!/bin/sh\necho "$(basename "$0") $1" >> "$LOG"\n'


class Quickstart(unittest.TestCase):
    def run_it(self, installs=RECORDS, cmake=RECORDS):
        with tempfile.TemporaryDirectory(prefix="landfall-quickstart-") as name:
            folder = pathlib.Path(name)
            (folder / "scripts").mkdir()
            (folder / "build" / "release" / "bin").mkdir(parents=True)
            shutil.copy(ROOT / "scripts" / "quickstart", folder / "scripts")
            for command, text in {"scripts/install-packages": installs, "cmake": cmake, "make": RECORDS,
                                  "build/release/bin/dem-eval": RECORDS}.items():
                (folder / command).write_text(text, encoding="utf-8")
                (folder / command).chmod(0o755)
            result = subprocess.run([folder / "scripts" / "quickstart"], capture_output=True, text=True, check=False, timeout=100,
                                    env={"PATH": f"{name}:{os.environ['PATH']}", "LOG": str(folder / "log")})
            left = [path.name for path in folder.glob("*.log")]
            return result, (folder / "log").read_text(encoding="utf-8").split("\n"), left

    def test_only_what_the_tools_need_is_installed(self):
        result, ran, left = self.run_it()
        self.assertEqual((result.returncode, result.stderr, left), (0, "", []))
        self.assertEqual(ran, ["install-packages --build", "cmake --preset", "cmake --build", "make -f", "dem-eval runs/example-2/dem.h5", ""])

    def test_it_ends_where_a_command_fails(self):
        for commands, code, ran_last in (({"installs": RECORDS + "exit 3\n"}, 3, "install-packages --build"),
                                         ({"cmake": RECORDS + '[ "$1" = --preset ] || exit 7\n'}, 7, "cmake --build"),
                                         ({"cmake": RECORDS + 'echo no compiler\nexit 1\n'}, 1, "cmake --preset")):
            result, ran, left = self.run_it(**commands)
            self.assertEqual((result.returncode, left, ran[-2]), (code, [], ran_last))
        self.assertIn("no compiler\n", result.stdout)


if __name__ == "__main__":
    unittest.main()
