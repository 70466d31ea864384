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

// The view

const SIZE_px = {minimum: 1.5, maximum: 30};
const REACH_px = 8;     // a click chooses a point at most so far away
const CLICK_px = 4;     // a longer movement of the pointer is a drag
const OUTER = 0.005;    // share of the points beyond either end of an axis that the first view may leave out
const HULL_POINTS = 2000;
const LOOSE = 5;        // times the distance between points: those so much farther may hide one

const VERTEX_SHADER = `#version 300 es
in vec3 place, color;
uniform mat4 projection;
uniform vec3 low, high;  // of the box
uniform float pointScale, minimum, grown, loose;
uniform vec2 depth;
out vec3 shade;
void main() {
  bool inside = all(greaterThanEqual(place, low)) && all(lessThanEqual(place, high));
  gl_Position = inside ? projection * vec4(place, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
  // Any of the points that cover each other may be in front. The highest would have the largest error.
  uint mixed = uint(gl_VertexID) * 2654435761u;
  mixed = (mixed ^ (mixed >> 15)) * 2246822519u;
  float nearer = max(0.5 * gl_Position.w, gl_Position.w - loose * float(mixed >> 16) / 65536.0);
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
          {shortest: 0.002, antialias: false});  // squares look the same without, and are drawn in a third of the time
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
    this.hull = this.hullPoints();
    const [width, depth] = this.ends.map(([low, high]) => high - low);
    this.spacing = Math.sqrt(Math.max(width * depth, 1e-12) / this.count);
    this.openBox();
    this.listen();
    this.listenForClicks();
  }

  /** Some of the points that lie between the ends of all axes. */
  hullPoints() {
    const half = this.ends.map(([low, high]) => (high - low) / 2), points = [];
    const stride = Math.max(1, Math.floor(this.count / HULL_POINTS));
    for (let i = 0; i < this.count; i += stride) {
      const place = this.placeOf(i);
      if (place.every((value, axis) => Math.abs(value) <= half[axis])) points.push(place);
    }
    return points.length > 0 ? points : [[0, 0, 0]];
  }

  /** Relative to the middle. */
  placeOf(index) {
    return [...this.places.subarray(3 * index, 3 * index + 3)];
  }

  /** Shows the points between the ends of each axis, [[low, high], ...] in the coordinates of the file. */
  cut(ends) {
    this.box = ends;
    this.low = ends.map(([low], axis) => low - this.middle[axis]);
    this.high = ends.map(([, high], axis) => high - this.middle[axis]);
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

  /** Colours the points by a column. */
  show(column) {
    const colors = new Uint8Array(3 * this.count);
    const {layer, codes} = column;
    const scale = layer.flags ? null : scaleOf(column);
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
    gl.uniform1f(at("pointScale"), this.pixels);
    gl.uniform1f(at("minimum"), SIZE_px.minimum);
    gl.uniform1f(at("loose"), LOOSE * this.spacing);
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
