# SPDX-License-Identifier: GPL-3.0-or-later
"""A test of HTML reports in a browser: texts, drawings, layout, and that a page requests no other file."""
import base64
import functools
import io
import shutil
import tempfile
import unittest

import numpy as np
from PIL import Image

from harness import Chain, ToolTest, browser

WIDTHS = (1400, 800, 390)

# A canvas drawn on a flat one.
FLAT = """
const canvas = arguments[0], flat = document.createElement("canvas");
Object.assign(flat, {width: canvas.width, height: canvas.height});
const context = flat.getContext("2d", {willReadFrequently: true});
context.drawImage(canvas, 0, 0);
"""
# The number of different colours in a canvas, and a checksum of its pixels.
CANVAS = FLAT + """
const data = new Uint32Array(context.getImageData(0, 0, flat.width, flat.height).data.buffer);
let sum = 0;
for (const pixel of data) sum = (Math.imul(sum, 31) + pixel) | 0;
return {colors: new Set(data).size, sum};
"""
# The fraction of a canvas' pixels whose red, green or blue differs from that of the first one, and the number of those on the border.
DRAWN = FLAT + """
const data = new Uint32Array(context.getImageData(0, 0, flat.width, flat.height).data.buffer), width = flat.width;
const differs = data.reduce((found, pixel, i) => { if ((pixel ^ data[0]) & 0xffffff) found.push(i); return found; }, []);
return [differs.length / data.length, differs.filter((i) => i % width % (width - 1) === 0 || i < width || i >= data.length - width).length];
"""
# All values of a layer; null where there is none.
VALUES = """
return rasterOf(layerNamed(arguments[0]), report.grid).then((raster) => Array.from(raster.codes, (_, i) => {
  const value = raster.value(i);
  return Number.isNaN(value) ? null : value;
}));
"""
# A drag of the pointer over the map of a layer, from and to a position in metres; with one position a move.
POINT = """
const [layer, ...places] = arguments;
const panel = panels.find((p) => p.canvas.dataset.layer === layer && p.options.region);
const box = panel.plot.getBoundingClientRect(), zoom = box.width / panel.width;
const event = (type, [x, y]) => panel.plot.dispatchEvent(new PointerEvent(type, {
  clientX: box.left + panel.x(x) * zoom, clientY: box.top + panel.y(y) * zoom, bubbles: true}));
if (places.length > 1) event("pointerdown", places[0]);
event("pointermove", places[places.length - 1]);
if (places.length > 1) event("pointerup", places[places.length - 1]);
"""
# The visible texts whose contrast with what is behind them is below 4.5 (WCAG 2, 1.4.3): [element, text, contrast].
FAINT = """
const parts = (color) => { const [r, g, b, a = 1] = color.match(/[0-9.]+/g).map(Number); return [r, g, b, a]; };
const over = (top, below) => [0, 1, 2].map((k) => top[k] * top[3] + below[k] * (1 - top[3])).concat([1]);
const light = (color) => color.slice(0, 3).map((part) => part / 255).map(
    (c) => c <= 0.04045 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4).reduce((sum, c, k) => sum + c * [0.2126, 0.7152, 0.0722][k], 0);
const styles = new Map(), style = (e) => { if (!styles.has(e)) styles.set(e, getComputedStyle(e)); return styles.get(e); };
const papers = new Map();
const paperOf = (e) => {
  if (e === null) return [255, 255, 255, 1];
  if (!papers.has(e)) papers.set(e, over(parts(style(e).backgroundColor), paperOf(e.parentElement)));
  return papers.get(e);
};
const opacity = (e) => e === null ? 1 : Number(style(e).opacity) * opacity(e.parentElement);
const found = new Map(), closed = document.querySelector("#__search:checked") ? "" : ", .md-search__output";
for (const e of document.querySelectorAll("body, body *")) {
  const own = [...e.childNodes].filter((node) => node.nodeType === 3).map((node) => node.textContent.trim()).join("");
  if (!own || e.closest(".haloed, script, style, noscript, option, .katex-mathml" + closed) || !e.checkVisibility({checkOpacity: true, checkVisibilityCSS: true})) continue;
  const box = e.getBoundingClientRect();
  if (box.width < 2 || box.height < 2) continue;
  const paper = paperOf(e), color = parts(e instanceof SVGElement ? style(e).fill : style(e).color);
  const ink = light(over([...color.slice(0, 3), color[3] * opacity(e)], paper)), behind = light(paper);
  const contrast = (Math.max(ink, behind) + 0.05) / (Math.min(ink, behind) + 0.05);
  const name = `${e.tagName}.${e.className.baseVal ?? e.className} in ${e.parentElement?.className.baseVal ?? e.parentElement?.className}`;
  if (contrast < 4.5) found.set(name, [name, own.slice(0, 40), contrast.toFixed(2)]);
}
return [...found.values()];
"""
# Pairs of texts of a diagram or blocks of the page that overlap, and elements wider than the page.
LAYOUT = """
const boxes = (list) => [...list].map((e) => ({text: e.textContent, box: e.getBoundingClientRect()}))
    .filter(({box}) => box.width > 0);
const cross = ({box: a}, {box: b}) => a.left < b.right - 1 && b.left < a.right - 1 && a.top < b.bottom - 1 &&
    b.top < a.bottom - 1;
const pairs = [];
for (const svg of document.querySelectorAll("svg")) {
  const texts = boxes(svg.querySelectorAll("text:not(.haloed)"));
  texts.forEach((a, i) => texts.slice(i + 1).forEach((b) => { if (cross(a, b)) pairs.push([a.text, b.text]); }));
}
const blocks = boxes(document.querySelectorAll("main > section, article > *"));
blocks.forEach((a, i) => blocks.slice(i + 1, i + 9).forEach((b) => { if (cross(a, b)) pairs.push([a.text.slice(0, 40), b.text.slice(0, 40)]); }));
const page = document.documentElement;
const wide = [...document.querySelectorAll("body *")].filter((e) => !e.closest(".scroll, .window, pre, .md-nav, .md-search, .katex-mathml") &&
    !e.closest("svg.sample") && e.getBoundingClientRect().right > page.clientWidth + 0.5);
for (const e of document.querySelectorAll(".scroll")) if (e.scrollWidth > e.clientWidth && innerWidth > 620) wide.push(e);  // a phone scrolls tables
return {pairs, scroll: page.scrollWidth - page.clientWidth,
        wide: wide.map((e) => e.tagName + "." + e.className + "#" + e.id + ": " + e.textContent.slice(0, 40))};
"""
# Whether each picture of the page is there.
IMAGES = """
return [...document.querySelectorAll("main img")].map((image) => image.complete && image.naturalWidth > 0);
"""


