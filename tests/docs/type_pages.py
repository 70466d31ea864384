#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
# run_docs_test.py runs pages with what their comments hide from readers: prerequisites, smaller arguments, and commands that are only
# shown. This script has the rendered text alone, as a browser shows it. What a page needs and does not say fails here.
"""Types pages as a reader does: the rendered text, every visible block in order, at full size, in a new folder.

    tests/docs/type_pages.py                   README.md and docs/user/tutorial.md
    tests/docs/type_pages.py PAGE ...          other pages
    --build DIR                                the build whose tools are typed; default build/release
    --folder DIR                               keep the files in DIR
    --skip REGEX                               do not type blocks that match; they are named in the result

The page is rendered by Debian's python3-markdown, which mkdocs needs (scripts/install-packages --docs). Shell blocks are typed into one bash, Python blocks into one python3. A block of JSON is saved under the name that the following block reads.
The folder looks like a clone after scripts/quickstart. Commands that build or test the whole program are skipped. Output is compared with the
text block that follows; file ids, revisions and sizes may differ, and the results say so. Exits with 1 if a block fails or prints something else.
"""
import argparse
import difflib
import html.parser
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time

import markdown

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.dirname(os.path.dirname(HERE))
PAGES = ["README.md", "docs/user/tutorial.md"]
SHELL, PYTHON = "sh", "python"
WHOLE_PROGRAM = re.compile(r"^scripts/(quickstart|test|package|install-packages)\b", re.MULTILINE)
JSON_NAME = re.compile(r"[\w.-]+\.json\b")
# A page says "on PATH", which README's first block of the chain does.
PREPARED = 'export PATH="$PWD/build/release/bin:$PWD/python/commands:$PATH"\n'


class Rendered(html.parser.HTMLParser):
    """The blocks (language, text, the text before it) of a page's HTML. Comments are not text."""

    def __init__(self, text):
        super().__init__()
        self.blocks, self.language, self.text, self.before = [], None, "", ""
        self.feed(markdown.markdown(text, extensions=["fenced_code", "tables"]))

    def handle_starttag(self, tag, attrs):
        if tag == "code" and dict(attrs).get("class", "").startswith("language-"):
            self.language, self.text = dict(attrs)["class"].removeprefix("language-"), ""

    def handle_data(self, data):
        if self.language is None:
            self.before += data
        else:
            self.text += data

    def handle_endtag(self, tag):
        if tag == "code" and self.language is not None:
            self.blocks.append((self.language, self.text, self.before))
            self.language, self.before = None, ""


