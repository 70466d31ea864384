// SPDX-License-Identifier: GPL-3.0-or-later

// Shaded relief, as lib/formats/picture/pixel_map.cpp computes it: light from the north-west, 45 degrees high.

import {blocksOf, missingShares} from "./rasters.js";
import {colorOf, NO_VALUE_COLOR} from "./scales.js";

const RMS_SLOPE = 0.4;  // to which the relief is scaled
const MIN_RELIEF = 0.25;
const MAX_RELIEF = 5;

/** The slope between the values before and after a cell; a missing one is ignored. */
function slopeBetween(before, value, after, cell_m) {
  const hasBefore = !Number.isNaN(before), hasAfter = !Number.isNaN(after);
  if (hasBefore && hasAfter) return (after - before) / (2 * cell_m);
  if (hasAfter) return (after - value) / cell_m;
  return hasBefore ? (value - before) / cell_m : 0;
}

/** [slope to the east, slope to the north] of each block; NaN for one without a value. */
export function slopesOf({rows, cols, values, cell_m}) {
  const slopes = new Float32Array(2 * values.length).fill(NaN);
  for (let row = 0; row < rows; ++row) {
    for (let col = 0; col < cols; ++col) {
      const i = row * cols + col, value = values[i];
      if (Number.isNaN(value)) continue;
      slopes[2 * i] = slopeBetween(col > 0 ? values[i - 1] : NaN, value, col + 1 < cols ? values[i + 1] : NaN, cell_m);
      slopes[2 * i + 1] = slopeBetween(row > 0 ? values[i - cols] : NaN, value, row + 1 < rows ? values[i + cols] : NaN, cell_m);
    }
  }
  return slopes;
}

/** The factor for heights, within its bounds, that brings the rms slope nearest to RMS_SLOPE. */
export function reliefFactor(slopes) {
  let squares = 0, count = 0;
  for (let i = 0; i < slopes.length; i += 2) {
    if (Number.isNaN(slopes[i])) continue;
    squares += slopes[i] ** 2 + slopes[i + 1] ** 2;
    ++count;
  }
  const rms = count > 0 ? Math.sqrt(squares / count) : 0;
  return rms > 0 ? Math.min(MAX_RELIEF, Math.max(MIN_RELIEF, RMS_SLOPE / rms)) : 1;
}

/** The factor by which the colour of a block is multiplied: 1 on level terrain. */
export function lightOf(slopes, index, factor) {
  const east = factor * slopes[2 * index], north = factor * slopes[2 * index + 1];
  const shade = Math.max(0, (east - north + Math.SQRT2) / Math.sqrt(1 + east * east + north * north) / Math.SQRT2);
  return Math.min(1.25, Math.max(0, 0.25 + 0.75 * shade));
}

/** The colours of elevations, three numbers for each block, shaded, and greyer the fewer of its cells have a value. Rasters
 * with a common scale have a common factor, so that alternating between them shows only their differences. */
export function reliefColors(raster, blocks, scale) {
  const slopes = slopesOf(blocks);
  const first = raster.peers?.[0] ?? raster;
  const factor = reliefFactor(first === raster ? slopes : slopesOf(blocksOf(first, blocks.stride)));
  const missing = missingShares(raster, blocks);
  const colors = new Float32Array(3 * blocks.values.length);
  blocks.values.forEach((value, i) => {
    const light = Number.isNaN(value) ? 1 : lightOf(slopes, i, factor);
    colors.set(colorOf(scale, value).map((part, k) => {
      const lit = Math.min(255, part * light);
      return lit + missing[i] * (NO_VALUE_COLOR[k] - lit);
    }), 3 * i);
  });
  return colors;
}
