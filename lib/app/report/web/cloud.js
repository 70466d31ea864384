// SPDX-License-Identifier: GPL-3.0-or-later

// A page that shows the points of a scan.

import {CloudView, columnOf, readColumns} from "./cloud_view.js";
import {horizontalColorBar} from "./colorbar.js";
import {buttonElement, choiceElement, htmlElement, swatchEntry} from "./elements.js";
import {counted} from "./numbers.js";
import {HANDLING} from "./orbit_view.js";
import {onThemeChange, startPage} from "./page.js";
import {report} from "./report_data.js";
import {valueText} from "./scales.js";

// The box outside of which a cloud is hidden: a field for each end of each axis.

const AXES = ["x", "y", "z"];

/** Creates the fields; returns {element, show}, where show(ends) cuts the cloud; `recolor` gives the points in it their colours. */
function boxFields(view, recolor) {
  const fields = AXES.map((axis) => ["from", "to"].map((end) => htmlElement(
      "input", {type: "number", step: "any", "aria-label": `${axis} ${end}`})));
  const inside = htmlElement("p", {class: "note", id: "inside", role: "status"});
  const tell = () => {
    inside.textContent = `${view.countInside().toLocaleString("en")} of the ${view.count.toLocaleString("en")} points are in the box.`;
  };
  const fill = () => {
    const decimals = Math.max(0, ...view.columns.map(({layer}) => -Math.floor(Math.log10(layer.step))));
    fields.forEach((pair, axis) => pair.forEach((field, end) => { field.value = view.box[axis][end].toFixed(decimals); }));
    tell();
  };
  const show = (ends) => {
    if (ends) view.cut(ends); else view.openBox();
    recolor();
    fill();
  };
  for (const field of fields.flat()) {
    field.addEventListener("change", () => {
      const ends = fields.map((pair) => pair.map((each) => each.valueAsNumber));
      if (ends.flat().some(Number.isNaN)) return fill();
      view.cut(ends);
      recolor();
      return tell();
    });
  }
  const whole = buttonElement("all points", () => show(null), {id: "whole"});
  const rows = fields.map((pair, axis) => htmlElement("tr", {}, htmlElement("th", {scope: "row"}, AXES[axis]),
                                                      ...pair.map((field) => htmlElement("td", {}, field))));
  const head = htmlElement("tr", {}, ...["box", "from (m)", "to (m)"].map((text) => htmlElement("th", {}, text)));
  const element = htmlElement("div", {class: "readings"}, htmlElement(
      "table", {id: "box"}, htmlElement("thead", {}, head), htmlElement("tbody", {}, ...rows)), whole, inside);
  fill();
  return {element, show};
}

// The point that was clicked on: its values, and the other returns of its pulse, which are lit.

const HINT = "Click on a point to see its values, and the other returns of its pulse.";
const ORDER = ["pulse", "pixel", "return_number", "status", "t", "range_measured", "range_true", "e_range", "x_est", "y_est", "z_est",
               "e_z", "e_horizontal", "intensity"];
const SURROUNDINGS = 0.03;  // half the edge of the box around a point, as a part of the longest side of the cloud

/** The other points of the pulse, those outside of the box too. */
function siblingsOf(pulses, index) {
  const found = [];
  pulses.codes.forEach((code, i) => { if (code === pulses.codes[index] && i !== index) found.push(i); });
  return found;
}

function siblingText(pulses, siblings) {
  if (!pulses) return "The file has no pulse numbers.";
  return `${siblings.length === 0 ? "No other return" : counted(siblings.length, "other return")} of its pulse ` +
      `${siblings.length > 1 ? "are" : "is"} among the points shown${siblings.length > 0 ? ", lit in magenta" : ""}.`;
}

function valueRows(index) {
  const titled = report.layers.filter(({name}) => ORDER.includes(name)).sort((a, b) => ORDER.indexOf(a.name) - ORDER.indexOf(b.name));
  return titled.map((layer) => htmlElement(
      "tr", {"data-column": layer.name}, htmlElement("th", {scope: "row"}, layer.title),
      htmlElement("td", {}, valueText(columnOf(layer.name), index))));
}

/** Creates the table of values; `box` is that of boxFields(). */
function choiceTable(view, box) {
  const element = htmlElement("div", {class: "readings", id: "choice"}, htmlElement("p", {class: "note"}, HINT));
  const showNothing = () => {
    view.light(-1, []);
    element.replaceChildren(htmlElement("p", {class: "note"}, `No point there. ${HINT}`));
  };
  const showPoint = (index) => {
    const pulses = columnOf("pulse");
    const siblings = pulses ? siblingsOf(pulses, index) : [];
    view.light(index, siblings);
    const half = SURROUNDINGS * Math.max(...view.ends.map(([low, high]) => high - low));
    const around = () => box.show(view.placeOf(index).map((value, axis) => [-half, half].map((d) => value + view.middle[axis] + d)));
    element.replaceChildren(
        htmlElement("table", {id: "chosen"}, htmlElement("tbody", {}, ...valueRows(index))),
        htmlElement("p", {class: "note", id: "siblings"}, siblingText(pulses, siblings)),
        htmlElement("div", {class: "controls"}, buttonElement("turn about it", () => view.centre(index)), buttonElement("box around it", around)));
  };
  let clicks = 0;
  view.onClick = (index) => {
    if (index < 0) showNothing(); else showPoint(index);
    element.dataset.clicks = String(++clicks);
  };
  return element;
}

// The page

/** The legend of a column in the box. */
function legendOf(view, column) {
  if (!column.layer.flags) return horizontalColorBar(view.inBox(column));
  const entries = column.layer.flags.map(({text, color, count}) => swatchEntry(`${text}: ${count.toLocaleString("en")}`, {fill: color}));
  return htmlElement("div", {class: "legend"}, htmlElement("span", {}, column.layer.title), ...entries);
}

function controls(view, color) {
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
  const legend = htmlElement("div", {id: "points-legend", class: "orbit-legend"});
  let shown = "z_est";
  const recolor = (name = shown) => {
    shown = name;
    view.show(columnOf(name));
    legend.replaceChildren(legendOf(view, columnOf(name)));
  };
  const layers = report.layers.filter(({style}) => style !== "");
  const color = choiceElement("colour", {id: "color"}, layers.map(({name, title}) => [name, title]), recolor, shown);
  const box = boxFields(view, recolor);
  section.append(controls(view, color), view.canvas, legend, htmlElement("p", {class: "note"}, HANDLING),
                 htmlElement("div", {class: "beside"}, box.element, choiceTable(view, box)));
  recolor();
  onThemeChange(() => view.draw());
}

startPage(() => {}, async () => {
  await readColumns();
  fillCloud(document.getElementById("cloud"));
});
