// SPDX-License-Identifier: GPL-3.0-or-later

// Columns of places on the map that a site was taken from; none of a site without a coordinate reference system.

import {formatNumber} from "./numbers.js";

/** @type {[string, string, number][]} */
const COORDINATES = [["easting (m)", "easting_m", 0.01], ["northing (m)", "northing_m", 0.01],
                     ["latitude (deg)", "latitude_deg", 1e-7], ["longitude (deg)", "longitude_deg", 1e-7]];

/** Headings and, for each place, cells of the coordinates that the places have.
 * @returns {{heads: [string, boolean][], cellsOf: (place: any) => any[][]}} */
export function mapColumns(places) {
  const known = COORDINATES.filter(([, key]) => places.some((place) => key in place));
  return {heads: known.map(([text]) => [text, true]),
          cellsOf: (place) => known.map(([, key, step]) => [formatNumber(place[key], step), place[key] ?? 1e300])};
}
