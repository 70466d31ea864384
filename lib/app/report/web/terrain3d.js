// SPDX-License-Identifier: GPL-3.0-or-later

// The DEM in three dimensions (WebGL 2): z_est as the surface, any layer as its colour, holes left out.

import {failLegend, horizontalColorBar} from "./colorbar.js";
import {buttonElement, choiceElement, htmlElement} from "./elements.js";
import {HANDLING, OrbitView, pixelsAtUnitDistance} from "./orbit_view.js";
import {onThemeChange} from "./page.js";
import {blocksOf, layerNamed, rasterOf} from "./rasters.js";
import {report} from "./report_data.js";
import {colorOf, flagColor, parseColor, scaleOf} from "./scales.js";

const MAX_VERTICES = 512;  // along either axis
const HULL_CELLS = 48;      // along either axis, of the blocks whose extremes stand for the surface

const VERTEX_SHADER = `#version 300 es
in float elevation;
in vec3 color;
uniform mat4 projection;
uniform vec2 first, cell;
uniform float middle, exaggeration;
uniform float pointScale;  // pixels of a cell at the distance 1
uniform int columns;
out vec3 shade, place;
void main() {
  vec2 at = first + cell * vec2(gl_VertexID % columns, gl_VertexID / columns);
  place = vec3(at, (elevation - middle) * exaggeration);
  shade = color;
  gl_Position = projection * vec4(place, 1.0);
  gl_PointSize = max(2.0, pointScale / gl_Position.w);
}`;

const FRAGMENT_SHADER = `#version 300 es
precision highp float;
in vec3 shade, place;
uniform bool level;  // without shading
out vec4 result;
void main() {
  if (level) {
    result = vec4(shade, 1.0);
    return;
  }
  vec3 normal = normalize(cross(dFdx(place), dFdy(place)));
  if (normal.z < 0.0) normal = -normal;
  float light = 0.5 + 0.65 * max(0.0, dot(normal, normalize(vec3(-0.5, 0.5, 0.7))));
  result = vec4(shade * light, 1.0);
}`;

/** The raster reduced to at most MAX_VERTICES cells a side. */
function coarseRaster(raster) {
  return blocksOf(raster, Math.ceil(Math.max(raster.rows, raster.cols) / MAX_VERTICES));
}

/** The corners of the triangles between neighbouring vertices that have a value, and the vertices with a value that
 * belong to no triangle. */
function surfaceIndices({rows, cols, values}) {
  const corners = [], used = new Uint8Array(values.length);
  const add = (...vertices) => {
    corners.push(...vertices);
    for (const vertex of vertices) used[vertex] = 1;
  };
  for (let row = 0; row + 1 < rows; ++row) {
    for (let col = 0; col + 1 < cols; ++col) {
      const a = row * cols + col, b = a + 1, c = a + cols, d = c + 1;
      if (Number.isNaN(values[b]) || Number.isNaN(values[c])) continue;
      if (!Number.isNaN(values[a])) add(a, b, c);
      if (!Number.isNaN(values[d])) add(b, d, c);
    }
  }
  const points = [];
  values.forEach((value, i) => { if (!Number.isNaN(value) && !used[i]) points.push(i); });
  return {corners, points};
}

/** The lowest and the highest vertex of each block of the surface, relative to the middle of the map: what must be in
 * sight. */
function hullOf({rows, cols, values, cell_m}, middle_m) {
  const stride = Math.ceil(Math.max(rows, cols) / HULL_CELLS), points = [];
  for (let row0 = 0; row0 < rows; row0 += stride) {
    for (let col0 = 0; col0 < cols; col0 += stride) {
      let low = null, high = null;
      for (let row = row0; row < Math.min(rows, row0 + stride); ++row) {
        for (let col = col0; col < Math.min(cols, col0 + stride); ++col) {
          const z = values[row * cols + col] - middle_m;
          if (Number.isNaN(z)) continue;
          const point = [(col + 0.5 - cols / 2) * cell_m, (row + 0.5 - rows / 2) * cell_m, z];
          if (low === null || z < low[2]) low = point;
          if (high === null || z > high[2]) high = point;
        }
      }
      if (low !== null) points.push(low, high);
    }
  }
  return points;
}

class TerrainView extends OrbitView {
  cornerCount; pointCount;

