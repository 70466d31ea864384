#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""eslint and tsc, as scripts/lint web runs them: nothing is wrong with lib/app/report/web, and they find what is."""
import os
import pathlib
import subprocess
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
MODULES = ROOT / "tests" / "web" / "node_modules" / ".bin"


def run(*command, stdin="", cwd=ROOT):
    result = subprocess.run(list(map(str, command)), cwd=cwd, input=stdin, capture_output=True, text=True, check=False)
    return result.returncode, result.stdout + result.stderr


@unittest.skipUnless((MODULES / "eslint").exists() and (MODULES / "tsc").exists(), "needs eslint and tsc: npm ci --prefix tests/web")
class Lint(unittest.TestCase):
    def test_the_reports(self):
        self.assertEqual(run(ROOT / "scripts" / "lint", "web"), (0, ""))

    def test_eslint_finds_faults(self):
        for text, rule in (("call(undeclared);", "no-undef"), ("const unused = 1;", "no-unused-vars"), ("export const a = 1, b = 2;", "one name at a time"),
                           ("{\n  document.title = '';\n}", "No block at the top level"), ("document.body.innerHTML = '';", "no-restricted-properties"),
                           ("import * as all from './map.js';\nall.draw();", "no-restricted-syntax")):
            code, output = run(MODULES / "eslint", "--config", "tests/web/eslint.config.mjs", "--stdin", "--stdin-filename", "lib/app/report/web/x.js",
                               stdin=text + "\n")
            self.assertEqual(code, 1, output)
            self.assertIn(rule, output)

    def test_tsc_finds_faults(self):
        with tempfile.TemporaryDirectory(prefix="landfall-lint-") as folder:
            pathlib.Path(folder, "tsconfig.json").write_text(f'{{"extends": "{ROOT}/tests/web/tsconfig.json", "include": ["*.js"]}}', encoding="utf-8")
            pathlib.Path(folder, "x.js").write_text("/** @param {number} x */\nexport function half(x) { return x / 2; }\nhalf('a');\n", encoding="utf-8")
            code, output = run(MODULES / "tsc", "--project", folder)
        self.assertNotEqual(code, 0)
        self.assertIn("x.js(3,6): error TS2345", output)


if __name__ == "__main__":
    unittest.main()
