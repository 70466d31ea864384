// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// The cases of a study's report: a table of which only the rows that are seen are built, filters, one case in full, and a plot of
// one column against another. All of it comes from the tree in #study-data (report.py).

const study = JSON.parse(document.getElementById("study-data").textContent);
const columnOf = new Map(study.columns.map((column) => [column.name, column]));
const total = study.caseRuns.length;  // cases that the page holds
const collator = new Intl.Collator("en", {numeric: true});

const ROW_HEIGHT = 31;
const ROWS_BESIDE = 20;    // built above and below what is seen
const MOST_CHOICES = 200;  // of a list; an axis of more values has bounds
const MOST_PRINTED = 300;
const VERDICT_CLASS = {pass: "pass", fail: "fail", error: "error"};

const state = {
  shown: study.columns.filter((column) => column.first).map((column) => column.name),
  sort: "case", descending: false, filters: new Map(), point: null, open: null, rows: [], printing: false,
};

// Values and texts

function at(column, row) {
  return "values" in column ? column.values[row] : column.all;
}

function isNumeric(column) {
  column.isNumeric ??= !["verdict", "text", "pass"].includes(column.role) && valuesOf(column).every((v) => v === null || typeof v === "number");
  return column.isNumeric;
}

function valuesOf(column) {
  return "values" in column ? column.values : [column.all];
}

function numberText(value) {
  if (Number.isInteger(value) || Math.abs(value) >= 1e4) return Math.round(value).toLocaleString("en");
  return String(Number(value.toPrecision(4)));
}

/** A value of an axis, with as many digits as tell it from the others. */
function axisText(value, digits) {
  const size = Math.abs(value);
  if (!(size >= 1000 && size < 1e7)) return String(Number(value.toPrecision(digits)));
  return value.toLocaleString("en", {maximumFractionDigits: Math.max(0, digits - 1 - Math.floor(Math.log10(size)))});
}

function text(column, value) {
  if (value === null) return "\u2013";
  if (column.role === "pass") return value ? "pass" : "fail";
  if (typeof value === "number") return column.digits ? axisText(value, column.digits) : column.role === "case" ? String(value) : numberText(value);
  return typeof value === "string" ? value : JSON.stringify(value);
}

function title(column) {
  return column.unit ? `${column.label} [${column.unit}]` : column.label;
}

function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [key, value] of Object.entries(properties)) {
    if (key in element && key !== "list") element[key] = value;
    else element.setAttribute(key, value);
  }
  element.append(...children);
  return element;
}

function verdictMark(word) {
  return make("span", {className: `verdict ${VERDICT_CLASS[word] ?? "unjudged"}`}, word);
}

// Filters and order

function passes(row) {
  if (state.point !== null && !state.point.has(row)) return false;
  for (const [name, accepts] of state.filters) {
    if (!accepts(at(columnOf.get(name), row))) return false;
  }
  return true;
}

function compare(column, a, b) {
  const x = at(column, a), y = at(column, b);
  if (x === null || y === null) return (x === null) - (y === null) || a - b;
  const order = typeof x === "number" && typeof y === "number" ? x - y : collator.compare(String(x), String(y));
  return (state.descending ? -order : order) || a - b;
}

function update() {
  const column = columnOf.get(state.sort);
  state.rows = [...Array(total).keys()].filter(passes).sort((a, b) => compare(column, a, b));
  const held = total < study.count ? ` (the page holds the first ${total.toLocaleString("en")} of ${study.count.toLocaleString("en")})` : "";
  document.getElementById("case-count").textContent =
      `${state.rows.length.toLocaleString("en")} of ${total.toLocaleString("en")} cases${held}${state.point ? ", of one point" : ""}`;
  body.build();
  plot.draw();
}

function choices(column) {
  const values = new Map(valuesOf(column).map((value) => [JSON.stringify(value), value]));
  const ordered = [...values.entries()];
  return isNumeric(column) ? ordered.sort((a, b) => a[1] - b[1]) : ordered;
}

