#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""landfall margin: dem-eval passes at the values that it finds and fails above them."""
import copy
import fcntl
import json
import os
import re
import signal
import subprocess
import time
import unittest

from case import BIN, StudyTest, read
from harness.commands import run_command
from matplotlib.table import Cell
from matplotlib.text import Text

# pylint: disable=wrong-import-order
import landfall
from landfall.answers import margin, margin_page
from landfall.plot import verdict_page

NOISE, POSITION, VELOCITY, ATTITUDE = (margin.NOISE, *(f"scan.navigation_error.{name}" for name in ("position_m.0", "velocity_mps.1", "rpy_rad.1")))
# 40 x 40 bins; the scan is 3 m wider than the judged region on each side. The detector is turned, so that returns do not line up with the bins.
CHAIN = {"terrain": {"grid": {"half_width_m": 8, "resolution_m": 0.1}},
         "scan": {"detector": {"rows": 16, "columns": 16, "fov_deg": 3, "roll_deg": 7.73}, "laser": {"pulse_rate_hz": 400, "scan_time_s": 1},
                  "scanner": {"type": "fsm", "pattern": {"type": "line_search", "rows": 20, "columns": 20, "half_width_m": 5}},
                  "trajectory": {"position_m": [0, 0, 60]}, "noise": {"range_sigma_m": 0.01}},
         "area": {"half_width_m": 2, "resolution_m": 0.1, "region_radius_m": 2}}


