#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Configurations of the four tools: from files, standard input, --set and --seed, and which ones are refused."""
import json
import math
import os
import subprocess
import unittest

from harness import CONFIGS, INPUTS, TOOLS, ToolTest, tool, with_values, write_file
from landfall.errors import UsageError
from landfall.schema import read_json

# A key of each tool's configuration, a valid value of it and one out of range.
KEYS = {"terrain-gen": ("grid.resolution_m", 0.2, -1), "scan-sim": ("noise.range_sigma_m", 0.03, -0.01),
        "regrid": ("resolution_m", 0.2, 0), "dem-eval": ("limits.invalid_frac", 0.5, 1.5),
        "hazard-map": ("limits.slope_deg", 12, 0), "monte-carlo": ("draws", 10, 0)}
MISSPELT = {"terrain-gen": ("feature", "features"), "scan-sim": ("trajektory", "trajectory"),
            "regrid": ("resolution", "resolution_m"), "dem-eval": ("region_radius", "region_radius_m"),
            "hazard-map": ("touchdown_sigma", "touchdown_sigma_m"), "monte-carlo": ("draw", "draws")}


class Check(ToolTest):
    """--check validates the configuration and does nothing else."""

    def test_a_valid_config_is_silent_and_writes_nothing(self):
        for name in TOOLS:
            result = self.succeed(name, "-c", self.config(CONFIGS[name]), "--check", "-o", self.path("out.h5"))
            self.assertEqual((result.stdout, self.entries()), ("", ["config.json"]))

    def test_check_opens_no_data(self):
        inputs = {"terrain-gen": ["--set", 'base={"type":"dem","path":"/nowhere/dem.tif"}'],
                  "scan-sim": ["--terrain", "/nowhere/terrain.h5", "--set",
                               'trajectory={"type":"table","path":"/nowhere/table.csv"}'],
                  "regrid": ["/nowhere/scan.h5", "--terrain", "/nowhere/terrain.h5"],
                  "dem-eval": ["/nowhere/dem.h5"], "hazard-map": ["/nowhere/dem.h5", "--terrain", "/nowhere/terrain.h5"],
                  "monte-carlo": ["/nowhere/scan.h5", "--terrain", "/nowhere/terrain.h5"]}
        for name in TOOLS:
            self.succeed(name, "--check", *inputs[name])


class Resolved(ToolTest):
    """The keys that --print-config adds to the given ones."""

    def resolved(self, *values):
        return json.loads(self.succeed("scan-sim", "--print-config", *values).stdout)

    def test_the_pixel_pitch_is_resolved_unless_fov_is_given(self):
        self.assertAlmostEqual(self.resolved()["detector"]["ifov_rad"], 1.6e-3 / 18, delta=1e-18)
        self.assertNotIn("ifov_rad", self.resolved("--set", "detector.fov_deg=1")["detector"])

    def test_a_whole_number_is_an_integer_however_it_is_written(self):
        self.assertEqual(self.resolved("--set", "detector.rows=3.0")["detector"]["rows"], 3)
        self.refuse(2, "scan-sim", "--print-config", "--set", "detector.rows=3.5", words=["/detector/rows", "3.5"])

    def test_a_file_may_follow_a_value(self):
        for name, key in [("regrid", "resolution_m=0.2"), ("dem-eval", "region_radius_m=4")]:
            self.refuse(1, name, "-o", self.path("out.h5"), "--set", key, self.path("nowhere.h5"),
                        words=["nowhere.h5: no such file"])


