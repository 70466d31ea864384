# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D360, D362
"""The problem of a design file, and the filters of its candidates (docs/user/studies/design.md).

A candidate gives each variable of the design file a value. Filters refuse candidates, each at a higher price than the one before:
the geometry of the frames, scan-sim --plan, one draw, a sequential test. landfall.design_search calls them.
"""
import copy
import itertools
import json
import math
import os
import statistics

from landfall import dictionary, schema
from landfall.answers import model, runs
from landfall.errors import ToolError, UsageError, printable
from landfall.requirements import is_decided_by_worst

ALL_REQUIREMENTS = "all six"
CHOSEN_PLACE_SAFE = "chosen place safe"
ACCEPTED_PLACE_SAFE = "accepted place safe"
ALL_AND_OWN = "all and own"
SAFE_LANDING = "safe landing"
SITE_REQUIREMENTS = (CHOSEN_PLACE_SAFE, ACCEPTED_PLACE_SAFE, SAFE_LANDING)
COSTS = ("ranges", "pulses", "pixels", "scan_time_s", "pulse_rate_hz")
# Methods that put a return into the one bin whose centre is nearest.
NEAREST = ("bilinear_nearest", "mean", "min", "max", "median")
NO_NUMBER = math.log(1000)  # margin where a DEM lacks a number


