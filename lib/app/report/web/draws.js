// SPDX-License-Identifier: GPL-3.0-or-later

// Fills the sections of the report on a run of draws.

import {axisOf, Chart, SQUARE} from "./chart.js";
import {valuesBar} from "./cursor.js";
import {choiceElement, htmlElement, LINE, tableElement, TEXT_COLOR} from "./elements.js";
import {MapPanel} from "./map.js";
import {appendFigures, gridText, loadGroups} from "./map_pages.js";
import {formatNumber} from "./numbers.js";
import {startPage} from "./page.js";
import {layerNamed, rasterOf} from "./rasters.js";
import {report} from "./report_data.js";
import {NEAR} from "./scales.js";

const CLASSES = 30;       // of a distribution
const MAX_FAILURES = 200;  // in the table
const SUPERSCRIPTS = "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079";
const UNITS = {frac: ["%", 100], bins: ["bins", 1], footprints: ["footprints", 1], m: ["cm", 100], "": ["", 1]};

const shownDraws = report.numbers.length;

function drawNumber(index) { return report.first_draw + index; }

function shownNote() {
  return shownDraws === report.draw_count ? "" : ` Shown are the first ${shownDraws.toLocaleString("en")} draws.`;
}

/** [text, factor] of a unit; one that has no entry is shown by its name. */
function shownUnit(unit) { return UNITS[unit] ?? [unit, 1]; }

function unitText(unit, value) {
  const [text, factor] = shownUnit(unit);
  return factor === 1 ? value.toLocaleString("en") : `${Number((factor * value).toPrecision(4))} ${text}`;
}

// Distributions

/** Equally wide classes of integers or fractions. A single value gets a class about itself. */
function classesOf(values, isWhole) {
  const low = Math.min(...values), high = Math.max(...values);
  if (isWhole) {
    const width = Math.max(1, Math.ceil((high - low + 1) / CLASSES));
    return {low: low - 0.5, width, count: Math.ceil((high - low + 1) / width)};
  }
  const width = high > low ? (high - low) / CLASSES : Math.max(Math.abs(low) / 100, 1e-6);
  return high > low ? {low, width, count: CLASSES} : {low: low - width / 2, width, count: 1};
}

function barsOf({low, width, count}, values) {
  const bars = Array.from({length: count}, (_, k) => ({low: low + k * width, high: low + (k + 1) * width, count: 0}));
  for (const value of values) ++bars[Math.min(count - 1, Math.floor((value - low) / width))].count;
  return bars.filter((bar) => bar.count > 0);
}

/** What a requirement is shown by: the length that decides it, if the draws have one, because a count of footprints that may not be over
 * the limit shows no margin; else its value. {values, label, factor, limit, limitText}, the limit in the unit of the label. */
function shownBy({unit, measured, values, limits, at_least, deciding}) {
  if (deciding) {
    const what = deciding.metrics[0].endsWith("p95_m") ? "95th percentile of the footprints" : "worst footprint";
    const limit = 100 * deciding.limit;
    return {values: deciding.values, label: `${what} (cm)`, factor: 100, limit, limitText: `limit: at most ${Number(limit.toPrecision(4))} cm`};
  }
  const [text, factor] = shownUnit(unit);
  return {values, label: `${measured}${unit === "footprints" || text === "" ? "" : ` (${text})`}`, factor, limit: limits[0] * factor,
          limitText: `limit: at ${at_least ? "least" : "most"} ${unitText(unit, limits[0])}`};
}

function failureCount({pass}) { return pass.reduce((sum, p) => sum + (p === 0 ? 1 : 0), 0); }

/** The largest share of a limit that a draw uses; 0 where the limit is 0. */
function largestUse(requirement) {
  const {values, factor, limit} = shownBy(requirement);
  return limit > 0 && (requirement.deciding || !requirement.at_least) ? Math.max(...values.map((value) => (value ?? 0) * factor / limit)) : 0;
}

/** The requirement that decides first: most failed draws, else nearest to its limit. */
function byDecision() {
  return [...report.requirements].sort((a, b) => failureCount(b) - failureCount(a) || largestUse(b) - largestUse(a));
}

