// SPDX-License-Identifier: GPL-3.0-or-later

// All pages share the start and the links to the sections. data-ready on <body> means that everything is drawn.

import {htmlElement} from "./elements.js";
import {fitAll} from "./fit.js";
import {makeSortable} from "./table.js";
import {makeThemeButton} from "./theme.js";

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
    fitAll();
    // After the next frame all panels have their width.
    await new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); });
    document.body.dataset.ready = "yes";
  } catch (error) {
    document.getElementById("message").textContent = `Drawing failed: ${error.message}`;
    throw error;
  }
}