class Problem:
    """A design file (schemas/design.schema.json)."""

    def __init__(self, path):
        self.path, self.tree = path, schema.read_checked(path, "design")
        self.base = runs.read_base(self.tree["base"], os.path.dirname(os.path.abspath(path)), path)
        self.title = self.tree.get("title", os.path.basename(path).removesuffix(".json"))
        self.variables, self.terrains = self.tree["variables"], self.tree.get("terrains", [{}])
        self.requirement = self.tree.get("requirement", ALL_AND_OWN if self._own() else ALL_REQUIREMENTS)
        self.probability = self.tree["probability"]
        self.proof_draws = self.tree.get("proof_draws", 473)
        search = self.tree.get("search", {})
        self.candidates, self.seed, self.start = search.get("candidates", 60), search.get("seed", 1), search.get("start", [])
        self.moves = search.get("moves", 8)
        self.vary, self.traced = self.tree.get("vary", {}), self.tree.get("traced_draws")
        self._check()
        self.reference_cost = self.cost(self.base)

    def _own(self):
        """{path of its columns: requirement} of the user's own requirements."""
        sections = {"own_requirements": "eval", "score.own_requirements": "hazard"}
        return {f"{path}.{own['name']}": own for path, stage in sections.items() for own in self.base.get(stage, {}).get("requirements", [])}

    def _counted_own(self):
        """The requirements of _own() that a draw must meet: all, the named one, or none."""
        return {path: own for path, own in self._own().items() if self.requirement in (ALL_AND_OWN, own["name"])}

    def judges_map(self):
        """Whether requirements on the DEM or of the user's own count; else the best site counts."""
        return self.requirement not in SITE_REQUIREMENTS

    def _check(self):
        known = [ALL_REQUIREMENTS, ALL_AND_OWN, *SITE_REQUIREMENTS]
        if self.requirement not in known and not self._counted_own():
            raise UsageError(f"{self.path}: /requirement: \"{printable(self.requirement)}\" is neither one of {', '.join(known)}, nor the name of a "
                             "requirement of your own in eval or hazard" + "".join(f"; own: {own['name']}" for own in self._own().values()))
        if self.requirement == ALL_AND_OWN and not self._own():
            raise UsageError(f"{self.path}: /requirement: \"{ALL_AND_OWN}\" needs requirements of your own in eval or hazard")
        if not self.judges_map() and "hazard" not in self.base:
            raise UsageError(f"{self.path}: /base: the requirement \"{self.requirement}\" needs a configuration of hazard-map: hazard")
        if self.requirement == SAFE_LANDING and "landing" not in (self.traced or {}):
            raise UsageError(f"{self.path}: /requirement: \"{SAFE_LANDING}\" needs /traced_draws/landing")
        for name, variable in self.variables.items():
            where = f"{self.path}: /variables/{name}"
            if ("values" in variable) == ("low" in variable or "high" in variable):
                raise UsageError(f"{where}: needs either values, or low and high")
            if "values" not in variable and not ("low" in variable and "high" in variable and variable["low"] < variable["high"]):
                raise UsageError(f"{where}: low and high are needed, and low < high")
            if "values" in variable and ("integer" in variable or "step" in variable):
                raise UsageError(f"{where}: integer and step are for a range; omit them where values are listed")
            if variable.get("integer") and any(variable[end] != int(variable[end]) for end in ("low", "high")):
                raise UsageError(f"{where}: low and high of an integer must be whole numbers")
        pattern = self.base["scan"]["scanner"].get("pattern", {})
        if self.tree.get("whole_pattern") and not ("rows" in pattern and "columns" in pattern):
            raise UsageError(f"{self.path}: /whole_pattern: needs a scanner whose pattern has rows and columns")
        for name in self.tree.get("cost", {}):
            if name not in COSTS:
                raise UsageError(f"{self.path}: /cost/{name}: is not one of {', '.join(COSTS)}")
        for number, values in enumerate(self.start):
            if set(values) != set(self.variables):
                raise UsageError(f"{self.path}: /search/start/{number}: needs a value for each of {', '.join(self.variables)}")
            for name, value in values.items():
                self._check_start(name, value, f"{self.path}: /search/start/{number}/{name}: {schema.shown(value)}")
        minimum = draws_needed(self.probability, 0)
        if self.proof_draws < minimum:
            raise UsageError(f"{self.path}: /proof_draws: {self.proof_draws} draws without a failure show less than {self.probability}; "
                             f"{minimum} are needed")

    def _check_start(self, name, value, where):
        variable = self.variables[name]
        if "values" in variable:
            if not any(value == one and isinstance(value, bool) == isinstance(one, bool) for one in variable["values"]):
                raise UsageError(f"{where} is not one of {', '.join(map(schema.shown, variable['values']))}")
            return
        is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
        if not is_number or not variable["low"] <= value <= variable["high"] or (variable.get("integer") and value != int(value)):
            kind = "a whole number" if variable.get("integer") else "a number"
            raise UsageError(f"{where} is not {kind} in [{variable['low']}, {variable['high']}]")

    def configs(self, values, terrain=0):
        """The configurations of a candidate, {name of a variable: value}, on a terrain of the ensemble."""
        configs = copy.deepcopy(self.base)
        self._set(configs, {key: value for name, value in values.items() for key in self.variables[name]["keys"]}, "/variables")
        if values and self.tree.get("whole_pattern"):
            pattern, laser = configs["scan"]["scanner"]["pattern"], configs["scan"]["laser"]
            laser["scan_time_s"] = pattern["rows"] * pattern["columns"] / laser["pulse_rate_hz"]
        self._set(configs, self.terrains[terrain], f"/terrains/{terrain}")
        return configs

    def _set(self, configs, values, where):
        try:
            model.set_values(configs, values)
        except UsageError as error:
            raise UsageError(f"{self.path}: {where}: {error}") from error

    def bounds(self, name):
        """As model.suggest() takes them."""
        variable = self.variables[name]
        if "values" in variable:
            return variable["values"]
        kind = int if variable.get("integer") else float
        return kind(variable["low"]), kind(variable["high"])

    def cost(self, configs):
        laser, detector = configs["scan"]["laser"], configs["scan"]["detector"]
        pulses, pixels = math.floor(laser["pulse_rate_hz"] * laser["scan_time_s"] + 1e-9), detector["rows"] * detector["columns"]
        parts = dict(zip(COSTS, (pulses * pixels, pulses, pixels, laser["scan_time_s"], laser["pulse_rate_hz"])))
        return sum(weight * parts[name] for name, weight in self.tree.get("cost", {"ranges": 1}).items())

    def scan_of(self, runner, configs):
        """The draws of a candidate's configurations: over a traced scan, or traced each."""
        return runs.Scan(runner, configs, 1) if self.traced is None else runs.TracedDraws(runner, configs, self.traced)

    def draws(self, **changes):
        """A configuration of monte-carlo; `seed` goes to the scan."""
        seed = changes.pop("seed")
        # Requirements of the user's own on other numbers than these need all of them.
        needs_full = any(not own["metric"].startswith(("coverage.", "requirements.")) for own in self.base["eval"].get("requirements", []))
        return {"vary": self.vary, "metrics": "full" if needs_full else "verdict", "scan": {"seed": seed}, **changes}

    def passes(self, row):
        """Whether a draw meets the requirement. An accepted place is one that hazard-map --require-safe accepts."""
        if self.requirement == ALL_AND_OWN:
            return row["pass"] == 1
        if self.requirement == ALL_REQUIREMENTS:
            return all(row[f"requirements.{name}.pass"] == 1 for name in dictionary.requirements())
        if self.judges_map():
            return all(row[path + ".pass"] == 1 for path in self._counted_own())
        if self.requirement == SAFE_LANDING:
            return bool(row["landing.safe"])
        return bool(row["site.true_safe"]) and (self.requirement == CHOSEN_PLACE_SAFE or row["site.p_touchdown"] >= self.base["hazard"]["sites"]["min_p"])

    def why_not(self, row, margins):
        """Why a draw, with its margins, does not meet the requirement."""
        if not self.judges_map():
            if row["site.p_touchdown"] is None:
                return "no place is safe"
            if self.requirement == SAFE_LANDING:
                return "the landing is not safe"
            if not row["site.true_safe"]:
                return "the chosen place is not known to be safe on the true terrain"
            return f"the chosen place has p_touchdown {row['site.p_touchdown']:.3g}, less than {self.base['hazard']['sites']['min_p']:g}"
        unjudged = [requirement.words for requirement in dictionary.requirements().values() if row[f"requirements.{requirement.name}.pass"] is None]
        if unjudged and self.requirement in (ALL_REQUIREMENTS, ALL_AND_OWN):
            return f"{unjudged[0]} is not judged: the footprint has too few bins"
        worst = max(margins, key=margins.get)
        return f"{worst} is {math.exp(margins[worst]):.3g} of its limit"

    def margins(self, row):
        """{requirement: ln(value/limit)} of a draw: below 0 it is met."""
        if not self.judges_map():
            is_safe = row["landing.safe" if self.requirement == SAFE_LANDING else "site.true_safe"]
            risk = 1 if not is_safe or row["site.p_touchdown"] is None else 1 - row["site.p_touchdown"]
            return {self.requirement: model.margin(risk, 1 - self.base["hazard"]["sites"]["min_p"])}
        limits = self.base["eval"]["limits"]
        found = {}
        for requirement in dictionary.requirements().values() if self.requirement in (ALL_REQUIREMENTS, ALL_AND_OWN) else ():
            values = [row[number] for number in requirement.worst]
            limit = limits[requirement.worst_limit]
            if None in values:
                found[requirement.words] = NO_NUMBER
            elif is_decided_by_worst(requirement, limits):
                found[requirement.words] = max(model.margin(value, limit) for value in values)
            else:
                found[requirement.words] = model.margin(limits[requirement.limit], row[requirement.value])
        for path, own in self._counted_own().items():
            value = row[path + ".value"]
            found[own["name"]] = NO_NUMBER if value is None else model.margin(value, own["max"]) if "max" in own else model.margin(own["min"], value)
        return found


