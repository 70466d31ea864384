#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the pages without running them: run_docs_test.py runs every command, and all links and cited files exist."""
import json
import os
import re
import sys
import unittest

import page as pages

ROOT = pages.ROOT
sys.path[:0] = [os.path.join(ROOT, "scripts"), os.path.join(ROOT, "scripts", "site")]
# pylint: disable=wrong-import-position
import check_includes
import equations
import stage

COMMAND = re.compile(r"^ {4,}((terrain-gen|scan-sim|regrid|dem-eval|landfall-\w+|make|cmake|ctest|cpack|python3|\w+\.py|gdal\w+|gmt|"
                     r"apt|apt-get|sudo|\$)( |$)|(\./|scripts/|bench/|python/commands/|studies/runners/)\w)")
CITING = ("bench", "docs", "examples", "lib", "python", "scripts", "studies", "tests", "tools")
CITED = re.compile(r"(?<![\w./-])(?:bench|cmake|examples|lib|packaging|python|schemas|scripts|studies|testdata|tests|tools)/[\w./-]*\w")
# Records of past runs, with the file names of that time.
RECORDS = {"docs/quality/tests.md"}
# Paths below an installation prefix, or made by a build.
ELSEWHERE = re.compile(r"lib/(landfall|cmake|python3)(/|$)|bench/bench_(eval|grid|hazards|rays)$")
# Layers whose names are also words, columns of scans or sites, or keys of configurations, metrics.json and plans.
NAMES_OF_OTHERS = {"albedo", "cost", "count", "e_x", "e_y", "e_z", "fail", "frames", "in_region", "invalid", "outcome", "p_safe", "p_touchdown",
                   "roughness", "safe", "slope", "x_true", "y_true", "z", "z_est", "z_true"}
LANGUAGES = {"sh", "python", "json", "csv", "text", "cpp", "cmake", ""}


def read(name):
    with open(os.path.join(ROOT, name), encoding="utf-8") as file:
        return file.read()


def source_files():
    """Sources and pages, relative to the repository."""
    for top in CITING:
        for folder, folders, files in os.walk(os.path.join(ROOT, top)):
            folders[:] = [name for name in folders if name != "node_modules"]
            yield from (os.path.relpath(os.path.join(folder, name), ROOT) for name in files
                        if name.endswith((".cpp", ".h", ".md", ".py", ".txt", ".cmake")))