function addChoice(place, column) {
  const select = make("select", {name: column.name}, make("option", {value: ""}, "any"));
  for (const [key, value] of choices(column)) select.append(make("option", {value: key}, text(column, value)));
  select.addEventListener("change", () => {
    if (select.value === "") state.filters.delete(column.name);
    else state.filters.set(column.name, (value) => JSON.stringify(value) === select.value);
    update();
  });
  place.append(make("label", {}, title(column), select));
}

function addBounds(place, column) {
  const [low, high] = ["from", "to"].map((word) => make("input", {type: "number", step: "any", placeholder: word, name: `${column.name} ${word}`}));
  const change = () => {
    const least = low.value === "" ? -Infinity : Number(low.value), most = high.value === "" ? Infinity : Number(high.value);
    state.filters.set(column.name, (value) => value !== null && value >= least && value <= most);
    update();
  };
  low.addEventListener("input", change);
  high.addEventListener("input", change);
  low.setAttribute("aria-label", `${title(column)} from`);
  high.setAttribute("aria-label", `${title(column)} to`);
  place.append(make("span", {}, title(column), " ", low, " ", high));
}

function addFilters() {
  const place = document.getElementById("filters");
  for (const column of study.columns) {
    if (!["verdict", "axis", "repeat"].includes(column.role)) continue;
    const count = choices(column).length;
    if (count < 2) continue;
    if (count <= MOST_CHOICES || !isNumeric(column)) addChoice(place, column);
    else addBounds(place, column);
  }
  const clear = make("button", {type: "button", id: "clear"}, "Show all");
  clear.addEventListener("click", clearFilters);
  place.append(clear);
}

function clearFilters() {
  for (const field of document.querySelectorAll("#filters select, #filters input")) field.value = "";
  state.filters.clear();
  choosePoint(null);
}

function addColumnChoices() {
  const place = document.querySelector("#columns .choices");
  for (const column of study.columns.slice(1)) {
    const box = make("input", {type: "checkbox", checked: column.first, name: column.name});
    box.addEventListener("change", () => {
      state.shown = study.columns.map((c) => c.name)
          .filter((name) => name === column.name ? box.checked : state.shown.includes(name));
      head.build();
      body.build();
    });
    place.append(make("label", {title: column.name}, box, ` ${title(column)}`));
  }
}

// The table

const caseWindow = document.getElementById("case-window");
const table = make("table", {className: "sortable-cases sortable"});
caseWindow.append(table);

const head = {
  build() {
    table.querySelector("colgroup")?.remove();
    table.tHead?.remove();
    const group = make("colgroup"), row = make("tr");
    let sum = 0;
    for (const column of state.shown.map((name) => columnOf.get(name))) {
      const width = columnWidth(column);
      sum += width;
      group.append(make("col", {style: `width: ${width}px`}));
      row.append(this.heading(column));
    }
    table.style.width = `${sum}px`;
    table.prepend(group, make("thead", {}, row));
  },

  heading(column) {
    const cell = make("th", {scope: "col", className: isNumeric(column) ? "number" : "", title: column.name});
    const button = make("button", {type: "button"}, ...breakable(title(column)));
    button.addEventListener("click", () => this.sort(column.name));
    if (state.sort === column.name) cell.setAttribute("aria-sort", state.descending ? "descending" : "ascending");
    cell.dataset.column = column.name;
    cell.append(button);
    return cell;
  },

  sort(name) {
    state.descending = state.sort === name && !state.descending;
    state.sort = name;
    for (const cell of table.tHead.rows[0].cells) {
      if (cell.dataset.column === name) cell.setAttribute("aria-sort", state.descending ? "descending" : "ascending");
      else cell.removeAttribute("aria-sort");
    }
    update();
  },
};

/** The text, breakable after the dots and underscores of a name. */
function breakable(words) {
  return words.split(/(?<=[._])/).flatMap((part, i) => i ? [make("wbr"), part] : [part]);
}

