# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the programs of python/commands as a user does."""
import os
import subprocess

COMMANDS = os.path.join(os.environ["LANDFALL_ROOT"], "python", "commands")


def run_command(name, *arguments, cwd=None):
    """The completed process of NAME.py, with its texts."""
    return subprocess.run([os.path.join(COMMANDS, name + ".py"), *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False, cwd=cwd)
