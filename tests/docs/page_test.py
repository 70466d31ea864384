#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Tests of the documentation tests themselves, with correct and wrong pages."""
import contextlib
import io
import tempfile
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

    def test_files(self):
        self.assertIsNone(verdict(block("csv", "a,b", "file: folder/t.csv") + block("sh", '[[ "$(cat folder/t.csv)" == a,b ]]')))

    def test_python_blocks_see_earlier_blocks(self):
        text = block("python", "import math\nprint('first')\ndef f():\n    return math.pi") + block("python", "print(round(f(), 2))")
        self.assertIsNone(verdict(text + block("text", "3.14", "output")))
        self.assertIn("NameError", verdict(block("python", "g()")))

    def test_configurations(self):
        self.assertIsNone(verdict(block("json", '{"half_width_m": 5}', "check: regrid")))
        self.assertIn("half_width", verdict(block("json", '{"half_width": 5}', "check: regrid")))


class HiddenInputs(unittest.TestCase):
    def found(self, text):
        return pages.Page("x.md", text).hidden_inputs()

    def test_a_file_that_only_a_hidden_command_makes(self):
        text = "<!-- setup: make_raster.py -o raster.tif -->\n```sh\nterrain-gen --from raster.tif -o site.h5\n```\n"
        self.assertEqual(self.found(text), [(3, "raster.tif")])
        visible = "```sh\nmake_raster.py -o raster.tif\n```\n"
        self.assertEqual(self.found(visible + text), [])
        self.assertEqual(self.found("<!-- file: raster.tif -->\n```text\nx\n```\n" + text), [])

    def test_the_reader_s_own_files(self):
        text = "<!-- setup: make_raster.py -o raster.tif -->\n<!-- yours: raster.tif -->\n```sh\nterrain-gen --from raster.tif\n```\n"
        self.assertEqual(self.found(text), [(4, "raster.tif")], "the prose must name it")
        self.assertEqual(self.found("Your raster is `raster.tif`.\n\n" + text), [])
        self.assertEqual(self.found("<!-- setup: small_chain; echo dem.h5 -->\n```sh\ndem-eval dem.h5\n```\n"), [])


class Typing(unittest.TestCase):
    def typed(self, text):
        with tempfile.TemporaryDirectory() as folder, contextlib.redirect_stderr(io.StringIO()):
            reader = type_pages.Reader(folder, folder)
            reader.read("made.md", text)
        return reader.faults, reader.notes

    def test_a_page_that_says_everything(self):
        page = ("One file:\n\n" + block("json", '{"a": 1}') + block("sh", 'A=2; grep -o 1 one.json; echo "<$A>"') + block("text", "1\n<2>") + block("sh", "echo $A; echo 3; echo 4") +
                block("text", "2\n...\n4") + block("python", "a = 5") + block("python", "print(a)") + block("text", "5") + block("sh", "scripts/test  # all"))
        faults, notes = self.typed(page)
        self.assertEqual((faults, len(notes)), ([], 1))
        self.assertRegex(notes[0], "scripts/test .*: not typed")

    def test_what_comments_hide_is_not_there(self):
        [fault] = self.typed(block("sh", "cat made.txt", "setup: echo 1 > made.txt"))[0]
        self.assertRegex(fault, r"block 1 \(cat made.txt\): exit 1\n.*No such file")

    def test_another_output_is_a_fault(self):
        [fault] = self.typed(block("sh", "echo 1; echo 2") + block("text", "1\n3"))[0]
        self.assertRegex(fault, "(?s)block 2.*-3\n\\+2$")


if __name__ == "__main__":
    unittest.main()
