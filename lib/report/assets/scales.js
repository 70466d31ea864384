// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// Colours of values and of pixels; units, ticks and numbers.

// Seventeen colours each, evenly spaced; colours between are interpolated. All three are readable with every common
// colour blindness: viridis (van der Walt and Smith 2015), cividis (Nunez et al. 2018), ColorBrewer's RdBu turned
// round, blue for negative.
const COLOR_MAPS = {
  viridis: unpackColors(
      "440154 48186a 472d7b 424086 3b528b 33638d 2c728e 26828e 21918c " +
      "1fa088 28ae80 3fbc73 5ec962 84d44b addc30 d8e219 fde725"),
  cividis: unpackColors(
      "00224e 002e6a 1a386f 32436d 434e6c 535a6d 61656f 6f7073 7d7c78 " +
      "8c8878 9b9476 aba072 bcae6c cdbb63 dec958 f0d846 fee838"),
  diverging: unpackColors(
      "053061 175290 2a71b2 3f8ec0 6bacd1 9bc9e0 c2ddec e0ecf3 f7f6f6 " +
      "fbe5d8 fbccb4 f5aa89 e48066 d05548 ba2832 930e26 67001f"),
};
// Okabe and Ito's palette is readable with every common colour blindness, too.
const BLUE = "#0072b2", SKY_BLUE = "#56b4e9", VERMILION = "#d55e00", ORANGE = "#e69f00", GREEN = "#009e73",
    PURPLE = "#cc79a7", INK = "#1d2733";
const NO_VALUE_COLOR = [217, 217, 217];

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

function unpackColors(text) {
  const anchors = text.split(" ").map(parseColor);
  const table = [];
  for (let i = 0; i < 256; ++i) {
    const at = i / 255 * (anchors.length - 1);
    const k = Math.min(Math.floor(at), anchors.length - 2);
    table.push(anchors[k].map((low, c) => Math.round(low + (at - k) * (anchors[k + 1][c] - low))));
  }
  return table;
}

function parseColor(text) {
  const digits = text.replace("#", "");
  return [0, 2, 4].map((at) => parseInt(digits.slice(at, at + 2), 16));
}

function cssColor(rgb) {
  return `rgb(${rgb.join(",")})`;
}

/** The mapping of a raster's values to colours: {colors, low, high, clipped, factor, unit}. */
function scaleOf(raster) {
  const {style, low, high, unit} = raster.layer;
  if (style === "elevation") {
    return withUnit({colors: COLOR_MAPS.cividis, low, high: Math.max(high, low + 1e-3), clipped: false}, unit);
  }
  if (style === "count" || style === "mask" || style === "flags") {
    return withUnit({colors: COLOR_MAPS.cividis, low: 0, high: Math.max(high, 1), clipped: false}, unit);
  }
  const {bound, clipped} = colorBound(raster, Math.max(Math.abs(low), Math.abs(high)));
  const signed = style === "signed";
  return withUnit({colors: signed ? COLOR_MAPS.diverging : COLOR_MAPS.viridis, low: signed ? -bound : 0,
                   high: bound, clipped}, unit);
}

/** The largest magnitude, or the 99.5th percentile where that is less than half of it: a single outlier
 * would make all other colours equal. At least 1 mm, so that rounding errors do not appear in colour. */
function colorBound(raster, largest) {
  const magnitudes = [];
  const stride = Math.max(1, Math.floor(raster.codes.length / 200000));
  for (let i = 0; i < raster.codes.length; i += stride) {
    const value = raster.value(i);
    if (!Number.isNaN(value)) magnitudes.push(Math.abs(value));
  }
  magnitudes.sort((a, b) => a - b);
  const usual = magnitudes[Math.floor(0.995 * (magnitudes.length - 1))] ?? 0;
  const clipped = usual >= 1e-3 && usual < largest / 2;
  return {bound: Math.max(clipped ? roundUp(usual) : largest, 1e-3), clipped};
}

/** Rounds up to 1, 1.5, 2, 3, 5 or 7 times a power of ten. */
function roundUp(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return power * ([1, 1.5, 2, 3, 5, 7, 10].find((digit) => digit * power >= value * (1 - 1e-12)) ?? 10);
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

function failColor(bits) {
  return FAIL_FLAGS.find((flag) => flag.bits & bits)?.color ?? null;
}

/** The colour of a set bin of a mask, or of a bin with flags. */
function markColor(style, value) {
  return style === "flags" ? failColor(value) : BLUE;
}

function failText(bits) {
  return FAIL_FLAGS.filter((flag) => flag.bits & bits).map((flag) => flag.text).join(", ") || "none";
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
