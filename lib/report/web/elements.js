// SPDX-License-Identifier: GPL-3.0-or-later

// Elements of the page.

import {INK} from "./palette.js";
import {makeSortable} from "./table.js";

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