/** How often each value occurred, passed and failed draws in their colours, and the limit. */
function distributionChart(requirement) {
  const {values: measured, label, factor, limit, limitText} = shownBy(requirement);
  const known = measured.map((value, i) => ({value: value * factor, pass: requirement.pass[i] === 1})).filter((_, i) => measured[i] !== null);
  if (known.length === 0) return null;
  const values = known.map(({value}) => value);
  const whole = !requirement.deciding && ["bins", "footprints"].includes(requirement.unit);
  const classes = classesOf(values, whole), end = whole ? limit + (requirement.at_least ? -0.5 : 0.5) : limit;  // whole numbers that are equal to the limit pass
  const all = barsOf(classes, values), passed = barsOf(classes, known.filter(({pass}) => pass).map(({value}) => value));
  const near = end <= NEAR * Math.max(0, ...values);
  const minimum = Math.min(classes.low, near ? end : Infinity), maximum = Math.max(classes.low + classes.count * classes.width, near ? end : -Infinity);
  const room = classes.count === 1 ? Math.max(classes.width, (maximum - minimum) / 4) : 0.04 * (maximum - minimum);  // a single bar would fill the chart
  const chart = new Chart(requirement.name, {low: minimum - room, high: maximum + room, label, whole},
                          {low: 0, high: 1.08 * Math.max(...all.map(({count}) => count)), label: "draws", whole: true});
  const fails = known.some(({pass}) => !pass);
  chart.bars(all, LINE.vermilion).bars(passed, LINE.blue);
  if (passed.length > 0) chart.area("passed", LINE.blue);
  if (fails) chart.area("failed", LINE.vermilion);
  chart.limit(end, limitText, LINE.purple);
  return chart.element;
}

function fillDistributions(section) {
  const charts = byDecision().map(distributionChart).filter((chart) => chart !== null);
  section.append(htmlElement("p", {class: "note"}, `The deciding quantity of each requirement over all draws, worst first.${shownNote()}`),
                 htmlElement("div", {class: "figures"}, ...charts));
}

// Varied keys

/** What may be shown against the keys: [{name, values, factor, label, pass, limit}]. */
function scatterMetrics() {
  const differs = ({values}) => values.some((value) => value !== values[0]);
  const requirements = byDecision().map((requirement) => ({name: requirement.name, pass: requirement.pass, ...shownBy(requirement)})).filter(differs);
  return [...requirements, ...report.metrics.map(({name, values}) => ({name, values, factor: 1, label: name, pass: report.pass, limit: null}))];
}

/** Ranks, the mean of equal ones. */
function ranksOf(values) {
  const order = values.map((value, i) => [value, i]).sort((a, b) => a[0] - b[0]);
  const ranks = new Array(values.length);
  for (let begin = 0; begin < order.length;) {
    let end = begin;
    while (end < order.length && order[end][0] === order[begin][0]) ++end;
    for (let k = begin; k < end; ++k) ranks[order[k][1]] = (begin + end - 1) / 2;
    begin = end;
  }
  return ranks;
}

/** Spearman's correlation; null where one of both is constant. */
function rankCorrelation(a, b) {
  const x = ranksOf(a), y = ranksOf(b), mean = (a.length - 1) / 2;
  const product = (u, v) => u.reduce((sum, value, i) => sum + (value - mean) * (v[i] - mean), 0);
  const norm = Math.sqrt(product(x, x) * product(y, y));
  return norm > 0 ? product(x, y) / norm : null;
}

/** A factor that gives numbers of few digits, and what to add to the label.
 * @returns {[number, string]} */
function shortScale(values) {
  const largest = Math.max(...values.map(Math.abs));
  if (!(largest > 0) || (largest < 1e4 && largest >= 0.01)) return [1, ""];
  const power = 3 * Math.floor(Math.log10(largest) / 3 + 1e-9);
  const superscripts = [...String(power)].map((c) => c === "-" ? "\u207b" : SUPERSCRIPTS[Number(c)]);
  return [10 ** -power, ` (10${superscripts.join("")})`];
}

