#!/usr/bin/python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""report_study.py: the content of the page compared with the files of the study, and its behaviour in a browser."""
import contextlib
import copy
import csv
import functools
import html.parser
import io
import json
import os
import re
import sys
import unittest

import h5py
from case import BASE, FEW_FIGURES, RESOLUTIONS, ROOT, SIGMAS, StudyTest, read, study

sys.path.insert(0, os.path.join(ROOT, "tests", "harness"))
# pylint: disable=wrong-import-order
import browser
from harness.commands import run_command
from harness.page import FAINT
from landfall.study import model, plot_study, reader, report_study, stages, table

HOSTILE = "</script><script>alert(1)</script><b>&\"'"
REPEATS = {"repeat": {"count": 2, "draws": {"scan.navigation_error.velocity_mps": {"normal": [0.1, 0.1, 0.1]}}}}


class Page(html.parser.HTMLParser):
    """The texts of a page's tables, and the JSON tree in the page."""

    def __init__(self, path):
        super().__init__()
        self.tables, self.tags, self._script, self._cell = [], [], None, None
        self.scripts = {}
        self.feed(read(path).decode())
        self.tree = json.loads(self.scripts["report-data"])

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag == "table":
            self.tables.append([])
        elif tag == "tr":
            self.tables[-1].append([])
        elif tag in ("td", "th"):
            self._cell = []
        elif tag == "script":
            self._script = dict(attrs).get("id", "")

    def handle_endtag(self, tag):
        if tag in ("td", "th"):
            self.tables[-1][-1].append(" ".join("".join(self._cell).split()))
            self._cell = None
        elif tag == "script":
            self._script = None

    def handle_data(self, data):
        if self._script is not None:
            self.scripts[self._script] = data
        elif self._cell is not None:
            self._cell.append(data)


def changed(base, steps):
    """The tree that report_study.changes() describes."""
    tree = copy.deepcopy(base)
    for place, *value in steps:
        if not place:
            tree = copy.deepcopy(value[0])
            continue
        node = tree
        for key in place[:-1]:
            node = node[key]
        if value:
            node[place[-1]] = copy.deepcopy(value[0])
        else:
            del node[place[-1]]
    return tree


def values(column, count):
    return column["values"] if "values" in column else [column["all"]] * count


class ReportTest(StudyTest):
    def report(self, *arguments, code=0, folder=None):
        result = run_command("report_study", folder or self.out(), *arguments)
        self.assertEqual(result.returncode, code, result.stdout + result.stderr)
        return result

    def page(self, **where):
        return Page(self.out("report.html", **where))