class Config(ToolTest):
    """A wrong configuration gives exit code 2, no output, and one line that names the key, the value and the bound."""

    def refuse_config(self, name, text, words):
        output = self.path("out.h5")
        self.refuse(2, name, "-c", self.config(text), "-o", output, *INPUTS[name], words=words, output=output)

    def test_unknown_key(self):
        for name in TOOLS:
            word, meant = MISSPELT[name]
            self.refuse_config(name, {word: 1}, ["config.json", f"/{word}", f'did you mean "{meant}"?'])
        self.refuse_config("scan-sim", {"noise": {"dropout": 0.1}}, ["/noise/dropout", "dropout_frac"])

    def test_value_out_of_range(self):
        for name in TOOLS:
            key, _, bad = KEYS[name]
            config = with_values({"grid": {}, "noise": {}, "limits": {}}, **{key.replace(".", "__"): bad})
            config = {k: v for k, v in config.items() if v != {}}
            self.refuse_config(name, config, ["/" + key.replace(".", "/"), str(bad)])

    def test_wrong_type(self):
        for name in TOOLS:
            key = KEYS[name][0]
            config = with_values({"grid": {}, "noise": {}, "limits": {}}, **{key.replace(".", "__"): "much"})
            config = {k: v for k, v in config.items() if v != {}}
            self.refuse_config(name, config, ["/" + key.replace(".", "/"), '"much"', "integer" if name == "monte-carlo" else "number"])

    def test_nan_infinity_and_overflow_are_not_json(self):
        for name in TOOLS:
            for value in ["NaN", "nan", "Infinity", "-Infinity", "1e999"]:
                self.refuse_config(name, f'{{"seed": {value}}}', ["config.json", "not valid JSON"])

    def test_duplicate_key(self):
        for name in TOOLS:
            self.refuse_config(name, '{"a": {"b": 1, "b": 2}}', ["config.json", '"b"', "twice"])

    def test_text_that_is_not_a_json_object(self):
        for name in TOOLS:
            for text in ["", "{", "{}}", "nonsense", '{"a": 1,}', "\0\0\0\0", '{"a": "\udcff"}']:
                self.write("config.json", text.encode("utf-8", "surrogateescape"))
                self.refuse(2, name, "-c", self.path("config.json"), "--check", words=["config.json"])
            self.refuse_config(name, "[]", ["config.json", "object"])
            self.refuse_config(name, "3", ["config.json", "object"])

    def test_config_that_cannot_be_read(self):
        for name in TOOLS:
            self.refuse(2, name, "-c", self.path("none.json"), "--check", words=["none.json"])
            self.refuse(2, name, "-c", self.folder, "--check", words=[self.folder])

    def test_a_byte_order_mark_is_skipped_and_a_nul_byte_refused(self):
        """With the same words as in a study's JSON. The JSON parser takes a NUL byte for the end of the text."""
        path = self.path("config.json")
        for content, at in ((b"\xef\xbb\xbf{}", None), (b"{}\0", (1, 3)), (b"{}\0garbage", (1, 3)), (b"\0", (1, 1)),
                            (b'\xef\xbb\xbf{"seed": 1\0}', (1, 11)), (b'{\n"seed": 1}\n\0', (3, 1))):
            write_file(path, content)
            if at is None:
                self.succeed("terrain-gen", "-c", path, "--check")
                self.assertEqual(read_json(path), {})
                continue
            place = f"a NUL byte at line {at[0]}, column {at[1]}"
            self.refuse(2, "terrain-gen", "-c", path, "--check", words=[path, f"not valid JSON: {place}"])
            with self.assertRaisesRegex(UsageError, f"not JSON: {place}$"):
                read_json(path)

    def test_a_number_of_many_digits_is_abbreviated(self):
        for text in ("9" * 100000, "-" + "9" * 100000):
            result = self.refuse(2, "terrain-gen", "-c", self.config('{"seed": %s}' % text), "--check",
                                 words=["number overflow parsing '" + text[:20], "...'"])
            self.assertLess(len(result.stderr), 300)

    def test_deep_nesting_is_refused(self):
        for name in TOOLS:
            self.refuse_config(name, '{"a":' * 50000 + "1" + "}" * 50000, ["config.json"])


