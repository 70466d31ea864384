// SPDX-License-Identifier: GPL-3.0-or-later

// One colour map for each quantity, from schemas/dictionary/maps.json: colours at equal distances, interpolated between.

import {report} from "./report_data.js";

export const COLOR_MAPS = Object.fromEntries(Object.entries(report.colors.maps).map(([name, anchors]) => [name, unpackColors(anchors)]));
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
