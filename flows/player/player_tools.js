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
  const flatly = (v) => v && typeof v === "object" ? Object.entries(v).map(([k, one]) => `${k} ${show(one)}`).join(", ") : show(v);
  const pill = (actor) => { const td = make("td"), p = make("span", actor.id, { className: "pill" }); p.style.background = actor.label || actor.color; td.append(p); return td; };

  // ---------------------------------------------------------------- units
  const UNITS = [["mph", 2.23694], ["km/h", 3.6], ["m/s", 1]];
  let units = 0;
  const speedText = (mps) => `${(mps * UNITS[units][1]).toFixed(UNITS[units][0] === "m/s" ? 1 : 0)}\u00a0${UNITS[units][0]}`;
  for (const [name] of UNITS) $("unit").append(Object.assign(document.createElement("option"), { textContent: name }));
  function useUnit(k) { units = k; $("unit").selectedIndex = k; fillSpeeds(); drawPlots(); draw(); }
  const nextUnit = () => useUnit((units + 1) % UNITS.length);
  $("unit").onchange = (e) => useUnit(e.target.selectedIndex);

  // ---------------------------------------------------------------- speeds before and at the contact, and what it changes
  function fillSpeeds() {
    const table = $("speeds"), change = (data.metrics.exact || {}).delta_v_mps || {};
    table.replaceChildren();
    const at = contact ? arriving : moment ? Math.round(momentStep) : null;   // the last step before they touch
    row(table, ["", "at the start", ...(at === null ? [] : ["1 s before", contact ? "at contact" : "at the closest"]), ...(contact ? ["delta-v"] : [])], true);
    for (const a of data.actors) {
      const told = (k) => speedText(a.speed[Math.min(Math.max(k, 0), a.speed.length - 1)]);
      const cells = [told(0) + (guessed(a.id) ? " (assumed)" : ""), ...(at === null ? [] : [at * step < 1 ? "–" : told(at - Math.round(1 / step)), told(at)]), ...(contact ? [change[a.id] === undefined ? "–" : speedText(change[a.id])] : [])];
      row(table, [pill(a), ...cells.map((c) => make("td", c, { className: "n" }))]);
    }
  }

  // ---------------------------------------------------------------- plots under the slider; another run's lines are dashed
  const near0 = data.near, TTC_S = 6;
  const inUnits = (a) => [a.color, a.speed.map((v) => v * UNITS[units][1])];
  const ofPair = (name) => [near0, other && other.near].flatMap((n, k) => n ? [[k ? COLOR.faint : COLOR.line, n[name], k > 0]] : []);
  const PLOTS = [
    ["speed", () => [...data.actors.map(inUnits), ...(other ? inRun(other).map((a) => [...inUnits(a), true]) : [])], () => UNITS[units][0], Infinity],
    ["clearance", () => ofPair("clearance_m"), () => "m", 40],
    ["time to collision", () => ofPair("ttc_s"), () => "s", TTC_S],
  ];
  const plots = PLOTS.map(([name, lines, unitOf, most]) => {
    const box = document.createElement("figure"), line = document.createElement("canvas"), caption = document.createElement("figcaption");
    line.onclick = (e) => { playing = false; go((e.offsetX / line.clientWidth) * last); };
    box.append(caption, line); $("plots").append(box);
    return { name, lines, unitOf, most, line, caption };
  });
  function drawPlots() {
    for (const plot of plots) {
      const { line } = plot, lines = plot.lines(), w = line.clientWidth, h = line.clientHeight, ratio = window.devicePixelRatio || 1;
      line.parentElement.hidden = !lines.length;
      if (!w || !h || !lines.length) continue;
      line.width = Math.round(w * ratio); line.height = Math.round(h * ratio);
      const pen = line.getContext("2d"); pen.scale(ratio, ratio);
      const values = lines.flatMap(([, v]) => v.filter((x) => x !== null)), top = Math.min(Math.max(...values, 1e-3), plot.most) * 1.08;
      plot.top = top;
      for (const [color, series, dashed] of lines) {
        pen.beginPath(); pen.strokeStyle = color; pen.lineWidth = dashed ? 1.3 : 1.8; pen.setLineDash(dashed ? [5, 3] : []);
        let down = false;
        series.slice(0, last + 1).forEach((v, k) => { if (v === null) { down = false; return; } pen[down ? "lineTo" : "moveTo"]((k / Math.max(last, 1)) * w, h - 2 - (Math.min(v, top) / top) * (h - 6)); down = true; });
        pen.stroke();
      }
      if (moment) { pen.strokeStyle = COLOR.hit; pen.lineWidth = 1.5; pen.setLineDash([3, 3]); pen.beginPath(); pen.moveTo((momentStep / Math.max(last, 1)) * w, 0); pen.lineTo((momentStep / Math.max(last, 1)) * w, h); pen.stroke(); }
      plot.drawn = pen.getImageData(0, 0, line.width, line.height);
    }
    plotCursor();
  }
  function plotCursor() {                                // where the clock is, and what holds there
    for (const { name, lines, unitOf, line, caption, drawn, most } of plots) {
      const k = Math.min(Math.round(now), last), all = lines();
      const whole = unitOf() === "mph" || unitOf() === "km/h", at = (v) => most < Infinity ? v[Math.min(k, v.length - 1)] : speedNow(v);
      const said = (dashed) => all.filter((l) => Boolean(l[2]) === dashed).map(([, v]) => at(v)).map((v) => v === null || v === undefined ? "–" : v.toFixed(!whole && v < 10 ? 1 : 0)).join(" / ");
      const beyond = all.some((l) => l[2]) ? `, ${other.name} ${said(true)}` : "";
      caption.textContent = `${name}: ${said(false)}${beyond} ${unitOf()}${near0 && most < Infinity ? ` (${near0.pair.join("–")})` : ""}`;
      caption.title = caption.textContent;
      if (!drawn) continue;
      const pen = line.getContext("2d"), x = (now / Math.max(last, 1)) * line.width;
      pen.putImageData(drawn, 0, 0);
      pen.save(); pen.setTransform(1, 0, 0, 1, 0, 0); pen.fillStyle = COLOR.cursor; pen.fillRect(x - 1, 0, 2, line.height); pen.restore();
    }
  }
  new ResizeObserver(drawPlots).observe($("plots"));
  DARK.addEventListener("change", () => { useTheme(); drawPlots(); draw(); });

  // ---------------------------------------------------------------- layers, measuring
  for (const name of Object.keys(layer)) {
    const label = document.createElement("label"), check = Object.assign(document.createElement("input"), { type: "checkbox", checked: true, id: `layer-${name}` });
    check.onchange = () => { layer[name] = check.checked; draw(); };
    label.append(check, { paths: "paths", labels: "names of vehicles", rest: "rest poses", signs: "signs and arrows", names: "roads", assumed: "what is assumed", traffic: "traffic" }[name]);
    $("layers").append(label);
  }
  $("measure").onclick = () => { measuring = !measuring; measured = null; $("measure").setAttribute("aria-pressed", measuring); canvas.style.cursor = measuring ? "crosshair" : ""; draw(); };

  // ---------------------------------------------------------------- other runs: over this one or beside it
  const runs = [...(data.runs || [])];
  function listRuns() {
    $("other").replaceChildren(...[["", "this run alone"], ...runs.map((r, k) => [String(k), r.name])].map(([value, text]) => Object.assign(document.createElement("option"), { value, textContent: text })));
    $("beside").disabled = !other;
  }
  function choose(k) { other = runs[k] || null; $("other").value = other ? String(k) : ""; $("beside").disabled = !other; if (!other) { beside = false; $("beside").checked = false; } fit(); drawPlots(); }
  $("other").onchange = (e) => choose(e.target.value === "" ? -1 : Number(e.target.value));
  $("beside").onchange = (e) => { beside = e.target.checked; fit(); };
  function runIn(name, text) {                           // trajectories.csv, or another player's page
    const page = /<script type="application\/json" id="data">([\s\S]*?)<\/script>/.exec(text);
    if (page) { const shown = JSON.parse(page[1]); return { name, actors: shown.actors, near: shown.near }; }
    const [head, ...lines] = text.trim().split(/\r?\n/), names = head.split(","), found = new Map();
    if (!["actor", "x_m", "y_m", "heading_rad", "speed_mps"].every((n) => names.includes(n))) throw new Error("no trajectories.csv and no player.html");
    for (const line of lines) {
      const cells = Object.fromEntries(line.split(",").map((v, k) => [names[k], v]));
      if (cells.role === "traffic") continue;
      if (!found.has(cells.actor)) found.set(cells.actor, { id: cells.actor, x: [], y: [], heading: [], speed: [] });
      const a = found.get(cells.actor);
      a.x.push(Number(cells.x_m)); a.y.push(Number(cells.y_m)); a.heading.push(Number(cells.heading_rad)); a.speed.push(Number(cells.speed_mps));
    }
    return { name, actors: [...found.values()] };
  }
  $("add").onchange = async (e) => {
    for (const file of e.target.files) {
      try { runs.push(runIn(file.name, await file.text())); listRuns(); choose(runs.length - 1); $("runfault").textContent = ""; }
      catch (fault) { $("runfault").textContent = `${file.name}: ${fault.message}`; }
    }
    e.target.value = "";
  };
  listRuns();
