// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// The values of the report, and its maps unpacked: 16-bit codes, value = offset + code * step.

const report = JSON.parse(document.getElementById("report-data").textContent);
const NO_VALUE_CODE = 65535;

/** A map: cells of `cell_m`, row-major, y ascending; (left_m, bottom_m) is the lower left corner of cell 0. */
class Raster {
  constructor(layer, grid, codes) {
    this.layer = layer;
    this.rows = grid.cell_rows;
    this.cols = grid.cell_cols;
    this.cell_m = grid.resolution_m * grid.factor;
    this.left_m = grid.x_m - grid.resolution_m / 2;
    this.bottom_m = grid.y_m - grid.resolution_m / 2;
    // Cells at the upper and right border may reach past the map.
    this.width_m = grid.cols * grid.resolution_m;
    this.height_m = grid.rows * grid.resolution_m;
    this.codes = codes;
  }

  /** NaN where there is none. */
  value(index) {
    const code = this.codes[index];
    return code === NO_VALUE_CODE ? NaN : this.layer.offset + code * this.layer.step;
  }

  /** The index of the cell at a place, -1 beyond the map. */
  indexAt(x_m, y_m) {
    const col = Math.floor((x_m - this.left_m) / this.cell_m);
    const row = Math.floor((y_m - this.bottom_m) / this.cell_m);
    return col < 0 || row < 0 || col >= this.cols || row >= this.rows ? -1 : row * this.cols + col;
  }

  hasValue() {
    return this.codes.some((code) => code !== NO_VALUE_CODE);
  }
}

async function inflate(text) {
  const packed = atob(text);
  const bytes = new Uint8Array(packed.length);
  for (let i = 0; i < packed.length; ++i) bytes[i] = packed.charCodeAt(i);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** Undoes what packed() in lib/report/quantised.h describes. */
function unpackCodes(bytes) {
  const count = bytes.length / 2;
  const codes = new Uint16Array(count);
  let code = 0;
  for (let i = 0; i < count; ++i) {
    const folded = bytes[i] | bytes[count + i] << 8;
    code = code + (folded >>> 1 ^ -(folded & 1)) & 0xffff;
    codes[i] = code;
  }
  return codes;
}

const rasters = new Map();

/** The map of a layer of `grid`, unpacked once. */
function rasterOf(layer, grid) {
  if (!rasters.has(layer.id)) {
    const text = document.getElementById("layer-" + layer.id).textContent;
    rasters.set(layer.id, inflate(text).then((bytes) => new Raster(layer, grid, unpackCodes(bytes))));
  }
  return rasters.get(layer.id);
}

/** The report's own map of a name; null where it has none. */
function layerNamed(name) {
  return report.layers.find((layer) => layer.name === name) ?? null;
}
