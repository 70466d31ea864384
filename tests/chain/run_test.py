#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""`landfall`, which starts every tool, and `landfall run`, whose files equal those of the single tools byte for byte."""
import json
import os
import re
import shlex
import shutil
import subprocess
import unittest

from harness import BIN, EVAL, HAZARD, REGRID, SCAN, TERRAIN, ToolTest, config_of, read_bytes, run, tool, with_values

SIGMA = {"navigation_sigma": {"position_m": [0.02, 0.03, 0.05], "velocity_mps": [0.1, 0.05, 0.1], "rpy_rad": [1e-4, 2e-4, 3e-4],
                              "rpy_rate_radps": [1e-3, 5e-4, 1e-3]}}
CHAIN = {"area": {"half_width_m": 5, "resolution_m": 0.1, "region_radius_m": 4},
         "terrain": {key: value for key, value in TERRAIN.items() if key != "grid"}, "scan": SCAN, "regrid": {"uncertainty": SIGMA},
         "eval": {key: value for key, value in EVAL.items() if key != "region_radius_m"},
         "hazard": {key: value for key, value in HAZARD.items() if key != "region_radius_m"}, "uncertainty": True}
OUTPUTS = ["dem.h5", "eval.h5", "hazards.h5", "hazards.html", "metrics.json", "report.html", "scan.h5", "sites.json", "terrain.h5"]
STATE = ".landfall-run.json"


class Landfall(ToolTest):
    def test_starts_every_tool(self):
        names = {"terrain-gen": "terrain-gen", "scan-sim": "scan-sim", "regrid": "regrid", "dem-eval": "dem-eval", "hazard-map": "hazard-map",
                 "monte-carlo": "monte-carlo", "info": "landfall-info", "export": "landfall-export"}
        listed = run("landfall", "help").stdout
        for name, program in names.items():
            self.assertEqual(run("landfall", name, "--help").stdout, run(program, "--help").stdout)
            self.assertEqual(run("landfall", "help", name).stdout, run(program, "--help").stdout)
            self.assertRegex(listed, rf"\n  {name} +[A-Z]")
        self.assertRegex(listed, r"\n  plot +[A-Z]")
        self.succeed("landfall", "terrain-gen", "-o", self.path("a.h5"), "--set", "grid.half_width_m=5")
        self.succeed("terrain-gen", "-o", self.path("b.h5"), "--set", "grid.half_width_m=5")
        self.assertEqual(read_bytes(self.path("a.h5")), read_bytes(self.path("b.h5")))

    def test_errors_are_those_of_the_tool(self):
        self.assertEqual(run("landfall", "scan-sim").stderr, run("scan-sim").stderr)
        self.assertEqual(run("landfall", "scan-sim").returncode, 2)
        self.assertTrue(run("landfall", "--version").stdout.startswith("landfall landfall "))

    def test_starts_every_command_of_python(self):
        """Each row with a module has one, and is in a list of commands."""
        root = os.environ["LANDFALL_ROOT"]
        rows = [row for row in json.loads(read_bytes(os.path.join(root, "schemas", "dictionary", "tools.json")))["tools"] if "module" in row]
        lists = {first: run("landfall", *filter(None, [first]), "--help").stdout for first in ("", "plot", "study")}
        for row in rows:
            module, words = row["module"].split()[0], row["command"].split()
            self.assertTrue(os.path.exists(os.path.join(root, "python", "landfall", module.replace(".", "/") + ".py")), row)
            self.assertRegex(lists[words[0] if words[1:] else ""], rf"\n  {words[-1]} +[A-Z]")
        shown = self.succeed("landfall", "help", "plot", "dem").stdout
        self.assertRegex(shown, r"\Ausage: landfall plot dem \[-h\]")
        self.assertEqual(self.succeed("landfall", "plot").stdout, lists["plot"])
        self.assertRegex(self.succeed("landfall", "study", "list", "noise").stdout, r"\Acase\trange_sigma_m\t")
        missing = run("landfall", "plot", "dem", "none.h5", cwd=self.folder)
        self.assertEqual((missing.returncode, missing.stderr), (1, "landfall plot dem: none.h5: no such file\n"))

    def test_completion(self):
        script = self.write("landfall", run("landfall", "--print-completion").stdout)
        self.write("scan-sim", run("scan-sim", "--print-completion").stdout)

        def complete(*words):
            text = ('source "$1"; shift; COMP_WORDS=("$@"); COMP_CWORD=$((${#COMP_WORDS[@]} - 1)); _landfall_landfall; '
                    'printf "%s\\n" "${COMPREPLY[@]}"')
            command = ["bash", "-c", text, "bash", script, "landfall", *words]
            return subprocess.run(command, capture_output=True, text=True, check=True, cwd=self.folder, env={**os.environ, "PATH": f"{BIN}:{os.environ['PATH']}"}).stdout.split()

        self.assertIn("scan-sim", complete("s"))
        self.assertIn("run", complete(""))
        self.assertIn("--ranges-from", complete("scan-sim", "--ran"))
        self.assertIn("--require-safe", complete("run", "--req"))
        self.assertEqual(complete("run", "--set", "scan.noise.ra"), ["scan." + key for key in complete("scan-sim", "--set", "noise.ra")])
        self.assertEqual(complete("plot", "d"), ["dem", "draws"])
        self.assertEqual(complete("study", "li"), ["list"])
        self.assertEqual(complete("plot", "dem", "--lim"), ["--limit-m"])

    def test_study_status_from_another_folder(self):
        result = run("landfall", "study", "status", "flyback", cwd=self.folder)
        self.assertEqual(result.returncode, 0, result.stderr)

    def test_a_study_that_fails_shows_its_own_message_alone(self):
        tiny = {"base": {"terrain": {"grid": {"half_width_m": 6, "resolution_m": 0.1}}, "scan": SCAN, "regrid": REGRID, "eval": {"region_radius_m": 4}}}
        for tree, words in [({"base": tiny["base"], "axis": []}, r"/axis: unknown key"), ({"base": {"scan": {"noise": {"range_sigma": 1}}}}, "range_sigma"),
                            ({"base": {**tiny["base"], "hazard": {"region": {"shape": "mask", "path": "no.h5"}}}}, r"FAILED \(exit 1\): score of ")]:
            study = self.config(tree, "tiny.json")
            result = run("landfall", "study", study, "-j2", cwd=self.folder)
            self.assertNotEqual(result.returncode, 0)
            self.assertRegex(result.stderr, words)
            self.assertNotIn("make", result.stderr)
            self.assertNotIn("Makefile", result.stderr)
        study = self.config({**tiny, "set": {"eval.region": {"shape": "mask", "path": self.config("x", "mask.h5")}}}, "lost.json")
        self.assertNotIn("make", run("landfall", "study", study, cwd=self.folder).stderr)
        os.remove(self.path("mask.h5"))
        self.assertIn("No rule to make target", run("landfall", "study", study, cwd=self.folder).stderr)  # nobody else says so


