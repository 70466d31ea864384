#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The committed files of testdata/ are those that its scripts make; they are small and listed in its README."""
import os
import sys
import unittest

ROOT = os.environ["LANDFALL_ROOT"]
TESTDATA = os.path.join(ROOT, "testdata")
sys.path[:0] = [TESTDATA, os.path.join(ROOT, "tests", "faults", "fuzz")]
sys.dont_write_bytecode = True

# pylint: disable=wrong-import-position
import make_malformed
import make_meshes
import make_rasters
import make_seeds


def read(path):
    with open(path, "rb") as file:
        return file.read()


class Testdata(unittest.TestCase):
    def test_the_files_are_those_of_the_scripts(self):
        for name, script in {"rasters": make_rasters, "meshes": make_meshes, "malformed": make_malformed}.items():
            folder, made = os.path.join(TESTDATA, name), script.files()
            self.assertEqual(sorted(os.listdir(folder)), sorted(made), f"testdata/make_{name}.py makes other files")
            for file, content in made.items():
                self.assertTrue(read(os.path.join(folder, file)) == content, f"testdata/make_{name}.py makes another {name}/{file}")

    def test_the_dictionary_has_the_words_of_the_schemas(self):
        dictionary = read(os.path.join(TESTDATA, "fuzz", "dictionaries", "config.dict")).decode()
        self.assertEqual(dictionary, make_seeds.dictionary(), "tests/faults/fuzz/make_seeds.py --words updates it")

    def test_the_readme_has_every_folder_raster_and_mesh(self):
        readme = read(os.path.join(TESTDATA, "README.md")).decode()
        for folder in next(os.walk(TESTDATA))[1]:
            self.assertIn(f"| `{folder}/", readme)
        for name in [*make_rasters.files(), *make_meshes.files()]:
            self.assertIn(name.replace("mars_big_endian.img", "`.img`"), readme)

    def test_the_files_are_small(self):
        sizes = {os.path.join(folder, name): os.path.getsize(os.path.join(folder, name))
                 for folder, _, names in os.walk(TESTDATA) for name in names}
        self.assertLess(max(sizes.values()), 200e3, max(sizes, key=sizes.get))
        self.assertLess(sum(sizes.values()), 2e6)


if __name__ == "__main__":
    unittest.main()
