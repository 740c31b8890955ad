"use strict";
(() => {
  const $ = (id) => document.getElementById(id);
  const data = JSON.parse($("data").textContent);
  const canvas = $("view"), ink = canvas.getContext("2d");
  const last = Math.max(data.t_s.length - 1, 0), step = last ? data.t_s[1] - data.t_s[0] : 0.05;
  const contact = data.collision.observed, declared = data.collision.declared;
  const near = data.near_crash, closest = near && !contact ? near.observed : null;
  const moment = contact || closest, momentStep = moment ? moment.t_s / step : null, contactStep = contact ? momentStep : null;
  const COLOR = { ground: "#e9ece4", asphalt: "#5d636a", path: "#a9a69c", edge: "#f2f2ee", lane: "#f2f2ee", center: "#efbf3f", stop: "#ffffff", hit: "#d7263d", lit: "#b99a2e", halo: "#ffd84d" };
  const WIDTH_M = { edge: 0.15, lane: 0.15, center: 0.2, stop: 0.55 };
  let lit = new Set();                                   // things pointed at: "V1", "road main", "contact"
  let now = 0, playing = false, before = 0, follow = false, box = { x: 0, y: 0, scale: 4 };

  // ---------------------------------------------------------------- view
  const size = () => [canvas.clientWidth, canvas.clientHeight];
  const toScreen = (x, y) => { const [w, h] = size(); return [w / 2 + (x - box.x) * box.scale, h / 2 - (y - box.y) * box.scale]; };
  function fit() {
    const xs = data.actors.flatMap((a) => a.x), ys = data.actors.flatMap((a) => a.y);
    if (!xs.length) return;
    const least = (v) => v.reduce((a, b) => Math.min(a, b)), most = (v) => v.reduce((a, b) => Math.max(a, b));
    const [w, h] = size(), margin = 14;
    const wide = most(xs) - least(xs) + 2 * margin, high = most(ys) - least(ys) + 2 * margin;
    box = { x: (most(xs) + least(xs)) / 2, y: (most(ys) + least(ys)) / 2, scale: Math.min(w / wide, h / high, 16) };
    follow = false;
    draw();
  }
  function zoom(factor, px, py) {
    const [w, h] = size(), dx = (px ?? w / 2) - w / 2, dy = h / 2 - (py ?? h / 2);
    const scale = Math.min(Math.max(box.scale * factor, 0.3), 80);
    box = { x: box.x + dx / box.scale - dx / scale, y: box.y + dy / box.scale - dy / scale, scale };
    draw();
  }

  // ---------------------------------------------------------------- motion
  function pose(actor, at) {
    const k = Math.min(Math.floor(at), last), n = Math.min(k + 1, last), u = at - k;
    let turn = actor.heading[n] - actor.heading[k];
    turn = Math.atan2(Math.sin(turn), Math.cos(turn));
    return { x: actor.x[k] + u * (actor.x[n] - actor.x[k]), y: actor.y[k] + u * (actor.y[n] - actor.y[k]),
      heading: actor.heading[k] + u * turn, speed: actor.speed[k] + u * (actor.speed[n] - actor.speed[k]) };
  }

  // ---------------------------------------------------------------- drawing
  function trace(flat) {
    ink.beginPath();
    for (let i = 0; i < flat.length; i += 2) ink[i ? "lineTo" : "moveTo"](flat[i], flat[i + 1]);
  }
  function drawNetwork() {
    ink.lineJoin = "round"; ink.lineCap = "butt";
    for (const pass of [0.9, 0]) {                       // a pale verge first, then the asphalt
      for (const area of data.drawing.areas) {
        trace(area); ink.closePath(); ink.fillStyle = ink.strokeStyle = pass ? "#d3d8cc" : COLOR.asphalt;
        ink.lineWidth = pass * 2; ink.fill(); if (pass) ink.stroke();
      }
      for (const [width, cars, flat, road] of data.drawing.strips) {
        const asphalt = lit.has(road) ? COLOR.lit : COLOR.asphalt;
        trace(flat); ink.lineWidth = width + pass * 2 + 0.05; ink.strokeStyle = pass ? "#d3d8cc" : cars ? asphalt : COLOR.path; ink.stroke();
      }
    }
    for (const [style, flat] of data.drawing.lines) {
      trace(flat); ink.lineWidth = Math.max(WIDTH_M[style], 0.9 / box.scale); ink.strokeStyle = COLOR[style];
      ink.setLineDash(style === "lane" ? [3, 6] : []); ink.stroke();
    }
    ink.setLineDash([]);
  }
  function drawPath(actor) {
    const k = Math.floor(now);
    for (const [from, to, alpha, width] of [[0, last, 0.6, 2], [0, k, 0.95, 3]]) {
      ink.beginPath();
      for (let i = from; i <= to; i++) ink[i > from ? "lineTo" : "moveTo"](actor.x[i], actor.y[i]);
      ink.globalAlpha = alpha; ink.strokeStyle = actor.color; ink.lineWidth = width / box.scale; ink.lineCap = "round";
      ink.setLineDash(to === last && from === 0 && alpha < 0.7 ? [6 / box.scale, 6 / box.scale] : []); ink.stroke();
    }
    ink.setLineDash([]); ink.globalAlpha = 1;
  }
  function drawActor(actor) {
    const p = pose(actor, now), l = actor.length_m, w = actor.width_m, thin = 1.2 / box.scale;
    ink.save(); ink.translate(p.x, p.y); ink.rotate(p.heading);
    ink.beginPath();
    if (actor.type === "pedestrian") ink.arc(0, 0, Math.max(l, w) / 2, 0, 7); else ink.roundRect(-l / 2, -w / 2, l, w, Math.min(w * 0.22, 0.5));
    if (lit.has(actor.id)) { ink.strokeStyle = COLOR.halo; ink.lineWidth = 9 / box.scale; ink.stroke(); }
    ink.fillStyle = actor.color; ink.strokeStyle = "#fff"; ink.lineWidth = thin * 1.5;
    ink.shadowColor = "rgba(0,0,0,.45)"; ink.shadowBlur = 7; ink.fill(); ink.shadowBlur = 0; ink.stroke();
    if (!["pedestrian", "object", "trailer"].includes(actor.type) && w > 1) {
      const glass = l / 2 - Math.min(l * 0.3, 1.9);
      ink.fillStyle = "rgba(15,25,35,.62)"; ink.beginPath();                       // windshield: which way is front
      ink.moveTo(glass, -w * 0.4); ink.lineTo(glass + 0.6, -w * 0.34); ink.lineTo(glass + 0.6, w * 0.34); ink.lineTo(glass, w * 0.4); ink.fill();
      ink.fillStyle = "#fff6cf"; for (const s of [-1, 1]) ink.fillRect(l / 2 - 0.28, s * w * 0.33 - 0.18, 0.2, 0.36);
    }
    if (w <= 1 && actor.type !== "pedestrian") { ink.fillStyle = "#fff"; ink.beginPath(); ink.arc(l * 0.3, 0, w * 0.2, 0, 7); ink.fill(); }
    ink.restore();
  }
  function labelPlace(actor) {                           // beside the box, away from the others where they are near
    const p = pose(actor, now), [x, y] = toScreen(p.x, p.y), lift = Math.min(actor.length_m * box.scale * 0.5, 40) + 16;
    let dx = 0, dy = 0;
    for (const other of data.actors) {
      const q = pose(other, now), [u, v] = toScreen(q.x, q.y), gap = Math.hypot(x - u, y - v);
      if (other !== actor && gap < 90) { dx += (x - u) / (gap + 1); dy += (y - v) / (gap + 1); }
    }
    const far = Math.hypot(dx, dy);
    return far > 0.2 ? [x + (lift * dx) / far, y + (lift * dy) / far] : [x, y - lift];
  }
  function drawLabel(actor) {
    const [x, y] = labelPlace(actor);
    ink.font = "700 12px system-ui, sans-serif"; ink.textAlign = "center"; ink.textBaseline = "middle";
    const wide = ink.measureText(actor.id).width + 12;
    ink.fillStyle = actor.color; ink.strokeStyle = "#fff"; ink.lineWidth = 1.5;
    ink.beginPath(); ink.roundRect(x - wide / 2, y - 9, wide, 18, 9); ink.fill(); ink.stroke();
    ink.fillStyle = "#fff"; ink.fillText(actor.id, x, y + 0.5);
  }
  function drawContact() {
    if (!contact || contact.x === undefined) return;
    const [x, y] = toScreen(contact.x, contact.y), since = now - contactStep, hit = since >= -0.5;
    const still = Math.min(Math.max(1.1 * box.scale, 5), 10), big = hit ? still + 8 * Math.max(0, 1 - since * step / 0.6) : 6;
    ink.beginPath();
    for (let i = 0; i < 20; i++) {
      const r = i % 2 ? big * 0.45 : big, a = (i * Math.PI) / 10;
      ink[i ? "lineTo" : "moveTo"](x + r * Math.cos(a), y + r * Math.sin(a));
    }
    ink.closePath();
    if (lit.has("contact")) { ink.strokeStyle = COLOR.halo; ink.lineWidth = 8; ink.stroke(); }
    ink.lineWidth = 1.5; ink.strokeStyle = hit ? "#fff" : COLOR.hit;
    if (hit) { ink.fillStyle = COLOR.hit; ink.globalAlpha = 0.92; ink.fill(); ink.globalAlpha = 1; }
    ink.stroke();
  }
  function draw() {
    const [w, h] = size(), ratio = window.devicePixelRatio || 1;
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) { canvas.width = Math.round(w * ratio); canvas.height = Math.round(h * ratio); }
    if (follow && data.actors.length) {
      const all = data.actors.map((a) => pose(a, now)), n = all.length;
      box.x = all.reduce((s, p) => s + p.x, 0) / n; box.y = all.reduce((s, p) => s + p.y, 0) / n;
    }
    ink.setTransform(ratio, 0, 0, ratio, 0, 0);
    ink.fillStyle = COLOR.ground; ink.fillRect(0, 0, w, h);
    ink.save(); ink.translate(w / 2, h / 2); ink.scale(box.scale, -box.scale); ink.translate(-box.x, -box.y);
    drawNetwork(); data.actors.forEach(drawPath); data.actors.forEach(drawActor);
    ink.restore();
    drawContact(); data.actors.forEach(drawLabel);
    state();
  }
  function state() {
    $("time").value = now;
    $("clock").textContent = `${(now * step).toFixed(2)} / ${(last * step).toFixed(2)} s`;
    $("play").textContent = playing ? "❚❚" : "►";
    $("follow").setAttribute("aria-pressed", follow);
    [...$("legend").children].forEach((row, i) => {
      const v = pose(data.actors[i], now).speed;
      row.lastChild.textContent = `${data.actors[i].type} · ${(v * 2.23694).toFixed(0)} mph`;
    });
    const metres = [200, 100, 50, 20, 10, 5, 2].find((m) => m * box.scale < 130) || 1;
    $("scale").firstElementChild.style.width = `${metres * box.scale}px`; $("scale").lastElementChild.textContent = `${metres} m`;
  }

  // ---------------------------------------------------------------- pointing: a thing and its sentences, both ways
  function thingAt(px, py) {
    for (const actor of data.actors) {
      const p = pose(actor, now), [x, y] = toScreen(p.x, p.y);
      if (Math.hypot(px - x, py - y) < Math.max((actor.length_m / 2) * box.scale, 14)) return actor.id;
    }
    if (contact && contact.x !== undefined) { const [x, y] = toScreen(contact.x, contact.y); if (Math.hypot(px - x, py - y) < 14) return "contact"; }
    const [w, h] = size(), gx = box.x + (px - w / 2) / box.scale, gy = box.y - (py - h / 2) / box.scale;
    for (const [width, , flat, road] of data.drawing.strips) {
      if (!road) continue;
      for (let i = 2; i < flat.length; i += 2) {
        const [ax, ay, bx, by] = flat.slice(i - 2, i + 2), dx = bx - ax, dy = by - ay, long = dx * dx + dy * dy || 1;
        const u = Math.min(Math.max(((gx - ax) * dx + (gy - ay) * dy) / long, 0), 1);
        if (Math.hypot(gx - ax - u * dx, gy - ay - u * dy) < width / 2) return road;
      }
    }
    return "";
  }
  function point(things, sentence) {                     // things light up; so do the sentences that tell of them
    lit = new Set(things);
    const facts = things.flatMap((t) => (data.facts[t] || []).filter((f) => !sentence || f.of === sentence.of).map((f) => [t, f]));
    document.querySelectorAll("#narrative .told").forEach((span) => {
      const own = data.sentences[Number(span.dataset.k)];
      span.classList.toggle("lit", sentence ? own === sentence : own.things.some((t) => lit.has(t)));
    });
    if (!sentence) document.querySelector("#narrative .told.lit")?.scrollIntoView({ block: "nearest" });
    const because = $("because"); because.replaceChildren(); because.hidden = !facts.length;
    for (const [thing, f] of facts) {
      const text = `${thing} ${words(f.name)}: ${show(Array.isArray(f.value) ? f.value.join(", ") : f.value)}`;
      because.append(make("span", f.status === "default" ? `${text} (assumed)` : text, { className: f.status, title: f.status }));
    }
    draw();
  }
  function pointable(node, things, sentence) {
    node.onmouseenter = node.onfocus = node.onclick = () => point(things, sentence);
    node.onmouseleave = node.onblur = () => point([]);
    return node;
  }

  // ---------------------------------------------------------------- time
  function go(to) { now = Math.min(Math.max(to, 0), last); draw(); }
  function tick(time) {
    if (!playing) return;
    now += ((time - before) / 1000 / step) * Number($("rate").value); before = time;
    if (now >= last) { now = last; playing = false; }
    draw();
    if (playing) requestAnimationFrame(tick);
  }
  function toggle() {
    playing = !playing;
    if (playing) { if (now >= last) now = 0; before = performance.now(); requestAnimationFrame(tick); }
    draw();
  }
  const jump = () => { playing = false; if (moment) go(Math.round(momentStep)); };
  const followOn = () => { follow = !follow; if (follow) box.scale = Math.max(box.scale, 9); draw(); };

  $("play").onclick = toggle; $("fit").onclick = fit; $("hit").onclick = jump; $("follow").onclick = followOn;
  $("hit").hidden = !moment; if (closest) $("hit").textContent = "closest approach";
  $("time").max = last; $("time").oninput = (e) => { playing = false; go(Number(e.target.value)); };
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); zoom(Math.exp(-e.deltaY * 0.0015), e.offsetX, e.offsetY); }, { passive: false });
  let hovered = "";
  canvas.addEventListener("pointerleave", () => { hovered = ""; point([]); });
  canvas.addEventListener("pointerdown", (e) => canvas.setPointerCapture(e.pointerId));
  canvas.addEventListener("pointermove", (e) => {
    if (!e.buttons) { const at = thingAt(e.offsetX, e.offsetY); if (at !== hovered) { hovered = at; point(at ? [at] : []); } }
    if (e.buttons) { follow = false; box.x -= e.movementX / box.scale; box.y += e.movementY / box.scale; draw(); }
  });
  document.addEventListener("keydown", (e) => {
    if (e.key === "Escape") { point([]); return; }
    if (e.target.tagName === "SELECT" || e.ctrlKey || e.metaKey || e.altKey) return;
    const far = e.shiftKey ? 1 / step : 1, round = (v) => Math.round(v);
    const keys = { " ": toggle, ArrowRight: () => go(round(now) + far), ArrowLeft: () => go(round(now) - far), Home: () => go(0), End: () => go(last),
      c: jump, C: jump, 0: fit, "+": () => zoom(1.25), "=": () => zoom(1.25), "-": () => zoom(0.8), f: followOn, F: followOn };
    if (keys[e.key]) { e.preventDefault(); keys[e.key](); }
  });
  new ResizeObserver(() => draw()).observe(canvas);

  // ---------------------------------------------------------------- words and tables (text only, never markup)
  function make(tag, text, options = {}) {
    const made = Object.assign(document.createElement(tag), options);
    if (text !== undefined && text !== null) made.textContent = text;
    return made;
  }
  const words = (name) => String(name).replace(/_/g, " ");
  const show = (v) => v === null || v === undefined ? "–" : typeof v === "boolean" ? (v ? "yes" : "no") : typeof v === "number" ? (Number.isInteger(v) ? String(v) : v.toFixed(Math.abs(v) < 10 ? 3 : 1)) : words(v);
  function row(table, cells, head) {
    const line = table.insertRow();
    for (const cell of cells) {
      if (cell instanceof Node) line.append(cell);
      else line.append(make(head ? "th" : "td", show(cell), { className: typeof cell === "number" ? "n" : "" }));
    }
  }
  const pill = (actor) => { const td = make("td"), p = make("span", actor.id, { className: "pill" }); p.style.background = actor.color; td.append(p); return td; };
  const unit = (name) => name.replace(/_s$/, " (s)").replace(/_mps$/, " (m/s)").replace(/_m$/, " (m)");
  const seen = contact && declared && contact.actor !== declared.striker && contact.other === declared.striker
    ? [contact.other, contact.other_area, contact.actor, contact.actor_area] : contact && [contact.actor, contact.actor_area, contact.other, contact.other_area];
  function tell(place, text) {                           // the narrative, with its vehicles in their colors
    let from = 0;
    for (const hit of text.matchAll(/\b(?:vehicle\s*(?:#\s*)?|V)(\d{1,2})\b/gi)) {
      const actor = data.actors.find((a) => a.id === `V${Number(hit[1])}`);
      if (!actor) continue;
      place.append(text.slice(from, hit.index), make("mark", hit[0], { style: `background:${actor.color}` }));
      from = hit.index + hit[0].length;
    }
    place.append(text.slice(from));
  }
  const sides = (a, aSide, b, bSide) => `${a} ${aSide} → ${b} ${bSide}`;

  $("case").textContent = data.case;
  $("about").textContent = `config ${data.config} · ${data.status} · attempts: road ${data.attempts.road}, scenario ${data.attempts.scenario} · ${Object.values(data.seconds).reduce((a, b) => a + b, 0).toFixed(1)} s`;
  const verdict = $("verdict");
  if (contact) {
    verdict.textContent = `${sides(...seen)} at ${contact.t_s.toFixed(2)} s` + (declared ? (data.collision.realised ? " · as declared ✓" : " · not as declared ✗") : "");
    verdict.className = !declared ? "" : data.collision.realised ? "good" : "bad";
    $("mark").style.left = `calc(8px + (100% - 16px) * ${contactStep / Math.max(last, 1)})`;
  } else if (closest) {
    verdict.textContent = `near crash: ${closest.actor} and ${closest.other} closest ${closest.clearance_m.toFixed(1)} m at ${closest.t_s.toFixed(1)} s` + (near.realised ? " · as declared ✓" : " · not as declared ✗");
    verdict.className = near.realised ? "good" : "bad";
    $("mark").style.left = `calc(8px + (100% - 16px) * ${momentStep / Math.max(last, 1)})`;
  } else {
    verdict.textContent = declared ? "the declared contact did not happen ✗" : "no contact"; verdict.className = declared ? "bad" : "";
    $("mark").hidden = true;
  }
  for (const a of data.actors) { const line = make("span"), id = make("b", a.id); id.style.background = a.color; line.append(id, make("i", "", { style: "font-style:normal" })); line.tabIndex = 0; pointable(line, [a.id]); $("legend").append(line); }
  for (const url of data.diagrams) { const img = make("img", null, { src: url, alt: "Crash diagram of the report" }); img.onclick = () => img.classList.toggle("large"); $("diagrams").append(img); $("diagrams").hidden = false; }
  let read = 0;
  data.sentences.forEach((s, k) => {
    tell($("narrative"), data.narrative.slice(read, s.start));
    const span = pointable(make("span", "", { className: "told", tabIndex: 0 }), s.things, s);
    span.dataset.k = k; tell(span, data.narrative.slice(s.start, s.end)); $("narrative").append(span);
    read = s.end;
  });
  tell($("narrative"), data.narrative.slice(read));
  for (const thing of Object.keys(data.facts)) if (thing.startsWith("road ")) $("roads").append(pointable(make("button", thing), [thing]));
  if (data.facts.contact) $("roads").append(pointable(make("button", "contact"), ["contact"]));
  row($("actors"), ["", "type", "maneuver", "size"], true);
  for (const a of data.actors) row($("actors"), [pill(a), a.type, a.maneuver, `${a.length_m.toFixed(1)} × ${a.width_m.toFixed(1)} m`]);
  $("conditions").textContent = Object.entries(data.conditions).map(([k, v]) => `${k}: ${words(v)}`).join(" · ");
  row($("collision"), ["declared", declared ? sides(declared.striker, declared.striker_area, declared.struck, declared.struck_area) : "none"]);
  row($("collision"), ["observed", contact ? sides(...seen) : "none"]);
  if (contact) row($("collision"), ["first contact", `${contact.t_s.toFixed(2)} s`]);
  if (near) {
    const told = near.declared, c = told.conflict;
    row($("collision"), ["avoided", sides(c.striker, c.striker_area, c.struck, c.struck_area)]);
    row($("collision"), ["evasion", told.evasions.map((e) => `${e.actor} ${words(e.maneuver)}`).join(", ") || "not told"]);
    row($("collision"), ["clearance", `${told.clearance_m.toFixed(2)} m (${told.clearance_basis})`]);
    if (closest) row($("collision"), ["closest approach", `${closest.clearance_m.toFixed(2)} m at ${closest.t_s.toFixed(2)} s`]);
  }
  const realised = near ? near.realised : data.collision.realised;
  row($("collision"), ["realised", make("td", realised ? "yes" : "no", { className: realised ? "yes" : "no" })]);
  const net = data.network || {};
  for (const [k, v] of Object.entries(net)) if (k !== "segments") row($("network"), [words(k), v]);
  if (net.segments) row($("network"), ["roads (lanes →/←)", net.segments.map((s) => `${s.id} ${s.lanes_forward}/${s.lanes_backward}`).join(", ")]);
  const paper = data.metrics.paper || {}, exact = data.metrics.exact || {};
  row($("metrics"), ["", make("th", "paper's formula", { className: "n" }), make("th", "exact", { className: "n" })], true);
  for (const key of new Set([...Object.keys(paper), ...Object.keys(exact)])) row($("metrics"), [unit(key), ...[paper[key], exact[key]].map((v) => make("td", show(v), { className: "n" }))]);
  for (const [field, nats] of Object.entries(data.grounding || {})) {
    const chip = make("span", `${field}  ${nats.toFixed(2)}`), strength = Math.min(Math.abs(nats) / 4, 1);
    chip.style.background = nats >= 0 ? `rgba(27,127,77,${0.1 + 0.35 * strength})` : `rgba(196,32,58,${0.1 + 0.35 * strength})`;
    $("grounding").append(chip); $("groundcard").hidden = false;
  }
  fit();
  window.addEventListener("load", fit);
  const start = /[#&]t=([\d.]+)/.exec(location.hash);          // player.html#t=4.2 opens at that second
  if (start) go(Number(start[1]) / step);
})();
