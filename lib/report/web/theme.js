// SPDX-License-Identifier: GPL-3.0-or-later

// Light and dark mode: that of the system, until the button is used. Maps have the same colours in both.

const listeners = [];
const systemIsDark = window.matchMedia("(prefers-color-scheme: dark)");

function isDark() {
  const {theme} = document.documentElement.dataset;
  return theme === undefined ? systemIsDark.matches : theme === "dark";
}

/** `listener` is called when the mode may have changed. */
export function onThemeChange(listener) { listeners.push(listener); }

export function makeThemeButton(button) {
  const update = () => {
    button.textContent = isDark() ? "light mode" : "dark mode";
    for (const listener of listeners) listener();
  };
  button.addEventListener("click", () => {
    document.documentElement.dataset.theme = isDark() ? "light" : "dark";
    update();
  });
  systemIsDark.addEventListener("change", update);
  update();
}
