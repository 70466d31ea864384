// SPDX-License-Identifier: GPL-3.0-or-later

// Views that draw themselves in the width of their element.

const views = [];

/** Calls view.fit() whenever the size of its element changes. */
export function fitToElement(view, element) {
  views.push(view);
  new ResizeObserver(() => view.fit()).observe(element);
}

/** Draws all views now. Their observers would do it with the next frame, after the browser has reported the page as loaded. */
export function fitAll() {
  for (const view of views) view.fit();
}
