// SPDX-License-Identifier: GPL-3.0-or-later

// The report of a study: the table of its cases with filters, one case in full, and a plot of one column against another.

import {axisOf, Chart} from "./chart.js";
import {choiceElement, LINE, svgElement} from "./elements.js";
import {startPage} from "./page.js";
import {report} from "./report_data.js";
import {openCase} from "./study_case.js";
import {addFilters, caseName, columnOf, isNumeric, linkPoints, numberText, onChange, state, textOf, titleOf, update, valueAt, valuesOf} from "./study_rows.js";
import {addColumnChoices, buildRows, startTable} from "./study_table.js";

// The plot

const PLOT = {width: 900, height: 400, left: 80};

function addChoice(name, columns, first) {
  document.getElementById("plot-controls").append(choiceElement(
      name, {name: `plot ${name}`, id: `plot-${name}`}, columns.map((column) => [column.name, titleOf(column)]), drawPlot, first?.name));
}

function choosePlot() {
  const numbers = report.columns.filter((column) => ["axis", "metric", "drawn", "time"].includes(column.role) &&
                                                    valuesOf(column).some((v) => v !== null));
  const metrics = numbers.filter((column) => column.role !== "axis");
  addChoice("x", [...numbers, columnOf.get("case")], numbers[0]);
  addChoice("y", metrics, metrics.find((column) => column.first) ?? metrics[0]);
}

/** @returns {HTMLSelectElement} */
function choice(name) { return document.querySelector(`#plot-${name}`); }

/** The axis of a column, words side by side, and the place of a case's value on it. */
function scaledBy(column, rows, also, spacing) {
  if (isNumeric(column)) {
    const axis = {...axisOf([...rows.map((row) => valueAt(column, row)), ...also], titleOf(column)), spacing};
    return {axis, place: (row) => valueAt(column, row)};
  }
  const words = [...new Set(valuesOf(column).map((value) => textOf(column, value)))];
  return {axis: {low: -0.5, high: words.length - 0.5, label: titleOf(column), words},
          place: (row) => words.indexOf(textOf(column, valueAt(column, row)))};
}

function drawPlot() {
  const [x, y] = ["x", "y"].map((name) => columnOf.get(choice(name).value));
  const rows = state.rows.filter((row) => valueAt(x, row) !== null && valueAt(y, row) !== null);
  const limit = report.metricLimits[y.name] ?? null;
  const across = scaledBy(x, rows, [], 110), up = scaledBy(y, rows, limit === null ? [] : [limit], 60);
  const chart = new Chart(`${titleOf(y)} against ${titleOf(x)}`, across.axis, up.axis, PLOT);
  if (limit !== null) chart.curve([[chart.x.low, limit], [chart.x.high, limit]], {color: LINE.purple, dash: "7 3", text: `limit ${numberText(limit)}`});
  const place = (row) => [chart.x.at(across.place(row)), chart.y.at(up.place(row))];
  chart.svg.append(...rows.map((row) => markOf(row, ...place(row))));
  if (rows.includes(state.open)) {
    const [cx, cy] = place(state.open);
    chart.svg.append(svgElement("circle", {class: "ring", cx, cy, r: 9}));
  }
  document.getElementById("plot").replaceChildren(chart.svg, chart.legend);
}

/** A ring for what passes, a cross for what fails, a square for the rest. */
function markOf(row, x, y) {
  const word = valueAt(columnOf.get("verdict"), row);
  const paths = {pass: `M${x - 4} ${y}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0`, fail: `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`};
  return svgElement("path", {class: `mark ${word in paths ? word : "unjudged"}`, d: paths[word] ?? `M${x - 3} ${y - 3}h6v6h-6z`,
                             "pointer-events": "all", "data-case": row}, svgElement("title", {}, `${caseName(row)}: ${word}`));
}

/** Opens the case that the address names. */
function openNamed() {
  const match = /^#case-(\d+)$/.exec(location.hash);
  if (match) openCase(Number(match[1]));
}

startPage(() => {
  addFilters();
  addColumnChoices();
  linkPoints();
  startTable(openCase);
  choosePlot();
  onChange(buildRows);
  onChange(drawPlot);
  document.getElementById("plot").addEventListener("click", (event) => {
    /** @type {SVGElement} */
    const mark = /** @type {Element} */ (event.target).closest("[data-case]");
    if (mark) openCase(Number(mark.dataset.case));
  });
  window.addEventListener("hashchange", openNamed);
  update();
  openNamed();
});
