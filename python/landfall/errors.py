# SPDX-License-Identifier: GPL-3.0-or-later
"""Errors of the package, with the same exit codes as the tools, and texts as they may be printed."""
import re

# Characters that could move the cursor, change colours or hide, reverse or imitate others, as in lib/base/text/shown_text.cpp; and bytes of
# file names that are not UTF-8, which Python keeps as surrogates.
_HIDDEN = re.compile("[\x00-\x1f\x7f-\x9f\xad\u061c\u180e\u200b-\u200f\u2028-\u202e\u2060-\u206f\ufeff\ufff9-\ufffb\ud800-\udfff]")


def printable(text: object) -> str:
    """A text from anywhere as it may be printed, on one line: control characters, marks of bidirectional text and characters without
    width become their escapes, such as \\u001b. Everything that a command prints passes through here."""
    return _HIDDEN.sub(_escape, str(text))


def printable_lines(text: object) -> str:
    """printable() of each line."""
    return "\n".join(map(printable, str(text).split("\n")))


def _escape(found: re.Match[str]) -> str:
    code = ord(found.group())
    return f"\\x{code - 0xdc00:02x}" if 0xdc80 <= code <= 0xdcff else f"\\u{code:04x}"


class Error(Exception):
    """Any error that landfall reports, on one line that may be printed. `exit_code` is the exit code of a command that fails with it."""

    exit_code = 1

    def __init__(self, message: object) -> None:
        super().__init__(printable(message))


class DataError(Error):
    """A file is missing, unreadable, incomplete or of the wrong kind, or cannot be written."""


class UsageError(Error):
    """A bad option or configuration, or an output that exists. The message names file, key, value and bound."""

    exit_code = 2


class ToolError(Error):
    """A tool is missing or failed. The message is the tool's; `exit_code` is its exit code, or 1 if it did not start."""

    def __init__(self, message: object, exit_code: int = 1) -> None:
        super(Error, self).__init__(printable_lines(message))  # a tool may print several lines
        self.exit_code = exit_code
