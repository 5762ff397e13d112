"use strict";
// Tables sort by a click on a column's name; numbers by value, cells without one last.
for (const table of document.querySelectorAll("table.sortable")) {
  const body = table.tBodies[0];
  const heads = [...table.tHead.rows[0].cells];
  const key = (row, column) => row.cells[column].dataset.v ?? row.cells[column].textContent;
  heads.forEach((head, column) => {
    const button = document.createElement("button");
    button.type = "button";
    button.append(...head.childNodes);
    head.append(button);
    button.addEventListener("click", () => {
      const down = head.getAttribute("aria-sort") === "ascending";
      const numbers = head.classList.contains("n");
      const number = (row) => {
        const text = key(row, column).replace("\u2212", "-");
        return text === "" || isNaN(text) ? null : Number(text);
      };
      const order = (a, b) => {
        if (!numbers) return (down ? -1 : 1) * key(a, column).localeCompare(key(b, column));
        const x = number(a), y = number(b);
        if (x === null || y === null) return (x === null) - (y === null);
        return down ? y - x : x - y;
      };
      const rows = [...body.rows].sort(order);
      body.append(...rows);
      heads.forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", down ? "descending" : "ascending");
    });
  });
}
// What is pointed at in a figure says its values. Without script the browser shows the same <title> by itself.
const tip = document.createElement("div");
tip.id = "tip";
tip.hidden = true;
document.body.append(tip);
for (const title of document.querySelectorAll("figure svg title")) {
  const mark = title.parentNode;
  if (mark.tagName === "svg") continue;
  mark.dataset.tip = title.textContent;
  title.remove();
}
const place = (event) => {
  const mark = event.target.closest?.("[data-tip]");
  tip.hidden = !mark;
  if (!mark) return;
  tip.textContent = mark.dataset.tip;
  const box = tip.getBoundingClientRect();
  const left = Math.min(event.clientX + 14, innerWidth - box.width - 8);
  const above = event.clientY - box.height - 12;
  tip.style.left = Math.max(8, left) + "px";
  tip.style.top = (above < 4 ? event.clientY + 18 : above) + "px";
};
document.addEventListener("pointermove", place);
document.addEventListener("pointerdown", place);