def arguments_of(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pages", nargs="*", default=PAGES, metavar="PAGE")
    parser.add_argument("--build", default=os.path.join(ROOT, "build", "release"), metavar="DIR")
    parser.add_argument("--folder", metavar="DIR")
    parser.add_argument("--skip", type=re.compile, metavar="REGEX")
    return parser.parse_args(words)


class Reader:
    """Types the blocks of one page into a folder."""

    def __init__(self, folder, build, skip=None):
        self.folder, self.build, self.skip = folder, os.path.abspath(build), skip
        self.aside = tempfile.mkdtemp(prefix="landfall-typed-")
        self.python, self.notes, self.faults = "", [], []
        os.makedirs(folder, exist_ok=True)
        self.clone()

    def clone(self):
        """Copies the files of the repository, and links the tools to where a build puts them."""
        listed = subprocess.run(["git", "-C", ROOT, "ls-files", "-z"], capture_output=True, text=True, check=True).stdout
        for name in filter(None, listed.split("\0")):
            os.makedirs(os.path.dirname(os.path.join(self.folder, name)), exist_ok=True)
            shutil.copy2(os.path.join(ROOT, name), os.path.join(self.folder, name))
        os.makedirs(os.path.join(self.folder, "build"), exist_ok=True)
        if not os.path.lexists(os.path.join(self.folder, "build", "release")):
            os.symlink(self.build, os.path.join(self.folder, "build", "release"))

    def command(self, language, text):
        """The bash command that types a block; Python has the names of the blocks before it."""
        path = os.path.join(self.aside, "block")
        if language == SHELL:
            with open(path, "w", encoding="utf-8") as file:
                file.write(text)
            return f". '{path}'"
        with open(path, "w", encoding="utf-8") as file:
            quiet = f"import contextlib, io\nwith contextlib.redirect_stdout(io.StringIO()):\n    exec({self.python!r})\n" if self.python else ""
            file.write(quiet + text)
        self.python += text
        return f"python3 '{path}'"

    def start(self):
        environment = {name: value for name, value in os.environ.items() if not name.startswith(("LANDFALL_", "PYTHONPATH", "MAKE", "MFLAGS"))}
        environment.update(MPLBACKEND="Agg", PATH="/usr/local/bin:/usr/bin:/bin", COLUMNS="80")
        shell = subprocess.Popen(["bash", "--norc"], cwd=self.folder, env=environment, stdin=subprocess.PIPE, text=True)
        shell.stdin.write(PREPARED)
        return shell

    def type(self, shell, language, text):
        """(status of the first command that failed, or 0; what was printed)."""
        command = self.command(language, text)
        out, status = (os.path.join(self.aside, name) for name in ("out", "status"))
        if os.path.exists(status):
            os.remove(status)
        shell.stdin.write(f"failed=0; trap 'failed=$?' ERR; set -o pipefail; {{ {command} ; }} < /dev/null > '{out}' 2>&1; trap - ERR; set +o pipefail\n"
                          f"echo $failed > '{status}.new'; mv '{status}.new' '{status}'\n")
        shell.stdin.flush()
        while not os.path.exists(status):
            if shell.poll() is not None:
                return shell.returncode or 1, "the shell has ended"
            time.sleep(0.05)
        with open(status, encoding="utf-8") as file:
            code = int(file.read())
        with open(out, encoding="utf-8", errors="replace") as file:
            return code, file.read()

    def read(self, name, text=None):
        if text is None:
            with open(os.path.join(ROOT, name), encoding="utf-8") as file:
                text = file.read()
        blocks = Rendered(text).blocks
        shell, printed = self.start(), None
        for number, (language, text, before) in enumerate(blocks):
            label = f"{name}, block {number + 1} ({text.strip().splitlines()[0][:60]})"
            if language in (SHELL, PYTHON):
                printed = self.run(shell, language, text, label)
            elif language == "json":
                printed = None
                self.save(text, before, blocks[number + 1:], label)
            elif language == "text" and printed is not None:
                self.compare(text, printed, label)
                printed = None
        shell.stdin.close()
        shell.wait()

    def run(self, shell, language, text, label):
        if WHOLE_PROGRAM.search(text) or (self.skip and self.skip.search(text)):
            self.notes.append(f"{label}: not typed")
            return None
        started = time.monotonic()
        code, printed = self.type(shell, language, text)
        print(f"{label}: {time.monotonic() - started:.1f} s", file=sys.stderr, flush=True)
        if code:
            self.faults.append(f"{label}: exit {code}\n{printed[-2000:]}")
            return None
        return printed

    def save(self, text, before, later, label):
        """Under the file name that the next block reads, or else the one that the prose names last."""
        following = next((words for language, words, _ in later if language == SHELL), "")
        prose = JSON_NAME.findall(before)
        names = [name for name in JSON_NAME.findall(following) if name in prose] or prose[-1:] or JSON_NAME.findall(following)[:1]
        if not names:
            self.notes.append(f"{label}: no file name, not saved")
            return
        with open(os.path.join(self.folder, names[0]), "w", encoding="utf-8") as file:
            file.write(text)

    def compare(self, shown, printed, label):
        if shows(shown, printed):
            if not is_same(shown, printed):
                self.notes.append(f"{label}: only ids, revisions or sizes differ")
            return
        lines = difflib.unified_diff(shown.splitlines(), printed.splitlines(), "page", "printed", lineterm="", n=0)
        self.faults.append(f"{label}:\n" + "\n".join(lines))


def is_same(shown, printed):
    """Also of an output with lines left out, of which only run_docs_test.py can tell."""
    return "..." in shown.split() or [line.rstrip() for line in shown.splitlines()] == [line.rstrip() for line in printed.splitlines()]


def shows(shown, printed):
    """run_docs_test.py's comparison, whose module needs the variables of the tests."""
    os.environ.setdefault("LANDFALL_ROOT", ROOT)
    os.environ.setdefault("LANDFALL_BIN", "")
    import run_docs_test  # pylint: disable=import-outside-toplevel  # once it has its variables
    return run_docs_test.shows(shown, printed)


def main():
    options = arguments_of(sys.argv[1:])
    folder = options.folder or tempfile.mkdtemp(prefix="landfall-reader-")
    faults = []
    for name in options.pages:
        reader = Reader(os.path.join(folder, os.path.splitext(os.path.basename(name))[0]), options.build, options.skip)
        reader.read(name)
        for note in reader.notes:
            print(f"note: {note}")
        faults += reader.faults
    for fault in faults:
        print(f"FAULT: {fault}")
    print(f"{len(faults)} faults in {', '.join(options.pages)}; the files are in {folder}")
    return 1 if faults else 0


if __name__ == "__main__":
    sys.exit(main())