class MadeStudy(ReportTest):
    """The report of one study that make has run."""

    @classmethod
    def setUpClass(cls):
        cls.shared = cls.made(study(SIGMAS, RESOLUTIONS, title=HOSTILE, description="Why " + HOSTILE, plot=FEW_FIGURES, **REPEATS), "study", "-j2")

    def setUp(self):
        self.folder = self.shared.folder

    def test_every_number_of_the_table(self):
        tree, rows = self.page().tree, self.rows()
        columns = {column["name"]: column for column in tree["columns"]}
        self.assertEqual(len(rows), 12)
        self.assertEqual(set(rows[0]) - set(columns), {"pass"})
        for name in set(rows[0]) - {"pass"}:
            for row, value in zip(rows, values(columns[name], 12)):
                if row[name] == "":
                    self.assertIsNone(value)
                else:
                    self.assertLessEqual(abs(float(row[name]) - value), 1e-6 * abs(value), name)
        verdicts = ["pass" if row["pass"] == "1" else "fail" for row in rows]
        self.assertEqual(set(verdicts), {"pass", "fail"})
        self.assertEqual(values(columns["verdict"], 12), verdicts)
        for row, missed in zip(rows, values(columns["missed"], 12)):
            failing = [name.split(".")[1].replace("_", " ") for name in row if name.startswith("requirements.") and name.endswith(".pass")
                       and row[name] == "0"]
            self.assertEqual(missed, ", ".join(failing))

    def test_points_are_those_of_the_figures(self):
        page = self.page()
        (table,) = [table for table in page.tables if any("all requirements" in head for head in table[0])]
        with open(self.out("figures", "pass_rates.csv"), encoding="utf-8") as file:
            rates = [row for row in csv.DictReader(file) if row["requirement"] == "all"]
        self.assertEqual(len(table), 1 + len(rates))
        for line, rate in zip(table[1:], rates):
            self.assertEqual((float(line[0]), float(line[1])), (float(rate["range_sigma_m"]), float(rate["resolution_m"])))
            low, high = 100 * float(rate["low_95"]), 100 * float(rate["high_95"])
            self.assertEqual(line[3], f"{rate['passed']}/{rate['count']} {low:.0f}–{high:.0f} %")
        with open(self.out("figures", "percentiles.csv"), encoding="utf-8") as file:
            estimates = [row for row in csv.DictReader(file) if row["metric"] == "accuracy.relative.z.max_m"]
        at = table[0].index("relative elevation error, largest [m]")
        for line, row in zip(table[1:], estimates):
            self.assertEqual(line[at], f"{float(row['value']):.3g} {float(row['low_95']):.3g}–{float(row['high_95']):.3g}")

    def test_configuration_of_every_case(self):
        tree = self.page().tree
        planned = reader.read_study(self.path("tiny.json"))
        for number, indices in enumerate(planned.cases()):
            for index, stage in enumerate(planned.base):
                config = tree["configs"][stage]
                found = changed(config["base"], config["changes"][tree["caseConfigs"][number][index]])
                self.assertEqual(found, model.configuration(planned, stage, indices), (number, stage))
        self.assertEqual(tree["configs"]["scan"]["shared"]["noise"], {"range_sigma_m": "(varies)"})
        self.assertEqual(tree["configs"]["scan"]["shared"]["detector"], BASE["scan"]["detector"])

    def test_times_and_files(self):
        """The time of a case is the sum over its five runs, whose summaries are in four logs."""
        tree = self.page().tree
        seconds = {}
        for name in self.files("log"):
            if name.endswith(".json"):
                text = "[" + re.sub(r"(?m)^}\n{", "},{", read(self.out("log", name)).decode()) + "]"
                seconds[name.rsplit(".", 1)[0]] = [entry["wall_s"] for entry in json.loads(text)]
        metrics, log, *needs = read(self.out("targets.txt")).decode().splitlines()[0].split()
        logs = [os.path.basename(log)[:-4], *(re.sub(r"^shared/(.*)\.scan", r"scan/\1", need)[:-3].replace("/", "-") for need in needs)]
        runs = [len(seconds[name]) for name in logs]
        self.assertEqual((runs[0], sum(runs)), (2, 5), logs)  # regrid and dem-eval; other cases use the same terrain, truth and scan
        self.assertEqual(metrics, json.loads(read(self.out("cases.json")))["cases"][0][-1])
        expected = sum(sum(seconds[name]) for name in logs)
        times = values(next(column for column in tree["columns"] if column["name"] == "time_s"), 12)
        self.assertAlmostEqual(times[0], expected, delta=1e-3 * expected)
        kept = {run[1] for run in tree["runs"] if run[5]}
        self.assertEqual(kept, {f"{kind}/{name}" for kind in ("terrain", "truth") for name in self.files(kind)})
        self.assertEqual(tree["tools"], read(self.out("tools.txt")).decode().splitlines())

    def test_texts_of_a_study_are_escaped(self):
        page, text = self.page(), read(self.out("report.html")).decode()
        self.assertEqual(page.tree["title"], HOSTILE)
        self.assertNotIn("<b>", text)
        self.assertNotIn("<script>alert", text)
        self.assertIn("Why &lt;/script&gt;", text)

    def test_the_page_has_no_external_references(self):
        page = self.page()
        for tag, attributes in page.tags:
            for name in ("src", "href", "srcset", "action"):
                self.assertRegex(attributes.get(name) or "#", "^(data:|#)", tag)
        self.assertEqual(sum(tag == "img" for tag, _ in page.tags), len([name for name in self.files("figures") if name.endswith(".png")]))
        self.assertNotRegex(read(self.out("report.html")).decode(), r"@import|url\(")

    def test_the_report_is_reproducible(self):
        self.assertIn("Nothing to be done", self.make("study").stdout)
        self.report("-o", self.path("again.html"))
        self.assertEqual(read(self.path("again.html")), read(self.out("report.html")))

    def test_refusals(self):
        for arguments, code, words in (
                ([], 2, "report.html exists; use -O to overwrite it"), (["-o", self.path("a.pdf")], 2, "must end in .html"),
                (["-o", self.path("none", "a.html")], 2, f"folder {self.path('none')} does not exist"),
                (["-o", self.path("a.html"), "--figures", self.path("none")], 1, "percentiles.csv: No such file")):
            self.assertIn(words, self.report(*arguments, code=code).stderr)
        self.assertIn("no planned study", self.report("-O", folder=self.path(), code=1).stderr)
        self.assertFalse([name for name in os.listdir(self.path()) if name.startswith("a.")])


