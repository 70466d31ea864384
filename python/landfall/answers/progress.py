# SPDX-License-Identifier: GPL-3.0-or-later
"""How far a long run is: one line that is updated on a terminal, else a line for each report."""
import sys
import threading
import time

from landfall.errors import printable


class Progress:
    """Counts steps of a run. Steps that were found done do not enter the estimate of the time that is left."""

    def __init__(self, stream=None):
        self.stream = stream or sys.stderr
        self.live, self._lock = self.stream.isatty(), threading.Lock()
        self.begin, self.shown = time.monotonic(), False
        self.label, self.total, self.count, self.made = "", 0, 0, 0

    def start(self, label, total):
        """A part of the run with `total` steps."""
        self.label, self.total, self.count, self.made = label, total, 0, 0
        self.begin = time.monotonic()

    def step(self, made=1, found=0):
        """Steps that were made now, and such that an earlier run made."""
        with self._lock:
            self.made += made
            self.count += made + found
            self.say(f"{self.count} of {self.total} {self.label}{self._left()}")

    def _left(self):
        left = self.total - self.count
        if not self.made or left <= 0:
            return ""
        seconds = (time.monotonic() - self.begin) / self.made * left
        return f", about {seconds:.0f} s to go" if seconds < 120 else f", about {seconds / 60:.0f} min to go"

    def say(self, text):
        """A line of its own off the terminal."""
        end, self.shown = ("", True) if self.live else ("\n", False)
        text = printable(text)
        print(f"\r\033[K{text}" if self.live else text, end=end, file=self.stream, flush=True)

    def clear(self):
        if self.shown:
            print("\r\033[K", end="", file=self.stream, flush=True)
            self.shown = False
