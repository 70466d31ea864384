# SPDX-License-Identifier: GPL-3.0-or-later
"""The page of landfall study report: HTML of the tree of its report(). Texts from files are escaped."""
import base64
import html
import json
import os

from landfall import tools, web
from landfall.command import read_bytes, write_text
from landfall.errors import DataError, printable_lines
from landfall.numbers import unit_of
from landfall.study.model import label_of, TOOLS
from landfall.study.names import counted, number, titled, with_unit
from landfall.study.table import error_sign, metric_label

MAX_VALUES = 12  # of an axis that are all named
MAX_NAMED = 20  # cases of one failure
VERDICTS = ("pass", "fail", "not judged", "error", "not made")
VERDICT_CLASS = {"pass": "pass", "fail": "fail", "error": "error"}
RUN_NAMES = {"terrain": TOOLS["terrain"], "truth": "scan-sim, truths", **TOOLS}
WHOLE = {"crossing": "Where a metric exceeds a level", "overview": "Metrics side by side", "hazards": "Hazards and best sites", "campaigns": "Probability of passing",
         "requirements": "Requirements met", "shares": "Share of each limit that is used"}


def escaped(value):
    return html.escape(printable_lines(value))


def page(tree, figures):
    """The whole document; `figures` is the folder with those of landfall plot study."""
    sections = [("verdicts", "Verdicts", verdicts(tree)), ("failed", "Cases that were not made", failed(tree)),
                ("tried", "What was tried", tried(tree)), ("points", "Points", points(tree)), ("cases", "Cases", CASES),
                ("figures", "Figures", figure_panels(figures, tree)), ("provenance", "Provenance", provenance(tree))]
    description = f"<p>{escaped(tree['description'])}</p>" if tree["description"] else ""
    note = f'{description}\n<p class="note">Study {escaped(tree["name"])}: {escaped(size(tree))}</p>'
    return document("study", tree["title"], note, [section for section in sections if section[2]],
                    f'<script type="application/json" id="report-data">{data(tree)}</script>\n')


def document(name, title, note, sections, elements=""):
    """The page `name` of lib/app/report/web. Sections are (name, heading, HTML); `note`, HTML, is below the title; `elements` are data of
    the script."""
    body = "".join(f'<section id="{name}"><h2>{escaped(heading)}</h2>\n{text}</section>\n' for name, heading, text in sections)
    parts = {"title": escaped(title), "subtitle": note, "banner": "", "sections": body, "data": elements}
    folder = os.path.join(tools.SHARE, "lib", "app", "report", "web")
    try:
        return web.filled(web.template(folder, name), parts)
    except OSError as error:
        raise DataError(f"{error.filename}: {error.strerror}") from error


def write_page(text, path):
    try:
        write_text(path, text)
    except OSError as error:
        raise DataError(f"cannot write {path}: {error.strerror}") from error


def data(tree):
    """The values that study.js reads, as JSON in which nothing ends the element that holds it."""
    points_of_table = [{"cases": point["cases"]} for point in tree["points"]] if repeat_count(tree) > 1 else []
    text = json.dumps(printable_values({**tree, "points": points_of_table}), ensure_ascii=False, separators=(",", ":"))
    return text.replace("<", "\\u003c")


def printable_values(tree):
    """The tree with printable_lines() of every text in it, keys too."""
    if isinstance(tree, dict):
        return {printable_values(key): printable_values(value) for key, value in tree.items()}
    if isinstance(tree, (list, tuple)):
        return [printable_values(value) for value in tree]
    return printable_lines(tree) if isinstance(tree, str) else tree


def size(tree):
    repeats = repeat_count(tree)
    return counted(tree["count"], "case") + (f", {counted(len(tree['points']), 'point')} of {repeats} repeats each" if repeats > 1 else "")


def repeat_count(tree):
    return max(len(point["cases"]) for point in tree["points"])


def verdict(word):
    return f'<span class="verdict {VERDICT_CLASS.get(word, "unjudged")}">{escaped(word)}</span>'


def cell(value, text=None):
    """A number; data-value is the sort key."""
    if value is None:
        return '<td class="number">–</td>'
    return f'<td class="number" data-value="{escaped(value)}">{escaped(number(value) if text is None else text)}</td>'


def text_cell(text):
    return f"<td>{escaped(text)}</td>"


def table(heads, rows, kind="sortable"):
    """Heads are HTML of th, rows of td."""
    body = "\n".join(f"<tr>{''.join(row)}</tr>" for row in rows)
    return f'<div class="scroll"><table class="{kind}"><thead><tr>{"".join(heads)}</tr></thead>\n<tbody>\n{body}\n</tbody></table></div>\n'