@functools.cache
def failed_study():
    """A study whose case 1 failed, with its report."""
    test = ReportTest.made(study({"key": "regrid.half_width_m", "values": [5, 2, 4]}, plot=FEW_FIGURES), "study", "-k", "-j2", code=2)
    test.assertFalse(os.path.exists(test.out("report.html")))
    test.sweep("collect", "--partial", test.out())
    write_numbers(test.out())
    test.report()
    return test


class ChangedStudy(ReportTest):
    def test_failed_and_missing_cases(self):
        self.copy(failed_study())
        tree = self.page().tree
        self.assertEqual(tree["verdicts"].get("error"), 1)
        ((log, end, tail, cases),) = tree["failures"]["logs"]
        self.assertEqual(cases, [1])
        self.assertRegex(log, r"^log/metrics-[0-9a-f]{16}\.log$")
        self.assertRegex(end, r"^exit 2 after ")
        self.assertRegex(tail[-1], r"dem-eval: .*region_radius_m: 3.5 does not fit")
        text = read(self.out("report.html")).decode()
        self.assertIn(tail[-1].split("/")[0], text)
        self.assertIn('1 case, <a href="#case-1">half width 2 m</a>: exit 2 after ', text)
        os.remove(self.out(log))  # as for a case that was never run
        self.report("-O")
        self.assertEqual((self.page().tree["failures"]), {"logs": [], "notMade": [1]})

    def test_a_table_of_a_different_plan(self):
        folder = fake_study(self, {"key": "regrid.resolution_m", "values": [0.1, 0.2, 0.25]})
        self.report()
        self.plan(study({"key": "regrid.resolution_m", "values": [0.1, 0.3, 0.25]}), "--no-check")
        self.assertRegex(self.report("-O", code=1).stderr, r"results.h5: case 1: resolution_m differs from cases.json")
        with open(os.path.join(folder, "study.mk"), "w", encoding="utf-8") as file:
            file.write("# nothing\n")
        self.plan(study({"key": "regrid.resolution_m", "values": [0.1, 0.2, 0.25]}), "--no-check")
        os.remove(os.path.join(folder, "figures", "percentiles.csv"))
        self.assertIn("percentiles.csv", self.report("-O", code=1).stderr)

    def test_folders_are_removed_from_paths(self):
        config = report_study.without_folders({"base": {"path": "/home/me/secret/a.tif"}, "values": [{"path": 'NETCDF:"/x/y.h5":z'}]})
        self.assertEqual(config, {"base": {"path": "a.tif"}, "values": [{"path": 'NETCDF:"y.h5":z'}]})

    def test_changes_reproduce_the_configuration(self):
        base = {"a": 1, "b": {"c": [1, 2, {"d": True}]}, "e": "x"}
        for tree in (base, {"a": 1}, {**base, "a": True}, {**base, "b": {"c": [1, 3, {"d": 1}]}}, {**base, "b": {"c": [1]}, "f": None}):
            steps = report_study.changes(base, tree)
            self.assertEqual(json.dumps(changed(base, steps), sort_keys=True), json.dumps(tree, sort_keys=True))
        self.assertEqual(report_study.changes(base, base), [])
        self.assertEqual(report_study.shared(base, [report_study.changes(base, {**base, "a": 2})]), {**base, "a": "(varies)"})


