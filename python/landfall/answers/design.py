# SPDX-License-Identifier: GPL-3.0-or-later
"""The cheapest lidar whose DEM passes with a given probability (docs/user/studies/design.md): the command, and its answer as text, table,
figure and page."""
import json
import math
import os

from landfall import command
from landfall.answers import answer_page, cost, design_search, model, runs
from landfall.answers.design_problem import Problem
from landfall.errors import Error, printable_lines
from landfall.study.page import cell, escaped, head, table, text_cell, verdict

STAGES = {"geometry": "the geometry of the frames", "plan": "the plan", "error": "a tool", "draw": "one draw"}


def write(problem, answer, folder):
    """design.json, candidates.csv, design.png and report.html."""
    runs.write_json(os.path.join(folder, "design.json"), answer)
    command.write_text(os.path.join(folder, "candidates.csv"), command.csv_text(_rows(problem, answer)))
    answer_page.write(problem, folder, "design", figure_of(problem, answer), lambda *parts: sections(problem, answer, *parts))


def _rows(problem, answer):
    """candidates.csv."""
    names = list(dict.fromkeys(name for candidate in answer["candidates"] for name in candidate["margins"]))
    yield [*problem.variables, "cost", "stage", "passes", *(f"ln(value/limit) of {name}" for name in names), "reason"]
    for candidate in answer["candidates"]:
        yield [*(candidate["values"][name] for name in problem.variables), candidate["cost"], candidate["stage"], int(candidate["passes"]),
               *(candidate["margins"].get(name, "") for name in names), candidate["reason"]]


def values_text(values):
    return ", ".join(f"{name} {value_text(value)}" for name, value in values.items())


def value_text(value):
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def refused(answer):
    """{stage: number of candidates that it refused}."""
    return {stage: sum(candidate["stage"] == stage and not candidate["passes"] for candidate in answer["candidates"]) for stage in STAGES}


def outcome(candidate):
    """The outcome of a candidate."""
    if not candidate["passes"]:
        return f"refused by {STAGES[candidate['stage']]}: {candidate['reason']}"
    if "race" not in candidate:
        return "one draw passes"
    counts = candidate["race"]["terrains"]
    worst = counts[candidate["race"]["terrain"]]
    if not candidate["race"]["accepted"]:
        return f"rejected by the sequential test on terrain {candidate['race']['terrain']}: {worst['passed']} of {worst['draws']} draws pass"
    text = f"accepted by the sequential test ({', '.join(str(count['passed']) + ' of ' + str(count['draws']) for count in counts)})"
    if "proof" in candidate:
        text += f"; fresh draws: {', '.join(str(rate['passed']) + ' of ' + str(rate['draws']) for rate in candidate['proof'])}"
    return text


def proof_text(answer):
    proof = answer["winner"]["proof"]
    return (f"P({answer['requirement']}) >= {min(rate['exact_lower_bound'] for rate in proof):.4f} on each of {len(proof)} terrains (exact bound, "
            f"95 % confidence): {', '.join(str(rate['passed']) + ' of ' + str(rate['draws']) for rate in proof)} fresh draws pass; "
            f"draw {answer['winner']['chain']['draw']} of the seed {answer['winner']['chain']['seed']} has the same {answer['winner']['chain']['numbers']} numbers through the chain")


def text_of(problem, answer):
    """The answer as a person reads it."""
    counts, reference = refused(answer), answer["reference_cost"]
    lines = [f"{len(answer['candidates'])} candidates; refused by {', by '.join(f'{name}: {counts[stage]}' for stage, name in STAGES.items())}",
             f"base, cost {reference:,.6g}: {outcome(answer['base'])}", "", "Candidates that one draw passes, by cost in per cent of the base's:"]
    lines += [f"  {100 * candidate['cost'] / reference:5.1f}  {outcome(candidate)}\n         {values_text(candidate['values'])}" for candidate in answer["raced"]]
    winner = answer["winner"]
    if winner is None:
        return "\n".join([*lines, "", "No candidate passes."])
    lines += ["", f"Winner: {100 * answer['cost_frac']:.1f} % of the base's cost, {winner['cost']:,.6g}", f"  {values_text(winner['values'])}",
              f"  {proof_text(answer)}", "", "Share of each limit that the search's draw uses:"]
    lines += [f"  {name:20} {100 * math.exp(value):6.1f} %{'   active' if name == answer['active'] else ''}"
              for name, value in sorted(winner["margins"].items(), key=lambda item: -item[1])]
    lines += ["", "Neighbours that cost no more:"]
    lines += [f"  {candidate['changed']} {value_text(candidate['values'][candidate['changed']])}, {100 * candidate['cost'] / reference:.1f} %: {outcome(candidate)}"
              for candidate in answer["neighbours"]]
    return "\n".join(lines)


