// SPDX-License-Identifier: GPL-3.0-or-later

// Fills the sections of the report on a comparison of two files.

import {valuesBar} from "./cursor.js";
import {htmlElement, swatchEntry, tableElement} from "./elements.js";
import {MapPanel} from "./map.js";
import {appendFigures, gridText, loadGroups, scaleControl} from "./map_pages.js";
import {startPage} from "./page.js";
import {report} from "./report_data.js";

const comparison = report.comparison;
const MAX_METRICS = 200;

/** A cell with a number, or "–". */
function numberCell(value) {
  return [typeof value === "number" ? String(Number(value.toPrecision(5))) : "\u2013", value ?? 1e300];
}

function keyText(value) {
  return value === undefined ? "(none)" : typeof value === "string" ? value : JSON.stringify(value);
}

function verdictText(requirement) {
  return requirement?.pass === true ? "pass" : requirement?.pass === false ? "FAIL" : "not judged";
}

/** Adds a table under a heading if it has rows. */
function appendTable(section, title, id, headings, rows) {
  if (rows.length > 0) section.append(htmlElement("h3", {}, title), tableElement(id, headings, rows));
}

function fillNumbers(section) {
  appendTable(section, "Requirements", "requirements", [["requirement", false], ["A", true], ["A", false], ["B", true], ["B", false]],
              (comparison.requirements ?? []).map(({name, a, b}) => [
                [name], numberCell(a?.value), [verdictText(a)], numberCell(b?.value), [verdictText(b)]]));
  appendTable(section, "Draws in pairs", "pairs",
              [["draws that pass", false], ...["both", "only A", "only B", "neither", "McNemar p", "B \u2212 A", "95 %, low", "high"].map((text) => [text, true])],
              (comparison.pairs ?? []).map(({name, both, only_a, only_b, neither, mcnemar_p, difference}) => [
                [name], ...[both, only_a, only_b, neither, mcnemar_p, difference.value, difference.low, difference.high].map(numberCell)]));
  appendTable(section, "Layers, B \u2212 A on the bins that both have", "statistics",
              [["layer", false], ["unit", false], ...["in both", "mean", "std", "NMAD", "5 %", "50 %", "95 %"].map((text) => [text, true])],
              (comparison.layers ?? []).filter((layer) => "mean" in layer).map((layer) => [
                [layer.layer], [layer.unit === "1" ? "" : layer.unit],
                ...["valid_both", "mean", "std", "nmad", "p05", "p50", "p95"].map((key) => numberCell(layer[key]))]));
  appendTable(section, "Layers of classes", "classes", [["layer", false], ["bins", true], ["differ", true]],
              (comparison.layers ?? []).filter((layer) => "differing" in layer).map(
                  ({layer, bins, differing}) => [[layer], numberCell(bins), numberCell(differing)]));
  appendTable(section, "Numbers that differ", "metrics", [["number", false], ["A", true], ["B", true], ["B \u2212 A", true]],
              (comparison.metrics ?? []).filter(({a, b}) => a !== b).slice(0, MAX_METRICS).map(
                  ({metric, a, b, difference}) => [[metric], numberCell(a), numberCell(b), numberCell(difference)]));
}

function mapFigure(raster) {
  const {flags} = raster.layer;
  const panel = new MapPanel(raster, flags ? {note: "\u00a0"} : {});
  if (flags) {
    const entries = flags.map(({text, color, count}) => swatchEntry(`${text}: ${count.toLocaleString("en")}`, {fill: color}));
    panel.element.append(htmlElement("div", {class: "legend flags"}, ...entries));
  }
  return panel.element;
}

async function fillMaps() {
  const section = document.getElementById("maps");
  if (report.layers.length === 0) {
    section.append(htmlElement("p", {}, comparison.not_compared ?? "These files have no map to show."));
    return;
  }
  const {groups, all} = await loadGroups();
  section.append(htmlElement("p", {class: "note"}, `${gridText()} in common. North (y) is up; grey: no value. A and B have one scale.`),
                 valuesBar(all), scaleControl());
  for (const [title, rasters] of groups) {
    const [a, b] = rasters;
    a.peers = [a, b];
    b.peers = a.peers;
    appendFigures(section, title, rasters.map(mapFigure));
  }
}

function fillConfiguration(section) {
  const rows = comparison.configuration.map(({tool, key, a, b}) => [[tool], [key], [keyText(a)], [keyText(b)]]);
  if (rows.length === 0) {
    section.append(htmlElement("p", {}, "No key differs."));
    return;
  }
  section.append(tableElement("keys", [["tool", false], ["key that differs", false], ["A", false], ["B", false]], rows));
}

function fillTexts() {
  fillNumbers(document.getElementById("numbers"));
  fillConfiguration(document.getElementById("configuration"));
}

startPage(fillTexts, fillMaps);
