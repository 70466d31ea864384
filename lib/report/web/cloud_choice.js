// SPDX-License-Identifier: GPL-3.0-or-later

// The point that was clicked on: its values, and the other returns of its pulse, which are lit.

import {columnOf} from "./cloud_columns.js";
import {buttonElement, htmlElement} from "./elements.js";
import {counted} from "./numbers.js";
import {report} from "./report_data.js";
import {valueText} from "./scales.js";

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

/** Creates the table of values; `box` is that of cloud_box.js. */
export function choiceTable(view, box) {
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
