// SPDX-License-Identifier: GPL-3.0-or-later

// A page that shows the points of a scan.

import {boxFields} from "./cloud_box.js";
import {choiceTable} from "./cloud_choice.js";
import {columnOf} from "./cloud_columns.js";
import {CloudView} from "./cloud_view.js";
import {horizontalColorBar} from "./colorbar.js";
import {buttonElement, choiceElement, htmlElement, swatchEntry} from "./elements.js";
import {HANDLING} from "./orbit_view.js";
import {startPage} from "./page.js";
import {report} from "./report_data.js";
import {onThemeChange} from "./theme.js";

const FIRST_COLORS = ["e_range", "e_z", "z_est"];  // the errors, if the file has the truth

function legendOf(column) {
  if (!column.layer.flags) return horizontalColorBar(column);
  const entries = column.layer.flags.map(({text, color, count}) => swatchEntry(`${text}: ${count.toLocaleString("en")}`, {fill: color}));
  return htmlElement("div", {class: "legend"}, htmlElement("span", {}, column.layer.title), ...entries);
}

function controls(view, legend, first) {
  const layers = report.layers.filter(({style}) => style !== "");
  const color = choiceElement("colour", {id: "color"}, layers.map(({name, title}) => [name, title]), (name) => {
    view.show(columnOf(name));
    legend.replaceChildren(legendOf(columnOf(name)));
  }, first);
  const size = htmlElement("input", {type: "range", id: "dots", min: "-1", max: "1", step: "0.05", value: "0"});
  size.addEventListener("input", () => {
    view.dotScale = 10 ** Number(size.value);
    view.draw();
  });
  return htmlElement("div", {class: "controls"}, color, htmlElement("label", {}, "size of the points", size),
                     buttonElement("reset the view", () => view.reset()));
}

function fillCloud(section) {
  const columns = ["x_est", "y_est", "z_est"].map(columnOf);
  let view;
  try {
    view = new CloudView(columns);
  } catch (error) {
    section.append(htmlElement("p", {}, `This browser has no WebGL 2, which the view needs (${error.message}).`));
    return;
  }
  const first = FIRST_COLORS.find((name) => report.layers.some((layer) => layer.name === name));
  const column = columnOf(first);
  const legend = htmlElement("div", {id: "points-legend", class: "orbit-legend"}, legendOf(column));
  const box = boxFields(view);
  section.append(controls(view, legend, first), view.canvas, legend, htmlElement("p", {class: "note"}, HANDLING),
                 htmlElement("div", {class: "beside"}, box.element, choiceTable(view, box)));
  view.show(column);
  onThemeChange(() => view.draw());
}

startPage(() => {}, () => fillCloud(document.getElementById("cloud")));
