// SPDX-License-Identifier: GPL-3.0-or-later

// The report of a study: the table of its cases with filters, one case in full, and a plot of one column against another.

import {startPage} from "./page.js";
import {openCase} from "./study_case.js";
import {choosePlot, drawPlot} from "./study_plot.js";
import {addFilters, linkPoints, onChange, update} from "./study_rows.js";
import {addColumnChoices, buildRows, startTable} from "./study_table.js";

/** Opens the case that the address names. */
function openNamed() {
  const match = /^#case-(\d+)$/.exec(location.hash);
  if (match) openCase(Number(match[1]));
}

startPage(() => {
  addFilters();
  addColumnChoices();
  linkPoints();
  startTable(openCase);
  choosePlot();
  onChange(buildRows);
  onChange(drawPlot);
  document.getElementById("plot").addEventListener("click", (event) => {
    /** @type {SVGElement} */
    const mark = /** @type {Element} */ (event.target).closest("[data-case]");
    if (mark) openCase(Number(mark.dataset.case));
  });
  window.addEventListener("hashchange", openNamed);
  update();
  openNamed();
});
