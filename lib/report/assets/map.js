// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// A map with axes in metres, north up, a colour bar, the region's outline, and the value under the pointer.

function svgElement(name, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

function htmlElement(name, attributes = {}, ...children) {
  const element = document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  element.append(...children);
  return element;
}

const MAP_MARGIN = {left: 50, right: 66, top: 22, bottom: 40};
let gradientCount = 0;

class MapPanel {
  /** `options`: region (the raster in_region), marks (a mask shown enlarged on the map), points ([{x_m, y_m,
   * text}]), footprint ({x_m, y_m}: its outline there). */
  constructor(raster, options = {}) {
    this.raster = raster;
    this.options = options;
    this.scale = scaleOf(raster);
    this.canvas = htmlElement("canvas", {class: "map", "data-layer": raster.layer.id, role: "img",
                                         "aria-label": raster.layer.title});
    this.svg = svgElement("svg");
    this.plot = htmlElement("div", {class: "plot"}, this.canvas, this.svg);
    this.readout = htmlElement("output", {class: "readout screen-only"});
    this.element = htmlElement("figure", {class: "panel"}, this.caption(), this.plot, this.readout);
    this.plot.addEventListener("pointermove", (event) => this.read(event));
    this.plot.addEventListener("pointerdown", (event) => this.read(event));
    this.plot.addEventListener("pointerleave", () => this.readout.replaceChildren("\u00a0"));
    this.readout.replaceChildren("\u00a0");
    this.width = 0;
    new ResizeObserver(() => this.fit()).observe(this.plot);
  }

  caption() {
    const enlarge = htmlElement("button", {type: "button", class: "enlarge screen-only",
                                           "aria-pressed": "false"}, "enlarge");
    enlarge.addEventListener("click", () => {
      const wide = this.element.classList.toggle("wide");
      enlarge.setAttribute("aria-pressed", String(wide));
      enlarge.textContent = wide ? "reduce" : "enlarge";
    });
    const note = htmlElement("span", {class: "note"}, this.note());
    return htmlElement("figcaption", {}, this.raster.layer.title, enlarge, note);
  }

  note() {
    const {layer} = this.raster;
    if (this.options.note) return this.options.note;
    if (!this.raster.hasValue()) return "no value anywhere";
    if (layer.style === "mask" || layer.style === "flags") return "\u00a0";
    const {unit, factor} = this.scale;
    const range = layer.unit === "m" ?
        `${metresAs(layer.low, unit, factor)} to ${metresAs(layer.high, unit, factor)}` :
        `${layer.low} to ${layer.high} ${layer.unit}`;
    return range + (this.scale.clipped ? "; colours end earlier" : "");
  }

  fit() {
    const width = Math.round(this.plot.clientWidth);
    if (width < 120 || width === this.width) return;
    this.width = width;
    this.draw();
  }

  /** Lays everything out for the present width. */
  draw() {
    const {left, right, top, bottom} = MAP_MARGIN;
    const plotWidth = this.width - left - right;
    this.pixels_per_m = plotWidth / this.raster.width_m;
    const plotHeight = this.raster.height_m * this.pixels_per_m;
    const height = plotHeight + top + bottom;
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${height}`);
    this.svg.replaceChildren();
    Object.assign(this.canvas.style, {
      left: `${100 * left / this.width}%`, top: `${100 * top / height}%`,
      width: `${100 * plotWidth / this.width}%`, height: `${100 * plotHeight / height}%`});
    this.box = {left, top, width: plotWidth, height: plotHeight};
    const ratio = Math.min(3, Math.max(1, window.devicePixelRatio));
    this.canvas.width = Math.max(1, Math.round(plotWidth * ratio));
    this.canvas.height = Math.max(1, Math.round(plotHeight * ratio));
    this.paint(ratio);
    this.drawAxes();
    this.drawRegion();
    this.drawFootprint();
    this.drawPoints();
    if (this.raster.layer.style !== "mask" && this.raster.layer.style !== "flags") this.drawColorBar();
  }

  x(x_m) { return this.box.left + (x_m - this.raster.left_m) * this.pixels_per_m; }
  y(y_m) { return this.box.top + this.box.height - (y_m - this.raster.bottom_m) * this.pixels_per_m; }

  /** The cells that each pixel of a row or column covers: [first, behind the last], of whole cells. */
  spans(pixels, metres, cells, turned) {
    const per_pixel = metres / this.raster.cell_m / pixels;
    return Array.from({length: pixels}, (_, pixel) => {
      const at = turned ? pixels - 1 - pixel : pixel;
      const first = Math.min(cells - 1, Math.floor(at * per_pixel + 1e-9));
      return [first, Math.min(cells, Math.max(first + 1, Math.floor((at + 1) * per_pixel + 1e-9)))];
    });
  }

  paint(ratio) {
    const {width, height} = this.canvas;
    const context = this.canvas.getContext("2d");
    const image = context.createImageData(width, height);
    const cols = this.spans(width, this.raster.width_m, this.raster.cols, false);
    const rows = this.spans(height, this.raster.height_m, this.raster.rows, true);
    const inside = this.options.region?.codes;
    for (let py = 0; py < height; ++py) {
      for (let px = 0; px < width; ++px) {
        const value = blockValue(this.raster, rows[py], cols[px]);
        const judged = !inside || inside[rows[py][0] * this.raster.cols + cols[px][0]] !== 0;
        image.data.set([...this.pixelColor(value, judged), 255], 4 * (py * width + px));
      }
    }
    context.putImageData(image, 0, 0);
    this.paintMarks(context, rows, cols, ratio);
    this.paintRegionEdge(context, rows, cols, ratio);
  }

  pixelColor(value, judged) {
    const {style} = this.raster.layer;
    if (style !== "mask" && style !== "flags") return colorOf(this.scale, value);
    return judged ? [255, 255, 255] : NO_VALUE_COLOR;
  }

  /** Set bins, at least 3 pixels wide: a single bad bin of a large map would be lost. */
  paintMarks(context, rows, cols, ratio) {
    const {style} = this.raster.layer;
    const source = style === "mask" || style === "flags" ? this.raster : this.options.marks;
    if (!source) return;
    const marks = [];
    rows.forEach((row, py) => cols.forEach((col, px) => {
      const bits = blockBits(source, row, col);
      if (bits !== 0) marks.push([px, py, style === "flags" ? failColor(bits) : BLUE]);
    }));
    const paint = (size, colorAt) => {
      for (const [px, py, color] of marks) {
        context.fillStyle = colorAt(color);
        context.fillRect(px - Math.floor((size - 1) / 2), py - Math.floor((size - 1) / 2), size, size);
      }
    };
    const size = Math.round(3 * ratio);
    // On a coloured map: white with a dark edge, seen on any colour.
    if (source !== this.raster) paint(size + 2 * Math.round(ratio), () => INK);
    paint(size, (color) => source === this.raster ? color : "#ffffff");
  }

  /** The border of a region that is neither a circle nor a square. */
  paintRegionEdge(context, rows, cols, ratio) {
    const {region} = this.options;
    if (!region || report.metrics.region.shape !== "mask") return;
    const inside = (row, col) => region.codes[row[0] * region.cols + col[0]] !== 0;
    for (let py = 0; py + 1 < rows.length; ++py) {
      for (let px = 0; px + 1 < cols.length; ++px) {
        const here = inside(rows[py], cols[px]);
        if (here === inside(rows[py + 1], cols[px]) && here === inside(rows[py], cols[px + 1])) continue;
        context.fillStyle = (px + py) % (8 * ratio) < 4 * ratio ? INK : "#ffffff";
        context.fillRect(px, py, ratio, ratio);
      }
    }
  }

  drawAxes() {
    const {left, top, width, height} = this.box;
    const {left_m, bottom_m, width_m, height_m} = this.raster;
    this.svg.append(svgElement("rect", {x: left, y: top, width, height, fill: "none", stroke: INK}));
    for (const {value, text} of ticks(left_m, left_m + width_m, Math.max(2, width / 45))) {
      this.svg.append(svgElement("line", {x1: this.x(value), x2: this.x(value), y1: top + height,
                                          y2: top + height + 4, stroke: INK}),
                      svgElement("text", {x: this.x(value), y: top + height + 17, "text-anchor": "middle"}, text));
    }
    for (const {value, text} of ticks(bottom_m, bottom_m + height_m, Math.max(2, height / 40))) {
      this.svg.append(svgElement("line", {x1: left - 4, x2: left, y1: this.y(value), y2: this.y(value), stroke: INK}),
                      svgElement("text", {x: left - 7, y: this.y(value) + 4, "text-anchor": "end"}, text));
    }
    this.svg.append(
        svgElement("text", {x: left + width / 2, y: top + height + 34, "text-anchor": "middle"}, "x (m)"),
        svgElement("text", {x: left - 7, y: top - 9, "text-anchor": "end"}, "y (m)"));
  }

  drawRegion() {
    const {shape, radius_m, half_width_m} = report.metrics.region;
    if (!this.options.region || shape === "mask") return;
    const half = (radius_m ?? half_width_m) * this.pixels_per_m;
    const outline = (style) => shape === "circle" ?
        svgElement("circle", {cx: this.x(0), cy: this.y(0), r: half, fill: "none", ...style}) :
        svgElement("rect", {x: this.x(0) - half, y: this.y(0) - half, width: 2 * half, height: 2 * half, fill: "none",
                            ...style});
    this.svg.append(outline({stroke: "#ffffff", "stroke-opacity": 0.7}),
                    outline({stroke: INK, "stroke-dasharray": "5 3"}));
  }

  /** At its place on a crop; in the lower left corner of a whole map, to scale. */
  drawFootprint() {
    const {shape, half_bins} = report.footprint;
    const half = (half_bins + 0.5) * report.grid.resolution_m * this.pixels_per_m;
    const {left, top, height} = this.box;
    const place = this.options.footprint;
    if (!place && (half < 1.5 || half > 30)) return;
    const x = place ? this.x(place.x_m) : left + 8 + half;
    const y = place ? this.y(place.y_m) : top + height - 8 - half;
    const outline = () => shape === "disc" ?
        svgElement("circle", {cx: x, cy: y, r: half, fill: "none"}) :
        svgElement("rect", {x: x - half, y: y - half, width: 2 * half, height: 2 * half, fill: "none"});
    for (const [stroke, width] of [["#ffffff", 3], [INK, 1.2]]) {
      const line = outline();
      line.setAttribute("stroke", stroke);
      line.setAttribute("stroke-width", width);
      this.svg.append(line);
    }
    if (place) return;
    this.svg.append(svgElement("text", {x: x + half + 5, y: y + half, class: "haloed"}, "footprint"));
  }

  drawPoints() {
    for (const {x_m, y_m, text} of this.options.points ?? []) {
      const x = this.x(x_m), y = this.y(y_m);
      this.svg.append(svgElement("circle", {cx: x, cy: y, r: 5, fill: "none", stroke: INK, "stroke-width": 1.4}),
                      svgElement("text", {x: x + 7, y: y - 5, class: "haloed"}, text));
    }
  }

  drawColorBar() {
    const {left, top, width, height} = this.box;
    const {colors, low, high, unit, factor, clipped} = this.scale;
    const id = `gradient-${++gradientCount}`;
    const stops = Array.from({length: 33}, (_, k) => svgElement(
        "stop", {offset: k / 32, "stop-color": cssColor(colors[Math.round(255 * k / 32)])}));
    const x = left + width + 12;
    this.svg.append(
        svgElement("defs", {}, svgElement("linearGradient", {id, x1: 0, x2: 0, y1: 1, y2: 0}, ...stops)),
        svgElement("rect", {x, y: top, width: 12, height, fill: `url(#${id})`, stroke: INK}),
        svgElement("text", {x: x + 6, y: top - 9, "text-anchor": "middle"}, unit + (clipped ? " \u2265" : "")));
    const y = (value) => top + height * (1 - (value - low * factor) / ((high - low) * factor));
    const few = this.raster.layer.style === "count" ? Math.min(height / 35, high) : height / 35;
    for (const {value, text} of ticks(low * factor, high * factor, Math.max(2, few))) {
      this.svg.append(svgElement("line", {x1: x + 12, x2: x + 15, y1: y(value), y2: y(value), stroke: INK}),
                      svgElement("text", {x: x + 18, y: y(value) + 4}, text));
    }
    const limit = this.options.limit_m;
    if (limit !== undefined && limit > low && limit < high) {
      this.svg.append(svgElement("line", {x1: x - 4, x2: x + 16, y1: y(limit * factor), y2: y(limit * factor),
                                          stroke: VERMILION, "stroke-width": 3}));
    }
  }

  read(event) {
    const size = this.plot.getBoundingClientRect();
    const zoom = this.width / size.width;
    const x_m = this.raster.left_m + ((event.clientX - size.left) * zoom - this.box.left) / this.pixels_per_m;
    const y_m = this.raster.bottom_m +
        (this.box.top + this.box.height - (event.clientY - size.top) * zoom) / this.pixels_per_m;
    const index = this.raster.indexAt(x_m, y_m);
    const place = `x ${formatNumber(x_m, 0.01)} m, y ${formatNumber(y_m, 0.01)} m: `;
    this.readout.textContent = index < 0 ? "\u00a0" : place + this.valueText(index);
  }

  valueText(index) {
    const value = this.raster.value(index);
    const {style, step} = this.raster.layer;
    if (style === "flags") return failText(value);
    if (Number.isNaN(value)) return "no value";
    if (style === "mask") return value === 0 ? "no" : "yes";
    const {unit, factor} = this.scale;
    return `${formatNumber(factor * value, factor * step)} ${unit}`;
  }
}

/** One value for the cells of a pixel, by the layer's own rule. */
function blockValue(raster, [row0, row1], [col0, col1]) {
  if (row1 - row0 === 1 && col1 - col0 === 1) return raster.value(row0 * raster.cols + col0);
  let result = NaN, count = 0;
  for (let row = row0; row < row1; ++row) {
    for (let col = col0; col < col1; ++col) {
      const value = raster.value(row * raster.cols + col);
      if (Number.isNaN(value)) continue;
      result = count === 0 ? value : chosenOf(raster.layer.rule, result, value);
      ++count;
    }
  }
  return raster.layer.rule === "mean" ? result / count : result;
}

function chosenOf(rule, a, b) {
  switch (rule) {
    case "mean": return a + b;
    case "extreme": return Math.abs(b) > Math.abs(a) ? b : a;
    case "largest": return Math.max(a, b);
    case "least": return Math.min(a, b);
    default: return a | b;
  }
}

/** The bits that any of the cells has. */
function blockBits(raster, [row0, row1], [col0, col1]) {
  let bits = 0;
  for (let row = row0; row < row1; ++row) {
    for (let col = col0; col < col1; ++col) bits |= raster.codes[row * raster.cols + col];
  }
  return bits;
}
