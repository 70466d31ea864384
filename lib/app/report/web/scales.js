// SPDX-License-Identifier: GPL-3.0-or-later

// Colours of values.

import {BLUE} from "./elements.js";
import {formatNumber, lengthUnit} from "./numbers.js";
import {report} from "./report_data.js";

/** One colour map for each quantity, from schemas/dictionary/maps.json: colours at equal distances, interpolated between. */
const COLOR_MAPS = Object.fromEntries(Object.entries(report.colors.maps).map(([name, anchors]) => [name, unpackColors(anchors)]));
export const NO_VALUE_COLOR = partsOf(report.colors.no_value);
export const MARK_COLOR = cssColor(partsOf(report.colors.mark));

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

export function parseColor(text) {
  return partsOf(parseInt(text.slice(1), 16));
}

export function cssColor(rgb) {
  return `rgb(${rgb.join(",")})`;
}

const OUTLIERS = report.colors.outliers;          // share of the values on either side that lie beyond the ends
const LIMIT_INSIDE = report.colors.limit_inside;  // a scale reaches at least this times the limit
const MIN_RANGE = 1e-3;                           // of a scale, so that rounding errors do not appear in colour
const FROM_MIN = ["elevation", "quantity"];  // the styles whose colours begin at the least value, not at 0
export const NEAR = report.colors.limit_near;  // a limit is near to values if it is at most this times the largest

/** Whether scales of errors reach the limits: "near" those that are near to the values, "all" or "none". */
export const display = {limits: "near"};

/** The mapping of a raster's values to colours: {colors, low, high, clipped: [below, above], factor, unit, limit}. The
 * rasters of raster.peers have one common scale. */
export function scaleOf(raster) {
  const {style, unit, limit} = raster.layer;
  const peers = raster.peers ?? [raster];
  const low = Math.min(...peers.map((peer) => peer.layer.low)), high = Math.max(...peers.map((peer) => peer.layer.high));
  const ends = style === "probability" ? [0, 1] : style === "shaded_probability" ? [0, high > 0 ? high : 1] :
      style === "signed" || style === "magnitude" ? errorEnds(raster) : ordinaryEnds(peers, low, high);
  const colors = COLOR_MAPS[raster.layer.colors] ?? COLOR_MAPS.magnitude;
  const slack = 1e-9 * (ends[1] - ends[0]);
  return withUnit({colors, low: ends[0], high: ends[1], clipped: [low < ends[0] - slack, high > ends[1] + slack],
                   limit}, unit);
}

/** Symmetric about 0, or from 0: the 99.5 % quantile of the magnitudes and, if it is to be shown, the limit. */
function errorEnds(raster) {
  const peers = raster.peers ?? [raster], magnitudes = sampleOf(peers).map(Math.abs).sort();
  const values = Math.max(quantileOf(magnitudes, 1 - OUTLIERS), MIN_RANGE);
  const limit = LIMIT_INSIDE * Math.max(...peers.map((peer) => peer.layer.limit ?? 0));
  const isReached = display.limits === "all" || (display.limits === "near" && limit <= NEAR * values);
  const bound = isReached ? Math.max(values, limit) : values;
  return [raster.layer.style === "signed" ? -bound : 0, bound];
}

/** All values or, if these reach over more than twice the range between the 0.5 and 99.5 % quantiles, this range. Numbers
 * of returns begin at 0. */
function ordinaryEnds(peers, low, high) {
  const values = sampleOf(peers).sort();
  const minimum = quantileOf(values, OUTLIERS), maximum = quantileOf(values, 1 - OUTLIERS);
  if (!FROM_MIN.includes(peers[0].layer.style)) return [0, maximum >= 1 && high > 2 * maximum ? maximum : Math.max(high, 1)];
  const ends = maximum > minimum && high - low > 2 * (maximum - minimum) ? [minimum, maximum] : [low, high];
  return [ends[0], Math.max(ends[1], ends[0] + MIN_RANGE)];
}

/** At most about 200,000 values of the rasters. */
function sampleOf(rasters) {
  const values = [];
  for (const raster of rasters) {
    const stride = Math.max(1, Math.floor(rasters.length * raster.codes.length / 200000));
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

export function colorOf(scale, value) {
  if (Number.isNaN(value)) return NO_VALUE_COLOR;
  const at = Math.round(255 * (value - scale.low) / (scale.high - scale.low));
  return scale.colors[Math.min(255, Math.max(0, at))];
}

/** The bits of a layer of flags or classes: [{bits, text, color}], the first for the colour of a cell first. */
function flagsOf(layer) {
  return layer.flags ?? report.fail_flags;
}

export function flagColor(layer, bits) {
  return flagsOf(layer).find((flag) => flag.bits & bits)?.color ?? null;
}

/** The colour of a set bin of a mask, or of a bin with flags, on a map of its own. */
export function markColor(layer, value) {
  return layer.style === "mask" ? BLUE : flagColor(layer, value);
}

function flagText(layer, bits) {
  return flagsOf(layer).filter((flag) => flag.bits & bits).map((flag) => flag.text).join(", ") || "none";
}

/** The value of a cell with its unit, in words for masks and flags. */
export function valueText(raster, index) {
  const value = raster.value(index);
  const {style, step, unit} = raster.layer;
  if (style === "flags" || style === "classes") return flagText(raster.layer, value);
  if (Number.isNaN(value)) return "no value";
  if (style === "mask") return value === 0 ? "no" : value === 1 ? "yes" : `${formatNumber(100 * value, 1)} % of the bins`;
  const {unit: shown, factor} = withUnit({low: raster.layer.low, high: raster.layer.high}, unit);
  return `${formatNumber(factor * value, factor * step)} ${shown}`.trimEnd();
}
