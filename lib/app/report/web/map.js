// SPDX-License-Identifier: GPL-3.0-or-later

// A map with axes in metres, north up, a colour bar, the region's outline, the common cursor and the profile's line.

import {clippingText, limitText, verticalColorBar} from "./colorbar.js";
import {listenToPointer, panels, placeText, pointing} from "./cursor.js";
import {buttonElement, htmlElement, INK, outlined, svgElement, TEXT_COLOR} from "./elements.js";
import {lengthUnit, metresAs, ticks} from "./numbers.js";
import {fitToElement} from "./page.js";
import {allMarks, blocksOf, loneMarks, MAX_MARKED, pixelShares, stretched} from "./rasters.js";
import {lightOf, reliefColors, reliefFactor, slopesOf} from "./relief.js";
import {report} from "./report_data.js";
import {colorOf, flagColor, MARK_COLOR, markColor, NO_VALUE_COLOR, parseColor, scaleOf, valueText} from "./scales.js";

const MAP_MARGIN = {left: 50, right: 92, top: 22, bottom: 40};
let clipCount = 0;
const TERRAIN_COLOR = [244, 241, 234];
const MIN_LIGHT = 0.85;  // on a probability above 0

export class MapPanel {
  clip;

  /** `options`: region (the raster in_region), marks (a mask whose single bins are shown enlarged on the map), points
   * ([{x_m, y_m, text}]), footprint ({x_m, y_m}: its outline there), note (instead of the range of values), relief (the raster of elevations that
   * shade classes), draw (called with the panel, adds to its svg). */
  constructor(raster, options = {}) {
    this.options = options;
    this.canvas = htmlElement("canvas", {class: "map", "data-layer": raster.layer.id, role: "img", tabindex: "0"});
    this.svg = svgElement("svg");
    this.plot = htmlElement("div", {class: "plot"}, this.canvas, this.svg);
    this.readout = htmlElement("output", {class: "readout screen-only"}, "\u00a0");
    this.title = htmlElement("span");
    this.noteText = htmlElement("span", {class: "note"});
    this.caption = htmlElement("figcaption", {}, this.title, this.enlargeButton(raster.layer), this.noteText);
    this.element = htmlElement("figure", {class: "panel"}, this.caption, this.plot, this.readout);
    this.width = 0;
    this.setRaster(raster);
    panels.push(this);
    listenToPointer(this);
    fitToElement(this, this.plot);
  }

  /** Shows a raster of the same grid. */
  setRaster(raster) {
    this.raster = raster;
    this.title.replaceChildren(raster.layer.title + " ", htmlElement("code", {}, raster.layer.name));
    this.canvas.setAttribute("aria-label", this.title.textContent);
    this.rescale();
  }

  /** Draws again, for example with other ends of the scale. */
  rescale() {
    this.scale = scaleOf(this.raster);
    if (this.width > 0) this.draw();
  }

  enlargeButton({name, title}) {
    const text = (wide) => `${wide ? "reduce" : "enlarge"} ${name}`;
    const button = buttonElement(text(false), () => {
      const wide = this.element.classList.toggle("wide");
      button.setAttribute("aria-pressed", String(wide));
      button.textContent = text(wide);
    }, {class: "enlarge screen-only", "aria-pressed": "false", title});
    return button;
  }

  /** The range of the values, the limit, and what of them the colours show. */
  note() {
    const {layer} = this.raster;
    if (this.options.note) return this.options.note;
    if (!this.raster.hasValue()) return "no value anywhere";
    if (this.isMarks()) return "";
    const [unit, factor] = lengthUnit(Math.max(Math.abs(layer.low), Math.abs(layer.high)));
    const rounded = (value) => Number.isInteger(value) ? value : Number(value.toPrecision(4));
    const range = layer.unit === "m" ?
        `${metresAs(layer.low, unit, factor)} to ${metresAs(layer.high, unit, factor)}` :
        `${rounded(layer.low)} to ${rounded(layer.high)} ${layer.unit}`.trimEnd();
    return [range, clippingText(this.scale), limitText(layer)].filter((text) => text !== "").join("; ");
  }

