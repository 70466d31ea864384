#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""All files state the same version, and CITATION.cff and the ids of the schemas are valid."""
import datetime
import json
import os
import re
import subprocess
import unittest

import yaml

ROOT = os.environ["LANDFALL_ROOT"]
SCHEMAS = ["chain", "design", "draws", "eval", "hazard", "regrid", "scan", "sensitivity", "study", "terrain"]


def text(*path):
    with open(os.path.join(ROOT, *path), encoding="utf-8") as file:
        return file.read()


VERSION = re.search(r"^project\(landfall VERSION (\S+)", text("CMakeLists.txt"), re.MULTILINE).group(1)
RELEASES = re.findall(r"^## (\S+)(?: - (\S+))?$", text("CHANGELOG.md"), re.MULTILINE)


class Versions(unittest.TestCase):
    def test_tools_and_packages_have_the_version(self):
        for tool in ["terrain-gen", "scan-sim", "regrid", "dem-eval", "hazard-map", "monte-carlo", "landfall-info", "landfall-export", "landfall-import", "landfall"]:
            words = subprocess.run([os.path.join(os.environ["LANDFALL_BIN"], tool), "--version"], check=True,
                                  capture_output=True, text=True).stdout
            self.assertIn(VERSION, words.split(), tool)
        self.assertEqual(text("packaging", "changelog").split("\n")[0].split(" ")[:2], ["landfall", f"({VERSION})"])

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
