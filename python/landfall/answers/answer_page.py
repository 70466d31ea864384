# SPDX-License-Identifier: GPL-3.0-or-later
"""The reports of sensitivity.py and design.py: one self-contained HTML file each. Texts from files are escaped."""
import json
import os

from landfall import tools
from landfall.study.page import cell, document, escaped, head, picture, table, text_cell, write_page


def write(problem, folder, name, figure, sections_of):
    """Writes the figure, NAME.png, and report.html. sections_of(path of the figure, version of the tools): [(name, heading, HTML)]."""
    from landfall.plot import plot_command  # here, because loading matplotlib takes time

    path = os.path.join(folder, name + ".png")
    plot_command.save({path: figure}, 150)
    sections = sections_of(path, tools.run_tool(tools.find("monte-carlo"), "--version").stdout)
    description = f"<p>{escaped(problem.tree.get('description', ''))}</p>"
    write_page(document("answers", problem.title, description, sections), os.path.join(folder, "report.html"))


def image(path, caption):
    return (f'<div class="figures"><figure class="panel wide"><figcaption>{escaped(caption)}</figcaption>'
            f'<img src="data:image/png;base64,{picture(path)}" alt="{escaped(caption)}"></figure></div>\n')


def configuration(problem, version):
    """The file and the version that made the answer."""
    return (f"<p>Tools: <code>{escaped(version.strip())}</code></p>\n<details><summary>{escaped(os.path.basename(problem.path))}</summary>"
            f"<pre>{escaped(json.dumps(problem.tree, indent=1))}</pre></details>\n")


def sensitivity_sections(problem, answer, figure, version):
    found = f"<p>{answer['draws']:,} draws, {len(problem.groups)} groups, {answer['points']} points; estimator: {escaped(answer['estimator'])}.</p>\n"
    if answer["points_left_out"]:
        found += (f"<p class=\"note\">{answer['points_left_out']} of {problem.size} points are left out, because a draw failed or a metric has no value.</p>\n"
                  + "".join(f"<pre>{escaped(why)}</pre>\n" for why in answer["failures"]))
    for name, output in answer["outputs"].items():
        found += f"<h3>{escaped(problem.outputs[name])}</h3>\n<p><code>{escaped(name)}</code>: mean {output['mean']:.4g}, standard deviation {output['std']:.3g}</p>\n"
        if output["groups"] is None:
            found += "<p>The same in all draws.</p>\n"
            continue
        heads = [head("group"), head("first order", True), head("95 % interval", True), head("total", True), head("95 % interval", True)]
        found += table(heads, [[text_cell(row["group"]), *_index_cells(row["first"]), *_index_cells(row["total"])] for row in output["groups"]])
    return [("indices", "Sobol indices", found), ("figure", "Figure", image(figure, "Sobol indices with 95 % intervals")),
            ("groups", "Groups", _groups(problem)), ("provenance", "Provenance", configuration(problem, version))]


def _index_cells(index):
    return [cell(index["value"], f"{index['value']:.3f}"), cell(index["low"], f"{index['low']:.3f} to {index['high']:.3f}")]


def _groups(problem):
    rows = []
    for group, keys in problem.tree["groups"].items():
        for key, given in keys.items():
            numbers = ", ".join(f"{name} {value:g}" for name, value in given.items() if name != "type")
            rows.append([text_cell(group), f"<td><code>{escaped(key)}</code></td>", text_cell(f"{given['type']}: {numbers}")])
    rows.append([text_cell(problem.groups[-1]), "<td><code>scan.draw</code></td>", text_cell("another draw in each point")])
    return table([head("group"), head("key"), head("distribution")], rows)
