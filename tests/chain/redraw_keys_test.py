#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Every key of a scan's configuration, changed by itself: a redraw that --ranges-from accepts equals a traced scan byte for byte, else it
is refused and the message names the key."""
import json
import os
import unittest

from harness import SCAN, ChainTest, read_bytes, run, scanner_types, with_values

SCANNERS = {"flash": {}, "gimbal": {"pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}}, "palmer": {"rate_hz": 40}, "polygon": {"facets": 12, "rate_hz": 3},
            "fsm": {"pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 4}},
            "risley": {"wedge_deg": [2, 2]}}
TABLES = {"distribution", "pixel_offset_table", "path", "table"}  # files: ranges_test.py, receiver_test.py
LINKS = {"pulse_energy_J", "wavelength_m", "aperture_m", "efficiency"}  # exclude reference_pe


def schema():
    return json.loads(read_bytes(os.path.join(os.environ["LANDFALL_ROOT"], "schemas", "scan.schema.json")))


ROOT_SCHEMA = schema()


def resolved(node):
    return {**ROOT_SCHEMA["definitions"][node["$ref"].rsplit("/", 1)[1]], **{key: value for key, value in node.items() if key != "$ref"}} \
        if "$ref" in node else node


def options_of(node):
    return [resolved(option) for option in node.get("oneOf", [node])]


def leaves(node, config, path=()):
    """(path, schema) of all keys below an object of this configuration."""
    node = resolved(node)
    kind = config.get("type") if isinstance(config, dict) else None
    for option in options_of(node):
        properties = option.get("properties", {})
        if not properties or properties.get("type", {}).get("const", kind) != kind:
            continue
        for key, inner in properties.items():
            inner, here = resolved(inner), (*path, key)
            if key in TABLES or key.startswith("$") or "const" in inner:
                continue
            below = config.get(key, inner.get("default", {})) if isinstance(config, dict) else {}
            if any("properties" in found for found in options_of(inner)):
                yield from leaves(inner, below, here)
            else:
                yield here, inner


def other_values(node, old):
    """Values that differ from the old one a little."""
    kinds = {"number": (int, float), "integer": int, "array": list, "string": str}
    node = next((option for option in options_of(node) if isinstance(old, kinds.get(option.get("type"), object))), options_of(node)[0])
    if "enum" in node:
        return [value for value in node["enum"] if value != old]
    if node.get("type") == "boolean":
        return [not old]
    if node.get("type") == "array":
        element = resolved(node["items"])
        if element.get("type") != "number":
            return [[{"axis": 1, "order": 2, "amplitude_rad": 1e-4}]] if not old else []
        size = node.get("minItems", 2)
        first = list(old) if old else [0.0] * size
        return [[changed(element, first[0]), *first[1:]]]
    return [changed(node, old)] if node.get("type") in ("number", "integer") else []


def changed(node, old):
    old = 0 if old is None else old
    step = 1 if node.get("type") == "integer" else abs(old) / 4 or 1e-4
    low, high = node.get("minimum", node.get("exclusiveMinimum", -1e9)), node.get("maximum", node.get("exclusiveMaximum", 1e9))
    return old + step if low < old + step < high else old - step


class RedrawKeys(ChainTest):
    def setUp(self):
        super().setUp()
        self.counts = {"accepted": set(), "refused": set(), "invalid": set()}

    def old_value(self, config, path, node):
        for key in path:
            config = config.get(key) if isinstance(config, dict) else None
        return node.get("default") if config is None else config

    def source(self, config, *options):
        self.succeed("scan-sim", "-c", self.config(config), "--terrain", self.chain.terrain, "--keep-misses", *options, "-O", "-o", self.path("source.h5"))

    def compare(self, config, key, value, *options):
        arguments = ["-c", self.config(config), "--set", f"{key}={json.dumps(value)}", "--keep-misses", *options, "-O", "-o"]
        redrawn = run("scan-sim", "--ranges-from", self.path("source.h5"), "--terrain", self.chain.terrain, *arguments, self.path("redrawn.h5"))
        traced = run("scan-sim", "--terrain", self.chain.terrain, *arguments, self.path("traced.h5"))
        if traced.returncode != 0:
            self.assertNotEqual(redrawn.returncode, 0, f"{key}={value}: {traced.stderr}")
            self.counts["invalid"].add(key)
        elif redrawn.returncode == 0:
            self.assertEqual(read_bytes(self.path("redrawn.h5")), read_bytes(self.path("traced.h5")), f"{key}={value}")
            self.counts["accepted"].add(key)
        else:
            self.assertEqual(redrawn.returncode, 2, redrawn.stderr)
            self.assertRegex(redrawn.stderr, f"/{key.replace('.', '/')}|/seed differs|Geiger|several returns|beams", f"{key}={value}")
            self.counts["refused"].add(key)

    def walk(self, config, sections, *options):
        self.source(config, *options)
        for section in sections:
            for path, node in leaves(ROOT_SCHEMA["properties"][section], config.get(section, {}), (section,)):
                if path[-1] in LINKS:
                    continue
                for value in other_values(node, self.old_value(config, path, node)):
                    self.compare(config, ".".join(path), value, *options)

    BASE = with_values(SCAN, detector__rows=4, detector__columns=4, laser__scan_time_s=0.02)

    def test_all_sections_without_a_receiver(self):
        self.walk(self.BASE, [name for name in ROOT_SCHEMA["properties"] if name not in ("$schema", "$comment", "scanner", "seed", "draw")])
        self.assertGreater(len(self.counts["accepted"]), 20, self.counts)
        self.assertGreater(len(self.counts["refused"]), 20, self.counts)
        self.assertLessEqual({"noise.range_bias_m", "pointing_error.time_stamp_bias_s", "navigation_error.velocity_mps"}, self.counts["accepted"])

    def test_the_receiver_and_its_light(self):
        config = {**self.BASE, "beam": {"divergence_rad": 0.03}, "surface": {"albedo": 0.5},
                  "link": {"reference_pe": 120, "reference_range_m": 50, "background_pe": 3},
                  "receiver": {"type": "leading_edge", "pulse_fwhm_s": 3e-10, "threshold_pe": 30}}
        self.walk(with_values(config, detector__subpixels=3), ["beam", "surface", "link", "receiver", "noise"], "--keep-echoes")
        self.assertLessEqual({"receiver.photon_noise", "receiver.jitter_sigma_s", "receiver.timer_step_s", "noise.false_range_m"}, self.counts["accepted"])
        self.assertLessEqual({"beam.divergence_rad", "surface.albedo", "link.background_pe", "receiver.threshold_pe", "receiver.type",
                              "receiver.returns"}, self.counts["refused"])

    def test_all_scanners(self):
        self.assertEqual({*SCANNERS, "table"}, scanner_types())  # a table's keys are files
        for name, values in SCANNERS.items():
            self.counts = {"accepted": set(), "refused": set(), "invalid": set()}
            self.walk({**self.BASE, "scanner": {"type": name, **values}}, ["scanner"])
            self.assertEqual(self.counts["accepted"], set(), name)
            self.assertGreaterEqual(len(self.counts["refused"]), 0 if name == "flash" else 4, (name, self.counts))

    def test_a_seed_that_moves_the_beams(self):
        for key, value, scanner, moves in (("pointing_error.jitter_sigma_rad", 1e-4, {}, True), ("pointing_error.mirror_time_sigma_s", 1e-5, {}, True),
                                           ("scanner.encoder_sigma_rad", 1e-4, {"type": "risley"}, True),
                                           ("scanner.encoder_sigma_rad", 1e-4, {"type": "fsm"}, False),
                                           ("scanner.facet_tilt_sigma_rad", 1e-4, {"type": "polygon"}, True)):
            config = {**self.BASE, **({"scanner": {**scanner, **SCANNERS[scanner["type"]]}} if scanner else {})}
            section, name = key.split(".")
            config = {**config, section: {**config.get(section, {}), name: value}}
            self.counts = {"accepted": set(), "refused": set(), "invalid": set()}
            self.source(config)
            self.compare(config, "seed", 77)
            self.compare(config, "draw", 5)
            self.assertEqual(self.counts["refused" if moves else "accepted"], {"seed", "draw"}, key)


if __name__ == "__main__":
    unittest.main()
