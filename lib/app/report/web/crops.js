// SPDX-License-Identifier: GPL-3.0-or-later

// The worst footprints and the largest holes: a table each, and maps of the footprints in full resolution.

import {htmlElement, tableElement} from "./elements.js";
import {holeChart} from "./error_charts.js";
import {MapPanel} from "./map.js";
import {mapColumns} from "./map_pages.js";
import {counted, formatNumber, metresAs} from "./numbers.js";
import {rasterOf} from "./rasters.js";
import {report} from "./report_data.js";

export function centimetres(value_m, limit_m) {
  const over = limit_m !== undefined && value_m !== null && value_m > limit_m;
  return [value_m === null ? "\u2013" : formatNumber(100 * value_m, 0.001) + (over ? " \u2717" : ""), value_m];
}

function worstTable(worst, limits) {
  const headings = [["no.", true], ["x (m)", true], ["y (m)", true], ["rel. x (cm)", true], ["rel. y (cm)", true],
                    ["rel. z (cm)", true], ["abs. horizontal (cm)", true], ["abs. z (cm)", true],
                    ["of its limit", true], ["which limit", false]];
  const onMap = mapColumns(worst);
  const rows = worst.map((f, k) => [
    [String(k + 1), k + 1],
    [formatNumber(f.x_m, 0.001), f.x_m], [formatNumber(f.y_m, 0.001), f.y_m],
    ...f.relative_m.map((error_m, axis) => centimetres(error_m, limits.relative_m[axis])),
    centimetres(f.horizontal_m, limits.horizontal_m),
    centimetres(f.absolute_m[2]),
    [f.share === null ? "\u221e" : `${formatNumber(100 * f.share, 0.1)} %`, f.share ?? 1e300],
    [requirementText(f)], ...onMap.cellsOf(f)]);
  return tableElement("worst-footprints", [...headings, ...onMap.heads], rows);
}

function requirementText({axis}) {
  return axis === "h" ? "absolute horizontal" : `relative ${axis}`;
}

/** The command that lists the returns behind the footprint's central bin. */
function inspection({x_m, y_m}) {
  const place = [x_m, y_m].map((value) => Number(value.toFixed(6)));
  return `landfall-info dem.h5 --at=${place} --scan scan.h5`;
}

async function cropFigure(footprint, k) {
  const maps = [];
  for (const layer of footprint.crop.layers) {
    const raster = await rasterOf(layer, footprint.crop);
    maps.push(new MapPanel(raster, {footprint}).element);
  }
  const share = footprint.share === null ? "over a limit of 0" : `${formatNumber(100 * footprint.share, 0.1)} % of its limit`;
  const title = `No. ${k + 1} at x ${formatNumber(footprint.x_m, 0.01)} m, y ${formatNumber(footprint.y_m, 0.01)} m`;
  return htmlElement("div", {class: "crop"}, htmlElement("h3", {}, title),
                     htmlElement("p", {class: "note"}, `${requirementText(footprint)} error: ${share}; its returns: `,
                                 htmlElement("code", {class: "inspection"}, inspection(footprint))),
                     htmlElement("div", {class: "pair"}, ...maps));
}

export async function fillWorst(section) {
  const {worst, footprint_limits: limits, footprint, metrics} = report;
  if (worst.length === 0) {
    section.append(htmlElement("p", {}, "No footprint could be judged."));
    return;
  }
  const limit = (value) => metresAs(value, "cm", 100);
  section.append(
      htmlElement("p", {}, worst.length === 1 ?
          "The footprint closest to a limit, or farthest over one: all others overlap it." :
          `The ${worst.length} footprints closest to a limit, or farthest over one, that do not overlap: ` +
          "each is the worst of those at least a footprint away from all before it."),
      htmlElement("p", {class: "note"}, `Footprint: ${footprint.shape}, ${footprint.width_m} m, ` +
          `${counted(metrics.accuracy.footprint_bins, "bin")} across. Limits: relative x and y ${limit(limits.relative_m[0])}, ` +
          `relative z ${limit(limits.relative_m[2])}, absolute horizontal ${limit(limits.horizontal_m)} for ` +
          `${100 * limits.horizontal_share} % of the footprints. \u2717 marks values over their limit. The commands name the files of this ` +
          "evaluation dem.h5 and scan.h5; docs/user/symptoms.md explains patterns of errors."),
      worstTable(worst, limits));
  const crops = htmlElement("div", {class: "crops"});
  section.append(crops);
  for (const [k, f] of worst.entries()) crops.append(await cropFigure(f, k));
}

export function fillHoles(section) {
  const {coverage} = report.metrics;
  const limit = report.limits.hole_bins;
  const farthest = coverage.max_distance_bins;
  section.append(htmlElement("p", {}, `${counted(coverage.invalid_count, "invalid bin")} ` +
      `(${Number((100 * coverage.invalid_frac).toPrecision(4))} % of the region) in ${counted(coverage.hole_count, "hole")}; ` +
      `${counted(coverage.holes_over_limit, "hole")} of more than ${counted(limit, "bin")}. ` +
      (farthest === null ? "No bin of the DEM is valid." : farthest === 0 ? "" :
          `The farthest invalid bin is ${counted(Number(farthest.toPrecision(4)), "bin")} from a valid one.`)));
  if (coverage.hole_count === 0) return;
  const onMap = mapColumns(report.holes);
  const rows = report.holes.map((hole) => [
    [hole.size_bins + (hole.size_bins > limit ? " \u2717" : ""), hole.size_bins],
    [formatNumber(hole.x_m, 0.001), hole.x_m], [formatNumber(hole.y_m, 0.001), hole.y_m],
    [formatNumber(hole.width_m, 0.001), hole.width_m], [formatNumber(hole.height_m, 0.001), hole.height_m],
    [formatNumber(hole.distance_bins, 0.01), hole.distance_bins ?? 1e300], ...onMap.cellsOf(hole)]);
  const headings = ["bins", "x (m)", "y (m)", "along x (m)", "along y (m)", "to a valid bin (bins)"];
  section.append(htmlElement("div", {class: "beside"}, holeChart(coverage.hole_size_histogram, limit),
                             htmlElement("div", {}, htmlElement("p", {class: "note"},
      `${rows.length === 1 ? "The only hole" : coverage.hole_count > rows.length ? `The ${rows.length} largest` :
          `All ${rows.length}`}; \u2717 marks those over the limit of ${counted(limit, "bin")}.`),
      tableElement("largest-holes", [...headings.map((text) => [text, true]), ...onMap.heads], rows))));
}
