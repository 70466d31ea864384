#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""A folder of `landfall run` belongs to its chain: another chain is refused, an edited one says what it replaces and why."""
import json
import os
import re
import shutil
import subprocess
import unittest

from harness import EVAL, SCAN, TERRAIN, ToolTest, read_bytes, run

CHAIN = {"area": {"half_width_m": 5, "resolution_m": 0.1, "region_radius_m": 4},
         "terrain": {key: value for key, value in TERRAIN.items() if key != "grid"}, "scan": SCAN, "eval": {"footprint_m": EVAL["footprint_m"]},
         "hazard": None}
STATE = ".landfall-run.json"


class RunFolder(ToolTest):
    def setUp(self):
        super().setUp()
        os.mkdir(self.path("a"))

    def write(self, name, **changes):
        return self.config({**CHAIN, **changes}, name)

    def chain(self, *arguments, code=0, folder="a/out", stdin=""):
        """Runs a chain in the test's folder; its messages, without warnings and those of the tools."""
        result = run("landfall", "run", *arguments, "-o", folder, cwd=self.folder, stdin=stdin)
        self.assertEqual(result.returncode, code, result.stderr)
        return [line.removeprefix("landfall run: ") for line in result.stderr.splitlines() if line.startswith("landfall run: ") and "warning: " not in line]

    def contents(self, folder="a/out"):
        """Each file of a folder with its inode and bytes."""
        return {name: (os.stat(self.path(f"{folder}/{name}")).st_ino, read_bytes(self.path(f"{folder}/{name}")))
                for name in sorted(os.listdir(self.path(folder)))}

    def memory(self, folder="a/out"):
        return json.loads(read_bytes(self.path(f"{folder}/{STATE}")))["chain"]

    def refused(self, *arguments, words, **options):
        before = self.contents()
        messages = self.chain(*arguments, code=2, **options)
        self.assertEqual(len(messages), 1, messages)
        for word in [*words, "use -O"]:
            self.assertIn(word, messages[0])
        self.assertEqual(self.contents(), before)

    def test_a_stage_names_the_file_and_the_section_of_the_chain(self):
        """Keys that only the DEM can judge."""
        self.write("a/chain.json", eval={**CHAIN["eval"], "region": {"shape": "polygon", "vertices": [[0, 0], [90, 0], [0, 9]]}})
        result = run("landfall", "run", "-c", "a/chain.json", "-o", "a/out", cwd=self.folder)
        self.assertEqual(result.returncode, 2)
        self.assertIn("dem-eval: a/chain.json: /eval/region/vertices: the polygon reaches beyond the map", result.stderr)

    def test_an_edited_chain_says_what_it_replaces_and_why(self):
        self.write("a/chain.json")
        self.assertEqual(self.chain("-c", "a/chain.json"), [])
        self.assertEqual(self.memory()["names"], ["../chain.json"])
        self.assertEqual(self.chain("-c", "a/chain.json"), [])
        self.write("a/chain.json", scan={**SCAN, "seed": 8, "noise": {"range_sigma_m": 0.02}})
        messages = self.chain("-c", "a/chain.json")
        self.assertEqual(messages[1:], ["a/out/dem.h5 replaced: scan.h5 changed", "a/out/eval.h5 replaced: dem.h5 changed"])
        self.assertRegex(messages[0], r"^a/out/scan\.h5 replaced: noise\.dead_pixel_frac 0\.03 -> 0, noise\.dropout_frac 0\.05 -> 0, and 3 more keys$")
        self.write("a/chain.json", scan={**SCAN, "seed": 8, "noise": {"range_sigma_m": 0.02}}, uncertainty=True,
                   regrid={"uncertainty": {"navigation_sigma": {"velocity_mps": [0.1, 0.1, 0.1]}}})
        messages = self.chain("-c", "a/chain.json", "--set", "eval.quantile=0.9")
        self.assertEqual(len(messages), 2, messages)
        self.assertIn("a/out/dem.h5 replaced: ", messages[0])
        self.assertEqual(messages[1], "a/out/eval.h5 replaced: quantile 0.95 -> 0.9; dem.h5 changed")

    def test_options_and_a_missing_output(self):
        self.write("a/chain.json")
        self.chain("-c", "a/chain.json")
        self.write("a/chain.json", uncertainty=True)
        messages = self.chain("-c", "a/chain.json", "--set", "scan.navigation_error={}", "--set", "scan.seed=7")
        self.assertRegex(messages[1], r"^a/out/dem\.h5 replaced: option uncertainty none -> true; uncertainty\.navigation_sigma\..* more keys; scan\.h5 changed$")
        os.remove(self.path("a/out/metrics.json"))
        self.assertEqual(self.chain("-c", "a/chain.json", "--set", "scan.navigation_error={}", "--set", "scan.seed=7"), [])

    def test_another_chain_is_refused(self):
        self.write("a/chain.json")
        self.write("b.json", scan={**SCAN, "seed": 8})
        self.chain("-c", "a/chain.json")
        self.refused("-c", "b.json", words=["a/out", "a/chain.json", "b.json", "scan.seed 7 -> 8"])
        self.refused("-c", "preset:paper", words=["a/chain.json", "preset:paper"])
        self.refused("--set", "scan.seed=3", words=["a/chain.json", "no -c"])
        self.refused("-c", "a/chain.json", "-c", "b.json", words=["b.json"])
        self.refused("-c", "-", stdin=json.dumps({"scan": {"seed": 3}}), words=["standard input"])
        self.assertIn("a/out/scan.h5 replaced: seed 7 -> 8", self.chain("-c", "b.json", "-O"))
        self.assertEqual(self.memory()["names"], ["../../b.json"])
        self.refused("-c", "a/chain.json", words=["b.json"])

    def test_renamed_moved_and_copied_chains(self):
        self.write("a/chain.json")
        self.chain("-c", "a/chain.json")
        before = {name: content for name, content in self.contents().items() if name != STATE}

        def same(*arguments, folder="a/out", names):
            self.assertEqual(self.chain(*arguments, folder=folder), [])
            self.assertEqual(self.memory(folder)["names"], names)
            self.assertEqual({name: content for name, content in self.contents(folder).items() if name != STATE}, before)

        os.rename(self.path("a/chain.json"), self.path("a/site.json"))
        same("-c", "a/site.json", names=["../site.json"])
        shutil.copy(self.path("a/site.json"), self.path("copy.json"))
        same("-c", "copy.json", names=["../../copy.json"])
        same("-c", self.path("a/site.json"), names=["../site.json"])
        os.rename(self.path("a"), self.path("moved"))
        same("-c", "moved/site.json", folder="moved/out", names=["../site.json"])
        os.symlink("moved", self.path("link"))
        same("-c", "moved/site.json", folder="link/out", names=["../site.json"])
        # A renamed chain that is edited afterwards is the folder's own.
        self.write("moved/site.json", scan={**SCAN, "seed": 8})
        self.assertIn("moved/out/scan.h5 replaced: seed 7 -> 8", self.chain("-c", "moved/site.json", folder="moved/out"))
        shutil.copytree(self.path("moved"), self.path("b"))
        before = {name: content for name, content in self.contents("b/out").items() if name != STATE}
        same("-c", "b/site.json", folder="b/out", names=["../site.json"])

    def test_defaults_that_are_spelled_out_are_the_same_content(self):
        self.write("a/chain.json")
        self.chain("-c", "a/chain.json")
        self.write("b.json", eval={"footprint_m": EVAL["footprint_m"], "quantile": 0.95})
        self.assertEqual(self.chain("-c", "b.json"), [])

    def test_a_preset_after_a_file(self):
        self.config({"regrid": {"resolution_m": 0.5}, "eval": {"region_radius_m": 20}, "hazard": {}, "uncertainty": False}, "a/chain.json")
        small = ["--set", "scan.laser.scan_time_s=0.02", "--set", "terrain.grid.resolution_m=1", "--set", "hazard=null",
                 "--set", "terrain.patterns=[]"]
        self.chain("-c", "a/chain.json", "-c", "preset:paper", *small)
        self.assertEqual(self.memory()["names"], ["../chain.json", "preset:paper"])
        self.assertEqual(self.chain("-c", "a/chain.json", "-c", "preset:paper", *small), [])
        self.refused("-c", "preset:paper", "-c", "a/chain.json", *small, words=["preset:paper"])

    def test_standard_input_is_known_by_its_content(self):
        text = json.dumps(CHAIN)
        self.chain("-c", "-", stdin=text)
        self.assertRegex(self.memory()["names"][0], r"^content [0-9a-f]{32}$")
        self.assertEqual(self.chain("-c", "-", stdin=text), [])
        self.assertIn("a/out/scan.h5 replaced: seed 7 -> 9", self.chain("-c", "-", "--set", "scan.seed=9", stdin=text))
        self.refused("-c", "-", stdin=json.dumps({**CHAIN, "scan": {**SCAN, "seed": 8}}), words=["standard input", "scan.seed 9 -> 8"])
        self.assertEqual(self.chain("-c", "-", stdin=json.dumps({**CHAIN, "scan": {**SCAN, "seed": 9}})), [])  # the same content

    def test_a_folder_of_version_0_2_0_is_adopted(self):
        self.write("a/chain.json")
        self.chain("-c", "a/chain.json")
        state = json.loads(read_bytes(self.path(f"a/out/{STATE}")))
        del state["chain"]
        self.config(state, f"a/out/{STATE}")
        adopted = "a/out has no record of its chain, as folders of version 0.2.0; it now belongs to a/chain.json"
        self.assertEqual(self.chain("-c", "a/chain.json", "--set", "eval.quantile=0.9"), [adopted, "a/out/eval.h5 replaced: quantile 0.95 -> 0.9"])
        self.assertEqual(self.memory()["names"], ["../chain.json"])
        self.assertEqual(self.chain("-c", "a/chain.json", "--set", "eval.quantile=0.9"), [])

    def test_rasters_are_names_too(self):
        os.mkdir(self.path("b"))
        self.succeed("terrain-gen", "-o", self.path("g.h5"), "--set", "grid.half_width_m=40", "--set", "grid.resolution_m=1", "--set", "base.slope_x=0.05")
        self.succeed("terrain-gen", "--from", self.path("g.h5"), "-o", self.path("a/g.tif"))
        self.succeed("terrain-gen", "-o", self.path("h.h5"), "--set", "grid.half_width_m=40", "--set", "grid.resolution_m=1")
        self.succeed("terrain-gen", "--from", self.path("h.h5"), "-o", self.path("b/g.tif"))
        for folder in ("a", "b"):
            self.write(f"{folder}/chain.json", terrain={"from": "g.tif"})
        self.chain("-c", "a/chain.json")
        # Equal texts that name another raster of the same name.
        self.refused("-c", "b/chain.json", words=["b/chain.json", "terrain.base.path"])
        shutil.copy(self.path("b/g.tif"), self.path("a/g.tif"))
        self.assertIn("a/out/terrain.h5 replaced: raster changed", self.chain("-c", "a/chain.json"))
        self.write("c.json")
        self.chain("-c", "c.json", "--from", "a/g.tif", folder="c")
        self.assertEqual(self.memory("c")["names"], ["../c.json", "--from ../a/g.tif"])
        self.assertEqual(len(self.chain("-c", "c.json", "--from", "b/g.tif", folder="c", code=2)), 1)
        os.rename(self.path("a"), self.path("moved"))
        self.assertEqual(self.chain("-c", "moved/chain.json", folder="moved/out"), [])

    def test_a_failed_run_does_not_change_hands(self):
        self.write("a/chain.json")
        self.chain("-c", "a/chain.json")
        memory = self.memory()
        self.write("b.json", terrain={"base": {"type": "dem", "path": "nowhere.tif"}})
        self.chain("-c", "b.json", "-O", code=1)
        self.assertEqual(self.memory(), memory)
        self.assertEqual(self.chain("-c", "a/chain.json"), [])

    def test_outputs_that_the_chain_no_longer_makes(self):
        self.write("a/chain.json", hazard={"lander": {"leg_radius_m": 0.4, "body_radius_m": 0.5}})
        self.chain("-c", "a/chain.json")
        self.write("a/chain.json")
        messages = self.chain("-c", "a/chain.json")
        self.assertEqual(messages, ["a/out: hazards.h5, hazards.html, sites.json remain from an earlier run; this chain makes none"])
        self.assertTrue(os.path.exists(self.path("a/out/hazards.h5")))

    def test_an_emptied_folder_belongs_to_none(self):
        self.write("a/chain.json")
        self.chain("-c", "a/chain.json")
        for name in os.listdir(self.path("a/out")):
            if not name.startswith("."):
                os.remove(self.path(f"a/out/{name}"))
        self.write("b.json", scan={**SCAN, "seed": 8})
        self.assertEqual(self.chain("-c", "b.json"), [])

    def test_a_pipe_is_known_by_its_content(self):
        text = json.dumps(CHAIN).replace("'", "")
        self.assertFalse(re.search("'", text))
        command = f"exec {os.environ['LANDFALL_BIN']}/landfall run -c <(printf '%s' '{text}') -o a/out"
        for _ in range(2):
            result = subprocess.run(["bash", "-c", command], capture_output=True, text=True, cwd=self.folder, check=False)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
        self.assertRegex(self.memory()["names"][0], r"^content [0-9a-f]{32}$")


if __name__ == "__main__":
    unittest.main()
