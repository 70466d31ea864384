#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""The common behaviour of the four tools (docs/user/cli.md): options, exit codes, messages, refusals."""
import json
import os
import shutil
import stat
import subprocess
import time
import unittest

import h5py
import jsonschema
import numpy as np

from harness import CONFIGS, INPUTS, PROGRAMS, TOOLS, ChainTest, ToolTest, attributes, read_bytes, run, tool, write_file

COMMON = ["-c,--config", "--set", "-o,--output", "-O,--overwrite", "-t,--threads", "-q,--quiet", "-v,--verbose",
          "--progress", "--no-progress", "--json", "--print-config", "--print-schema", "--check", "-V,--version",
          "-h,--help", "--compression", "--record-environment", "--log"]
ALL = [name for name in PROGRAMS if name != "landfall"]


class Information(ToolTest):
    """Options that print information and exit: they open no input and write no file."""

    def test_help_names_every_shared_option_and_seed_only_for_random_tools(self):
        for name in TOOLS:
            text = self.succeed(name, "--help").stdout
            for option in COMMON:
                self.assertIn(option, text, name)
            self.assertEqual("--seed" in text, name in ["terrain-gen", "scan-sim", "monte-carlo"], name)
            self.assertEqual(run(name, "-h").stdout, text)

    def test_texts_fit_80_columns(self):
        for name in ALL:
            for line in self.succeed(name, "--help").stdout.splitlines():
                self.assertLessEqual(len(line), 80, f"{name}: {line}")
        for line in self.succeed("scan-sim", "--list-presets").stdout.splitlines():
            self.assertLessEqual(len(line), 80, line)

    def test_help_does_not_load_gdal(self):
        for name in TOOLS:
            result = subprocess.run([tool(name), "--help"], env={**os.environ, "LD_DEBUG": "files"},
                                    capture_output=True, text=True, check=True)
            self.assertIn("libc.so", result.stderr, "LD_DEBUG does not list the loaded libraries")
            self.assertNotIn("libgdal", result.stderr, name)

    def test_the_timer_of_libhwy_is_not_measured(self):
        result = subprocess.run([tool("regrid"), "--version"], env={**os.environ, "LD_DEBUG": "bindings"},
                                capture_output=True, text=True, check=True)
        self.assertIn("libhwy", result.stderr, "LD_DEBUG does not list the bindings")
        for line in result.stderr.splitlines():
            if "platform15TimerResolution" in line:
                self.assertRegex(line, r" to \S*/liblandfall\.so \[0\]: ")

    def test_no_library_is_taken_from_the_current_folder(self):
        for name in ("libpng16.so.16", "libudunits2.so.0"):
            self.write(name, "not a library")
        subprocess.run([os.path.abspath(tool("regrid")), "--version"], cwd=self.path(""), capture_output=True, check=True)

    def test_version_is_one_line_with_tool_and_number(self):
        for name in TOOLS:
            text = self.succeed(name, "--version").stdout
            self.assertRegex(text, rf"\Alandfall {name} \d+\.\d+\.\d+ \(git [^)\n]+\)\n\Z")
            self.assertEqual(run(name, "-V").stdout, text)

    def test_print_config_is_resolved_and_can_be_used_again(self):
        for name in TOOLS:
            for config in ({}, CONFIGS[name]):
                first = self.succeed(name, "-c", self.config(config), "--print-config").stdout
                again = self.succeed(name, "-c", self.config(first), "--print-config").stdout
                self.assertEqual(first, again, name)
                self.assertContains(json.loads(first), config)
        self.assertEqual(self.entries(), ["config.json"])

    def assertContains(self, resolved, given):
        if not isinstance(given, dict):
            self.assertEqual(resolved, given)
            return
        for key, value in given.items():
            if isinstance(value, dict):
                self.assertContains(resolved[key], value)

    def test_the_documented_defaults(self):
        def resolved(name):
            return json.loads(self.succeed(name, "--print-config").stdout)
        self.assertEqual(resolved("regrid"), {"resolution_m": 0.05, "half_width_m": 50, "truth_at": "bin_center",
                                              "method": "bilinear_nearest"})
        self.assertEqual(resolved("dem-eval"), {
            "region_radius_m": 50, "region": {"shape": "circle"}, "footprint_m": 1.7, "footprint_shape": "square",
            "quantile": 0.95,
            "limits": {"invalid_frac": 0.01, "hole_bins": 10, "distance_bins": 1, "relative_elevation_m": 0.05,
                       "relative_horizontal_m": 0.05, "absolute_horizontal_m": 1,
                       "absolute_horizontal_frac": 0.95}})
        self.assertEqual(resolved("hazard-map"), {
            "lander": {"legs": 4, "leg_radius_m": 0.85, "pad_diameter_m": 0.2, "pad_height": "max", "body_radius_m": 0.85},
            "method": "contact", "region_radius_m": 50, "limits": {"slope_deg": 10, "roughness_m": 0.3},
            "hole_fill_bins": 10, "z_sigma_m": None, "touchdown_sigma_m": 1, "seed": 1,
            "sites": {"count": 5, "separation_m": 5, "divert_radius_m": 40, "divert_weight": 0.1, "min_p": 0.99}})
        terrain = resolved("terrain-gen")
        self.assertEqual((terrain["grid"], terrain["features"], terrain["patterns"], terrain["seed"]),
                         ({"half_width_m": 60, "resolution_m": 0.05}, [], [], 1))
        scan = resolved("scan-sim")
        self.assertEqual(scan["detector"], {"rows": 18, "columns": 18, "subpixels": 1, "roll_deg": 0,
                                            "ifov_rad": 1.6e-3 / 18, "distribution": "uniform",
                                            "distortion": {"k1": 0, "k2": 0, "k3": 0}, "fill_factor": 1,
                                            "estimator": "mean", "range_resolution_m": 0.15})
        self.assertEqual(scan["laser"], {"pulse_rate_hz": 20000, "scan_time_s": 2})
        self.assertEqual(scan["trajectory"], {
            "type": "constant_velocity", "position_m": [0, 0, 500], "velocity_mps": [0, 0, -23],
            "rpy_deg": [0, 0, 0], "rpy_rate_degps": [0, 0, 0]})

    def test_print_schema_is_a_draft_07_schema_that_accepts_the_empty_and_the_resolved_config(self):
        for name in TOOLS:
            schema = json.loads(self.succeed(name, "--print-schema").stdout)
            self.assertEqual(schema["$schema"], "http://json-schema.org/draft-07/schema#")
            jsonschema.Draft7Validator.check_schema(schema)
            validator = jsonschema.Draft7Validator(schema)
            validator.validate({})
            validator.validate(CONFIGS[name])
            validator.validate(json.loads(run(name, "--print-config").stdout))
            self.assertFalse(validator.is_valid({"no_such_key": 1}), name)

    def test_information_that_cannot_be_written_is_a_failure(self):
        for name in TOOLS:
            for option in ["--help", "--version", "--print-config", "--print-schema"]:
                with open("/dev/full", "w", encoding="utf-8") as full:
                    result = subprocess.run([tool(name), option], stdout=full, stderr=subprocess.PIPE, text=True,
                                            check=False)
                self.assertEqual(result.returncode, 1, f"{name} {option}")
                self.check_message(name, result.stderr, ["standard output"])

