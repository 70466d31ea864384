// SPDX-License-Identifier: GPL-3.0-or-later
"use strict";

// Formulas, as pymdownx.arithmatex marks them: \( ... \) and \[ ... \].
for (const formula of document.querySelectorAll(".arithmatex")) {
  const text = formula.textContent.trim();
  katex.render(text.slice(2, -2), formula, {displayMode: text.startsWith("\\["), throwOnError: true});
}

// A browser lets no page of a file:// address read the index of the search.
if (location.protocol === "file:") {
  const note = document.createElement("aside");
  note.id = "search-note";
  note.textContent = "The search needs a web server: python3 -m http.server --directory build/site 8000, then http://localhost:8000";
  document.querySelector("main").prepend(note);
}
