// SPDX-License-Identifier: GPL-3.0-or-later

// A lander that stands at a site in its worst poses: from above on the elevations, and from the side along the level
// direction of its plane, which is a line there.

import {Axis, drawFrame} from "./chart.js";
import {htmlElement, legendEntry, LINE, outlined, svgElement, swatchEntry, VERMILION} from "./elements.js";
import {MapPanel} from "./map.js";
import {formatNumber, lengthUnit, metresAs} from "./numbers.js";
import {fitToElement} from "./page.js";
import {endsOf} from "./profile.js";
import {rasterOf} from "./rasters.js";
import {report} from "./report_data.js";

const SIDE = {height: 260, left: 66, right: 14, top: 14, bottom: 44};
const TERRAIN_FILL = "var(--soft)";
const PLANE = LINE.blue;
const DECIDING = LINE.vermilion;

/** The unit vector up the plane, along which the side view looks across; that of leg 0 on a level plane.
 * @returns {[number, number]} */
function directionOf({east, north, yaw_deg}) {
  const steep = Math.hypot(east, north);
  const yaw = yaw_deg * Math.PI / 180;
  return steep > 1e-9 ? [east / steep, north / steep] : [Math.cos(yaw), Math.sin(yaw)];
}

/** Draws pads, legs, the deciding bin and the direction of the side view on a map. */
function drawPose(panel, site, pose) {
  const {pixels_per_m: scale} = panel;
  const x0 = panel.x(site.x_m), y0 = panel.y(site.y_m);
  const draw = (name, attributes, style) => panel.clipped(...outlined(name, attributes, style));
  const [ux, uy] = directionOf(pose);
  const reach = 0.97 * Math.min(panel.raster.width_m, panel.raster.height_m) / 2 * scale;
  draw("line", {x1: x0 - reach * ux, y1: y0 + reach * uy, x2: x0 + reach * ux, y2: y0 - reach * uy, class: "side-line"}, {width: 1, dash: "5 4"});
  for (const {x_m, y_m, touches} of pose.pads) {
    const place = {cx: panel.x(x_m), cy: panel.y(y_m)};
    draw("line", {x1: x0, y1: y0, x2: place.cx, y2: place.cy, class: "leg"}, {width: 1.4});
    draw("circle", {...place, r: Math.max(3.5, report.lander.pad_diameter_m / 2 * scale), class: touches ? "pad" : "pad hanging",
                    fill: touches ? "#ffffff" : "none"}, {width: 1.6, dash: touches ? "" : "3 2"});
  }
  const half = Math.max(4, report.grid.resolution_m / 2 * scale);
  draw("rect", {x: panel.x(pose.highest.x_m) - half, y: panel.y(pose.highest.y_m) - half, width: 2 * half, height: 2 * half, class: "deciding"},
        {color: VERMILION, width: 2});
  for (const {text, sign} of [{text: "low", sign: -1}, {text: "high", sign: 1}]) {
    const x = x0 + sign * 0.86 * reach * ux, y = y0 - sign * 0.86 * reach * uy;
    panel.svg.append(svgElement("text", {x, y: y + 4, "text-anchor": "middle", class: "haloed"}, text));
  }
}

/** The lowest and the highest ground under the body along the side view: [[distance, low, high]]. */
function terrainUnder(raster, site, [ux, uy]) {
  const radius = report.footprint.width_m / 2 + 1e-9, classes = new Map();
  for (let row = 0; row < raster.rows; ++row) {
    for (let col = 0; col < raster.cols; ++col) {
      const dx = raster.left_m + (col + 0.5) * raster.cell_m - site.x_m, dy = raster.bottom_m + (row + 0.5) * raster.cell_m - site.y_m;
      const z = raster.value(row * raster.cols + col);
      if (Math.hypot(dx, dy) > radius || Number.isNaN(z)) continue;
      const at = Math.round((dx * ux + dy * uy) / raster.cell_m);
      const [low, high] = classes.get(at) ?? [Infinity, -Infinity];
      classes.set(at, [Math.min(low, z), Math.max(high, z)]);
    }
  }
  return [...classes].sort(([a], [b]) => a - b).map(([at, [low, high]]) => [at * raster.cell_m, low, high]);
}

class SideView {
  raster; site; pose; width; x; y;