class Usage(ToolTest):
    def test_unknown_flag(self):
        for name in TOOLS:
            self.refuse(2, name, "--no-such-flag", words=["--no-such-flag"])

    def test_arguments_must_be_utf_8(self):
        foreign = os.fsdecode(b"a\xf8")
        for name in ALL:
            self.refuse(2, name, foreign + ".h5", words=["argument 1, 'a?.h5'", "UTF-8"])
            self.refuse(2, name, "-q", "-o", foreign, words=["argument 3, 'a?'", "UTF-8"])
        self.refuse(2, "scan-sim", "--check", "--set", f"seed.{foreign}=1", words=["argument 3, 'seed.a?=1'", "UTF-8"])
        self.refuse(2, "terrain-gen", "--from", "a.tif", "--datum", foreign, words=["argument 4, 'a?'", "UTF-8"])
        self.assertEqual(self.entries(), [])

    def test_option_values_out_of_range(self):
        for name in TOOLS:
            for option, value in [("-t", "-1"), ("-t", "x"), ("--compression", "10"), ("--compression", "-1")]:
                self.refuse(2, name, option, value, words=[value])

    def test_missing_arguments(self):
        for name in TOOLS:
            self.refuse(2, name, "-o", words=["--output"])

    def test_an_empty_value_is_not_an_absent_option(self):
        files = {"terrain-gen": ["--from", "-c", "-o"], "scan-sim": ["--terrain", "--ranges-from"],
                 "regrid": ["--terrain"], "dem-eval": ["--metrics"],
                 "hazard-map": ["--terrain", "--sites", "--score"], "monte-carlo": ["--terrain", "--samples", "--report"]}
        long_names = {"-c": "--config", "-o": "--output"}
        for name, options in files.items():
            for option in options:
                wanted = f"{name}: {long_names.get(option, option)} needs a file\n"
                for arguments in ([option, ""], [f"{option}="] if option.startswith("--") else [option, ""]):
                    inputs = [] if option in INPUTS[name] else INPUTS[name]
                    result = self.refuse(2, name, *inputs, *arguments)
                    self.assertEqual(result.stderr.replace(" (see --help)", ""), wanted)
        for name, argument in [("regrid", "scans"), ("dem-eval", "dem"), ("hazard-map", "map"), ("monte-carlo", "scan")]:
            self.assertEqual(self.refuse(2, name, "").stderr, f"{name}: the argument {argument} needs a file\n")

    def test_without_an_output_no_input_is_opened(self):
        for name in TOOLS:
            self.refuse(2, name, *INPUTS[name], words=["-o"])


