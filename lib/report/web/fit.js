// SPDX-License-Identifier: GPL-3.0-or-later

// Views that draw themselves in the width of their element.

const LEAST_WIDTH = 160;  // pixels, below which the page has no layout yet
const fits = [];

/** Calls view.draw() whenever the width of its element, which it puts into view.width, changes. */
export function fitToElement(view, element) {
  const fit = () => {
    const width = Math.round(element.clientWidth);
    if (width < LEAST_WIDTH || width === view.width) return;
    view.width = width;
    view.draw();
  };
  fits.push(fit);
  new ResizeObserver(fit).observe(element);
}

/** Draws all views now. Their observers would do it with the next frame, after the browser has reported the page as loaded. */
export function fitAll() {
  for (const fit of fits) fit();
}
