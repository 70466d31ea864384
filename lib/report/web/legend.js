// SPDX-License-Identifier: GPL-3.0-or-later

// Legends: entries with a sample and its text.

import {htmlElement, svgElement} from "./elements.js";

/** A line and its name. */
export function legendEntry(text, color, dash, width = 2.5) {
  const sample = svgElement("svg", {viewBox: "0 0 30 10", class: "sample"}, svgElement(
      "line", {x1: 1, x2: 29, y1: 5, y2: 5, stroke: color, "stroke-width": width, "stroke-dasharray": dash}));
  return htmlElement("span", {}, sample, text);
}

/** A shape of 12 x 12 pixels, by default a square, and its name. */
export function swatchEntry(text, attributes, shape = "rect") {
  const size = shape === "rect" ? {width: 12, height: 12} : {cx: 6, cy: 6, r: 4};
  const sample = svgElement("svg", {viewBox: "0 0 12 12", class: "swatch"}, svgElement(shape, {...size, ...attributes}));
  return htmlElement("span", {}, sample, text);
}
