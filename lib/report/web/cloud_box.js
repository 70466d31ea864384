// SPDX-License-Identifier: GPL-3.0-or-later

// The box outside of which a cloud is hidden: a field for each end of each axis.

import {buttonElement, htmlElement} from "./elements.js";

const AXES = ["x", "y", "z"];

/** Creates the fields; returns {element, show}, where show(ends) cuts the cloud. */
export function boxFields(view) {
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
    view.draw();
    fill();
  };
  for (const field of fields.flat()) {
    field.addEventListener("change", () => {
      const ends = fields.map((pair) => pair.map((each) => each.valueAsNumber));
      if (ends.flat().some(Number.isNaN)) return fill();
      view.cut(ends);
      view.draw();
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
