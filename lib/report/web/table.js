// SPDX-License-Identifier: GPL-3.0-or-later

// Tables of class "sortable": a click on a heading sorts by its column, a second click reverses the order.
//
// A cell is compared by its data-value where it has one, otherwise by its text: as numbers where both are
// numbers, as text otherwise. Empty cells and dashes come last in both orders. Equal rows keep their order. The
// headings are the last row of thead; a cell that spans columns has no heading of its own to sort by.

function sortKey(cell) {
  const text = (cell?.dataset.value ?? cell?.textContent ?? "").trim();
  if (text === "" || text === "-" || text === "\u2013") return null;
  const number = Number(text);
  return Number.isNaN(number) ? text : number;
}

export function compareKeys(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  return String(a).localeCompare(String(b), "en", {numeric: true});
}

function sortRows(table, column, descending) {
  for (const body of table.tBodies) {
    const rows = [...body.rows].map((row) => ({row, key: sortKey(row.cells[column])}));
    rows.sort((a, b) => {
      if (a.key === null || b.key === null) return (a.key === null ? 1 : 0) - (b.key === null ? 1 : 0);
      return descending ? compareKeys(b.key, a.key) : compareKeys(a.key, b.key);
    });
    body.append(...rows.map(({row}) => row));
  }
}

/** Makes the headings buttons; does nothing to a table that has them. */
export function makeSortable(table) {
  if (table.dataset.sortable) return;
  table.dataset.sortable = "yes";
  const headings = [...(table.tHead?.rows[table.tHead.rows.length - 1]?.cells ?? [])];
  headings.forEach((heading, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.title = "sort by this column";
    button.append(...heading.childNodes);
    heading.append(button);
    button.addEventListener("click", () => {
      const descending = heading.getAttribute("aria-sort") === "ascending";
      for (const other of headings) other.removeAttribute("aria-sort");
      heading.setAttribute("aria-sort", descending ? "descending" : "ascending");
      sortRows(table, column, descending);
    });
  });
}
