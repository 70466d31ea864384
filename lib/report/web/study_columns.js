// SPDX-License-Identifier: GPL-3.0-or-later

// The columns of a study's cases (python/landfall/study/report.py): their values and texts.

import {htmlElement} from "./elements.js";
import {report} from "./report_data.js";

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

/** A value of an axis, with as many digits as tell it from the others. */
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