def head(text, is_number=False):
    return f'<th{" class=number" if is_number else ""}>{text}</th>'


# Verdicts, failures


def verdicts(tree):
    counts = [(word, tree["verdicts"][word]) for word in VERDICTS if word in tree["verdicts"]]
    text = "<p>" + " ".join(f'<span class="count">{verdict(word)} {counted(count, "case")}</span>' for word, count in counts) + "</p>\n"
    if tree["assumptions"]:
        text += f'<p class="note" id="assumptions">Assumptions: {escaped("; ".join(tree["assumptions"]))}.</p>\n'
    if tree["stale"]:
        text += f'<p class="note">{counted(tree["stale"], "case")} of the table were made by other versions of the tools.</p>\n'
    return text


def failed(tree):
    """The failures, by log, with its end; and the stages that were not run."""
    text = ""
    for log, end, tail, cases in tree["failures"]["logs"]:
        text += (f"<p>{verdict('error')} {case_list(tree, cases)}: {escaped(end)}, {escaped(log)}</p>\n"
                 f"<pre>{escaped(chr(10).join(tail) or 'no message')}</pre>\n")
    if tree["failures"]["notMade"]:
        text += f"<p>{verdict('not made')} {case_list(tree, tree['failures']['notMade'])}</p>\n"
    return text


def case_list(tree, cases):
    """How many, and the first ones by the values of their axes."""
    named = "; ".join(f'<a href="#case-{case}">{escaped(tree["caseNames"][str(case)])}</a>' for case in cases[:MAX_NAMED])
    rest = f" and {len(cases) - MAX_NAMED:,} more" if len(cases) > MAX_NAMED else ""
    return f"{counted(len(cases), 'case')}, {named}{rest}"


# Axes, limits, configuration


def tried(tree):
    rows = [[*map(text_cell, (axis["label"], axis["role"], plain_unit(axis["unit"]))), cell(len(axis["values"])), text_cell(values(axis))]
            for axis in tree["axes"]]
    text = table([head("axis"), head("kind"), head("unit"), head("values", True), head("which")], rows) if rows else ""
    text += "<details><summary>Limits that all cases share</summary>" + limits(tree["limits"]) + "</details>\n"
    text += ('<h3>Configuration</h3>\n<p class="note">What the study sets in all cases; “(varies)” marks values that differ between cases. All else '
             "has the tools’ defaults.</p>\n")
    for kind, config in tree["configs"].items():
        shared = json.dumps(config["shared"], indent=1, ensure_ascii=False)
        differ = len({json.dumps(steps) for steps in config["changes"]})
        note = counted(differ, "configuration")
        text += f'<details><summary>{RUN_NAMES[kind]} <span class="note">{note}</span></summary><pre>{escaped(shared)}</pre></details>\n'
    return text


def plain_unit(unit):
    return "" if unit == "1" else unit


