#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The time that --help takes. ctest runs this test alone, because other tests would slow it down."""
import subprocess
import time
import unittest

from harness import SANITIZED, TOOLS, tool


class HelpTime(unittest.TestCase):
    @unittest.skipIf(SANITIZED, "sanitizers are slow")
    def test_help_answers_in_under_50_ms(self):
        for name in TOOLS:
            times = []
            for _ in range(10):
                start = time.perf_counter()
                subprocess.run([tool(name), "--help"], stdout=subprocess.DEVNULL, check=True)
                times.append(time.perf_counter() - start)
            self.assertLess(min(times), 0.05, name)


if __name__ == "__main__":
    unittest.main()
