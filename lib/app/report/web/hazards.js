// SPDX-License-Identifier: GPL-3.0-or-later

// Fills the sections of the report on a hazard map.

import {Chart} from "./chart.js";
import {setLine, valuesBar} from "./cursor.js";
import {htmlElement, LINE, outlined, swatchEntry, tableElement, TEXT_COLOR} from "./elements.js";
import {MapPanel} from "./map.js";
import {appendFigures, gridText, loadGroups, mapColumns, scaleControl} from "./map_pages.js";
import {counted, formatNumber, lengthUnit, metresAs} from "./numbers.js";
import {startPage} from "./page.js";
import {poseLegend, siteFigures} from "./pose.js";
import {firstLine, ProfileView} from "./profile.js";
import {layerNamed} from "./rasters.js";
import {report} from "./report_data.js";

const TRUTH = {null: "unknown", true: "safe", false: "hazard \u2717"};  // of true_safe
const WITH_SITES = ["safe", "outcome", "p_safe", "p_touchdown", "cost"];

function mapsNote() {
  const {factor, rows, cols} = report.grid;
  const blocks = Math.max(rows, cols) < 200 ? "" :
      ` Where several bins${factor === 1 ? "" : `, at least ${factor} x ${factor},`} share a pixel, it shows the worst value and the mean ` +
          "elevation; classes are averaged.";
  return `${gridText()}.${blocks} North (y) is up; grey: no value; outlined: the region; dashed on the cost: the places within reach. ` +
      "The relief is lit from the north-west. A colour bar of slopes, roughnesses, costs and distances covers 99.5 % of the values, and extends to the " +
      "limit (\u25b8) if that is at most four times as far; a pointed end means that values lie beyond it.";
}

function classLegend({flags}) {
  const entries = flags.map(({text, color, count}) => swatchEntry(
      `${text}: ${count.toLocaleString("en")} (${percentText(count, report.places)})`, {fill: color}));
  return htmlElement("div", {class: "legend flags"}, ...entries);
}

/** The border of the places among which sites are looked for. */
function drawReach(panel) {
  const points = report.reach.map(([x, y]) => `${panel.x(x).toFixed(2)},${panel.y(y).toFixed(2)}`).join(" ");
  panel.clipped(...outlined("polygon", {points, class: "reach"}, {width: 1.3, dash: "6 4"}));
}

function mapOptions({layer}, region, relief) {
  const options = {region, relief};
  if (WITH_SITES.includes(layer.name)) options.points = report.sites.map(({x_m, y_m, rank}) => ({x_m, y_m, text: String(rank)}));
  if (layer.name === "cost") options.draw = drawReach;
  return options;
}

async function fillMaps(section) {
  const {groups, all, named} = await loadGroups();
  const elevation = named("z_est") ?? named("z"), truth = named("z_true");
  section.append(htmlElement("p", {class: "note"}, mapsNote()), valuesBar(all), scaleControl());
  for (const [title, rasters] of groups) {
    appendFigures(section, title, rasters.map((raster) => mapFigure(raster, mapOptions(raster, named("safe"), elevation))));
  }
  const curves = [[truth, LINE.sky, 5], [elevation, LINE.vermilion, 1.5]].filter(([raster]) => raster !== null);
  section.append(new ProfileView(curves, null).element);
  setLine(firstLine(report.grid, report.sites[0]));
}

function mapFigure(raster, options) {
  const {element} = new MapPanel(raster, options);
  if (raster.layer.flags) element.append(classLegend(raster.layer));
  return element;
}

// Sites

function probability(value) {
  return [value === null ? "\u2013" : formatNumber(value, 0.0001), value];
}

/** Where the evidence carries no larger probability. */
function atLeast(value, isCapped) {
  const [text, number] = probability(value);
  return [isCapped ? `\u2265${text}` : text, number];
}

function siteTable(sites) {
  const hasTruth = report.score !== null, hasP = layerNamed("p_safe") !== null;
  /** @type {[string, (site: any) => any[]][]} */
  const all = [["no.", ({rank}) => [String(rank), rank]], ["x (m)", ({x_m}) => [formatNumber(x_m, 0.01), x_m]],
               ["y (m)", ({y_m}) => [formatNumber(y_m, 0.01), y_m]], ["cost", ({cost}) => probability(cost)],
               ["p_touchdown", ({p_touchdown: p, p_safe, p_capped}) => atLeast(p, p_capped && p >= p_safe - 1e-6)],
               ["p_safe", ({p_safe, p_capped}) => atLeast(p_safe, p_capped)],
               ["slope (deg)", ({slope_deg}) => [formatNumber(slope_deg, 0.01), slope_deg]],
               ["roughness (cm)", ({roughness_m}) => [formatNumber(100 * roughness_m, 0.1), roughness_m]],
               ["hazard at (m)", ({distance_to_hazard_m: d}) => [formatNumber(d, 0.01), d ?? 1e300]]];
  const columns = all.filter(([text]) => hasP || !text.startsWith("p_"));
  const onMap = mapColumns(sites);
  const rows = sites.map((site) => [...columns.map(([, cell]) => cell(site)), ...(hasTruth ? [[TRUTH[site.true_safe]]] : []), ...onMap.cellsOf(site)]);
  return tableElement("landing-sites", [...columns.map(([text]) => [text, true]), ...(hasTruth ? [["truth", false]] : []), ...onMap.heads], rows);
}

