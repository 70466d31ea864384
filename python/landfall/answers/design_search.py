# SPDX-License-Identifier: GPL-3.0-or-later
# Decisions: D361, D363
"""The search of landfall.design: Optuna proposes candidates; a sequential test compares those on the Pareto front by many draws;
neighbours of the one that is accepted are tried; fresh draws judge it.

The answer depends on the design file alone: not on the number of workers, nor on a run that was cut off.
"""
import math
import os
import warnings

from landfall import schema
from landfall.answers import model, runs
from landfall.answers.design_problem import ALL_AND_OWN, ALL_REQUIREMENTS, CandidateCheck, failures_allowed, rate_of
from landfall.errors import DataError

TOGETHER = 4  # candidates that are proposed together, whatever the number of workers
# The search's one draw, the tests and the proofs have seeds of their own, and so have the terrains, which follow them: further apart than
# the seeds of any terrains.
RACE_SEED, PROOF_SEED, PROOF_STEP = 1_000_000_000, 1_100_000_000, 1_000_000
MAX_DRAWS = 2000
FIRST_ROUND = 8  # draws on each terrain, so that bad candidates cost little


class Design:
    """A design run in `folder`."""

    def __init__(self, problem, folder, workers=1, prefix=(), progress=None):
        self.problem, self.workers, self.progress = problem, workers, progress or runs.Silent()
        self.runner = runs.Runner(folder, 0 if workers == 1 else 1, prefix)
        self.check_candidate = CandidateCheck(problem, self.runner)
        self.proofs = 0

    def run(self):
        """The answer, a tree of JSON."""
        candidates = self.search()
        front = pareto(candidates)
        raced, tried, winner, failed = [], [], None, []
        for candidate in by_fronts(candidate for candidate in candidates if candidate["passes"]):
            found = self.race(candidate)
            raced.append(found)
            if not found["race"]["accepted"]:
                continue
            # The cheapest first. The proof of an improved one, which is near the edge of what suffices, fails more often than that of the one before.
            for step, around in reversed(self.improve(found, raced)):
                if step["values"] in failed:
                    continue
                step["proof"] = self.prove(step)
                if all(rate["exact_lower_bound"] >= self.problem.probability for rate in step["proof"]):
                    winner, tried = step, around
                    break
                failed.append(step["values"])
            if winner:
                break
        answer = {"format": "landfall.design", "version": 1, "title": self.problem.title, "probability": self.problem.probability,
                  "requirement": self.problem.requirement, "reference_cost": self.problem.reference_cost, "base": self.check_candidate({}), "candidates": candidates,
                  "front": front, "raced": raced, "winner": winner, "neighbours": tried, "proofs": self.proofs}
        if winner:
            answer["cost_frac"] = winner["cost"] / self.problem.reference_cost
            answer["active"] = max(winner["margins"], key=winner["margins"].get)
        return answer

    def percent(self, candidate):
        return f"{100 * candidate['cost'] / self.problem.reference_cost:.1f} % of the base's cost"

    def search(self):
        """All candidates that were looked at, in order."""
        problem, module = self.problem, model.optuna()
        module.logging.set_verbosity(module.logging.WARNING)
        warnings.filterwarnings("ignore", category=module.exceptions.ExperimentalWarning)
        study = module.create_study()
        for values in problem.start[:problem.candidates]:
            study.enqueue_trial(values)
        candidates, random = [], max(len(problem.start) + 8, problem.candidates // 4)
        self.progress.start("candidates", problem.candidates)
        with model.Workers(self.workers) as pool:
            while len(candidates) < problem.candidates:
                # A sampler of its own for each step: its random numbers follow from the number of candidates so far.
                study.sampler = module.samplers.TPESampler(seed=problem.seed + len(candidates), n_startup_trials=random, multivariate=True, constant_liar=True,
                                                           constraints_func=lambda trial: trial.user_attrs["constraints"])
                trials = [study.ask() for _ in range(min(TOGETHER, problem.candidates - len(candidates)))]
                proposed = [{name: model.suggest(trial, name, problem.bounds(name)) for name in problem.variables} for trial in trials]
                before = self.check_candidate.made
                for trial, candidate in zip(trials, pool.map(self.check_candidate, proposed)):
                    trial.set_user_attr("constraints", [candidate["violation"]])
                    study.tell(trial, candidate["cost"])
                    candidates.append(candidate)
                made = self.check_candidate.made - before
                self.progress.step(made, len(trials) - made)
        return candidates

    # Tests by draws

    def scans_of(self, values):
        """The draws on each terrain."""
        return [self.problem.scan_of(self.runner, self.problem.configs(values, terrain)) for terrain in range(len(self.problem.terrains))]

    def part(self, scan, draws, begin, end):
        """The file of the draws begin..end-1 of a run; an earlier run may have made it."""
        path = self.runner.place("part", [*scan.depends, draws, begin, end], "h5")
        if not os.path.exists(path):
            scan.make_draws(draws, path, "--draws", f"{begin}:{end}")
        return path

    def rounds(self, scans, draws, sizes):
        """For each terrain the passes of its draws so far, after each round of draws on all of them."""
        passes, parts, begin = [[] for _ in scans], [[] for _ in scans], 0
        for size in sizes:
            end = min(begin + size, draws["draws"])
            with model.Workers(self.workers) as pool:
                paths = list(pool.map(lambda scan: self.part(scan, draws, begin, end), scans))  # pylint: disable=cell-var-from-loop
            for terrain, path in enumerate(paths):
                passes[terrain] += [self.problem.passes(row) for row in runs.rows_of(path)]
                parts[terrain].append(path)
            begin = end
            yield passes, parts
            if end == draws["draws"]:
                return

    def race(self, candidate):
        """The candidate with "race": the sequential test of P(pass) on every terrain; the first terrain that rejects decides."""
        rule = {"p0": self.problem.probability, "p1": 1 - 3 * (1 - self.problem.probability), "alpha": 0.05, "beta": 0.05}
        rule |= self.problem.tree.get("race", {})
        draws = self.problem.draws(draws=MAX_DRAWS, seed=RACE_SEED)
        scans = self.scans_of(candidate["values"])
        self.progress.say(f"sequential test of {self.percent(candidate)}")
        try:
            for passes, _ in self.rounds(scans, draws, [FIRST_ROUND, *([runs.PART_DRAWS] * MAX_DRAWS)]):
                ends = [sprt(terrain, **rule) for terrain in passes]
                rejecting = [terrain for terrain, (accepted, _) in enumerate(ends) if accepted is False]
                if rejecting or all(accepted for accepted, _ in ends):
                    break
        finally:
            for scan in scans:
                scan.done()
        worst = rejecting[0] if rejecting else min(range(len(ends)), key=lambda terrain: sum(passes[terrain]) / len(passes[terrain]))
        counts = [{"passed": sum(terrain[:count]), "draws": count} for terrain, (_, count) in zip(passes, ends)]
        return {**candidate, "race": {**rule, "accepted": not rejecting and all(accepted for accepted, _ in ends), "terrain": worst, "terrains": counts}}

    def prove(self, candidate):
        """The rates of fresh draws on every terrain, as monte-carlo states them. Ends early where they can no longer suffice."""
        first = PROOF_SEED + PROOF_STEP * self.proofs
        self.proofs += 1
        allowed = failures_allowed(self.problem.probability, self.problem.proof_draws)
        draws = self.problem.draws(draws=self.problem.proof_draws, seed=first)
        scans = self.scans_of(candidate["values"])
        count = math.ceil(self.problem.proof_draws / runs.PART_DRAWS)
        self.progress.start("rounds of fresh draws", count)
        try:
            for passes, parts in self.rounds(scans, draws, [runs.PART_DRAWS] * count):
                self.progress.step()
                failed = max(terrain.count(False) for terrain in passes)
                if failed > allowed:
                    return [{"passed": sum(terrain), "draws": len(terrain), "exact_lower_bound": 0.0} for terrain in passes]
            candidate["chain"] = self.through_the_chain(candidate["values"], runs.rows_of(parts[0][0])[0])
            return [{"first_seed": first, **self.merged(*terrain)} for terrain in zip(passes, parts)]
        finally:
            for scan in scans:
                scan.done()

    def through_the_chain(self, values, row):
        """{"seed", "draw", "numbers"} of a draw on the first terrain that scan-sim, regrid and dem-eval make again: every number must be the same."""
        configs = self.problem.configs(values)
        if (self.problem.traced or {}).get("terrain_seed") == "each":
            configs["terrain"]["seed"] += row["seed"] - configs["scan"]["seed"]
            configs["terrain"]["draw"] = row["draw"]
        configs = model.set_values(configs, {model.SEED: row["seed"], model.DRAW: row["draw"], **{key: row[key] for key in self.problem.vary}})
        numbers = self.runner.numbers(configs, with_sigma=(self.problem.traced or {}).get("uncertainty", False))
        common = sorted(row.keys() & numbers.keys())
        for name in common:
            if row[name] != numbers[name]:
                raise DataError(f"{self.problem.path}: {name} of draw {row['draw']} of the seed {row['seed']} is {row[name]}, and {numbers[name]} through the chain")
        return {"seed": row["seed"], "draw": row["draw"], "numbers": len(common)}

    def merged(self, passes, parts):
        """The rate of the whole run."""
        verdict = os.path.join(self.runner.scratch, "verdict.json")
        self.runner.run("monte-carlo", "merge", *parts, "-o", os.path.join(self.runner.scratch, "merged.h5"), "-O", "--verdict", verdict)
        tree = schema.read_json(verdict)
        rates = {rate["requirement"]: rate for rate in tree["rates"]}
        of_map = {ALL_REQUIREMENTS: "all", ALL_AND_OWN: "all_and_own"}.get(self.problem.requirement, self.problem.requirement)
        rate = rates[of_map] if self.problem.judges_map() else rate_of(self.problem.requirement, passes)
        return {**rate, "rates": tree["rates"]}

    def improve(self, accepted, raced):
        """[(candidate, its neighbours)]: the accepted one, the cheapest of its neighbours that is accepted too, and so on until none is."""
        path = []
        while True:
            better = None
            around = [(name, values) for name, values in neighbours(self.problem, accepted["values"])
                      if self.problem.cost(self.problem.configs(values)) <= accepted["cost"]]
            self.progress.say(f"{len(around)} neighbours of {self.percent(accepted)}")
            with model.Workers(self.workers) as pool:
                candidates = list(pool.map(self.check_candidate, [values for _, values in around]))
            tried = [{**candidate, "changed": name} for (name, _), candidate in zip(around, candidates)]
            cheaper = [i for i, candidate in enumerate(tried) if candidate["passes"] and candidate["cost"] < accepted["cost"]]
            for i in sorted(cheaper, key=lambda i: tried[i]["cost"]):  # pylint: disable=cell-var-from-loop
                tried[i] = self.race(tried[i])
                if tried[i]["race"]["accepted"] and len(path) < self.problem.moves:
                    better = tried[i]
                    break
            path.append((accepted, tried))
            if better is None:
                return path
            raced.append(better)
            accepted = better


def pareto(candidates):
    """The candidates with a draw that no other one beats in both cost and worst margin; by cost.

    Equal worst margins, as of holes, which are whole bins, are compared by the next ones.
    """
    def margins(candidate):
        return sorted(candidate["margins"].values(), reverse=True)

    front = []
    for candidate in sorted((candidate for candidate in candidates if candidate["stage"] == "draw"), key=lambda candidate: (candidate["cost"], margins(candidate))):
        if not front or margins(candidate) < margins(front[-1]):
            front.append(candidate)
    return front


def by_fronts(candidates):
    """The candidates on the Pareto front, then those on the front of the others, and so on: the margins of one draw may mislead."""
    rest = list(candidates)
    while rest:
        front = pareto(rest)
        yield from front
        rest = [candidate for candidate in rest if candidate not in front]


def sprt(passes, p0, p1, alpha, beta):
    """Wald's test, as monte-carlo's (docs/user/monte-carlo.md): (True accepted, False rejected or None, draws that it took)."""
    up, down = math.log((1 - beta) / alpha) - 1e-9, math.log(beta / (1 - alpha)) + 1e-9  # tolerance of D305
    step = {True: math.log(p1 / p0), False: math.log((1 - p1) / (1 - p0))}
    counts = {True: 0, False: 0}
    for count, passed in enumerate(passes, 1):
        counts[passed] += 1
        ratio = counts[True] * step[True] + counts[False] * step[False]
        if ratio <= down or ratio >= up:
            return ratio <= down, count
    return None, len(passes)


def neighbours(problem, values):
    """(name of the variable that differs, values): one step down and up of each variable, or each of its other values."""
    for name, variable in problem.variables.items():
        if "values" in variable:
            others = [value for value in variable["values"] if value != values[name]]
        else:
            step = variable.get("step", 1 if variable.get("integer") else (variable["high"] - variable["low"]) / 20)
            others = [value for value in (values[name] - step, values[name] + step) if variable["low"] <= value <= variable["high"]]
        for value in others:
            yield name, {**values, name: value}
