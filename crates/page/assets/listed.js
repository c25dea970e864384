"use strict";
// A table that is wider than its place shows each row as a list: a name before each value, nothing to be moved sideways.
(() => {
  const boxes = [...document.querySelectorAll(".wide")];
  for (const table of boxes.map((box) => box.firstElementChild)) {
    const names = [...table.querySelectorAll("thead th")].map((th) => {
      const [name, unit] = [th.firstChild?.textContent ?? "", th.querySelector("small")?.textContent];
      return unit && !name.endsWith(unit) ? `${name} (${unit})` : name;
    });
    for (const row of table.tBodies[0].rows) [...row.cells].forEach((cell, k) => (cell.dataset.name = names[k]));
  }
  const fit = (box) => {
    box.classList.remove("listed");
    box.classList.toggle("listed", box.scrollWidth > box.clientWidth + 1);
  };
  const all = () => boxes.forEach(fit);
  all();
  addEventListener("resize", all);
  // Paper has room for all columns.
  addEventListener("beforeprint", () => boxes.forEach((box) => box.classList.remove("listed")));
  addEventListener("afterprint", all);
})();
