# SPDX-License-Identifier: GPL-3.0-or-later
"""Parses a page of the documentation: its fenced blocks, the comments that annotate them, headings and links.

A page says what a reader needs: the test begins in an empty folder, or in a clone of the repository if the prose names "a clone". A paragraph with
"Save as `NAME`" or "saved as" makes the next block the content of that file.

tests/docs/notes has, under the name of the page, the comments of its blocks, each below `## ` and the first line of its block (`(2)` behind
it: of the second block that begins so); its `setup.sh` in a folder is the first setup of each page of that folder. A comment on its own line of the page itself annotates the next block too:

    <!-- setup: COMMANDS -->      shell functions, on one or more lines, that make commands of the page smaller; they make no file, and
                                  type_pages.py, which runs a page as it is shown, leaves them out
    <!-- long: REASON -->         the next block runs only with LANDFALL_TEST_LONG=1; otherwise it is listed as skipped
    <!-- long setup: COMMANDS --> setup commands for such blocks, run only together with them
    <!-- bare: NAME -->           scripts/test-deb or test-container runs the next block in a bare Debian 12 (bare_block.py)
    <!-- all tests -->            the next block runs all tests, including this one; .ci/run runs it
    <!-- check: TOOL -->          the next block is a configuration that TOOL --check must accept
    <!-- output -->               the next block is the output of the previous one; a line `...` matches any lines, and
                                  revisions, ids and file sizes may differ
    <!-- full output -->          the same, of a command that a setup makes smaller: only type_pages.py compares it

and one gives a line that only the site shows (scripts/docs):

    <!-- site: MARKDOWN -->
"""
import collections
import os
import re