/** By the number of a draw; others are not judged. */
const OUTCOMES = {0: {color: LINE.vermilion, text: "failed"}, 1: {color: LINE.blue, text: "passed"}};
const UNJUDGED = {color: LINE.sky, text: "not judged"};

function withoutStage(name) { return name.slice(name.indexOf(".") + 1); }

function scatterChart(metric, {name, values}) {
  const [xFactor, xScale] = shortScale(values), [yFactor, yScale] = shortScale(metric.values.map((y) => (y ?? 0) * metric.factor));
  const limit = metric.limit === null ? null : metric.limit * yFactor;
  const points = values.map((x, i) => ({x: x * xFactor, y: metric.values[i] === null ? null : metric.values[i] * metric.factor * yFactor,
                                        outcome: OUTCOMES[metric.pass[i]] ?? UNJUDGED}))
      .filter(({x, y}) => x !== null && y !== null);
  const ys = points.map(({y}) => y), xs = points.map(({x}) => x);
  const near = limit !== null && Math.abs(limit) <= 3 * Math.max(...ys.map(Math.abs));
  const chart = new Chart(withoutStage(name), axisOf(xs, withoutStage(name) + xScale), axisOf(near ? [...ys, limit] : ys, metric.label + yScale));
  const rho = rankCorrelation(xs, ys), rhoOfSize = rankCorrelation(xs.map(Math.abs), ys);
  for (const outcome of [OUTCOMES[1], OUTCOMES[0], UNJUDGED]) {
    const shown = points.filter((point) => point.outcome === outcome);
    if (shown.length > 0) chart.dots(shown.map(({x, y}) => [x, y, 3]), outcome.color, outcome.text);
  }
  if (near) chart.curve([[chart.x.low, limit], [chart.x.high, limit]], {color: LINE.purple, dash: "7 3", text: "limit"});
  const correlations = [["the key", rho], ["its magnitude", xs.some((x) => x < 0) ? rhoOfSize : null]].filter(([, r]) => r !== null);
  chart.legend.append(htmlElement("span", {}, correlations.length === 0 ? "" :
      `rank correlation with ${correlations.map(([text, r]) => `${text} ${formatNumber(r, 0.01)}`).join(", with ")}`));
  return chart.element;
}

function fillCauses(section) {
  const metrics = scatterMetrics();
  if (report.varied.length === 0 || metrics.length === 0) {
    const why = report.varied.length === 0 ? "No key is varied: the draws differ in their random numbers only." : "No metric differs between the draws.";
    section.append(htmlElement("p", {}, why));
    return;
  }
  const figures = htmlElement("div", {class: "figures"});
  const show = (k) => figures.replaceChildren(...report.varied.map((key) => scatterChart(metrics[Number(k)], key)));
  const choice = choiceElement("metric", {id: "metric"}, metrics.map(({name}, k) => [k, name]), show);
  show(0);
  section.append(htmlElement("p", {class: "note"}, `A point for each draw.${shownNote()} A rank correlation near 1 or \u22121 means that the key orders the draws.`),
                 htmlElement("div", {class: "controls screen-only"}, choice), figures);
}

// Failed draws

function missedText(index) {
  return report.requirements.filter(({pass}) => pass[index] === 0).map(({name, unit, values, limits, at_least}) =>
      `${name}: ${unitText(unit, values[index])} ${at_least ? "<" : ">"} ${unitText(unit, limits[index])}`).join("; ");
}

function shortNumber(value) {
  const isSmall = value !== 0 && Math.abs(value) < 1e-3;
  return (isSmall ? value.toExponential(2) : String(Number(value.toPrecision(3)))).replaceAll("-", "\u2212");
}

function valuesText(index) {
  return report.varied.map(({name, values}) => `${name.split(".").slice(-2).join(".")} ${shortNumber(values[index])}`).join(", ");
}

function failureTable(failed) {
  const columns = [["draw", true], ["missed", false], ...(report.varied.length > 0 ? [["values", false]] : [])];
  const rows = failed.slice(0, MAX_FAILURES).map((i) => [
    [String(drawNumber(i)), drawNumber(i)], [missedText(i)],
    ...(report.varied.length > 0 ? [[valuesText(i)]] : [])]);
  return tableElement("failed-draws", columns, rows);
}

