// SPDX-License-Identifier: GPL-3.0-or-later

/** The values of the report. */
export const report = JSON.parse(document.getElementById("report-data").textContent);
