#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the documentation tests themselves, with correct and wrong pages."""
import contextlib
import io
import re
import unittest
from unittest import mock

import page as pages
import run_docs_test
import structure_test
import type_pages


def block(language, text, *notes):
    return "".join(f"<!-- {note} -->\n" for note in notes) + f"```{language}\n{text}\n```\n\n"


def run(text):
    page = pages.Page("docs/made.md", text)
    return page, run_docs_test.Run(page)


def verdict(text):
    """The error that run_docs_test reports; None without one."""
    page, done = run(text)
    try:
        run_docs_test.Commands().check(page, done)
    except AssertionError as error:
        return str(error)
    return None


class Reading(unittest.TestCase):
    def test_blocks_have_their_line_and_annotations(self):
        page = pages.Page("made.md", "# A\n\n" + block("sh", "true", "setup: a\nb", "bare: slow") + block("json", "{}", "check: regrid"))
        self.assertEqual([(b.language, b.line, b.text) for b in page.blocks], [("setup", 3, "a\nb\n"), ("sh", 7, "true\n"), ("json", 12, "{}\n")])
        self.assertEqual([b.is_run for b in page.blocks], [True, False, False])
        self.assertEqual(page.faults, [])

    def test_faults(self):
        for text in ("<!-- chek: regrid -->\n", "<!-- not run: slow -->\n```sh\ntrue\n```\n", "<!-- output -->\ntext\n", "```sh\ntrue\n", "<!-- check: regrid -->\n"):
            with self.subTest(text):
                self.assertEqual(len(pages.Page("made.md", text).faults), 1)

    def test_anchors_and_links(self):
        page = pages.Page("made.md", "# `regrid --x`, a test\n\n## Twice\n\n## Twice\n\n[a](b.md#c) ![d](e.png) `[f](g)` [h](https://i)\n")
        self.assertEqual(page.anchors(), {"regrid---x-a-test", "twice", "twice-1"})
        self.assertEqual(page.links(), [(7, "b.md#c"), (7, "e.png")])

    def test_commands_outside_of_blocks_are_found(self):
        for line in ("    regrid scan.h5 -o dem.h5", "    make -f Makefile.studies", "    python/commands/plot_dem.py dem.h5", "    ./build", "    $ ls -l"):
            self.assertRegex(line, structure_test.COMMAND)
        for line in ("    z = height_m", "regrid makes a map", "    regrids and others"):
            self.assertNotRegex(line, structure_test.COMMAND)


