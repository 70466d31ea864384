// SPDX-License-Identifier: GPL-3.0-or-later

// Shared parts of pages with maps: groups of maps with a heading each, and the coordinates of places.

import {panels} from "./cursor.js";
import {choiceElement, htmlElement} from "./elements.js";
import {formatNumber} from "./numbers.js";
import {rasterOf} from "./rasters.js";
import {report} from "./report_data.js";
import {display} from "./scales.js";

/** Rasters that show one quantity, such as an error in x, y and z, have one scale. */
function shareScales(rasters) {
  const kindOf = ({layer}) => ["elevation", "signed", "magnitude"].includes(layer.style) ?
      [layer.style, layer.style === "elevation" ? "" : layer.quantity ?? layer.group].join() : layer.id;
  for (const raster of rasters) raster.peers = rasters.filter((other) => kindOf(other) === kindOf(raster));
}

/** The rasters of the layers that have a group: {groups: [[title, rasters]], all, named}. */
export async function loadGroups() {
  const titles = report.groups.filter((title) => report.layers.some(({group}) => group === title));
  const groups = await Promise.all(titles.map(async (title) => [
    title, await Promise.all(report.layers.filter(({group}) => group === title).map((layer) => rasterOf(layer, report.grid)))]));
  const all = groups.flatMap(([, rasters]) => rasters);
  shareScales(all);
  return {groups, all, named: (name) => all.find(({layer}) => layer.name === name) ?? null};
}

/** "401 x 401 bins of 5 cm" */
export function gridText() {
  const {rows, cols, resolution_m} = report.grid;
  return `${cols} x ${rows} bins of ${Number((resolution_m * 100).toPrecision(6))} cm`;
}

/** The choice of whether the scales of errors reach the limits. */
export function scaleControl() {
  const options = [["near", "reach near limits"], ["all", "reach all limits"], ["none", "show the data only"]];
  return htmlElement("div", {class: "controls screen-only"}, choiceElement("colour scales", {id: "scales"}, options, (limits) => {
    display.limits = limits;
    for (const panel of panels) panel.rescale();
  }));
}

export function appendFigures(section, title, elements) {
  section.append(htmlElement("h3", {}, title), htmlElement("div", {class: "figures"}, ...elements));
}

/** @type {[string, string, number][]} */
const COORDINATES = [["easting (m)", "easting_m", 0.01], ["northing (m)", "northing_m", 0.01],
                     ["latitude (deg)", "latitude_deg", 1e-7], ["longitude (deg)", "longitude_deg", 1e-7]];

/** Headings and, for each place, cells of the coordinates that the places have.
 * @returns {{heads: [string, boolean][], cellsOf: (place: any) => any[][]}} */
export function mapColumns(places) {
  const known = COORDINATES.filter(([, key]) => places.some((place) => key in place));
  return {heads: known.map(([text]) => [text, true]),
          cellsOf: (place) => known.map(([, key, step]) => [formatNumber(place[key], step), place[key] ?? 1e300])};
}
