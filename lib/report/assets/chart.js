// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// Diagrams: curves, bars and points between two axes, linear or logarithmic.

// The colours of lines, which differ in light and dark mode (report.css).
const LINE = {blue: "var(--blue)", sky: "var(--sky)", vermilion: "var(--vermilion)", purple: "var(--purple)"};
const CHART = {width: 430, height: 300, left: 58, right: 16, top: 14, bottom: 46};

class Axis {
  /** `pixels`: where low and high lie. */
  constructor({low, high, label, log = false, whole = false}, pixels) {
    Object.assign(this, {low, high, label, log, whole, pixels});
  }

  at(value) {
    const place = (v) => this.log ? Math.log(v) : v;
    const share = (place(value) - place(this.low)) / (place(this.high) - place(this.low));
    return this.pixels[0] + share * (this.pixels[1] - this.pixels[0]);
  }

  ticks() {
    if (!this.log) {
      const most = Math.abs(this.pixels[1] - this.pixels[0]) / 45;
      return ticks(this.low, this.high, this.whole ? Math.min(most, this.high - this.low) : most);
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

class Chart {
  constructor(title, xAxis, yAxis) {
    const {width, height, left, right, top, bottom} = CHART;
    this.x = new Axis(xAxis, [left, width - right]);
    this.y = new Axis(yAxis, [height - bottom, top]);
    this.svg = svgElement("svg", {viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": title});
    this.legend = htmlElement("div", {class: "legend"});
    this.element = htmlElement("figure", {class: "panel chart"}, htmlElement("figcaption", {}, title), this.svg,
                               this.legend);
    this.drawAxes();
  }

  drawAxes() {
    const {width, height, left, right, top, bottom} = CHART;
    for (const {value, text} of this.x.ticks()) {
      const x = this.x.at(value);
      this.svg.append(svgElement("line", {x1: x, x2: x, y1: top, y2: height - bottom, class: "grid"}),
                      svgElement("text", {x, y: height - bottom + 17, "text-anchor": "middle"}, text));
    }
    for (const {value, text} of this.y.ticks()) {
      const y = this.y.at(value);
      this.svg.append(svgElement("line", {x1: left, x2: width - right, y1: y, y2: y, class: "grid"}),
                      svgElement("text", {x: left - 6, y: y + 4, "text-anchor": "end"}, text));
    }
    this.svg.append(
        svgElement("rect", {x: left, y: top, width: width - left - right, height: height - top - bottom,
                            fill: "none", stroke: TEXT_COLOR}),
        svgElement("text", {x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle"}, this.x.label),
        svgElement("text", {transform: `translate(13 ${(top + height - bottom) / 2}) rotate(-90)`,
                            "text-anchor": "middle"}, this.y.label));
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
    const sample = svgElement("svg", {viewBox: "0 0 12 12", class: "swatch"}, svgElement("rect", {width: 12, height: 12, fill: color}));
    this.legend.append(htmlElement("span", {}, sample, text));
    return this;
  }

  dots(points, color, text) {
    for (const [x, y, radius] of points) {
      this.svg.append(svgElement("circle", {cx: this.x.at(x), cy: this.y.at(y), r: radius, fill: color,
                                            "fill-opacity": 0.75}));
    }
    const sample = svgElement("svg", {viewBox: "0 0 12 12", class: "swatch"},
                              svgElement("circle", {cx: 6, cy: 6, r: 4, fill: color}));
    this.legend.append(htmlElement("span", {}, sample, text));
    return this;
  }

  /** [[x, y, text]] beside points, except beside those that are near to one with a label. */
  labels(points) {
    const labelled = [];
    for (const [x, y, text] of points) {
      const place = [this.x.at(x), this.y.at(y)];
      if (labelled.some(([px, py]) => Math.abs(px - place[0]) < 9 * text.length && Math.abs(py - place[1]) < 18)) continue;
      labelled.push(place);
      const isLeft = place[0] > this.x.pixels[1] - 60;
      this.svg.append(svgElement("text", {x: place[0] + (isLeft ? -8 : 8), y: Math.max(this.y.pixels[1] + 14, place[1] - 7),
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

/** A line and its name. */
function legendEntry(text, color, dash, width = 2.5) {
  const sample = svgElement("svg", {viewBox: "0 0 30 10", class: "sample"}, svgElement(
      "line", {x1: 1, x2: 29, y1: 5, y2: 5, stroke: color, "stroke-width": width, "stroke-dasharray": dash}));
  return htmlElement("span", {}, sample, text);
}
