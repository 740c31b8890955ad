"use strict";
// Editing: an editor at each fact, vehicles dragged to another lane, undo, run again. A refused change shows its reason at
// its field, or above the facts; the page then stays as it was.
(() => {
  const $ = (id) => document.getElementById(id);
  const desk = window.desk;
  const token = document.querySelector("meta[name=desk-token]").content;
  const make = (tag, options = {}, ...inner) => { const node = Object.assign(document.createElement(tag), options); node.append(...inner); return node; };
  const may = () => Boolean($("rerun") && !$("rerun").disabled);

  // ---------------------------------------------------------------- asking the server
  async function change(kind, edits = {}, why = "") {
    if (desk.busy) return null;
    const page = $("main"), key = page.dataset.key, started = performance.now();
    desk.busy = true; page.classList.add("busy"); page.setAttribute("aria-busy", "true");
    desk.say({ edit: "Planning and simulating …", undo: "Undoing …", rerun: "Running the case again …" }[kind]);
    const body = JSON.stringify({ version: page.dataset.version, stamp: page.dataset.stamp, edits, why, who: localStorage.getItem("desk-who") || "" });
    try {
      const answer = await fetch(`/${kind}/${key}`, { method: "POST", headers: { "Content-Type": "application/json", "X-Desk-Token": token }, body });
      const type = answer.headers.get("content-type") || "";
      const said = type.includes("json") ? await answer.json() : { text: answer.status === 404 ? "This case was removed from the folder meanwhile; nothing was changed." : await answer.text() };
      if (!answer.ok) return { ok: false, status: answer.status, ...said };
      closeEditor();
      await desk.refresh();
      const seconds = ((performance.now() - started) / 1000).toFixed(1);
      desk.say(said.changed === false ? "The value was the same already." : `Done in ${seconds} s: ${said.status}.`);
      document.documentElement.dataset.mended = String(Number(document.documentElement.dataset.mended || 0) + 1);
      return { ok: true, ...said };
    } catch {
      return { ok: false, status: 0, text: "The desk does not answer. Was it stopped? Nothing is lost; start it again and reload." };
    } finally {
      desk.busy = false; $("main").classList.remove("busy"); $("main").removeAttribute("aria-busy");
    }
  }
  function refused(said) {                                // what is not said at an open editor is said above the facts
    if (!said || said.ok) return;
    desk.say("Nothing was changed.");
    const say = document.querySelector(".editor .say");
    if (say) { say.textContent = said.text; say.focus?.(); } else { const place = $("mendfault"); place.textContent = said.text; place.hidden = false; place.scrollIntoView({ block: "nearest" }); }
    for (const [field, lines] of Object.entries(said.fields || {})) {
      const cell = $(`f-${field}`)?.querySelector("td");
      if (cell && !cell.querySelector(".editor")) cell.append(make("small", { className: "finding", textContent: lines.join("; ") }));
    }
    if (said.status === 409 && $("changed")) $("changed").hidden = false;
  }
  desk.change = async (kind, edits, why) => { if ($("mendfault")) $("mendfault").hidden = true; const said = await change(kind, edits, why); refused(said); return said; };

  // ---------------------------------------------------------------- the editor, made from what the field may be
  const words = (v) => String(v).replaceAll("_", " ");
  function control(asked, id) {
    const now = asked.value;
    if (asked.form === "flag") return select(id, [["true", "yes"], ["false", "no"]], String(now));
    if (["choice", "actor", "road"].includes(asked.form)) {
      const choices = (asked.choices || []).map((c) => [c, words(c)]);
      return select(id, asked.optional ? [["", "open: the planner chooses"], ...choices] : choices, now ?? "");
    }
    if (asked.form === "integer" || asked.form === "number")
      return make("input", { id, type: "number", value: now ?? "", min: asked.least ?? "", max: asked.most ?? "", step: asked.form === "integer" ? 1 : "any", placeholder: asked.optional ? "open" : "" });
    return make("input", { id, type: "text", value: Array.isArray(now) ? now.join(", ") : now ?? "", placeholder: asked.choices ? asked.choices.join(", ") : "" });
  }
  function select(id, choices, now) {
    const made = make("select", { id });
    for (const [value, text] of choices) made.append(make("option", { value, textContent: text, selected: String(value) === String(now) }));
    return made;
  }
  function typed(asked, input) {
    const raw = input.value.trim();
    if (asked.form === "flag") return raw === "true";
    if (raw === "" && asked.optional) return null;
    if (asked.form === "integer" || asked.form === "number") return raw === "" || Number.isNaN(Number(raw)) ? raw : Number(raw);
    if (asked.form === "list") return raw.split(",").map((t) => t.trim().replaceAll(" ", "_")).filter(Boolean);
    return raw;
  }
  function closeEditor() {
    const open = document.querySelector(".editor");
    if (!open) return;
    const back = open.parentElement.querySelector("button.value");
    open.remove(); desk.picks = null;
    if (back) { back.hidden = false; back.focus(); }
  }
  desk.closeEditor = closeEditor;
  function openEditor(button) {
    closeEditor();
    const field = button.dataset.field, asked = JSON.parse(button.dataset.edit);
    const input = control(asked, "edit-value"), why = make("input", { id: "edit-why", type: "text", maxLength: 1000, placeholder: "why (may be left empty)" });
    const limits = asked.least !== undefined && asked.most !== undefined ? ` (${asked.least} to ${asked.most})` : "";
    const form = make("form", { className: "editor" },
      make("label", { htmlFor: "edit-value", textContent: asked.about + limits }), input,
      make("label", { htmlFor: "edit-why", className: "away", textContent: "Why" }), why,
      make("div", { className: "say", role: "alert" }),
      make("div", { className: "row" }, make("button", { className: "primary", textContent: "Change" }), make("button", { type: "button", textContent: "Leave", onclick: closeEditor })));
    if (asked.form === "road") { form.querySelector("label").textContent += "; or pick the road on the map"; desk.picks = (road) => { input.value = road; input.focus(); }; }
    form.noValidate = true;                               // the server says what is wrong, in words
    form.onsubmit = (e) => { e.preventDefault(); desk.change("edit", { [field]: typed(asked, input) }, why.value); };
    button.hidden = true;
    button.after(form);
    input.focus();
    input.select?.();
  }

  // ---------------------------------------------------------------- dragging a vehicle to another lane
  function laneAt(event) {
    const strip = document.elementsFromPoint(event.clientX, event.clientY).find((n) => n.matches?.(".strip.lane"));
    return strip && Number(strip.dataset.lane) ? strip : null;
  }
  function aim(strip) {
    document.querySelectorAll(".strip.target").forEach((n) => n.classList.remove("target"));
    strip?.classList.add("target");
  }
  const groupOf = (actor) => (actor.startsWith("V") ? "vehicles" : "others") + "." + actor;
  function move(actor, strip) {
    const at = groupOf(actor), { road, direction, lane } = strip.dataset;
    return desk.change("edit", { [`${at}.start_road`]: road, [`${at}.start_direction`]: direction, [`${at}.start_lane`]: Number(lane) }, "moved on the map");
  }
  function wireCar(car) {
    let from = null, over = null;
    const home = `translate(${car.dataset.x} ${car.dataset.y})`;
    car.addEventListener("pointerdown", (e) => { if (e.button) return; e.preventDefault(); car.setPointerCapture(e.pointerId); from = desk.ground(e); car.focus({ preventScroll: true }); });
    car.addEventListener("pointermove", (e) => {
      if (!from) return;
      const p = desk.ground(e);
      if (!desk.dragging && Math.hypot(p.x - from.x, p.y - from.y) < 1.2) return;
      desk.dragging = true; car.classList.add("dragged");
      car.setAttribute("transform", `translate(${p.x} ${p.y})`);
      aim((over = laneAt(e)));
    });
    const end = (e) => {
      const dragged = desk.dragging, strip = over;
      from = over = null; desk.dragging = false; car.classList.remove("dragged"); aim(null);
      if (!dragged) return;
      car.setAttribute("transform", home);
      if (e.type === "pointerup" && strip) { car.setAttribute("transform", `translate(${desk.ground(e).x} ${desk.ground(e).y})`); move(car.dataset.actor, strip).then((said) => { if (!said?.ok) car.setAttribute("transform", home); }); }
      else if (e.type === "pointerup") desk.say("There is no lane at this place.");
    };
    car.addEventListener("pointerup", end); car.addEventListener("pointercancel", end);
    car.addEventListener("keydown", (e) => {
      const step = { ArrowLeft: 1, ArrowRight: -1 }[e.key];
      if (!step) return;
      e.preventDefault();
      const button = document.querySelector(`button.value[data-field="${groupOf(car.dataset.actor)}.start_lane"]`);
      if (!button) return;
      const now = Number(JSON.parse(button.dataset.edit).value) || Number(button.textContent) || 0;
      if (now + step < 1) { desk.say("The vehicle is in the rightmost lane already."); return; }
      desk.change("edit", { [button.dataset.field]: now + step }, "moved on the map");
    });
  }

  // ---------------------------------------------------------------- wiring, again after every change
  desk.wireMending = () => {
    if (!may()) return;
    document.querySelectorAll("button.value").forEach((b) => { b.onclick = () => openEditor(b); });
    document.querySelectorAll(".back").forEach((b) => { b.onclick = () => desk.change("edit", { [b.dataset.field]: "as_read" }); });
    document.querySelectorAll(".remove").forEach((b) => { b.onclick = (e) => { e.preventDefault(); e.stopPropagation(); desk.change("edit", { [b.dataset.remove]: false }); }; });
    document.querySelectorAll(".car").forEach(wireCar);
    $("undo").onclick = () => desk.change("undo");
    $("rerun").onclick = () => desk.change("rerun");
    $("adding").onchange = (e) => { if (e.target.value) desk.change("edit", JSON.parse(e.target.value)); e.target.value = ""; };
    $("who").value = localStorage.getItem("desk-who") || "";
    $("who").onchange = (e) => localStorage.setItem("desk-who", e.target.value.trim());
  };
})();
