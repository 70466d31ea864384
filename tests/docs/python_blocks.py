#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The Python blocks of a page, in one interpreter: each line of the input names a working folder, a block's file and the file to which what the
block prints is appended; its exit code is printed when it has ended."""
import os
import sys
import traceback

names = {"__name__": "__main__"}
answers = os.fdopen(os.dup(1), "w", encoding="utf-8")
for line in sys.stdin:
    folder, path, output = line.rstrip("\n").split("\t")
    os.chdir(folder)
    with open(path, encoding="utf-8") as file, open(output, "ab") as printed:
        os.dup2(printed.fileno(), 1)
        os.dup2(printed.fileno(), 2)
        code = 0
        try:
            exec(compile(file.read(), path, "exec"), names)  # pylint: disable=exec-used
        except BaseException:  # pylint: disable=broad-except
            traceback.print_exc()
            code = 1
        sys.stdout.flush()
        sys.stderr.flush()
    print(code, file=answers, flush=True)
