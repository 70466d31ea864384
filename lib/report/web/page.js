// SPDX-License-Identifier: GPL-3.0-or-later

// All pages share the start and the links to the sections. data-ready on <body> means that everything is drawn.

import {htmlElement} from "./elements.js";
import {fitAll} from "./fit.js";
import {makeSortable} from "./table.js";
import {makeThemeButton} from "./theme.js";

export function pageSection(id) {
  return document.getElementById(id);
}

function fillContents() {
  const links = [...document.querySelectorAll("main > section")].map((section) => htmlElement(
      "a", {href: `#${section.id}`}, section.querySelector("h2").textContent));
  document.querySelector("nav.contents").prepend(...links);
}

/** Resolves after the next frame, when all panels have their width. */
function nextFrame() {
  return new Promise((resolve) => { requestAnimationFrame(() => requestAnimationFrame(resolve)); });
}

/** Fills the page: `fillTexts` what needs no map, `fillDrawings`, if there are any, the maps. */
async function fillPage(fillTexts, fillDrawings) {
  makeThemeButton(pageSection("theme"));
  fillTexts();
  fillContents();
  for (const table of document.querySelectorAll("main table.sortable")) makeSortable(table);
  if (fillDrawings) await fillDrawings();
  fitAll();
}

export function startPage(fillTexts, fillDrawings = null) {
  fillPage(fillTexts, fillDrawings).then(nextFrame).then(
      () => { document.body.dataset.ready = "yes"; },
      (error) => {
        pageSection("message").textContent = `Drawing failed: ${error.message}`;
        throw error;
      });
}
