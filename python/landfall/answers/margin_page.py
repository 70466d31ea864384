# SPDX-License-Identifier: GPL-3.0-or-later
"""The margins of a chain as text, figure and page."""
import json
import os
import tempfile
from decimal import Context, Decimal, ROUND_DOWN

from landfall import command, dictionary
from landfall.answers.answer_page import image
from landfall.numbers import number, unit_of, with_unit
from landfall.requirements import margin_text, unit_of_requirement, value_text
from landfall.study.page import cell, document, escaped, head, table, text_cell, verdict, write_page

VERDICTS = {True: "pass", False: "fail", None: "not judged"}


def unit_of_key(key):
    """The unit that the name in a key ends in, before an index."""
    return unit_of(key.rstrip("0123456789").rstrip("."))


def end_text(entry, unit):
    """The value up to which a key passes, not rounded to one that fails, and what it says of the other values."""
    end = entry["passes_up_to"]
    text = "not limiting" if end is None else with_unit(float(Context(4, ROUND_DOWN).create_decimal(Decimal(repr(end)))), unit, 4)
    return text if entry["monotone"] else text + " (larger ones pass again)"


def key_rows(answer):
    """(key, configured, passes up to, decides) as texts; a second row where requirements fail whatever the error is."""
    for key, entry in answer["keys"].items():
        unit = unit_of_key(key)
        configured = with_unit(entry["configured"], unit, 4)
        yield key, configured, end_text(entry, unit) if entry["passes_at_zero"] else "never", entry["decides"] or ""
        if "others" in entry:
            yield "", "", end_text(entry["others"], unit), entry["others"]["decides"] or ""


def left_out(answer):
    """The requirements that fail without some of the errors too: {requirement: number of keys}."""
    found = {}
    for entry in answer["keys"].values():
        for name in entry.get("others", {}).get("left_out", []):
            found[name] = found.get(name, 0) + 1
    return found


def notes(answer):
    out = [f"{name} fails for {count} of {len(answer['keys'])} keys even where the error is 0; the second row of such a key leaves it out"
           for name, count in left_out(answer).items()]
    unjudged = [name for name, entry in answer["requirements"].items() if entry["worst"] is None]
    shares = [name for name, entry in answer["requirements"].items() if name in dictionary.requirements() and entry["worst"] is not None
              and dictionary.requirements()[name].at_least and entry["margin_frac"] is None]
    return out + [f"{what}: {', '.join(names)}" for what, names in (("not judged, and left out of the search", unjudged),
                                                                    ("no margin, as another share than 95 % is judged", shares)) if names]


def text_of(answer):
    """The answer as a person reads it."""
    lines = [f"{'requirement':24}{'worst':>14}{'limit':>14}{'margin':>11}"]
    for name, entry in answer["requirements"].items():
        unit = unit_of_requirement(name)
        lines.append(f"{name:24}{value_text(entry['worst'], unit):>14}{value_text(entry['limit'], unit):>14}{margin_text(entry['margin_frac']):>11}")
    lines += [f"{'all':24}{VERDICTS[answer['pass']]:>14}", "", f"{'error':42}{'configured':>16}{'passes up to':>18}  decides"]
    lines += [f"{key:42}{configured:>16}{end:>18}  {decides}".rstrip() for key, configured, end, decides in key_rows(answer)]
    lines += ["", "posting   verdict"]
    lines += [f"{with_unit(entry['resolution_m'], 'm'):10}{VERDICTS[entry['pass']]}{': ' if entry['fails'] else ''}{', '.join(entry['fails'])}" for entry in answer["postings"]]
    return "\n".join([*lines, *(f"note: {note}" for note in notes(answer))])


def shares_used(answer, base):
    """[(requirement, share of its limit that is used)]; of a number that is to be at least its limit, the share of the number that the limit is."""
    at_least = {own["name"] for own in base["eval"].get("requirements", []) if "min" in own}
    for name, entry in answer["requirements"].items():
        if entry["margin_frac"] is None or (name in at_least and entry["worst"] <= 0):
            continue
        yield name.replace("_", " "), entry["limit"] / entry["worst"] if name in at_least else max(0, 1 - entry["margin_frac"])


