// SPDX-License-Identifier: GPL-3.0-or-later

// Diagrams of an evaluation: distributions of the errors, sizes of the holes, errors against sigmas.

import {Chart} from "./chart.js";
import {LINE, TEXT_COLOR} from "./elements.js";
import {counted, lengthUnit, metresAs} from "./numbers.js";

const MIN_BOUND_M = 1e-6;  // least bound of an axis, so that rounding errors do not fill it
const AXIS_STYLES = {x: {color: LINE.blue, dash: ""}, y: {color: LINE.vermilion, dash: "6 3"}, z: {color: TEXT_COLOR, dash: "2 2"}};

/** `curves`: [[axis, points]]. */
function addCurves(chart, prefix, curves) {
  for (const [axis, points] of curves) chart.curve(points, {...AXIS_STYLES[axis], text: prefix + axis});
  return chart;
}

/** Shares up to a value, extended to the right border with share 1, so that a single value gives a line, too. */
function rising(points, right, factor) {
  return [...points, [Math.max(right, points[points.length - 1][0]), 1]].map(([x, y]) => [x * factor, 100 * y]);
}

/** Cumulative share of a histogram: [[upper edge of a class, share up to it]]. */
function cumulative({low, high, count}) {
  const total = count.reduce((sum, n) => sum + n, 0);
  let sum = 0;
  const points = count.map((n, k) => {
    sum += n;
    return [low + (k + 1) * (high - low) / count.length, sum / total];
  });
  return [[low, 0], ...points];
}

/** The value below which a share of a histogram lies. */
function shareBelow(histogram, share) {
  return cumulative(histogram).find(([, y]) => y >= share)[0];
}

export function errorChart(axes) {
  const shown = axes.filter(([, h]) => h.error.count.length > 1);
  if (shown.length === 0) return null;
  const bound = Math.max(MIN_BOUND_M, ...shown.map(([, h]) => Math.max(Math.abs(shareBelow(h.error, 0.001)),
                                                                 Math.abs(shareBelow(h.error, 0.999)))));
  const [unit, factor] = lengthUnit(bound);
  const curves = shown.map(([axis, h]) => [axis, merged(h.error, bound, 80)]);
  const high = 1.08 * Math.max(...curves.map(([, points]) => Math.max(...points.map(([, y]) => y))));
  const chart = new Chart("Errors of the bins", {low: -bound * factor, high: bound * factor, label: `true \u2212 estimated (${unit})`},
                          {low: 0, high: 100 * high, label: "bins in a class (%)"});
  return addCurves(chart, "e_", curves.map(([axis, points]) => [axis, points.map(([x, y]) => [x * factor, 100 * y])])).element;
}

/** [[middle, share]] of `classes` equally wide classes from -bound to bound. */
function merged({low, high, count}, bound, classes) {
  const total = count.reduce((sum, n) => sum + n, 0);
  const shares = new Array(classes).fill(0);
  const width = 2 * bound / classes, step = (high - low) / count.length;
  count.forEach((n, k) => {
    // A class across a border is divided in proportion, because unequal divisions would cause a beat pattern.
    const begin = (low + k * step + bound) / width, end = begin + step / width;
    for (let at = Math.max(0, Math.floor(begin)); at < Math.min(classes, end); ++at) {
      shares[at] += n / total * (Math.min(end, at + 1) - Math.max(begin, at)) / (end - begin);
    }
  });
  return shares.map((share, k) => [(2 * (k + 0.5) / classes - 1) * bound, share]);
}

export function absoluteErrorChart(axes) {
  const shown = axes.filter(([, h]) => h.error.count.length > 0);
  if (shown.length === 0) return null;
  const curves = shown.map(([axis, h]) => [axis, folded(h.error)]);
  const bound = Math.max(MIN_BOUND_M, ...curves.map(([, points]) => points.find(([, y]) => y >= 0.999)[0]));
  const [unit, factor] = lengthUnit(bound);
  const chart = new Chart("Bins with an error up to ...", {low: 0, high: bound * factor, label: `|error| (${unit})`},
                          {low: 0, high: 100, label: "share of the bins (%)"});
  return addCurves(chart, "e_", curves.map(([axis, points]) => [axis, rising(points, bound, factor)])).element;
}

