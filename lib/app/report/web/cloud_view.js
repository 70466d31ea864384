// SPDX-License-Identifier: GPL-3.0-or-later

// The points of a cloud in three dimensions: colours, a box outside of which they are hidden, and some of them lit.

import {OrbitView, pixelsAtUnitDistance} from "./orbit_view.js";
import {unpackCodes} from "./rasters.js";
import {report} from "./report_data.js";
import {colorOf, flagColor, parseColor, scaleOf} from "./scales.js";

// The columns of a cloud unpacked: 32-bit codes, value = offset + code * step.

const NO_WIDE_CODE = 0xffffffff;

/** The halves of the codes, packed apart; null where all are 0. */
async function halfOf(name) {
  const element = document.getElementById("layer-" + name);
  return element === null ? null : unpackCodes(element.textContent, report.count);
}

/** The values of all points, NaN where one has none; scales.js takes it for a raster. */
async function readColumn(layer) {
  const [low, high] = await Promise.all(["low", "high"].map((half) => halfOf(`${layer.name}-${half}`)));
  const codes = Uint32Array.from(low);
  if (high !== null) high.forEach((part, i) => { codes[i] += 65536 * part; });
  return {layer, codes, value: (index) => codes[index] === NO_WIDE_CODE ? NaN : layer.offset + codes[index] * layer.step};
}

const unpacked = new Map();

/** Unpacks all columns. */
export async function readColumns() {
  for (const layer of report.layers) unpacked.set(layer.name, await readColumn(layer));
}

/** A column of the report, behind readColumns(); null if it has none of this name. */
export function columnOf(name) {
  return unpacked.get(name) ?? null;
}

/** The value between the lowest and the highest below which this share of the values lies, from a sample. */
function quantileOfColumn(column, share) {
  const stride = Math.max(1, Math.floor(column.codes.length / 20000)), sample = [];
  for (let i = 0; i < column.codes.length; i += stride) sample.push(column.value(i));
  return Float64Array.from(sample).sort()[Math.round(share * (sample.length - 1))];
}

/** The height by which each point hides others and is hidden: the median of its cell of the ground, whose points differ by their errors, or its own
 * height if that is far from it. */
function surfaceHeights(places, spacing) {
  const count = places.length / 3, cells = new Map();
  const cellOf = (value) => Math.floor(value / (CELL * spacing));
  for (let i = 0; i < count; ++i) {
    const key = 2 ** 26 * cellOf(places[3 * i]) + cellOf(places[3 * i + 1]);
    if (cells.has(key)) cells.get(key).push(i); else cells.set(key, [i]);
  }
  const heights = new Float32Array(count);
  for (const members of cells.values()) {
    const median = Float64Array.from(members, (i) => places[3 * i + 2]).sort()[members.length >> 1];
    const quartile = Float64Array.from(members, (i) => Math.abs(places[3 * i + 2] - median)).sort()[members.length >> 2];
    const merged = Math.max(MERGED * spacing, SPREAD * quartile);
    for (const i of members) {
      const own = places[3 * i + 2];
      heights[i] = Math.abs(own - median) <= merged ? median : own;
    }
  }
  return heights;
}

// The view

const SIZE_px = {minimum: 1.5, maximum: 30};
const REACH_px = 8;     // a click chooses a point at most so far away
const CLICK_px = 4;     // a longer movement of the pointer is a drag
const OUTER = 0.005;    // share of the points beyond either end of an axis that the first view may leave out
const HULL_POINTS = 2000;
const FROM_ABOVE = {azimuth: 0, tilt: Math.PI / 2};
const FLATTEST = 0.1;   // sine of the angle between a line of sight and the ground
const CELL = 8;         // times the distance between points: the edge of a cell of the surface
const MERGED = 5;       // times the distance between points: those no farther from the surface of their cell lie on it,
const SPREAD = 17;      // and those within so many times the lower quartile of these distances, 5.4 sigma of a normal error

const VERTEX_SHADER = `#version 300 es
in vec3 place, color;
in float surface;        // the height that hides and is hidden
uniform mat4 projection;
uniform vec3 low, high;  // of the box
uniform vec3 eye;
uniform float pointScale, minimum, grown, loose;
uniform vec2 depth;
out vec3 shade;
void main() {
  bool inside = all(greaterThanEqual(place, low)) && all(lessThanEqual(place, high));
  gl_Position = inside ? projection * vec4(place, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
  // Near points hide far ones by where the line of sight meets the surface, not by their own height: the highest of those that cover each other
  // would have the largest errors.
  uint mixed = uint(gl_VertexID) * 2654435761u;
  mixed = (mixed ^ (mixed >> 15)) * 2246822519u;
  vec3 ray = place - eye;
  float down = min(ray.z, -${FLATTEST.toFixed(2)} * length(ray));
  float away = gl_Position.w * (1.0 + (surface - place.z) / down);
  float nearer = max(0.5 * away, away - loose * float(mixed >> 16) / 65536.0);
  if (inside) gl_Position.z = gl_Position.w * (depth[0] + depth[1] / nearer);
  gl_PointSize = clamp(pointScale / gl_Position.w, minimum, ${SIZE_px.maximum.toFixed(1)}) + grown;
  shade = color;
}`;