CONFIDENCE = 0.95


def _tails(probability, draws):
    """P(at most 0, 1, ... failures). The terms are sums of logarithms, since the first may be too small for a number."""
    total = 0.0
    for failures in range(draws + 1):
        ways = math.lgamma(draws + 1) - math.lgamma(failures + 1) - math.lgamma(draws - failures + 1)
        missed = failures * math.log1p(-probability) if failures else 0.0
        total += math.exp(ways + (draws - failures) * math.log(probability) + missed)
        yield total


def failures_allowed(probability, draws):
    """The most failures in so many draws that still show the probability (exact bound of Clopper and Pearson); -1: none does."""
    return next((failures for failures, tail in enumerate(_tails(probability, draws)) if tail > 1 - CONFIDENCE), draws + 1) - 1


def rate_of(requirement, passes):
    """The rate of passes, as monte-carlo states it: with Wilson's interval and the exact lower bound of Clopper and Pearson."""
    passed, draws = sum(passes), len(passes)
    low, high = 0.0, 1.0
    while passed and high - low > 1e-15:  # the probability of which so many failures or fewer are as rare as 1 - CONFIDENCE
        middle = (low + high) / 2
        low, high = (middle, high) if next(itertools.islice(_tails(middle, draws), draws - passed, None)) < 1 - CONFIDENCE else (low, middle)
    z = statistics.NormalDist().inv_cdf((1 + CONFIDENCE) / 2)
    centre, width = passed + z * z / 2, z * math.sqrt(passed * (draws - passed) / draws + z * z / 4)
    return {"requirement": requirement, "passed": passed, "draws": draws, "wilson_low": (centre - width) / (draws + z * z),
            "wilson_high": (centre + width) / (draws + z * z), "exact_lower_bound": low}


