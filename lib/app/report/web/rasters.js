// SPDX-License-Identifier: GPL-3.0-or-later

// The maps of the report unpacked: 16-bit codes, value = offset + code * step; maps in larger blocks, and blocks as the pixels of a canvas.

import {report} from "./report_data.js";

const NO_VALUE_CODE = 65535;

/** A map: cells of `cell_m`, row-major, y ascending; (left_m, bottom_m) is the lower left corner of cell 0. */
class Raster {
  markedCount; markedRaster;

  constructor(layer, grid, codes) {
    this.layer = layer;
    this.rows = grid.cell_rows;
    this.cols = grid.cell_cols;
    this.factor = grid.factor;
    this.cell_m = grid.resolution_m * grid.factor;
    this.left_m = grid.x_m - grid.resolution_m / 2;
    this.bottom_m = grid.y_m - grid.resolution_m / 2;
    // Cells at the upper and right border may extend beyond the map.
    this.width_m = grid.cols * grid.resolution_m;
    this.height_m = grid.rows * grid.resolution_m;
    this.codes = codes;
  }

  /** NaN if the cell has no value. */
  value(index) {
    const code = this.codes[index];
    return code === NO_VALUE_CODE ? NaN : this.layer.offset + code * this.layer.step;
  }

  /** The index of the cell at a position, -1 outside the map. */
  indexAt(x_m, y_m) {
    const col = Math.floor((x_m - this.left_m) / this.cell_m);
    const row = Math.floor((y_m - this.bottom_m) / this.cell_m);
    return col < 0 || row < 0 || col >= this.cols || row >= this.rows ? -1 : row * this.cols + col;
  }

  /** The number of cells whose code is not 0. */
  marked() {
    this.markedCount ??= this.codes.reduce((sum, code) => sum + (code === 0 ? 0 : 1), 0);
    return this.markedCount;
  }

  /** Only the bits of a layer of classes that are marks; other layers as they are. */
  marks() {
    if (this.layer.style !== "classes") return this;
    const bits = this.layer.flags.reduce((sum, flag) => sum | (flag.is_mark ? flag.bits : 0), 0);
    this.markedRaster ??= Object.assign(Object.create(Raster.prototype), this, {
      codes: this.codes.map((code) => code & bits), markedCount: undefined});
    return this.markedRaster;
  }

  hasValue() {
    return this.codes.some((code) => code !== NO_VALUE_CODE);
  }
}