def fake_study(test, *axes, **keys):
    """Plans a study and writes metrics for each case: those of a real case, scaled by the case number. Returns the folder."""
    folder = test.plan(study(*axes, **keys), "--no-check")
    with open(os.path.join(ROOT, "testdata", "studies", "metrics.json"), encoding="utf-8") as file:
        metrics = json.load(file)
    statistics = metrics["statistics"]
    for number, (*_, name) in enumerate(json.loads(read(os.path.join(folder, "cases.json")))["cases"]):
        largest = 0.02 + 0.06 * (number * 7919 % 1000) / 1000
        metrics["statistics"] = scaled(statistics, 1 + number * 1e-4)
        metrics["accuracy"]["relative"]["z"]["max_m"] = largest
        metrics["pass"] = metrics["requirements"]["relative_elevation"]["pass"] = largest <= 0.05
        with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
            file.write(json.dumps(metrics))  # json.dump takes three times as long
    test.sweep("collect", folder)
    write_numbers(folder)
    return folder


def scaled(tree, factor):
    return {key: scaled(value, factor) for key, value in tree.items()} if isinstance(tree, dict) else tree * factor


def write_numbers(folder):
    """Writes the files of plot_study.py except the figures."""
    with h5py.File(os.path.join(folder, "results.h5")) as file:
        results = table.Results(file)
    axes, metrics = [axis.name for axis in results.axes], results.plot.get("metrics", ["accuracy.relative.z.max_m", "coverage.invalid_frac"])
    os.makedirs(os.path.join(folder, "figures"), exist_ok=True)
    with contextlib.redirect_stdout(io.StringIO()):
        plot_study.write_csv(os.path.join(folder, "figures", "percentiles.csv"),
                             [*axes, "metric", "count", "percentile", "value", "low_95", "high_95"],
                             plot_study.percentile_rows(results, metrics, 0.5))
        plot_study.write_csv(os.path.join(folder, "figures", "pass_rates.csv"),
                             [*axes, "requirement", "passed", "count", "rate", "low_95", "high_95"], plot_study.pass_rate_rows(results))


