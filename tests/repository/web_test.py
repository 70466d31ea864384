#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""python/landfall/web.py: the pages of lib/app/report/web, and what it refuses in small ones."""
import base64
import hashlib
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(os.environ["LANDFALL_ROOT"])
SCRIPT = ROOT / "python" / "landfall" / "web.py"
WEB = ROOT / "lib" / "app" / "report" / "web"
sys.path.insert(0, str(SCRIPT.parent))
import web  # pylint: disable=wrong-import-position

# Two pages, of which one needs the modules a and b.
MODULES = {"one.js": 'import {a} from "./a.js";\nimport {b} from "./b.js";\na(b);\n', "two.js": "let x = 1;\n",
           "a.js": 'import {b} from "./b.js";\n\n/** Adds b. */\nexport function a(x) {\n  return x + b;\n}\n', "b.js": "export const b = 2;\nconst c = b;\n"}


class Web(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(self.enterContext(tempfile.TemporaryDirectory(prefix="landfall-web-")))

    def write(self, **changes):
        files = {**MODULES, **{name.replace("_", "."): text for name, text in changes.items()}}
        for name, text in files.items():
            (self.folder / name).write_text(text, encoding="utf-8")

    def refused(self, message, **changes):
        self.write(**changes)
        with self.assertRaisesRegex(ValueError, message):
            web.check(self.folder, ("one", "two"))
            web.program(self.folder, "one")

    def test_modules_follow_those_that_they_import(self):
        self.write()
        web.check(self.folder, ("one", "two"))
        self.assertEqual(web.program(self.folder, "one"), '\n"use strict";\nconst b = 2;\nconst c = b;\n'
                         "\n/** Adds b. */\nfunction a(x) {\n  return x + b;\n}\na(b);\n")
        self.assertEqual(web.program(self.folder, "two"), '\n"use strict";\nlet x = 1;\n')

    def test_names_that_collide(self):
        self.refused("one.js and b.js both declare 'c', which the page one joins", one_js=MODULES["one.js"] + "function c() {}\n")
        self.refused("both declare 'a'", b_js=MODULES["b.js"] + "class a {}\n")
        self.write(two_js="let a = 1;\n")  # of different pages
        web.check(self.folder, ("one", "two"))

    def test_cycles(self):
        self.refused("modules import each other: a.js -> b.js -> a.js", b_js='import {a} from "./a.js";\nexport const b = a(1);\n')

    def test_exports_and_imports_that_do_not_match(self):
        self.refused("b.js: no module imports 'd', which it exports", b_js=MODULES["b.js"] + "export let d = 1;\n")
        self.refused("a.js: b.js does not export 'c'", a_js=MODULES["a.js"].replace("{b}", "{b, c}"), b_js=MODULES["b.js"])
        self.refused("c.js: no page needs it", a_js=MODULES["a.js"], c_js="")

    def test_forms_that_cannot_be_joined(self):
        for line in ('import a from "./a.js";', 'import * as a from "./a.js";', 'import "./a.js";', 'import {a} from "a";', "export default 1;",
                     "export {c};", 'export * from "./a.js";', 'const d = import("./a.js");', "const d = import.meta;", 'const d = "</script>";',
                     "const d = '<!--';"):
            self.refused("b.js: .* cannot be joined", b_js=MODULES["b.js"] + line + "\n")
        self.refused("b.js: a declaration at the top level must begin with a name", b_js=MODULES["b.js"] + "const {d} = {d: 1};\n")

    def test_a_style_with_the_name_of_a_place(self):
        self.write(page_html="@style@ @title@ @program@ @sections@", report_css="a {}\n", two_html="two @text@\n")
        self.assertEqual(web.template(self.folder, "two"), '\na {}\n @title@ \n"use strict";\nlet x = 1;\n two @text@\n')
        self.write(report_css="a::before { content: '@title@' }\n")
        with self.assertRaisesRegex(ValueError, "@title@ in the style would be replaced"):
            web.template(self.folder, "two")

    def test_the_reports(self):
        web.check(WEB)
        for page in web.PAGES:
            text = web.template(WEB, page)
            self.assertEqual(text.count("<script>"), 1)
            self.assertNotRegex(text, r"(?m)^(import|export)\b")

    def test_only_the_script_and_the_style_of_the_page_are_admitted(self):
        for page in web.PAGES:
            text = web.template(WEB, page)
            policy = re.search(r'Content-Security-Policy" content="([^"]*)"', text)[1]
            for directive, tag in (("script-src", "script"), ("style-src", "style")):
                content = re.search(f"(?s)<{tag}>(.*)</{tag}>", text)[1].encode()
                digest = base64.b64encode(hashlib.sha256(content).digest()).decode()
                self.assertEqual(re.search(f"{directive} ([^;]*)", policy)[1], f"'sha256-{digest}'")
            self.assertNotIn("unsafe", policy)
            self.assertIn("default-src 'none'", policy)
            # A policy with a hash of styles refuses attributes.
            self.assertNotIn("style=", text)

    def test_as_a_program(self):
        (self.folder / "web").symlink_to(WEB)
        made = subprocess.run([sys.executable, SCRIPT, "web", "out", "hazards"], cwd=self.folder, capture_output=True, text=True, check=True)
        self.assertEqual((made.stdout, made.stderr, os.listdir(self.folder / "out")), ("", "", ["hazards.html"]))
        self.assertEqual((self.folder / "out" / "hazards.html").read_text(encoding="utf-8"), web.template(WEB, "hazards"))
        bad = subprocess.run([sys.executable, SCRIPT, "none", "out", "hazards"], cwd=self.folder, capture_output=True, text=True, check=False)
        self.assertEqual((bad.returncode, bad.stderr), (1, "web.py: [Errno 2] No such file or directory: 'none/evaluation.js'\n"))


if __name__ == "__main__":
    unittest.main()
