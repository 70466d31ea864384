// SPDX-License-Identifier: GPL-3.0-or-later

// Fills the sections of the report of an evaluation.

import {failLegend} from "./colorbar.js";
import {centimetres, fillHoles, fillWorst} from "./crops.js";
import {setLine, valuesBar} from "./cursor.js";
import {buttonElement, htmlElement, LINE, tableElement} from "./elements.js";
import {absoluteErrorChart, errorChart, relativeChart, reliabilityChart, shareChart} from "./error_charts.js";
import {MapPanel} from "./map.js";
import {appendFigures, gridText, loadGroups, scaleControl} from "./map_pages.js";
import {counted, formatNumber, metresAs} from "./numbers.js";
import {startPage} from "./page.js";
import {firstLine, ProfileView} from "./profile.js";
import {layerNamed, rasterOf} from "./rasters.js";
import {report} from "./report_data.js";
import {fillTerrainView} from "./terrain3d.js";

const BLOCK_TEXT = "their mean elevation, their error of largest magnitude, their largest relative error and every missed " +
    "requirement; numbers of returns and shares of invalid bins are averaged";

function mapOptions({layer}, region, marks) {
  const options = {region};
  if (layer.style === "elevation") options.marks = marks;
  const {coverage} = report.metrics;
  if (layer.name === "invalid") {
    options.note = `${counted(coverage.invalid_count, "bin")} in ${counted(coverage.hole_count, "hole")}`;
  }
  if (layer.name === "fail") {
    options.note = "bins and centres of footprints" +
        (report.worst.length > 0 ? "; the worst are numbered where there is room" : "");
    options.points = report.worst.map(({x_m, y_m}, k) => ({x_m, y_m, text: String(k + 1)}));
  }
  return options;
}

function mapsNote() {
  const {factor, rows, cols} = report.grid;
  const blocks = Math.max(rows, cols) < 200 ? "" :
      ` Where several bins${factor === 1 ? "" : `, at least ${factor} x ${factor},`} share a pixel, it shows ${BLOCK_TEXT}.`;
  return `${gridText()}.${blocks} North (y) is up; grey: no value; outlined: the judged region. Errors are true \u2212 estimated. ` +
      "A colour bar covers 99.5 % of the values, and extends to the limit (\u25b8) if that is at most four times as far; a pointed end " +
      "means that values lie beyond it. Elevations are lit from the north-west.";
}

/** A button that alternates a panel between two rasters; where the system asks for less motion, one step a click. */
function blinkButton(panel, rasters) {
  const PERIOD_MS = 700;
  const names = rasters.map(({layer}) => layer.name).join(" / ");
  const step = () => panel.setRaster(rasters[panel.raster === rasters[0] ? 1 : 0]);
  let timer = null;
  const button = buttonElement(`blink ${names}`, () => {
    if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) {
      step();
      return;
    }
    if (timer === null) {
      step();
      timer = setInterval(step, PERIOD_MS);
    } else {
      clearInterval(timer);
      timer = null;
      panel.setRaster(rasters[0]);
    }
    button.setAttribute("aria-pressed", String(timer !== null));
    button.textContent = timer === null ? `blink ${names}` : "stop blinking";
  }, {class: "blink screen-only", "aria-pressed": "false"});
  return button;
}

function profileView(named) {
  const styles = [["z_true", LINE.sky, 5], ["z_est", LINE.vermilion, 1.5]];
  const elevations = styles.map(([name, ...style]) => [named(name), ...style]).filter(([raster]) => raster !== null);
  return new ProfileView(elevations, named("e_z"));
}

async function fillMaps(section) {
  const {groups, all, named} = await loadGroups();
  const region = await rasterOf(layerNamed("in_region"), report.grid);
  const elevations = all.filter(({layer}) => layer.style === "elevation");
  section.append(htmlElement("p", {class: "note"}, mapsNote()), valuesBar(all), scaleControl());
  for (const [title, rasters] of groups) {
    appendFigures(section, title, rasters.map((raster) => mapFigure(raster, mapOptions(raster, region, named("invalid")), elevations)));
    if (rasters[0].layer.style === "elevation") section.append(profileView(named).element);
  }
  setLine(firstLine(report.grid, report.worst[0]));
}