class Output(ChainTest):
    """Output paths: errors are found before the run, and an existing file is kept unless -O is given."""

    def test_a_file_that_the_run_reads_cannot_be_an_output(self):
        """Even with -O, the tools refuse to overwrite the configuration and the files that it names."""
        for name in TOOLS:
            config = self.config(CONFIGS[name], "mine.json")
            before = read_bytes(config)
            for output in (config, os.path.join(self.folder, ".", "mine.json")):
                self.refuse(2, name, *self.chain.inputs(name)[:-2], "-c", config, "-o", output, "-O",
                            words=["mine.json is an input of this run"])
            self.assertEqual(read_bytes(config), before)
        mask = self.path("mask.h5")
        shutil.copy(self.chain.eval, mask)
        before = read_bytes(mask)
        region = json.dumps({"shape": "mask", "path": mask, "layer": "in_region"})
        for option in ("-o", "--metrics", "--report"):
            self.refuse(2, "dem-eval", self.chain.dem, "--metrics-only", option, mask, "-O", "--set", f"region={region}",
                        words=["mask.h5 is an input of this run"])
        self.assertEqual(read_bytes(mask), before)

    def test_two_outputs_of_one_name(self):
        names = [("-o", "--metrics"), ("-o", "--report"), ("--metrics", "--report")]
        for first, second in names:
            others = [] if first == "-o" else ["--metrics-only"]
            self.refuse(2, "dem-eval", self.chain.dem, *others, first, "one", second, "./one", cwd=self.folder,
                        words=[f"{first} and {second} name the same file, ./one"])
        self.assertEqual(self.entries(), [])

    def test_only_a_regular_file_is_replaced(self):
        os.mkfifo(self.path("pipe.h5"))
        for name in TOOLS:
            self.refuse(2, name, *self.chain.inputs(name), "-o", self.path("pipe.h5"), "-O", words=["pipe.h5 is not a regular file"])
        self.assertTrue(stat.S_ISFIFO(os.stat(self.path("pipe.h5")).st_mode))

    def test_an_existing_output_is_refused_and_kept(self):
        output = self.path("out.h5")
        for name in TOOLS:
            self.write("out.h5", "precious")
            self.refuse(2, name, *self.chain.inputs(name), "-o", output, words=[output, "-O"])
            self.assertEqual(read_bytes(output), b"precious")

    def test_an_existing_output_is_refused_before_inputs_are_read(self):
        output = self.path("out.h5")
        for name in TOOLS:
            self.write("out.h5", "precious")
            self.refuse(2, name, *INPUTS[name], "-o", output, words=[output, "-O"])

    def test_overwrite_keeps_the_permissions(self):
        output = self.write("out.h5", "")
        for mode in (0o600, 0o664):
            os.chmod(output, mode)
            self.succeed("terrain-gen", *self.chain.inputs("terrain-gen"), "-o", output, "-O")
            self.assertEqual(stat.S_IMODE(os.stat(output).st_mode), mode)

    def test_overwrite_replaces_an_existing_output(self):
        output = self.path("out.h5")
        for name in TOOLS:
            self.write("out.h5", "precious")
            self.succeed(name, *self.chain.inputs(name), "-o", output, "-O")
            self.assertEqual(read_bytes(output), read_bytes(self.chain.output(name)), name)
            self.assertEqual(self.entries(), ["out.h5"])

    def test_a_folder_a_missing_folder_or_a_dangling_link_is_refused(self):
        os.symlink("/nowhere/x", self.path("dangling"))
        for name in TOOLS:
            self.refuse(2, name, *self.chain.inputs(name), "-o", self.folder, "-O", words=[self.folder])
            self.refuse(2, name, *self.chain.inputs(name), "-o", self.path("a/b.h5"), words=["a/b.h5"])
            self.refuse(2, name, *self.chain.inputs(name), "-o", self.path("dangling"), words=["dangling"])

    @unittest.skipIf(os.geteuid() == 0, "root may write anywhere")
    def test_a_folder_without_permission(self):
        os.mkdir(self.path("locked"))
        os.chmod(self.path("locked"), 0o500)
        for name in TOOLS:
            self.refuse(1, name, *self.chain.inputs(name), "-o", self.path("locked/out.h5"), words=["locked"])

    def test_a_name_with_spaces_and_other_letters(self):
        for name in TOOLS:
            self.succeed(name, *self.chain.inputs(name), "-o", self.path("größe 1 'x'.h5"), "-O")

    def test_compression_changes_the_size_not_the_content(self):
        for name in TOOLS:
            sizes = {}
            for level in (0, 9):
                output = self.path(f"{level}.h5")
                self.succeed(name, *self.chain.inputs(name), "-o", output, "-O", "--compression", level)
                sizes[level] = os.path.getsize(output)
                self.assertEqual(contents(output), contents(self.chain.output(name)), name)
            self.assertLess(sizes[9], sizes[0], name)


