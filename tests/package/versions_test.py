#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""All files state the same version, and CITATION.cff and the ids of the schemas are valid."""
import datetime
import json
import os
import re
import subprocess
import tempfile
import unittest

import yaml

from harness import PROGRAMS, ROOT, read_bytes

SCHEMAS = ["chain", "design", "draws", "eval", "hazard", "regrid", "scan", "sensitivity", "study", "terrain"]


def text(*path):
    return read_bytes(os.path.join(ROOT, *path)).decode()


VERSION = re.search(r"^project\(landfall VERSION (\S+)", text("CMakeLists.txt"), re.MULTILINE).group(1)
RELEASES = re.findall(r"^## (\S+)(?: - (\S+))?$", text("CHANGELOG.md"), re.MULTILINE)


class Versions(unittest.TestCase):
    def test_tools_and_packages_have_the_version(self):
        for tool in PROGRAMS:
            words = subprocess.run([os.path.join(os.environ["LANDFALL_BIN"], tool), "--version"], check=True,
                                  capture_output=True, text=True).stdout
            self.assertIn(VERSION, words.split(), tool)
        self.assertEqual(text("packaging", "changelog").split("\n")[0].split(" ")[:2], ["landfall", f"({VERSION})"])

    def test_a_clone_whose_commit_git_cannot_tell(self):
        with tempfile.TemporaryDirectory(prefix="landfall-version-") as folder:
            os.mkdir(os.path.join(folder, ".git"))
            with open(os.path.join(folder, "CMakeLists.txt"), "w", encoding="utf-8") as file:
                file.write(f"cmake_minimum_required(VERSION 3.25)\nproject(clone NONE)\nadd_subdirectory({ROOT}/lib/store/files files)\n")
            configured = subprocess.run(["cmake", "-S", folder, "-B", f"{folder}/build", "-DGIT_EXECUTABLE=/bin/false"], check=True,
                                        capture_output=True, text=True)
            self.assertIn("Files will not name the commit that made them: git: 1", configured.stderr)
            self.assertIn(b'#define LANDFALL_GIT "unknown"\n', read_bytes(f"{folder}/build/include/store/files/version.h"))

    def test_the_latest_release_of_the_changelog_has_the_version(self):
        releases = [release for release in RELEASES if release[0] != "Unreleased"]
        self.assertEqual(releases[0][0], VERSION)
        dates = [datetime.date.fromisoformat(date) for _, date in releases]
        self.assertEqual(dates, sorted(dates, reverse=True))
        kinds = set(re.findall(r"^### (.*)$", text("CHANGELOG.md"), re.MULTILINE))
        self.assertLessEqual(kinds, {"Added", "Changed", "Deprecated", "Removed", "Fixed", "Security"})

    def test_the_citation_has_the_version_and_the_keys_of_cff_1_2(self):
        citation = yaml.safe_load(text("CITATION.cff"))
        for key in ["cff-version", "message", "title", "authors"]:  # the keys that the schema requires
            self.assertIn(key, citation)
        known = {"abstract", "authors", "cff-version", "commit", "contact", "date-released", "doi", "identifiers", "keywords",
                 "license", "license-url", "message", "preferred-citation", "references", "repository", "repository-artifact",
                 "repository-code", "title", "type", "url", "version"}
        self.assertLessEqual(set(citation), known)
        self.assertEqual((citation["cff-version"], citation["type"]), ("1.2.0", "software"))
        self.assertEqual(citation["license"], "GPL-3.0-or-later")
        self.assertEqual(citation["version"], VERSION)
        self.assertEqual(citation["date-released"].isoformat(), dict(RELEASES)[VERSION])
        for work in [citation, *citation["references"]]:
            self.assertTrue(all(set(author) & {"name", "family-names"} for author in work["authors"]))
        for reference in citation["references"]:
            self.assertLessEqual({"authors", "title", "type"}, set(reference))


class Workflow(unittest.TestCase):
    def test_each_job_runs_scripts_that_exist(self):
        workflow = yaml.safe_load(text(".github", "workflows", "ci.yml"))
        commands = [step["run"] for job in workflow["jobs"].values() for step in job["steps"] if "run" in step]
        scripts = [command.split()[0] for command in commands if re.match(r"(scripts|\.ci)/", command)]
        self.assertLessEqual({".ci/run", "scripts/package", "scripts/test-deb", "scripts/test-container", "scripts/docs"}, set(scripts))
        self.assertEqual([script for script in scripts if not os.access(os.path.join(ROOT, script), os.X_OK)], [])
        needed = {name for job in workflow["jobs"].values() for name in job.get("needs", [])}
        self.assertLessEqual(needed, set(workflow["jobs"]))


class Paper(unittest.TestCase):
    """paper/paper.md in the form of the Journal of Open Source Software."""

    def setUp(self):
        _, head, self.body = text("paper", "paper.md").split("---\n", 2)
        self.head = yaml.safe_load(head)

    def test_the_head_has_its_keys(self):
        self.assertLessEqual({"title", "tags", "authors", "affiliations", "date", "bibliography"}, set(self.head))
        self.assertTrue(os.path.exists(os.path.join(ROOT, "paper", self.head["bibliography"])))
        places = {affiliation["index"] for affiliation in self.head["affiliations"]}
        self.assertLessEqual({author["affiliation"] for author in self.head["authors"]}, places)

    def test_the_sections_and_the_length(self):
        sections = re.findall(r"(?m)^# (.*)$", self.body)
        self.assertLessEqual({"Summary", "Statement of need", "State of the field", "References"}, set(sections))
        self.assertTrue(250 <= len(self.body.split()) <= 1000, len(self.body.split()))

    def test_what_it_cites_is_in_the_bibliography(self):
        entries = re.findall(r"(?m)^@\w+\{(\w+),$", text("paper", "paper.bib"))
        self.assertEqual(sorted(set(re.findall(r"@(\w+)[\];]", self.body))), sorted(entries))

    def test_its_numbers_are_those_of_the_pages(self):
        self.assertIn("| all | 3,826 | 3,519, 92.0 % | 307 | 295 | 99.7 % |", text("docs", "quality", "tests.md"))
        self.assertIn("| roll reversed | 260.7 |", text("docs", "quality", "real-scan.md"))
        self.assertIn("**4.98 urad rms**", text("docs", "quality", "real-scan.md"))
        for number in ("3,826", "99.7 %", "5 microradians", "261"):
            self.assertIn(number, self.body)


class Schemas(unittest.TestCase):
    def test_each_has_an_id_with_its_version(self):
        files = sorted(name for name in os.listdir(os.path.join(ROOT, "schemas")) if name != "dictionary")
        self.assertEqual(files, [f"{name}.schema.json" for name in SCHEMAS])
        for name in SCHEMAS:
            schema = json.loads(text("schemas", f"{name}.schema.json"))
            self.assertRegex(schema["$id"], rf"^urn:landfall:schema:{name}:[1-9][0-9]*\.[0-9]+$")
            self.assertEqual(schema["properties"]["$schema"]["type"], "string")


if __name__ == "__main__":
    unittest.main()