const FRAGMENT_SHADER = `#version 300 es
precision mediump float;
in vec3 shade;
uniform bool lit;
uniform vec3 light;
out vec4 result;
void main() {
  if (!lit) {
    result = vec4(shade, 1.0);
    return;
  }
  float from = 2.0 * length(gl_PointCoord - 0.5);
  if (from > 1.0) discard;
  result = vec4(from > 0.7 ? vec3(0.0) : light, 1.0);
}`;

export class CloudView extends OrbitView {
  lit = [];
  chosen = -1;
  dotScale = 1;
  waiting = null;  // for the next frame
  /** @type {(index: number) => void} */
  onClick = () => {};

  /** Throws if WebGL 2 is missing. */
  constructor(columns) {
    super("points", "The points in three dimensions. Arrow keys turn them, plus and minus zoom.", VERTEX_SHADER, FRAGMENT_SHADER,
          {shortest: 0.002, antialias: false, first: FROM_ABOVE});  // squares look the same without, and are drawn in a third of the time
    this.columns = columns;
    this.count = columns[0].codes.length;
    this.ends = columns.map((column) => [quantileOfColumn(column, OUTER), quantileOfColumn(column, 1 - OUTER)]);
    this.middle = this.ends.map(([low, high]) => (low + high) / 2);
    this.places = new Float32Array(3 * this.count);
    columns.forEach((column, axis) => {
      for (let i = 0; i < this.count; ++i) this.places[3 * i + axis] = column.value(i) - this.middle[axis];
    });
    this.upload("place", 3, this.places);
    this.indices = this.gl.createBuffer();
    const [width, depth] = this.ends.map(([low, high]) => high - low);
    this.spacing = Math.sqrt(Math.max(width * depth, 1e-12) / this.count);
    this.upload("surface", 1, surfaceHeights(this.places, this.spacing));
    this.openBox();
    this.listen();
    this.listenForClicks();
  }

  /** Some of the points in the box that lie between the ends of all axes. */
  hullPoints() {
    const half = this.ends.map(([low, high]) => (high - low) / 2), inside = [];
    for (let i = 0; i < this.count; ++i) if (this.isInside(i)) inside.push(i);
    const stride = Math.max(1, Math.floor(inside.length / HULL_POINTS));
    const some = inside.filter((_, k) => k % stride === 0).map((i) => this.placeOf(i));
    const points = some.filter((place) => place.every((value, axis) => Math.abs(value) <= half[axis]));
    return [points, some, [[0, 0, 0]]].find((each) => each.length > 0);
  }

  /** Relative to the middle. */
  placeOf(index) {
    return [...this.places.subarray(3 * index, 3 * index + 3)];
  }

  /** Shows the points between the ends of each axis, [[low, high], ...] in the coordinates of the file; they fill the canvas. */
  cut(ends) {
    this.box = ends;
    this.low = ends.map(([low], axis) => low - this.middle[axis]);
    this.high = ends.map(([, high], axis) => high - this.middle[axis]);
    this.hull = this.hullPoints();
    Object.assign(this.view, {zoom: 1, target: [0, 0, 0]});
  }

  openBox() {
    this.cut(this.columns.map(({layer}) => [layer.low - layer.step, layer.high + layer.step]));
  }

  isInside(index) {
    for (let axis = 0; axis < 3; ++axis) {
      const value = this.places[3 * index + axis];
      if (value < this.low[axis] || value > this.high[axis]) return false;
    }
    return true;
  }

  countInside() {
    let inside = 0;
    for (let i = 0; i < this.count; ++i) inside += this.isInside(i) ? 1 : 0;
    return inside;
  }

  /** The values of a column in the box: what a scale of colours is for. */
  inBox(column) {
    const codes = column.codes.filter((_, i) => this.isInside(i));
    const value = (index) => codes[index] === NO_WIDE_CODE ? NaN : column.layer.offset + codes[index] * column.layer.step;
    let low = Infinity, high = -Infinity;
    for (let i = 0; i < codes.length; ++i) {
      if (value(i) < low) low = value(i);
      if (value(i) > high) high = value(i);
    }
    return low > high ? column : {layer: {...column.layer, low, high}, codes, value};
  }

