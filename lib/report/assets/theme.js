// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// Light and dark mode: that of the system, until the button is used. Maps have the same colours in both.

const themeListeners = [];  // called when the mode may have changed
const systemIsDark = window.matchMedia("(prefers-color-scheme: dark)");

function isDark() {
  const {theme} = document.documentElement.dataset;
  return theme === undefined ? systemIsDark.matches : theme === "dark";
}

function makeThemeButton(button) {
  const update = () => {
    button.textContent = isDark() ? "light mode" : "dark mode";
    for (const listener of themeListeners) listener();
  };
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    update();
  });
  systemIsDark.addEventListener("change", update);
  update();
}
