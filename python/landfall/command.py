# SPDX-License-Identifier: GPL-3.0-or-later
"""Common parts of all commands: options, output paths, error messages and exit codes."""
import argparse
import csv
import importlib
import io
import os
import re
import sys
import threading

from landfall.errors import DataError, Error, UsageError, printable


class Parser(argparse.ArgumentParser):
    """An argument parser whose errors are one line, and whose values may be negative numbers or lists of these."""

    def __init__(self, *arguments, **keys):
        super().__init__(*arguments, **keys)
        self._negative_number_matcher = re.compile(r"-\.?\d")  # argparse takes "-5,3" for an option

    def error(self, message):
        raise UsageError(f"{message} (see --help)")


def run(main):
    """Calls main(arguments). An error becomes one line on stderr and the exit code."""
    name = os.path.basename(sys.argv[0])
    try:
        main(sys.argv[1:])
    except Error as error:
        print(f"{name}: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    except KeyboardInterrupt:
        print(f"{name}: interrupted", file=sys.stderr)
        sys.exit(130)
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        sys.exit(1)
    except OSError as error:
        print(f"{name}: {printable(error.filename or '')}: {error.strerror}", file=sys.stderr)
        sys.exit(1)
    except MemoryError:
        print(f"{name}: not enough memory for this run", file=sys.stderr)
        sys.exit(1)


def import_matplotlib():
    """Imports matplotlib without settings of others. By itself it takes those of a matplotlibrc in the current folder, which came with the data
    perhaps, and could run LaTeX, or else of the user. To be called before any other import of it."""
    os.environ["MATPLOTLIBRC"] = os.devnull
    here = os.open(os.curdir, os.O_PATH)
    try:
        os.chdir(os.sep)
        importlib.import_module("matplotlib")
    finally:
        os.fchdir(here)
        os.close(here)


def read_bytes(path, hint=""):
    """The content of a file. Throws DataError that names it, with `hint` at its end."""
    try:
        with open(path, "rb") as file:
            return file.read()
    except OSError as error:
        raise DataError(f"{path}: {error.strerror}{hint}") from error


def read_text(path, hint=""):
    return read_bytes(path, hint).decode(errors="replace")


def check_outputs(paths, overwrite, makes_folder=False):
    """Rejects outputs that could not be written, before any work is done. With makes_folder, their folder need not exist."""
    for path in paths:
        folder = os.path.dirname(path) or "."
        is_new = os.path.isdir(os.path.dirname(folder) or ".") and not os.path.exists(folder)
        if not os.path.isdir(folder) and not (makes_folder and is_new):
            raise UsageError(f"output {path}: folder {folder} does not exist")
        if os.path.isdir(path):
            raise UsageError(f"output {path} is a directory")
        if os.path.exists(path) and not os.path.isfile(path):
            raise UsageError(f"output {path} is not a regular file")
        if os.path.lexists(path) and not overwrite:
            raise UsageError(f"output {path} exists; use -O to overwrite it")


def sync(path):
    """Returns when the file's content is on the disk."""
    descriptor = os.open(path, os.O_RDONLY)
    try:
        os.fsync(descriptor)
    finally:
        os.close(descriptor)


def write_whole(path, write_to, is_synced=True):
    """Calls write_to(temporary name) and renames: `path` holds a complete file or what it held before, also after a crash
    and while other threads or processes write it.

    Without is_synced, the caller syncs many files at once.
    """
    temporary = os.path.join(os.path.dirname(path), f".{os.path.basename(path)}.{threading.get_native_id()}.part")
    try:
        write_to(temporary)
        if is_synced:
            sync(temporary)
        os.replace(temporary, path)
    finally:
        if os.path.exists(temporary):
            os.remove(temporary)


def write_text(path, text, is_synced=True):
    """write_whole() of a text, whose line feeds remain."""
    def write_to(name):
        with open(name, "w", encoding="utf-8", newline="") as file:
            file.write(text)
    write_whole(path, write_to, is_synced)


def csv_text(rows):
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows(rows)
    return text.getvalue()
