#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""tests/durations.csv: the tiers of this repository, and how scripts/keep-durations renews the file of a small project."""
import csv
import os
import pathlib
import shutil
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
LONGEST_OF_A_COMMIT_S = 20
TESTS = ("grew", "faster", "skipped", "not_run", "new", "quick")
BEFORE = "test,seconds,tier\ngrew,30,slow\nskipped,25,slow\nnot_run,20,commit\nfaster,9,commit\ndeleted,8,commit\n"
AFTER = "test,seconds,tier\ngrew,41,slow\nskipped,25,slow\nnot_run,20,commit\nnew,6,commit\n"
RUN = """<testsuite>
  <testcase name="grew" time="40.6" status="run"/>
  <testcase name="faster" time="4.9" status="run"/>
  <testcase name="skipped" time="0.5" status="notrun"/>
  <testcase name="new" time="6.2" status="run"/>
  <testcase name="quick" time="0.1" status="run"/>
</testsuite>
"""


class Durations(unittest.TestCase):
    def test_tiers_of_this_repository(self):
        with open(ROOT / "tests" / "durations.csv", encoding="utf-8") as file:
            rows = list(csv.DictReader(file))
        self.assertEqual({row["tier"] for row in rows}, {"commit", "slow"})
        self.assertEqual(len({row["test"] for row in rows}), len(rows))
        # A commit needs all unit tests.
        self.assertEqual([row["test"] for row in rows if row["test"].startswith("unit_") and row["tier"] != "commit"], [])
        slow = [row["test"] for row in rows if row["tier"] == "commit" and not row["test"].startswith("unit_")
                and int(row["seconds"]) > LONGEST_OF_A_COMMIT_S]
        self.assertEqual(slow, [], f"these take more than {LONGEST_OF_A_COMMIT_S} s: make them faster, or set their tier to slow")

    def test_keep_durations(self):
        with tempfile.TemporaryDirectory(prefix="landfall-durations-") as name:
            folder = pathlib.Path(name)
            (folder / "scripts").mkdir()
            (folder / "tests").mkdir()
            shutil.copy(ROOT / "scripts" / "keep-durations", folder / "scripts")
            (folder / "tests" / "durations.csv").write_text(BEFORE, encoding="utf-8")
            (folder / "CTestTestfile.cmake").write_text("".join(f"add_test({test} true)\n" for test in TESTS), encoding="utf-8")
            (folder / "durations.xml").write_text(RUN, encoding="utf-8")
            subprocess.run([str(folder / "scripts" / "keep-durations"), name], check=True)
            self.assertEqual((folder / "tests" / "durations.csv").read_text(encoding="utf-8"), AFTER)


if __name__ == "__main__":
    unittest.main()