class Structure(unittest.TestCase):
    def setUp(self):
        self.pages = {name: pages.Page(name) for name in pages.names()}

    def test_comments_and_blocks_are_well_formed(self):
        faults = [fault for page in self.pages.values() for fault in page.faults]
        faults += [f"{page.name}:{block.line}: a block of `{block.language}`" for page in self.pages.values()
                   for block in page.blocks if block.language not in LANGUAGES | {"setup", "long setup"}]
        self.assertEqual(faults, [])

    def test_no_command_is_outside_of_a_shell_block(self):
        found = [f"{page.name}:{number}: {line.strip()}" for page in self.pages.values() for number, line in page.prose.items()
                 if COMMAND.match(line)]
        found += [f"{page.name}:{block.line}: {line}" for page in self.pages.values() for block in page.blocks
                  if block.language == "" or (block.language == "text" and "output" not in block.notes)
                  for line in block.text.splitlines() if COMMAND.match("    " + line)]
        self.assertEqual(found, [])

    def blocks_with(self, note):
        return [(page, block) for page in self.pages.values() for block in page.blocks if note in block.notes]

    def test_every_command_is_run(self):
        """By run_docs_test.py, always or on request, by scripts/test-deb or scripts/test-container, or by CI (the block that runs all
        tests)."""
        for page, block in self.blocks_with("long"):
            self.assertNotEqual(block.notes["long"], "", f"{page.name}:{block.line}: without a reason")
        run_in_bare = []
        for script in ("test-deb", "test-container"):
            with open(os.path.join(ROOT, "scripts", script), encoding="utf-8") as file:
                run_in_bare += re.findall(r'^ *page (?:\w+ )?"(.*)"$', file.read(), re.MULTILINE)
        self.assertEqual(sorted(block.notes["bare"] for _, block in self.blocks_with("bare")), sorted(run_in_bare))
        self.assertEqual({page.name for page, _ in self.blocks_with("bare")}, {"docs/user/install.md"})

    def test_pages_hold_no_comments_for_tests(self):
        """They are in tests/docs/notes: a reader of the raw page sees only the page, and what the site shows besides."""
        self.assertEqual([f"{name}: {line}" for name in pages.names() for line in read(name).splitlines()
                          if line.startswith("<!--") and not line.startswith("<!-- site:")], [])

    def test_ci_runs_the_command_of_all_tests(self):
        [(_, block)] = self.blocks_with("all tests")
        command = block.text.split("#")[0].strip()
        self.assertEqual(command, "scripts/test")
        with open(os.path.join(ROOT, ".ci", "run"), encoding="utf-8") as file:
            self.assertIn(f"exec {command}\n", file.readlines())

    def test_configurations_are_checked(self):
        self.assertEqual([f"{page.name}:{block.line}" for page in self.pages.values() for block in page.blocks
                          if block.language == "json" and not {"check", "file", "output"} & block.notes.keys()], [])

    def test_links_are_valid(self):
        """An anchor of a schema or of the catalogue is one of the page that is made of it."""
        broken, made = [], {name: pages.Page(name, text) for name, text in stage.made().items()}
        for page in self.pages.values():
            for number, target in page.links():
                path, _, anchor = target.partition("#")
                name = stage.target_of(page.name, path) if path else page.name
                if not os.path.exists(os.path.join(ROOT, name)):
                    broken.append(f"{page.name}:{number}: {target}")
                elif anchor and anchor not in (self.pages.get(name) or made[stage.MADE_FROM[name]]).anchors():
                    broken.append(f"{page.name}:{number}: no heading {anchor} in {name}")
        self.assertEqual(broken, [])

    def test_each_equation_of_the_paper_is_tested(self):
        """credibility.md has the table that equations.py makes, whose cells are all filled; other publications have equations too."""
        shown, made = equations.page()
        self.assertEqual(shown, made, "scripts/site/equations.py --write writes the table")
        self.assertEqual([number for number, columns in equations.citations().items() if not all(columns.values())], [])
        self.assertEqual(equations.cited("/// as in Eqs. 8-9 and Eq. 12;\n/// Eqs. 1 and 7 (Bortz 1971,\n/// Eq. 10), Eq. 3.151"), {1, 7, 8, 9, 12})

    def test_every_page_is_linked(self):
        linked = {os.path.normpath(os.path.join(os.path.dirname(page.name), target.partition("#")[0])) for page in self.pages.values()
                  for _, target in page.links()}
        self.assertEqual(sorted(set(self.pages) - linked - {"README.md"}), [])

    def test_every_picture_is_shown(self):
        folder = os.path.join(ROOT, "docs", "images")
        shown = {os.path.basename(target) for page in self.pages.values() for _, target in page.links()}
        self.assertEqual(sorted(set(os.listdir(folder)) - shown), [])

    def test_cited_files_exist(self):
        """Except paths with a NAME for the reader to fill in: lib/chain/lidar/scanner/NAME.h."""
        found = [(page.name, path) for page in self.pages.values() if page.name not in RECORDS for line in page.prose.values()
                 for path in CITED.findall(pages.LINK.sub("", line)) if "NAME" not in path and not ELSEWHERE.match(path)]
        self.assertGreater(len(found), 100)
        self.assertEqual([where for where in found if not os.path.exists(os.path.join(ROOT, where[1]))], [])

    def test_the_wings_agree_with_check_includes(self):
        page = read("docs/architecture.md")
        arrows = re.search(r"(?m)^    tools/((?: +--> +\w+)+)$", page)[1].split("-->")
        self.assertEqual(tuple(wing.strip() for wing in reversed(arrows[1:])), check_includes.WINGS)
        rows = re.findall(r"(?m)^\| `(\w+)`: [^|]* \| (0 .*) \|$", page)
        shown = {f"{wing}/{room}": int(level) for wing, rooms in rows for level, names in re.findall(r"(\d)([^;]*)", rooms)
                 for room in re.findall("`([\\w/]+)`", re.sub(r"\(.*?\)", "", names))}
        self.assertEqual(shown, check_includes.LEVELS)

    def decisions(self):
        """[(subject, {number: file}, [number])]: what the lines below a subject say, and its decisions."""
        for section in re.split(r"(?m)^## ", read("docs/reference/decisions.md"))[1:]:
            subject, _, text = section.partition("\n\n")
            places, _, entries = text.partition("\n\n")
            files = {number: file for file, numbers in re.findall(r"`([^`]*)`\s\(([D\d,\s]*)\)", places) for number in re.findall(r"D\d+", numbers)}
            yield subject, files, re.findall(r"(?m)^- \*\*(D\d+) ", entries)

    def test_where_to_add_what_names_each_file(self):
        """The code files that know an example of a row, by name, are those that the row names."""
        for row, example in (("requirement", "absolute_horizontal_frac"), ("layer", "z_spread"), ("scan pattern", "lissajous"), ("error model", "mirror_time_sigma_s")):
            [line] = [line for line in read("docs/architecture.md").splitlines() if line.startswith(f"| {row} |")]
            named = tuple(re.findall(r"`((?:lib|tools|python|schemas)/[\w./]+)`", line))
            knowing = [os.path.relpath(os.path.join(folder, name), ROOT) for top in ("lib", "tools", "python", "schemas")
                       for folder, _, names in os.walk(os.path.join(ROOT, top)) for name in names
                       if name.endswith((".h", ".cpp", ".py", ".js", ".json", ".cl")) and re.search(rf"\b{example}\b", read(os.path.join(folder, name)))]
            self.assertGreater(len(knowing), 1)
            self.assertEqual([name for name in knowing if not name.startswith(named)], [], row)

    def test_the_worst_name_is_kept_in_few_files(self):
        """Files of code that hold a name, also as a part of another: whoever adds or renames one touches them. The bounds only sink."""
        code = [read(os.path.join(folder, name)) for top in ("lib", "tools", "python") for folder, _, files in os.walk(os.path.join(ROOT, top))
                for name in files if name.endswith((".h", ".cpp", ".cl", ".js", ".py"))]
        requirements = json.loads(read("schemas/dictionary/requirements.json"))["requirements"]
        properties = json.loads(read("schemas/scan.schema.json"))["properties"]
        names = {"requirements": [row["name"] for row in requirements if "_" in row["name"]],  # a single word is also one of the language
                 "limits": {row["worst_limit"] for row in requirements} | {"absolute_horizontal_frac"},
                 "layers": {row["name"] for row in json.loads(read("schemas/dictionary/layers.json"))["layers"]} - NAMES_OF_OTHERS,
                 "errors": [key for section in ("noise", "pointing_error") for key in properties[section]["properties"]
                            if f'"{key}"' not in read("schemas/regrid.schema.json")]}  # regrid has keys of these names
        worst = {kind: max(sum(name in text for text in code) for name in some) for kind, some in names.items()}
        self.assertEqual(worst, {"requirements": 6, "limits": 8, "layers": 5, "errors": 5})
        schema = json.loads(read("schemas/scan.schema.json"))["definitions"]
        types = {row["properties"]["type"]["const"] for row in schema.values() if "const" in row.get("properties", {}).get("type", {})}
        scanners = [len([text for text in code if re.search(rf"""["']{name}["']""", text)]) for name in types - {"table", "polygon"}]
        self.assertEqual(max(scanners), 4)

    def test_decisions_are_in_order_below_their_subjects(self):
        order = {subject: [int(number[1:]) for number in numbers] for subject, _, numbers in self.decisions()}
        self.assertEqual([subject for subject, numbers in order.items() if numbers != sorted(numbers)], [])
        every = [number for numbers in order.values() for number in numbers]
        self.assertGreater(len(every), 100)
        self.assertEqual(len(every), len(set(every)))

    def test_every_decision_is_cited_by_the_file_that_makes_it(self):
        for subject, files, numbers in self.decisions():
            self.assertEqual(sorted(files), sorted(numbers), subject)
            silent = [(number, file) for number, file in files.items() if number not in re.findall(r"\bD\d+\b", read(file))]
            self.assertEqual(silent, [], subject)

    def test_every_file_that_lists_its_decisions_is_named(self):
        named = {(file, number) for _, files, _ in self.decisions() for number, file in files.items()}
        listed = {(name, number) for name in source_files() for line in re.findall(r"(?m)^(?://|#) Decisions: (.*)$", read(name))
                  for number in re.findall(r"D\d+", line)}
        self.assertEqual(sorted(listed - named), [])

    def test_every_cited_decision_exists(self):
        there = {number for _, _, numbers in self.decisions() for number in numbers}
        cited = {(name, number) for name in source_files() for number in re.findall(r"(?<![\w.])D[1-9]\d{0,2}(?![\w.]\w)", read(name))}
        self.assertGreater(len(cited), 50)
        self.assertEqual(sorted((name, number) for name, number in cited if number not in there), [])