  constructor(raster, site, pose) {
    Object.assign(this, {raster, site, pose, width: 0});
    this.direction = directionOf(pose);
    this.terrain = terrainUnder(raster, site, this.direction);
    this.svg = svgElement("svg", {role: "img", class: "side", "aria-label": "The lander from the side"});
    this.note = htmlElement("span", {class: "note"});
    this.element = htmlElement("figure", {class: "panel"}, htmlElement("figcaption", {}, "From the side", this.note), this.svg);
    fitToElement(this, this.element);
  }

  /** Position of a point of the map along the view. */
  along({x_m, y_m}) {
    return (x_m - this.site.x_m) * this.direction[0] + (y_m - this.site.y_m) * this.direction[1];
  }

  planeAlong(at_m) {
    const {east, north, centre_z_m} = this.pose, [ux, uy] = this.direction;
    return centre_z_m + east * (at_m * ux) + north * (at_m * uy);
  }

  /** Heights of the limits of roughness above the centre of the plane: one, or one on either side of a fitted plane. */
  limits() {
    const above = report.limits.roughness_m / Math.cos(this.pose.slope_deg * Math.PI / 180);
    return this.pose.pads.length > 0 ? [above] : [above, -above];
  }

  draw() {
    const {left, right, top, bottom, height} = SIDE;
    const {pose} = this;
    const pads = pose.pads.map((pad) => ({...pad, at: this.along(pad)}));
    const pad_m = report.lander.pad_diameter_m / 2;
    const reach = 1.06 * Math.max(report.footprint.width_m / 2, ...pads.map(({at}) => Math.abs(at) + pad_m));
    const heights = [...this.terrain.flatMap(([, low, high]) => [low, high]), this.planeAlong(-reach), this.planeAlong(reach),
                     ...pads.map(({z_m}) => z_m), pose.highest.z_m];
    const [low, high] = endsOf(heights, 0.02);
    const near = this.limits().filter((limit) => pose.centre_z_m + limit < high + 0.5 * (high - low) && pose.centre_z_m + limit > low - 0.5 * (high - low));
    const [minimum, maximum] = endsOf([...heights, ...near.flatMap((limit) => [-reach, reach].map((at) => this.planeAlong(at) + limit))], 0.02);
    this.x = new Axis({low: -reach, high: reach, label: "low to high side of the plane (m)", spacing: 55}, [left, this.width - right]);
    this.y = new Axis({low: minimum, high: maximum, label: "z (m)", spacing: 32}, [height - bottom, top]);
    this.svg.setAttribute("viewBox", `0 0 ${this.width} ${height}`);
    this.svg.replaceChildren();
    drawFrame(this.svg, this.x, this.y);
    this.drawTerrain();
    this.line("plane", reach, 0, {stroke: PLANE, "stroke-width": 2});
    for (const limit of near) this.line("limit", reach, limit, {stroke: LINE.purple, "stroke-width": 1.5, "stroke-dasharray": "7 3"});
    for (const pad of pads) this.drawPad(pad, pad_m);
    this.drawDeciding();
    const stretch = (height - top - bottom) / (maximum - minimum) / ((this.width - left - right) / (2 * reach));
    this.note.textContent = `heights x ${Number(stretch.toPrecision(2))}${near.length > 0 ? "" : "; the limit of the roughness lies beyond"}`;
  }

  point(at, z) { return `${this.x.at(at).toFixed(2)},${this.y.at(z).toFixed(2)}`; }

  drawTerrain() {
    const above = this.terrain.map(([at, , high]) => this.point(at, high));
    const below = this.terrain.map(([at, low]) => this.point(at, low)).reverse();
    this.svg.append(svgElement("polygon", {class: "ground", points: [...above, ...below].join(" "), fill: TERRAIN_FILL, "fill-opacity": 0.35,
                                           stroke: TERRAIN_FILL, "stroke-width": 1}));
  }

  /** A line parallel to the plane. */
  line(name, reach, above, style) {
    const z = (at) => this.planeAlong(at) + above;
    this.svg.append(svgElement("line", {class: name, x1: this.x.at(-reach), y1: this.y.at(z(-reach)), x2: this.x.at(reach),
                                        y2: this.y.at(z(reach)), ...style}));
  }