class Running(unittest.TestCase):
    def test_blocks_share_a_shell_and_a_folder(self):
        self.assertIsNone(verdict(block("sh", "a=1; echo text > file", "setup: b=2") + block("sh", '[[ $a$b == 12 && "$(cat file)" == text ]]')))

    def test_a_failure_names_line_command_and_message(self):
        for text in ("false", "ls missing-file", "echo $unset", "false | true"):
            with self.subTest(text):
                self.assertIn("docs/made.md:6: exit ", verdict(block("sh", "true") + block("sh", text)))
        self.assertIn("missing-file", verdict(block("sh", "ls missing-file")))
        self.assertIn("line 7", verdict(block("sh", "true") + block("sh", "true\nls() { $unset; }\nls")))

    def test_blocks_that_run_elsewhere(self):
        self.assertIsNone(verdict(block("sh", "false", "bare: name") + block("sh", "false", "all tests") + block("text", "false")))

    def test_long_blocks_run_on_request(self):
        text = block("sh", "[[ $a == 1 ]] && sleep 0.1 && echo slow", "setup: a=0", "long setup: a=1", "long: reason") + block("text", "slow", "output")
        wrong = text.replace("```text\nslow", "```text\nquick")
        with mock.patch.object(pages, "LONG", False):
            self.assertIsNone(verdict(text))
            self.assertIsNone(verdict(wrong))
            self.assertIsNone(verdict(block("sh", "false", "long: reason")))
        with mock.patch.object(pages, "LONG", True):
            self.assertIsNone(verdict(text))
            self.assertIn("docs/made.md:10: the page shows", verdict(wrong))
            self.assertIn("docs/made.md:3: exit 1", verdict(block("sh", "false", "long: reason")))
            _, done = run(text)
            self.assertGreater(done.seconds[2], 0.09)

    def test_shown_output_must_be_the_output(self):
        self.assertIsNone(verdict(block("sh", "echo one; echo two") + block("text", "one\ntwo", "output")))
        self.assertIsNone(verdict(block("sh", "seq 5") + block("text", "1\n...\n5", "output")))
        self.assertIn("docs/made.md:7", verdict(block("sh", "echo one; echo two") + block("text", "one", "output")))
        self.assertIn("docs/made.md:7", verdict(block("sh", "seq 5") + block("text", "1\n...\n4", "output")))

    def test_ids_and_revisions_may_differ(self):
        command = "echo 'regrid 0.1.0 (git 08323fd) 7ca041163144 of 10 m'"
        self.assertIsNone(verdict(block("sh", command) + block("text", "regrid 0.1.0 (git v1-2) 4fee806301ff of 10 m", "output")))
        self.assertIn("docs/made.md:7", verdict(block("sh", command) + block("text", "regrid 0.1.0 (git v1-2) 4fee806301ff of 11 m", "output")))

    def test_a_file_has_the_name_that_the_page_shows(self):
        check = block("sh", '[[ "$(cat folder/t.csv)" == a,b ]]')
        self.assertIsNone(verdict("Some rows; save them\nas `folder/t.csv`:\n\n" + block("csv", "a,b") + check))
        self.assertIn("No such file", verdict("Save as `folder/t.csv`:\n\nRows:\n\n" + block("csv", "a,b") + check))

    def test_python_blocks_see_earlier_blocks(self):
        text = block("python", "import math\nprint('first')\ndef f():\n    return math.pi") + block("python", "print(round(f(), 2))")
        self.assertIsNone(verdict(text + block("text", "3.14", "output")))
        self.assertIn("NameError", verdict(block("python", "g()")))

    def test_configurations(self):
        self.assertIsNone(verdict(block("json", '{"half_width_m": 5}', "check: regrid")))
        self.assertIn("half_width", verdict(block("json", '{"half_width": 5}', "check: regrid")))


class FromNothing(unittest.TestCase):
    def test_a_page_begins_in_an_empty_folder_or_in_a_clone(self):
        self.assertIsNone(verdict(block("sh", '[[ -z "$(ls -A)" ]]')))
        self.assertIsNone(verdict("In a clone:\n\n" + block("sh", "ls Makefile.studies studies/noise.json")))

    def test_a_setup_makes_and_removes_no_file(self):
        for setup in ("echo 1 > a", "rm a", "mv a b", "cat() { :; }; echo 1 > b/c"):
            with self.subTest(setup):
                self.assertIn("a setup makes files", verdict(block("sh", "echo 1 > a; mkdir b") + block("sh", "cat a", f"setup: {setup}")))
        self.assertIsNone(verdict(block("sh", "size=9; count", "setup: count() { [[ $size == 9 ]]; }")))

    def test_a_page_as_shown(self):
        page = block("sh", "echo $a", "setup: a=2", "long: minutes") + block("text", "1", "output")
        for before, expected in (("a=1", None), ("a=3", "the page shows"), ("scripts/no", "exit 127")):
            with self.subTest(before), mock.patch.object(pages, "LONG", True):
                fault = type_pages.fault_of(pages.Page("docs/made.md", block("sh", before) + page))
                self.assertIn(expected, fault) if expected else self.assertIsNone(fault)

    def test_blocks_that_are_not_typed(self):
        with contextlib.redirect_stdout(io.StringIO()) as printed:
            self.assertIsNone(type_pages.fault_of(pages.Page("x.md", block("sh", "false", "long: builds") + block("sh", "exit 3")), re.compile("exit")))
        self.assertEqual(printed.getvalue(), "note: x.md:3: not typed: builds\nnote: x.md:7: not typed: skipped\n")


if __name__ == "__main__":
    unittest.main()