def contents(path):
    """The bytes of all datasets, and all attributes except the values of references."""
    found = {}

    def visit(name, item):
        if isinstance(item, h5py.Dataset):
            found[name] = item[()].tobytes() if item.shape else item[()]
        found[name, "attributes"] = sorted(
            (key, str(value)) for key, value in item.attrs.items()
            if key not in ("DIMENSION_LIST", "REFERENCE_LIST"))

    with h5py.File(path) as file:
        file.visititems(visit)
        found["/"] = sorted((key, str(value)) for key, value in file.attrs.items())
    return found


class Inputs(ChainTest):
    """Input files that are missing, of the wrong kind or damaged: exit code 1, and one line that names the file."""

    def arguments(self, name, data):
        """The tool's arguments with its main input replaced."""
        return {"scan-sim": ["--terrain", data], "regrid": [data],
                "dem-eval": [data], "hazard-map": [data],
                "monte-carlo": [data, "--terrain", self.chain.terrain]}[name] + ["-c", self.chain.config(name), "-o", self.path("out.h5")]

    def refuse_input(self, name, data, words=()):
        self.refuse(1, name, *self.arguments(name, data), words=[data, *words], output=self.path("out.h5"))

    READERS = {"scan-sim": "terrain", "regrid": "scan", "dem-eval": "dem", "hazard-map": "dem", "monte-carlo": "scan"}

    def test_missing_file_folder_or_text(self):
        self.write("text.h5", "x_est,y_est\n1,2\n")
        self.write("empty.h5", "")
        for name in self.READERS:
            self.refuse_input(name, self.path("none.h5"), ["no such file"])
            self.refuse_input(name, self.folder, ["directory"])
            self.refuse_input(name, self.path("text.h5"), ["HDF5"])
            self.refuse_input(name, self.path("empty.h5"), ["HDF5"])
        self.refuse(1, "regrid", self.chain.scan, "--terrain", self.path("none.h5"), "-o", self.path("out.h5"),
                    words=["none.h5"])

    def test_another_kind_of_file(self):
        for name, wanted in {**self.READERS, "hazard-map": "dem terrain"}.items():
            for kind in ["terrain", "scan", "dem", "eval", "hazards", "draws"]:
                if kind in wanted.split():
                    continue
                found = "evaluation" if kind == "eval" else kind
                self.refuse_input(name, getattr(self.chain, kind), [f"landfall.{found}", *(f"landfall.{kind}" for kind in wanted.split())])
        with h5py.File(self.path("foreign.h5"), "w") as file:
            file["z"] = [1.0]
        for name in self.READERS:
            self.refuse_input(name, self.path("foreign.h5"), ["format_name"])

    def test_a_file_of_a_later_format_or_an_incomplete_one(self):
        for name, kind in self.READERS.items():
            data = self.changed(getattr(self.chain, kind), lambda file: file.attrs.__setitem__("complete", 0))
            self.refuse_input(name, data, ["incomplete"])
            with h5py.File(data, "r+") as file:
                file.attrs["complete"] = 1
                file.attrs["format_version"] = "2.0"
            self.refuse_input(name, data, ["2.0"])

    def test_messages_quote_at_most_40_characters_of_a_file(self):
        for name, kind in self.READERS.items():
            for attribute in ["format_name", "format_version"]:
                data = self.changed(getattr(self.chain, kind), lambda file, key=attribute: file.attrs.__setitem__(key, "[" * 40000 + "\n"))
                self.refuse_input(name, data, ["[" * 40])
                self.assertNotIn("[" * 41, run(name, data).stderr)

    def test_texts_that_are_not_utf_8(self):
        foreign = np.bytes_(b"a\xff\xfe")
        for kind in ["terrain", "scan", "dem", "eval"]:
            data = self.path(kind + ".h5")
            shutil.copy(getattr(self.chain, kind), data)
            with h5py.File(data, "r+") as file:
                for holder, name in [(file, "file_id"), (file["provenance"], "tool"), (file["provenance"], "version")]:
                    del holder.attrs[name]
                    holder.attrs.create(name, foreign)
                for column in [c for c in file.values() if isinstance(c, h5py.Dataset) and "units" in c.attrs]:
                    for name in ["units", "long_name"]:
                        column.attrs.create(name, foreign)
            self.assertEqual(json.loads(self.succeed("landfall-info", "--json", data).stdout)["file_id"], "a\ufffd\ufffd")
            self.succeed("landfall-info", data)
            setattr(self, kind, data)
        self.succeed("scan-sim", "-c", self.chain.config("scan-sim"), "--terrain", self.terrain, "-o", self.path("s.h5"))
        self.succeed("regrid", self.scan, "-c", self.chain.config("regrid"), "--terrain", self.terrain, "--other-terrain", "-o",
                     self.path("d.h5"))
        self.succeed("dem-eval", self.dem, "-c", self.chain.config("dem-eval"), "-o", self.path("e.h5"))
        with h5py.File(self.path("e.h5")) as file:
            self.assertIn("a\ufffd\ufffd", file["provenance/chain_json"].asstr()[()])
        with h5py.File(self.terrain, "r+") as file:
            file[b"b\xff"] = [1.0]
        for name, arguments in [("landfall-info", []), ("scan-sim", ["-o", self.path("o.h5"), "--terrain"])]:
            self.refuse(1, name, *arguments, self.terrain, words=["holds an object whose name, 'b?', is not UTF-8"])

    def test_files_truncated_at_many_lengths(self):
        data = self.path("cut.h5")
        for name, kind in self.READERS.items():
            whole = read_bytes(getattr(self.chain, kind))
            for size in [1, 8, 100, 2048, 0.1, 0.25, 0.5, 0.75, 0.9, 0.99, len(whole) - 1]:
                cut = int(size * len(whole)) if isinstance(size, float) else size
                write_file(data, whole[:cut])
                self.refuse_input(name, data)

    def test_zeroed_data_never_cause_a_crash(self):
        data = self.path("holed.h5")
        for name, kind in self.READERS.items():
            whole = read_bytes(self.chain.source if name == "monte-carlo" else getattr(self.chain, kind))
            for piece in range(20):
                begin = len(whole) * piece // 20
                write_file(data, whole[:begin] + b"\xff" * 512 + whole[begin + 512:])
                result = run(name, *self.arguments(name, data), "-O")
                self.assertIn(result.returncode, (0, 1), f"{name} {piece}: {result.stderr}")
                if result.returncode == 1:
                    self.check_message(name, result.stderr, [data])

    def test_a_missing_dataset(self):
        for name, kind, key in [("scan-sim", "terrain", "z"), ("scan-sim", "terrain", "x"),
                                ("regrid", "scan", "points/x_est"), ("regrid", "scan", "points/status"),
                                ("regrid", "scan", "pulses/t"), ("regrid", "scan", "points"),
                                ("dem-eval", "dem", "z_est"), ("dem-eval", "dem", "y"), ("hazard-map", "dem", "z_est"),
                                ("hazard-map", "terrain", "z"), ("monte-carlo", "scan", "points/range_true")]:
            data = self.changed(getattr(self.chain, kind), lambda file, key=key: file.__delitem__(key))
            self.refuse_input(name, data, [key.rpartition("/")[2]])


