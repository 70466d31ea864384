# SPDX-License-Identifier: GPL-3.0-or-later
"""Where the tools and their data are, and how they are run."""
import os
import shutil
import subprocess

from landfall.errors import ToolError

# Holds python/, schemas/ and studies/: a clone, or PREFIX/share/landfall.
SHARE = os.path.dirname(os.path.dirname(os.path.dirname(os.path.realpath(__file__))))
IS_CLONE = os.path.exists(os.path.join(SHARE, "CMakeLists.txt"))
BIN = os.path.normpath(os.path.join(SHARE, "build/release/bin" if IS_CLONE else "../../bin"))


def find(tool, folder=None):
    """The path of a tool: in the folder given, else beside this package's installation, else on PATH."""
    path = os.path.join(folder or BIN, tool)
    found = path if os.access(path, os.X_OK) else None if folder else shutil.which(tool)
    if found is None:
        raise ToolError(f"{path}: no such program" + ("" if folder else ", and none on PATH"))
    return found


def run_tool(path, *arguments, **options):
    """Runs a program and returns what it printed. Throws ToolError with its message where it fails."""
    try:
        result = subprocess.run([path, *map(str, arguments)], capture_output=True, text=True, check=False, **options)
    except OSError as error:
        raise ToolError(f"{path}: {error.strerror}") from error
    if result.returncode != 0:
        raise ToolError(result.stderr.strip() or f"{path}: exit code {result.returncode}", result.returncode)
    return result