# A comment is a sentence with a subject; other words say the same in plain English.
FRAGMENT = re.compile(r'(?:///?|#|""")\s*(?:Of|What|Where)\b')
STALE = re.compile(r"\b(?:goes on|anew|likewise)\b", re.I)
CODE = ("bench", "cmake", "examples", "lib", "python", "scripts", "studies", "tests", "tools")


class English(unittest.TestCase):
    def sources(self):
        """(name, lines) of the sources, without the scripts of reports."""
        for top in CODE:
            for folder, _, files in os.walk(os.path.join(ROOT, top)):
                for name in files:
                    path = os.path.relpath(os.path.join(folder, name), ROOT)
                    is_source = name.endswith((".cpp", ".h", ".cl", ".py", ".txt", ".cmake")) or top in ("scripts", "studies") and "." not in name
                    if is_source and path != "tests/docs/structure_test.py":
                        yield path, read(path).splitlines()

    def test_a_comment_begins_with_its_subject(self):
        found = [f"{path}:{number}" for path, lines in self.sources() for number, line in enumerate(lines, 1)
                 if FRAGMENT.match(line.strip()) and not self.is_comment(lines[number - 2])]
        self.assertEqual(found, [])

    @staticmethod
    def is_comment(line):
        return line.strip().startswith(("//", "#")) and "SPDX" not in line

    def test_nothing_goes_on_anew(self):
        found = [f"{path}:{number}" for path, lines in self.sources() for number, line in enumerate(lines, 1) if STALE.search(line)]
        found += [f"{name}:{number}" for name in pages.names() for number, line in enumerate(read(name).splitlines(), 1) if STALE.search(line)]
        self.assertEqual(found, [])


if __name__ == "__main__":
    unittest.main()
