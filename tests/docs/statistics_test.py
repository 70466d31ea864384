#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Checks the tables of docs/reference/statistics.md and of docs/user/monte-carlo.md, by enumerating the binomial distribution.

    statistics_test.py            compares the pages' tables
    statistics_test.py --print    prints them

It shares no code and, where there is a choice, no formula with lib/chain/draws: an interval covers p if its test does not reject p, so
that no bound is computed here.
"""
import math
import os
import statistics
import sys
import unittest

ROOT = os.environ.get("LANDFALL_ROOT", os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
PROBABILITIES = (0.5, 0.7, 0.9, 0.95, 0.97, 0.99, 0.995, 0.999)
SIZES = (20, 50, 100, 200, 299, 500)
Z = statistics.NormalDist().inv_cdf(0.975)


def masses(n, p):
    """The probability of k passes, k = 0 .. n."""
    log = math.lgamma
    return [math.exp(log(n + 1) - log(k + 1) - log(n - k + 1) + k * math.log(p) + (n - k) * math.log1p(-p)) for k in range(n + 1)]


def wilson_coverage(n, p):
    return sum(mass for k, mass in enumerate(masses(n, p)) if abs(k - n * p) <= Z * math.sqrt(n * p * (1 - p)))


def exact_coverage(n, p, confidence=0.95):
    """The bound of k passes is at most p if k or more passes have a probability of at least 1 - confidence."""
    covered, tail = 1, 0
    for mass in reversed(masses(n, p)):
        tail += mass
        if tail < 1 - confidence:
            covered = 1 - tail
    return covered


def coverage_table(coverage):
    """The last two columns are over all n = 20 .. 500."""
    rows = []
    for p in PROBABILITIES:
        every = {n: coverage(n, p) for n in range(20, 501)}
        rows.append([p] + [f"{every[n]:.3f}" for n in SIZES] + [f"{min(every.values()):.3f}", f"{statistics.mean(every.values()):.3f}"])
    return table(["p \\ n", *SIZES, "least", "mean"], rows)


def is_shown(n, fails, p, confidence):
    """Whether at least n - fails passes of n are unlikely enough where the probability is p."""
    return sum(math.comb(n, d) * (1 - p) ** d * p ** (n - d) for d in range(fails + 1)) <= 1 - confidence


def draws_needed(fails, p, confidence):
    return next(n for n in range(fails + 1, 100000) if is_shown(n, fails, p, confidence))


def plan_table():
    rows = []
    for fails in range(5):
        n95, n99 = (draws_needed(fails, 0.99, confidence) for confidence in (0.95, 0.99))
        chances = [sum(math.comb(n95, d) * (1 - p) ** d * p ** (n95 - d) for d in range(fails + 1)) for p in (0.995, 0.998, 0.999, 0.9999)]
        rows.append([fails, n95, f"{n99:,}"] + [f"{chance:.3f}" for chance in chances])
    return table(["failures allowed", "draws, 95 %", "draws, 99 %", "p = 0.995", "0.998", "0.999", "0.9999"], rows)


def ends(rule, p):
    """The exact distribution of the test's end: probability accepted, rejected, mean draws, draws within which 95 % of tests end."""
    p0, p1, alpha, beta = rule
    accept, reject = math.log(beta / (1 - alpha)), math.log((1 - beta) / alpha)
    live, n, accepted, rejected, draws, maximum = {0: 1.0}, 0, 0, 0, 0, None
    while sum(live.values()) > 1e-13:
        n, following = n + 1, {}
        for fails, mass in live.items():
            following[fails] = following.get(fails, 0) + mass * p
            following[fails + 1] = following.get(fails + 1, 0) + mass * (1 - p)
        live = {}
        for fails, mass in following.items():
            ratio = (n - fails) * math.log(p1 / p0) + fails * math.log((1 - p1) / (1 - p0))
            if accept < ratio < reject:
                live[fails] = mass
                continue
            draws += n * mass
            accepted, rejected = (accepted + mass, rejected) if ratio <= accept else (accepted, rejected + mass)
        maximum = n if maximum is None and accepted + rejected >= 0.95 else maximum
    return accepted, rejected, draws, maximum


def share(probability):
    """With three decimals, or one digit of a small probability."""
    if probability >= 0.0005:
        return f"{probability:.3f}"
    return f"{probability:.0e}".replace("e-0", "e-") if probability > 1e-12 else "0"


