# SPDX-License-Identifier: GPL-3.0-or-later
"""The verdict of an eval.h5 on one page, as PDF: requirements with their margins, assumptions, and the files and versions behind it."""
import json
import os
import textwrap

import matplotlib
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.figure import Figure

from landfall import command, files, requirements
from landfall.errors import DataError, UsageError, printable, printable_lines
from landfall.plot import maps
from landfall.requirements import flatten, margin_text, unit_of_requirement, value_text

SIZE_IN, FOOT_IN = (8.27, 11.69), 0.4  # A4; a page with more is longer
LEFT, WIDTH, ROW_IN, STEP_IN = 0.08, 0.84, 0.38, 0.25
COLORS = {"pass": "#cfe4f2", "FAIL": "#f6c9a8"}


class Page:
    """The contents of an eval.h5 that the page shows."""

    def __init__(self, path):
        with files.open_landfall(path, "landfall.evaluation") as file:
            self.name, self.attributes = os.path.basename(path), files.attributes(file)
            self.numbers = flatten(json.loads(file["metrics_json"][()]))
            self.config = json.loads(file["provenance/config_json"][()])
            self.steps = json.loads(file["provenance/chain_json"][()])
            self.rows = files.read_verdict(file)
            if self.rows is None:
                raise DataError(f"{path}: has no sentences of the verdict, as files of old versions; run dem-eval again")
            self.margins = requirements.margins_of(self.numbers, self.config)
        self.verdict = {True: "pass", False: "FAIL", None: "not judged"}[requirements.all_of(requirements.verdicts_of(self.numbers))]

    def table(self):
        """Requirement, measured, worst value, limit of it, margin, verdict."""
        for row in self.rows:
            entry, unit = self.margins[row["requirement"]], unit_of_requirement(row["requirement"])
            yield [row["requirement"].replace("_", " "), textwrap.fill(row["measured"], 34), value_text(entry["worst"], unit), value_text(entry["limit"], unit),
                   margin_text(entry["margin_frac"]), row["verdict"]]

    def assumptions(self):
        region = f"{self.numbers['region.bin_count']:,} bins of the region"
        return [region, *requirements.assumption_texts(lambda path: [self.numbers.get(path)])]

    def provenance(self):
        """[tool and version, file id], the evaluation last."""
        return [*([f"{step['tool']} {step['version']}", step["file_id"]] for step in self.steps), [self.attributes["source"], self.attributes["file_id"]]]


def draw(page, height_in=SIZE_IN[1]):
    rows, steps = list(page.table()), page.provenance()
    place = _Place(height_in)
    place.text(f"Verdict: {page.verdict}", 20, weight="bold", color=maps.VERMILION if page.verdict == "FAIL" else "black")
    place.text(f"{page.name}: {page.attributes['title']}", 10)
    place.heading("Requirements")
    place.table(["requirement", "measured", "worst value", "its limit", "margin", "verdict"], rows, [0.19, 0.33, 0.13, 0.12, 0.11, 0.12], ROW_IN,
                [COLORS.get(row[-1], "#e8e8e8") for row in rows])
    place.text("Margin: 1 - worst value / limit; of the absolute horizontal error its 95th percentile.", 8)
    place.heading("What the verdict assumes")
    place.text("\n".join(page.assumptions()), 9)
    place.heading("Limits and footprint")
    place.text(textwrap.fill(json.dumps(page.config), 112), 7, family="monospace")
    place.heading("Files and versions")
    place.table(["made by", "file id"], steps, [0.6, 0.4], STEP_IN)
    return place.figure if place.top_in >= FOOT_IN else draw(page, height_in + FOOT_IN - place.top_in + 0.01)


class _Place:
    """Puts texts and tables one below the other on a page of this height, inches."""

    def __init__(self, height_in):
        self.figure, self.height_in, self.top_in = Figure(figsize=(SIZE_IN[0], height_in)), height_in, height_in - 0.6

    def text(self, text, size, **style):
        text = printable_lines(text)
        self.figure.text(LEFT, self.top_in / self.height_in, text, fontsize=size, va="top", linespacing=1.4, parse_math=False, **style)
        self.top_in -= 1.5 * size / 72 * (text.count("\n") + 1) + 0.07

    def heading(self, text):
        self.top_in -= 0.14
        self.text(text, 12, weight="bold")

    def table(self, heads, rows, widths, row_in, colors=()):
        height_in = row_in * (len(rows) + 1)
        axes = self.figure.add_axes((LEFT, (self.top_in - height_in) / self.height_in, WIDTH, height_in / self.height_in))
        axes.axis("off")
        table = axes.table([[printable_lines(text) for text in row] for row in rows], colLabels=heads, colWidths=widths, cellLoc="left", bbox=(0, 0, 1, 1))
        table.auto_set_font_size(False)
        table.set_fontsize(8)
        for (row, column), cell in table.get_celld().items():
            cell.set_edgecolor("#b0b0b0")
            cell.get_text().set_parse_math(False)
            if row == 0:
                cell.set_text_props(weight="bold")
            elif colors and column == len(heads) - 1:
                cell.set_facecolor(colors[row - 1])
        self.top_in -= height_in + 0.14


def write(evaluation, path, overwrite):
    """Writes the page of an eval.h5. The same file gives the same bytes."""
    if not path.endswith(".pdf"):
        raise UsageError(f"--page {path}: the name must end in .pdf")
    command.check_outputs([path], overwrite)
    page = Page(evaluation)
    with files.drawing([evaluation]), matplotlib.rc_context({"pdf.fonttype": 42}):
        figure = draw(page)
        metadata = {"Title": f"Verdict of {page.name}: {page.verdict}", "Creator": page.attributes["source"], "Producer": None, "CreationDate": None}
        command.write_whole(path, lambda name: FigureCanvasPdf(figure).print_pdf(name, metadata=metadata))
    print(printable(path))
