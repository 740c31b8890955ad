"use strict";
// The case gallery: filter, sort, and draw what scrolls into view. Everything from a report enters as text.
const data = JSON.parse(document.getElementById("data").textContent);
const byId = (id) => document.getElementById(id);
const PAGE = 8;
const HALF_DM = 420, PIXELS = 360;
let shown = [], made = 0;

function element(tag, className, text) {
  const node = document.createElement(tag);
  if (className) node.className = className;
  if (text !== undefined) node.textContent = text;
  return node;
}

// ---------------------------------------------------------------- filter and sort
const runs = (one, arm) => (arm < 0 ? one.arms : [one.arms[arm]]).filter(Boolean);
const wrong = (run) => run.right.filter((v) => v === 0).length;
const judged = (run) => run.right.some((v) => v !== null);
const stamp = (run) => run.status + run.declared + run.right.join("");

for (const one of data.cases) {
  one.words = (one.id + " " + one.text).toLowerCase();
  const all = one.arms.filter(Boolean);
  const errors = all.map((r) => r.error + wrong(r) + (r.status === "generated" ? 0 : 1));
  one.differ = new Set(all.map(stamp)).size - 1 + Math.max(...errors) - Math.min(...errors);
}

const FILTERS = {
  "": () => true,
  declared: (r) => r.declared === true,
  undeclared: (r) => r.declared === false,
  lacking: (r) => r.account?.verdict === "lacking",
  whole: (r) => r.account?.verdict === "whole",
  wrong: (r) => wrong(r) > 0,
  right: (r) => judged(r) && wrong(r) === 0,
};
const SORTS = {
  wrong: (one, arm) => Math.max(...runs(one, arm).map(wrong)),
  error: (one, arm) => Math.max(...runs(one, arm).map((r) => r.error)),
  lacking: (one, arm) => Math.max(...runs(one, arm).map((r) => r.account?.lacking ?? -1)),
  speed: (one, arm) => Math.max(...runs(one, arm).map((r) => r.speed ?? -1)),
  attempts: (one, arm) => Math.max(...runs(one, arm).map((r) => r.attempts ?? 0)),
  differ: (one) => one.differ,
};

function choose() {
  const words = byId("words").value.toLowerCase().split(/\s+/).filter(Boolean);
  const arm = Number(byId("arm").value), show = byId("show").value, sort = byId("sort").value;
  const fits = FILTERS[show] ?? ((r) => r.status === show);
  shown = data.cases.filter((one) => words.every((w) => one.words.includes(w)) && (show === "differ" ? one.differ > 0
    : show === "" ? arm < 0 || runs(one, arm).length : runs(one, arm).some(fits)));
  const rank = SORTS[sort];
  if (rank) {
    const keyed = shown.map((one) => [rank(one, arm), one]);
    keyed.sort((a, b) => b[0] - a[0] || (a[1].id < b[1].id ? -1 : 1));
    shown = keyed.map((pair) => pair[1]);
  } else shown.sort((a, b) => (a.id < b.id ? -1 : a.id > b.id ? 1 : 0));
  byId("count").textContent = shown.length === data.cases.length ? `${shown.length} cases` : `${shown.length} of ${data.cases.length} cases`;
  byId("gallery").replaceChildren();
  made = 0;
  if (!shown.length) byId("gallery").append(element("p", "empty", "No case matches the filters."));
  more();
}

function more() {
  const next = shown.slice(made, made + PAGE);
  made += next.length;
  byId("gallery").append(...next.map(card));
}

// ---------------------------------------------------------------- cards
function card(one) {
  const box = element("article", "card case"), left = element("div");
  left.append(element("h3", "", one.id));
  if (one.img) {
    const figure = element("figure"), image = element("img");
    image.alt = "crash diagram";
    image.src = one.img;
    figure.append(image);
    left.append(figure);
  }
  const story = element("p", "story");
  tell(story, one);
  story.title = "click for the whole report";
  story.addEventListener("click", () => story.classList.toggle("open"));
  left.append(story);
  const tiles = element("div", "tiles");
  one.arms.forEach((run, k) => tiles.append(tile(run, data.arms[k])));
  box.append(left, tiles);
  return box;
}

// The report, each sentence marked as it was read: by color, and what is not simply read in words too.
function tell(story, one) {
  let from = 0;
  for (const [start, end, mark] of one.told) {
    story.append(one.text.slice(from, start));
    const span = element("span", "told " + mark, one.text.slice(start, end));
    if (data.marked[mark]) span.append(element("sup", "", data.marked[mark]));
    story.append(span);
    from = end;
  }
  story.append(one.text.slice(from));
}