  /** Throws if WebGL 2 is missing. */
  constructor(surface) {
    super("terrain", "The DEM in three dimensions. Arrow keys turn it, plus and minus zoom.", VERTEX_SHADER, FRAGMENT_SHADER);
    this.surface = surface;
    this.place();
    this.upload("elevation", 1, surface.values.map((v) => Number.isNaN(v) ? 0 : v));
    const {corners, points} = surfaceIndices(surface);
    Object.assign(this, {cornerCount: corners.length, pointCount: points.length});
    this.gl.bindBuffer(this.gl.ELEMENT_ARRAY_BUFFER, this.gl.createBuffer());
    this.gl.bufferData(this.gl.ELEMENT_ARRAY_BUFFER, Uint32Array.from([...corners, ...points]), this.gl.STATIC_DRAW);
    this.listen();
  }

  /** Sets the positions of the vertices relative to the middle of the map. */
  place() {
    const {rows, cols, cell_m, values} = this.surface;
    let low = Infinity, high = -Infinity;
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
    const middle_m = low <= high ? (low + high) / 2 : 0;
    this.hull = hullOf(this.surface, middle_m);
    const at = (name) => this.gl.getUniformLocation(this.program, name);
    this.gl.uniform2f(at("first"), (1 - cols) / 2 * cell_m, (1 - rows) / 2 * cell_m);
    this.gl.uniform2f(at("cell"), cell_m, cell_m);
    this.gl.uniform1f(at("middle"), middle_m);
    this.gl.uniform1i(at("columns"), cols);
  }

  /** Shows the colours of another layer's raster. */
  show(raster) {
    const {values} = coarseRaster(raster);
    const scale = scaleOf(raster);
    const {style} = raster.layer;
    const colors = new Uint8Array(3 * values.length);
    values.forEach((value, i) => {
      const color = style === "flags" ? parseColor(flagColor(raster.layer, value) ?? "#e8ebee") : colorOf(scale, value);
      colors.set(color, 3 * i);
    });
    this.upload("color", 3, colors);
    this.draw();
  }

  draw() {
    const {gl} = this;
    const {width, height} = this.beginFrame();
    const at = (name) => gl.getUniformLocation(this.program, name);
    gl.uniform1f(at("exaggeration"), this.view.exaggeration);
    gl.uniform1f(at("pointScale"), this.surface.cell_m * pixelsAtUnitDistance(width, height));
    gl.uniform1i(at("level"), 0);
    gl.drawElements(gl.TRIANGLES, this.cornerCount, gl.UNSIGNED_INT, 0);
    gl.uniform1i(at("level"), 1);
    gl.drawElements(gl.POINTS, this.pointCount, gl.UNSIGNED_INT, 4 * this.cornerCount);
  }
}

/** Creates the view with its controls. */
export async function fillTerrainView(section) {
  const say = (text) => section.append(htmlElement("p", {}, text));
  const elevation = await rasterOf(layerNamed("z_est"), report.grid);
  if (!elevation.hasValue()) return say("Nothing to show: no bin of the DEM is valid.");
  const surface = coarseRaster(elevation);
  let view;
  try {
    view = new TerrainView(surface);
  } catch (error) {
    return say(`This browser has no WebGL 2, which the 3-D view needs (${error.message}). The maps show the same.`);
  }
  const bins = surface.stride * report.grid.factor;
  const legend = htmlElement("div", {id: "terrain-legend", class: "orbit-legend"}, terrainLegend(elevation));
  section.append(terrainControls(view, legend), view.canvas, legend, htmlElement("p", {class: "note"},
      `${surface.rows} x ${surface.cols} vertices, ${bins === 1 ? "one for each bin" : `one for ${bins} x ${bins} bins`}; ` +
      "a bin without an elevation is omitted, one without neighbours is a point. Light from the north-west shades " +
      `the surface. ${HANDLING}`));
  view.show(elevation);
  onThemeChange(() => view.draw());
  return undefined;
}

function terrainLegend(raster) {
  return raster.layer.style === "flags" ? failLegend() : horizontalColorBar(raster);
}

function terrainControls(view, legend) {
  const layers = report.layers.filter((layer) => layer.style !== "mask");
  const color = choiceElement("colour", {id: "terrain-layer"}, layers.map(({name, title}) => [name, title]), async (name) => {
    const raster = await rasterOf(layerNamed(name), report.grid);
    view.show(raster);
    legend.replaceChildren(terrainLegend(raster));
  });
  const slider = htmlElement("input", {type: "range", id: "exaggeration", min: "0", max: "1", step: "0.01", value: "0"});
  const shown = htmlElement("output", {}, "1");
  slider.addEventListener("input", () => {
    view.view.exaggeration = 100 ** Number(slider.value);
    shown.textContent = Number(view.view.exaggeration.toPrecision(2));
    view.draw();
  });
  return htmlElement("div", {class: "controls"}, color, htmlElement("label", {}, "heights times", slider, shown),
                     buttonElement("reset the view", () => view.reset()));
}