def wald_mean(rule):
    """Wald's approximation of the mean draws at p0, as if the test stopped on its limits."""
    p0, p1, alpha, beta = rule
    at_stop = (1 - alpha) * math.log(beta / (1 - alpha)) + alpha * math.log((1 - beta) / alpha)
    return at_stop / (p0 * math.log(p1 / p0) + (1 - p0) * math.log((1 - p1) / (1 - p0)))


def sprt_table():
    rows = []
    for p in sorted(PROBABILITIES + (0.98, 0.985)):
        accepted, rejected, draws, maximum = ends((0.99, 0.97, 0.05, 0.05), p)
        rows.append([p, share(accepted), share(rejected), f"{draws:.0f}", f"{maximum:,}"])
    return table(["p", "accepted", "rejected", "draws, mean", "draws, 95 % of runs"], rows)


def rules_table():
    rows = []
    for rule in ((0.99, 0.97, 0.05, 0.05), (0.99, 0.97, 0.01, 0.01), (0.99, 0.98, 0.05, 0.05), (0.99, 0.95, 0.05, 0.05),
                 (0.995, 0.99, 0.05, 0.05), (0.999, 0.99, 0.05, 0.05), (0.95, 0.9, 0.05, 0.05)):
        p0, p1, alpha, beta = rule
        good, bad = ends(rule, p0), ends(rule, p1)
        straight = math.ceil(math.log((1 - alpha) / beta) / math.log(p0 / p1))
        rows.append([p0, p1, alpha, beta, f"{good[1]:.4f}", f"{bad[0]:.4f}", straight, f"{good[2]:,.0f}", f"{bad[2]:,.0f}"])
    return table(["p0", "p1", "alpha", "beta", "true alpha", "true beta", "straight passes", "draws, mean, at p0", "at p1"], rows)


def wrong_by_looking(p, maximum):
    """The probability that a campaign of draws that pass with probability p, which stops as soon as its exact 95 % bound reaches p,
    does so within `most` draws."""
    live, stopped = {0: 1.0}, 0
    for n in range(1, maximum + 1):
        following = {}
        for fails, mass in live.items():
            following[fails] = following.get(fails, 0) + mass * p
            following[fails + 1] = following.get(fails + 1, 0) + mass * (1 - p)
        allowed, tail = -1, 0
        for fails in range(n + 1):
            tail += math.comb(n, fails) * (1 - p) ** fails * p ** (n - fails)
            if tail > 0.05:
                break
            allowed = fails
        stopped += sum(mass for fails, mass in following.items() if fails <= allowed)
        live = {fails: mass for fails, mass in following.items() if fails > allowed}
    return stopped


def table(heads, rows):
    lines = [heads, ["---"] * len(heads), *rows]
    return "\n".join("| " + " | ".join(map(str, line)) + " |" for line in lines)


def pages():
    """The pages that show these numbers, as one text."""
    texts = []
    for name in ("reference/statistics.md", "user/monte-carlo.md"):
        with open(os.path.join(ROOT, "docs", *name.split("/")), encoding="utf-8") as file:
            texts.append(file.read())
    return "\n".join(texts)


class Statistics(unittest.TestCase):
    maxDiff = None

    def assert_shown(self, text):
        self.assertTrue(text in pages(), f"no page shows\n{text}")

    def test_coverage_of_wilson(self):
        self.assert_shown(coverage_table(wilson_coverage))

    def test_coverage_of_the_exact_bound(self):
        self.assert_shown(coverage_table(exact_coverage))

    def test_fixed_plans(self):
        self.assert_shown(plan_table())

    def test_sequential_test(self):
        self.assert_shown(sprt_table())
        self.assert_shown(rules_table())

    def test_numbers_in_the_text(self):
        flowing = " ".join(pages().split())
        for text in (f"{wilson_coverage(100, 0.99):.2f} instead of 0.95 at p = 0.99 and n = 100",
                     f"{wrong_by_looking(0.99, 500):.2f} within 500 draws",
                     f"{wrong_by_looking(0.99, 2000):.2f} within 2,000",
                     f"is {wald_mean((0.99, 0.97, 0.05, 0.05)):.0f} draws at p0"):
            self.assertIn(text, flowing)


if __name__ == "__main__":
    if sys.argv[1:] == ["--print"]:
        print(coverage_table(wilson_coverage), coverage_table(exact_coverage), plan_table(), sprt_table(), rules_table(), sep="\n\n")
        print(wilson_coverage(100, 0.99), wrong_by_looking(0.99, 500), wrong_by_looking(0.99, 2000))
    else:
        unittest.main()