class Assignments(ToolTest):
    """--set, the config file, standard input and --seed."""

    def resolved(self, name, *arguments, **options):
        return json.loads(self.succeed(name, "--print-config", *arguments, **options).stdout)

    def test_set_overrides_the_file_and_earlier_assignments(self):
        for name in TOOLS:
            key, value, _ = KEYS[name]
            folder, _, leaf = key.rpartition(".")
            config = self.config(CONFIGS[name])
            resolved = self.resolved(name, "-c", config, "--set", f"{key}=0.4", f"--set={key}={value}")
            self.assertEqual((resolved[folder] if folder else resolved)[leaf], value)

    def test_set_takes_arrays_objects_texts_and_indices(self):
        scan = self.resolved("scan-sim", "--set", "mount.position_m=[1, 2, 3]", "--set", "mount.position_m.1=-4",
                             "--set", 'scanner={"type": "flash"}', "--set", "detector.ifov_rad=[1e-3,2e-3]")
        self.assertEqual(scan["mount"]["position_m"], [1, -4, 3])
        self.assertEqual(scan["scanner"], {"type": "flash"})
        self.assertEqual(scan["detector"]["ifov_rad"], [1e-3, 2e-3])
        self.assertEqual(self.resolved("regrid", "--set", 'truth_at="centroid"')["truth_at"], "centroid")

    def test_invalid_assignments(self):
        for name in TOOLS:
            for text in ["a", "=1", "a=", "a=[1", 'a="open', "a..b=1", '{"a":1}']:
                self.refuse(2, name, "--check", "--set", text, words=["--set", text])
        self.refuse(2, "scan-sim", "--check", "--set", "seed=1", "--set", "seed.x=1", words=["--set seed.x=1"])

    def test_a_word_is_a_text(self):
        self.assertEqual(self.resolved("regrid", "--set", "truth_at=centroid")["truth_at"], "centroid")
        self.assertEqual(self.resolved("scan-sim", "--set", "scanner.type=flash")["scanner"], {"type": "flash"})
        for text in ["abc", "NaN", "0,01", "1e", "True"]:
            self.refuse(2, "scan-sim", "--check", "--set", f"noise.range_sigma_m={text}",
                        words=["/noise/range_sigma_m", f'"{text}" is of type string, not number'])

    def test_a_key_and_its_value_in_two_arguments(self):
        for value in ["0.01", "-3", "[1,2]"]:
            self.refuse(2, "scan-sim", "--set", "noise.range_sigma_m", value,
                        words=[f"expected KEY=JSON; write --set noise.range_sigma_m={value}"])
        result = self.refuse(2, "scan-sim", "--set", "noise.range_sigma_m", "--check", words=["expected KEY=JSON"])
        self.assertNotIn("write", result.stderr)

    def test_several_files_merge_in_order(self):
        first = self.config({"laser": {"scan_time_s": 1, "pulse_rate_hz": 100}, "seed": 5}, "first.json")
        second = self.config('// a shorter scan\n{"laser": {"scan_time_s": 0.5 /* s */}, "seed": null}', "second.json")
        resolved = self.resolved("scan-sim", "-c", first, "--config", second)
        self.assertEqual((resolved["laser"]["scan_time_s"], resolved["laser"]["pulse_rate_hz"]), (0.5, 100))
        self.assertEqual(resolved["seed"], 1)  # null removes a key, which then has its default
        self.refuse(2, "scan-sim", "-c", first, "-c", self.config({"nope": 1}, "third.json"), "--check",
                    words=["first.json + ", "third.json: /nope"])

    def test_presets(self):
        names = [line.split()[0] for line in self.succeed("scan-sim", "--list-presets").stdout.splitlines()]
        self.assertIn("paper", names)
        for name in names:
            self.succeed("scan-sim", "-c", f"preset:{name}", "--check", cwd=self.folder)
        resolved = self.resolved("scan-sim", "-c", "preset:paper", "-c", self.config({"seed": 3}))
        self.assertEqual((resolved["seed"], resolved["scanner"]["pattern"]["rows"]), (3, 247))
        self.refuse(2, "scan-sim", "-c", "preset:papr", "--check", words=["did you mean preset:paper?"])
        self.refuse(2, "regrid", "-c", "preset:paper", "--check", words=["this tool has none"])
        self.refuse(2, "regrid", "--list-presets", words=["unknown option --list-presets"])

    def test_a_part_of_a_type_suggests_it(self):
        self.refuse(2, "terrain-gen", "--check", "--set", 'patterns=[{"type": "rocks"}]', words=['did you mean "golombek_rocks"?'])

    def test_config_from_standard_input(self):
        for name in TOOLS:
            self.assertEqual(self.resolved(name, "-c", "-", stdin=json.dumps(CONFIGS[name])),
                             self.resolved(name, "-c", self.config(CONFIGS[name])))
            self.refuse(2, name, "-c", "-", "--check", stdin='{"nope": 1}', words=["standard input", "/nope"])
            self.refuse(2, name, "-c", "-", "--check", stdin="", words=["standard input"])

    def test_standard_input_that_cannot_be_read(self):
        for name in TOOLS:
            folder = os.open("/", os.O_RDONLY)
            self.addCleanup(os.close, folder)
            result = subprocess.run([tool(name), "-c", "-", "--check"], stdin=folder, capture_output=True, text=True, timeout=60,
                                    check=False)
            self.assertEqual((result.returncode, result.stderr), (2, f"{name}: standard input: cannot be read completely\n"))

    def test_config_through_a_pipe(self):
        for name in TOOLS:
            script = f"{tool(name)} -c <(echo '{{}}') --print-config"
            result = subprocess.run(["bash", "-c", script], capture_output=True, text=True, timeout=60, check=False)
            self.assertEqual((result.returncode, result.stderr), (0, ""))
            self.assertEqual(json.loads(result.stdout), self.resolved(name))

    def test_a_configuration_has_a_largest_size(self):
        """A device without an end does not fill the memory."""
        self.refuse(2, "scan-sim", "--check", "-c", "/dev/zero", words=["/dev/zero: is larger than 64 MiB"])
        with open("/dev/zero", "rb") as zeros:
            result = subprocess.run([tool("scan-sim"), "--check", "-c", "-"], stdin=zeros, capture_output=True, text=True, timeout=100, check=False)
        self.assertEqual(result.returncode, 2)
        self.check_message("scan-sim", result.stderr, ["standard input: is larger than 64 MiB"])
        with self.assertRaisesRegex(UsageError, "^/dev/zero: is larger than 64 MiB"):
            read_json("/dev/zero")

    def test_seed_option_overrides_set_and_file(self):
        for name in ["terrain-gen", "scan-sim"]:
            config = self.config({"seed": 5})
            self.assertEqual(self.resolved(name)["seed"], 1)
            self.assertEqual(self.resolved(name, "-c", config)["seed"], 5)
            self.assertEqual(self.resolved(name, "-c", config, "--set", "seed=6")["seed"], 6)
            self.assertEqual(self.resolved(name, "-c", config, "--set", "seed=6", "--seed", "7")["seed"], 7)
            self.assertEqual(self.resolved(name, "--seed", 2**53 - 1)["seed"], 2**53 - 1)
            for bad in ["-1", "x", "1.5", str(2**53)]:
                self.refuse(2, name, "--check", "--seed", bad, words=["--seed"])