  /** A pad on the plane and, if it hangs, the ground under it. */
  drawPad({at, z_m, touches}, pad_m) {
    const on = this.planeAlong(at), x = this.x.at(at - pad_m), width = Math.max(4, this.x.at(at + pad_m) - x);
    this.svg.append(svgElement("rect", {class: touches ? "pad" : "pad hanging", x, y: this.y.at(on) - 6, width, height: 6, stroke: PLANE,
                                        "stroke-width": 1.5, fill: touches ? PLANE : "var(--paper)"}));
    if (touches) return;
    this.svg.append(svgElement("line", {x1: x, x2: x + width, y1: this.y.at(z_m), y2: this.y.at(z_m), stroke: TERRAIN_FILL, "stroke-width": 3}),
                    svgElement("line", {x1: x + width / 2, x2: x + width / 2, y1: this.y.at(on), y2: this.y.at(z_m), stroke: PLANE,
                                        "stroke-dasharray": "2 3"}));
  }

  drawDeciding() {
    const {highest, roughness_m} = this.pose;
    const at = this.along(highest), x = this.x.at(at), y = this.y.at(highest.z_m), on = this.y.at(this.planeAlong(at));
    const isLeft = x > (this.x.pixels[0] + this.x.pixels[1]) / 2;
    this.svg.append(svgElement("line", {x1: x, x2: x, y1: y, y2: on, stroke: DECIDING, "stroke-width": 2}),
                    svgElement("circle", {class: "deciding", cx: x, cy: y, r: 4, fill: DECIDING}),
                    svgElement("text", {x: x + (isLeft ? -8 : 8), y: Math.max(this.y.pixels[1] + 14, Math.min(y, on) - 6), "text-anchor": isLeft ? "end" : "start",
                                        class: "haloed"}, metresAs(roughness_m, ...lengthUnit(Math.abs(roughness_m)))));
  }
}

function poseText({slope_deg, roughness_m, yaw_deg, pads}) {
  const yaw = pads.length > 0 ? `yaw ${formatNumber(yaw_deg, 1)} deg; ` : "";
  return `${yaw}slope ${formatNumber(slope_deg, 0.01)} deg, limit ${report.limits.slope_deg} deg; roughness ` +
      `${metresAs(roughness_m, "cm", 100)}, limit ${metresAs(report.limits.roughness_m, "cm", 100)}`;
}

/** "steepest" and "roughest", or one for both. */
function posesOf({steepest, roughest}) {
  if (roughest.pads.length === 0) return [["fitted plane", roughest]];
  const equal = ["yaw_deg", "east", "north"].every((key) => steepest[key] === roughest[key]);
  return equal ? [["steepest and roughest pose", roughest]] : [["steepest pose", steepest], ["roughest pose", roughest]];
}

/** A figure for each worst pose of a site. */
export async function siteFigures(site) {
  const [layer] = site.crop.layers;
  const raster = await rasterOf(layer, site.crop);
  return posesOf(site.poses).map(([name, pose]) => {
    const map = new MapPanel(raster, {footprint: site, draw: (panel) => drawPose(panel, site, pose)});
    const title = `No. ${site.rank} at x ${formatNumber(site.x_m, 0.01)} m, y ${formatNumber(site.y_m, 0.01)} m: ${name}`;
    return htmlElement("div", {class: "crop site", "data-rank": site.rank}, htmlElement("h3", {}, title),
                       htmlElement("p", {class: "note"}, poseText(pose)),
                       htmlElement("div", {class: "pair"}, map.element, new SideView(raster, site, pose).element));
  });
}

export function poseLegend(hasPads) {
  const pad = (text, fill) => swatchEntry(text, {x: 1, y: 3, width: 10, height: 6, stroke: PLANE, "stroke-width": 1.5, fill});
  const entries = [
    swatchEntry("ground under the body, lowest to highest", {fill: TERRAIN_FILL, "fill-opacity": 0.35}),
    legendEntry(hasPads ? "plane of the pads" : "fitted plane", PLANE, ""),
    ...(hasPads ? [pad("pad", PLANE), pad("fourth pad, above its ground", "var(--paper)")] : []),
    swatchEntry("bin that decides the roughness", {fill: DECIDING}, "circle"),
    legendEntry("limit of the roughness", LINE.purple, "7 3"),
  ];
  return htmlElement("div", {}, htmlElement("p", {class: "note"}, "The lander in the poses that decide slope and roughness. The side view looks along " +
      "the level direction of the plane, which is a line there; the dashed line on the map is its horizontal axis."),
                     htmlElement("div", {class: "legend"}, ...entries));
}