class Summary(ChainTest):
    """--json prints one JSON object on stdout and does not change the file."""

    PHASES = {"terrain-gen": ["terrain", "write"], "scan-sim": ["trace"], "regrid": ["grid", "write"],
              "dem-eval": ["evaluate", "write"], "hazard-map": ["judge", "judge the truth", "sites"], "monte-carlo": ["read", "draw", "write"]}
    COUNTS = {"terrain-gen": ["node_count"], "scan-sim": ["pulse_count", "ray_count", "rays_per_s", "real_time_factor", "return_count"],
              "regrid": ["inside_count", "outside_count"], "dem-eval": ["metrics"],
              "hazard-map": ["places", "sites", "score"], "monte-carlo": ["verdict", "draws_per_s"]}

    def test_keys(self):
        for name in TOOLS:
            output = self.path("out.h5")
            text = self.succeed(name, *self.chain.inputs(name), "-o", output, "-O", "--json", "-t", "2").stdout
            summary = json.loads(text)
            self.assertEqual((summary["tool"], summary["threads"]), (name, 2))
            self.assertIsInstance(summary["peak_memory_bytes"], int)
            self.assertGreater(summary["peak_memory_bytes"], 1 << 20)
            self.assertGreater(summary["wall_s"], 0)
            self.assertGreater(summary["cpu_s"], 0)
            self.assertLessEqual(set(self.PHASES[name]), set(summary["phases"]))
            for phase in summary["phases"].values():
                self.assertEqual(set(phase), {"wall_s", "cpu_s"})
                self.assertGreaterEqual(phase["wall_s"], 0)
            self.assertLessEqual(set(self.COUNTS[name]), set(summary))
            self.assertEqual(read_bytes(output), read_bytes(self.chain.output(name)))

    def test_counts_agree_with_the_files(self):
        output = self.path("out.h5")
        scan = json.loads(self.succeed("scan-sim", *self.chain.inputs("scan-sim"), "-o", output, "--json").stdout)
        with h5py.File(output) as file:
            self.assertEqual(scan["return_count"], file["points/x_est"].shape[0])
            self.assertEqual(scan["pulse_count"], file["pulses/t"].shape[0])
            for key in ["return_count", "miss_count", "dropout_count", "dead_count"]:
                self.assertEqual(scan[key], file["points"].attrs[key])
        self.assertEqual(scan["ray_count"], 400 * 64)
        self.assertAlmostEqual(scan["rays_per_s"] * scan["phases"]["trace"]["wall_s"], 400 * 64, places=3)
        # The factor is 0.2 s of scan time divided by the time until the counts are final, slightly less than wall_s.
        self.assertGreaterEqual(scan["real_time_factor"] * scan["wall_s"], 0.2)
        self.assertLess(scan["real_time_factor"] * scan["wall_s"], 0.4)
        regrid = json.loads(self.succeed("regrid", *self.chain.inputs("regrid"), "-o", output, "-O",
                                         "--json").stdout)
        with h5py.File(output) as file:
            self.assertEqual(regrid["inside_count"], file["count"][()].sum())
        self.assertEqual(regrid["inside_count"] + regrid["outside_count"], scan["return_count"])

    def test_verbose_prints_on_stderr_and_quiet_overrides_it(self):
        for name in TOOLS:
            result = run(name, *self.chain.inputs(name), "-o", self.path("out.h5"), "-O", "-v")
            self.assertEqual((result.returncode, result.stdout), (0, ""))
            self.assertRegex(result.stderr, rf"(?m)^{name}: writes .*out\.h5$")
            self.assertRegex(result.stderr, rf"(?m)^{name}: \w+ took [0-9.]+ s$")
            for flags in (["-q"], ["-q", "-v"], ["-q", "--progress"], ["--no-progress"]):
                result = self.succeed(name, *self.chain.inputs(name), "-o", self.path("out.h5"), "-O", *flags)
                self.assertEqual(result.stdout, "")


