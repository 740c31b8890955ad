  // ---------------------------------------------------------------- explanations of the metrics
  const EXPLAIN = {
    collision_probability: "share of instants with overlapping boxes; small even with a collision, since it depends on the duration",
    near_miss_probability: "share of instants with centers nearer than a vehicle length plus one meter",
    collision: "whether any two boxes overlap",
    collision_speed_mps: "relative speed in the step that ends in the first contact",
    time_to_collision_s: "minimum time to the contact at constant velocities; exact: only on a collision course, 0 in contact",
    post_encroachment_time_s: "minimum time between one actor leaving a place and the other reaching it; 0 with contact",
    required_deceleration_mps2: "largest braking that one of the two would have needed at any instant before the contact",
    minimum_distance_m: "minimum distance: paper's between centers, exact between outlines",
    interaction_intensity_mean: "sum of 1/distance to other actors within 50 m; mean over time",
    interaction_intensity_max: "maximum of that sum over time",
    average_displacement_error_m: "mean error of a prediction at constant velocity; larger with more maneuvering",
    final_displacement_error_m: "error at the end of the prediction",
    emergency_score: "points for contact, short TTC, short PET and nearness, by the paper's weights",
    emergency_level: "critical from 10 points, high from 6, moderate from 3",
    delta_v_mps: "change of velocity in the contact, from masses and a common final velocity",
    delta_v_worst_mps: "the larger change of velocity of the two",
    contact_energy_j: "energy absorbed in the contact, from masses and relative speed",
    fatality_risk: "probability of a fatality, from published curves over speed",
    time_exposed_ttc_s: "time with TTC below 1.5 s before the contact",
    time_integrated_ttc_s2: "integral of 1.5 s minus TTC, while TTC was below 1.5 s",
    time_exposed_drac_s: "time during which braking harder than 3.35 m/s2 was needed",
    braking_s_before_s: "start of braking of the first of the two, before the contact",
    ttc_at_braking_s: "TTC at that instant",
    brake_by_s: "last instant at which full braking alone would have avoided the contact",
    brake_by_m: "distance to the contact at that instant",
    required_2_s_before_mps2: "constant braking from 2 s before the contact that would have avoided it",
    steer_by_s: "last instant at which steering alone would have avoided the contact",
  };
  const CALLED = {                                       // names for people; the keys are those of metrics.json
    collision_probability: "share of time in contact", near_miss_probability: "share of time in a near miss", collision: "contact",
    collision_speed_mps: "closing speed at the contact", time_to_collision_s: "time to collision (TTC), least",
    post_encroachment_time_s: "post-encroachment time (PET)",
    required_deceleration_mps2: "braking needed, most", minimum_distance_m: "distance, least", interaction_intensity_mean: "interaction intensity, mean",
    interaction_intensity_max: "interaction intensity, most", average_displacement_error_m: "prediction error, mean", final_displacement_error_m: "prediction error at the end",
    emergency_score: "emergency score", emergency_level: "emergency level", delta_v_mps: "change of velocity (delta-v)", delta_v_worst_mps: "change of velocity, the larger",
    contact_energy_j: "energy absorbed", fatality_risk: "risk of a fatality", time_exposed_ttc_s: "time with TTC under 1.5 s", time_integrated_ttc_s2: "TTC deficit, integrated",
    time_exposed_drac_s: "time in which hard braking was needed", braking_s_before_s: "braking began before the contact", ttc_at_braking_s: "TTC as braking began",
    brake_by_s: "last moment to brake, before the contact", brake_by_m: "last place to brake, before the contact", steer_by_s: "last moment to steer, before the contact",
    required_2_s_before_mps2: "steady braking that avoids it, from 2 s before",
  };
  for (const s of ["0_5", "1", "2"]) {
    CALLED[`ttc_${s}_s_before_s`] = `TTC ${s.replace("_", ".")} s before the contact`;
    CALLED[`drac_${s}_s_before_mps2`] = `braking needed ${s.replace("_", ".")} s before the contact`;
    EXPLAIN[`ttc_${s}_s_before_s`] = "time until the outlines would touch at the velocities of that instant";
    EXPLAIN[`drac_${s}_s_before_mps2`] = "constant braking that would have avoided the contact from that instant (DRAC)";
  }
  const ENDS = [["_mps2", "m/s²"], ["_s2", "s²"], ["_mps", "m/s"], ["_m", "m"], ["_s", "s"], ["_j", "J"]];
  const HARDEST_MPS2 = 12;                               // no vehicle of the kinds' records brakes harder
  const unitOf = (key) => (ENDS.find(([end]) => key.endsWith(end)) || ["", ""])[1];
  const called = (key) => CALLED[key] || words(key.replace(/_(mps2|mps|s2|s|m|j)$/, ""));
  const plainly = (v) => typeof v === "number" ? v.toFixed(Math.abs(v) >= 100 ? 0 : Math.abs(v) >= 10 ? 1 : 2) : show(v);
  function figure(key, v) {                              // with its unit; braking that nothing can do in words
    if (v && typeof v === "object") return Object.entries(v).map(([k, one]) => `${k} ${figure(key, one)}`).join(", ");
    if (typeof v !== "number") return show(v);
    const [unit] = [unitOf(key)];
    if (key === "contact_energy_j") return `${(v / 1000).toFixed(1)}\u00a0kJ`;
    if (unit === "m/s²" && v > HARDEST_MPS2) return `over ${HARDEST_MPS2} ${unit}: more than brakes give`;
    if (/probability|risk/.test(key)) return `${(100 * v).toFixed(v < 0.1 ? 2 : 0)} %`;
    return unit ? `${plainly(v)}\u00a0${unit}` : plainly(v);
  }

  // ---------------------------------------------------------------- report, verdict, account, tables
  const seen = contact && declared && contact.actor !== declared.striker && contact.other === declared.striker
    ? [contact.other, contact.other_area, contact.actor, contact.actor_area] : contact && [contact.actor, contact.actor_area, contact.other, contact.other_area];
  function tell(place, text, at) {                       // the narrative, its replaced words marked, its vehicles in their colors
    let from = 0;
    for (const r of data.redactions || []) {
      if (r.start < at || r.start >= at + text.length) continue;
      const begin = Math.max(r.start - at, from), end = Math.min(r.end - at, text.length);
      paint(place, text.slice(from, begin));
      place.append(make("span", end > begin ? text.slice(begin, end) : "[…]", { className: "gone", title: `${r.removed} characters about persons were ${end > begin ? "replaced" : "left out"} here` }));
      from = Math.max(end, begin);
    }
    paint(place, text.slice(from));
  }
  function paint(place, text) {
    let from = 0;
    for (const hit of text.matchAll(NAMED)) {
      const number = hit[1] ? Number(hit[1]) : NUMBERS.indexOf(hit[2].toLowerCase()) + 1;
      const actor = data.actors.find((a) => a.id === `V${number}`);
      if (!actor) continue;
      place.append(text.slice(from, hit.index), make("mark", hit[0], { style: `background:${actor.label || actor.color}` }));
      from = hit.index + hit[0].length;
    }
    place.append(text.slice(from));
  }
  const NUMBERS = ["one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten"];
  const NAMED = new RegExp(`\\b(?:(?:vehicle|unit|veh\\.?|traffic unit)\\s*(?:no\\.?\\s*|number\\s*|#\\s*)?|V|U(?=\\d))(?:(\\d{1,2})|(?<=\\s)(${NUMBERS.join("|")}))\\b`, "gi");
  const sides = (a, aSide, b, bSide) => `${a} ${aSide} → ${b} ${bSide}`;

  $("case").textContent = data.case;
  const driven = data.drive, CALLED_DRIVE = { braked_s: "braking began before the contact or the closest approach", braked_at_ttc_s: "TTC as braking began", hardest_mps2: "hardest braking", closest_m: "distance, least", least_ttc_s: "time to collision, least", pet_s: "post-encroachment time (PET)" };
  $("about").textContent = driven ? data.config : `config ${data.config} · ${data.status} · attempts: road ${data.attempts.road}, scenario ${data.attempts.scenario} · ${Object.values(data.seconds).reduce((a, b) => a + b, 0).toFixed(1)} s`;
  const account = data.account && data.account.verdict !== "none" ? data.account : null;
  if (account) {                                         // what is told and there, told and lacking, assumed: first thing
    const whole = account.verdict === "whole", disputed = data.disagreements || [], of = (kind) => account.items.filter((i) => i.kind === kind);
    $("account").hidden = false; $("account").open = !whole; $("account").className = whole ? "whole" : "amber";
    $("account").firstElementChild.textContent = `${whole ? "✓" : "⚠"} ${account.sentence.charAt(0).toUpperCase()}${account.sentence.slice(1)}`;
    const differing = disputed.map((d) => ({ start: d.start, text: `${d.field}: ${d.kept} (${d.kept_by}), but the ${d.by} read ${d.other}` }));
    for (const item of [...of("lacks"), ...of("unread"), ...of("contradicts"), ...of("guessed"), ...differing]) {
      const line = make("li"), words = item.reason ? `${item.text}: ${item.reason}` : item.text;
      const sentence = data.sentences.find((s) => s.of <= item.start && item.start < s.upto);
      if (sentence) { const told = make("button", words); told.type = "button"; told.onclick = () => point(sentence.things, sentence); line.append(told); } else line.append(words);
      $("lacks").append(line);
    }
    if (account.assumed) $("assumed").textContent = `Assumed: ${of("assumed").map((i) => i.text).join("; ")}.`;
  }
  const verdict = $("verdict"), surely = !account || account.verdict === "whole";   // nothing is green over something unread
  const judged = (good) => (good ? (surely ? "good" : "") : "bad"), as = (good) => (good ? " · as declared ✓" : " · not as declared ✗");
  if (contact) {
    verdict.textContent = `${sides(...seen)} at ${contact.t_s.toFixed(2)} s` + (declared && !driven ? as(data.collision.realised) : "");
    verdict.className = !declared ? "" : judged(data.collision.realised);
  } else if (closest) {
    verdict.textContent = `near crash: ${closest.actor} and ${closest.other} closest ${closest.clearance_m.toFixed(1)} m at ${closest.t_s.toFixed(1)} s` + as(near.realised);
    verdict.className = judged(near.realised);
  } else {
    verdict.textContent = declared ? "the declared contact did not happen ✗" : "no contact"; verdict.className = declared ? "bad" : "";
  }
  if (moment) $("mark").style.left = `calc(8px + (100% - 16px) * ${momentStep / Math.max(last, 1)})`; else $("mark").hidden = true;
  if (driven) {                                          // of a drive: did it avoid the crash, and what rules did it cost
    const own = driven.rules.filter((r) => r.ego && r.status === "broken");
    verdict.textContent = `${driven.outcome}: ${driven.reason}` + (own.length ? ` · breaks ${own.length === 1 ? "a rule" : `${own.length} rules`}` : "");
    verdict.className = driven.outcome === "avoided" ? (own.length || driven.doubt ? "" : "good") : ["unchanged", "worse"].includes(driven.outcome) ? "bad" : "";
    $("rulecard").hidden = false;
    for (const r of driven.rules) row($("rules"), [make("td", r.status, { className: r.status === "broken" ? "no" : "" }), r.text]);
    if (!own.length) row($("rules"), [make("td", "kept"), driven.kept ? `${driven.ego}: every rule that the map tells of` : "the map tells of no rule here"]);
    $("narrative").parentElement.querySelector(".hint").hidden = true; $("narrative").parentElement.firstElementChild.textContent = "What happened";
  }
  for (const a of data.actors) { const line = make("span"), id = make("b", a.id); id.style.background = a.label || a.color; line.append(id, make("i", "", { style: "font-style:normal" })); line.tabIndex = 0; pointable(line, [a.id]); $("legend").append(line); }
  for (const url of data.diagrams) { const img = make("img", null, { src: url, alt: "Crash diagram of the report" }); img.onclick = () => img.classList.toggle("large"); $("diagrams").append(img); $("diagrams").hidden = false; }
  $("marks").hidden = !data.sentences.some((s) => s.mark);
  let read = 0;
  data.sentences.forEach((s, k) => {
    tell($("narrative"), data.narrative.slice(read, s.start), read);
    const span = pointable(make("span", "", { className: "told", tabIndex: 0 }), s.things, s);
    if (s.mark) span.classList.add(s.mark);
    if (data.marked[s.mark]) span.title = data.marked[s.mark];
    span.dataset.k = k; tell(span, data.narrative.slice(s.start, s.end), s.start); $("narrative").append(span);
    if (data.marked[s.mark]) span.append(make("sup", data.marked[s.mark], { className: "marked" }));
    read = s.end;
  });
  tell($("narrative"), data.narrative.slice(read), read);
  if ((data.redactions || []).length) { $("redacted").hidden = false; $("redacted").textContent = "Dotted words stand for others, and […] for words left out: sex, age, names, licence, health and injury data and numbers of reports and badges are not kept."; }
  for (const thing of Object.keys(data.facts)) if (thing.startsWith("road ")) $("roads").append(pointable(make("button", thing.replaceAll("_", " ")), [thing]));
  if (data.facts.contact) $("roads").append(pointable(make("button", "contact"), ["contact"]));
  row($("actors"), ["", "type", "maneuver", "size"], true);
  for (const a of data.actors) row($("actors"), [pill(a), a.type, a.maneuver, `${a.length_m.toFixed(1)} × ${a.width_m.toFixed(1)} m`]);
  fillSpeeds();
  $("conditions").textContent = Object.entries(data.conditions).map(([k, v]) => `${k}: ${words(v)}`).join(" · ");
  row($("collision"), [driven ? "the script's" : "declared", declared ? sides(declared.striker, declared.striker_area, declared.struck, declared.struck_area) : "none"]);
  row($("collision"), [driven ? "in this drive" : "observed", contact ? sides(...seen) : "none"]);
  if (contact) row($("collision"), ["first contact", `${contact.t_s.toFixed(2)} s`]);
  if (near) {
    const told = near.declared, c = told.conflict;
    row($("collision"), ["avoided", sides(c.striker, c.striker_area, c.struck, c.struck_area)]);
    row($("collision"), ["evasion", told.evasions.map((e) => `${e.actor} ${words(e.maneuver)}`).join(", ") || "not told"]);
    row($("collision"), ["clearance", `${told.clearance_m.toFixed(2)} m (${told.clearance_basis})`]);
    if (closest) row($("collision"), ["closest approach", `${closest.clearance_m.toFixed(2)} m at ${closest.t_s.toFixed(2)} s`]);
  }
  const realised = near ? near.realised : data.collision.realised;
  if (!driven) row($("collision"), ["realised", make("td", realised ? "yes" : "no", { className: realised ? (surely ? "yes" : "") : "no" })]);
  const net = data.network || {};
  for (const [k, v] of Object.entries(net)) if (k !== "segments") row($("network"), [words(k), v]);
  if (data.place) row($("network"), ["real place", data.place.replace(/^the real place is /, "")]);
  if (net.segments) row($("network"), ["roads (lanes →/←)", net.segments.map((s) => `${s.id} ${s.lanes_forward}/${s.lanes_backward}`).join(", ")]);
  const paper = data.metrics.paper || {}, exact = data.metrics.exact || {};
  const readings = driven ? [["", exact]] : [["paper's formula", paper], ["exact", exact]];
  row($("metrics"), ["", ...readings.map(([name]) => make("th", name, { className: "n" }))], true);
  function explained(key) {                              // the figure's name, and under it what it is in a line
    const td = make("td", called(key));
    if (EXPLAIN[key]) td.append(make("small", EXPLAIN[key]));
    return td;
  }
  const measures = [...new Set([...Object.keys(paper), ...Object.keys(exact)])].filter((key) => !key.endsWith("_reason"));
  const because = (key, of) => of[key] === null && of[key.replace(/_s$/, "_reason")];     // why there is no value
  if (driven) for (const [k, v] of Object.entries(data.metrics.drive || {})) if (CALLED_DRIVE[k]) row($("metrics"), [CALLED_DRIVE[k], make("td", figure(k, v), { className: "n" })]);
  for (const key of measures) row($("metrics"), [explained(key), ...readings.map(([, of]) => make("td", of[key] === undefined ? "–" : because(key, of) || figure(key, of[key]), { className: "n" }))]);
  for (const [field, nats] of Object.entries(data.grounding || {})) {
    const chip = make("span", `${field}  ${nats.toFixed(2)}`), strength = Math.min(Math.abs(nats) / 4, 1);
    chip.style.background = nats >= 0 ? `rgba(27,127,77,${0.1 + 0.35 * strength})` : `rgba(196,32,58,${0.1 + 0.35 * strength})`;
    $("grounding").append(chip); $("groundcard").hidden = false;
  }
  for (const card of document.querySelectorAll(".card")) if (!card.hidden) card.hidden = ![...card.querySelectorAll("table, div")].some((part) => part.childElementCount);
  window.addEventListener("message", (e) => {              // the page around it points at something
    if (seated && e.source === parent && e.data?.sgcad === "point" && Array.isArray(e.data.things)) point(e.data.things.map(String), undefined, true);
  });
  fit();
  window.addEventListener("load", fit);
  const start = /[#&]t=([\d.]+)/.exec(location.hash);          // player.html#t=4.2 opens at that second
  if (start) go(Number(start[1]) / step);
  if (data.over) choose(runs.findIndex((r) => r.name === data.over));