def draws_needed(probability, failures):
    """The fewest draws in which so many failures show the probability."""
    draws = failures + 1
    while failures_allowed(probability, draws) < failures:
        draws += 1
    return draws


# Filters


def frame_gap_bins(configs):
    """The widest gap between two frames of a raster on flat terrain at the end of the scan, in bins; None without a raster."""
    scan = configs["scan"]
    pattern, detector, motion = scan["scanner"].get("pattern", {}), scan["detector"], scan["trajectory"]
    if pattern.get("type") != "line_search" or not pattern.get("compensated") or motion["type"] != "constant_velocity" or "ifov_rad" not in detector:
        return None
    ifov = detector["ifov_rad"] if isinstance(detector["ifov_rad"], list) else [detector["ifov_rad"]] * 2
    height_m = motion["position_m"][2] + min(motion["velocity_mps"][2] * scan["laser"]["scan_time_s"], 0)
    side_m = max(ifov[0] * detector["columns"], ifov[1] * detector["rows"]) * height_m
    roll = math.radians(detector["roll_deg"])
    extent_m = side_m * (abs(math.cos(roll)) + abs(math.sin(roll)))  # over the corners
    pitch_m = max(2 * pattern["half_width_m"] / max(pattern[key] - 1, 1) for key in ("rows", "columns"))
    return (pitch_m - extent_m) / configs["regrid"]["resolution_m"]


class CandidateCheck:
    """The filters before the sequential test, for one candidate after another."""

    def __init__(self, problem, runner):
        self.problem, self.runner, self.made = problem, runner, 0

    def __call__(self, values):
        """{"values", "cost", "stage" that refused or "draw", "reason", "violation" (above 0: refused), "margins", "passes"}."""
        configs = self.problem.configs(values)
        result = {"values": values, "cost": self.problem.cost(configs), "margins": {}, "passes": False}
        if self.problem.judges_map():
            gap = frame_gap_bins(configs)
            widest = 2 * configs["eval"]["limits"]["distance_bins"] + 2  # a bin holds returns up to a bin away
            if gap is not None and gap > widest:
                return {**result, "stage": "geometry", "reason": f"frames are {gap:.3g} bins apart at the end of the scan; at most {widest:g} can pass",
                        "violation": math.log(gap / widest) + 1}
        found, is_earlier = self.runner.cached("look", [configs, self.problem.vary, self.problem.seed, self.problem.requirement,
                                                        *([] if self.problem.traced is None else [self.problem.traced])],
                                               lambda: self._run(configs), runs.is_steady)
        self.made += not is_earlier
        return {**result, **found}

    def _run(self, configs):
        try:
            if self.problem.judges_map():
                refused = self._plan(configs)
                if refused:
                    return refused
            scan = self.problem.scan_of(self.runner, configs)
            try:
                [row] = scan.rows(self.problem.draws(draws=1, metrics="full", seed=self.problem.seed))
            finally:
                scan.done()
        except ToolError as error:
            return {"stage": "error", "reason": str(error), "violation": 3.0, "code": error.exit_code}
        margins, passes = self.problem.margins(row), self.problem.passes(row)
        worst = max(margins, key=margins.get)
        return {"stage": "draw", "margins": margins, "violation": margins[worst] if passes else max(margins[worst], 1e-9), "passes": passes,
                "reason": "" if passes else self.problem.why_not(row, margins)}

    def _plan(self, configs):
        """The reason why flat terrain would fail, or None. What relief and errors could still change is let through."""
        limits, radius, edge = configs["eval"]["limits"], configs["eval"]["region_radius_m"], configs["regrid"]["resolution_m"]
        plan = json.loads(self.runner.run("scan-sim", "--plan", "--json", "--plan-radius", radius, "--plan-resolution", edge,
                                          config=configs["scan"]))["plan"]["coverage"]
        farthest = limits["distance_bins"] + math.sqrt(2)
        if plan["max_distance_bins"] > farthest:
            return {"stage": "plan", "reason": f"a bin of flat terrain is {plan['max_distance_bins']:.3g} bins from the next return",
                    "violation": math.log(plan["max_distance_bins"] / farthest) + 0.5}
        if configs["regrid"]["method"] in NEAREST and plan["uncovered_frac"] > 2 * limits["invalid_frac"] > 0:
            return {"stage": "plan", "reason": f"{100 * plan['uncovered_frac']:.3g} % of the bins of flat terrain are empty",
                    "violation": math.log(plan["uncovered_frac"] / limits["invalid_frac"])}
        return None