async function fillSites(section) {
  const {sites} = report;
  if (sites.length === 0) {
    section.append(htmlElement("p", {}, "No landing site: no safe place lies within reach."));
    return;
  }
  section.append(htmlElement("p", {}, sites.length === 1 ? "The safe place of least cost." :
      "Safe places of least cost, the best first."), siteTable(sites));
  if (sites.some((site) => site.p_capped)) {
    section.append(htmlElement("p", {class: "note"}, "\u2265: at least so much; the map's evidence carries no larger probability."));
  }
  const drawn = sites.filter((site) => site.crop && site.poses);
  if (drawn.length === 0) {
    section.append(htmlElement("p", {class: "note", id: "no-poses"}, "This method measures slope and roughness without a pose of the lander."));
    return;
  }
  section.append(poseLegend(drawn[0].poses.roughest.pads.length > 0));
  for (const site of drawn) section.append(htmlElement("div", {class: "crops"}, ...await siteFigures(site)));
}

// Score

function percentText(part, whole = 1) {
  return part === null ? "\u2013" : `${Number((100 * part / whole).toPrecision(3))} %`;
}

/** The ends of a logarithmic axis in percent; 0 is drawn at its low end. */
function percentAxis(values, label) {
  const minimum = Math.min(1, ...values.filter((value) => value > 0));
  return {low: 10 ** Math.floor(Math.log10(minimum) - 1e-9) / 2, high: 150, log: true, label};
}

/** Missed hazards against false alarms for other roughness limits of the map. */
function rocChart({roughness_limit_m, missed_hazard_frac, false_alarm_frac}) {
  const points = roughness_limit_m.map((limit, k) => ({limit, missed: 100 * missed_hazard_frac[k], alarms: 100 * false_alarm_frac[k],
                                                       known: missed_hazard_frac[k] !== null && false_alarm_frac[k] !== null}))
      .filter(({known}) => known);
  if (points.length === 0) return null;
  const chart = new Chart("Other roughness limits of the map", percentAxis(points.map(({alarms}) => alarms), "false alarms (% of the truly safe places)"),
                          percentAxis(points.map(({missed}) => missed), "missed hazards (% of the true hazards)"));
  const at = ({alarms, missed}) => [chart.inside(alarms, chart.x), chart.inside(missed, chart.y)];
  const own = points.find(({limit}) => Math.abs(limit - report.limits.roughness_m) < 1e-9 * report.limits.roughness_m);
  chart.curve(points.map(at), {color: LINE.blue, width: 1}).dots(points.filter((point) => point !== own).map((point) => [...at(point), 3]), LINE.blue, "other limits");
  if (own) chart.dots([[...at(own), 5.5]], LINE.vermilion, `limit ${metresAs(own.limit, ...lengthUnit(own.limit))}`);
  chart.labels([...(own ? [own] : []), ...points].map((point) => [...at(point), metresAs(point.limit, ...lengthUnit(point.limit))]));
  return chart.element;
}

function calibrationChart({p_low, p_high, count, safe_frac}) {
  const points = count.map((n, k) => ({n, middle: (p_low[k] + p_high[k]) / 2, safe: safe_frac[k]})).filter(({safe}) => safe !== null);
  if (points.length === 0) return null;
  const chart = new Chart("Reliability of p_safe", {low: 0, high: 1, label: "p_safe, middle of each class"},
                          {low: -0.03, high: 1.03, label: "share of truly safe places"});
  chart.curve([[0, 0], [1, 1]], {color: TEXT_COLOR, text: "perfectly calibrated", width: 1.2})
      .dots(points.map(({middle, safe}) => [middle, safe, 4.5]), LINE.blue, "found; number of places")
      .labels(points.map(({middle, safe, n}) => [middle, safe, n.toLocaleString("en")]));
  return chart.element;
}

function fillScore(section) {
  const {score} = report;
  if (score === null) {
    section.remove();
    return;
  }
  const compared = report.places - score.counts.unknown;
  section.append(htmlElement("p", {}, `${compared.toLocaleString("en")} places are compared with the truth: ` +
      `${percentText(score.missed_hazard_frac)} of the true hazards are missed, and ${percentText(score.false_alarm_frac)} of the truly ` +
      "safe places are false alarms."));
  const notes = [score.brier === null ? "" : `Brier score of p_safe: ${Number(score.brier.toPrecision(3))}.`,
                 score.filled_truth_bins === 0 ? "" : `${counted(score.filled_truth_bins, "bin")} of the truth, in filled holes, ` +
                     `${score.filled_truth_bins === 1 ? "is a mean" : "are means"} of the surroundings.`];
  const charts = [rocChart(score.roc), calibrationChart(score.reliability)].filter((chart) => chart !== null);
  if (charts.length > 0 && score.roc) notes.push("The limits applied to the true terrain are unchanged; points on an axis of the first diagram have the value 0.");
  section.append(htmlElement("p", {class: "note"}, notes.filter((text) => text !== "").join(" ")));
  section.append(charts.length > 0 ? htmlElement("div", {class: "figures"}, ...charts) :
      htmlElement("p", {}, "No diagram: the true terrain has no hazard, or no safe place."));
}

startPage(() => fillScore(document.getElementById("score")), async () => {
  await fillMaps(document.getElementById("maps"));
  await fillSites(document.getElementById("sites"));
});
