// A click on a column's head sorts by it, another one the other way. Rows without a number come last.
(() => {
  const body = document.querySelector("#runs tbody");
  const heads = [...document.querySelectorAll("#runs th")];

  function compare(a, b, way) {
    const [x, y] = [a.dataset.value, b.dataset.value];
    if (x === undefined && y === undefined) return way * a.textContent.localeCompare(b.textContent, "en", { numeric: true });
    if (x === undefined || y === undefined) return x === undefined ? 1 : -1;
    return way * (Number(x) - Number(y));
  }

  heads.forEach((head, n) => head.firstElementChild.addEventListener("click", () => {
    const way = head.getAttribute("aria-sort") === "ascending" ? -1 : 1;
    heads.forEach((other) => other.setAttribute("aria-sort", "none"));
    head.setAttribute("aria-sort", way > 0 ? "ascending" : "descending");
    body.append(...[...body.rows].sort((a, b) => compare(a.cells[n], b.cells[n], way)));
  }));
})();
