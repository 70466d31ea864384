// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// Colours of values and of pixels; units, ticks and numbers.

// One colour map for each quantity, from lib/picture/color_map.cpp: colours at equal distances, interpolated between.
const COLOR_MAPS = Object.fromEntries(Object.entries(report.colors.maps).map(([name, anchors]) => [name, unpackColors(anchors)]));
const NO_VALUE_COLOR = partsOf(report.colors.no_value);
const MARK_COLOR = cssColor(partsOf(report.colors.mark));
// Okabe and Ito's palette is readable with every common colour blindness, too.
const BLUE = "#0072b2", SKY_BLUE = "#56b4e9", VERMILION = "#d55e00", ORANGE = "#e69f00", PURPLE = "#cc79a7";
const INK = "#1d2733";            // on maps, which look the same in light and dark mode
const TEXT_COLOR = "var(--ink)";  // beside maps

// FailFlag of lib/evaluation/evaluate.h and the requirement that judges it. A cell has the colour of the first entry
// of which it has a bit.
const FAIL_FLAGS = [
  {bits: 4, text: "relative z", requirement: "relative_elevation", color: VERMILION},
  {bits: 1, text: "relative x", requirement: "relative_horizontal", color: ORANGE},
  {bits: 2, text: "relative y", requirement: "relative_horizontal", color: "#661100"},
  {bits: 8, text: "absolute horizontal", requirement: "absolute_horizontal", color: PURPLE},
  {bits: 16, text: "hole too large", requirement: "hole_size", color: BLUE},
  {bits: 32, text: "too far from a valid bin", requirement: "hole_distance", color: SKY_BLUE},
];

function unpackColors(anchors) {
  const colors = anchors.map(partsOf);
  const table = [];
  for (let i = 0; i < 256; ++i) {
    const at = i / 255 * (colors.length - 1);
    const k = Math.min(Math.floor(at), colors.length - 2);
    table.push(colors[k].map((low, c) => Math.round(low + (at - k) * (colors[k + 1][c] - low))));
  }
  return table;
}

function partsOf(rrggbb) {
  return [rrggbb >> 16, rrggbb >> 8 & 255, rrggbb & 255];
}

function parseColor(text) {
  return partsOf(parseInt(text.slice(1), 16));
}

function cssColor(rgb) {
  return `rgb(${rgb.join(",")})`;
}

const OUTLIERS = 0.005;     // on either side; as in lib/picture/map_picture.cpp
const LIMIT_INSIDE = 1.1;   // a scale reaches at least this times the limit
const display = {limits: true};  // whether scales reach the limits

/** The mapping of a raster's values to colours: {colors, low, high, clipped: [below, above], factor, unit, limit}. The
 * rasters of raster.peers have one common scale. */
function scaleOf(raster) {
  const {style, unit, limit} = raster.layer;
  const peers = raster.peers ?? [raster];
  const low = Math.min(...peers.map((peer) => peer.layer.low)), high = Math.max(...peers.map((peer) => peer.layer.high));
  const ends = style === "probability" ? [0, 1] : style === "chance" ? [0, high > 0 ? high : 1] :
      style === "signed" || style === "magnitude" ? errorEnds(raster) : ordinaryEnds(peers, low, high);
  const colors = COLOR_MAPS[raster.layer.colors] ?? COLOR_MAPS.magnitude;
  const slack = 1e-9 * (ends[1] - ends[0]);
  return withUnit({colors, low: ends[0], high: ends[1], clipped: [low < ends[0] - slack, high > ends[1] + slack],
                   limit}, unit);
}

/** Symmetric about 0, or from 0: the 99.5 % quantile of the magnitudes and, if they are to be shown, the limits. At
 * least 0.001, so that rounding errors do not appear in colour. */
function errorEnds(raster) {
  const magnitudes = sampleOf(raster.peers ?? [raster]).map(Math.abs).sort();
  const limit = display.limits ? LIMIT_INSIDE * (raster.layer.limit ?? 0) : 0;
  const bound = Math.max(quantileOf(magnitudes, 1 - OUTLIERS), limit, 1e-3);
  return [raster.layer.style === "signed" ? -bound : 0, bound];
}

