# SPDX-License-Identifier: GPL-3.0-or-later
"""Runs the programs of python/commands as a user does."""
import os
import runpy
import subprocess
import sys
import tempfile
import traceback

import h5py  # pylint: disable=unused-import
import matplotlib.pyplot  # pylint: disable=unused-import

from harness import fork

COMMANDS = os.path.join(os.environ["LANDFALL_ROOT"], "python", "commands")


def run_command(name, *arguments, cwd=None):
    """The completed process of NAME.py, with its texts. It is forked from this one, whose libraries it has at hand: to import them takes
    longer than most commands. The package landfall is imported as if for the first time."""
    words = [os.path.join(COMMANDS, name + ".py"), *map(str, arguments)]
    with tempfile.TemporaryFile("w+", encoding="utf-8") as out, tempfile.TemporaryFile("w+", encoding="utf-8") as err:
        sys.stdout.flush()
        sys.stderr.flush()
        process = fork()
        if process == 0:
            become(words, cwd, out, err)
        code = os.waitstatus_to_exitcode(os.waitpid(process, 0)[1])
        out.seek(0)
        err.seek(0)
        return subprocess.CompletedProcess(words, code, out.read(), err.read())


def become(words, cwd, out, err):
    """Runs the program in this process and ends it, as the interpreter does."""
    code = 1
    try:
        os.dup2(out.fileno(), 1)
        os.dup2(err.fileno(), 2)
        sys.stdout, sys.stderr = open(1, "w", encoding="utf-8", closefd=False), open(2, "w", encoding="utf-8", closefd=False)
        os.chdir(cwd or os.curdir)
        for module in [module for module in sys.modules if module.split(".")[0] == "landfall"]:
            sys.modules.pop(module, None)
        sys.argv, sys.path[0] = words, os.path.dirname(COMMANDS)
        runpy.run_path(words[0], run_name="__main__")
        code = 0
    except SystemExit as end:
        code = end.code if isinstance(end.code, int) else 0 if end.code is None else 1
        if isinstance(end.code, str):
            print(end.code, file=sys.stderr)
    except BaseException:  # pylint: disable=broad-except
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(code)
