// SPDX-License-Identifier: GPL-3.0-or-later

// The legend of a map's colours: quantity, unit, limit and ends.

import {htmlElement, svgElement, swatchEntry, TEXT_COLOR} from "./elements.js";
import {lengthUnit, metresAs, ticks} from "./numbers.js";
import {report} from "./report_data.js";
import {cssColor, scaleOf} from "./scales.js";

/** What the colours of a layer show; for an error its sign. */
function quantityOf({name, style, quantity}) {
  if (quantity) return quantity;
  if (style === "elevation") return "elevation";
  if (style === "count") return "returns";
  if (name.startsWith("abs_")) return "mean of true \u2212 estimated";
  if (name.startsWith("rel_")) return report.quantile ? `|e \u2212 mean|, ${Number((100 * report.quantile).toPrecision(4))} % quantile` : "|e \u2212 mean|, quantile";
  return style === "signed" ? "true \u2212 estimated" : "distance, true to estimated";
}

/** "limit ±5 cm"; empty for a layer without one. */
export function limitText({name, style, unit, limit}) {
  if (limit === null) return "";
  const sign = style === "signed" ? "\u00b1" : "";
  const of = name.startsWith("e_") ? ` of rel_${name.slice(2)}` : name.startsWith("abs_") ? " of the horizontal error" : "";
  return `\u25b8 limit ${sign}${unit === "m" ? metresAs(limit, ...lengthUnit(limit)) : `${limit} ${unit}`}${of}`;
}

/** The limits on a scale, in the unit of the layer. */
function limitsOn({low, high, limit}, style) {
  if (limit === null) return [];
  return (style === "signed" ? [limit, -limit] : [limit]).filter((value) => value > low && value < high);
}

function colorGradient(id, colors, direction) {
  const stops = Array.from({length: 33}, (_, k) => svgElement(
      "stop", {offset: k / 32, "stop-color": cssColor(colors[Math.round(255 * k / 32)])}));
  return svgElement("defs", {}, svgElement("linearGradient", {id, ...direction}, ...stops));
}

let gradientCount = 0;

/** A colour bar along a map: ticks and the quantity on its right, the limits on its left; a pointed end where values lie
 * beyond. */
export function verticalColorBar({layer}, scale, {x, top, height}) {
  const {colors, low, high, unit, factor, clipped} = scale;
  const id = `gradient-${++gradientCount}`, width = 12, point = 8;
  const y = (value) => top + height * (1 - (value - low) / (high - low));
  const outline = [[x, top], ...(clipped[1] ? [[x + width / 2, top - point]] : []), [x + width, top],
                   [x + width, top + height], ...(clipped[0] ? [[x + width / 2, top + height + point]] : []), [x, top + height]];
  const parts = [colorGradient(id, colors, {x1: 0, x2: 0, y1: 1, y2: 0}),
                 svgElement("polygon", {points: outline.join(" "), fill: `url(#${id})`, stroke: TEXT_COLOR})];
  const few = layer.style === "count" ? Math.min(height / 35, high) : height / 35;
  let longest = 0;
  for (const {value, text} of ticks(low * factor, high * factor, Math.max(2, few))) {
    const at = y(value / factor);
    longest = Math.max(longest, text.length);
    parts.push(svgElement("line", {x1: x + width, x2: x + width + 3, y1: at, y2: at, stroke: TEXT_COLOR}),
               svgElement("text", {x: x + width + 6, y: at + 4}, text));
  }
  for (const limit of limitsOn(scale, layer.style)) {
    const at = y(limit);
    const corners = `${x - 9},${at - 5} ${x - 1},${at} ${x - 9},${at + 5}`;
    parts.push(svgElement("polygon", {class: "limit", points: corners, fill: TEXT_COLOR}),
               svgElement("line", {x1: x, x2: x + width, y1: at, y2: at, stroke: "#ffffff", "stroke-width": 3}),
               svgElement("line", {x1: x, x2: x + width, y1: at, y2: at, stroke: "#000000", "stroke-width": 1.4}));
  }
  const label = quantityOf(layer) + (unit ? ` (${unit})` : "");
  const place = `translate(${x + Math.max(56, 33 + 7 * longest)} ${top + height / 2}) rotate(-90)`;
  parts.push(svgElement("text", {transform: place, "text-anchor": "middle"}, label));
  return parts;
}

/** The legend of the 3-D view's colours, which ignores the shading of the surface. */
export function horizontalColorBar(raster) {
  const {layer} = raster;
  const scale = scaleOf(raster);
  const {colors, low, high, unit, factor} = scale;
  const id = "terrain-gradient", left = 20, width = 380;
  const x = (value) => left + width * (value - low) / (high - low);
  const svg = svgElement("svg", {viewBox: `0 0 ${width + 2 * left} 34`}, colorGradient(id, colors, {x1: 0, x2: 1}),
                         svgElement("rect", {x: left, y: 2, width, height: 12, fill: `url(#${id})`, stroke: TEXT_COLOR}));
  for (const {value, text} of ticks(low * factor, high * factor, Math.max(2, layer.style === "count" ? Math.min(6, high) : 6))) {
    const at = x(value / factor);
    svg.append(svgElement("line", {x1: at, x2: at, y1: 14, y2: 17, stroke: TEXT_COLOR}),
               svgElement("text", {x: at, y: 29, "text-anchor": "middle"}, text));
  }
  for (const limit of limitsOn(scale, layer.style)) {
    svg.append(svgElement("line", {class: "limit", x1: x(limit), x2: x(limit), y1: 0, y2: 16, stroke: "#ffffff", "stroke-width": 3}),
               svgElement("line", {x1: x(limit), x2: x(limit), y1: 0, y2: 16, stroke: "#000000", "stroke-width": 1.4}));
  }
  const notes = [clippingText(scale), limitText(layer).replace("\u25b8 ", "line: "), layer.style === "elevation" ? "" : "grey: no value"];
  const of = ["signed", "magnitude"].includes(layer.style) ? `: ${quantityOf(layer)}` : "";
  return htmlElement("div", {class: "legend"}, htmlElement("span", {}, layer.title + of + (unit ? ` (${unit})` : "")), svg,
                     htmlElement("span", {}, notes.filter((text) => text !== "").join("; ")));
}

/** Where the colours end, if values lie beyond; empty otherwise. */
export function clippingText({low, high, clipped, unit, factor}) {
  if (!clipped[0] && !clipped[1]) return "";
  const end = (value) => metresAs(value, unit, factor).trimEnd();
  if (low === -high) return `colours end at \u00b1${end(high)}`;
  if (!clipped[1]) return `colours begin at ${end(low)}`;
  return clipped[0] ? `colours from ${end(low)} to ${end(high)}` : `colours end at ${end(high)}`;
}

/** The missed requirements and how many bins or footprints miss each. */
export function failLegend() {
  const entries = report.fail_flags.map(({bits, text, color, requirement}) => {
    const judged = report.metrics.requirements[requirement].pass !== null;
    const count = judged ? report.fail_count[Math.log2(bits)] : "not judged";
    return swatchEntry(`${text}: ${count}`, {fill: color});
  });
  return htmlElement("div", {class: "legend flags"}, ...entries);
}
