// SPDX-License-Identifier: GPL-3.0-or-later

// FailFlag of lib/evaluation/evaluate.h and the requirement that judges it. A cell has the colour of the first entry
// of which it has a bit.

import {BLUE, DARK_RED, ORANGE, PURPLE, SKY_BLUE, VERMILION} from "./palette.js";

export const FAIL_FLAGS = [
  {bits: 4, text: "relative z", requirement: "relative_elevation", color: VERMILION},
  {bits: 1, text: "relative x", requirement: "relative_horizontal", color: ORANGE},
  {bits: 2, text: "relative y", requirement: "relative_horizontal", color: DARK_RED},
  {bits: 8, text: "absolute horizontal", requirement: "absolute_horizontal", color: PURPLE},
  {bits: 16, text: "hole too large", requirement: "hole_size", color: BLUE},
  {bits: 32, text: "too far from a valid bin", requirement: "hole_distance", color: SKY_BLUE},
];
