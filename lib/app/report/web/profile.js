// SPDX-License-Identifier: GPL-3.0-or-later

// True and estimated elevation, and the error, along a line that is dragged on a map or typed.

import {Axis, drawFrame} from "./chart.js";
import {lineListeners, pointing, setLine} from "./cursor.js";
import {htmlElement, legendEntry, svgElement} from "./elements.js";
import {formatNumber, lengthUnit, metresAs} from "./numbers.js";
import {report} from "./report_data.js";

const PROFILE = {heights: [230, 130], left: 64, right: 16, top: 12, gap: 26, bottom: 46};

/** The cells of a raster under a line, in order: [{from_m, to_m, index}], distances from its first end; the parts outside
 * the map are left out. Each cell counts as a whole: nothing is interpolated between bins. */
function cellsUnder(raster, {from, to}) {
  const dx = to.x_m - from.x_m, dy = to.y_m - from.y_m, length = Math.hypot(dx, dy);
  const cuts = [0, 1];
  const cut = (first, step, origin) => {
    if (step === 0) return;
    const ends = [(first - origin) / raster.cell_m, (first + step - origin) / raster.cell_m].sort((a, b) => a - b);
    for (let k = Math.ceil(ends[0]); k <= ends[1]; ++k) cuts.push((origin + k * raster.cell_m - first) / step);
  };
  cut(from.x_m, dx, raster.left_m);
  cut(from.y_m, dy, raster.bottom_m);
  cuts.sort((a, b) => a - b);
  const cells = [];
  for (let k = 0; k + 1 < cuts.length; ++k) {
    if (cuts[k + 1] - cuts[k] < 1e-12) continue;
    const middle = (cuts[k] + cuts[k + 1]) / 2;
    const index = raster.indexAt(from.x_m + middle * dx, from.y_m + middle * dy);
    if (index >= 0) cells.push({from_m: cuts[k] * length, to_m: cuts[k + 1] * length, index});
  }
  return cells;
}

/** The values under a line: [[distance, value]], NaN where a bin has none. */
function profileOf(raster, line) {
  return cellsUnder(raster, line).map(({from_m, to_m, index}) => [(from_m + to_m) / 2, raster.value(index)]);
}

/** The pieces of a curve between gaps. */
function piecesOf(points) {
  const pieces = [[]];
  for (const point of points) {
    if (Number.isNaN(point[1])) pieces.push([]);
    else pieces[pieces.length - 1].push(point);
  }
  return pieces.filter((piece) => piece.length > 0);
}

/** The ends of an axis that holds all values, with some room. */
export function endsOf(values, minimum) {
  const known = values.filter((value) => !Number.isNaN(value));
  if (known.length === 0) return [-minimum, minimum];
  const low = Math.min(...known), high = Math.max(...known);
  const room = Math.max(0.06 * (high - low), (minimum - (high - low)) / 2, 1e-4);
  return [low - room, high + room];
}

export class ProfileView {
  elevations; error;

  /** `elevations`: [[raster, colour, width]]; `error`: the raster of e_z, or null. */
  constructor(elevations, error) {
    Object.assign(this, {elevations, error});
    this.svg = svgElement("svg", {role: "img", "aria-label": "Elevations and error along the line"});
    this.note = htmlElement("p", {class: "note"});
    this.fields = ["from x", "from y", "to x", "to y"].map((name) => htmlElement("input", {
      type: "number", step: "any", "aria-label": `${name} (m)`, size: "7"}));
    for (const field of this.fields) field.addEventListener("change", () => this.readFields());
    const legend = htmlElement("div", {class: "legend"}, ...elevations.map(([raster, color, width]) =>
        legendEntry(raster.layer.title + " " + raster.layer.name, color, "", width)));
    if (error) legend.append(legendEntry("error e_z = true \u2212 estimated", "var(--ink)", ""));
    const [x0, y0, x1, y1] = this.fields;
    this.figure = htmlElement("figure", {class: "panel"}, this.svg, legend);
    this.element = htmlElement("div", {id: "profile"}, htmlElement("h3", {}, "Profile"),
        htmlElement("div", {class: "controls screen-only"}, "Drag a line on a map, or type its ends (m): from", x0, y0, "to", x1, y1),
        this.figure, this.note);
    lineListeners.push((line) => this.show(line));
    new ResizeObserver(() => { if (pointing.line) this.show(pointing.line); }).observe(this.figure);
  }

  readFields() {
    const [x0, y0, x1, y1] = this.fields.map((field) => field.valueAsNumber);
    if ([x0, y0, x1, y1].some(Number.isNaN) || (x0 === x1 && y0 === y1)) return;
    setLine({from: {x_m: x0, y_m: y0}, to: {x_m: x1, y_m: y1}});
  }