def values(axis):
    shown = [number(value, axis["digits"]) if axis["numeric"] else value if isinstance(value, str) else json.dumps(value) for value in axis["values"]]
    if len(shown) > MAX_VALUES:
        shown = [*shown[:MAX_VALUES // 2], "…", shown[-1]]
    return "; ".join(shown)


def limits(found):
    rows = [[text_cell(label_of(key, unit_of(key))), cell(value, with_unit(value, unit_of(key)))] for key, value in found.items()]
    return table([head("limit"), head("value", True)], rows) if rows else '<p class="note">None: every limit differs between cases.</p>\n'


# Points


def points(tree):
    """A row for each point with its repeats; empty where a point is a case."""
    if repeat_count(tree) == 1:
        return ""
    axes = [axis for axis in tree["axes"] if axis["role"] == "axis"]
    units = {column["name"]: column["unit"] for column in tree["columns"]}
    heads = [head(escaped(titled(axis["label"], axis["unit"])).replace("_", "_<wbr>"), axis["numeric"]) for axis in axes]
    names = [name.replace("_", " ") for name in ("all requirements", *tree["requirements"])]
    heads += [head("done", True), *(head(f"{escaped(name)} met", True) for name in names)]
    heads += [head(escaped(titled(metric_label(metric, units[metric]), units[metric])), True) for metric in tree["metrics"]]
    rows = [[*(value_cell(axis, value) for axis, value in zip(axes, point["values"])),
             cell(point["done"], f"{point['done']} of {len(point['cases'])}"), *map(rate_cell, point["rates"]),
             *(estimate_cell(estimate or [None] * 3) for estimate in point["estimates"])] for point in tree["points"]]
    sign = f"; {error_sign(tree['metrics'])}" if error_sign(tree["metrics"]) else ""
    estimate = "median" if tree["quantile"] == 0.5 else f"{100 * tree['quantile']:g}th percentile"
    return (f'<p class="note">Requirements: repeats that meet them, and the 95 % interval of their rate (Wilson). Metrics: {estimate} of the '
            f"repeats and its 95 % interval (percentile bootstrap){sign}. A click on a heading sorts, one on a row shows its cases.</p>\n"
            + table(heads, rows, "sortable points"))


def value_cell(axis, value):
    if axis["numeric"]:
        return cell(value, number(value, axis["digits"]))
    return text_cell(value if isinstance(value, str) else json.dumps(value))


def rate_cell(rate):
    if not rate or not rate[1]:
        return cell(None)
    passed, judged, low, high = rate
    kind = "pass" if passed == judged else "fail" if passed == 0 else "mixed"
    return (f'<td class="number" data-value="{passed / judged}"><span class="rate {kind}">{passed}/{judged}</span> '
            f'<span class="interval">{100 * low:.0f}–{100 * high:.0f} %</span></td>')


def estimate_cell(estimate):
    value, low, high = estimate
    if value is None:
        return cell(None)
    interval = f' <span class="interval">{number(low)}–{number(high)}</span>' if low is not None else ""
    return f'<td class="number" data-value="{value}">{number(value)}{interval}</td>'


# Cases: lib/app/report/web/study.js fills this

CASES = """<noscript><p>This table needs JavaScript; results.csv next to this page holds the same numbers.</p></noscript>
<div class="controls" id="filters"></div>
<details id="columns" class="screen-only"><summary>Columns</summary><div class="choices"></div></details>
<p class="note"><output id="case-count"></output></p>
<div class="window" id="case-window" tabindex="0" role="region" aria-label="cases"></div>
<p class="note">A click on a heading sorts. A case's number opens it: all metrics, configuration, files. Arrow keys go from case to case.
Errors are true - estimated.</p>
<div id="case-detail" hidden></div>
<h3>One number against another</h3>
<div class="controls" id="plot-controls"></div>
<div id="plot" class="panel"></div>
<p class="note" id="plot-note">A mark for each case that the filters leave; a click opens it.</p>
"""

# Figures, provenance


def figure_panels(folder, tree):
    """The figures of landfall plot study that are there: whole ones, then each metric's."""
    names, units = {**WHOLE}, {column["name"]: column["unit"] for column in tree["columns"]}
    for metric in tree["metrics"]:
        names[metric] = metric_label(metric, units[metric])
        names[metric + "-map"] = names[metric] + ", map"
    text = ""
    for name, caption in names.items():
        path = os.path.join(folder, name + ".png")
        if os.path.isfile(path):
            kind = "panel wide" if name in WHOLE else "panel"
            text += (f'<figure class="{kind}" id="figure-{escaped(name)}"><figcaption>{escaped(caption)}</figcaption>'
                     f'<img src="data:image/png;base64,{picture(path)}" alt="{escaped(caption)}"></figure>\n')
    return f'<div class="figures two">\n{text}</div>\n' if text else ""


def picture(path):
    return base64.b64encode(read_bytes(path)).decode()


def provenance(tree):
    tools = "\n".join(f"<li><code>{escaped(line)}</code></li>" for line in tree["tools"])
    rows = []
    for kind, name in RUN_NAMES.items():
        runs = [run for run in tree["runs"] if run[0] == kind]
        if runs:
            seconds, cpu, memory = ([run[index] for run in runs if run[index] is not None] for index in (2, 3, 4))
            rows.append([f"<td>{name}</td>", cell(len(runs)), cell(sum(seconds), f"{sum(seconds):,.1f}"), cell(sum(cpu), f"{sum(cpu):,.1f}"),
                         cell(max(memory, default=None), f"{max(memory, default=0) / 1e6:,.0f}")])
    heads = [head("tool"), *(head(text, True) for text in ("runs", "time [s]", "CPU time [s]", "largest memory [MB]"))]
    return (f"<p>Tools:</p>\n<ul>{tools}</ul>\n" + table(heads, rows) +
            '<p class="note">A run that several cases share counts once here, and in the time of each case. Configurations, files and their '
            "ids stand with each case. Paths in configurations are cut to the file’s name.</p>\n")
