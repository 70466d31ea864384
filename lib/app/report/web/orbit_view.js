// SPDX-License-Identifier: GPL-3.0-or-later

// The base of 3-D views (WebGL 2): a canvas that is turned, moved and zoomed by mouse, touch and keys.

import {htmlElement} from "./elements.js";
import {parseColor} from "./scales.js";

const ZOOM = 3;       // the distance divided by half the width that is visible at that distance
const FILLED = 0.97;  // the part of the canvas, along x or y, that the hull spans
const FIRST_VIEW = {azimuth: -0.4, tilt: 0.62, zoom: 1, target: [0, 0, 0]};

export const HANDLING = "Drag or use the arrow keys to turn, drag with Shift or the right button to move, + and \u2212 (or Ctrl and the " +
    "wheel) to zoom.";

/** The pixels of a length of 1 at the distance 1. */
export function pixelsAtUnitDistance(width, height) {
  return ZOOM / Math.max(1, width / height) * width / 2;
}

/** Views add: hull, the points that fill the canvas at first, relative to the middle; and draw(). */
export class OrbitView {
  hull = [];
  buffers = new Map();            // of the vertex attributes
  matrix = new Float32Array(16);  // of the last frame
  distance = 1;                   // of the eye from the middle, in the last frame
  eye = [0, 0, 0];                // where it was in the last frame, relative to the middle
  depth = [0, 0];                 // of a point at the distance w: depth[0] + depth[1]/w

  /** `shortest`: the least distance of the eye, as a part of the first one; `first`: what the first view has different. Throws if WebGL 2 is missing. */
  constructor(id, label, vertexShader, fragmentShader, {shortest = 0.05, antialias = true, first = {}} = {}) {
    this.shortest = shortest;
    this.first = {...FIRST_VIEW, ...first};
    this.view = {...this.first, exaggeration: 1};
    this.canvas = htmlElement("canvas", {id, class: "orbit", tabindex: "0", role: "img", "aria-label": label});
    this.gl = this.canvas.getContext("webgl2", {antialias, preserveDrawingBuffer: true});
    if (!this.gl) throw new Error("no WebGL 2");
    this.program = this.link(vertexShader, fragmentShader);
  }

  link(vertexShader, fragmentShader) {
    const {gl} = this;
    const program = gl.createProgram();
    for (const [kind, source] of [[gl.VERTEX_SHADER, vertexShader], [gl.FRAGMENT_SHADER, fragmentShader]]) {
      const shader = gl.createShader(kind);
      gl.shaderSource(shader, source);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
    gl.useProgram(program);
    gl.enable(gl.DEPTH_TEST);
    return program;
  }

  /** Sets the values of a vertex attribute, of `size` numbers each. */
  upload(name, size, data) {
    const {gl} = this;
    const at = gl.getAttribLocation(this.program, name);
    if (!this.buffers.has(name)) this.buffers.set(name, gl.createBuffer());
    gl.bindBuffer(gl.ARRAY_BUFFER, this.buffers.get(name));
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, data instanceof Uint8Array ? gl.UNSIGNED_BYTE : gl.FLOAT,
                           data instanceof Uint8Array, 0, 0);
  }

  draw() {}

  /** Clears the canvas and sets the uniform `projection`. Returns the size of the canvas in pixels. */
  beginFrame() {
    const {gl, canvas} = this;
    const ratio = Math.min(2, Math.max(1, window.devicePixelRatio));
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio));
    const height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, {width, height});
    gl.viewport(0, 0, width, height);
    const paper = parseColor(getComputedStyle(canvas).getPropertyValue("--shade").trim());
    gl.clearColor(...paper.map((part) => part / 255), 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    Object.assign(this, viewMatrix(this.view, this.hull, width / height));
    gl.uniformMatrix4fv(gl.getUniformLocation(this.program, "projection"), false, this.matrix);
    return {width, height};
  }

  turn(azimuth, tilt) {
    this.view.azimuth += azimuth;
    this.view.tilt = Math.min(Math.PI / 2, Math.max(0.05, this.view.tilt + tilt));
    this.draw();
  }

  zoom(factor) {
    this.view.zoom = Math.min(4, Math.max(this.shortest, this.view.zoom * factor));
    this.draw();
  }

  /** Moves the view by pixels of the page to the right and down. */
  move(right_px, down_px) {
    const {clientWidth, clientHeight} = this.canvas;
    const scale = this.distance / pixelsAtUnitDistance(clientWidth, clientHeight);
    const {right, up} = axesOf(this.view);
    this.view.target = this.view.target.map((value, k) => value + scale * (down_px * up[k] - right_px * right[k]));
    this.draw();
  }

  reset() {
    Object.assign(this.view, this.first);
    this.draw();
  }

  listen() {
    new ResizeObserver(() => this.draw()).observe(this.canvas);
    const pointers = new Map();
    const ends = () => {
      const [a, b] = [...pointers.values()];
      return {apart: Math.hypot(a.x - b.x, a.y - b.y), x: (a.x + b.x) / 2, y: (a.y + b.y) / 2};
    };
    this.canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    this.canvas.addEventListener("pointerdown", (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
    });
    this.canvas.addEventListener("pointermove", (event) => {
      const before = pointers.get(event.pointerId);
      if (!before) return;
      const two = pointers.size === 2 ? ends() : null;
      pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
      if (two) {
        const now = ends();
        this.move(now.x - two.x, now.y - two.y);
        this.zoom(two.apart / Math.max(1, now.apart));
      } else if (event.shiftKey || event.buttons > 1) {
        this.move(event.clientX - before.x, event.clientY - before.y);
      } else if (pointers.size === 1) {
        this.turn((before.x - event.clientX) / 200, (event.clientY - before.y) / 200);
      }
    });
    for (const name of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(name, (event) => pointers.delete(event.pointerId));
    }
    this.canvas.addEventListener("wheel", (event) => {
      if (!event.ctrlKey && document.activeElement !== this.canvas) return;  // otherwise the wheel scrolls the page
      event.preventDefault();
      this.zoom(Math.exp(event.deltaY / 600));
    }, {passive: false});
    const arrows = {ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1]};
    this.canvas.addEventListener("keydown", (event) => {
      const arrow = arrows[event.key];
      const factor = {"+": 0.9, "-": 1 / 0.9}[event.key];
      if (!arrow && !factor) return;
      event.preventDefault();
      if (factor) this.zoom(factor);
      else if (event.shiftKey) this.move(40 * arrow[0], 40 * arrow[1]);
      else this.turn(0.1 * arrow[0], 0.1 * arrow[1]);
    });
  }
}