class Margins(StudyTest):
    def run_it(self, *arguments, tree=None, out="m.json", code=0):
        result = subprocess.run([f"{BIN}/landfall", "margin", "-c", self.write(tree or CHAIN, "chain"), "-o", self.path(out), *arguments], capture_output=True,
                                text=True, timeout=300, check=False)
        self.assertEqual(result.returncode, code, result.stderr)
        return result

    def judge(self, key, value):
        """metrics.json of landfall run with another value of the key."""
        *path, name = key.removeprefix("scan.").split(".")
        given = {name: value}
        if name.isdigit():
            *path, last = path
            given = {last: [value if axis == int(name) else 0 for axis in range(3)]}
        for part in reversed(path):
            given = {part: given}
        error = self.write({"scan": given}, "error")
        result = subprocess.run([f"{BIN}/landfall", "run", "-c", self.path("chain.json"), "-c", error, "-o", self.path("run"), "-O", "-q"], capture_output=True, text=True,
                                check=False)
        self.assertEqual(result.returncode, 0, result.stderr)
        return json.loads(read(self.path("run", "metrics.json")))

    def test_the_values_found(self):
        result = self.run_it("--keys", ",".join((NOISE, POSITION, VELOCITY, ATTITUDE)), "--postings", "0.03,0.1")
        self.assertEqual(result.stderr, "")
        answer = json.loads(read(self.path("m.json")))
        self.assertEqual((answer["format"], answer["version"], answer["pass"]), ("landfall.margins", 1, True))
        keys = answer["keys"]
        self.assertEqual([entry["decides"] for entry in keys.values()], ["relative_elevation", "absolute_horizontal", "relative_horizontal", "absolute_horizontal"])
        self.assertAlmostEqual(keys[POSITION]["passes_up_to"], 1, delta=1e-3)
        for key, entry in keys.items():
            with self.subTest(key):
                self.assertTrue(entry["monotone"] and entry["passes_at_zero"])
                self.assertTrue(self.judge(key, entry["passes_up_to"])["pass"])
                worse = self.judge(key, entry["passes_up_to"] * 1.02)
                self.assertEqual([name for name, found in worse["requirements"].items() if not found["pass"]], [entry["decides"]])
        self.assertEqual([(entry["resolution_m"], entry["pass"]) for entry in answer["postings"]], [(0.03, False), (0.1, True)])
        self.assert_margins(answer["requirements"])
        shown = re.search(rf"{NOISE} +0.01 m +(.*) m  relative_elevation\n", result.stdout)[1]  # never rounded to a value that fails
        self.assertTrue(0 <= keys[NOISE]["passes_up_to"] - float(shown) < 1e-5, shown)

    def assert_margins(self, found):
        """The numbers of metrics.json of the chain as it is."""
        metrics = self.judge(NOISE, 0.01)
        relative = metrics["accuracy"]["relative"]
        self.assertEqual(found["relative_elevation"], {"worst": relative["z"]["max_m"], "limit": 0.05, "margin_frac": 1 - relative["z"]["max_m"] / 0.05})
        self.assertEqual(found["relative_horizontal"]["worst"], max(relative["x"]["max_m"], relative["y"]["max_m"]))
        self.assertEqual(found["absolute_horizontal"], {"worst": metrics["accuracy"]["absolute"]["horizontal"]["p95_m"], "limit": 1,
                                                        "margin_frac": 1 - metrics["accuracy"]["absolute"]["horizontal"]["p95_m"]})

    def test_killed_and_resumed(self):
        some = ("--keys", NOISE, "--postings", "0.1,0.2", "--report", self.path("m.html"))
        self.run_it(*some)
        whole = {name: read(self.path(name)) for name in ("m.json", "m.html")}
        self.assertNotRegex(whole["m.html"].decode(), r"(src|href)=.?http")
        for name in whole:
            os.remove(self.path(name))
        with subprocess.Popen([f"{BIN}/landfall", "margin", "-c", self.path("chain.json"), "-o", self.path("m.json"), *some], stdout=subprocess.DEVNULL) as process:
            deadline = time.monotonic() + 120
            while time.monotonic() < deadline and len(self.kept()) < 3:
                time.sleep(0.01)
            process.send_signal(signal.SIGKILL)
        before = {name: os.stat(self.path("m.json.runs", "cache", name)).st_mtime_ns for name in self.kept()}
        self.assertGreaterEqual(len(before), 3)
        self.assertFalse(os.path.exists(self.path("m.json")))
        progress = self.run_it(*some, "--progress").stderr
        self.assertEqual({name: read(self.path(name)) for name in whole}, whole)
        self.assertNotIn("the chain as it is", progress)  # it is in the folder
        self.assertFalse(os.path.exists(self.path("m.json.runs")))

    def kept(self):
        folder = self.path("m.json.runs", "cache")
        return [name for name in os.listdir(folder) if name.startswith("margin-") and not name.endswith(".part")] if os.path.isdir(folder) else []

    def test_a_chain_that_fails(self):
        """A cone fails the relative elevation whatever the noise is; the other requirements have their own answer."""
        tree = copy.deepcopy(CHAIN)
        tree["terrain"]["features"] = [{"type": "cone", "x_m": 0.5, "y_m": 0, "radius_m": 1, "height_m": 6}]
        tree["eval"] = {"requirements": [{"name": "returns", "metric": "assumptions.median_returns_per_bin", "min": 2}]}
        text = self.run_it("--keys", POSITION, "--postings", "0.1", "--require-pass", tree=tree, code=3).stdout
        answer = json.loads(read(self.path("m.json")))
        entry = answer["keys"][POSITION]
        self.assertEqual((entry["passes_up_to"], entry["decides"], entry["passes_at_zero"], entry["monotone"]), (0, "relative_elevation", False, True))
        self.assertIn("relative_elevation", entry["others"]["left_out"])
        self.assertGreater(entry["others"]["passes_up_to"], 0)
        self.assertRegex(text, rf"{POSITION} +0 m +never  relative_elevation\n")
        self.assertLess(answer["requirements"]["relative_elevation"]["margin_frac"], 0)
        self.assertEqual(answer["requirements"]["returns"]["margin_frac"], answer["requirements"]["returns"]["worst"] / 2 - 1)
        self.assertFalse(answer["postings"][0]["pass"])

    def test_another_share_of_the_footprints_has_no_margin(self):
        """The 95th percentile, of which the margin is, decides nothing then. A number that is to be at least its limit uses limit/number of it."""
        tree = {**CHAIN, "eval": {"limits": {"absolute_horizontal_frac": 0.5}, "requirements": [{"name": "returns", "metric": "assumptions.median_returns_per_bin", "min": 2}]}}
        text = self.run_it("--keys", NOISE, "--postings", "0.1", tree=tree).stdout
        answer = json.loads(read(self.path("m.json")))
        self.assertIsNone(answer["requirements"]["absolute_horizontal"]["margin_frac"])
        self.assertIn("note: no margin, as another share than 95 % is judged: absolute_horizontal\n", text + "\n")
        shares = dict(margin_page.shares_used(answer, tree))
        self.assertEqual(shares["returns"], 2 / answer["requirements"]["returns"]["worst"])
        self.assertNotIn("absolute horizontal", shares)

    def test_the_page_of_a_verdict(self):
        self.write(CHAIN, "chain")
        metrics = self.judge(NOISE, 0.06)
        pages = []
        for name in ("a.pdf", "b.pdf"):
            result = run_command("plot_eval", self.path("run", "eval.h5"), "--page", self.path(name))
            self.assertEqual((result.returncode, result.stdout), (0, self.path(name) + "\n"), result.stderr)
            pages.append(read(self.path(name)))
        self.assertEqual(pages[0], pages[1])
        self.assertEqual(len(re.findall(rb"/Type /Page\b", pages[0])), 1)
        page = verdict_page.Page(self.path("run", "eval.h5"))
        shown = verdict_page.draw(page)
        page.config["region"] = {"vertices": [[0, number] for number in range(800)]}
        long = verdict_page.draw(page)
        self.assertEqual(shown.get_size_inches()[1], 11.69)
        self.assertGreater(min(axes.get_position().y0 for axes in long.axes), 0)
        texts = [found.get_text() for found in shown.findobj(Text)] + [found.get_text().get_text() for found in shown.findobj(Cell)]
        worst = metrics["accuracy"]["relative"]["z"]["max_m"]
        tools = ("terrain", "scan", "dem", "eval")
        for expected in ("Verdict: pass" if metrics["pass"] else "Verdict: FAIL", f"{worst:.4g} m", f"{100 * (1 - worst / 0.05):+.1f} %",
                         *(landfall.open(self.path("run", f"{tool}.h5"), check=False).attrs["file_id"] for tool in tools)):
            self.assertIn(expected, texts)
        self.assertIn(f"{metrics['assumptions']['median_returns_per_bin']:g} returns per bin (median)", "".join(texts))
        self.assertIn("must end in .pdf", run_command("plot_eval", self.path("run", "eval.h5"), "--page", self.path("a.png")).stderr)
        self.assertIn("a.pdf exists", run_command("plot_eval", self.path("run", "eval.h5"), "--page", self.path("a.pdf")).stderr)

    def test_what_is_refused(self):
        for arguments, message in ((["--postings", "0.1,x"], "--postings 0.1,x: is not a list of numbers"), (["--postings", "0.1,-1"], "not all are > 0 m"),
                                   (["--keys", "scan.seed"], f"--keys: scan.seed: is not one of {NOISE}, "),
                                   (["--set", "scan.noise.range_sigma_m=-1"], "range_sigma_m: -1 is not in"),
                                   (["--report", self.path("none", "m.html")], "does not exist"), (["-c", self.path("none.json")], "none.json")):
            with self.subTest(message):
                error = self.run_it(*arguments, code=2).stderr
                self.assertRegex(error, r"\Alandfall margin: [^\n]*\n\Z")
                self.assertIn(message, error)
                self.assertFalse(os.path.exists(self.path("m.json")))
                self.assertFalse(os.path.exists(self.path("m.json.runs")))
        self.assertIn("--postings 1e-09: monte-carlo: footprint_m", self.run_it("--postings", "0.1,1e-9", code=2).stderr)
        with open(self.path("m.json.runs", "lock"), "w", encoding="ascii") as lock:
            fcntl.flock(lock, fcntl.LOCK_EX)
            self.assertIn("m.json.runs: another run uses it", self.run_it(code=2).stderr)
        self.write("", "m")
        self.assertIn("m.json exists", self.run_it(code=2).stderr)


