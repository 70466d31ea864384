// SPDX-License-Identifier: GPL-3.0-or-later

// One case of a study in full: requirements, configurations, numbers, runs and files.

import {buttonElement, htmlElement, tableElement} from "./elements.js";
import {report} from "./report_data.js";
import {caseCount, caseName, changed, columnOf, numberText, state, valueAt, valuesOfCase, verdictMark} from "./study_rows.js";
import {bringIntoView, focusCase} from "./study_table.js";

/** A stage's configuration in a case: the first one with the changes of the case. */
function configuration(kind, row) {
  const {base, changes} = report.configs[kind];
  const tree = {"": structuredClone(base)};
  for (const [place, ...value] of changes[report.caseConfigs[row][Object.keys(report.configs).indexOf(kind)]]) {
    let node = tree;
    const path = ["", ...place], last = path.pop();
    for (const key of path) node = node[key];
    if (value.length) node[last] = structuredClone(value[0]);
    else delete node[last];
  }
  return tree[""];
}

/** A study file of the case alone. */
function caseStudy(row) {
  const base = Object.fromEntries(Object.keys(report.configs).map((kind) => [kind, configuration(kind, row)]));
  // A run of draws has these from its case.
  for (const kind of base.draws ? ["scan", "regrid", "eval"] : []) delete base.draws[kind];
  const options = report.options.length ? {options: {regrid: report.options}} : {};
  return {title: [report.title, valuesOfCase(row)].filter(Boolean).join(": "), base, ...options};
}

function saveButton(label, name, tree) {
  return buttonElement(label, () => {
    const address = URL.createObjectURL(new Blob([JSON.stringify(tree(), null, 1) + "\n"], {type: "application/json"}));
    htmlElement("a", {href: address, download: name}).click();
    setTimeout(() => URL.revokeObjectURL(address), 1000);
  }, {class: "link"});
}

/** A table of numbers, texts and elements; a column of numbers is aligned to the right. */
function smallTable(heads, rows) {
  const isNumber = heads.map((_, k) => rows.every((cells) => cells[k] === null || typeof cells[k] === "number"));
  const cell = (value, k) => isNumber[k] ? [value === null ? "\u2013" : numberText(value), value] :
      [value === null ? "\u2013" : typeof value === "number" ? numberText(value) : value];
  return tableElement(null, heads.map((text, k) => [text, isNumber[k]]), rows.map((cells) => cells.map(cell)));
}

function requirementRows(row) {
  return report.columns.filter((column) => column.role === "pass" && valueAt(column, row) !== null).map((column) => {
    const path = column.name.slice(0, -".pass".length);
    const of = (part) => columnOf.has(`${path}.${part}`) ? valueAt(columnOf.get(`${path}.${part}`), row) : null;
    return [path.split(".").slice(-1)[0].replaceAll("_", " "), of("value"), of("limit"), verdictMark(of("pass") ? "pass" : "fail")];
  });
}

function metricRows(row) {
  return report.columns.filter((column) => ["metric", "drawn"].includes(column.role) && valueAt(column, row) !== null)
      .map((column) => [column.label, valueAt(column, row), column.unit]);
}

function runRows(row) {
  return report.caseRuns[row].map((index) => {
    const [kind, output, seconds, cpu, memory, id] = report.runs[index];
    return [kind, seconds, cpu, memory === null ? null : memory / 1e6, output ?? "not kept", id ?? ""];
  });
}

function collapsed(heading, ...content) {
  return htmlElement("details", {}, htmlElement("summary", {}, heading), ...content);
}

function detailOf(row) {
  const parts = [htmlElement("h3", {tabindex: -1}, `${caseName(row)} `, verdictMark(valueAt(columnOf.get("verdict"), row)))];
  const failure = report.failures.logs.find(([, , , cases]) => cases.includes(row));
  if (failure) parts.push(htmlElement("p", {}, `${failure[1]}, ${failure[0]}`), htmlElement("pre", {}, failure[2].join("\n") || "no message"));
  if (report.reports[row]) parts.push(htmlElement("p", {}, htmlElement("a", {href: report.reports[row]}, "The report of this case")));
  const requirements = requirementRows(row);
  if (requirements.length) parts.push(smallTable(["requirement", "value", "limit", "verdict"], requirements));
  parts.push(htmlElement("p", {}, saveButton("Save as a study of this case", `${report.name}-case-${row}.json`, () => caseStudy(row))));
  for (const kind of Object.keys(report.configs)) {
    const tree = configuration(kind, row);
    parts.push(collapsed(`Configuration: ${kind}`, saveButton(`Save ${kind}.json`, `${kind}.json`, () => tree),
                         htmlElement("pre", {}, JSON.stringify(tree, null, 1))));
  }
  parts.push(collapsed("All numbers", smallTable(["metric", "value", "unit"], metricRows(row))));
  parts.push(collapsed("Runs and files", smallTable(["stage", "time [s]", "CPU time [s]", "memory [MB]", "file", "file_id"], runRows(row))));
  return parts;
}

export function openCase(row) {
  if (!(row >= 0 && row < caseCount)) return;
  state.open = row;
  const place = document.getElementById("case-detail");
  place.replaceChildren(...detailOf(row), buttonElement("Close", () => closeCase(row), {id: "close"}));
  place.hidden = false;
  bringIntoView(row);
  changed();
  place.querySelector("h3").focus({preventScroll: true});
  place.scrollIntoView({block: "nearest"});
}

function closeCase(row) {
  state.open = null;
  document.getElementById("case-detail").hidden = true;
  changed();
  focusCase(row);
}