/** The chain's commands of a draw: its number and its values, in the digits that give back the same bits. */
function drawCommands(index) {
  const draw = `draw-${drawNumber(index)}`;
  const sets = (stage) => report.varied.filter(({name}) => name.startsWith(`${stage}.`))
      .map(({name, values}) => ` \\\n  --set ${name.slice(stage.length + 1)}=${values[index]}`).join("");
  const makesTerrain = report.stages.terrain !== undefined;
  const terrain = makesTerrain ? `${draw}-terrain.h5` : "terrain.h5";
  const setsNumber = ` --set draw=${report.numbers[index]}`;
  const commands = makesTerrain ? [`terrain-gen -c terrain.json${report.terrain_seeds === "each" ? setsNumber : ""}${sets("terrain")} -o ${terrain}`] : [];
  const ranges = report.traces ? "" : " --ranges-from scan.h5";
  commands.push(`scan-sim -c scan.json${ranges} --terrain ${terrain} \\\n ${setsNumber}${sets("scan")} \\\n  -o ${draw}-scan.h5`,
          `regrid ${draw}-scan.h5 -c regrid.json --terrain ${terrain}${report.uncertainty ? " --uncertainty" : ""}${sets("regrid")} \\\n  -o ${draw}-dem.h5`,
          `dem-eval ${draw}-dem.h5 -c eval.json${sets("eval")} \\\n  --metrics ${draw}-metrics.json -o ${draw}-eval.h5`);
  if (report.stages.hazard !== undefined) {
    commands.push(`hazard-map ${draw}-dem.h5 -c hazard.json --terrain ${terrain}${sets("hazard")} \\\n` +
        `  --sites ${draw}-sites.json --score ${draw}-score.json -o ${draw}-hazards.h5`);
  }
  return commands.join("\n");
}

// Landings

/** @type {[string, string][]} */
const ARMS = [["landing", "with the lidar"], ["blind", "without a lidar"]];

/** The touchdowns of one arm, north up; both arms have the same axes. */
function touchdownChart([arm, title], reach) {
  const {x_m, y_m, safe} = report.landings[arm];
  const points = (isSafe) => x_m.map((x, i) => [x, y_m[i], safe[i] === 1]).filter(([, , each]) => each === isSafe).map(([x, y]) => [x, y, 3]);
  const axis = (label) => ({low: -reach, high: reach, label});
  const chart = new Chart(`touchdowns ${title}`, axis("x (m)"), axis("y (m)"), SQUARE);
  chart.dots(points(true), LINE.blue, "safe").dots(points(false), LINE.vermilion, "not safe");
  if (arm === "landing" && report.reach !== null) {
    chart.curve([...report.reach, ...report.reach.slice(0, 1)], {color: TEXT_COLOR, dash: "6 4", text: "places within reach, as configured", width: 1});
  }
  return chart.element;
}

function landingTable(failed) {
  const {x_m, y_m, slope_deg, roughness_m} = report.landings.landing;
  const number = (value) => value === null ? ["no terrain"] : [shortNumber(value), value];
  const columns = [["draw", true], ["x (m)", true], ["y (m)", true], ["slope (\u00b0)", true], ["roughness (m)", true], ["blind", false]];
  const rows = failed.slice(0, MAX_FAILURES).map((i) => [[String(drawNumber(i)), drawNumber(i)], number(x_m[i]), number(y_m[i]), number(slope_deg[i]),
    number(roughness_m[i]), [report.landings.blind.safe[i] === 1 ? "safe" : "not safe"]]);
  return tableElement("failed-landings", columns, rows);
}

