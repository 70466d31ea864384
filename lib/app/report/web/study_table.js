// SPDX-License-Identifier: GPL-3.0-or-later

// The table of a study's cases, of which only the rows that are seen are built.

import {buttonElement, htmlElement} from "./elements.js";
import {report} from "./report_data.js";
import {isNumeric, state, textOf, titleOf, update, valueAt, valuesOf, verdictMark} from "./study_rows.js";

const ROW_HEIGHT = 31;
const ROWS_BESIDE = 20;  // built above and below the visible rows
const MAX_PRINTED = 300;

const caseWindow = document.getElementById("case-window");
const rowsOfCases = htmlElement("tbody");
const table = htmlElement("table", {class: "sortable", "data-sortable": "by its own means"}, rowsOfCases);
let shown = report.columns.filter((column) => column.first);
let isPrinting = false;

export function addColumnChoices() {
  const place = document.querySelector("#columns .choices");
  for (const column of report.columns.slice(1)) {
    const box = htmlElement("input", {type: "checkbox", checked: column.first, name: column.name});
    box.addEventListener("change", () => {
      shown = report.columns.filter((other) => other === column ? box.checked : shown.includes(other));
      buildHead();
      buildRows();
    });
    place.append(htmlElement("label", {title: column.name}, box, ` ${titleOf(column)}`));
  }
}

function buildHead() {
  table.querySelector("colgroup")?.remove();
  table.tHead?.remove();
  const widths = shown.map(columnWidth);
  table.style.width = `${widths.reduce((sum, width) => sum + width, 0)}px`;
  const group = htmlElement("colgroup", {}, ...widths.map((width) => htmlElement("col", {width})));
  table.prepend(group, htmlElement("thead", {}, htmlElement("tr", {}, ...shown.map(heading))));
}

function heading(column) {
  const button = buttonElement(breakable(titleOf(column)), () => sortBy(column.name));
  return htmlElement("th", {scope: "col", class: isNumeric(column) ? "number" : "", title: column.name, "data-column": column.name,
                            "aria-sort": sortedAs(column.name)}, button);
}

function sortedAs(name) {
  return state.sort !== name ? null : state.descending ? "descending" : "ascending";
}

function sortBy(name) {
  state.descending = state.sort === name && !state.descending;
  state.sort = name;
  for (const cell of table.tHead.rows[0].cells) {
    const order = sortedAs(cell.dataset.column);
    if (order) cell.setAttribute("aria-sort", order);
    else cell.removeAttribute("aria-sort");
  }
  update();
}

/** The text, breakable after the dots and underscores of a name. */
function breakable(words) {
  return words.split(/(?<=[._])/).flatMap((part, i) => i ? [htmlElement("wbr"), part] : [part]);
}

/** Wide enough for the longest value, and for a heading of some four lines. */
function columnWidth(column) {
  const longest = (texts) => texts.reduce((maximum, value) => Math.max(maximum, value.length), 0);
  const values = longest(valuesOf(column).map((value) => textOf(column, value))) + (column.role === "verdict" ? 5 : 0);
  const words = longest(titleOf(column).split(/[ ._]/)) + 3;
  return Math.round(18 + 7.4 * Math.min(40, Math.max(5, values, Math.min(words, 14), Math.ceil(titleOf(column).length / 4))));
}

export function buildRows() {
  const {rows} = state;
  const seen = Math.ceil(caseWindow.clientHeight / ROW_HEIGHT) || 20;
  const top = Math.floor(caseWindow.scrollTop / ROW_HEIGHT);
  let from = Math.max(0, Math.min(top, rows.length - seen) - ROWS_BESIDE), to = Math.min(rows.length, top + seen + ROWS_BESIDE);
  if (isPrinting) [from, to] = [0, Math.min(rows.length, MAX_PRINTED)];
  rowsOfCases.replaceChildren(space(from), ...rows.slice(from, to).map(caseRow), space(isPrinting ? 0 : rows.length - to));
}

/** A row as high as `count` rows. */
function space(count) {
  const cell = htmlElement("td", {colspan: shown.length});
  cell.style.height = `${count * ROW_HEIGHT}px`;
  return htmlElement("tr", {class: "space", hidden: count === 0}, cell);
}

function caseRow(row) {
  const cells = shown.map((column) => {
    const value = valueAt(column, row);
    return htmlElement("td", {class: isNumeric(column) ? "number" : "", title: value ?? ""}, caseCell(column, value));
  });
  return htmlElement("tr", {class: row === state.open ? "chosen" : "", "data-case": row}, ...cells);
}

function caseCell(column, value) {
  const words = textOf(column, value);
  if (column.role === "case") return htmlElement("button", {type: "button"}, words);
  return column.role === "verdict" || (column.role === "pass" && value !== null) ? verdictMark(words) : words;
}

/** The case of a row that holds an element, or null. */
function caseOf(element) {
  const row = element?.closest?.("tr[data-case]");
  return row ? Number(row.dataset.case) : null;
}

/** Fills the table; a click on a case's number calls `open`. */
export function startTable(open) {
  caseWindow.append(table);
  buildHead();
  let isWaiting = false;
  caseWindow.addEventListener("scroll", () => {
    if (isWaiting) return;
    isWaiting = true;
    requestAnimationFrame(() => {
      isWaiting = false;
      scrolled();
    });
  });
  table.addEventListener("click", (event) => {
    const row = caseOf(event.target);
    if (row !== null && event.target.closest("button")) open(row);
  });
  caseWindow.addEventListener("keydown", (event) => {
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key], row = caseOf(event.target);
    if (!step || row === null) return;
    event.preventDefault();
    const next = state.rows[state.rows.indexOf(row) + step];
    if (next !== undefined) focusCase(next);
  });
  window.addEventListener("beforeprint", () => layOutForPrint(true));
  window.addEventListener("afterprint", () => layOutForPrint(false));
  window.addEventListener("resize", buildRows);
}

/** Paper shows the first rows, without scrolling. */
function layOutForPrint(value) {
  isPrinting = value;
  buildRows();
}

/** Builds the rows; the one that had the focus keeps it. */
function scrolled() {
  const row = caseOf(document.activeElement);
  buildRows();
  if (row !== null) focusButton(row);
}

function focusButton(row) {
  table.querySelector(`tr[data-case="${row}"] button`)?.focus({preventScroll: true});
}

export function bringIntoView(row) {
  const place = state.rows.indexOf(row) * ROW_HEIGHT, header = table.tHead.offsetHeight;
  if (place < 0) return;
  const low = caseWindow.scrollTop, high = low + caseWindow.clientHeight - header - ROW_HEIGHT;
  if (place < low) caseWindow.scrollTop = place;
  else if (place > high) caseWindow.scrollTop = place - (high - low);
  buildRows();
}

export function focusCase(row) {
  bringIntoView(row);
  focusButton(row);
}