function mapFigure(raster, options, elevations) {
  const panel = new MapPanel(raster, options);
  if (raster.layer.name === "fail") panel.element.append(failLegend());
  if (raster.layer.name === "z_est" && elevations.length === 2) panel.noteText.before(blinkButton(panel, elevations));
  return panel.element;
}

function statisticsTable({statistics}) {
  const keys = [["mean", "mean_m"], ["standard deviation", "std_m"], ["root mean square", "rmse_m"],
                ["median", "median_m"], ["NMAD", "nmad_m"], ["LE90", "le90_m"], ["95 % within", "p95_m"]];
  const names = Object.keys(statistics).filter((name) => statistics[name]?.mean_m !== undefined);
  const rows = keys.map(([text, key]) => [[text], ...names.map((name) => centimetres(statistics[name][key]))]);
  return tableElement("statistics", [["of the bins", false], ...names.map((name) => [`${name} (cm)`, true])], rows);
}

function fillErrors(section) {
  const axes = Object.entries(report.histograms);
  const charts = [errorChart(axes), absoluteErrorChart(axes), relativeChart(axes, report.footprint_limits)];
  const shown = charts.filter((chart) => chart !== null);
  if (shown.length === 0) {
    section.append(htmlElement("p", {}, "No errors: the DEM has no truth, or no bin with an elevation."));
    return;
  }
  section.append(htmlElement("div", {class: "figures"}, ...shown), statisticsTable(report.metrics));
  const {horizontal} = report.metrics.statistics;
  section.append(htmlElement("p", {class: "note"}, `Horizontal: CE90 ${metresAs(horizontal.ce90_m, "cm", 100)}.`));
}

function fillUncertainty(section) {
  const {uncertainty} = report.metrics;
  const kinds = ["absolute", "relative"].filter((kind) => uncertainty?.[kind].count > 0);
  if (kinds.length === 0) {
    section.remove();
    return;
  }
  section.append(htmlElement("p", {}, "The errors compared with the DEM's 1-sigma maps. On the line they agree with the " +
      "predicted sigma; above it they are larger than predicted."));
  for (const kind of kinds) {
    const score = uncertainty[kind];
    const percent = (share) => share === null ? "\u2013" : `${formatNumber(100 * share, 0.01)} %`;
    const charts = [reliabilityChart(`${kind}: errors against sigma`, score.reliability),
                    shareChart(`${kind}: errors within k sigma`, score.within_k_sigma)].filter((c) => c !== null);
    section.append(htmlElement("h3", {}, `${kind[0].toUpperCase()}${kind.slice(1)} error`),
                   htmlElement("p", {class: "note"}, `${counted(score.count, "bin")}; within 1 sigma ${percent(score.within_1_sigma_frac)} ` +
                       `(normal 68.27 %), within 2 ${percent(score.within_2_sigma_frac)} (95.45 %); standard deviation of ` +
                       `error over sigma ${formatNumber(score.std, 0.001)}.`),
                   htmlElement("div", {class: "figures"}, ...charts));
  }
}

function fillTexts() {
  fillUncertainty(document.getElementById("uncertainty"));
  fillErrors(document.getElementById("errors"));
  fillHoles(document.getElementById("holes"));
  if (report.metrics.accuracy.footprint_bins === null) document.getElementById("worst").remove();
}

async function fillDrawings() {
  await fillMaps(document.getElementById("maps"));
  await fillTerrainView(document.getElementById("view-3d"));
  if (document.getElementById("worst")) await fillWorst(document.getElementById("worst"));
}

startPage(fillTexts, fillDrawings);