/** All values or, if these reach over more than twice the range between the 0.5 and 99.5 % quantiles, this range. Numbers
 * of returns begin at 0. */
function ordinaryEnds(peers, low, high) {
  const values = sampleOf(peers).sort();
  const least = quantileOf(values, OUTLIERS), most = quantileOf(values, 1 - OUTLIERS);
  if (peers[0].layer.style !== "elevation") return [0, most >= 1 && high > 2 * most ? most : Math.max(high, 1)];
  const ends = most > least && high - low > 2 * (most - least) ? [least, most] : [low, high];
  return [ends[0], Math.max(ends[1], ends[0] + 1e-3)];
}

/** At most about 200,000 values of the rasters. */
function sampleOf(rasters) {
  const values = [];
  for (const raster of rasters) {
    const stride = Math.max(1, Math.floor(raster.codes.length / 200000));
    for (let i = 0; i < raster.codes.length; i += stride) {
      const value = raster.value(i);
      if (!Number.isNaN(value)) values.push(value);
    }
  }
  return Float64Array.from(values);
}

function quantileOf(sorted, share) {
  return sorted[Math.round(share * (sorted.length - 1))] ?? 0;
}

/** Chooses m, cm or mm for metres so that the numbers are neither very small nor very large. */
function withUnit(scale, unit) {
  const [shown, factor] = unit === "m" ? lengthUnit(Math.max(Math.abs(scale.low), Math.abs(scale.high))) : [unit, 1];
  return {...scale, unit: shown, factor};
}

function lengthUnit(largest_m) {
  return largest_m >= 0.5 ? ["m", 1] : largest_m >= 0.01 ? ["cm", 100] : largest_m >= 2e-4 ? ["mm", 1000] :
      ["\u00b5m", 1e6];
}

function colorOf(scale, value) {
  if (Number.isNaN(value)) return NO_VALUE_COLOR;
  const at = Math.round(255 * (value - scale.low) / (scale.high - scale.low));
  return scale.colors[Math.min(255, Math.max(0, at))];
}

/** The bits of a layer of flags or classes: [{bits, text, color}], the first for the colour of a cell first. */
function flagsOf(layer) {
  return layer.flags ?? FAIL_FLAGS;
}

function flagColor(layer, bits) {
  return flagsOf(layer).find((flag) => flag.bits & bits)?.color ?? null;
}

/** The colour of a set bin of a mask, or of a bin with flags, on a map of its own. */
function markColor(layer, value) {
  return layer.style === "mask" ? BLUE : flagColor(layer, value);
}

function flagText(layer, bits) {
  return flagsOf(layer).filter((flag) => flag.bits & bits).map((flag) => flag.text).join(", ") || "none";
}

/** The shares of blocks in each of `pixels` pixels, which `extent` blocks fill: {first, shares}. */
function pixelShares(pixels, extent, blocks) {
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
function stretched(colors, cols, columns, rows) {
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

/** At most about `most` multiples of 1, 2 or 5 times a power of ten from low to high. */
function ticks(low, high, most) {
  const least = (high - low) / most;
  const power = 10 ** Math.floor(Math.log10(least));
  const step = power * ([1, 2, 5].find((digit) => digit * power >= least * (1 - 1e-9)) ?? 10);
  const result = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) {
    result.push({value: k * step, text: formatNumber(k * step, step)});
  }
  return result;
}

/** A number with the decimals that a step of this size needs, and a typographic minus sign. */
function formatNumber(value, step) {
  if (value === null || value === undefined || Number.isNaN(value)) return "\u2013";
  const decimals = step > 0 ? Math.min(10, Math.max(0, -Math.floor(Math.log10(step) + 1e-9))) : 3;
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}

/** "1 hole", "2 holes". */
function counted(count, word) {
  return `${count} ${word}${count === 1 ? "" : "s"}`;
}

function metresAs(value_m, unit, factor, digits = 3) {
  return value_m === null ? "\u2013" : `${Number((factor * value_m).toPrecision(digits))} ${unit}`.replaceAll("-", "\u2212");
}
