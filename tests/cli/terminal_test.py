#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The output of the tools on a terminal, here a pseudo-terminal, and what options suppress."""
import fcntl
import os
import pty
import struct
import subprocess
import termios
import unittest

from harness import TOOLS, ChainTest, read_bytes, tool


def read_all(descriptor):
    chunks = []
    while True:
        try:
            chunk = os.read(descriptor, 65536)
        except OSError:  # the other end is closed
            break
        if not chunk:
            break
        chunks.append(chunk)
    return b"".join(chunks).decode()


def open_terminal():
    """Both ends of a pseudo-terminal; skips the test if the machine has none (a bare chroot)."""
    try:
        return pty.openpty()
    except OSError as error:
        raise unittest.SkipTest(f"no pseudo-terminal: {error}") from error


class Terminal(ChainTest):
    def on_terminal(self, name, *arguments, streams=("stdout", "stderr")):
        """Runs the tool with these streams on a terminal and the others discarded; returns the text on the terminal."""
        ours, theirs = open_terminal()
        ends = {stream: theirs if stream in streams else subprocess.DEVNULL for stream in ("stdout", "stderr")}
        command = [tool(name), *self.chain.inputs(name), "-o", self.path("out.h5"), "-O", *arguments]
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, **ends) as process:
            os.close(theirs)
            text = read_all(ours)
        os.close(ours)
        self.assertEqual(process.returncode, 0, text)
        self.assertEqual(read_bytes(self.path("out.h5")), read_bytes(self.chain.output(name)))
        return text

    PHASE = {"terrain-gen": "terrain", "scan-sim": "trace", "regrid": "grid", "dem-eval": "evaluate", "hazard-map": "judge",
             "monte-carlo": "draw"}

    def test_progress_appears_on_a_terminal(self):
        for name in TOOLS:
            text = self.on_terminal(name, streams=["stderr"])
            self.assertRegex(text, rf"{self.PHASE[name]} +\[#{{30}}\] 100 %")

    def test_quiet_and_no_progress_suppress_progress(self):
        for name in TOOLS:
            self.assertEqual(self.on_terminal(name, "-q", streams=["stderr"]), "", name)
            self.assertRegex(self.on_terminal(name, "--no-progress", streams=["stderr"]), rf"\A{name}: [^\n]+\n\Z")

    def test_the_result_is_the_last_line(self):
        for name in TOOLS:
            text = self.on_terminal(name, streams=["stderr"])
            self.assertRegex(text.splitlines()[-1], rf"{name}: .*(nodes|returns|bins are empty|FAIL|best site|draws pass)")

    def printed(self, *command, columns=80):
        """The text that a command prints on the stdout of a terminal of so many columns."""
        ours, theirs = open_terminal()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 50, columns, 0, 0))
        with subprocess.Popen([tool(command[0]), *command[1:]], stdin=subprocess.DEVNULL, stdout=theirs, stderr=subprocess.DEVNULL) as process:
            os.close(theirs)
            text = read_all(ours)
        os.close(ours)
        self.assertEqual(process.returncode, 0, text)
        return text.replace("\r\n", "\n")

    def test_a_judge_needs_no_option(self):
        judged = self.printed("dem-eval", *self.chain.inputs("dem-eval"))
        self.assertRegex(judged, r"(?m)^requirement +measured +limit +verdict")
        self.assertEqual(self.printed("dem-eval", *self.chain.inputs("dem-eval"), "--metrics-only"), judged)
        self.assertRegex(self.printed("hazard-map", *self.chain.inputs("hazard-map")), r"(?m)^site +x, m +y, m")
        self.assertEqual(self.entries(), [])

    def test_text_ends_at_the_last_column_and_before_a_number(self):
        for name in TOOLS:
            complete = subprocess.run([tool("landfall-info"), self.chain.output(name)], capture_output=True, text=True, check=True).stdout
            for columns in (60, 67, 80, 200):
                lines = self.printed("landfall-info", self.chain.output(name), columns=columns).splitlines()
                self.assertEqual([], [line for line in lines if len(line) > columns and "..." in line])
                for line in lines:
                    if line.endswith("..."):
                        [whole] = [text for text in complete.splitlines() if text.startswith(line[:-3])][:1]
                        cut = len(line) - 3
                        self.assertFalse(whole[cut - 1].isdigit() and whole[cut].isdigit() and " " in line[columns // 2:], line)

    def test_progress_can_be_forced_off_a_terminal(self):
        for name in TOOLS:
            result = subprocess.run([tool(name), *self.chain.inputs(name), "-o", self.path("out.h5"), "-O",
                                     "--progress"], capture_output=True, text=True, check=True)
            self.assertEqual(result.stdout, "")
            self.assertIn("100 %", result.stderr)

    def test_only_judges_print_on_stdout_their_tables(self):
        for name in TOOLS:
            text = self.on_terminal(name, streams=["stdout"])
            if name == "dem-eval":
                self.assertRegex(text, r"requirement +measured +limit +verdict")
                self.assertRegex(text, r"relative_elevation .* FAIL")
            elif name == "hazard-map":
                self.assertRegex(text, r"(?s)place +bins +share.*missed hazards")
            elif name == "monte-carlo":
                self.assertRegex(text, r"(?s)requirement +passed +draws.*\nall +0 of 2 ")
            else:
                self.assertEqual(text, "")

    def test_quiet_suppresses_the_table(self):
        for name in ("dem-eval", "hazard-map", "monte-carlo"):
            self.assertEqual(self.on_terminal(name, "-q", streams=["stdout"]), "")

    def test_an_error_has_its_own_line(self):
        """The message appears below the progress bar or replaces it."""
        ours, theirs = open_terminal()
        command = [tool("scan-sim"), *self.chain.inputs("scan-sim"), "-o", self.path("out.h5"), "--set",
                   "noise.dropout_frac=1"]
        with subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=theirs) as process:
            os.close(theirs)
            text = read_all(ours)
        os.close(ours)
        self.assertEqual(process.returncode, 1)
        self.assertRegex(text, r"(\n|\r\x1b\[K)scan-sim: the scan has no return[^\n]*\n\Z")


if __name__ == "__main__":
    unittest.main()
