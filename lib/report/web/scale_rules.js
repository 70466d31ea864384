// SPDX-License-Identifier: GPL-3.0-or-later

// Ends of the colour scales and strength of the relief, as in lib/picture.

import {report} from "./report_data.js";

export const OUTLIERS = report.colors.outliers;         // share of the values on either side that lie beyond the ends
export const LIMIT_INSIDE = report.colors.limit_inside;  // a scale reaches at least this times the limit
export const MIN_RANGE = 1e-3;    // of a scale, so that rounding errors do not appear in colour
export const RMS_SLOPE = 0.4;     // to which the relief is scaled
export const MIN_RELIEF = 0.25;
export const MAX_RELIEF = 5;