/** Wide enough for the longest value, and for a heading of some four lines. */
function columnWidth(column) {
  const longest = (texts) => texts.reduce((most, value) => Math.max(most, value.length), 0);
  const values = longest(valuesOf(column).map((value) => text(column, value))) + (column.role === "verdict" ? 5 : 0);
  const words = longest(title(column).split(/[ ._]/)) + 3;
  return Math.round(18 + 7.4 * Math.min(40, Math.max(5, values, Math.min(words, 14), Math.ceil(title(column).length / 4))));
}

const body = {
  rows: make("tbody"),
  first: 0,

  build() {
    if (!this.rows.parentNode) table.append(this.rows);
    const seen = Math.ceil(caseWindow.clientHeight / ROW_HEIGHT) || 20;
    const top = Math.floor(caseWindow.scrollTop / ROW_HEIGHT);
    let from = Math.max(0, Math.min(top, state.rows.length - seen) - ROWS_BESIDE), to = Math.min(state.rows.length, top + seen + ROWS_BESIDE);
    if (state.printing) [from, to] = [0, Math.min(state.rows.length, MOST_PRINTED)];
    const shown = state.shown.map((name) => columnOf.get(name));
    const rest = state.printing ? 0 : state.rows.length - to;
    this.rows.replaceChildren(space(from), ...state.rows.slice(from, to).map((row) => caseRow(row, shown)), space(rest));
    this.first = from;
  },
};

function space(count) {
  const cell = make("td", {colSpan: state.shown.length});
  cell.style.height = `${count * ROW_HEIGHT}px`;
  return make("tr", {className: "space", hidden: count === 0}, cell);
}

function caseRow(row, columns) {
  const line = make("tr", {className: row === state.open ? "chosen" : ""});
  line.dataset.case = row;
  for (const column of columns) {
    const value = at(column, row), words = text(column, value);
    const cell = make("td", {className: isNumeric(column) ? "number" : "", title: String(value ?? "")});
    if (column.role === "case") cell.append(make("button", {type: "button"}, words));
    else if (column.role === "verdict" || (column.role === "pass" && value !== null)) cell.append(verdictMark(words));
    else cell.append(words);
    line.append(cell);
  }
  return line;
}

function listenToTable() {
  let waiting = false;
  caseWindow.addEventListener("scroll", () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; keepFocus(() => body.build()); });
  });
  table.addEventListener("click", (event) => {
    const row = event.target.closest("tr[data-case]");
    if (row && event.target.closest("button")) openCase(Number(row.dataset.case));
  });
  caseWindow.addEventListener("keydown", (event) => {
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key];
    const row = event.target.closest?.("tr[data-case]");
    if (!step || !row) return;
    event.preventDefault();
    const next = state.rows[state.rows.indexOf(Number(row.dataset.case)) + step];
    if (next !== undefined) focusCase(next);
  });
}

/** Rows are built anew; the one that had the focus keeps it. */
function keepFocus(build) {
  const row = document.activeElement?.closest?.("tr[data-case]")?.dataset.case;
  build();
  if (row !== undefined) table.querySelector(`tr[data-case="${row}"] button`)?.focus({preventScroll: true});
}

function bringIntoView(row) {
  const place = state.rows.indexOf(row) * ROW_HEIGHT, header = table.tHead.offsetHeight;
  if (place < 0) return;
  const low = caseWindow.scrollTop, high = low + caseWindow.clientHeight - header - ROW_HEIGHT;
  if (place < low) caseWindow.scrollTop = place;
  else if (place > high) caseWindow.scrollTop = place - (high - low);
  body.build();
}

function focusCase(row) {
  bringIntoView(row);
  table.querySelector(`tr[data-case="${row}"] button`)?.focus({preventScroll: true});
}

// One case

/** "range noise 0.0167 m, repeat 3" */
function valuesOfCase(row) {
  return study.columns.filter((column) => ["axis", "repeat"].includes(column.role)).map((column) => {
    const unit = column.unit ? " " + column.unit : "";
    return `${column.label} ${text(column, at(column, row))}${unit}`;
  }).join(", ");
}