/** The cumulative shares of |value|. */
function folded({low, high, count}) {
  const total = count.reduce((sum, n) => sum + n, 0);
  const values = count.map((n, k) => [Math.abs(low + (k + 0.5) * (high - low) / count.length), n]);
  values.sort((a, b) => a[0] - b[0]);
  let sum = 0;
  return [[values[0][0], 0], ...values.map(([value, n]) => [value, (sum += n) / total])];
}

export function relativeChart(axes, limits) {
  const shown = axes.filter(([, h]) => h.relative.count.length > 0);
  if (shown.length === 0) return null;
  const largest = Math.max(...shown.map(([, h]) => h.relative.high));
  const [ofX, , ofZ] = limits.relative_m;
  const closest = Math.max(ofZ, ofX);
  const bound = Math.max(MIN_BOUND_M, closest > 30 * largest ? largest : Math.max(largest, closest) * 1.05);
  const [unit, factor] = lengthUnit(bound);
  const chart = new Chart("Footprints with a relative error up to ...",
                          {low: 0, high: bound * factor, label: `relative error (${unit})`},
                          {low: 0, high: 100, label: "share of the footprints (%)"});
  addCurves(chart, "rel_", shown.map(([axis, h]) => [axis, rising(cumulative(h.relative), bound, factor)]));
  const texts = ofZ === ofX ? [["limit", ofZ]] : [["limit of z", ofZ], ["limit of x and y", ofX]];
  for (const [text, limit] of texts) chart.limit(limit * factor, `${text} ${metresAs(limit, ...lengthUnit(limit))}`, LINE.purple);
  return chart.element;
}

export function holeChart({size_bins, count}, limit) {
  const largest = size_bins[size_bins.length - 1];
  const log = largest >= 60;
  const high = Math.max(largest, limit <= Math.max(30, 3 * largest) ? limit : 0) * (log ? 1.3 : 1) + 1;
  const maximum = Math.max(...count);
  const countLog = maximum > 50;
  const chart = new Chart("Sizes of the holes", {low: log ? 0.8 : 0, high, label: "bins of a hole (8-connected)", log, whole: true},
                          {low: countLog ? 0.7 : 0, high: countLog ? maximum * 1.5 : maximum * 1.1, label: "holes", log: countLog,
                           whole: true});
  const bars = size_bins.map((size, k) => log ? {low: size / 1.05, high: size * 1.05, count: count[k]} :
                                                {low: size - 0.4, high: size + 0.4, count: count[k]});
  return chart.bars(bars, LINE.blue).limit(limit + 0.5, `limit ${counted(limit, "bin")}`).element;
}

export function reliabilityChart(title, {sigma_m, rmse_m, bins}) {
  const shown = sigma_m.map((sigma, k) => [sigma, rmse_m[k], bins[k]]).filter(([s, r]) => s > 0 && r > 0);
  if (shown.length === 0) return null;
  const values = shown.flatMap(([sigma, rmse]) => [sigma, rmse]);
  const [unit, factor] = lengthUnit(Math.max(...values));
  const low = factor * Math.min(...values) / 1.3, high = factor * Math.max(...values) * 1.3;
  const maximum = Math.max(...shown.map(([, , n]) => n));
  const chart = new Chart(title, {low, high, log: true, label: `predicted sigma (${unit})`},
                          {low, high, log: true, label: `root mean square error (${unit})`});
  return chart.curve([[low, low], [high, high]], {color: TEXT_COLOR, text: "as predicted", width: 1.2})
      .dots(shown.map(([sigma, rmse, n]) => [sigma * factor, rmse * factor, 2.5 + 6 * Math.sqrt(n / maximum)]), LINE.blue,
            "found (area: bins)").element;
}

/** The error function, within 1.5e-7 (Abramowitz and Stegun 7.1.26). */
function errorFunction(x) {
  const t = 1 / (1 + 0.3275911 * x);
  const factors = [0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429];
  return 1 - factors.reduceRight((sum, factor) => (sum + factor) * t, 0) * Math.exp(-x * x);
}

export function shareChart(title, {k, frac}) {
  if (k.length === 0) return null;
  const chart = new Chart(title, {low: 0, high: 4, label: "k"},
                          {low: 0, high: 100, label: "errors within k sigma (%)"});
  const normal = Array.from({length: 81}, (_, i) => [i / 20, 100 * errorFunction(i / 20 / Math.SQRT2)]);
  return chart.curve(normal, {color: TEXT_COLOR, text: "normal distribution", width: 1.2})
      .dots(k.map((value, i) => [value, 100 * frac[i], 3.5]), LINE.blue, "found").element;
}
