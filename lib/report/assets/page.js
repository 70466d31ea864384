// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// What all pages share: the start, links to the sections, the ends of the scales. data-ready on <body> means that
// everything is drawn.

function pageSection(id) {
  return document.getElementById(id);
}

/** The choice of whether the scales of errors reach the limits. */
function scaleControl() {
  const select = htmlElement("select", {id: "scales"}, htmlElement("option", {value: "limits"}, "reach the limits"),
                             htmlElement("option", {value: "data"}, "show the data only"));
  select.addEventListener("change", () => {
    display.limits = select.value === "limits";
    for (const panel of panels) panel.rescale();
  });
  return htmlElement("label", {}, "colour scales", select);
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

function makeTablesSortable() {
  for (const table of document.querySelectorAll("main table.sortable")) makeSortable(table);
}

/** Fills the page: `fillTexts` what needs no map, `fillDrawings` the rest. */
async function fillPage(fillTexts, fillDrawings) {
  makeThemeButton(pageSection("theme"));
  fillTexts();
  fillContents();
  makeTablesSortable();
  if (typeof DecompressionStream === "undefined") {
    pageSection("message").textContent = "This browser cannot unpack the maps: it has no DecompressionStream " +
        "(Chromium 80, Firefox 113, Safari 16.4 or later have it).";
    return;
  }
  await fillDrawings();
  makeTablesSortable();
}

function startPage(fillTexts, fillDrawings) {
  fillPage(fillTexts, fillDrawings).then(nextFrame).then(
      () => { document.body.dataset.ready = "yes"; },
      (error) => {
        pageSection("message").textContent = `Drawing failed: ${error.message}`;
        throw error;
      });
}
