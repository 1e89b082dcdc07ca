/** Tables that are sorted by a column at a click. */

/** Numbers by size, then words by the alphabet; what is empty comes last, whichever the direction. */
export function order(cells: string[], ascending: boolean): number[] {
  const value = (text: string): number => {
    const found = /^[\s+−-]*[\d.]/.test(text) ? parseFloat(text.replace("−", "-").replace(/[,\s]/g, "")) : NaN;
    return found;
  };
  const keys = cells.map((text) => ({ text: text.trim(), number: value(text.trim()) }));
  const sign = ascending ? 1 : -1;
  return cells
    .map((_, k) => k)
    .sort((a, b) => {
      const [x, y] = [keys[a], keys[b]];
      if (!x.text || !y.text) return Number(!x.text) - Number(!y.text) || a - b;
      const [xIs, yIs] = [!Number.isNaN(x.number), !Number.isNaN(y.number)];
      if (xIs && yIs) return sign * (x.number - y.number) || a - b;
      if (xIs !== yIs) return xIs ? -1 : 1;
      return sign * x.text.localeCompare(y.text, "en") || a - b;
    });
}

export function sortable(table: HTMLTableElement): void {
  const heads = [...table.querySelectorAll<HTMLTableCellElement>("thead th")];
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "sort";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const ascending = head.getAttribute("aria-sort") !== "ascending";
      for (const other of heads) other.removeAttribute("aria-sort");
      head.setAttribute("aria-sort", ascending ? "ascending" : "descending");
      const body = table.tBodies[0];
      const rows = [...body.rows];
      const sorted = order(
        rows.map((row) => row.cells[column]?.dataset.value ?? row.cells[column]?.textContent ?? ""),
        ascending,
      );
      body.append(...sorted.map((k) => rows[k]));
    });
  });
}
