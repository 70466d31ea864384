#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Figures do not depend on a matplotlibrc: in the folder of the data it would be part of what came with them, and could run LaTeX."""
import os
import subprocess
import sys
import unittest

from harness import ROOT, ChainTest, read_bytes, write_file

COMMANDS = os.path.join(ROOT, "python", "commands")
SETTINGS = {"latex": b"text.usetex: True\ntext.latex.preamble: \\input{/etc/passwd}\n", "effects": b"path.effects: []\n", "not UTF-8": b"font.family: \xff\n",
            "look": b"figure.facecolor: red\nsavefig.facecolor: red\nfont.family: monospace\nfont.size: 30\naxes.grid: True\nimage.cmap: gray\n"
                    b"axes.unicode_minus: False\nmathtext.fontset: cm\nsavefig.bbox: tight\nno.such.key: 1\n"}
FIGURE = """
import sys
import matplotlib
before = dict(matplotlib.rcParams)
import landfall
figure = landfall.plot.dem(sys.argv[1])
figure.savefig(sys.argv[2])
figure.canvas.print_png(sys.argv[2] + ".print")
assert dict(matplotlib.rcParams) == before, "the caller's settings have changed"
"""
ANSWERS = """
import types
from landfall.answers import {name}
problem = types.SimpleNamespace(groups=[], title="t", outputs={{}}, judges_map=lambda: True)
answer = {{"outputs": {{}}, "draws": 1, "candidates": [], "front": [], "raced": [], "base": {{"stage": "none"}}, "winner": None, "reference_cost": 1}}
{name}.figure_of(problem, answer)
"""


class Settings(ChainTest):
    def setUp(self):
        super().setUp()
        self.folder, self.marks, home = self.path("data"), self.path("latex-ran"), self.path("home")
        for folder in (self.folder, home, self.path("bin")):
            os.mkdir(folder)
        for program in ("latex", "dvipng"):  # they must not run
            os.chmod(write_file(self.path(f"bin/{program}"), f"#!/bin/sh\ntouch {self.marks}\nexit 1\n"), 0o755)
        self.environment = {**os.environ, "HOME": home, "MPLCONFIGDIR": os.path.join(home, "mpl"), "PYTHONPATH": os.path.join(ROOT, "python"),
                            "PATH": self.path("bin") + ":" + os.environ["PATH"], "MPLBACKEND": "Agg"}
        os.mkdir(self.environment["MPLCONFIGDIR"])

    def run_python(self, *words, environment=None):
        result = subprocess.run([sys.executable, *words], cwd=self.folder, env=environment or self.environment, capture_output=True, text=True, timeout=120,
                                check=False)
        self.assertFalse(os.path.exists(self.marks), "LaTeX was run")
        return result

    def figure(self, command, *arguments, environment=None):
        result = self.run_python(os.path.join(COMMANDS, command + ".py"), *arguments, "-O", "--dpi", "50", "-o", self.path("f.png"), environment=environment)
        self.assertEqual((result.returncode, result.stderr), (0, ""))
        return read_bytes(self.path("f.png"))

    def write(self, folder, content):
        write_file(os.path.join(folder, "matplotlibrc"), content)

    def test_a_command_draws_the_same(self):
        clean = self.figure("plot_dem", self.chain.dem)
        for name, content in SETTINGS.items():
            self.write(self.folder, content)
            with self.subTest(name):
                self.assertEqual(self.figure("plot_dem", self.chain.dem), clean)
        os.remove(os.path.join(self.folder, "matplotlibrc"))
        self.write(self.environment["MPLCONFIGDIR"], SETTINGS["look"])
        self.assertEqual(self.figure("plot_dem", self.chain.dem), clean)
        named = {**self.environment, "MATPLOTLIBRC": self.environment["MPLCONFIGDIR"]}
        self.assertEqual(self.figure("plot_dem", self.chain.dem, environment=named), clean)

    def test_no_command_opens_one(self):
        """To open a pipe blocks."""
        os.mkfifo(os.path.join(self.folder, "matplotlibrc"))
        for command in sorted(name for name in os.listdir(COMMANDS) if name != "__pycache__"):
            with self.subTest(command):
                self.assertEqual(self.run_python(os.path.join(COMMANDS, command), "--help").returncode, 0)
        for name in ("sensitivity", "design"):
            with self.subTest(name):
                result = self.run_python("-c", ANSWERS.format(name=name))
                self.assertEqual((result.returncode, result.stderr), (0, ""))

    def test_a_figure_in_a_program_whose_settings_remain(self):
        figures = []
        for name in ("latex", "look", None):
            if name is None:
                os.remove(os.path.join(self.folder, "matplotlibrc"))
            else:
                self.write(self.folder, SETTINGS[name])
            result = self.run_python("-c", FIGURE, self.chain.dem, self.path("f.png"))
            self.assertEqual(result.returncode, 0, result.stderr)
            figures.append((read_bytes(self.path("f.png")), read_bytes(self.path("f.png.print"))))
        self.assertTrue(figures[0] == figures[1] == figures[2])


if __name__ == "__main__":
    unittest.main()
