// SPDX-License-Identifier: GPL-3.0-or-later

// One cursor on all maps, with the values of all layers at it; a line dragged on any map.

import {htmlElement} from "./elements.js";
import {formatNumber} from "./numbers.js";
import {valueText} from "./scales.js";

const MIN_DRAG = 6;  // pixels, so that a click draws no line
export const pointing = {cursor: null, line: null};  // {x_m, y_m}; {from, to}
export const panels = [];                            // all maps of the page
export const lineListeners = [];                     // called with the line when it changes

let overlaysAreDue = false;

/** Draws all overlays with the next frame. */
function updateOverlays() {
  if (overlaysAreDue) return;
  overlaysAreDue = true;
  requestAnimationFrame(() => {
    overlaysAreDue = false;
    for (const panel of panels) panel.drawOverlay();
    showValues();
  });
}

/** Moves the cursor of all maps; null removes it. */
function setCursor(cursor) {
  pointing.cursor = cursor;
  updateOverlays();
}

export function setLine(line) {
  pointing.line = line;
  updateOverlays();
  for (const listener of lineListeners) listener(line);
}

export function listenToPointer(panel) {
  const {plot, canvas} = panel;
  let start = null;
  plot.addEventListener("pointerdown", (event) => {
    const place = panel.placeOf(event);
    start = place && {place, x: event.clientX, y: event.clientY};
    setCursor(place);
    if (place && event.target === canvas) canvas.setPointerCapture(event.pointerId);
  });
  plot.addEventListener("pointermove", (event) => {
    const place = panel.placeOf(event);
    if (place) setCursor(place);
    const isDrag = start && Math.hypot(event.clientX - start.x, event.clientY - start.y) >= MIN_DRAG;
    if (place && isDrag && !panel.options.footprint) setLine({from: start.place, to: place});
  });
  for (const name of ["pointerup", "pointercancel"]) plot.addEventListener(name, () => { start = null; });
  canvas.addEventListener("keydown", (event) => {
    const steps = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
    if (event.key === "Escape") setCursor(null);
    if (!steps[event.key]) return;
    event.preventDefault();
    const {cell_m, left_m, bottom_m, width_m, height_m} = panel.raster;
    const from = pointing.cursor ?? {x_m: left_m + width_m / 2, y_m: bottom_m + height_m / 2};
    const place = {x_m: from.x_m + steps[event.key][0] * cell_m, y_m: from.y_m + steps[event.key][1] * cell_m};
    if (panel.raster.indexAt(place.x_m, place.y_m) >= 0) setCursor(place);
  });
}

let valueRasters = [];  // of all layers of the DEM

/** The bar with the values of all layers at the cursor. */
export function valuesBar(rasters) {
  valueRasters = rasters;
  const values = rasters.map(({layer}) => htmlElement("span", {"data-value-of": layer.name},
                                                      htmlElement("b", {}, layer.name), htmlElement("output", {}, "\u2013")));
  return htmlElement("div", {id: "values", class: "values screen-only", role: "status"},
                     htmlElement("span", {class: "place"}, "Point at a map: the values of all layers appear here."), ...values);
}

function showValues() {
  const bar = document.getElementById("values");
  if (!bar) return;
  const {cursor} = pointing;
  bar.querySelector(".place").textContent = cursor ? placeText(cursor) : "Point at a map: the values of all layers appear here.";
  for (const raster of valueRasters) {
    const index = cursor ? raster.indexAt(cursor.x_m, cursor.y_m) : -1;
    bar.querySelector(`[data-value-of=${raster.layer.name}] output`).textContent = index < 0 ? "\u2013" : valueText(raster, index);
  }
}

export function placeText({x_m, y_m}) {
  return `x ${formatNumber(x_m, 0.01)} m, y ${formatNumber(y_m, 0.01)} m`;
}