function fillLandings(section) {
  if (report.landings === null) {
    section.remove();
    return;
  }
  const all = ARMS.flatMap(([arm]) => [...report.landings[arm].x_m, ...report.landings[arm].y_m]);
  const reach = 1.1 * Math.max(1, ...all.map(Math.abs));
  section.append(htmlElement("p", {class: "note"}, `Each draw lands at its best site, and without a lidar at the origin, judged on the true terrain.${shownNote()}`),
                 htmlElement("div", {class: "figures"}, ...ARMS.map((arm) => touchdownChart(arm, reach))));
  const failed = report.landings.landing.safe.map((safe, i) => safe === 1 ? -1 : i).filter((i) => i >= 0);
  section.append(htmlElement("h3", {}, "Landings that are not safe"), htmlElement("p", {}, failed.length === 0 ? "All landings with the lidar are safe." :
      `${failed.length.toLocaleString("en")} landings with the lidar are not safe.` +
      `${failed.length > MAX_FAILURES ? ` The table has the first ${MAX_FAILURES}.` : ""} The chain's commands of each draw are below.`));
  if (failed.length > 0) section.append(htmlElement("div", {class: "tall"}, landingTable(failed)));
}

function fillFailures(section) {
  const failed = report.pass.map((pass, i) => pass === 0 ? i : -1).filter((i) => i >= 0);
  const unjudged = report.pass.filter((pass) => pass === -1).length;
  if (unjudged > 0) section.append(htmlElement("p", {}, `${unjudged.toLocaleString("en")} draws are not judged, because the footprint has too few bins.`));
  section.append(htmlElement("p", {}, failed.length === 0 ? "No draw failed." : `${failed.length.toLocaleString("en")} draws failed.` +
      `${failed.length > MAX_FAILURES ? ` The table has the first ${MAX_FAILURES}.` : ""}${shownNote()}`));
  if (failed.length > 0) section.append(htmlElement("div", {class: "tall"}, failureTable(failed)));
  if (report.stages === null) {
    section.append(htmlElement("p", {class: "note"}, "The report of a run over one scan shows the commands of the chain."));
    return;
  }
  const configurations = Object.entries(report.stages).map(([stage, config]) => `cat > ${stage}.json <<'END'\n${JSON.stringify(config)}\nEND`);
  const input = htmlElement("input", {type: "number", id: "draw", min: report.first_draw, max: drawNumber(shownDraws - 1), value: drawNumber(failed[0] ?? 0)});
  const commands = htmlElement("pre", {id: "commands"});
  const show = () => {
    const index = Number(input.value) - report.first_draw;
    if (Number.isInteger(index) && index >= 0 && index < shownDraws) commands.textContent = drawCommands(index);
  };
  input.addEventListener("input", show);
  show();
  section.append(htmlElement("h3", {}, "The same draw by the chain"),
                 htmlElement("p", {class: "note"}, report.traces ? "The metrics are the same, bit for bit." :
                     "scan.h5 and terrain.h5 are the inputs of this run; the metrics are the same, bit for bit."),
                 htmlElement("details", {}, htmlElement("summary", {}, "once: the configurations of the tools"),
                             htmlElement("pre", {id: "configurations"}, configurations.join("\n"))),
                 htmlElement("div", {class: "controls screen-only"}, htmlElement("label", {}, "draw", input)), commands);
}

// Maps

function mapsNote() {
  const {factor} = report.grid;
  return gridText() +
      `${factor === 1 ? "" : `, stored in blocks of ${factor} x ${factor} bins`}. Blocks show their largest probability and error, and their mean spread; where a ` +
      "probability is 0 the shaded terrain is seen. North (y) is up; grey: no value; outlined: the region. Colours of errors end at the 99.5 % quantile.";
}

async function fillMaps(section) {
  if (report.layers.length === 0) {
    section.append(htmlElement("p", {}, "This run was made without maps."));
    return;
  }
  const {groups, all} = await loadGroups();
  const region = await rasterOf(layerNamed("in_region"), report.grid);
  const relief = all.find(({layer}) => layer.style === "elevation") ?? null;
  section.append(htmlElement("p", {class: "note"}, mapsNote()), valuesBar(all));
  for (const [title, rasters] of groups) {
    appendFigures(section, title, rasters.map((raster) => new MapPanel(raster, {region, relief}).element));
  }
}

startPage(() => {
  fillDistributions(document.getElementById("distributions"));
  fillCauses(document.getElementById("causes"));
  fillLandings(document.getElementById("landings"));
  fillFailures(document.getElementById("failures"));
}, () => fillMaps(document.getElementById("maps")));
