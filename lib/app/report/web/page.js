// SPDX-License-Identifier: GPL-3.0-or-later

// All pages share the start, the links to the sections, light and dark mode, and views that draw themselves in the width of their element.
// data-ready on <body> means that everything is drawn.

import {htmlElement, makeSortable} from "./elements.js";

// Light and dark mode: that of the system, until the button is used. Maps have the same colours in both.

const listeners = [];
const systemIsDark = window.matchMedia("(prefers-color-scheme: dark)");

function isDark() {
  const {theme} = document.documentElement.dataset;
  return theme === undefined ? systemIsDark.matches : theme === "dark";
}

/** `listener` is called when the mode may have changed. */
export function onThemeChange(listener) { listeners.push(listener); }

function makeThemeButton(button) {
  const update = () => {
    button.textContent = isDark() ? "light mode" : "dark mode";
    for (const listener of listeners) listener();
  };
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    update();
  });
  systemIsDark.addEventListener("change", update);
  update();
}

// Layout and start

const MIN_WIDTH = 160;  // pixels, below which the page has no layout yet
const fits = [];

/** Calls view.draw() whenever the width of its element, which it puts into view.width, changes. */
export function fitToElement(view, element) {
  const fit = () => {
    const width = Math.round(element.clientWidth);
    if (width < MIN_WIDTH || width === view.width) return;
    view.width = width;
    view.draw();
  };
  fits.push(fit);
  new ResizeObserver(fit).observe(element);
}

function fillContents() {
  const links = [...document.querySelectorAll("main > section")].map((section) => htmlElement(
      "a", {href: `#${section.id}`}, section.querySelector("h2").textContent));
  document.querySelector("nav.contents").prepend(...links);
}

/** Fills the page: `fillTexts` what needs no map, `fillDrawings`, if there are any, the maps. Tells of an error on the page. */
export async function startPage(fillTexts, fillDrawings = null) {
  try {
    makeThemeButton(document.getElementById("theme"));
    fillTexts();
    fillContents();
    for (const table of document.querySelectorAll("main table.sortable")) makeSortable(table);
    if (fillDrawings) await fillDrawings();
    // The observers of the views would do it with the next frame.
    for (const fit of fits) fit();
    // After the next frame all panels have their width.
    await new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); });
    document.body.dataset.ready = "yes";
  } catch (error) {
    document.getElementById("message").textContent = `Drawing failed: ${error.message}`;
    throw error;
  }
}
