"use strict";
(() => {
  const search = document.getElementById("text");
  const links = () => [...document.querySelectorAll(".who a")];
  document.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    if (e.target.matches("input, select, textarea")) { if (e.key === "Escape") e.target.blur(); return; }
    if (e.key === "/") { e.preventDefault(); search.focus(); search.select(); }
    const step = { j: 1, k: -1 }[e.key];
    if (step) { const all = links(), at = all.indexOf(document.activeElement); (all[at < 0 ? 0 : at + step] || all[at])?.focus(); }
  });
  if (matchMedia("(max-width: 1000px)").matches) document.querySelector(".facets details")?.removeAttribute("open");
  // While the folder is still being read, the list is fetched again until it is whole.
  async function again() {
    const answer = await fetch(location.href);
    if (!answer.ok) return;
    const fresh = new DOMParser().parseFromString(await answer.text(), "text/html");
    for (const part of ["#main", ".facets ul"]) {
      const old = document.querySelector(part), made = fresh.querySelector(part);
      if (old && made && !old.contains(document.activeElement)) old.replaceWith(made);
    }
    if (fresh.getElementById("pending")) setTimeout(again, 700);
  }
  if (document.getElementById("pending")) setTimeout(again, 500);
})();
