// SPDX-License-Identifier: GPL-3.0-or-later

// The columns of a cloud unpacked: 32-bit codes, value = offset + code * step.

import {unpackCodes} from "./rasters.js";
import {report} from "./report_data.js";

const NO_WIDE_CODE = 0xffffffff;

/** The halves of the codes, packed apart; null where all are 0. */
function halfOf(name) {
  const element = document.getElementById("layer-" + name);
  return element === null ? null : unpackCodes(element.textContent, report.count);
}

/** The values of all points, NaN where one has none; scales.js takes it for a raster. */
function readColumn(layer) {
  const [low, high] = ["low", "high"].map((half) => halfOf(`${layer.name}-${half}`));
  const codes = Uint32Array.from(low);
  if (high !== null) high.forEach((part, i) => { codes[i] += 65536 * part; });
  return {layer, codes, value: (index) => codes[index] === NO_WIDE_CODE ? NaN : layer.offset + codes[index] * layer.step};
}

const columns = new Map();

/** A column of the report, unpacked on first use; null if it has none of this name. */
export function columnOf(name) {
  const layer = report.layers.find((candidate) => candidate.name === name);
  if (!layer) return null;
  if (!columns.has(name)) columns.set(name, readColumn(layer));
  return columns.get(name);
}

/** The value between the lowest and the highest below which this share of the values lies, from a sample. */
export function quantileOfColumn(column, share) {
  const stride = Math.max(1, Math.floor(column.codes.length / 20000)), sample = [];
  for (let i = 0; i < column.codes.length; i += stride) sample.push(column.value(i));
  return Float64Array.from(sample).sort()[Math.round(share * (sample.length - 1))];
}