/** Undoes what packed() in lib/app/report/quantised.h describes. */
export async function unpackCodes(text, count) {
  const packed = new Blob([Uint8Array.from(atob(text), (character) => character.charCodeAt(0))]);
  const bytes = new Uint8Array(await new Response(packed.stream().pipeThrough(new DecompressionStream("deflate"))).arrayBuffer());
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

/** The map of a layer of `grid`, unpacked on first use. */
export function rasterOf(layer, grid) {
  if (!rasters.has(layer.id)) {
    const text = document.getElementById("layer-" + layer.id).textContent;
    rasters.set(layer.id, unpackCodes(text, grid.cell_rows * grid.cell_cols).then((codes) => new Raster(layer, grid, codes)));
  }
  return rasters.get(layer.id);
}

/** The report's layer of this name; null if it has none. */
export function layerNamed(name) {
  return report.layers.find((layer) => layer.name === name) ?? null;
}

/** Reduces a block of cells to one value by the layer's rule. */
function blockValue(raster, [row0, row1], [col0, col1]) {
  if (row1 - row0 === 1 && col1 - col0 === 1) return raster.value(row0 * raster.cols + col0);
  let result = NaN, count = 0;
  for (let row = row0; row < row1; ++row) {
    for (let col = col0; col < col1; ++col) {
      const value = raster.value(row * raster.cols + col);
      if (Number.isNaN(value)) continue;
      result = count === 0 ? value : chosenOf(raster.layer.rule, result, value);
      ++count;
    }
  }
  return raster.layer.rule === "mean" ? result / count : result;
}

function chosenOf(rule, a, b) {
  switch (rule) {
    case "mean": return a + b;
    case "extreme": return Math.abs(b) > Math.abs(a) ? b : a;
    case "largest": return Math.max(a, b);
    case "smallest": return Math.min(a, b);
    default: return a | b;
  }
}

/** The raster in blocks of `stride` x `stride` cells, each by the layer's rule; those at the upper and right border
 * may be cut short. */
export function blocksOf(raster, stride) {
  const rows = Math.ceil(raster.rows / stride), cols = Math.ceil(raster.cols / stride);
  const values = new Float32Array(rows * cols);
  for (let row = 0; row < rows; ++row) {
    for (let col = 0; col < cols; ++col) {
      values[row * cols + col] = blockValue(raster, [row * stride, Math.min(raster.rows, (row + 1) * stride)],
                                            [col * stride, Math.min(raster.cols, (col + 1) * stride)]);
    }
  }
  return {rows, cols, values, stride, cell_m: stride * raster.cell_m};
}

/** The share of the cells of each block that have no value. */
export function missingShares(raster, {stride, rows, cols}) {
  const missing = new Float32Array(rows * cols), all = new Float32Array(rows * cols);
  raster.codes.forEach((code, i) => {
    const block = Math.floor(Math.floor(i / raster.cols) / stride) * cols + Math.floor(i % raster.cols / stride);
    ++all[block];
    if (code === NO_VALUE_CODE) ++missing[block];
  });
  return missing.map((count, block) => count / all[block]);
}

export const MAX_MARKED = 0.01;  // of the region, and of the map by enlarged marks: more would hide the map

/** [{row, col, value}] of the marks. */
export function allMarks({cols, values}) {
  const marks = [];
  values.forEach((value, i) => {
    if (value !== 0) marks.push({row: Math.floor(i / cols), col: i % cols, value});
  });
  return marks;
}

/** Those with at most one marked neighbour of eight; larger groups are visible. */
export function loneMarks(blocks) {
  const {rows, cols, values} = blocks;
  return allMarks(blocks).filter(({row, col}) => {
    let marked = 0;
    for (let r = Math.max(0, row - 1); r <= Math.min(rows - 1, row + 1); ++r) {
      for (let c = Math.max(0, col - 1); c <= Math.min(cols - 1, col + 1); ++c) marked += values[r * cols + c] === 0 ? 0 : 1;
    }
    return marked <= 2;
  });
}

/** The shares of blocks in each of `pixels` pixels, which `extent` blocks fill: {first, shares}. */
export function pixelShares(pixels, extent, blocks) {
  const step = extent / pixels;
  return Array.from({length: pixels}, (_, pixel) => {
    const begin = pixel * step, end = begin + step;
    const first = Math.min(blocks - 1, Math.floor(begin + 1e-9));
    const last = Math.min(blocks - 1, Math.max(first, Math.ceil(end - 1e-9) - 1));
    const parts = Array.from({length: last - first + 1}, (__, k) => Math.max(
        1e-9, Math.min(end, first + k + 1) - Math.max(begin, first + k)));
    const sum = parts.reduce((total, part) => total + part, 0);
    return {first, shares: parts.map((part) => part / sum)};
  });
}

/** Colours of blocks (three numbers each, `cols` a row) as pixels: each is the mean of its blocks. */
export function stretched(colors, cols, columns, rows) {
  const across = new Float32Array(3 * columns.length * (colors.length / 3 / cols));
  for (let row = 0, to = 0; row < colors.length / 3 / cols; ++row) {
    for (const {first, shares} of columns) {
      for (let c = 0; c < 3; ++c, ++to) {
        for (let k = 0; k < shares.length; ++k) across[to] += shares[k] * colors[3 * (row * cols + first + k) + c];
      }
    }
  }
  const pixels = new Uint8ClampedArray(4 * columns.length * rows.length).fill(255);
  const width = columns.length;
  rows.forEach(({first, shares}, py) => {
    for (let px = 0; px < width; ++px) {
      for (let c = 0; c < 3; ++c) {
        let sum = 0;
        for (let k = 0; k < shares.length; ++k) sum += shares[k] * across[3 * ((first + k) * width + px) + c];
        pixels[4 * (py * width + px) + c] = sum;
      }
    }
  });
  return pixels;
}
