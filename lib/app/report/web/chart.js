// SPDX-License-Identifier: GPL-3.0-or-later

// Diagrams: curves, bars and points between two axes, linear or logarithmic.

import {htmlElement, legendEntry, LINE, svgElement, swatchEntry, TEXT_COLOR} from "./elements.js";
import {ticks} from "./numbers.js";

const MAX_WORDS = 12;  // next to an axis
const CHART = {width: 430, height: 300, left: 58, right: 16, top: 14, bottom: 46};
/** The size of a chart whose axes are equally long. */
export const SQUARE = {height: CHART.width - CHART.left - CHART.right + CHART.top + CHART.bottom};

export class Axis {
  low; high; label; log; whole; spacing; words; pixels;

  /** `pixels`: where low and high lie; `spacing`: the least distance of ticks; `words`: those at 0, 1, 2, ..., instead of numbers. */
  constructor({low, high, label = "", log = false, whole = false, spacing = 45, words = null}, pixels) {
    Object.assign(this, {low, high, label, log, whole, spacing, words, pixels});
  }

  at(value) {
    const place = (v) => this.log ? Math.log(v) : v;
    const share = (place(value) - place(this.low)) / (place(this.high) - place(this.low));
    return this.pixels[0] + share * (this.pixels[1] - this.pixels[0]);
  }

  ticks() {
    if (this.words) return this.words.slice(0, MAX_WORDS).map((text, value) => ({value, text}));
    if (!this.log) {
      const max_count = Math.max(2, Math.abs(this.pixels[1] - this.pixels[0]) / this.spacing);
      return ticks(this.low, this.high, this.whole ? Math.min(max_count, this.high - this.low) : max_count);
    }
    const digits = this.high / this.low < 30 ? [1, 2, 3, 5] : [1];
    const result = [];
    for (let power = Math.floor(Math.log10(this.low)); power <= Math.log10(this.high); ++power) {
      for (const digit of digits) {
        const value = digit * 10 ** power;
        if (value >= this.low * 0.999 && value <= this.high * 1.001) {
          result.push({value, text: String(Number(value.toPrecision(3))).replaceAll("-", "\u2212")});
        }
      }
    }
    return result;
  }
}

/** An axis about all values that are not null. */
export function axisOf(values, label) {
  const known = values.filter((value) => value !== null);
  const [low, high] = known.length > 0 ? [Math.min(...known), Math.max(...known)] : [0, 1];
  const room = 0.04 * (high - low) || Math.abs(high) / 10 || 1;
  return {low: low - room, high: high + room, label};
}

/** Draws the grid, the ticks and the labels of two axes; numbers along x only if that axis has a label. */
export function drawFrame(svg, x, y) {
  const [left, right] = x.pixels, [bottom, top] = y.pixels;
  for (const {value, text} of x.ticks()) {
    const at = x.at(value);
    svg.append(svgElement("line", {x1: at, x2: at, y1: top, y2: bottom, class: "grid"}));
    if (x.label) svg.append(svgElement("text", {x: at, y: bottom + 17, "text-anchor": "middle"}, text));
  }
  for (const {value, text} of y.ticks()) {
    const at = y.at(value);
    svg.append(svgElement("line", {x1: left, x2: right, y1: at, y2: at, class: "grid"}),
               svgElement("text", {x: left - 6, y: at + 4, "text-anchor": "end"}, text));
  }
  svg.append(svgElement("rect", {x: left, y: top, width: right - left, height: bottom - top, fill: "none", stroke: TEXT_COLOR}),
             svgElement("text", {x: (left + right) / 2, y: bottom + 38, "text-anchor": "middle"}, x.label),
             svgElement("text", {transform: `translate(13 ${(top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle"}, y.label));
}

export class Chart {
  constructor(title, xAxis, yAxis, size = {}) {
    const {width, height, left, right, top, bottom} = {...CHART, ...size};
    this.x = new Axis(xAxis, [left, width - right]);
    this.y = new Axis(yAxis, [height - bottom, top]);
    this.svg = svgElement("svg", {viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title});
    this.legend = htmlElement("div", {class: "legend"});
    this.element = htmlElement("figure", {class: "panel chart"}, htmlElement("figcaption", {}, title), this.svg,
                               this.legend);
    drawFrame(this.svg, this.x, this.y);
  }

  inside(value, axis) { return Math.min(axis.high, Math.max(axis.low, value)); }

  curve(points, {color, dash = "", text = "", width = 2}) {
    const path = points.map(([x, y]) => `${this.x.at(this.inside(x, this.x)).toFixed(2)},` +
                                        this.y.at(this.inside(y, this.y)).toFixed(2));
    this.svg.append(svgElement("polyline", {points: path.join(" "), fill: "none", stroke: color,
                                            "stroke-width": width, "stroke-dasharray": dash}));
    if (text) this.entry(text, color, dash);
    return this;
  }

  bars(bars, color) {
    for (const {low, high, count} of bars) {
      const x = this.x.at(low), top = this.y.at(this.inside(count, this.y));
      this.svg.append(svgElement("rect", {x, y: top, width: Math.max(1, this.x.at(high) - x - 0.5),
                                          height: this.y.pixels[0] - top, fill: color}));
    }
    return this;
  }

  /** A legend entry of an area. */
  area(text, color) {
    this.legend.append(swatchEntry(text, {fill: color}));
    return this;
  }

  dots(points, color, text) {
    for (const [x, y, radius] of points) {
      this.svg.append(svgElement("circle", {cx: this.x.at(x), cy: this.y.at(y), r: radius, fill: color,
                                            "fill-opacity": 0.75}));
    }
    this.legend.append(swatchEntry(text, {fill: color}, "circle"));
    return this;
  }

  /** [[x, y, text]] above points, or below those near the upper border, except near a labelled one. */
  labels(points) {
    const labelled = [];
    for (const [x, y, text] of points) {
      const place = [this.x.at(x), this.y.at(y)];
      if (labelled.some(([px, py, length]) => Math.abs(px - place[0]) < 9 * Math.max(length, text.length) && Math.abs(py - place[1]) < 18)) continue;
      labelled.push([...place, text.length]);
      const isLeft = place[0] > this.x.pixels[1] - 60, isLow = place[1] - 19 < this.y.pixels[1];
      this.svg.append(svgElement("text", {x: place[0] + (isLeft ? -8 : 8), y: place[1] + (isLow ? 19 : -7),
                                          "text-anchor": isLeft ? "end" : "start", class: "haloed"}, text));
    }
    return this;
  }

  /** A vertical line at x; outside the axis only its legend entry is shown. */
  limit(x, text, color = LINE.vermilion) {
    const beyond = x > this.x.high || x < this.x.low;
    if (!beyond) this.curve([[x, this.y.low], [x, this.y.high]], {color, dash: "7 3"});
    this.entry(text + (beyond ? " (beyond this diagram)" : ""), color, "7 3");
    return this;
  }

  entry(text, color, dash) { this.legend.append(legendEntry(text, color, dash)); }
}
