"use strict";
// The case page: related elements are highlighted; the map moves; drawings grow; keys open the next case.
// mend.js uses `window.desk`. Text is inserted as text only, never as markup.
(() => {
  const $ = (id) => document.getElementById(id);
  const desk = (window.desk = { lit: [], picks: null });
  const things = (node) => (node.dataset.things || "").split(" ").filter(Boolean);

  // ---------------------------------------------------------------- lighting up, both ways
  desk.point = (lit, sentence = "", fromPlayer = false) => {
    desk.lit = lit;
    for (const node of document.querySelectorAll("[data-things]")) {
      const own = node.dataset.sentence ?? node.dataset.of ?? "";
      const shares = things(node).some((t) => lit.includes(t));
      const tells = sentence !== "" && (node.dataset.sentence !== undefined || node.matches(".fact, .item"));
      node.classList.toggle("lit", tells ? own === sentence : shares);
    }
    const player = $("player");
    if (player && !fromPlayer) player.contentWindow.postMessage({ sgcad: "point", things: lit.map((t) => t.replace(":", " ")) }, "*");
  };
  desk.show = (selector) => document.querySelector(selector)?.scrollIntoView({ block: "nearest" });
  const pointer = (e) => e.target.closest?.("[data-things]");
  function light(node) {
    if (node.dataset.of !== undefined && !node.matches(".car, .strip")) {
      const told = document.querySelector(`[data-sentence="${node.dataset.of}"]`);
      desk.point([...new Set([...things(node)])], node.dataset.of);
      told?.classList.add("lit");
    } else desk.point(things(node), node.dataset.sentence ?? "");
  }
  let held = null;                                        // what was clicked stays lit until something else is
  const main = () => $("main");
  // A page that scrolls or is laid out anew under a resting pointer sends the same events as a pointer that moves:
  // they must not put out what a key, the player or a click lit.
  let pointerAt = "";
  const rests = (e) => pointerAt === `${e.screenX} ${e.screenY}`;
  document.addEventListener("pointermove", (e) => { pointerAt = `${e.screenX} ${e.screenY}`; }, true);
  document.addEventListener("pointerover", (e) => { const node = pointer(e); if (node && !held && !desk.dragging && !rests(e)) light(node); });
  document.addEventListener("pointerout", (e) => { if (pointer(e) && !held && !desk.dragging && !rests(e)) desk.point([]); });
  document.addEventListener("focusin", (e) => { const node = pointer(e); if (node) { held = null; light(node); } });
  document.addEventListener("click", (e) => {
    const node = pointer(e);
    if (!node) { if (held && !e.target.closest("button, a, input, select, summary")) { held = null; desk.point([]); } return; }
    held = node;
    light(node);
    const lit = things(node);
    if (node.closest("#map") && desk.picks && node.dataset.road) { desk.picks(node.dataset.road); return; }
    if (node.closest("#map")) openGroup(lit);
    if (node.closest("#map, .facts, .account, .history")) (document.querySelector(".told.lit"))?.scrollIntoView({ block: "nearest" });
    if (node.matches(".item") && node.dataset.field) toFact(node.dataset.field);
  });
  function openGroup(lit) {
    const group = lit.map((t) => document.querySelector(`[data-group="${CSS.escape(t)}"]`)).find(Boolean);
    if (group) { group.open = true; group.scrollIntoView({ block: "nearest" }); }
    return group;
  }
  function toFact(field) {
    const row = $(`f-${field}`) || [...document.querySelectorAll(".fact")].find((r) => r.classList.contains("lit"));
    if (row) { row.closest("details").open = true; row.scrollIntoView({ block: "center" }); }
  }
  desk.openGroup = openGroup;
  window.addEventListener("message", (e) => {             // the player tells what is pointed at in it
    if (!$("player") || e.source !== $("player").contentWindow || e.data?.sgcad !== "pointed" || !Array.isArray(e.data.things)) return;
    if (held && !e.data.things.length) return;
    held = null;
    desk.point(e.data.things.map((t) => String(t).replace(" ", ":")), "", true);
  });

  // ---------------------------------------------------------------- the map moves
  const view = () => $("map").viewBox.baseVal;
  function look(x, y, w, h) { $("map").setAttribute("viewBox", `${x} ${y} ${w} ${h}`); }
  function zoom(factor, at) {
    const v = view(), w = Math.min(Math.max(v.width * factor, 12), 900), h = (v.height * w) / v.width;
    const p = at || { x: v.x + v.width / 2, y: v.y + v.height / 2 };
    look(p.x - ((p.x - v.x) * w) / v.width, p.y - ((p.y - v.y) * h) / v.height, w, h);
  }
  desk.ground = (e) => { const m = $("map").getScreenCTM().inverse(); return new DOMPoint(e.clientX, e.clientY).matrixTransform(m); };
  function wireMap() {
    const map = $("map");
    if (!map) return;
    $("in").onclick = () => zoom(0.75); $("out").onclick = () => zoom(1.33);
    $("home").onclick = () => map.setAttribute("viewBox", map.dataset.home);
    map.addEventListener("wheel", (e) => { if (!e.ctrlKey && !document.activeElement?.closest("#map")) return; e.preventDefault(); zoom(e.deltaY > 0 ? 1.12 : 0.89, desk.ground(e)); }, { passive: false });
    let from = null;
    map.addEventListener("pointerdown", (e) => { if (!e.target.closest(".car")) from = desk.ground(e); });
    map.addEventListener("pointermove", (e) => { if (!from || !e.buttons) return; const p = desk.ground(e), v = view(); look(v.x + from.x - p.x, v.y + from.y - p.y, v.width, v.height); });
    map.addEventListener("pointerup", () => { from = null; });
    map.addEventListener("keydown", (e) => { const step = { "+": 0.8, "=": 0.8, "-": 1.25 }[e.key]; if (step) { e.preventDefault(); zoom(step); } });
  }
  function wireDrawings() {
    for (const button of document.querySelectorAll(".drawing")) button.onclick = () => button.setAttribute("aria-pressed", button.getAttribute("aria-pressed") !== "true");
  }

  // ---------------------------------------------------------------- keys
  document.addEventListener("keydown", (e) => {
    if (e.ctrlKey || e.metaKey || e.altKey) return;
    if (e.key === "Escape") {
      document.querySelectorAll(".drawing[aria-pressed=true]").forEach((b) => b.setAttribute("aria-pressed", "false"));
      held = null; desk.point([]); desk.closeEditor?.(); return;
    }
    if (e.target.matches("input, select, textarea")) return;
    const place = { n: "after", p: "before", l: "back" }[e.key];
    if (place) $(place)?.click();
    if (e.key === "u") $("undo")?.click();
    if (e.key === "r") $("rerun")?.click();
    if ((e.key === "Enter" || e.key === " ") && e.target.matches("[role=button]")) { e.preventDefault(); e.target.dispatchEvent(new MouseEvent("click", { bubbles: true })); }
  });

  // ---------------------------------------------------------------- the page follows the disk
  desk.say = (text) => { const toast = $("toast"); toast.textContent = text; toast.classList.add("on"); clearTimeout(desk.timer); desk.timer = setTimeout(() => toast.classList.remove("on"), 4000); };
  desk.refresh = async () => {                            // the page as it is now; scroll, open groups and focus stay
    const open = new Map([...document.querySelectorAll("details")].map((d, k) => [d.dataset.group ?? k, d.open]));
    const focus = document.activeElement, again = focus?.dataset?.field ? `button.value[data-field="${CSS.escape(focus.dataset.field)}"]` : focus?.id ? `#${CSS.escape(focus.id)}` : focus?.dataset?.actor ? `[data-actor="${CSS.escape(focus.dataset.actor)}"]` : "";
    const scrolls = [...document.querySelectorAll(".report, .facts")].map((n) => n.scrollTop), at = scrollY;
    const answer = await fetch(location.href), text = await answer.text();
    const fresh = new DOMParser().parseFromString(text, "text/html");
    main().replaceWith(document.adoptNode(fresh.getElementById("main")));
    document.title = fresh.title;
    held = null;
    [...document.querySelectorAll("details")].forEach((d, k) => { const was = open.get(d.dataset.group ?? k); if (was !== undefined && !d.classList.contains("lacks")) d.open = was; });
    [...document.querySelectorAll(".report, .facts")].forEach((n, k) => { n.scrollTop = scrolls[k] || 0; });
    scrollTo(0, at);
    wire();
    if (again) document.querySelector(again)?.focus({ preventScroll: true });
  };
  async function look_at_disk() {
    const page = main();
    if (page.dataset.key && !document.hidden && !desk.busy) {
      try {
        const answer = await fetch(`/version/${page.dataset.key}`);
        if (page === main() && !desk.busy) {
          if (answer.status === 404) { $("changed").hidden = false; $("changed").firstChild.textContent = "This case was removed from the folder, or is being written again. "; }
          else if (answer.ok) $("changed").hidden = (await answer.json()).version === page.dataset.version;
        }
      } catch { $("changed").hidden = false; $("changed").firstChild.textContent = "The desk does not answer; was it stopped? "; }
    }
    setTimeout(look_at_disk, 4000);
  }
  function wire() { wireMap(); wireDrawings(); if ($("reload")) $("reload").onclick = () => desk.refresh(); desk.wireMending?.(); }
  desk.wire = wire;
  document.addEventListener("DOMContentLoaded", () => { wire(); setTimeout(look_at_disk, 4000); });
})();