  /** Colours the points by a column, with the scale of those in the box. */
  show(column) {
    const colors = new Uint8Array(3 * this.count);
    const {layer, codes} = column;
    const scale = layer.flags ? null : scaleOf(this.inBox(column));
    const known = new Map();
    for (let i = 0; i < this.count; ++i) {
      let color = scale ? colorOf(scale, column.value(i)) : known.get(codes[i]);
      if (!color) {
        color = parseColor(flagColor(layer, column.value(i)) ?? "#8c8c8c");
        known.set(codes[i], color);
      }
      colors[3 * i] = color[0];
      colors[3 * i + 1] = color[1];
      colors[3 * i + 2] = color[2];
    }
    this.upload("color", 3, colors);
    this.canvas.dataset.color = layer.name;
    this.draw();
  }

  /** Lights these points, and `chosen` more. */
  light(chosen, lit) {
    Object.assign(this, {chosen, lit});
    this.draw();
  }

  /** Draws with the next frame, once for all changes before it. */
  draw() {
    this.waiting ??= requestAnimationFrame(() => {
      this.waiting = null;
      this.drawNow();
    });
  }

  drawNow() {
    const {gl} = this;
    const {width, height} = this.beginFrame();
    const at = (name) => gl.getUniformLocation(this.program, name);
    this.pixels = pixelsAtUnitDistance(width, height) * this.spacing * this.dotScale;
    gl.uniform3fv(at("low"), this.low);
    gl.uniform3fv(at("high"), this.high);
    gl.uniform3fv(at("eye"), this.eye);
    gl.uniform1f(at("pointScale"), this.pixels);
    gl.uniform1f(at("minimum"), SIZE_px.minimum);
    gl.uniform1f(at("loose"), 2 * this.spacing);
    gl.uniform2fv(at("depth"), this.depth);
    gl.uniform1f(at("grown"), 0);
    gl.uniform1i(at("lit"), 0);
    gl.drawArrays(gl.POINTS, 0, this.count);
    gl.uniform1i(at("lit"), 1);
    gl.disable(gl.DEPTH_TEST);
    this.drawLit(this.lit, 4, [1, 0, 1]);
    this.drawLit(this.chosen < 0 ? [] : [this.chosen], 11, [1, 1, 1]);
    gl.enable(gl.DEPTH_TEST);
  }

  drawLit(indices, grown, color) {
    if (indices.length === 0) return;
    const {gl} = this;
    gl.uniform1f(gl.getUniformLocation(this.program, "grown"), grown);
    gl.uniform3fv(gl.getUniformLocation(this.program, "light"), color);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, this.indices);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, Uint32Array.from(indices), gl.STREAM_DRAW);
    gl.drawElements(gl.POINTS, indices.length, gl.UNSIGNED_INT, 0);
  }

  /** The point at a place of the canvas, in pixels of the page: the foremost of those that cover it, else the nearest
   * within REACH_px; -1 if there is none. */
  pointAt(x_px, y_px) {
    const {clientWidth, clientHeight} = this.canvas, m = this.matrix;
    const ratio = this.canvas.width / clientWidth;
    let nearest = -1, minimum = REACH_px, foremost = -1, first = Infinity;
    for (let i = 0; i < this.count; ++i) {
      const x = this.places[3 * i], y = this.places[3 * i + 1], z = this.places[3 * i + 2];
      const w = m[3] * x + m[7] * y + m[11] * z + m[15];
      if (w <= 0) continue;
      const dx = (1 + (m[0] * x + m[4] * y + m[8] * z + m[12]) / w) / 2 * clientWidth - x_px;
      const dy = (1 - (m[1] * x + m[5] * y + m[9] * z + m[13]) / w) / 2 * clientHeight - y_px;
      const away = Math.max(Math.abs(dx), Math.abs(dy));
      if (away > REACH_px || !this.isInside(i)) continue;
      const half = Math.min(SIZE_px.maximum, Math.max(SIZE_px.minimum, this.pixels / w)) / 2 / ratio;
      if (away <= half && w < first) [foremost, first] = [i, w];
      if (away < minimum) [nearest, minimum] = [i, away];
    }
    return foremost >= 0 ? foremost : nearest;
  }

  listenForClicks() {
    let start = null;
    this.canvas.addEventListener("pointerdown", (event) => { start = event.button === 0 ? event : null; });
    this.canvas.addEventListener("pointerup", (event) => {
      if (!start || Math.hypot(event.clientX - start.clientX, event.clientY - start.clientY) > CLICK_px) return;
      const box = this.canvas.getBoundingClientRect();
      this.onClick(this.pointAt(event.clientX - box.left, event.clientY - box.top));
    });
  }

  /** Moves the middle of the view to a point. */
  centre(index) {
    this.view.target = this.placeOf(index);
    this.draw();
  }
}