def numbers(schema, path=""):
    """(path, schema) of every number within a JSON schema."""
    if isinstance(schema, list):
        for index, item in enumerate(schema):
            yield from numbers(item, f"{path}/{index}")
    elif isinstance(schema, dict):
        types = schema.get("type")
        types = types if isinstance(types, list) else [types]
        if "number" in types or "integer" in types:
            yield path, schema
        for key, item in schema.items():
            yield from numbers(item, f"{path}/{key}")


def is_bounded(schema):
    return "enum" in schema or all(any(math.isfinite(schema.get(word, math.inf)) for word in words)
                                   for words in (("minimum", "exclusiveMinimum"), ("maximum", "exclusiveMaximum")))


class Bounds(ToolTest):
    """No value may be so large that a result overflows."""

    # They are values of keys, or factors of them, and the tools check the product.
    OF_KEYS = ("/definitions/spaced/items", "/definitions/axis/properties/scale", "/definitions/draw/properties/normal",
               "/definitions/draw/properties/uniform/items")

    def test_every_number_of_every_schema_is_bounded(self):
        for name in TOOLS:
            schema = json.loads(self.succeed(name, "--print-schema").stdout)
            found = dict(numbers(schema))
            self.assertGreaterEqual(len(found), 4)
            self.assertEqual([path for path, item in found.items() if not is_bounded(item)], [], name)
        with open(os.path.join(os.environ["LANDFALL_ROOT"], "schemas", "study.schema.json"), encoding="utf-8") as file:
            unbounded = [path for path, item in numbers(json.load(file)) if not is_bounded(item)]
        self.assertEqual([path for path in unbounded if not path.startswith(self.OF_KEYS)], [])

    def test_values_that_no_lidar_has_are_refused(self):
        for name, key, value in (("scan-sim", "noise.range_sigma_m", 1e308), ("scan-sim", "noise.range_bias_m", -1e200),
                                 ("scan-sim", "trajectory.position_m", [0, 0, 1e200]), ("scan-sim", "detector.distortion.k3", 1e300),
                                 ("regrid", "uncertainty.range_sigma_m", 1e200), ("dem-eval", "footprint_m", 1e300),
                                 ("terrain-gen", "base.slope_x", 1e308), ("terrain-gen", "base.elevation_m", -1e308)):
            self.refuse(2, name, "--set", f"{key}={json.dumps(value)}", "--check", words=["/" + key.replace(".", "/"), " is not in "])


if __name__ == "__main__":
    unittest.main()
