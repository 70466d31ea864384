// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// Elements of the page.

function svgElement(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

function htmlElement(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

/** Creates a table; each cell is [text, value to sort by]. */
function tableElement(id, headings, rows) {
  const cell = ([text, value], name) => {
    const attributes = value === undefined ? {} : {class: "number", "data-value": value ?? ""};
    return htmlElement(name, attributes, text);
  };
  const head = htmlElement("tr", {}, ...headings.map(([text, isNumber]) => htmlElement(
      "th", isNumber ? {class: "number"} : {}, text)));
  const body = rows.map((cells) => htmlElement("tr", {}, ...cells.map((entry) => cell(entry, "td"))));
  const table = htmlElement("table", {id, class: "sortable"}, htmlElement("thead", {}, head),
                            htmlElement("tbody", {}, ...body));
  return htmlElement("div", {class: "scroll"}, table);
}
