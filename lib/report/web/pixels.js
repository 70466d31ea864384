// SPDX-License-Identifier: GPL-3.0-or-later

// Blocks of a raster as the pixels of a canvas.

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