  isMarks() { return ["mask", "flags", "classes"].includes(this.raster.layer.style); }

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
    this.options.draw?.(this);
    if (!this.isMarks()) this.svg.append(...verticalColorBar(this.raster, this.scale, {x: left + plotWidth + 14, top, height: plotHeight}));
    this.overlay = svgElement("g", {class: "overlay"});
    this.svg.append(this.overlay);
    this.drawOverlay();
  }

  /** Adds elements that end at the border of the map. */
  clipped(...elements) {
    const {left, top, width, height} = this.box;
    this.clip ??= `clip-${++clipCount}`;
    if (!this.svg.querySelector("clipPath")) {
      this.svg.prepend(svgElement("clipPath", {id: this.clip}, svgElement("rect", {x: left, y: top, width, height})));
    }
    this.svg.append(svgElement("g", {"clip-path": `url(#${this.clip})`}, ...elements));
  }

  x(x_m) { return this.box.left + (x_m - this.raster.left_m) * this.pixels_per_m; }
  y(y_m) { return this.box.top + this.box.height - (y_m - this.raster.bottom_m) * this.pixels_per_m; }

  paint(ratio) {
    const {width, height} = this.canvas;
    // All blocks have the same whole number of cells, because uneven blocks would cause a beat pattern.
    const cells = this.raster.width_m / this.raster.cell_m / width;
    const stride = Math.max(1, Math.ceil(cells - 1e-9));
    const marks = this.enlargedMarks(stride, ratio);
    const {style} = this.raster.layer;
    const isAveraged = style === "count" || style === "classes" || (this.isMarks() && marks === null);
    const blocks = blocksOf(this.raster, isAveraged ? 1 : stride);
    const context = this.canvas.getContext("2d");
    const columns = pixelShares(width, this.raster.width_m / blocks.cell_m, blocks.cols);
    const rows = pixelShares(height, this.raster.height_m / blocks.cell_m, blocks.rows).reverse();
    const pixels = stretched(this.blockColors(blocks, isAveraged && style === "mask"), blocks.cols, columns, rows);
    context.putImageData(new ImageData(pixels, width, height), 0, 0);
    if (marks) this.paintMarks(context, marks);
    this.paintRegionEdge(context, ratio);
    this.tell(blocks.stride, isAveraged && cells > 1, marks !== null && marks.length > 0);
  }

  blockColors(blocks, isShare) {
    if (this.raster.layer.style === "elevation") return reliefColors(this.raster, blocks, this.scale);
    if (this.raster.layer.style === "classes") return this.classColors(blocks);
    if (this.raster.layer.style === "shaded_probability") return this.shadedColors(blocks);
    const {region} = this.options;
    const judged = this.isMarks() && region ? blocksOf(region, blocks.stride).values : null;
    const colors = new Float32Array(3 * blocks.values.length);
    blocks.values.forEach((value, i) => colors.set(this.blockColor(value, !judged || judged[i] !== 0, isShare), 3 * i));
    return colors;
  }

  /** `colorsOf(value, light)`: the colour of a block in the light of the ground, 1 where no terrain is given. */
  colorsInLight(blocks, colorsOf) {
    const colors = new Float32Array(3 * blocks.values.length);
    const {relief} = this.options;
    const slopes = relief ? slopesOf(blocksOf(relief, blocks.stride)) : new Float32Array(2 * blocks.values.length).fill(NaN);
    const factor = reliefFactor(slopes);
    blocks.values.forEach((value, i) => colors.set(colorsOf(value, Number.isNaN(slopes[2 * i]) ? 1 : lightOf(slopes, i, factor)), 3 * i));
    return colors;
  }

  classColors(blocks) {
    const ofBits = new Map([[0, NO_VALUE_COLOR]]);
    return this.colorsInLight(blocks, (bits, light) => {
      if (!ofBits.has(bits)) ofBits.set(bits, parseColor(flagColor(this.raster.layer, bits)));
      return ofBits.get(bits).map((part) => Math.min(255, part * light));
    });
  }

  /** Colours of probabilities; the ground has its own colour where the probability is 0. Elsewhere the light is nearly even, so that a colour can
   * be compared with the colour bar. */
  shadedColors(blocks) {
    return this.colorsInLight(blocks, (value, light) => {
      const color = value === 0 ? TERRAIN_COLOR : colorOf(this.scale, value);
      const shade = value === 0 ? light : Math.min(1, Math.max(MIN_LIGHT, light));
      return color.map((part) => Number.isNaN(value) ? NO_VALUE_COLOR[0] : Math.min(255, part * shade));
    });
  }

  /** A mask's value is the share of its bins that are set; `isShare`: the colour shows it. */
  blockColor(value, judged, isShare) {
    if (!this.isMarks()) return colorOf(this.scale, value);
    const base = judged ? [255, 255, 255] : NO_VALUE_COLOR;
    if (value === 0) return base;
    const color = parseColor(markColor(this.raster.layer, value));
    return isShare ? color.map((part, k) => base[k] + value * (part - base[k])) : color;
  }

  /** The marks to be painted, those with at most one neighbour at least 3 pixels wide, because a single bad bin of a large
   * map would not be visible: [{x, y, value, size}]. Null if less than 1 % of the region and of the map must not be hidden by them. */
  enlargedMarks(stride, ratio) {
    const source = this.isMarks() ? this.raster.marks() : this.options.marks;
    const {region} = this.options;
    if (!source || source.marked() >= MAX_MARKED * (region ? region.marked() : source.codes.length)) return null;
    const blocks = blocksOf(source, stride), isClass = source.layer.style === "classes";
    const pixels = this.canvas.width * blocks.cell_m / this.raster.width_m, size = Math.round(3 * ratio);
    if (pixels >= size && !isClass) return [];
    const placed = ({row, col, value}, width) => ({x: (col + 0.5) * pixels, y: this.canvas.height - (row + 0.5) * pixels, value, size: width});
    const lone = pixels >= size ? [] : loneMarks(blocks).map((mark) => placed(mark, size));
    const hasRoom = lone.length * size ** 2 < MAX_MARKED * this.canvas.width * this.canvas.height;
    if (!isClass) return hasRoom ? lone : null;
    // Averaged colours would hide the marks of classes, so that all are painted, and single ones on top.
    return [...allMarks(blocks).map((mark) => placed(mark, Math.max(Math.round(2 * ratio), Math.ceil(pixels)))), ...(hasRoom ? lone : [])];
  }

  paintMarks(context, marks) {
    for (const {x, y, value, size} of marks) {
      context.fillStyle = this.isMarks() ? markColor(this.raster.layer, value) : MARK_COLOR;
      context.fillRect(Math.round(x - size / 2), Math.round(y - size / 2), size, size);
    }
  }

  /** The note on the quantity drawn, and on its reduction from the DEM. */
  tell(stride, averaged, enlarged) {
    const bins = stride * this.raster.factor;
    const marks = this.raster.layer.style === "classes" ? "wrong places on top" :
        this.isMarks() ? "single ones enlarged" : "magenta: single invalid bins, enlarged";
    const texts = [this.note(), bins === 1 ? "" : `blocks of ${bins} x ${bins} bins`, averaged ? "averaged in each pixel" : "", enlarged ? marks : ""];
    this.noteText.textContent = texts.filter((text) => text !== "").join("; ") || "\u00a0";
  }

  /** Paints the border of a region that is neither a circle nor a square. */
  paintRegionEdge(context, ratio) {
    const {region} = this.options;
    if (!region || !["mask", "polygon"].includes(report.region.shape)) return;
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
    this.svg.append(svgElement("rect", {x: left, y: top, width, height, fill: "none", stroke: TEXT_COLOR}));
    for (const {value, text} of ticks(left_m, left_m + width_m, Math.max(2, width / 45))) {
      this.svg.append(svgElement("line", {x1: this.x(value), x2: this.x(value), y1: top + height,
                                          y2: top + height + 4, stroke: TEXT_COLOR}),
                      svgElement("text", {x: this.x(value), y: top + height + 17, "text-anchor": "middle"}, text));
    }
    for (const {value, text} of ticks(bottom_m, bottom_m + height_m, Math.max(2, height / 40))) {
      this.svg.append(svgElement("line", {x1: left - 4, x2: left, y1: this.y(value), y2: this.y(value), stroke: TEXT_COLOR}),
                      svgElement("text", {x: left - 7, y: this.y(value) + 4, "text-anchor": "end"}, text));
    }
    this.svg.append(
        svgElement("text", {x: left + width / 2, y: top + height + 34, "text-anchor": "middle"}, "x (m)"),
        svgElement("text", {x: left - 7, y: top - 9, "text-anchor": "end"}, "y (m)"));
  }

  drawRegion() {
    const {shape, radius_m, half_width_m, center_x_m, center_y_m} = report.region;
    if (!this.options.region || !["circle", "square"].includes(shape)) return;
    const half = (radius_m ?? half_width_m) * this.pixels_per_m;
    const outline = (style) => shape === "circle" ?
        svgElement("circle", {cx: this.x(center_x_m ?? 0), cy: this.y(center_y_m ?? 0), r: half, fill: "none", ...style}) :
        svgElement("rect", {x: this.x(0) - half, y: this.y(0) - half, width: 2 * half, height: 2 * half, fill: "none",
                            ...style});
    this.svg.append(outline({stroke: "#ffffff", "stroke-opacity": 0.7}),
                    outline({stroke: INK, "stroke-dasharray": "5 3"}));
  }

  /** Draws the footprint to scale: at its position on a crop, in the lower left corner of a whole map; none where the page has none. */
  drawFootprint() {
    if (!report.footprint) return;
    const {shape, text, half_bins} = report.footprint;
    const half = (half_bins + 0.5) * report.grid.resolution_m * this.pixels_per_m;
    const {left, top, height} = this.box;
    const place = this.options.footprint;
    if (!place && (half < 1.5 || half > 30)) return;
    const x = place ? this.x(place.x_m) : left + 8 + half;
    const y = place ? this.y(place.y_m) : top + height - 8 - half;
    this.svg.append(...shape === "disc" ? outlined("circle", {cx: x, cy: y, r: half}, {width: 1.2}) :
        outlined("rect", {x: x - half, y: y - half, width: 2 * half, height: 2 * half}, {width: 1.2}));
    if (place) return;
    this.svg.append(svgElement("text", {x: x + half + 5, y: y + half, class: "haloed"}, text));
  }

  /** Draws a circle for each point, with its number next to it where no other circle or number is. The first points
   * are placed first; a point without room gets no number. */
  drawPoints() {
    const places = (this.options.points ?? []).map(({x_m, y_m, text}) => ({x: this.x(x_m), y: this.y(y_m), text}));
    const taken = places.map(({x, y}) => ({left: x - 6, right: x + 6, top: y - 6, bottom: y + 6}));
    const {left, top, width, height} = this.box;
    for (const {x, y, text} of places) {
      this.svg.append(...outlined("circle", {cx: x, cy: y, r: 5}, {width: 1.4}));
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

  /** The position under the pointer, metres; null outside the map. */
  placeOf(event) {
    const size = this.plot.getBoundingClientRect();
    const zoom = this.width / size.width;
    const x_m = this.raster.left_m + ((event.clientX - size.left) * zoom - this.box.left) / this.pixels_per_m;
    const y_m = this.raster.bottom_m +
        (this.box.top + this.box.height - (event.clientY - size.top) * zoom) / this.pixels_per_m;
    return this.raster.indexAt(x_m, y_m) < 0 ? null : {x_m, y_m};
  }

  /** Draws the cursor and the line of the profile, and reads the value at the cursor. */
  drawOverlay() {
    if (!this.overlay) return;
    const {cursor, line} = pointing;
    this.overlay.replaceChildren();
    const stroke = (name, attributes) => this.overlay.append(...outlined(name, attributes));
    const holds = ({x_m, y_m}) => this.raster.indexAt(x_m, y_m) >= 0;
    if (line && holds(line.from) && holds(line.to)) {
      const [x1, y1, x2, y2] = [this.x(line.from.x_m), this.y(line.from.y_m), this.x(line.to.x_m), this.y(line.to.y_m)];
      stroke("line", {x1, y1, x2, y2, class: "profile-line"});
      stroke("circle", {cx: x1, cy: y1, r: 3.5});
    }
    const isInside = cursor !== null && holds(cursor);
    if (isInside) {
      const x = this.x(cursor.x_m), y = this.y(cursor.y_m);
      stroke("path", {class: "cursor", d: `M${x - 11} ${y}h7m8 0h7M${x} ${y - 11}v7m0 8v7`});
    }
    this.readout.textContent = isInside ?
        `${placeText(cursor)}: ${valueText(this.raster, this.raster.indexAt(cursor.x_m, cursor.y_m))}` : "\u00a0";
  }
}