ROOT = os.environ.get("LANDFALL_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
FENCE = re.compile(r"^( *)```(\w*) *$")
COMMENT = re.compile(r"^<!-- (setup|long setup|long|bare|all tests|check|output|full output|site)(?:: *(.*))?$", re.DOTALL)
LINK = re.compile(r"(!?)\[(?:[^\[\]]|\[[^\]]*\])*\]\(([^()\s]+)\)")
RUN_LANGUAGES = ("sh", "python")
NOTES = os.path.join(ROOT, "tests", "docs", "notes")
SAVED = re.compile(r"\b[Ss]aved?\b[^`.:]*\bas `([\w./-]+)`")
RUN_ELSEWHERE = {"bare", "all tests"}
LONG = bool(os.environ.get("LANDFALL_TEST_LONG"))


class Block:
    """A fenced block, or the commands of a setup comment (languages `setup` and `long setup`)."""

    def __init__(self, language, line, text, notes):
        self.language, self.line, self.text, self.notes = language, line, text, notes

    @property
    def is_command(self):
        """True if the block shows commands to a reader."""
        return self.language in RUN_LANGUAGES and "file" not in self.notes

    @property
    def is_run(self):
        """True if this run of the tests executes the block."""
        if self.language in ("setup", "long setup"):
            return LONG or self.language == "setup"
        return self.is_command and not RUN_ELSEWHERE & self.notes.keys() and (LONG or "long" not in self.notes)


def notes_of(name):
    """{key: [comment]} of tests/docs/notes; the key is the first line of a block."""
    path = os.path.join(NOTES, name)
    if not os.path.exists(path):
        return {}
    with open(path, encoding="utf-8") as file:
        parts = re.split(r"(?m)^## (.*)\n", file.read())[1:]
    return {key: re.findall(r"(?ms)^<!-- .*?-->$", text) for key, text in zip(parts[::2], parts[1::2])}


class Page:
    """`name` is relative to the repository; `blocks` are in order; `prose` maps line numbers to lines outside of blocks."""

    def __init__(self, name, text=None):
        self.name, self.blocks, self.prose, self.faults = name, [], {}, []
        self._notes, self._begins = notes_of(name) if text is None else {}, collections.Counter()
        if text is None:
            with open(os.path.join(ROOT, name), encoding="utf-8") as file:
                text = file.read()
        self._lines = text.split("\n")
        self._read()

    def _read(self):
        notes, number, paragraph = {}, 0, ""
        while number < len(self._lines):
            fence = FENCE.match(self._lines[number])
            if fence:
                if SAVED.search(paragraph):
                    notes["file"] = SAVED.findall(paragraph)[-1]
                for comment in self._notes_of_block(self._lines[number + 1].strip()):
                    self._take(comment, number, notes)
                number = self._read_block(number, fence, notes)
                notes, paragraph = {}, ""
            elif self._lines[number].startswith("<!--"):
                number = self._read_comment(number, notes)
            else:
                if self._lines[number].strip():
                    self._refuse_unused(notes, number)
                    notes = {}
                    self.prose[number + 1] = self._lines[number]
                    paragraph = f"{paragraph if self._lines[number - 1].strip() else ''} {self._lines[number]}"
                number += 1
        self._refuse_unused(notes, number)
        self.faults += [f"tests/docs/notes/{self.name}: no block begins with {key}" for key in self._notes]

    def _notes_of_block(self, line):
        self._begins[line] += 1
        again = self._begins[line]
        return self._notes.pop(line if again == 1 else f"{line} ({again})", [])

    def _refuse_unused(self, notes, number):
        if notes:
            self.faults.append(f"{self.name}:{number + 1}: no block follows <!-- {', '.join(notes)} -->")

    def _read_block(self, first, fence, notes):
        indent, end = len(fence[1]), first + 1
        while end < len(self._lines) and self._lines[end].strip() != "```":
            end += 1
        if end == len(self._lines):
            self.faults.append(f"{self.name}:{first + 1}: a block without an end")
        text = "".join(line[indent:] + "\n" for line in self._lines[first + 1:end])
        self.blocks.append(Block(fence[2], first + 2, text, notes))
        return end + 1

    def _read_comment(self, first, notes):
        end = first
        while end < len(self._lines) and "-->" not in self._lines[end]:
            end += 1
        self._take("\n".join(self._lines[first:end + 1]), first, notes)
        return end + 1

    def _take(self, text, first, notes):
        match = COMMENT.match(text[:text.find("-->")].rstrip())
        if not match:
            self.faults.append(f"{self.name}:{first + 1}: an unknown comment: {text}")
        elif match[1] == "site":
            pass
        elif match[1] in ("setup", "long setup"):
            lines_before = text[:match.start(2)].count("\n")
            self.blocks.append(Block(match[1], first + 1 + lines_before, match[2] + "\n", {}))
        else:
            notes[match[1]] = match[2] or ""

    def needs_clone(self):
        """True if the prose tells readers to be in a clone of the repository."""
        return any(block.is_run for block in self.blocks) and any(re.search(r"\ba clone\b", line) for line in self.prose.values())

    def anchors(self):
        """The anchors of all headings, as GitHub makes them."""
        found = {}
        for line in self.prose.values():
            heading = re.match(r"#+ +(.*)$", line)
            if heading:
                text = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading[1]).strip().lower()
                anchor = re.sub(r"[^\w\- ]", "", text).replace(" ", "-")
                found[anchor] = found.get(anchor, -1) + 1
        return {f"{anchor}-{again}" if again else anchor for anchor, count in found.items() for again in range(count + 1)}

    def links(self):
        """(line, target) of each link and image, except those to other sites."""
        return [(number, match[2]) for number, line in self.prose.items() for match in LINK.finditer(re.sub(r"`[^`]*`", "``", line))
                if not re.match(r"[a-z]+:", match[2])]


def names():
    """The paths of all pages, relative to the repository."""
    found = ["CONTRIBUTING.md", "README.md"]
    for folder, _, files in os.walk(os.path.join(ROOT, "docs")):
        found += [os.path.relpath(os.path.join(folder, name), ROOT) for name in files if name.endswith(".md")]
    return sorted(found)
