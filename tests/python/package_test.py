#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The package as users get it: installed by pip without a network, its types, and the notebook of examples/."""
import importlib.util
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.abspath(os.environ["LANDFALL_ROOT"])
sys.path.insert(0, os.path.join(ROOT, "tests", "docs"))
import page  # pylint: disable=wrong-import-position
BIN = os.path.abspath(os.environ["LANDFALL_BIN"])
NOTEBOOK = os.path.join(ROOT, "examples", "notebook", "two_lidars.ipynb")
USE = """
import landfall
figure = landfall.plot.dem("dem.h5", limit_m=0.03)
landfall.run("scan-sim", ["preset:paper", {"seed": 2}], terrain=3, output="a.h5")
landfall.run("scan-sim", 3)
landfall.plot.dem("dem.h5", limit="5")
"""
FAULTS = ["use.py:5: error: Argument 2 to \"run\" has incompatible type \"int\"", "use.py:6: error: Unexpected keyword argument \"limit\""]


def needs(module, package):
    return unittest.skipUnless(importlib.util.find_spec(module), f"{package} is not installed")


class Package(unittest.TestCase):
    def setUp(self):
        self.folder = self.enterContext(tempfile.TemporaryDirectory(prefix="landfall-package-"))

    def run_in_folder(self, *command, environment=None, code=0):
        done = subprocess.run([*command], cwd=self.folder, env=environment, capture_output=True, text=True, check=False)
        self.assertEqual(done.returncode, code, done.stdout + done.stderr)
        return done.stdout

    @needs("ensurepip", "python3-venv")
    @needs("wheel", "python3-wheel")
    @needs("setuptools", "python3-setuptools")
    def test_pip_installs_it_without_a_network(self):
        [command] = [block.text for block in page.Page("docs/user/python.md").blocks if "pip install" in block.text]
        clone = self.folder
        for name in ("python", "schemas", os.path.join("studies", "presets"), os.path.join("lib", "app", "report", "web")):
            shutil.copytree(os.path.join(ROOT, name), os.path.join(clone, name), ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copy(os.path.join(ROOT, "CMakeLists.txt"), clone)
        copied = os.listdir(clone)
        before = sorted(os.listdir(os.path.join(clone, "python")))
        environment = {**{name: value for name, value in os.environ.items() if not name.startswith(("PYTHON", "LANDFALL"))},
                       "PATH": os.pathsep.join([BIN, "/usr/bin", "/bin"]), "PIP_INDEX_URL": "http://127.0.0.1:9/", "PIP_RETRIES": "0"}
        self.run_in_folder("bash", "-euo", "pipefail", "-c", command, environment=environment)
        self.assertEqual(sorted(os.listdir(os.path.join(clone, "python"))), before, "the build left files in the clone")
        self.run_in_folder("rm", "-r", *copied)
        text = ("import landfall; t = landfall.run('terrain-gen', {'grid': {'half_width_m': 2, 'resolution_m': 0.5}}, output='t.h5'); print(dict(t.sizes));"
                "print(type(landfall.plot.terrain(t)).__name__); from landfall.study import model, page; from landfall import web;"
                "print(model.read_config('preset:paper', 'scan', '.')['detector']['roll_deg'])")
        self.assertEqual(self.run_in_folder("v/bin/python", "-c", text, environment=environment), "{'y': 9, 'x': 9}\nFigure\n7.73\n")

    @needs("mypy", "mypy")
    def test_types_are_those_of_the_functions(self):
        use = os.path.join(self.folder, "use.py")
        with open(use, "w", encoding="ascii") as file:
            file.write(USE)

        def checked(*files):  # the second call takes what the first one cached
            return subprocess.run(["mypy", "--cache-dir", os.path.join(self.folder, "cache"), *files], cwd=os.path.join(ROOT, "python"),
                                  capture_output=True, text=True, check=False)

        package = checked()
        self.assertEqual(package.returncode, 0, package.stdout)
        found = checked(use).stdout
        lines = [line for line in found.splitlines() if ": error: " in line]
        self.assertEqual(len(lines), len(FAULTS), found)
        for line, fault in zip(lines, FAULTS):
            self.assertIn(fault, line)

    @needs("nbformat", "python3-nbformat")
    @needs("nbclient", "python3-nbclient")
    @needs("ipykernel", "python3-ipykernel")
    @needs("xarray", "python3-xarray")
    def test_the_notebook_runs_and_shows_each_figure_once(self):
        import nbclient
        import nbformat

        notebook = nbformat.read(NOTEBOOK, as_version=4)
        paths = {"PYTHONPATH": os.path.join(ROOT, "python"), "LANDFALL_BIN": BIN, "HOME": self.folder, "IPYTHONDIR": self.folder}
        environment = {**{name: value for name, value in os.environ.items() if name != "MPLBACKEND"}, **paths}
        nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3", resources={"metadata": {"path": self.folder}}).execute(env=environment)
        outputs = {cell["id"]: cell.get("outputs", []) for cell in notebook.cells}
        for name in ("dem", "compare"):
            self.assertEqual([sorted(output.get("data", {})) for output in outputs[name]], [["image/png", "text/plain"]], name)
        self.assertEqual(outputs["profile"], [])
        self.assertTrue(os.path.exists(os.path.join(self.folder, "profile.png")))
        errors = eval(outputs["scans"][-1]["data"]["text/plain"])  # pylint: disable=eval-used
        self.assertLess(1.2 * errors["quiet"], errors["noisy"])


if __name__ == "__main__":
    unittest.main()