  show(line) {
    const places = [line.from.x_m, line.from.y_m, line.to.x_m, line.to.y_m].map((value) => Number(value.toFixed(3)));
    this.fields.forEach((field, k) => { field.value = places[k]; });
    const length = Math.hypot(line.to.x_m - line.from.x_m, line.to.y_m - line.from.y_m);
    const curves = this.elevations.map(([raster, color, width]) => ({points: profileOf(raster, line), color, width}));
    const errors = this.error ? profileOf(this.error, line) : [];
    this.draw(length, curves, errors);
    this.note.textContent = this.noteOf(length, errors);
  }

  noteOf(length, errors) {
    const known = errors.map(([, value]) => value).filter((value) => !Number.isNaN(value));
    const {factor} = report.grid;
    const blocks = factor === 1 ? "" : ` Blocks of ${factor} x ${factor} bins: of elevations the mean, of errors the largest.`;
    if (known.length === 0) return `${formatNumber(length, 0.01)} m.${blocks}`;
    const maximum = known.reduce((a, b) => Math.abs(b) > Math.abs(a) ? b : a);
    const [unit, scale] = lengthUnit(Math.abs(maximum));
    const rms = Math.sqrt(known.reduce((sum, value) => sum + value * value, 0) / known.length);
    return `${formatNumber(length, 0.01)} m; error: largest ${metresAs(maximum, unit, scale)}, root mean square ${metresAs(rms, unit, scale)}.` +
        blocks;
  }

  draw(length, curves, errors) {
    const {heights, left, right, top, gap, bottom} = PROFILE;
    const width = Math.max(300, Math.round(this.figure.clientWidth));
    const hasErrors = this.error !== null;
    const height = top + heights[0] + (hasErrors ? gap + heights[1] : 0) + bottom;
    this.svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    this.svg.replaceChildren();
    const x = (label) => new Axis({low: 0, high: length, label, spacing: 70}, [left, width - right]);
    const label = "distance along the line (m)", xUpper = x(hasErrors ? "" : label);
    const upper = endsOf(curves.flatMap(({points}) => points.map(([, value]) => value)), 0.01);
    const y = new Axis({low: upper[0], high: upper[1], label: "elevation (m)", spacing: 32}, [top + heights[0], top]);
    drawFrame(this.svg, xUpper, y);
    for (const {points, color, width: thickness} of curves) this.curve(xUpper, y, points, {color, width: thickness});
    if (hasErrors) this.drawErrors(x(label), errors, [top + heights[0] + gap, top + heights[0] + gap + heights[1]]);
  }

  drawErrors(x, errors, [top, bottom]) {
    const limit = this.error.layer.limit ?? 0;
    const maximum = Math.max(1.15 * limit, 1e-3, ...errors.map(([, value]) => Number.isNaN(value) ? 0 : 1.06 * Math.abs(value)));
    const [unit, factor] = lengthUnit(maximum);
    const y = new Axis({low: -maximum * factor, high: maximum * factor, label: `error (${unit})`, spacing: 32}, [bottom, top]);
    drawFrame(this.svg, x, y);
    const scaled = errors.map(([at, value]) => [at, value * factor]);
    for (const value of limit > 0 ? [limit, -limit] : []) {
      this.svg.append(svgElement("line", {class: "limit", x1: x.pixels[0], x2: x.pixels[1], y1: y.at(value * factor),
                                          y2: y.at(value * factor), stroke: "var(--purple)", "stroke-dasharray": "7 3", "stroke-width": 1.5}));
    }
    this.curve(x, y, scaled, {color: "var(--ink)", width: 1.2});
    if (limit > 0) {
      this.svg.append(svgElement("text", {x: x.pixels[1] - 4, y: y.at(limit * factor) + 13, "text-anchor": "end", class: "haloed"},
                                 `limit of the relative error \u00b1${metresAs(limit, ...lengthUnit(limit))}`));
    }
  }

  /** A frame with ticks; the distance is labelled on the lowest one. */
  curve(x, y, points, {color, width}) {
    for (const piece of piecesOf(points)) {
      const at = (point) => `${x.at(point[0]).toFixed(2)},${y.at(point[1]).toFixed(2)}`;
      this.svg.append(piece.length === 1 ?
          svgElement("circle", {cx: x.at(piece[0][0]), cy: y.at(piece[0][1]), r: width, fill: color}) :
          svgElement("polyline", {points: piece.map(at).join(" "), fill: "none", stroke: color, "stroke-width": width}));
    }
  }
}

/** From west to east through a place or, without one, the middle of the map. */
export function firstLine({x_m, y_m, resolution_m, rows, cols}, place) {
  const y = place ? place.y_m : y_m + (rows - 1) / 2 * resolution_m;
  return {from: {x_m, y_m: y}, to: {x_m: x_m + (cols - 1) * resolution_m, y_m: y}};
}