@unittest.skipIf(browser.missing(), browser.missing())
class InBrowser(ReportTest):
    """Small studies with repeats, and one of 2,000 cases, in a browser."""

    @classmethod
    def setUpClass(cls):
        cls.window = browser.Browser()
        cls.addClassCleanup(cls.window.close)
        cls.browser = cls.window.driver
        cls.browser.get("about:blank")
        cls.window.requests()  # discards the requests of the browser's first page

    def open(self, *axes, fragment="", **keys):
        fake_study(self, *axes, **keys)
        self.report()
        self.browser.get("file://" + self.out("report.html") + fragment)
        self.rows_of_table = self.rows()

    def tearDown(self):
        self.assertEqual([entry["message"] for entry in self.browser.get_log("browser")], [])
        self.assertEqual({url.split("#")[0] for url in self.window.requests()}, {"file://" + self.out("report.html")})

    def run_script(self, script, *arguments):
        return self.browser.execute_script(script, *arguments)

    def seen_cases(self):
        return self.run_script("return [...document.querySelectorAll('.window tr[data-case]')].map(row => Number(row.dataset.case))")

    def by_css(self, selector):
        return self.browser.find_element("css selector", selector)

    def choose(self, name, words):
        from selenium.webdriver.support.select import Select
        Select(self.by_css(f'#filters select[name="{name}"]')).select_by_visible_text(words)

    def largest(self, case):
        return float(self.rows_of_table[case]["accuracy.relative.z.max_m"])

    def test_sort_filter_and_open(self):
        self.open(SIGMAS, RESOLUTIONS, title=HOSTILE, repeat={"count": 3})
        self.assertEqual(self.seen_cases(), list(range(18)))
        by_size = sorted(range(18), key=self.largest)
        button = self.by_css('.window th[data-column="accuracy.relative.z.max_m"] button')
        button.click()
        self.assertEqual(self.seen_cases(), by_size)
        button.send_keys("\ue007")  # Enter
        self.assertEqual(self.seen_cases(), by_size[::-1])
        self.assertEqual(self.by_css('.window th[aria-sort]').get_attribute("aria-sort"), "descending")
        self.choose("verdict", "fail")
        failing = [case for case in by_size[::-1] if self.rows_of_table[case]["pass"] == "0"]
        self.assertEqual(self.seen_cases(), failing)
        self.choose("resolution_m", "0.2")
        failing = [case for case in failing if self.rows_of_table[case]["resolution_m"] == "0.2"]
        self.assertEqual(self.seen_cases(), failing)
        self.assertEqual(self.by_css("#case-count").text, f"{len(failing)} of 18 cases")
        marks = self.run_script("return [...document.querySelectorAll('#plot .mark')].map(mark => Number(mark.dataset.case))")
        self.assertEqual(marks, failing)
        self.by_css("#clear").click()
        self.assertEqual(len(self.seen_cases()), 18)

        self.by_css("table.points tbody tr:nth-child(2)").click()
        self.assertEqual(sorted(self.seen_cases()), [3, 4, 5])
        self.by_css('.window tr[data-case="4"] button').click()
        detail = self.by_css("#case-detail").text
        self.assertIn("Case 4: range sigma 0.01 m, resolution 0.2 m, repeat 2", detail)
        self.assertIn("relative elevation", detail)
        self.by_css("#close").click()
        self.assertEqual(self.run_script("return document.activeElement.textContent"), "4")

    def test_a_case_as_a_study_file(self):
        self.open(SIGMAS, RESOLUTIONS, repeat={"count": 2, "draws": {"scan.noise.dropout_frac": {"uniform": [0, 0.2]}}},
                  options={"regrid": ["--corrected"]})
        planned = reader.read_study(self.path("tiny.json"))
        for case, indices in ((0, (0, 0, 0)), (7, (1, 1, 1)), (11, (2, 1, 1))):
            saved = self.run_script("return caseStudy(arguments[0])", case)
            alone = reader.read_study(self.write(saved, f"case{case}"))
            self.assertEqual(alone.options, planned.options)
            self.assertEqual(list(alone.base), list(planned.base))
            for stage in planned.base:
                self.assertEqual(model.configuration(alone, stage, ()), model.configuration(planned, stage, indices))

    def test_a_case_with_draws_as_a_study_file(self):
        """The run of draws of the saved study is the same one: it has scan, regrid and eval from its case."""
        tree = study({"key": "draws.draws", "values": [1, 2]}, {**SIGMAS, "values": [0.01, 0.02]}, plot=FEW_FIGURES)
        tree["base"]["draws"] = {"metrics": "verdict"}
        planned = stages.build(reader.read_study(self.write(tree)))
        self.make("study-results", "-j2")
        write_numbers(self.out())
        self.report()
        self.browser.get("file://" + self.out("report.html"))
        for case in (0, 3):
            saved = self.run_script("return caseStudy(arguments[0])", case)
            alone = stages.build(reader.read_study(self.write(saved, f"case{case}")))
            self.assertEqual(list(alone.draws), [planned.cases[case][1]["draws"].id])

    def test_a_failed_case_and_the_address_of_a_case(self):
        self.copy(failed_study())
        self.browser.get("file://" + self.out("report.html") + "#case-1")
        detail = self.by_css("#case-detail").text
        self.assertIn("half width 2 m", detail)
        self.assertIn("does not fit the DEM", detail)
        self.choose("verdict", "error")
        self.assertEqual(self.seen_cases(), [1])

    def test_a_foreign_script_does_not_run(self):
        self.open(SIGMAS)
        path = self.out("report.html")
        text = read(path).decode().replace("</main>", "<script>document.title = 'foreign';</script></main>")
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)
        self.browser.get("file://" + path)
        self.assertEqual((len(self.seen_cases()), self.browser.title), (3, "tiny"))
        (entry,) = self.browser.get_log("browser")
        self.assertIn("violates the following Content Security Policy directive 'script-src 'sha256-", entry["message"])

    def test_dark_mode(self):
        self.open(SIGMAS, fragment="#case-1")
        paper = "return getComputedStyle(document.querySelector('main > section')).backgroundColor"
        light = self.run_script(paper)
        self.by_css("#theme").click()
        self.assertEqual((light, self.run_script(paper)), ("rgb(255, 255, 255)", "rgb(24, 29, 35)"))
        self.assertEqual(self.run_script(FAINT), [])
        self.assertEqual(self.run_script("return getComputedStyle(document.querySelector('#plot .mark.fail')).stroke"), "rgb(255, 138, 61)")

    def test_widths(self):
        long_name = {"name": "a_very_long_name_of_an_axis_that_nobody_would_choose_but_somebody_will", "key": "scan.noise.range_sigma_m",
                     "values": [0, 0.01]}
        self.open(long_name, RESOLUTIONS, description="word " * 100, repeat={"count": 2}, fragment="#case-1")
        self.assertTrue(self.by_css("#case-detail").is_displayed())
        for details in self.browser.find_elements("css selector", "details"):
            self.run_script("arguments[0].open = true", details)
        for width in (1400, 800):
            self.window.resize(width)
            self.assertEqual(self.run_script("return innerWidth"), width)
            self.assertLessEqual(self.run_script("return document.documentElement.scrollWidth"), width)
            self.assertEqual(self.run_script("return [...document.querySelectorAll('section')].filter(part => part.scrollWidth > part.clientWidth)"
                                             ".map(part => part.id)"), [])

    def test_points_of_three_axes_fit(self):
        self.open(SIGMAS, RESOLUTIONS, {"key": "scan.noise.dropout_frac", "values": [0, 0.2]}, repeat={"count": 2},
                  plot={"metrics": plot_study.DEFAULT_METRICS})
        self.window.resize(1400)
        self.assertEqual(self.run_script("return document.querySelector('table.points').rows[0].cells.length"), 3 + 1 + 7 + 5)
        hidden = "const part = document.querySelector('.scroll:has(table.points)'); return part.scrollWidth - part.clientWidth"
        self.assertEqual(self.run_script(hidden), 0)
        self.window.resize(800)
        self.assertGreater(self.run_script(hidden), 0)
        bar = "return getComputedStyle(document.querySelector('.scroll:has(table.points)'), '::-webkit-scrollbar').height"
        self.assertEqual(self.run_script(bar), "12px")

    def test_many_cases(self):
        self.open({"key": "scan.noise.range_sigma_m", "linspace": [0, 0.1, 500]}, {"key": "scan.noise.dropout_frac", "linspace": [0, 0.9, 4]})
        self.assertEqual(len(self.rows_of_table), 2000)
        self.assertLess(os.path.getsize(self.out("report.html")), 3.2e6)
        self.assertLess(len(self.seen_cases()), 100)
        self.by_css('.window th[data-column="accuracy.relative.z.max_m"] button').click()
        by_size = sorted(range(2000), key=self.largest)
        self.assertEqual(self.seen_cases()[:30], by_size[:30])
        self.run_script("document.getElementById('case-window').scrollTop = 1e9")
        self.run_script("buildRows()")
        self.assertEqual(self.seen_cases()[-20:], by_size[-20:])
        low = self.by_css('#filters input[name="range_sigma_m from"]')
        low.send_keys("0.0999")
        self.assertEqual(self.by_css("#case-count").text, "4 of 2,000 cases")
        self.run_script("window.dispatchEvent(new Event('beforeprint'))")
        self.assertEqual(len(self.seen_cases()), 4)
        self.run_script("window.dispatchEvent(new Event('afterprint'))")


if __name__ == "__main__":
    unittest.main()
