# SPDX-License-Identifier: GPL-3.0-or-later
"""Campaigns of monte-carlo, and the numbers of one of their draws by the tools of the chain."""
import json
import math

import h5py
import numpy as np

from . import EVAL, REGRID, TERRAIN, MonteCarloTest, columns, config_of, read_bytes

TOOL_OF = {"terrain": "terrain-gen", "scan": "scan-sim", "regrid": "regrid", "eval": "dem-eval", "hazard": "hazard-map"}
OWN = (*TOOL_OF, "seed", "draw", "pass", "landing", "blind")  # columns that begin so are not in the files of the chain
LAYERS = ["p_invalid", "p_fail_rel_x", "p_fail_rel_y", "p_fail_rel_z", "p_fail_absolute", "e_z_mean", "e_z_std", "e_map_std", "count_mean"]
REQUIREMENTS = ["coverage", "hole_size", "hole_distance", "relative_elevation", "relative_horizontal", "absolute_horizontal"]
# Values of draws that trace: paths, attitudes, errors and a rule.
DISPERSED = {**{f"scan.trajectory_dispersion.{key}.{i}": {"type": "normal", "sigma": sigma}
                for key, sigma in (("position_m", 0.2), ("velocity_mps", 0.3), ("rpy_rad", 2e-3), ("rpy_rate_radps", 5e-3))
                for i in range(3)},
             "scan.pointing_error.jitter_sigma_rad": {"type": "uniform", "low": 0, "high": 2e-4},
             "scan.navigation_error.velocity_mps.0": {"type": "normal", "sigma": 0.3},
             "scan.trajectory.velocity_mps.2": {"type": "uniform", "low": -6, "high": -4},
             "eval.quantile": {"type": "uniform", "low": 0.8, "high": 1}}
FRACTAL = {**TERRAIN, "base": [{"type": "plane", "slope_x": 0.03},
                               {"type": "fractal", "hurst_exponent": 0.7, "rms_deviation_m": 0.05, "reference_length_m": 1}]}


def draws_config(**values):
    return {"draws": 6, "scan": {}, "regrid": REGRID, "eval": EVAL, "vary": {}, **values}


def merged(base, changes):
    """As RFC 7396."""
    if not isinstance(changes, dict):
        return changes
    base = dict(base) if isinstance(base, dict) else {}
    return {**base, **{key: merged(base.get(key), value) for key, value in changes.items()}}


def flat(value, path=""):
    """The numbers of metrics.json by their dotted paths."""
    if isinstance(value, dict):
        return {name: number for key, inner in value.items() for name, number in flat(inner, f"{path}.{key}" if path else key).items()}
    if isinstance(value, (list, str)) or path in ("pass", "version", "score.version"):
        return {}
    return {path: math.nan if value is None else float(value)}


class DrawsTest(MonteCarloTest):
    """Draws over the chain's scan or over another one; those of a campaign with the section terrain, or with scan=False, trace."""

    def arguments(self, config, output, *options, scan=None):
        inputs = [] if "terrain" in config or scan is False else [scan or self.chain.scan, "--terrain", self.chain.terrain]
        return [*inputs, "-c", self.config(config, "mc.json"), "-o", self.path(output), *options]

    def draws(self, config, *options, output="draws.h5", scan=None):
        """Runs a campaign; returns the rows of its draws."""
        self.succeed("monte-carlo", *self.arguments(config, output, "-O", *options, scan=scan))
        return columns(self.path(output), "draws")

    def verdict(self, output="draws.h5"):
        with h5py.File(self.path(output)) as file:
            return json.loads(file["verdict_json"].asstr()[()])

    def chain_draw(self, config, rows, draw, *, scan=None, terrain=None, regrid=()):
        """The numbers of one draw by the tools, whose files stay: they get the values and the number of the draw by --set."""
        out = {name: self.path(name) for name in ("t.h5", "s.h5", "d.h5", "e.h5", "m.json", "h.h5", "sites.json", "score.json")}

        def tool(stage, given, *arguments):
            values = [f"{key.partition('.')[2]}={float(rows[key][draw])!r}" for key in rows if key.split(".")[0] == stage]
            self.succeed(TOOL_OF[stage], *arguments, "-c", self.config(given or {}, stage + ".json"),
                         *[word for value in values for word in ("--set", value)], "-O")
        if scan is None and terrain is None:
            terrain = out["t.h5"]
            tool("terrain", config["terrain"], *(["--set", f"draw={draw}"] if config.get("terrain_seed") == "each" else []), "-o", terrain)
        terrain = terrain or self.chain.terrain
        tool("scan", merged(config_of(scan), config["scan"]) if scan else config["scan"], *(["--ranges-from", scan] if scan else []),
             "--terrain", terrain, "--set", f"draw={draw}", "-o", out["s.h5"])
        tool("regrid", config["regrid"], out["s.h5"], "--terrain", terrain, *(["--uncertainty"] if config.get("uncertainty") else []),
             *regrid, "-o", out["d.h5"])
        tool("eval", config["eval"], out["d.h5"], "--metrics", out["m.json"], "-o", out["e.h5"])
        found = flat(json.loads(read_bytes(out["m.json"])))
        if config.get("hazard") is not None:
            tool("hazard", config["hazard"], out["d.h5"], "--terrain", terrain, "--sites", out["sites.json"], "--score", out["score.json"],
                 "-o", out["h.h5"])
            score, sites = (json.loads(read_bytes(out[name])) for name in ("score.json", "sites.json"))
            found |= flat(score, "score")
            found |= flat({key: value for site in sites["sites"][:1] for key, value in site.items() if key != "rank"}, "site")
        return found

    def check_draw(self, config, rows, draw, **sources):
        """Every number of the draw is that of the chain."""
        expected = self.chain_draw(config, rows, draw, **sources)
        found = {name: rows[name][draw] for name in rows if name.split(".")[0] not in OWN}
        if config.get("metrics", "full") == "full":
            self.assertEqual(set(found), set(expected))
        for name, value in found.items():
            np.testing.assert_array_equal(value, expected[name], f"{name}, draw {draw}")
        self.assertEqual({1: True, 0: False, -1: None}[rows["pass"][draw]], json.loads(read_bytes(self.path("m.json")))["pass"])
