// SPDX-License-Identifier: GPL-3.0-or-later

// Colours by name. Okabe and Ito's palette is readable with every common colour blindness, too.

export const BLUE = "#0072b2";
export const VERMILION = "#d55e00";
export const INK = "#1d2733";            // on maps, which look the same in light and dark mode
export const TEXT_COLOR = "var(--ink)";  // beside maps
// Lines of diagrams differ in light and dark mode (report.css).
export const LINE = {blue: "var(--blue)", sky: "var(--sky)", vermilion: "var(--vermilion)", purple: "var(--purple)"};
