// SPDX-License-Identifier: GPL-3.0-or-later

// The maps of a page, in groups with a heading each.

import {panels} from "./cursor.js";
import {htmlElement} from "./elements.js";
import {rasterOf} from "./rasters.js";
import {report} from "./report_data.js";
import {display} from "./scales.js";

/** The rasters of the layers that have a group: {groups: [[title, rasters]], all, named}. */
export async function loadGroups() {
  const titles = report.groups.filter((title) => report.layers.some(({group}) => group === title));
  const groups = await Promise.all(titles.map(async (title) => [
    title, await Promise.all(report.layers.filter(({group}) => group === title).map((layer) => rasterOf(layer, report.grid)))]));
  const all = groups.flatMap(([, rasters]) => rasters);
  return {groups, all, named: (name) => all.find(({layer}) => layer.name === name) ?? null};
}

/** "401 x 401 bins of 5 cm" */
export function gridText() {
  const {rows, cols, resolution_m} = report.grid;
  return `${cols} x ${rows} bins of ${Number((resolution_m * 100).toPrecision(6))} cm`;
}

/** The choice of whether the scales of errors reach the limits. */
export function scaleControl() {
  const select = htmlElement("select", {id: "scales"}, htmlElement("option", {value: "near"}, "reach near limits"),
                             htmlElement("option", {value: "all"}, "reach all limits"), htmlElement("option", {value: "none"}, "show the data only"));
  select.addEventListener("change", () => {
    display.limits = select.value;
    for (const panel of panels) panel.rescale();
  });
  return htmlElement("div", {class: "controls screen-only"}, htmlElement("label", {}, "colour scales", select));
}

export function appendFigures(section, title, elements) {
  section.append(htmlElement("h3", {}, title), htmlElement("div", {class: "figures"}, ...elements));
}
