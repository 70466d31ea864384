#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""How error paths are found in a source, and told apart by llvm-cov's regions."""
import contextlib
import io
import json
import os
import tempfile
import unittest
from unittest import mock

import page

SOURCE = """// throw in a comment
int f(int a) {
  if (a < 0) throw Error("throw in a text");
  try {
    return g(a);
  } catch (const Error& error) {
    return h(error);
  }
  if (a > 9)
    throw Error("twice");
  throw Error("twice");
}
"""
# [line, column, count, counted, begins, gap]: everything ran but the throw of line 3, the handler and what follows it.
RECORD = {"segments": [[2, 14, 5, True, True, False], [3, 14, 0, True, True, False], [3, 44, 5, True, False, False],
                       [6, 32, 0, True, True, False], [8, 4, 0, True, False, False], [12, 2, 0, False, False, False]],
          "summary": {kind: {"count": 10, "covered": 6} for kind in ("lines", "branches", "functions")}}
KEYS = ['throw Error("throw in a text")', "catch (const Error& error) { return h(error)", 'throw Error("twice")', 'throw Error("twice") #2']


class Coverage(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = folder.name
        os.makedirs(os.path.join(self.root, "lib", "io"))
        os.makedirs(os.path.join(self.root, "docs", "quality"))
        self.put("lib/io/f.cpp", SOURCE)
        self.put("docs/quality/coverage.md", "# Page\n\n## Results\n\nold\n\n## Error paths that no test runs\n\nold\n\n## After\n\nkept\n")

    def put(self, name, text):
        with open(os.path.join(self.root, name), "w", encoding="utf-8") as file:
            file.write(text)

    def test_error_paths_are_found_outside_comments_and_texts(self):
        self.assertEqual([key for _, _, key in page.error_paths(SOURCE)], KEYS)

    def test_what_never_ran(self):
        missed, total = page.uncovered_paths(self.root, {"lib/io/f.cpp": RECORD})
        self.assertEqual([(path, key) for path, _, key in missed], [("lib/io/f.cpp", key) for key in KEYS])
        self.assertEqual(total, {"lib/io": 4})
        ran = {**RECORD, "segments": [[2, 14, 5, True, True, False]]}
        self.assertEqual(page.uncovered_paths(self.root, {"lib/io/f.cpp": ran}), ([], {"lib/io": 4}))

    def test_the_page_asks_a_reason_for_each_and_keeps_the_rest(self):
        reasons = os.path.join(self.root, "uncovered.json")

        def write(known):
            with open(reasons, "w", encoding="utf-8") as file:
                json.dump({f"lib/io/f.cpp: {key}": "a reason" for key in known}, file)
            with mock.patch.object(page, "REASONS", reasons), contextlib.redirect_stdout(io.StringIO()) as out:
                return page.write(self.root, {"lib/io/f.cpp": RECORD}), out.getvalue()
        self.assertEqual(write(KEYS), (0, ""))
        with open(os.path.join(self.root, "docs", "quality", "coverage.md"), encoding="utf-8") as file:
            text = file.read()
        self.assertIn("| lib/io | 10 | 60.0 % | 10 | 60.0 % | 10 | 60.0 % | 4 | 0.0 % |\n", text)
        self.assertIn(f"| `{KEYS[1]}` | a reason |\n", text)
        self.assertTrue(text.endswith("\n## After\n\nkept\n"))
        self.assertNotIn("old", text)
        self.assertEqual(write(KEYS[1:]), (1, f"lib/io/f.cpp:3: {KEYS[0]}\n"))
        self.assertEqual(write([*KEYS, "gone"]), (1, "runs, or is no more: lib/io/f.cpp: gone\n"))

    def test_what_fuzz_targets_reach_by_library(self):
        self.put("docs/quality/fuzzing.md", "# Page\n\n## What it reaches\n\nold\n\n## After\n")
        page.write_fuzz(self.root, {"config": {"lib/io/f.cpp": RECORD, "lib/io/g.h": RECORD}, "mesh": {"lib/ray/h.cpp": RECORD}})
        with open(os.path.join(self.root, "docs", "quality", "fuzzing.md"), encoding="utf-8") as file:
            self.assertEqual(file.read(), "# Page\n\n## What it reaches\n\n| | `fuzz_config` | `fuzz_mesh` |\n|---|---|---|\n"
                             "| lib/io | 60.0 % of 20 |  |\n| lib/ray |  | 60.0 % of 10 |\n\n## After\n")

    def test_lines_that_never_ran(self):
        with contextlib.redirect_stdout(io.StringIO()) as out:
            page.print_lines(self.root, "lib/io/f.cpp", RECORD)
        self.assertEqual([int(line.split(":")[1]) for line in out.getvalue().splitlines()], [3, 6, 7, 8, 9, 10, 11, 12])


if __name__ == "__main__":
    unittest.main()