function tile(run, arm) {
  const box = element("div", "tile"), head = element("h4", "", arm.label);
  head.title = arm.name;
  box.append(head);
  if (!run) {
    box.append(element("div", "blank", "not done yet"));
    return box;
  }
  if (run.draw && run.status === "generated") {
    const canvas = element("canvas");
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "network, paths and first contact");
    box.append(canvas);
    pictures.set(canvas, run.draw);
    draw(canvas);
    eye.observe(canvas);
  } else box.append(element("div", "blank " + run.status, run.why || run.status));
  if (run.account) box.append(account(run.account));
  const line = element("p");
  const whole = !run.account || run.account.verdict === "whole";
  const good = run.status === "generated" && run.declared !== false && whole;
  const pill = run.status !== "generated" ? run.status : run.declared === false ? "crash not as declared" : run.declared ? "crash as declared" : "generated";
  line.append(element("span", "pill " + (good ? "good" : run.status === "refused" ? "" : run.status === "generated" && run.declared !== false ? "amber" : "bad"), pill));
  box.append(line);
  const o = run.observed;
  if (o) box.append(element("p", "", `${o.actor} ${o.actor_area} · ${o.other} ${o.other_area} at ${Number(o.t_s).toFixed(1)} s` + (run.speed != null ? `, closing at ${run.speed.toFixed(0)} m/s` : "")));
  const marks = element("div", "marks");
  if (run.status === "generated") run.right.forEach((v, k) => v !== null && marks.append(element("span", v ? "" : "no", (v ? "✓ " : "✗ ") + data.verdicts[k])));
  box.append(marks);
  if (run.player) {
    const link = element("a", "", "player");
    link.href = run.player;
    const p = element("p");
    p.append(link);
    box.append(p);
  }
  return box;
}

// The verdict, in the sentence that stands everywhere else too: words and a mark, not color alone.
function account(a) {
  const whole = a.verdict === "whole";
  const text = a.sentence || `${a.verdict}: ${a.has} of ${a.told} things told are there, ${a.assumed} assumed`;
  return element("p", "account " + (whole ? "good" : "amber"), `${whole ? "✓" : "⚠"} ${text.charAt(0).toUpperCase()}${text.slice(1)}`);
}

// ---------------------------------------------------------------- networks
// Pixels are held near the window only: 500 cases times 7 arms would take 2 GB.
const pictures = new WeakMap();
const eye = new IntersectionObserver((seen) => {
  for (const { isIntersecting, target } of seen) {
    if (isIntersecting) draw(target);
    else target.width = target.height = 1;
  }
}, { rootMargin: "900px" });

function trace(pen, flat, close) {
  pen.beginPath();
  for (let k = 0; k < flat.length; k += 2) pen.lineTo(flat[k], flat[k + 1]);
  if (close) pen.closePath();
}

function draw(canvas) {
  if (canvas.width === PIXELS) return;
  const what = pictures.get(canvas);
  canvas.width = canvas.height = PIXELS;
  const pen = canvas.getContext("2d"), scale = canvas.width / (2 * HALF_DM);
  pen.setTransform(scale, 0, 0, -scale, canvas.width / 2, canvas.height / 2);
  pen.lineJoin = "round";
  for (const [color, inset] of [["#a3a9ae", 0], ["#5b6067", 3.2]]) {
    pen.strokeStyle = color;
    for (const [width, flat] of what.lanes) { trace(pen, flat); pen.lineWidth = width - inset; pen.stroke(); }
  }
  pen.fillStyle = "#5b6067";
  for (const flat of what.areas) { trace(pen, flat, true); pen.fill(); }
  for (const mover of what.movers) {
    pen.strokeStyle = mover.color;
    pen.lineWidth = 6;
    trace(pen, mover.way);
    pen.stroke();
  }
  for (const mover of what.movers) {
    const [x, y, heading] = mover.at, [length, width] = mover.size;
    pen.save();
    pen.translate(x, y);
    pen.rotate(heading);
    pen.fillStyle = mover.color;
    pen.strokeStyle = "#fff";
    pen.lineWidth = 3;
    pen.beginPath();
    pen.rect(-length / 2, -width / 2, length, width);
    pen.fill();
    pen.stroke();
    pen.restore();
  }
}

// ---------------------------------------------------------------- start
byId("arm").append(new Option("any", "-1"), ...data.arms.map((a, k) => new Option(a.label, String(k))));
for (const id of ["arm", "show", "sort"]) byId(id).addEventListener("change", choose);
let typing;
byId("words").addEventListener("input", () => { clearTimeout(typing); typing = setTimeout(choose, 120); });
byId("tools").addEventListener("submit", (event) => event.preventDefault());
new IntersectionObserver((seen) => seen.some((s) => s.isIntersecting) && made < shown.length && more(), { rootMargin: "900px" }).observe(byId("more"));
if (data.arms.length === 1) byId("gallery").className = "alone"; else byId("by").textContent = " (by the reference, or the first arm that has the case)";
const wish = new URLSearchParams(location.hash.slice(1));
for (const id of ["words", "arm", "show", "sort"]) if (wish.has(id)) byId(id).value = wish.get(id);
choose();
