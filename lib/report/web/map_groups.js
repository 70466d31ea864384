// SPDX-License-Identifier: GPL-3.0-or-later

// The maps of a page, in groups with a heading each.

import {panels} from "./cursor.js";
import {htmlElement} from "./elements.js";
import {layerNamed, rasterOf} from "./rasters.js";
import {report} from "./report_data.js";
import {display} from "./scales.js";

/** The rasters of `titled`, [[title, names of layers]], as far as the report has them: {groups: [[title, rasters]], all, named}. */
export async function loadGroups(titled) {
  const known = titled.map(([title, names]) => [title, names.map(layerNamed).filter((layer) => layer !== null)])
      .filter(([, layers]) => layers.length > 0);
  const groups = await Promise.all(known.map(async ([title, layers]) => [
    title, await Promise.all(layers.map((layer) => rasterOf(layer, report.grid)))]));
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
  const select = htmlElement("select", {id: "scales"}, htmlElement("option", {value: "limits"}, "reach the limits"),
                             htmlElement("option", {value: "data"}, "show the data only"));
  select.addEventListener("change", () => {
    display.limits = select.value === "limits";
    for (const panel of panels) panel.rescale();
  });
  return htmlElement("div", {class: "controls screen-only"}, htmlElement("label", {}, "colour scales", select));
}

export function appendFigures(section, title, elements) {
  section.append(htmlElement("h3", {}, title), htmlElement("div", {class: "figures"}, ...elements));
}