/** The axes of the screen: to the right, up, and back to the eye. */
function axesOf({azimuth, tilt}) {
  const [ca, sa, ct, st] = [Math.cos(azimuth), Math.sin(azimuth), Math.cos(tilt), Math.sin(tilt)];
  return {right: [ca, sa, 0], up: [-st * sa, st * ca, ct], back: [sa * ct, -ca * ct, st]};
}

/** {matrix, distance, depth, eye}: the matrix transforms coordinates relative to the middle to screen coordinates, column-major. The
 * eye looks from `tilt` above the horizon, `azimuth` from the south, counter-clockwise, and is so far away that `hull`
 * fills the canvas; then the distance is multiplied by `zoom`, and `target` takes the place of the middle. */
function viewMatrix(view, hull, aspect) {
  const {right, up, back} = axesOf(view);
  const {zoom, exaggeration, target} = view;
  const sx = ZOOM / Math.max(1, aspect), sy = sx * aspect;
  const dot = (axis, [x, y, z]) => axis[0] * x + axis[1] * y + axis[2] * z * exaggeration;
  const along = (axis) => axis[0] * target[0] + axis[1] * target[1] + axis[2] * target[2];
  const seen = hull.map((point) => [dot(right, point), dot(up, point), dot(back, point)]);
  const {shift, away} = fittedView(seen, sx, sy);
  const distance = away * zoom, ahead = distance + along(back);
  const size = Math.max(...seen.map((point) => Math.hypot(...point))) + Math.hypot(...shift);
  const near = Math.max(ahead - size, size / 500) / 2, far = ahead + 2 * size;
  const a = (far + near) / (near - far), b = 2 * far * near / (near - far);
  const matrix = [];
  for (let k = 0; k < 3; ++k) {
    // Heights are exaggerated by the shader.
    matrix.push(sx * right[k], sy * up[k], a * back[k], -back[k]);
  }
  matrix.push(-sx * (shift[0] + along(right)), -sy * (shift[1] + along(up)), -a * ahead + b, ahead);
  const eye = [0, 1, 2].map((k) => right[k] * (shift[0] + along(right)) + up[k] * (shift[1] + along(up)) + back[k] * ahead);
  return {matrix: new Float32Array(matrix), distance, depth: [-a, b], eye};
}

/** The shift [to the right, up] and the distance of the eye with which points (right, up, towards the eye) span the part
 * FILLED of the canvas and lie in its middle. */
function fittedView(seen, sx, sy) {
  const shift = [0, 0];
  let away = 0;
  for (let round = 0; round < 40; ++round) {
    away = Math.max(...seen.map(([x, y, z]) => z + Math.max(sx * Math.abs(x - shift[0]), sy * Math.abs(y - shift[1])) / FILLED));
    // Moves the middle of what is seen to the middle of the canvas; a longer step would swing about it.
    const nearest = away - Math.max(...seen.map((point) => point[2]));
    for (const [axis, scale] of [[0, sx], [1, sy]]) {
      const places = seen.map((point) => scale * (point[axis] - shift[axis]) / (away - point[2]));
      shift[axis] += (Math.min(...places) + Math.max(...places)) / 2 * nearest / scale;
    }
  }
  away = Math.max(...seen.map(([x, y, z]) => z + Math.max(sx * Math.abs(x - shift[0]), sy * Math.abs(y - shift[1])) / FILLED));
  return {shift, away: Math.max(away, 1e-3)};
}
