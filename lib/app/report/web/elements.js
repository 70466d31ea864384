// SPDX-License-Identifier: GPL-3.0-or-later

// Colours by name, and elements of the page.

// Okabe and Ito's palette is readable with every common colour blindness, too.
export const BLUE = "#0072b2";
export const VERMILION = "#d55e00";
export const INK = "#1d2733";            // on maps, which look the same in light and dark mode
export const TEXT_COLOR = "var(--ink)";  // next to maps
// Lines of diagrams differ in light and dark mode (report.css).
export const LINE = {blue: "var(--blue)", sky: "var(--sky)", vermilion: "var(--vermilion)", purple: "var(--purple)"};

/** Attributes that are null or false are left out; true sets one without a value. */
function withParts(element, attributes, children) {
  for (const [key, value] of Object.entries(attributes)) {
    if (value !== null && value !== false) element.setAttribute(key, value === true ? "" : value);
  }
  element.append(...children);
  return element;
}

export function svgElement(name, attributes = {}, ...children) {
  return withParts(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

/** An outline over a wider white one, so that it is seen on every colour of a map. */
export function outlined(name, attributes, {width = 1.5, color = INK, dash = ""} = {}) {
  const stroke = (style) => svgElement(name, {fill: "none", ...attributes, ...style});
  return [stroke({stroke: "#ffffff", "stroke-width": width + 2}), stroke({stroke: color, "stroke-width": width, "stroke-dasharray": dash})];
}

export function htmlElement(name, attributes = {}, ...children) {
  return withParts(document.createElement(name), attributes, children);
}

/** An entry of a legend: a line and its name. */
export function legendEntry(text, color, dash, width = 2.5) {
  const sample = svgElement("svg", {viewBox: "0 0 30 10", class: "sample"}, svgElement(
      "line", {x1: 1, x2: 29, y1: 5, y2: 5, stroke: color, "stroke-width": width, "stroke-dasharray": dash}));
  return htmlElement("span", {}, sample, text);
}

/** An entry of a legend: a shape of 12 x 12 pixels, by default a square, and its name. */
export function swatchEntry(text, attributes, shape = "rect") {
  const size = shape === "rect" ? {width: 12, height: 12} : {cx: 6, cy: 6, r: 4};
  const sample = svgElement("svg", {viewBox: "0 0 12 12", class: "swatch"}, svgElement(shape, {...size, ...attributes}));
  return htmlElement("span", {}, sample, text);
}

/** A button with a text or a list of nodes that calls `act` when it is clicked. */
export function buttonElement(content, act, attributes = {}) {
  const button = htmlElement("button", {type: "button", ...attributes}, ...[content].flat());
  button.addEventListener("click", act);
  return button;
}

/** A labelled choice among [[value, text]] that calls `act` with the value when it changes. */
export function choiceElement(label, attributes, options, act, chosen = null) {
  const select = htmlElement("select", attributes, ...options.map(([value, text]) => htmlElement(
      "option", {value, selected: value === chosen}, text)));
  select.addEventListener("change", () => act(select.value));
  return htmlElement("label", {}, label, select);
}

/** Creates a table that a click on a heading sorts; each cell is [text or element, value to sort by]. */
export function tableElement(id, headings, rows) {
  const cell = ([text, value], name) => {
    const attributes = value === undefined ? {} : {class: "number", "data-value": value ?? ""};
    return htmlElement(name, attributes, text);
  };
  const head = htmlElement("tr", {}, ...headings.map(([text, isNumber]) => htmlElement(
      "th", isNumber ? {class: "number"} : {}, text)));
  const body = rows.map((cells) => htmlElement("tr", {}, ...cells.map((entry) => cell(entry, "td"))));
  const table = htmlElement("table", {id, class: "sortable"}, htmlElement("thead", {}, head),
                            htmlElement("tbody", {}, ...body));
  makeSortable(table);
  return htmlElement("div", {class: "scroll"}, table);
}

// Tables of class "sortable": a click on a heading sorts by its column, a second click reverses the order.
//
// A cell is compared by its data-value where it has one, otherwise by its text: as numbers where both are
// numbers, as text otherwise. Empty cells and dashes come last in both orders. Equal rows keep their order. The
// headings are the last row of thead; a cell that spans columns has no heading of its own to sort by.

function sortKey(cell) {
  const text = (cell?.dataset.value ?? cell?.textContent ?? "").trim();
  if (text === "" || text === "-" || text === "\u2013") return null;
  const number = Number(text);
  return Number.isNaN(number) ? text : number;
}

export function compareKeys(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", {numeric: true});
}

function sortRows(table, column, descending) {
  for (const body of table.tBodies) {
    const rows = [...body.rows].map((row) => ({row, key: sortKey(row.cells[column])}));
    rows.sort((a, b) => {
      if (a.key === null || b.key === null) return (a.key === null ? 1 : 0) - (b.key === null ? 1 : 0);
      return descending ? compareKeys(b.key, a.key) : compareKeys(a.key, b.key);
    });
    body.append(...rows.map(({row}) => row));
  }
}

/** Makes the headings buttons; does nothing to a table that has them. */
export function makeSortable(table) {
  if (table.dataset.sortable) return;
  table.dataset.sortable = "yes";
  const headings = [...(table.tHead?.rows[table.tHead.rows.length - 1]?.cells ?? [])];
  headings.forEach((heading, column) => {
    heading.append(buttonElement([...heading.childNodes], () => {
      const descending = heading.getAttribute("aria-sort") === "ascending";
      for (const other of headings) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sortRows(table, column, descending);
    }, {title: "sort by this column"}));
  });
}
