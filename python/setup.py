# SPDX-License-Identifier: GPL-3.0-or-later
# The package reads schemas, presets and the reports' scripts, which lie next to python/ in a clone: an installed package has copies in landfall/share.
# The build keeps its files in a temporary folder, so that the clone stays as it is.
"""Builds the Python package from a clone (pyproject.toml)."""
import atexit
import os
import re
import shutil
import tempfile

from setuptools import setup
from setuptools.command.build_py import build_py

CLONE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..")
DATA = ("schemas", "studies/presets", "lib/app/report/web")


def version():
    path = os.path.join(CLONE, "CMakeLists.txt")
    if not os.path.exists(path):
        raise SystemExit("landfall's package is built from a clone: there is no CMakeLists.txt next to the folder python")
    with open(path, encoding="utf-8") as file:
        return re.search(r"project\(landfall VERSION ([\d.]+)", file.read())[1]


def scratch(name):
    folder = tempfile.mkdtemp(prefix=f"landfall-{name}-")
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


class BuildWithData(build_py):
    """Copies the files that the package reads into it."""

    def run(self):
        super().run()
        for name in DATA:
            shutil.copytree(os.path.join(CLONE, name), os.path.join(self.build_lib, "landfall", "share", name), dirs_exist_ok=True)


setup(version=version(), cmdclass={"build_py": BuildWithData}, options={"build": {"build_base": scratch("build")}, "egg_info": {"egg_base": scratch("info")}})
