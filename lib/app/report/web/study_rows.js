// SPDX-License-Identifier: GPL-3.0-or-later

// The cases that a study's report shows: the values and texts of their columns, filters, order, and the case that is open.

import {buttonElement, choiceElement, compareKeys, htmlElement} from "./elements.js";
import {report} from "./report_data.js";

// Columns (python/landfall/study/report_study.py)

export const columnOf = new Map(report.columns.map((column) => [column.name, column]));
export const caseCount = report.caseRuns.length;  // cases that the page holds
const VERDICT_CLASS = {pass: "pass", fail: "fail", error: "error"};

export function valueAt(column, row) {
  return "values" in column ? column.values[row] : column.all;
}

export function valuesOf(column) {
  return "values" in column ? column.values : [column.all];
}

export function isNumeric(column) {
  column.isNumeric ??= !["verdict", "text", "pass"].includes(column.role) && valuesOf(column).every((v) => v === null || typeof v === "number");
  return column.isNumeric;
}

export function numberText(value) {
  if (Number.isInteger(value) || Math.abs(value) >= 1e4) return Math.round(value).toLocaleString("en");
  return String(Number(value.toPrecision(4)));
}

/** A value of an axis, with enough digits to differ from the others. */
function axisText(value, digits) {
  const size = Math.abs(value);
  if (!(size >= 1000 && size < 1e7)) return String(Number(value.toPrecision(digits)));
  return value.toLocaleString("en", {maximumFractionDigits: Math.max(0, digits - 1 - Math.floor(Math.log10(size)))});
}

export function textOf(column, value) {
  if (value === null) return "\u2013";
  if (column.role === "pass") return value ? "pass" : "fail";
  if (typeof value === "number") return column.digits ? axisText(value, column.digits) : column.role === "case" ? String(value) : numberText(value);
  return typeof value === "string" ? value : JSON.stringify(value);
}

export function titleOf(column) {
  return column.unit ? `${column.label} [${column.unit}]` : column.label;
}

export function verdictMark(word) {
  return htmlElement("span", {class: `verdict ${VERDICT_CLASS[word] ?? "unjudged"}`}, word);
}

/** "range noise 0.0167 m, repeat 3" */
export function valuesOfCase(row) {
  return report.columns.filter((column) => ["axis", "repeat"].includes(column.role)).map((column) => {
    const unit = column.unit ? " " + column.unit : "";
    return `${column.label} ${textOf(column, valueAt(column, row))}${unit}`;
  }).join(", ");
}

export function caseName(row) {
  const name = valuesOfCase(row);
  return `Case ${row}` + (name ? `: ${name}` : "");
}

// Filters and order

const MAX_CHOICES = 200;  // of a list; an axis of more values has bounds

/** `rows`: the cases in order; `point`: the cases of the chosen point, or null; `open`: the case in full, or null. */
export const state = {sort: "case", descending: false, filters: new Map(), point: null, open: null, rows: []};
const changeListeners = [];

/** `listener` is called when the rows or the open case have changed. */
export function onChange(listener) { changeListeners.push(listener); }

export function changed() {
  for (const listener of changeListeners) listener();
}

function passes(row) {
  if (state.point !== null && !state.point.has(row)) return false;
  for (const [name, accepts] of state.filters) {
    if (!accepts(valueAt(columnOf.get(name), row))) return false;
  }
  return true;
}

function compare(column, a, b) {
  const x = valueAt(column, a), y = valueAt(column, b);
  if (x === null || y === null) return Number(x === null) - Number(y === null) || a - b;
  const order = compareKeys(x, y);
  return (state.descending ? -order : order) || a - b;
}

export function update() {
  const column = columnOf.get(state.sort);
  state.rows = [...Array(caseCount).keys()].filter(passes).sort((a, b) => compare(column, a, b));
  const held = caseCount < report.count ?
      ` (the page holds the first ${caseCount.toLocaleString("en")} of ${report.count.toLocaleString("en")})` : "";
  document.getElementById("case-count").textContent =
      `${state.rows.length.toLocaleString("en")} of ${caseCount.toLocaleString("en")} cases${held}${state.point ? ", of one point" : ""}`;
  changed();
}

function choices(column) {
  const values = new Map(valuesOf(column).map((value) => [JSON.stringify(value), value]));
  const ordered = [...values.entries()];
  return isNumeric(column) ? ordered.sort((a, b) => a[1] - b[1]) : ordered;
}

function choiceOf(column) {
  const options = choices(column).map(([key, value]) => [key, textOf(column, value)]);
  return choiceElement(titleOf(column), {name: column.name}, [["", "any"], ...options], (chosen) => {
    if (chosen === "") state.filters.delete(column.name);
    else state.filters.set(column.name, (value) => JSON.stringify(value) === chosen);
    update();
  });
}

function boundsOf(column) {
  const [low, high] = ["from", "to"].map((word) => htmlElement("input", {
    type: "number", step: "any", placeholder: word, name: `${column.name} ${word}`, "aria-label": `${titleOf(column)} ${word}`}));
  const change = () => {
    const minimum = low.value === "" ? -Infinity : Number(low.value), maximum = high.value === "" ? Infinity : Number(high.value);
    state.filters.set(column.name, (value) => value !== null && value >= minimum && value <= maximum);
    update();
  };
  low.addEventListener("input", change);
  high.addEventListener("input", change);
  return htmlElement("span", {}, titleOf(column), " ", low, " ", high);
}

export function addFilters() {
  const place = document.getElementById("filters");
  for (const column of report.columns) {
    if (!["verdict", "axis", "repeat"].includes(column.role)) continue;
    const count = choices(column).length;
    if (count > 1) place.append(count <= MAX_CHOICES || !isNumeric(column) ? choiceOf(column) : boundsOf(column));
  }
  place.append(buttonElement("Show all", clearFilters, {id: "clear"}));
}

function clearFilters() {
  for (const field of document.querySelectorAll("#filters select")) /** @type {HTMLSelectElement} */ (field).value = "";
  for (const field of document.querySelectorAll("#filters input")) /** @type {HTMLInputElement} */ (field).value = "";
  state.filters.clear();
  choosePoint(null);
}

/** @returns {NodeListOf<HTMLTableRowElement>} */
function pointRows() { return document.querySelectorAll("table.points tbody tr"); }

function choosePoint(index) {
  for (const row of pointRows()) row.classList.toggle("chosen", Number(row.dataset.point) === index);
  state.point = index === null ? null : new Set(report.points[index].cases);
  document.getElementById("case-window").scrollTop = 0;
  update();
}

/** A click on a row of the table of points shows its cases only. */
export function linkPoints() {
  pointRows().forEach((row, index) => {
    row.dataset.point = String(index);
    row.tabIndex = 0;
    const choose = () => choosePoint(row.classList.contains("chosen") ? null : index);
    row.addEventListener("click", choose);
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(); });
  });
}
