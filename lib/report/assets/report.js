// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// Fills the sections of the report of an evaluation.

const MAP_GROUPS = [
  ["Elevation and returns", ["z_est", "z_true", "count"]],
  ["Errors of the bins: true minus estimated", ["e_x", "e_y", "e_z"]],
  ["Absolute error: mean over the footprint centred on the bin", ["abs_x", "abs_y", "abs_z"]],
  ["Relative error: quantile of the deviation from that mean", ["rel_x", "rel_y", "rel_z"]],
  ["Coverage and verdict", ["invalid", "fail"]],
];
const BLOCK_TEXT = "of elevations their mean, of errors the one of the largest magnitude, of relative errors the " +
    "largest, of missed requirements all of them; numbers of returns and shares of invalid bins are averaged";

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

function failLegend() {
  const entries = FAIL_FLAGS.map(({bits, text, color, requirement}) => {
    const judged = report.metrics.requirements[requirement].pass !== null;
    const count = judged ? report.fail_count[Math.log2(bits)] : "not judged";
    const sample = svgElement("svg", {viewBox: "0 0 12 12", class: "swatch"},
                              svgElement("rect", {width: 12, height: 12, fill: color}));
    return htmlElement("span", {}, sample, `${text}: ${count}`);
  });
  return htmlElement("div", {class: "legend flags"}, ...entries);
}

function mapsNote() {
  const {factor, rows, cols, resolution_m} = report.grid;
  const size = `${cols} x ${rows} bins of ${Number((resolution_m * 100).toPrecision(6))} cm`;
  const blocks = Math.max(rows, cols) < 200 ? "" :
      ` Blocks of bins, where a map has more bins than pixels, show ${BLOCK_TEXT}` +
          `${factor === 1 ? "" : `, after the least of each ${factor} x ${factor} bins`}.`;
  return `${size}.${blocks} North (y) is up; grey: no value; outlined: the judged region. Errors are true \u2212 estimated. ` +
      "Colours end at the 99.5 % quantile of the magnitudes, or beyond the limit (\u25b8), whichever is larger; a pointed end of a " +
      "colour bar means that values lie beyond it. Elevations are lit from the north-west.";
}

/** A button that alternates a panel between two rasters; where the system asks for less motion, one step a click. */
function blinkButton(panel, rasters) {
  const PERIOD_MS = 700;
  const names = rasters.map(({layer}) => layer.name).join(" / ");
  const button = htmlElement("button", {type: "button", class: "blink screen-only", "aria-pressed": "false"}, `blink ${names}`);
  const step = () => panel.setRaster(rasters[panel.raster === rasters[0] ? 1 : 0]);
  let timer = null;
  button.addEventListener("click", () => {
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
  });
  return button;
}

/** The estimated and the true elevation have one scale. */
function makePeers(rasters) {
  const elevations = rasters.filter(({layer}) => layer.style === "elevation");
  for (const raster of elevations) raster.peers = elevations;
  return elevations;
}

function profileView(rasters) {
  const named = (name) => rasters.find(({layer}) => layer.name === name) ?? null;
  const styles = [["z_true", LINE.sky, 5], ["z_est", LINE.vermilion, 1.5]];
  const elevations = styles.map(([name, ...style]) => [named(name), ...style]).filter(([raster]) => raster !== null);
  return new ProfileView(elevations, named("e_z"));
}

async function fillMaps(section) {
  const shown = MAP_GROUPS.map(([title, names]) => [title, names.map(layerNamed).filter((layer) => layer !== null)]);
  const rasters = await Promise.all(shown.flatMap(([, layers]) => layers).map((layer) => rasterOf(layer, report.grid)));
  const region = await rasterOf(layerNamed("in_region"), report.grid);
  const marks = await rasterOf(layerNamed("invalid"), report.grid);
  const elevations = makePeers(rasters);
  section.append(htmlElement("p", {class: "note"}, mapsNote()), valuesBar(rasters),
                 htmlElement("div", {class: "controls screen-only"}, scaleControl()));
  for (const [title, layers] of shown) {
    if (layers.length === 0) continue;
    const figures = htmlElement("div", {class: "figures"});
    section.append(htmlElement("h3", {}, title), figures);
    for (const layer of layers) {
      const raster = rasters.find((candidate) => candidate.layer === layer);
      const panel = new MapPanel(raster, mapOptions(raster, region, marks));
      if (layer.name === "fail") panel.element.append(failLegend());
      if (layer.name === "z_est" && elevations.length === 2) panel.noteText.before(blinkButton(panel, elevations));
      figures.append(panel.element);
    }
    if (layers[0].style === "elevation") section.append(profileView(rasters).element);
  }
  setLine(firstLine(report.grid, report.worst[0]));
}

function statisticsTable({statistics}) {
  const keys = [["mean", "mean_m"], ["standard deviation", "std_m"], ["root mean square", "rmse_m"],
                ["median", "median_m"], ["NMAD", "nmad_m"], ["LE90", "le90_m"], ["95 % within", "p95_m"]];
  const columns = [["x", "x (cm)"], ["y", "y (cm)"], ["z", "z (cm)"], ["z_corrected", "z, slope-corrected (cm)"]].filter(
      ([name]) => statistics[name]);
  const rows = keys.map(([text, key]) => [[text], ...columns.map(([name]) => centimetres(statistics[name][key]))]);
  return tableElement("statistics", [["of the bins", false], ...columns.map(([, text]) => [text, true])], rows);
}

function fillErrors(section) {
  const axes = Object.entries(report.histograms);
  const charts = [errorChart(axes), absoluteErrorChart(axes), relativeChart(axes, report.limits)];
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
  fillUncertainty(pageSection("uncertainty"));
  fillErrors(pageSection("errors"));
  fillHoles(pageSection("holes"));
  if (report.metrics.requirements.relative_elevation.pass === null) pageSection("worst").remove();
}

async function fillDrawings() {
  await fillMaps(pageSection("maps"));
  await fillTerrainView(pageSection("view-3d"));
  if (pageSection("worst")) await fillWorst(pageSection("worst"));
}

startPage(fillTexts, fillDrawings);