class Searches(unittest.TestCase):
    """Searches of functions whose answer is known."""

    @staticmethod
    def answer(passes, configured=0, last=100):
        return margin.Search(configured, 0.05, last, lambda value: {"a": True, "b": passes(value)}).answer(["a", "b"])

    def test_an_end(self):
        for end in (0.001, 0.05, 0.7, 3, 99):
            for configured in (0, 0.5, -0.5):
                found = self.answer(lambda value, end=end: abs(value) <= end, configured)
                size = abs(found["passes_up_to"])
                self.assertTrue(0.999 * end <= size <= end, (found, end))
                self.assertEqual(found["passes_up_to"] < 0, configured < 0)
                self.assertEqual((found["decides"], found["monotone"]), ("b", True))

    def test_no_end(self):
        self.assertEqual(self.answer(lambda value: True), {"passes_up_to": None, "decides": None, "monotone": True})
        self.assertEqual(self.answer(lambda value: False), {"passes_up_to": 0, "decides": "b", "monotone": True})
        self.assertEqual(self.answer(lambda value: value == 0)["passes_up_to"], 0)
        self.assertEqual(self.answer(lambda value: True, 200)["passes_up_to"], None)

    def test_a_gap_is_found(self):
        """Not all values below the last one that passes pass: the answer is the end of the first part, where a sample met the gap."""
        found = self.answer(lambda value: value <= 3 or 5 <= value <= 9)
        self.assertTrue(2.997 <= found["passes_up_to"] <= 3, found)
        self.assertFalse(found["monotone"])
        found = self.answer(lambda value: value < 1 or value > 8, 10, 20)
        self.assertFalse(found["monotone"])
        self.assertTrue(0.999 <= found["passes_up_to"] <= 1, found)


if __name__ == "__main__":
    unittest.main()
