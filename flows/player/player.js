// The stage: what is drawn, when, and how one moves about. player_tools.js and player_words.js go on in the same function.
  const $ = (id) => document.getElementById(id);
  const data = JSON.parse($("data").textContent);
  const canvas = $("view"), ink = canvas.getContext("2d");
  const last = Math.max(data.t_s.length - 1, 0), step = last ? data.t_s[1] - data.t_s[0] : 0.05;
  const contact = data.collision.observed, declared = data.collision.declared;
  const near = data.near_crash, closest = near && !contact ? near.observed : null;
  const moment = contact || closest, momentStep = moment ? moment.t_s / step : null, contactStep = contact ? momentStep : null;
  const COLOR = { asphalt: "#5d636a", edge: "#f2f2ee", lane: "#f2f2ee", center: "#efbf3f", stop: "#ffffff", hit: "#d7263d", lit: "#b99a2e", halo: "#ffd84d", cone: "#ff7a1a" };
  const DARK = matchMedia("(prefers-color-scheme: dark)");
  const useTheme = () => Object.assign(COLOR, DARK.matches
    ? { ground: "#242b2a", verge: "#37403d", curb: "#8d8f8a", ditch: "#3a4238", embankment: "#303a33", groundLine: "#57625a", path: "#85837b", text: "#e4e7e9", line: "#c3ccd2", faint: "#e58fc4", cursor: "#58b4dc" }
    : { ground: "#e9ece4", verge: "#d3d8cc", curb: "#8f918b", ditch: "#cfc6ae", embankment: "#dde3cf", groundLine: "#a3a890", path: "#a9a69c", text: "#22282d", line: "#3b444c", faint: "#a0447a", cursor: "#0b6e99" });
  useTheme();
  const WIDTH_M = { edge: 0.15, lane: 0.15, center: 0.2, stop: 0.55 };
  const seated = parent !== window && /[#&]embed\b/.test(location.hash);   // in the desk: the stage alone, which says what is pointed at
  document.body.classList.toggle("seated", seated);
  let lit = new Set();                                   // things pointed at: "V1", "road main", "contact"
  const layer = { paths: true, labels: true, rest: true, signs: true, names: true, assumed: true, ...((data.traffic || []).length ? { traffic: true } : {}) };
  let other = null, beside = false, measured = null;     // another run, whether it has a half of its own, two points in metres
  let pane = { left: 0, wide: 0, actors: data.actors };  // the half that is drawn into
  let now = 0, playing = false, before = 0, follow = false, box = { x: 0, y: 0, scale: 4 };

  // ---------------------------------------------------------------- view
  const size = () => [canvas.clientWidth, canvas.clientHeight];
  const toScreen = (x, y) => { const h = size()[1]; return [pane.left + pane.wide / 2 + (x - box.x) * box.scale, h / 2 - (y - box.y) * box.scale]; };
  function toGround(px, py) { const [w, h] = size(), wide = beside && other ? w / 2 : w; return [box.x + ((px % wide) - wide / 2) / box.scale, box.y - (py - h / 2) / box.scale]; }
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
    const end = actor.x.length - 1, k = Math.min(Math.floor(at), end), n = Math.min(k + 1, end), u = Math.min(at - k, 1);
    let turn = actor.heading[n] - actor.heading[k];
    turn = Math.atan2(Math.sin(turn), Math.cos(turn));
    return { x: actor.x[k] + u * (actor.x[n] - actor.x[k]), y: actor.y[k] + u * (actor.y[n] - actor.y[k]),
      heading: actor.heading[k] + u * turn, speed: actor.speed[k] + u * (actor.speed[n] - actor.speed[k]),
      roll: actor.roll ? actor.roll[k] + u * (actor.roll[n] - actor.roll[k]) : 0 };
  }
  const lies = (roll) => ["on its wheels", "on its right side", "on its roof", "on its left side"][((Math.round(roll / (Math.PI / 2)) % 4) + 4) % 4];

  // ---------------------------------------------------------------- drawing
  function trace(flat) {
    ink.beginPath();
    for (let i = 0; i < flat.length; i += 2) ink[i ? "lineTo" : "moveTo"](flat[i], flat[i + 1]);
  }
  function drawNetwork() {
    ink.lineJoin = "round"; ink.lineCap = "butt";
    for (const pass of [0.9, 0]) {                       // a pale verge first, then the asphalt
      for (const area of data.drawing.areas) {
        trace(area); ink.closePath(); ink.fillStyle = ink.strokeStyle = pass ? COLOR.verge : COLOR.asphalt;
        ink.lineWidth = pass * 2; ink.fill(); if (pass) ink.stroke();
      }
      for (const [width, cars, flat, road] of data.drawing.strips) {
        const asphalt = lit.has(road) ? COLOR.lit : COLOR.asphalt;
        trace(flat); ink.lineWidth = width + pass * 2 + 0.05; ink.strokeStyle = pass ? COLOR.verge : cars ? asphalt : COLOR.path; ink.stroke();
      }
    }
    for (const [kind, area] of data.drawing.grounds || []) {      // curbs, ditches, embankments: strips, hatched across
      trace(area); ink.closePath(); ink.fillStyle = COLOR[kind]; ink.fill();
      ink.strokeStyle = COLOR.groundLine; ink.lineWidth = kind === "curb" ? Math.max(0.12, 0.9 / box.scale) : 0.12; ink.stroke();
      if (kind === "curb") continue;
      const n = area.length;
      for (let i = 0; i < n / 2; i += 2) { trace([area[i], area[i + 1], area[n - 2 - i], area[n - 1 - i]]); ink.stroke(); }
    }
    for (const gore of data.drawing.gores || []) {         // painted triangles: asphalt, hatched
      trace(gore); ink.closePath(); ink.fillStyle = COLOR.asphalt; ink.fill(); ink.save(); ink.clip();
      ink.strokeStyle = COLOR.edge; ink.lineWidth = 0.35;
      for (let i = 2; i < gore.length / 2; i += 4) {
        const n = gore.length; trace([gore[i], gore[i + 1], gore[n - 2 - i], gore[n - 1 - i]]); ink.stroke();
      }
      ink.restore(); trace(gore); ink.closePath(); ink.lineWidth = Math.max(0.15, 0.9 / box.scale); ink.strokeStyle = COLOR.edge; ink.stroke();
    }
    for (const [width, flat] of data.drawing.crossings || []) {   // bars across the way that is walked
      trace(flat); ink.lineWidth = width; ink.strokeStyle = COLOR.edge; ink.setLineDash([0.5, 0.6]); ink.stroke();
    }
    ink.setLineDash([]);
    for (const [style, flat] of data.drawing.lines) {
      trace(flat); ink.lineWidth = Math.max(WIDTH_M[style], 0.9 / box.scale); ink.strokeStyle = COLOR[style];
      ink.setLineDash(style === "lane" ? [3, 6] : []); ink.stroke();
    }
    ink.setLineDash([]);
    const cones = data.drawing.cones || [], wide = Math.max(0.22, 1.6 / box.scale);
    for (let i = 0; i < cones.length; i += 2) {
      ink.beginPath(); ink.arc(cones[i], cones[i + 1], wide, 0, 7); ink.fillStyle = COLOR.cone; ink.fill();
    }
  }
  function arrow(directions) {                           // painted ahead along x: one stem, a head each way
    ink.beginPath(); ink.moveTo(-2, 0); ink.lineTo(0.6, 0);
    for (const way of directions) {
      const turn = { s: 0, l: Math.PI / 2, r: -Math.PI / 2, t: Math.PI * 0.95 }[way];
      if (turn === undefined) continue;
      const x = 0.6 + 1.1 * Math.cos(turn), y = 1.1 * Math.sin(turn), dx = Math.cos(turn), dy = Math.sin(turn);
      ink.moveTo(0.6, 0); ink.lineTo(x, y);
      ink.moveTo(x - 0.5 * dx + 0.35 * dy, y - 0.5 * dy - 0.35 * dx); ink.lineTo(x, y); ink.lineTo(x - 0.5 * dx - 0.35 * dy, y - 0.5 * dy + 0.35 * dx);
    }
    ink.strokeStyle = COLOR.edge; ink.lineWidth = 0.22; ink.lineCap = "butt"; ink.stroke();
  }
  const LAMPS = { red: [0], "red-yellow": [0, 1], yellow: [1], flashing: [1], green: [2] };
  const showing = (edge) => ((data.signals || {})[edge] || []).reduce((state, [from, next]) => (from <= now ? next : state), "");
  function drawMarks() {
    const big = Math.max(1, 9 / (box.scale * 1.1));        // a sign is at least some pixels high
    for (const [kind, x, y, heading, directions] of data.drawing.marks || []) {
      ink.save(); ink.translate(x, y); ink.rotate(heading);
      if (kind === "arrow") { if (box.scale > 2.5) arrow(directions); }
      else {
        ink.scale(big, big); ink.lineWidth = 0.14; ink.strokeStyle = "#fff"; ink.beginPath();
        if (kind === "stop") {
          for (let i = 0; i < 8; i++) ink[i ? "lineTo" : "moveTo"](0.75 * Math.cos((i + 0.5) * Math.PI / 4), 0.75 * Math.sin((i + 0.5) * Math.PI / 4));
          ink.closePath(); ink.fillStyle = "#c1121f"; ink.fill(); ink.stroke();
        } else {
          ink.roundRect(-1.1, -0.45, 2.2, 0.9, 0.25); ink.fillStyle = "#1d2329"; ink.fill(); ink.stroke();
          const lamp = LAMPS[showing(directions)] || [];                            // without a plan all three stay dark
          ["#ff4d4f", "#ffc533", "#38d66b"].forEach((c, i) => { ink.beginPath(); ink.arc(0.68 - 0.68 * i, 0, 0.24, 0, 7); ink.fillStyle = lamp.includes(i) ? c : "#4a535b"; ink.fill(); });
        }
      }
      ink.restore();
    }
  }
  const covers = [$("legend"), $("compass")].map((part) => [part, 60]);
  function covered(x, y) {                               // under the legend or the compass, which lie over the map
    return covers.some(([part, by]) => x > part.offsetLeft - by && x < part.offsetLeft + part.offsetWidth + by && y < part.offsetTop + part.offsetHeight + 12);
  }
  function placesOf(road) {                              // points along a road's lanes that are in view, in pixels
    const h = size()[1], found = [];
    for (const [, cars, flat, name] of data.drawing.strips) {
      if (name !== road || !cars) continue;
      for (let i = 2; i < flat.length; i += 2) {
        for (let u = 0; u <= 1; u += 0.05) {
          const [x, y] = toScreen(flat[i - 2] + u * (flat[i] - flat[i - 2]), flat[i - 1] + u * (flat[i + 1] - flat[i - 1]));
          if (x > pane.left + 70 && x < pane.left + pane.wide - 70 && y > 24 && y < h - 24 && !covered(x, y)) found.push([x, y]);
        }
      }
    }
    return found;
  }
  function drawNames() {                                 // a road's name on it, as far from the vehicles as it is in view
    const busy = pane.actors.map((a) => { const p = pose(a, now); return toScreen(p.x, p.y); });
    if (contact && contact.x !== undefined) busy.push(toScreen(contact.x, contact.y));
    ink.font = "600 11px system-ui, sans-serif"; ink.textAlign = "center"; ink.textBaseline = "middle";
    for (const road of new Set(data.drawing.strips.map((s) => s[3]).filter(Boolean))) {
      const guess = (data.facts[road] || []).filter((f) => f.status === "default").length, name = (data.facts[road] || []).find((f) => f.name === "name");
      const text = `${road.replace(/^road /, "").replaceAll("_", " ")}${name ? ` (${name.value})` : ""} road${guess && layer.assumed ? " · partly assumed" : ""}`;
      const away = ([x, y]) => Math.min(...busy.map(([u, v]) => Math.hypot(x - u, y - v)), 1e6), wide = ink.measureText(text).width / 2 + 8;
      const best = placesOf(road).reduce((a, b) => !a || away(b) > away(a) + 1 ? b : a, null);
      if (!best) continue;
      const [x, y] = best;
      ink.fillStyle = "rgba(255,255,255,.82)"; ink.strokeStyle = guess && layer.assumed ? "#59636c" : "rgba(0,0,0,0)"; ink.setLineDash([4, 3]); ink.lineWidth = 1.5;
      ink.beginPath(); ink.roundRect(x - wide, y - 9, 2 * wide, 18, 5); ink.fill(); ink.stroke(); ink.setLineDash([]);
      ink.fillStyle = "#3b444c"; ink.fillText(text, x, y);
    }
  }
  function outline(actor, p) { ink.translate(p.x, p.y); ink.rotate(p.heading); ink.beginPath(); ink.roundRect(-actor.length_m / 2, -actor.width_m / 2, actor.length_m, actor.width_m, 0.3); }
  function drawGhost(actor, p, dash, alpha) {             // an outline: where one comes to rest, or is in another run
    ink.save(); outline(actor, p); ink.globalAlpha = alpha; ink.strokeStyle = actor.color; ink.lineWidth = 2 / box.scale;
    ink.setLineDash(dash.map((v) => v / box.scale)); ink.fillStyle = actor.color; ink.stroke(); ink.globalAlpha = alpha * 0.18; ink.fill(); ink.restore();
  }
  const restOf = (actor) => pose(actor, actor.x.length - 1);
  const inRun = (run) => data.actors.flatMap((a) => { const found = run.actors.find((b) => b.id === a.id); return found ? [{ ...a, ...found }] : []; });
  const assumedOf = (id) => (data.facts[id] || []).filter((f) => f.status === "default");
  function drawPath(actor) {
    const k = Math.floor(now), last = actor.x.length - 1;
    for (const [from, to, alpha, width] of [[0, last, 0.6, 2], [0, k, 0.95, 3]]) {
      ink.beginPath();
      for (let i = from; i <= Math.min(to, last); i++) ink[i > from ? "lineTo" : "moveTo"](actor.x[i], actor.y[i]);
      ink.globalAlpha = alpha; ink.strokeStyle = actor.color; ink.lineWidth = width / box.scale; ink.lineCap = "round";
      ink.setLineDash(to === last && from === 0 && alpha < 0.7 ? [6 / box.scale, 6 / box.scale] : []); ink.stroke();
    }
    ink.setLineDash([]); ink.globalAlpha = 1;
  }
  function drawBelly(l, w, roll) {                       // rolled over: what faces up is a flank, or the underside with its wheels
    const side = Math.abs(Math.cos(roll)) < 0.5, up = Math.sin(roll) > 0 ? -1 : 1;   // on its right side the wheels point to the left
    ink.fillStyle = "rgba(20,24,28,.72)";
    if (!side) { ink.beginPath(); ink.roundRect(-l * 0.42, -w * 0.32, l * 0.84, w * 0.64, 0.15); ink.fill(); }
    for (const at of [-0.3, 0.3]) for (const edge of side ? [-up] : [-1, 1]) {
      ink.fillStyle = "#11161b"; ink.beginPath(); ink.roundRect(l * at - 0.34, edge * w * 0.4 - 0.16, 0.68, 0.32, 0.1); ink.fill();
      ink.strokeStyle = "#aab3ba"; ink.lineWidth = 0.06; ink.stroke();
    }
  }
  function drawActor(actor) {
    const p = pose(actor, now), l = actor.length_m, w = actor.width_m, thin = 1.2 / box.scale;
    ink.save(); ink.translate(p.x, p.y); ink.rotate(p.heading);
    ink.beginPath();
    if (actor.outline === "round") ink.arc(0, 0, Math.max(l, w) / 2, 0, 7); else ink.roundRect(-l / 2, -w / 2, l, w, Math.min(w * 0.22, 0.5));
    if (lit.has(actor.id)) { ink.strokeStyle = COLOR.halo; ink.lineWidth = 9 / box.scale; ink.stroke(); }
    ink.fillStyle = actor.color; ink.strokeStyle = "#fff"; ink.lineWidth = thin * 1.5;
    if (layer.assumed && assumedOf(actor.id).length) ink.setLineDash([5 / box.scale, 4 / box.scale]);   // told: a whole outline
    ink.shadowColor = "rgba(0,0,0,.45)"; ink.shadowBlur = 7; ink.fill(); ink.shadowBlur = 0; ink.stroke(); ink.setLineDash([]);
    if (Math.cos(p.roll) < 0.5) drawBelly(l, w, p.roll);
    else if (actor.outline === "cab" && w > 1) {
      const glass = l / 2 - Math.min(l * 0.3, 1.9);
      ink.fillStyle = "rgba(15,25,35,.62)"; ink.beginPath();                       // windshield: which way is front
      ink.moveTo(glass, -w * 0.4); ink.lineTo(glass + 0.6, -w * 0.34); ink.lineTo(glass + 0.6, w * 0.34); ink.lineTo(glass, w * 0.4); ink.fill();
      ink.fillStyle = "#fff6cf"; for (const s of [-1, 1]) ink.fillRect(l / 2 - 0.28, s * w * 0.33 - 0.18, 0.2, 0.36);
    }
    if (w <= 1 && actor.outline !== "round") { ink.fillStyle = "#fff"; ink.beginPath(); ink.arc(l * 0.3, 0, w * 0.2, 0, 7); ink.fill(); }
    ink.restore();
  }
  function drawBackground(vehicle) {                     // no part of the crash: paler, without shadow, path and label
    const p = pose(vehicle, now), l = vehicle.length_m, w = vehicle.width_m, glass = l / 2 - Math.min(l * 0.3, 1.9);
    ink.save(); outline(vehicle, p); ink.globalAlpha = 0.8; ink.fillStyle = vehicle.color; ink.fill();
    ink.fillStyle = "rgba(15,25,35,.4)"; ink.fillRect(glass, -w * 0.38, 0.6, w * 0.76); ink.restore();
  }
  function labelPlace(actor) {                           // beside the box, away from the others where they are near
    const p = pose(actor, now), [x, y] = toScreen(p.x, p.y), reach = actor.length_m * box.scale * 0.5;
    const met = pane.actors.some((one) => { const q = pose(one, now); return one !== actor && Math.hypot(p.x - q.x, p.y - q.y) < actor.length_m + one.length_m; });
    const lift = (met ? 1.6 * Math.min(reach, 60) : Math.min(reach, 40)) + 16;   // further off where two meet: the contact stays free
    let dx = 0, dy = 0;
    for (const one of pane.actors) {
      const q = pose(one, now), [u, v] = toScreen(q.x, q.y), gap = Math.hypot(x - u, y - v);
      if (one !== actor && gap < 90) { dx += (x - u) / (gap + 1); dy += (y - v) / (gap + 1); }
    }
    const far = Math.hypot(dx, dy);
    return far > 0.2 ? [x + (lift * dx) / far, y + (lift * dy) / far] : [x, y - lift];
  }
  function drawLabel(actor) {
    const [x, y] = labelPlace(actor);
    ink.font = "700 12px system-ui, sans-serif"; ink.textAlign = "center"; ink.textBaseline = "middle";
    const wide = ink.measureText(actor.id).width + 12, p = pose(actor, now), [u, v] = toScreen(p.x, p.y);
    ink.strokeStyle = actor.color; ink.lineWidth = 1; ink.beginPath(); ink.moveTo(u, v); ink.lineTo(x, y); ink.stroke();
    ink.fillStyle = actor.label || actor.color; ink.strokeStyle = "#fff"; ink.lineWidth = 1.5;
    ink.beginPath(); ink.roundRect(x - wide / 2, y - 9, wide, 18, 9); ink.fill(); ink.stroke();
    ink.fillStyle = "#fff"; ink.fillText(actor.id, x, y + 0.5);
  }
  function drawContact() {
    if (!contact || contact.x === undefined || pane.actors !== data.actors) return;
    const [x, y] = toScreen(contact.x, contact.y), since = now - contactStep, hit = since >= -0.5;
    const still = Math.min(Math.max(1.1 * box.scale, 5), 10), close = box.scale > 20, big = hit && !close ? still + 3 * Math.max(0, 1 - since * step / 0.6) : close ? 7 : 6;
    ink.beginPath();
    for (let i = 0; i < 20; i++) {
      const r = i % 2 ? big * 0.45 : big, a = (i * Math.PI) / 10;
      ink[i ? "lineTo" : "moveTo"](x + r * Math.cos(a), y + r * Math.sin(a));
    }
    ink.closePath();
    if (lit.has("contact")) { ink.strokeStyle = COLOR.halo; ink.lineWidth = 8; ink.stroke(); }
    ink.lineWidth = 1.5; ink.strokeStyle = hit ? "#fff" : COLOR.hit;
    if (hit) { ink.fillStyle = COLOR.hit; ink.globalAlpha = 0.55; ink.fill(); ink.globalAlpha = 1; }
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
    const halves = beside && other ? 2 : 1;
    for (let k = 0; k < halves; k++) drawPane({ left: (k * w) / halves, wide: w / halves, actors: k ? inRun(other) : data.actors, name: k ? other.name : data.name || "script" }, h, halves);
    pane = { left: 0, wide: w / halves, actors: data.actors };
    state();
  }
  function drawPane(here, h, halves) {
    pane = here;
    ink.save(); ink.beginPath(); ink.rect(pane.left, 0, pane.wide, h); ink.clip();
    ink.save(); ink.translate(pane.left + pane.wide / 2, h / 2); ink.scale(box.scale, -box.scale); ink.translate(-box.x, -box.y);
    drawNetwork(); if (layer.signs) drawMarks();
    if (layer.paths) pane.actors.forEach(drawPath);
    if (layer.rest) pane.actors.forEach((a) => { if (now < a.x.length - 2) drawGhost(a, restOf(a), [2, 3], 0.75); });
    if (other && halves === 1) inRun(other).forEach((a) => drawGhost(a, pose(a, now), [7, 4], 1));
    if (layer.traffic) (data.traffic || []).forEach(drawBackground);
    pane.actors.forEach(drawActor);
    ink.restore();
    if (layer.names) drawNames();
    drawContact(); if (layer.labels) pane.actors.forEach(drawLabel);
    if (measured) drawMeasure();
    if (halves > 1) { ink.fillStyle = COLOR.text; ink.font = "700 13px system-ui, sans-serif"; ink.textAlign = "center"; ink.fillText(pane.name, pane.left + pane.wide / 2, h - 14); ink.fillRect(pane.left - 1, 0, 2, h); }
    ink.restore();
  }
  function drawMeasure() {
    const [a, b = a] = measured, [x, y] = toScreen(...a), [u, v] = toScreen(...b), long = Math.hypot(a[0] - b[0], a[1] - b[1]);
    ink.strokeStyle = "#7209b7"; ink.lineWidth = 2; ink.beginPath(); ink.moveTo(x, y); ink.lineTo(u, v); ink.stroke();
    for (const [p, q] of [[x, y], [u, v]]) { ink.beginPath(); ink.arc(p, q, 4, 0, 7); ink.fillStyle = "#7209b7"; ink.fill(); }
    const text = `${long.toFixed(2)} m`; ink.font = "700 13px system-ui, sans-serif"; ink.textAlign = "center"; ink.textBaseline = "middle";
    const wide = ink.measureText(text).width / 2 + 7; ink.fillStyle = "#fff"; ink.beginPath(); ink.roundRect((x + u) / 2 - wide, (y + v) / 2 - 11, 2 * wide, 22, 6); ink.fill(); ink.fillStyle = "#7209b7"; ink.fillText(text, (x + u) / 2, (y + v) / 2);
  }
  const guessed = (id) => (data.facts[id] || []).some((f) => f.name === "start_speed_mph" && f.status === "default");
  const arriving = contact ? Math.max(Math.ceil(contactStep) - 1, 0) : null;   // the last step before they touch: from the contact on, speeds are pushed ones
  const speedNow = (speeds) => speeds[Math.min(arriving !== null && now > arriving && now <= contactStep ? arriving : Math.round(now), speeds.length - 1)];
  function state() {
    $("time").value = now;
    $("clock").textContent = `${(now * step).toFixed(2)} / ${(last * step).toFixed(2)} s`;
    $("play").textContent = playing ? "❚❚" : "►";
    $("follow").setAttribute("aria-pressed", follow);
    [...$("legend").children].forEach((row, i) => {
      const p = pose(data.actors[i], now), lying = Math.cos(p.roll) < 0.5 ? ` · ${lies(p.roll)}` : "";
      row.lastChild.textContent = `${data.actors[i].type} · ${speedText(speedNow(data.actors[i].speed))}${guessed(data.actors[i].id) && !(now > contactStep && contact) ? " (assumed)" : ""}${lying}`;
    });
    plotCursor();
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
    const [gx, gy] = toGround(px, py);
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
  function point(things, sentence, told) {               // things light up; so do the sentences that tell of them
    lit = new Set(things);
    if (seated && !told) parent.postMessage({ sgcad: "pointed", things }, "*");
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
  function closeUp() {                                   // the two that meet, at that instant, as large as they fit
    const two = (data.near ? data.near.pair : []).map((id) => data.actors.find((a) => a.id === id)).filter(Boolean);
    if (!two.length) return;
    playing = false; follow = false;
    if (moment) now = Math.min(Math.round(momentStep), last);
    const poses = two.map((a) => pose(a, now)), [w, h] = size(), wide = beside && other ? w / 2 : w;
    const xs = poses.map((p) => p.x), ys = poses.map((p) => p.y), reach = Math.max(...two.map((a) => a.length_m));
    const across = Math.max(...xs) - Math.min(...xs) + 1.7 * reach, high = Math.max(...ys) - Math.min(...ys) + 1.7 * reach;
    box = { x: (Math.max(...xs) + Math.min(...xs)) / 2, y: (Math.max(...ys) + Math.min(...ys)) / 2, scale: Math.min(wide / across, h / high, 60) };
    draw();
  }
  const followOn = () => { follow = !follow; if (follow) box.scale = Math.max(box.scale, 9); draw(); };

  $("play").onclick = toggle; $("fit").onclick = fit; $("hit").onclick = jump; $("close").onclick = closeUp; $("close").hidden = !data.near; $("follow").onclick = followOn;
  $("hit").hidden = !moment; if (closest) $("hit").textContent = "closest approach";
  $("time").max = last; $("time").oninput = (e) => { playing = false; go(Number(e.target.value)); };
  canvas.addEventListener("wheel", (e) => { e.preventDefault(); zoom(Math.exp(-e.deltaY * 0.0015), e.offsetX, e.offsetY); }, { passive: false });
  let hovered = "", picked = "", pressed = null, measuring = false;
  canvas.addEventListener("pointerleave", () => { hovered = ""; point(picked ? [picked] : []); });
  canvas.addEventListener("pointerdown", (e) => { canvas.setPointerCapture(e.pointerId); pressed = [e.offsetX, e.offsetY]; });
  canvas.addEventListener("pointerup", (e) => {           // a press without a drag picks, or sets a point to measure from
    if (!pressed || Math.hypot(e.offsetX - pressed[0], e.offsetY - pressed[1]) > 4) return;
    const at = toGround(e.offsetX, e.offsetY);
    if (measuring) { measured = measured && measured.length === 1 ? [measured[0], at] : [at]; draw(); return; }
    const thing = thingAt(e.offsetX, e.offsetY);
    picked = thing && thing !== picked ? thing : ""; point(picked ? [picked] : []);
  });
  canvas.addEventListener("pointermove", (e) => {
    if (!e.buttons) { const at = thingAt(e.offsetX, e.offsetY); if (at !== hovered) { hovered = at; point(at ? [at] : picked ? [picked] : []); } }
    if (e.buttons) { follow = false; box.x -= e.movementX / box.scale; box.y += e.movementY / box.scale; draw(); }
  });
  document.addEventListener("keydown", (e) => {
    if (e.key === "Escape") { picked = ""; measured = null; point([]); return; }
    if (["SELECT", "INPUT"].includes(e.target.tagName) && e.target.id !== "time" && e.key !== "z" || e.ctrlKey || e.metaKey || e.altKey) return;
    const far = e.shiftKey ? 1 / step : 1, round = (v) => Math.round(v);
    const keys = { " ": toggle, ArrowRight: () => go(round(now) + far), ArrowLeft: () => go(round(now) - far), Home: () => go(0), End: () => go(last),
      c: jump, C: jump, 0: fit, "+": () => zoom(1.25), "=": () => zoom(1.25), "-": () => zoom(0.8), f: followOn, F: followOn,
      z: closeUp, Z: closeUp, m: () => $("measure").click(), M: () => $("measure").click(), u: nextUnit, U: nextUnit };
    if (keys[e.key]) { e.preventDefault(); keys[e.key](); }
  });
  new ResizeObserver(() => (seated && !now ? fit() : draw())).observe(canvas);   // a frame gets its size late