function caseName(row) {
  const name = valuesOfCase(row);
  return `Case ${row}` + (name ? `: ${name}` : "");
}

/** A stage's configuration in a case: the first one with what the case changes. */
function configuration(kind, row) {
  const {base, changes} = study.configs[kind];
  const tree = {"": structuredClone(base)};
  for (const [place, ...value] of changes[study.caseConfigs[row][Object.keys(study.configs).indexOf(kind)]]) {
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
  const base = Object.fromEntries(Object.keys(study.configs).map((kind) => [kind, configuration(kind, row)]));
  // A campaign has these from its case.
  for (const kind of base.draws ? ["scan", "regrid", "eval"] : []) delete base.draws[kind];
  const options = study.options.length ? {options: {regrid: study.options}} : {};
  return {title: [study.title, valuesOfCase(row)].filter(Boolean).join(": "), base, ...options};
}

function save(name, tree) {
  const address = URL.createObjectURL(new Blob([JSON.stringify(tree, null, 1) + "\n"], {type: "application/json"}));
  make("a", {href: address, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(address), 1000);
}

function saveButton(label, name, tree) {
  const button = make("button", {type: "button", className: "link"}, label);
  button.addEventListener("click", () => save(name, tree()));
  return button;
}

function smallTable(heads, rows) {
  const line = (tag, cells) => make("tr", {}, ...cells.map((cell) => make(tag, {className: typeof cell === "number" ? "number" : ""},
      cell === null ? "\u2013" : typeof cell === "number" ? numberText(cell) : cell)));
  return make("div", {className: "scroll"}, make("table", {}, make("thead", {}, line("th", heads)),
      make("tbody", {}, ...rows.map((cells) => line("td", cells)))));
}

function requirementRows(row) {
  return study.columns.filter((column) => column.role === "pass" && at(column, row) !== null).map((column) => {
    const name = column.name.split(".")[1];
    const of = (part) => columnOf.has(`requirements.${name}.${part}`) ? at(columnOf.get(`requirements.${name}.${part}`), row) : null;
    return [name.replaceAll("_", " "), of("value"), of("limit"), verdictMark(of("pass") ? "pass" : "fail")];
  });
}

function metricRows(row) {
  return study.columns.filter((column) => ["metric", "drawn"].includes(column.role) && at(column, row) !== null)
      .map((column) => [column.label, at(column, row), column.unit]);
}

function runRows(row) {
  return study.caseRuns[row].map((index) => {
    const [kind, output, seconds, cpu, memory, id] = study.runs[index];
    return [kind, seconds, cpu, memory === null ? null : memory / 1e6, output ?? "not kept", id ?? ""];
  });
}

function folded(heading, ...content) {
  return make("details", {}, make("summary", {}, heading), ...content);
}

function failureOf(row) {
  return study.failures.logs.find(([, , , cases]) => cases.includes(row));
}

function detailOf(row) {
  const parts = [make("h3", {tabIndex: -1}, `${caseName(row)} `, verdictMark(at(columnOf.get("verdict"), row)))];
  const failure = failureOf(row);
  if (failure) parts.push(make("p", {}, `${failure[1]}, ${failure[0]}`), make("pre", {}, failure[2].join("\n") || "no message"));
  if (study.reports[row]) parts.push(make("p", {}, make("a", {href: study.reports[row]}, "The report of this case")));
  const requirements = requirementRows(row);
  if (requirements.length) parts.push(smallTable(["requirement", "value", "limit", "verdict"], requirements));
  parts.push(make("p", {}, saveButton("Save as a study of this case", `${study.name}-case-${row}.json`, () => caseStudy(row))));
  for (const kind of Object.keys(study.configs)) {
    const tree = configuration(kind, row);
    parts.push(folded(`Configuration: ${kind}`, saveButton(`Save ${kind}.json`, `${kind}.json`, () => tree), make("pre", {}, JSON.stringify(tree, null, 1))));
  }
  parts.push(folded("All numbers", smallTable(["metric", "value", "unit"], metricRows(row))));
  parts.push(folded("Runs and files", smallTable(["stage", "time [s]", "CPU time [s]", "memory [MB]", "file", "file_id"], runRows(row))));
  return parts;
}

function openCase(row) {
  if (!(row >= 0 && row < total)) return;
  state.open = row;
  const place = document.getElementById("case-detail");
  const close = make("button", {type: "button", id: "close"}, "Close");
  close.addEventListener("click", () => closeCase(row));
  place.replaceChildren(...detailOf(row), close);
  place.hidden = false;
  bringIntoView(row);
  plot.draw();
  place.querySelector("h3").focus({preventScroll: true});
  place.scrollIntoView({block: "nearest"});
}

function closeCase(row) {
  state.open = null;
  document.getElementById("case-detail").hidden = true;
  plot.draw();
  focusCase(row);
}

// The points' rows

function choosePoint(index) {
  const rows = document.querySelectorAll("table.points tbody tr");
  for (const row of rows) row.classList.toggle("chosen", Number(row.dataset.point) === index);
  state.point = index === null ? null : new Set(study.points[index].cases);
  caseWindow.scrollTop = 0;
  update();
}

function linkPoints() {
  document.querySelectorAll("table.points tbody tr").forEach((row, index) => {
    row.dataset.point = index;
    row.tabIndex = 0;
    const choose = () => choosePoint(row.classList.contains("chosen") ? null : index);
    row.addEventListener("click", choose);
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") choose(); });
  });
}

// The plot

const SVG = "http://www.w3.org/2000/svg";
const FRAME = {width: 900, height: 400, left: 80, right: 16, top: 14, bottom: 52};

function svg(tag, attributes, words) {
  const element = document.createElementNS(SVG, tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (words !== undefined) element.textContent = words;
  return element;
}

/** Some five round numbers within [low, high]. */
function ticks(low, high) {
  const rough = (high - low) / 5, power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].find((factor) => factor * power >= rough) * power;
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high * (1 + 1e-12); ++i) found.push(Number((i * step).toPrecision(12)));
  return found;
}

/** Where values of a column lie between `start` and `end`: numbers in proportion, words side by side. */
function scaleOf(column, rows, start, end, also = []) {
  if (!isNumeric(column)) {
    const words = [...new Set(valuesOf(column).map((value) => text(column, value)))];
    const place = (value) => start + (end - start) * (words.indexOf(text(column, value)) + 0.5) / words.length;
    return {place, ticks: words.slice(0, 12).map((word) => [start + (end - start) * (words.indexOf(word) + 0.5) / words.length, word])};
  }
  let low = Infinity, high = -Infinity;
  for (const value of [...rows.map((row) => at(column, row)), ...also]) {
    if (value !== null) [low, high] = [Math.min(low, value), Math.max(high, value)];
  }
  if (!(low <= high)) [low, high] = [0, 1];
  const margin = (high - low || Math.abs(high) || 1) * 0.05;
  [low, high] = [low - margin, high + margin];
  const place = (value) => start + (end - start) * (value - low) / (high - low);
  return {place, ticks: ticks(low, high).map((value) => [place(value), numberText(value)])};
}

const plot = {
  x: null,
  y: null,

  choose() {
    const numbers = study.columns.filter((column) => ["axis", "metric", "drawn", "time"].includes(column.role) && valuesOf(column).some((v) => v !== null));
    const metrics = numbers.filter((column) => column.role !== "axis");
    this.x = this.select("x", numbers.concat(columnOf.get("case")), numbers[0]);
    this.y = this.select("y", metrics, metrics.find((column) => column.first) ?? metrics[0]);
  },

  select(name, columns, first) {
    const select = make("select", {name: `plot ${name}`, id: `plot-${name}`});
    for (const column of columns) select.append(make("option", {value: column.name, selected: column === first}, title(column)));
    select.addEventListener("change", () => this.draw());
    document.getElementById("plot-controls").append(make("label", {}, name, select));
    return select;
  },

  draw() {
    const x = columnOf.get(this.x.value), y = columnOf.get(this.y.value);
    const rows = state.rows.filter((row) => at(x, row) !== null && at(y, row) !== null);
    const limit = study.metricLimits[y.name] ?? null;
    const across = scaleOf(x, rows, FRAME.left, FRAME.width - FRAME.right);
    const up = scaleOf(y, rows, FRAME.height - FRAME.bottom, FRAME.top, limit === null ? [] : [limit]);
    const picture = svg("svg", {viewBox: `0 0 ${FRAME.width} ${FRAME.height}`, role: "img", "aria-label": `${title(y)} against ${title(x)}`});
    this.axes(picture, across, up, x, y);
    if (limit !== null) {
      const level = up.place(limit);
      picture.append(svg("line", {class: "limit", x1: FRAME.left, x2: FRAME.width - FRAME.right, y1: level, y2: level}));
      picture.append(svg("text", {x: FRAME.width - FRAME.right - 4, y: level - 5, "text-anchor": "end"}, `limit ${numberText(limit)}`));
    }
    for (const row of rows) picture.append(mark(row, across.place(at(x, row)), up.place(at(y, row))));
    if (rows.includes(state.open)) picture.append(svg("circle", {class: "ring", cx: across.place(at(x, state.open)), cy: up.place(at(y, state.open)), r: 9}));
    document.getElementById("plot").replaceChildren(picture);
  },

  axes(picture, across, up, x, y) {
    const bottom = FRAME.height - FRAME.bottom, right = FRAME.width - FRAME.right;
    for (const [place, words] of up.ticks) {
      picture.append(svg("line", {class: "grid", x1: FRAME.left, x2: right, y1: place, y2: place}),
          svg("text", {x: FRAME.left - 6, y: place + 4, "text-anchor": "end"}, words));
    }
    for (const [place, words] of across.ticks) {
      picture.append(svg("line", {class: "grid", x1: place, x2: place, y1: FRAME.top, y2: bottom}),
          svg("text", {x: place, y: bottom + 17, "text-anchor": "middle"}, words));
    }
    picture.append(svg("text", {x: (FRAME.left + right) / 2, y: FRAME.height - 10, "text-anchor": "middle"}, title(x)),
        svg("text", {transform: `translate(16 ${(FRAME.top + bottom) / 2}) rotate(-90)`, "text-anchor": "middle"}, title(y)));
  },
};

/** A ring for what passes, a cross for what fails, a square for the rest. */
function mark(row, x, y) {
  const word = at(columnOf.get("verdict"), row);
  const paths = {pass: `M${x - 4} ${y}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0`, fail: `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`};
  const shape = svg("path", {class: `mark ${word in paths ? word : "unjudged"}`, d: paths[word] ?? `M${x - 3} ${y - 3}h6v6h-6z`, "pointer-events": "all"});
  shape.dataset.case = row;
  shape.append(svg("title", {}, `${caseName(row)}: ${word}`));
  return shape;
}

// Start

function start() {
  addFilters();
  addColumnChoices();
  linkPoints();
  head.build();
  plot.choose();
  listenToTable();
  document.getElementById("plot").addEventListener("click", (event) => {
    const shape = event.target.closest("[data-case]");
    if (shape) openCase(Number(shape.dataset.case));
  });
  for (const [name, printing] of [["beforeprint", true], ["afterprint", false]]) {
    window.addEventListener(name, () => { state.printing = printing; body.build(); });
  }
  window.addEventListener("resize", () => body.build());
  const named = () => { const match = /^#case-(\d+)$/.exec(location.hash); if (match) openCase(Number(match[1])); };
  window.addEventListener("hashchange", named);
  update();
  named();
}

document.addEventListener("DOMContentLoaded", start);
