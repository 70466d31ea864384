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

function colorGradient(id, colors, direction) {
  const stops = Array.from({length: 33}, (_, k) => svgElement(
      "stop", {offset: k / 32, "stop-color": cssColor(colors[Math.round(255 * k / 32)])}));
  return svgElement("defs", {}, svgElement("linearGradient", {id, ...direction}, ...stops));
}

const MAP_MARGIN = {left: 50, right: 66, top: 22, bottom: 40};
let gradientCount = 0;

class MapPanel {
  /** `options`: region (the raster in_region), marks (a mask whose single bins are shown enlarged on the map), points
   * ([{x_m, y_m, text}]), footprint ({x_m, y_m}: its outline there). */
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
    this.blocks = htmlElement("span");
    const note = htmlElement("span", {class: "note"}, this.note(), this.blocks);
    return htmlElement("figcaption", {}, this.raster.layer.title, enlarge, note);
  }

  note() {
    const {layer} = this.raster;
    if (this.options.note) return this.options.note;
    if (!this.raster.hasValue()) return "no value anywhere";
    if (this.isMarks()) return "\u00a0";
    const {unit, factor} = this.scale;
    const range = layer.unit === "m" ?
        `${metresAs(layer.low, unit, factor)} to ${metresAs(layer.high, unit, factor)}` :
        `${layer.low} to ${layer.high} ${layer.unit}`.trimEnd();
    return range + (this.scale.clipped ? "; colours end earlier" : "");
  }

  isMarks() { return ["mask", "flags"].includes(this.raster.layer.style); }

  fit() {
    const width = Math.round(this.plot.clientWidth);
    if (width < 120 || width === this.width) return;
    this.width = width;
    this.draw();
  }

  /** Computes the layout for the current width and draws. */
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
    if (!this.isMarks()) this.drawColorBar();
  }

  x(x_m) { return this.box.left + (x_m - this.raster.left_m) * this.pixels_per_m; }
  y(y_m) { return this.box.top + this.box.height - (y_m - this.raster.bottom_m) * this.pixels_per_m; }

  paint(ratio) {
    const {width, height} = this.canvas;
    // All blocks have the same whole number of cells, because uneven blocks would cause a beat pattern.
    const cells = this.raster.width_m / this.raster.cell_m / width;
    const stride = this.isShaded() ? 1 : Math.max(1, Math.ceil(cells - 1e-9));
    const blocks = blocksOf(this.raster, stride);
    const judged = this.isMarks() && this.options.region ? blocksOf(this.options.region, stride).values : null;
    const colors = new Float32Array(3 * blocks.values.length);
    blocks.values.forEach((value, i) => colors.set(this.blockColor(value, !judged || judged[i] !== 0), 3 * i));
    const context = this.canvas.getContext("2d");
    const columns = pixelShares(width, this.raster.width_m / blocks.cell_m, blocks.cols);
    const rows = pixelShares(height, this.raster.height_m / blocks.cell_m, blocks.rows).reverse();
    context.putImageData(new ImageData(stretched(colors, blocks.cols, columns, rows), width, height), 0, 0);
    this.paintMarks(context, blocks, ratio);
    this.paintRegionEdge(context, ratio);
    this.tellBlocks(stride, this.isShaded() && cells > 1);
  }

  /** Whether a pixel has the mean colour of its cells: the least count, or whether any bin is marked, would look the
   * same everywhere on a map with many gaps. */
  isShaded() {
    const {style} = this.raster.layer;
    return style === "count" || (style === "mask" && !fewMarks(this.raster, this.options.region));
  }

  blockColor(value, judged) {
    const {style} = this.raster.layer;
    if (!this.isMarks()) return colorOf(this.scale, value);
    if (value !== 0) return parseColor(markColor(style, value));
    return judged ? [255, 255, 255] : NO_VALUE_COLOR;
  }

  /** Paints marks of one or two blocks at least 3 pixels wide if marks are few: a single bad bin of a large map would
   * not be visible. */
  paintMarks(context, blocks, ratio) {
    const {style} = this.raster.layer, own = this.isMarks();
    const source = own ? this.raster : this.options.marks;
    if (!source || !fewMarks(source, this.options.region)) return;
    const size = Math.round(3 * ratio);
    const pixels = this.canvas.width * blocks.cell_m / this.raster.width_m;
    if (pixels >= size) return;
    const marks = loneMarks(own ? blocks : blocksOf(source, blocks.stride));
    const paint = (width, colorAt) => {
      for (const {row, col, value} of marks) {
        context.fillStyle = colorAt(value);
        context.fillRect(Math.round((col + 0.5) * pixels - width / 2),
                         Math.round(this.canvas.height - (row + 0.5) * pixels - width / 2), width, width);
      }
    };
    // On a coloured map: white with a dark edge, visible on any colour.
    if (!own) paint(size + 2 * Math.round(ratio), () => INK);
    paint(size, (value) => own ? markColor(style, value) : "#ffffff");
  }

  /** Adds to the note how the drawn map is reduced from the DEM. */
  tellBlocks(stride, averaged) {
    const bins = stride * this.raster.factor;
    this.blocks.textContent = (bins === 1 ? "" : `; blocks of ${bins} x ${bins} bins`) +
        (averaged ? "; averaged in each pixel" : "");
  }

  /** Paints the border of a region that is neither a circle nor a square. */
  paintRegionEdge(context, ratio) {
    const {region} = this.options;
    if (!region || report.metrics.region.shape !== "mask") return;
    const {width, height} = this.canvas;
    const {left_m, bottom_m, width_m, height_m} = this.raster;
    const inside = (px, py) => region.codes[region.indexAt(left_m + (px + 0.5) / width * width_m,
                                                           bottom_m + (1 - (py + 0.5) / height) * height_m)] !== 0;
    for (let py = 0; py + 1 < height; ++py) {
      for (let px = 0; px + 1 < width; ++px) {
        const here = inside(px, py);
        if (here === inside(px, py + 1) && here === inside(px + 1, py)) continue;
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

  /** Draws the footprint to scale: at its position on a crop, in the lower left corner of a whole map. */
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

  /** Draws a circle for each point, with its number beside it where no other circle or number is. The first points
   * are placed first; a point without room gets no number. */
  drawPoints() {
    const places = (this.options.points ?? []).map(({x_m, y_m, text}) => ({x: this.x(x_m), y: this.y(y_m), text}));
    const taken = places.map(({x, y}) => ({left: x - 6, right: x + 6, top: y - 6, bottom: y + 6}));
    const {left, top, width, height} = this.box;
    for (const {x, y, text} of places) {
      for (const stroke of ["#ffffff", INK]) {
        this.svg.append(svgElement("circle", {cx: x, cy: y, r: 5, fill: "none", stroke,
                                              "stroke-width": stroke === INK ? 1.4 : 3.4}));
      }
      const wide = 8 * text.length;
      const boxes = [[7, -16], [-7 - wide, -16], [7, 4], [-7 - wide, 4], [-wide / 2, -20], [-wide / 2, 7]].map(
          ([dx, dy]) => ({left: x + dx, right: x + dx + wide, top: y + dy, bottom: y + dy + 12}));
      const box = boxes.find((b) => b.left >= left && b.right <= left + width && b.top >= top &&
          b.bottom <= top + height && !taken.some((t) => b.left < t.right && t.left < b.right && b.top < t.bottom &&
                                                         t.top < b.bottom));
      if (!box) continue;
      taken.push(box);
      this.svg.append(svgElement("text", {x: box.left, y: box.bottom - 2, class: "haloed number"}, text));
    }
  }

  drawColorBar() {
    const {left, top, width, height} = this.box;
    const {colors, low, high, unit, factor, clipped} = this.scale;
    const id = `gradient-${++gradientCount}`;
    const x = left + width + 12;
    this.svg.append(
        colorGradient(id, colors, {x1: 0, x2: 0, y1: 1, y2: 0}),
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
