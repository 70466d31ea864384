# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of the package, with the same exit codes as the tools."""


class Error(Exception):
    """Any error that landfall reports. `exit_code` is the exit code of a command that fails with it."""

    exit_code = 1


class DataError(Error):
    """A file is missing, unreadable, incomplete or of the wrong kind, or cannot be written."""


class UsageError(Error):
    """A bad option or configuration, or an output that exists. The message names file, key, value and bound."""

    exit_code = 2


class ToolError(Error):
    """A tool is missing or failed. The message is the tool's; `exit_code` is its exit code, or 1 if it did not start."""

    def __init__(self, message, exit_code=1):
        super().__init__(message)
        self.exit_code = exit_code