def figure_of(answer, base):
    """The share of each limit that is used; and of the largest errors that pass the share that is configured, where any is."""
    command.import_matplotlib()
    from matplotlib.figure import Figure

    from landfall.plot import maps

    used = list(shares_used(answer, base))
    limited = {key: entry if entry["passes_at_zero"] else entry.get("others") for key, entry in answer["keys"].items()}
    errors = [(f"{key.split('.', 2)[2]}, up to {with_unit(entry['passes_up_to'], unit_of_key(key))}", answer["keys"][key]["configured"] / entry["passes_up_to"])
              for key, entry in limited.items() if entry and entry["passes_up_to"] and answer["keys"][key]["configured"]]
    panels = [part for part in ((used, "Requirements: share of the limit that the worst value uses"),
                                (errors, "Errors: share of the largest value that passes that is configured")) if part[0]]
    figure = Figure(figsize=(9, sum(0.9 + 0.27 * len(bars) for bars, _ in panels)), constrained_layout=True)
    all_axes = figure.subplots(len(panels), 1, squeeze=False, height_ratios=[len(bars) + 1 for bars, _ in panels])[:, 0]
    for axes, (bars, title) in zip(all_axes, panels):
        axes.barh([name for name, _ in bars], [100 * value for _, value in bars], 0.6, color=[maps.VERMILION if value > 1 else maps.BLUE for _, value in bars])
        for place, (_, value) in enumerate(bars):
            axes.text(100 * value, place, f" {number(100 * value)} %", va="center", fontsize=8)
        axes.axvline(100, color="black", linestyle="--", linewidth=1)
        axes.set_xlim(0, 112 * max([1, *(value for _, value in bars)]))
        axes.set_ylim(len(bars) - 0.4, -0.6)
        axes.tick_params(labelsize=9)
        axes.set_title(title, fontsize=10, loc="left")
        axes.set_xlabel("%, 100: the limit" if bars is used else "%, 100: the largest value that passes", fontsize=9)
    return figure


def sections(answer, base, picture):
    """[(name, heading, HTML)] of the page."""
    rows = [[text_cell(name.replace("_", " ")), cell(entry["worst"], value_text(entry["worst"], unit_of_requirement(name))),
             cell(entry["limit"], value_text(entry["limit"], unit_of_requirement(name))), cell(entry["margin_frac"], margin_text(entry["margin_frac"]))]
            for name, entry in answer["requirements"].items()]
    found = f"<p>The chain as configured: {verdict(VERDICTS[answer['pass']])}</p>\n" + table([head("requirement"), *(head(text, True) for text in ("worst value", "limit", "margin"))], rows)
    keys = "".join(f"<p class=\"note\">{escaped(note)}.</p>\n" for note in notes(answer)) + table(
        [head(text) for text in ("error", "configured", "passes up to", "the requirement that decides")], [list(map(text_cell, row)) for row in key_rows(answer)], "")
    postings = table([head("posting"), head("verdict"), head("fails")], [[text_cell(with_unit(entry["resolution_m"], "m")), f"<td>{verdict(VERDICTS[entry['pass']])}</td>",
                     text_cell(", ".join(entry["fails"]))] for entry in answer["postings"]], "")
    origin = (f"<p>Seed {answer['seed']}, draw {answer['draw']}; tools: <code>{escaped(answer['source'])}</code></p>\n<details><summary>Configuration</summary>"
              f"<pre>{escaped(json.dumps(base, indent=1))}</pre></details>\n")
    return [("requirements", "Requirements", found), ("figure", "Figure", image(picture, "Margins against limits")), ("errors", "Errors that pass", keys),
            ("postings", "Postings", postings), ("provenance", "Provenance", origin)]


def write(answer, base, path):
    figure = figure_of(answer, base)
    from matplotlib.backends.backend_agg import FigureCanvasAgg  # after figure_of(), which imports matplotlib

    with tempfile.TemporaryDirectory(prefix="landfall-margin-") as folder:
        picture = os.path.join(folder, "margin.png")
        figure.set_dpi(150)
        FigureCanvasAgg(figure).print_png(picture, metadata={"Software": None})
        note = "<p>The margin of each requirement, the largest error of each kind with which the chain passes, one at a time and with the same random numbers, and the postings that pass.</p>"
        write_page(document("answers", "Margins", note, sections(answer, base, picture)), path)