def figure_of(problem, answer):
    """Cost against the worst requirement, or the predicted risk of the place, in the one draw: candidates, front, and what more draws made of it."""
    command.import_matplotlib()
    from matplotlib.figure import Figure

    from landfall.plot import maps

    figure = Figure(figsize=(9, 5.4), constrained_layout=True)
    axes = figure.subplots()

    def scatter(candidates, **style):
        axes.scatter([100 * candidate["cost"] / answer["reference_cost"] for candidate in candidates], [100 * math.exp(candidate["violation"]) for candidate in candidates], **style)

    drawn = [candidate for candidate in answer["candidates"] if candidate["stage"] == "draw"]
    for passes, color, label in ((False, maps.VERMILION, "fails one draw"), (True, maps.BLUE, "passes one draw")):
        chosen = [candidate for candidate in drawn if candidate["passes"] == passes]
        scatter(chosen, s=22, color=color, alpha=0.8, label=f"{label} ({len(chosen)})")
    front = answer["front"]
    axes.step([100 * candidate["cost"] / answer["reference_cost"] for candidate in front], [100 * math.exp(candidate["violation"]) for candidate in front], where="post",
              color="0.5", linewidth=1, label="Pareto front")
    rejected = [candidate for candidate in answer["raced"] if not candidate["race"]["accepted"]]
    if rejected:
        scatter(rejected, s=70, marker="x", color="black", linewidth=1.2, label=f"rejected by the sequential test ({len(rejected)})")
    if answer["base"]["stage"] == "draw":
        scatter([answer["base"]], s=90, marker="D", facecolor="none", edgecolor="black", label="base")
    if answer["winner"]:
        scatter([answer["winner"]], s=220, marker="*", color="#009e73", edgecolor="black", linewidth=0.6, label=f"winner: {100 * answer['cost_frac']:.1f} %", zorder=4)
    axes.axhline(100, color="black", linewidth=0.8, linestyle="--", label=None if problem.judges_map() else "below: accepted by sites.min_p")
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
    axes.yaxis.set_minor_formatter(lambda value, _: f"{value:g}" if str(value)[0] in "25" else "")
    axes.set(xlabel="cost, % of the base's", ylabel="worst requirement, % of its limit" if problem.judges_map() else "1 - p_touchdown of the chosen place, % of 1 - sites.min_p")
    axes.grid(alpha=0.3, which="both")
    axes.set_axisbelow(True)
    axes.legend(fontsize=8)
    figure.suptitle(problem.title, fontsize=11)
    return figure


# Page


def sections(problem, answer, figure, version):
    return [("answer", "Answer", _answer(answer)), ("front", "Candidates by many draws", _raced(answer)), ("neighbours", "Neighbours", _neighbours(answer)),
            ("figure", "Pareto front", answer_page.image(figure, "Cost against the worst requirement of one draw")),
            ("candidates", "Candidates", _candidates(problem, answer)), ("provenance", "Provenance", answer_page.configuration(problem, version))]


def _answer(answer):
    winner = answer["winner"]
    if winner is None:
        return f"<p>{verdict('fail')} No candidate passes with a probability of {answer['probability']}.</p>\n"
    heads = [head("requirement"), head("value, % of its limit, in the search's draw", True)]
    rows = [[text_cell(name + (" (active)" if name == answer["active"] else "")), cell(value, f"{100 * math.exp(value):.1f}")]
            for name, value in sorted(winner["margins"].items(), key=lambda item: -item[1])]
    rates = [[cell(number), cell(rate["passed"]), cell(rate["draws"]), cell(rate["wilson_low"], f"{rate['wilson_low']:.4f} to {rate['wilson_high']:.4f}"),
              cell(rate["exact_lower_bound"], f"{rate['exact_lower_bound']:.4f}"), cell(rate["first_seed"], str(rate["first_seed"]))]
             for number, rate in enumerate(winner["proof"])]
    return (f"<p>{verdict('pass')} {100 * answer['cost_frac']:.1f} % of the base’s cost: {escaped(values_text(winner['values']))}</p>\n"
            f"<p>{escaped(proof_text(answer))}. Candidates put to fresh draws: {answer['proofs']}.</p>\n"
            + table([head(text, True) for text in ("terrain", "passed", "draws", "Wilson interval, 95 %", "exact lower bound, 95 %", "seed")], rates)
            + table(heads, rows))


def _raced(answer):
    rows = [[cell(candidate["cost"], f"{100 * candidate['cost'] / answer['reference_cost']:.1f}"), text_cell(values_text(candidate["values"])),
             text_cell(outcome(candidate))] for candidate in answer["raced"]]
    base = f"<p>Base: {escaped(outcome(answer['base']))}.</p>\n"
    return base + table([head("cost, % of the base’s", True), head("candidate"), head("outcome")], rows)


def _neighbours(answer):
    if not answer["neighbours"]:
        return "<p>No neighbour costs as little.</p>\n"
    rows = [[text_cell(candidate["changed"]), text_cell(value_text(candidate["values"][candidate["changed"]])),
             cell(candidate["cost"], f"{100 * candidate['cost'] / answer['reference_cost']:.1f}"), text_cell(outcome(candidate))] for candidate in answer["neighbours"]]
    return ("<p class=\"note\">Each differs from the winner by one step of one variable and costs no more.</p>\n"
            + table([head("variable"), head("value"), head("cost, % of the base’s", True), head("outcome")], rows))


def _candidates(problem, answer):
    rows = [[*(text_cell(json.dumps(candidate["values"][name]) if not isinstance(candidate["values"][name], float) else f"{candidate['values'][name]:.4g}")
               for name in problem.variables), cell(candidate["cost"], f"{100 * candidate['cost'] / answer['reference_cost']:.1f}"), text_cell(outcome(candidate))]
            for candidate in answer["candidates"]]
    return table([*(head(escaped(name)) for name in problem.variables), head("cost, %", True), head("outcome")], rows)


def main(arguments):
    parser = command.Parser(description="The cheapest lidar whose DEM passes with a given probability.")
    runs.add_options(parser, "design file (docs/user/studies/design.md)")
    options = parser.parse_args(arguments)
    model.optuna()
    prefix = runs.prepare(options)
    problem = Problem(options.file)
    design = design_search.Design(problem, options.out, options.workers, prefix, runs.Progress())
    runs.say_cost(cost.text_of_design(design))
    answer = design.run()
    write(problem, answer, options.out)
    print(printable_lines(text_of(problem, answer)))
    if answer["winner"] is None:
        raise Error(f"{problem.path}: no candidate passes with a probability of {problem.probability}")