class Run(ToolTest):
    def out(self, name):
        return self.path(os.path.join("out", name))

    def run_chain(self, *arguments, code=0, chain=None):
        config = self.config(chain or CHAIN, "chain.json")
        result = run("landfall", "run", "-c", config, "-o", self.path("out"), *arguments)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def states(self):
        """Inode and time of each output: a stage that is not run again leaves both."""
        return {name: (os.stat(self.out(name)).st_ino, os.stat(self.out(name)).st_mtime_ns) for name in OUTPUTS}

    def test_every_file_equals_that_of_the_single_tools(self):
        """On one thread, those of the tools on all."""
        printed = self.run_chain("-t", 1).stdout
        self.assertEqual(sorted(os.listdir(self.path("out"))), sorted([*OUTPUTS, STATE]))
        os.mkdir(self.path("single"))
        grid = {"half_width_m": 15, "resolution_m": 0.1}
        stages = {"terrain": {**CHAIN["terrain"], "grid": grid}, "scan": SCAN, "regrid": {"half_width_m": 5, "resolution_m": 0.1, "uncertainty": SIGMA},
                  "eval": {**CHAIN["eval"], "region_radius_m": 4}, "hazard": {**CHAIN["hazard"], "region_radius_m": 4}}
        c = {stage: self.config(value, stage + ".json") for stage, value in stages.items()}
        s = {name: os.path.join(self.path("single"), name) for name in OUTPUTS}
        self.succeed("terrain-gen", "-c", c["terrain"], "-o", s["terrain.h5"])
        self.succeed("scan-sim", "-c", c["scan"], "--terrain", s["terrain.h5"], "-o", s["scan.h5"])
        self.succeed("regrid", s["scan.h5"], "-c", c["regrid"], "--terrain", s["terrain.h5"], "--uncertainty", "-o", s["dem.h5"])
        tables = self.succeed("dem-eval", s["dem.h5"], "-c", c["eval"], "-o", s["eval.h5"], "--metrics", s["metrics.json"],
                              "--report", s["report.html"], "--table").stdout
        tables += "\n" + self.succeed("hazard-map", s["dem.h5"], "-c", c["hazard"], "--terrain", s["terrain.h5"], "-o", s["hazards.h5"],
                                      "--sites", s["sites.json"], "--report", s["hazards.html"], "--table").stdout
        for name in OUTPUTS:
            self.assertEqual(read_bytes(self.out(name)), read_bytes(s[name]), name)
        self.assertEqual(printed, tables)

    def test_messages_of_a_stage_name_keys_of_the_chain(self):
        """Not options of regrid, which `landfall run` does not have."""
        stderr = self.run_chain("-q", code=2, chain={**CHAIN, "regrid": {}}).stderr
        self.assertIn(f"regrid: {self.path('chain.json')}: /regrid: {self.out('scan.h5')} may have a navigation or pointing error of unknown sigma; give "
                      "regrid.uncertainty.navigation_sigma=", stderr)
        self.assertNotIn(" --", stderr)

    def test_printed_commands_make_the_same_files(self):
        self.run_chain()
        commands = self.run_chain("--print-commands").stdout.replace(self.path("out"), self.path("again"))
        os.mkdir(self.path("again"))
        for line in commands.splitlines():
            name, *words = shlex.split(line)
            self.succeed(name, *words)
        for name in OUTPUTS:
            self.assertEqual(read_bytes(os.path.join(self.path("again"), name)), read_bytes(self.out(name)), name)

    def test_an_unchanged_chain_is_not_run_again(self):
        first = self.run_chain()
        before = self.states()
        again = self.run_chain()
        self.assertEqual(self.states(), before)
        self.assertEqual(again.stdout, first.stdout)
        made = json.loads(self.run_chain("--json").stdout)["stages"]
        self.assertEqual({name: stage["made"] for name, stage in made.items()},
                         dict.fromkeys(["terrain-gen", "scan-sim", "regrid", "dem-eval", "hazard-map"], False))

    def test_only_what_a_change_reaches_is_made_again(self):
        self.run_chain()
        before = self.states()
        self.run_chain("--set", "hazard.limits.slope_deg=12")
        changed = {name for name, state in self.states().items() if state != before[name]}
        self.assertEqual(changed, {"hazards.h5", "hazards.html", "sites.json"})
        before = self.states()
        self.run_chain("--set", "hazard.limits.slope_deg=12", "--set", "scan.seed=8")
        changed = {name for name, state in self.states().items() if state != before[name]}
        self.assertEqual(changed, set(OUTPUTS) - {"terrain.h5"})
        self.assertEqual(config_of(self.out("scan.h5"))["seed"], 8)

    def test_a_missing_or_edited_side_output_is_not_taken_for_its_own(self):
        self.run_chain()
        reference = read_bytes(self.out("metrics.json"))
        os.remove(self.out("metrics.json"))
        self.run_chain()
        self.assertEqual(read_bytes(self.out("metrics.json")), reference)
        with open(self.out("metrics.json"), "ab") as file:
            file.write(b"\n")
        result = self.run_chain(code=2)
        self.assertIn("metrics.json exists, and landfall run did not make it; use -O", result.stderr)
        self.assertEqual(read_bytes(self.out("metrics.json")), reference + b"\n")
        self.run_chain("-O")
        self.assertEqual(read_bytes(self.out("metrics.json")), reference)

    def test_files_of_another_origin_are_refused(self):
        for name in OUTPUTS:
            with self.subTest(name):
                shutil.rmtree(self.path("out"), ignore_errors=True)
                os.mkdir(self.path("out"))
                self.write(self.out(name), "mine")
                result = self.run_chain(code=2)
                self.assertIn(f"{name} exists", result.stderr)
                self.assertEqual(os.listdir(self.path("out")), [name])
                self.assertEqual(read_bytes(self.out(name)), b"mine")

    def test_a_terrain_of_another_origin_is_kept_if_it_is_the_same(self):
        os.mkdir(self.path("out"))
        terrain = self.config({**CHAIN["terrain"], "grid": {"half_width_m": 15, "resolution_m": 0.1}}, "t.json")
        self.succeed("terrain-gen", "-c", terrain, "-o", self.out("terrain.h5"))
        inode = os.stat(self.out("terrain.h5")).st_ino
        self.run_chain()
        self.assertEqual(os.stat(self.out("terrain.h5")).st_ino, inode)
        shutil.rmtree(self.path("out"))
        os.mkdir(self.path("out"))
        self.succeed("terrain-gen", "-c", terrain, "-o", self.out("terrain.h5"), "--seed", 9)
        kept = read_bytes(self.out("terrain.h5"))
        self.assertIn("terrain.h5 exists; use -O", self.run_chain(code=2).stderr)
        self.assertEqual(read_bytes(self.out("terrain.h5")), kept)

    def test_a_damaged_output_is_made_again(self):
        self.run_chain()
        reference = read_bytes(self.out("dem.h5"))
        with open(self.out("dem.h5"), "r+b") as file:
            file.truncate(5000)
        self.assertIn("use -O", self.run_chain(code=2).stderr)
        self.run_chain("-O")
        self.assertEqual(read_bytes(self.out("dem.h5")), reference)

    def test_a_failure_leaves_the_finished_stages(self):
        far = {"shape": "polygon", "vertices": [[90, 0], [99, 0], [90, 9]]}
        result = self.run_chain(code=1, chain=with_values(CHAIN, hazard__region=far))
        self.assertIn("nothing to judge", result.stderr)
        self.assertIn("hazards.h5 was not made; the finished stages remain", result.stderr)
        self.assertEqual(sorted(os.listdir(self.path("out"))), sorted({*OUTPUTS, STATE} - {"hazards.h5", "hazards.html", "sites.json"}))
        before = os.stat(self.out("scan.h5")).st_ino
        self.run_chain()
        self.assertEqual(os.stat(self.out("scan.h5")).st_ino, before)

    def test_bins_too_coarse_for_the_lander_are_refused_before_the_work(self):
        contact = with_values(CHAIN, hazard__lander__leg_radius_m=0.15)
        plane = with_values(CHAIN, hazard={"method": "plane", "lander": {"body_radius_m": 0.05}})
        rocks = with_values(CHAIN, hazard={"method": "range_difference", "limits": {"roughness_m": 0.05}})
        wide = with_values(CHAIN, hazard__lander__body_radius_m=6)
        for chain, words in [(contact, ["/hazard/lander/leg_radius_m: 0.15 is less than 2 bins of 0.1 m", "at least 0.2 m", "at most 0.075 m"]),
                             (plane, ["/hazard/lander/body_radius_m: 0.05 is less than 1 bin of 0.1 m", "at least 0.1 m", "at most 0.05 m"]),
                             (rocks, ["/hazard/limits/roughness_m: 0.05 is less than 1 bin of 0.1 m", "at least 0.1 m", "at most 0.05 m"]),
                             (wide, ["/hazard/lander/body_radius_m: a lander of 121 bins across", "half_width_m"])]:
            message = self.run_chain(code=2, chain=chain).stderr
            for word in ["chain.json: /hazard/", "regrid.resolution_m", "area.resolution_m", '"hazard": null', *words]:
                self.assertIn(word, message)
            self.assertFalse(os.path.exists(self.path("out")))
            sections = {**{key: value for key, value in chain.items() if key != "regrid"}, "draws": 2}
            message = run("monte-carlo", "-c", self.config(sections, "mc.json"), "-o", self.path("draws.h5")).stderr
            for word in ["mc.json: /hazard/", "regrid.resolution_m", "area.resolution_m", '"hazard": null', *words]:
                self.assertIn(word, message)

    def test_verdicts_decide_the_exit_code(self):
        self.run_chain()
        states = self.states()
        strict = ["--set", "eval.limits.relative_elevation_m=0"]
        self.run_chain("--require-pass", *strict, code=3)
        self.run_chain("--require-pass", *strict, code=3)  # nor does a repetition pass
        self.run_chain(*strict)
        loose = with_values(CHAIN, eval__limits={"invalid_frac": 1, "hole_bins": 10**6, "distance_bins": 10**6, "relative_elevation_m": 9,
                                                "relative_horizontal_m": 9, "absolute_horizontal_m": 9, "absolute_horizontal_frac": 0})
        self.run_chain("--require-pass", chain=loose)
        before = self.states()
        self.run_chain("--require-pass", chain=loose)
        self.assertEqual(self.states(), before)
        self.assertEqual(before["scan.h5"], states["scan.h5"])
        self.run_chain("--require-safe", "--set", "hazard.limits.slope_deg=0.001", code=3)

    def test_sections_merge_presets_and_objects(self):
        chain = {"terrain": "preset:paper", "scan": ["preset:paper", {"laser": {"scan_time_s": 0.1}}],
                 "area": {"half_width_m": 20, "resolution_m": 0.2}}
        printed = json.loads(self.run_chain("--print-config", "--set", "scan.noise.range_sigma_m=0.02", chain=chain).stdout)
        paper = json.loads(run("scan-sim", "-c", "preset:paper", "--print-config").stdout)
        self.assertEqual(printed["scan"]["detector"]["roll_deg"], paper["detector"]["roll_deg"])
        self.assertEqual(printed["scan"]["laser"], {"pulse_rate_hz": 20000, "scan_time_s": 0.1})
        self.assertEqual(printed["scan"]["noise"], {"range_sigma_m": 0.02})
        self.assertEqual(printed["terrain"]["grid"], {"half_width_m": 60, "resolution_m": 0.05})  # given by the preset
        self.assertEqual(printed["regrid"], {"half_width_m": 20, "resolution_m": 0.2})
        self.assertEqual((printed["eval"], printed["hazard"]), ({"region_radius_m": 20}, {"region_radius_m": 20}))
        changes = self.config({"scan": {"noise": {"dropout_frac": 0.5}}})
        again = run("landfall", "run", "-c", "preset:paper", "-c", changes, "-o", "x", "--print-config")
        self.assertEqual(json.loads(again.stdout)["scan"]["noise"], {"range_sigma_m": paper["noise"]["range_sigma_m"], "dropout_frac": 0.5})

    def test_a_section_may_be_a_file_next_to_the_chain(self):
        """Alone or in a list; a raster that it names lies next to it."""
        os.makedirs(self.path("site/parts"))
        for name, tree in (("site/parts/terrain.json", {"from": "moon.tif", "seed": 5}), ("site/scan.json", {"noise": {"range_sigma_m": 0.5}}),
                           ("site/chain.json", {"terrain": "parts/terrain.json", "scan": ["preset:paper", "scan.json", {"seed": 7}]})):
            self.write(name, json.dumps(tree))
        result = run("landfall", "run", "-c", "site/chain.json", "-o", "x", "--print-config", cwd=self.folder)
        self.assertIn("site/parts/moon.tif: no such file", result.stderr)
        self.write("site/parts/terrain.json", json.dumps({"seed": 5}))
        printed = json.loads(self.succeed("landfall", "run", "-c", self.path("site/chain.json"), "-o", "x", "--print-config").stdout)
        self.assertEqual((printed["terrain"]["seed"], printed["scan"]["seed"], printed["scan"]["noise"]), (5, 7, {"range_sigma_m": 0.5}))
        self.assertEqual(printed["scan"]["detector"]["roll_deg"], 7.73)

    def grid(self, area, **sections):
        """The grid that an area gives the terrain."""
        return json.loads(self.run_chain("--print-config", chain={"area": area, "hazard": None, **sections}).stdout)["terrain"]["grid"]

    def test_the_terrain_is_ten_metres_wider_by_whole_nodes(self):
        for half_width_m, resolution_m, wanted in [(50, 0.05, 60), (5.1, 0.1, 15.1), (30.1, 0.07, 40.11), (0.3, 0.1, 10.3)]:
            found = self.grid({"half_width_m": half_width_m, "resolution_m": resolution_m})
            self.assertEqual(found, {"half_width_m": wanted, "resolution_m": resolution_m})
        found = self.grid({"half_width_m": 5, "resolution_m": 0.1}, terrain={"grid": {"resolution_m": 0.4}})
        self.assertEqual(found, {"half_width_m": 15.2, "resolution_m": 0.4})

    def test_coarse_bins_leave_the_terrain_fine(self):
        """Nodes at the bins' spacing would lose the rocks that a footprint must resolve: the spacing is at most max(0.1 m, footprint/17)."""
        for resolution_m, footprint_m, wanted in [(1, None, 0.1), (0.1, 3.4, 0.1), (1, 3.4, 0.2), (0.15, 3.4, 0.15), (1, 0.5, 0.1), (0.02, 0.5, 0.02),
                                                  (2, 17, 1), (1, 10, 0.588235294)]:
            found = self.grid({"half_width_m": 6, "resolution_m": resolution_m}, **({"eval": {"footprint_m": footprint_m}} if footprint_m else {}))
            self.assertEqual(found["resolution_m"], wanted)
            self.assertAlmostEqual(found["half_width_m"] / wanted, round(found["half_width_m"] / wanted), 6)
            self.assertGreaterEqual(found["half_width_m"], 16 - 1e-9)
        self.assertEqual(json.loads(self.run_chain("--print-config", chain={"area": {"resolution_m": 1}, "hazard": None}).stdout)["regrid"], {"resolution_m": 1})
        result = self.run_chain("--print-config", code=2, chain={"area": {"resolution_m": 1}, "eval": {"footprint_m": -1}})
        self.assertIn("/eval: /footprint_m: -1", result.stderr)

    def test_errors_name_the_section(self):
        for chain, words in [({"area": {"half_with_m": 2}}, "chain.json: /area/half_with_m: unknown key"),
                             ({"draws": 5}, "chain.json: /draws: unknown key"),
                             ({"terrain": {"grid": {"half_width_m": 5, "resolution_m": 0.3}}}, "chain.json: /terrain: /grid")]:
            with self.subTest(words):
                self.assertIn(words, self.run_chain(code=2, chain=chain).stderr)
                self.assertFalse(os.path.exists(self.path("out")))

    def test_a_raster_in_place_of_the_terrain(self):
        self.ground()
        ground = ["--from", self.path("chains/ground.tif"), "--center", "3,2"]
        self.assertIn("--from replaces the section terrain", self.run_chain(*ground).stderr)
        self.succeed("terrain-gen", *ground, "--half-width", "15", "--resolution", "0.1", "-o", self.path("site.h5"))
        self.assertEqual(read_bytes(self.out("terrain.h5")), read_bytes(self.path("site.h5")))
        before = self.states()
        self.run_chain(*ground)
        self.assertEqual(self.states(), before)

    def ground(self):
        """A raster in a folder of its own."""
        os.mkdir(self.path("chains"))
        self.succeed("terrain-gen", "-o", self.path("ground.h5"), "--set", "grid.half_width_m=40", "--set", "base.slope_x=0.05",
                     "--set", "grid.resolution_m=1")
        self.succeed("terrain-gen", "--from", self.path("ground.h5"), "-o", self.path("chains/ground.tif"))

    def test_a_chain_file_names_its_raster_and_site(self):
        self.ground()
        cone = {"type": "cone", "radius_m": 1, "height_m": 0.5}
        terrain = {"from": "ground.tif", "center": [3, 2], "base": {"datum": "none"}, "features": [cone]}
        for area, sizes in [(CHAIN["area"], ["--half-width", "15", "--resolution", "0.1"]), ({}, [])]:
            chain = self.config({**CHAIN, "area": area, "terrain": terrain}, "chains/chain.json")
            printed = json.loads(self.succeed("landfall", "run", "-c", chain, "-o", "x", "--print-config", cwd=self.folder).stdout)["terrain"]
            self.assertEqual(printed["base"], {"type": "dem", "path": self.path("chains/ground.tif"), "center": [3, 2], "datum": "none"})
            single = self.config({"base": {"datum": "none"}, "features": [cone]}, "single.json")
            self.succeed("terrain-gen", "--from", self.path("chains/ground.tif"), "--center", "3,2", *sizes, "-c", single, "-O", "-o", self.path("site.h5"))
            self.assertEqual(printed["grid"], config_of(self.path("site.h5"))["grid"])
            if sizes:
                result = run("landfall", "run", "-c", "chains/chain.json", "-o", "out", cwd=self.folder)
                self.assertEqual(result.returncode, 0, result.stderr)
                self.assertEqual(read_bytes(self.out("terrain.h5")), read_bytes(self.path("site.h5")))

    def test_a_mesh_in_place_of_a_raster(self):
        self.succeed("terrain-gen", "-o", self.path("m.h5"), "--set", "grid.half_width_m=20", "--set", "grid.resolution_m=1")
        self.succeed("terrain-gen", "--from", self.path("m.h5"), "-o", self.path("mesh.obj"))
        self.run_chain(chain={**CHAIN, "terrain": {"from": "mesh.obj", "mesh": {"scale_m": 2}}})
        self.succeed("terrain-gen", "-c", self.config({"mesh": {"path": self.path("mesh.obj"), "scale_m": 2}}), "-o", self.path("single.h5"))
        self.assertEqual(read_bytes(self.out("terrain.h5")), read_bytes(self.path("single.h5")))

    def test_draws_take_the_raster_of_a_chain_file(self):
        self.ground()
        common = {"draws": 2, "area": CHAIN["area"], "scan": SCAN, "eval": CHAIN["eval"], "layers": False}
        named = self.config({**common, "terrain": {"from": "ground.tif", "center": [3, 2]}}, "chains/mc.json")
        base = {"type": "dem", "path": self.path("chains/ground.tif"), "center": [3, 2]}
        plain = self.config({**common, "terrain": {"base": base, "grid": {"half_width_m": 15, "resolution_m": 0.1}}}, "plain.json")
        for name, path in [("a.h5", named), ("b.h5", plain)]:
            self.succeed("monte-carlo", "-c", path, "-o", self.path(name))
        self.assertEqual(read_bytes(self.path("a.h5")), read_bytes(self.path("b.h5")))

    def test_a_raster_that_the_section_contradicts_is_refused(self):
        self.ground()
        for terrain, words in [({"from": 5}, "chain.json: /terrain/from: 5 is of type integer"),
                               ({"from": "g.tif", "center": [1]}, "chain.json: /terrain/center: an array of 1"),
                               ({"from": "g.tif", "base": {"path": "h.tif"}}, "chain.json: /terrain: /base/path: "),
                               ({"from": "g.tif", "center": [1, 2], "base": {"center": [1, 2]}}, "chain.json: /terrain: /base/center: "),
                               ({"from": "g.tif", "base": {"dataum": "none"}}, "chain.json: /terrain: /base/dataum: unknown key")]:
            with self.subTest(words):
                self.assertIn(words, self.run_chain(code=2, chain={**CHAIN, "terrain": terrain}).stderr)
                self.assertFalse(os.path.exists(self.path("out")))

    def test_without_hazards(self):
        self.run_chain(chain={**CHAIN, "hazard": None})
        self.assertEqual(sorted(os.listdir(self.path("out"))), sorted({*OUTPUTS, STATE} - {"hazards.h5", "hazards.html", "sites.json"}))

    def test_its_configuration_is_never_overwritten(self):
        os.mkdir(self.path("out"))
        config = self.config(CHAIN, "out/metrics.json")
        result = run("landfall", "run", "-c", config, "-o", self.path("out"), "-O")
        self.assertEqual(result.returncode, 2)
        self.assertIn("is an input of this run", result.stderr)
        self.assertEqual(json.loads(read_bytes(config)), CHAIN)

    def test_monte_carlo_takes_the_area(self):
        self.run_chain("--set", "scan.noise.dropout_frac=0", "--set", "scan.noise.dead_pixel_frac=0")
        config = self.config({"area": CHAIN["area"], "draws": 2, "eval": CHAIN["eval"]}, "mc.json")
        sections = {"regrid": {"half_width_m": 5, "resolution_m": 0.1}, "eval": {**CHAIN["eval"], "region_radius_m": 4}}
        plain = self.config({**sections, "draws": 2}, "plain.json")
        for name, path in [("a.h5", config), ("b.h5", plain)]:
            self.succeed("monte-carlo", self.out("scan.h5"), "--terrain", self.out("terrain.h5"), "-c", path, "-o", self.path(name))
        self.assertEqual(read_bytes(self.path("a.h5")), read_bytes(self.path("b.h5")))

    def test_manual_pages(self):
        for words in (["--print-man"], ["run", "--print-man"]):
            page = run("landfall", *words).stdout
            checked = subprocess.run(["groff", "-man", "-Tutf8", "-ww"], input=page, capture_output=True, text=True, check=True)
            self.assertEqual(checked.stderr, "")
        self.assertTrue(re.search(r"\.TH LANDFALL.RUN 1", page), page[:80])


if __name__ == "__main__":
    assert os.path.exists(tool("landfall"))
    unittest.main()