class Privacy(ChainTest):
    """Files hold no host name, time or folder unless --record-environment is given."""

    def test_no_path_host_or_year_in_any_file(self):
        secrets = [self.chain.folder, os.uname().nodename, os.path.expanduser("~") + "/", os.getcwd(),
                   time.strftime("%Y-%m-%d"), os.path.dirname(tool("regrid"))]
        for name in TOOLS:
            text = all_text(self.chain.output(name))
            for secret in secrets:
                if len(secret) > 3:
                    self.assertNotIn(secret, text, name)
                    self.assertNotIn(secret.encode(), read_bytes(self.chain.output(name)), name)

    def test_record_environment_adds_host_clock_and_folder_and_nothing_else(self):
        output = self.path("out.h5")
        for name in TOOLS:
            self.succeed(name, *self.chain.inputs(name), "-o", output, "-O", "--record-environment")
            recorded = contents(output)
            environment = recorded.pop("provenance/environment_json").decode()
            recorded.pop(("provenance/environment_json", "attributes"))
            self.assertEqual(recorded, contents(self.chain.output(name)))
            self.assertIn(os.uname().nodename, environment)
            self.assertRegex(environment, r"\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ")

    def test_data_paths_in_the_config_are_cut_to_the_name(self):
        table = self.write("descent.csv", "t_s,x_m,y_m,z_m,qw,qx,qy,qz\n0,0,0,50,1,0,0,0\n1,0,0,45,1,0,0,0\n")
        self.succeed("scan-sim", "--terrain", self.chain.terrain, "-c", self.chain.config("scan-sim"), "-o",
                     self.path("out.h5"), "--set", "trajectory=" + json.dumps({"type": "table", "path": table}))
        text = all_text(self.path("out.h5"))
        self.assertIn("descent.csv", text)
        self.assertNotIn(self.folder, text)


def all_text(path):
    """All texts in the file."""
    texts = []

    def visit(name, item):
        texts.append(name)
        texts.extend(map(str, attributes(item).values()))
        if isinstance(item, h5py.Dataset) and item.dtype.kind in "OS" and not item.shape:
            texts.append(item.asstr()[()])

    with h5py.File(path) as file:
        texts.extend(map(str, attributes(file).values()))
        file.visititems(visit)
    return "\n".join(texts)


if __name__ == "__main__":
    unittest.main()
