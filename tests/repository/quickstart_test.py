#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""scripts/quickstart with commands that only write down that they ran: the figures' packages are installed during the build."""
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
RECORDS = '#!/bin/sh\necho "$(basename "$0") $1" >> "$LOG"\n'
INSTALLS = RECORDS + """[ "$1" = --build ] && exit
for i in $(seq 600); do grep -q "cmake --build" "$LOG" && break; sleep 0.05; done
echo installed >> "$LOG"
"""


class Quickstart(unittest.TestCase):
    def run_it(self, installs=INSTALLS, cmake=RECORDS):
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

    def test_figures_wait_for_their_packages(self):
        result, ran, left = self.run_it()
        self.assertEqual((result.returncode, result.stderr, left), (0, "", []))
        self.assertEqual(ran[0], "install-packages --build")
        self.assertEqual(sorted(ran[1:4]), ["cmake --build", "cmake --preset", "install-packages "])
        self.assertEqual(ran[4:], ["installed", "make -f", "dem-eval runs/example-2/dem.h5", ""])

    def test_packages_that_cannot_be_installed(self):
        result, ran, left = self.run_it(INSTALLS + "echo no space left >&2\nexit 3\n")
        self.assertEqual((result.returncode, left), (1, []))
        self.assertIn("no space left\nquickstart: the packages that draw the figures could not be installed\n", result.stderr)
        self.assertNotIn("make -f", ran)

    def test_a_build_that_fails_leaves_no_installation_behind(self):
        result, ran, left = self.run_it(cmake=RECORDS + '[ "$1" = --preset ] || exit 7\n')
        self.assertEqual((result.returncode, left, ran[-2]), (7, [], "installed"))


if __name__ == "__main__":
    unittest.main()