@functools.cache
def case_and_window():
    """The case and the browser of a test program."""
    chain, window = Chain(), browser.Browser()
    unittest.addModuleCleanup(chain.remove)
    unittest.addModuleCleanup(window.close)
    return chain, window


class PageTest(ToolTest):
    """All tests of a program use one case and one browser."""

    @classmethod
    def setUpClass(cls):
        cls.chain, cls.window = case_and_window()
        cls.requested = set()  # by the page that is open

    def widen(self):
        if self.window.size != (WIDTHS[0], 1000):
            self.window.resize(WIDTHS[0])

    def open(self, name):
        """Opens a page in the test's folder."""
        self.window.driver.get("about:blank")  # to widen a page draws it again
        self.window.driver.get_log("browser")
        self.window.requests()
        self.requested.clear()
        self.widen()
        self.window.open(self.path(name))

    def text(self, selector):
        return self.window.run("return document.querySelector(arguments[0])?.textContent ?? null", selector)

    def cells(self, table):
        return self.window.run("return [...document.querySelectorAll(arguments[0] + ' tbody tr')]"
                               ".map((row) => [...row.cells].map((cell) => cell.textContent))", table)

    def texts(self, selector):
        return self.window.run("return [...document.querySelectorAll(arguments[0])].map((e) => e.textContent)", selector)

    def element(self, selector):
        return self.window.run("return document.querySelector(arguments[0])", selector)

    def canvas(self, selector):
        return self.window.run(CANVAS, self.element(selector))

    def pixels(self, selector):
        """Red, green and blue of the pixels of a canvas, (rows, columns, 3)."""
        url = self.window.run(FLAT + "return flat.toDataURL();", self.element(selector))
        with Image.open(io.BytesIO(base64.b64decode(url.partition(",")[2]))) as image:
            return np.asarray(image.convert("RGB"))

    def share(self, selector, color):
        """The fraction of the pixels of a canvas that have a colour."""
        return (self.pixels(selector) == color).all(-1).mean()

    def drawn(self, selector):
        return self.window.run(DRAWN, self.element(selector))

    def values(self, name, shape):
        """All values of a layer that the page has."""
        return np.array(self.window.run(VALUES, name), float).reshape(shape)

    def step(self, name):
        """The step with which a layer is stored in the page."""
        return self.window.run("return layerNamed(arguments[0]).step", name)

    def maps(self):
        return self.window.run("return [...document.querySelectorAll('#maps canvas')].map((c) => c.dataset.layer)")

    def check_parts(self, sections, maps, colors=1):
        """The page has these sections and maps, and every map more than so many colours."""
        self.assertEqual(self.window.run("return [...document.querySelectorAll('main > section')].map((s) => s.id)"), sections)
        self.assertEqual(self.maps(), maps)
        for name in maps:
            self.assertGreater(self.canvas(f"#maps canvas[data-layer={name}]")["colors"], colors, name)
        self.check_log_and_requests()

    def point(self, layer, *places):
        self.window.run(POINT, layer, *places)
        self.settle()

    def values_under_cursor(self, layer, place):
        """{layer: text} of the values at a place, where all maps have a cursor."""
        self.point(layer, place)
        drawn = self.window.run("return panels.filter((p) => p.options.region && p.svg.querySelector('.cursor'))"
                                ".map((p) => p.raster.layer.name)")
        self.assertEqual(drawn, self.maps())
        shown = self.window.run("return Object.fromEntries([...document.querySelectorAll('#values [data-value-of]')].map("
                                "(e) => [e.dataset.valueOf, e.querySelector('output').textContent]))")
        self.assertEqual(set(shown), set(drawn))
        return shown

    def scheme(self, name, media=""):
        """The colours of the system for this test."""
        command = functools.partial(self.window.driver.execute_cdp_cmd, "Emulation.setEmulatedMedia")
        command({"media": media, "features": [{"name": "prefers-color-scheme", "value": name}]})
        self.addCleanup(command, {"features": []})
        self.settle()

    def check_contrast(self, where):
        self.assertEqual(self.window.run(FAINT), [], where)

    def check_log_and_requests(self):
        """Checks that the browser logged no error and requested the file only."""
        errors = [entry for entry in self.window.driver.get_log("browser") if "GL Driver Message" not in entry["message"]]
        self.assertEqual(errors, [])
        self.requested.update(url.split(":")[0] for url in self.window.requests())
        self.assertEqual(self.requested, {"file"})
        self.assertEqual(self.text("#message"), "")

    def check_layout(self):
        for width in WIDTHS:
            self.window.resize(width)
            self.check_boxes(f"{width} px")

    def check_boxes(self, where):
        self.assertEqual(self.window.run(LAYOUT), {"pairs": [], "scroll": 0, "wide": []}, where)

    def settle(self):
        """Waits for the next frame, with which overlays are drawn."""
        self.window.driver.execute_async_script("requestAnimationFrame(() => requestAnimationFrame(() => arguments[0]()))")


class CommonPage(PageTest):
    """Tests of one page, before a class whose report() makes and opens a page and whose results() returns what was made: that is done once. A test
    that changes what another one looks at changes it back."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        cls.common = tempfile.mkdtemp(prefix="landfall-")
        cls.addClassCleanup(shutil.rmtree, cls.common)
        cls.is_open = False

    def setUp(self):
        self.folder = self.common

    def report(self, *arguments):
        if not self.is_open:
            super().report(*arguments)
            type(self).is_open = True
        self.widen()
        return self.results()
