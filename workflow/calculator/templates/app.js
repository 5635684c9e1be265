// The page: reads what is set, calculates, tells, draws, and keeps the state in the link.
"use strict";

const library = JSON.parse(document.getElementById("library").textContent);
const tables = JSON.parse(document.getElementById("films").textContent);
const form = document.forms[0], field = (name) => form.elements[name], tell = (id) => document.getElementById(id);
const POINTS = ["sphere", "cone", "disc"], OWN = "own constants", ALLOY = "AlScN";

// Of every number: its units, the words of what it must be, whether it is allowed, and where it usually is.
const positive = ["must be greater than zero", (value) => value > 0];
const NUMBERS = {
  scandium_fraction: ["1", "must be 0 to 0.5", (value) => value >= 0 && value <= 0.5],
  thickness: ["m", ...positive, [1e-8, 1e-2]],
  radius: ["m", ...positive, [1e-8, 10]],
  width: ["m", ...positive, [1e-8, 10]],
  slope: ["1", ...positive],
  force: ["N", ...positive],
  load: ["N m-1", ...positive],
  friction: ["1", "must be 0 or more", (value) => value >= 0 && value <= 2],
  voltage: ["V", "must be a number", () => true],
  datum: ["m", ...positive],
};

const asSet = () => Object.fromEntries([...new FormData(form)].filter(([name]) => applies(name)));
const profile = () => field("profile").value;
const isPoint = () => POINTS.includes(profile());
const film = () => (Object.hasOwn(library.films, field("material").value) ? field("material").value : "");

// Whether an input means anything for what is set.
function applies(name) {
  const punch = { radius: ["cylinder", "sphere"], width: ["flat", "disc"], slope: ["wedge", "cone"] }[name];
  if (punch) return punch.includes(profile());
  if (name === "force") return isPoint();
  if (["load", "friction"].includes(name)) return !isPoint();
  if (name === "datum") return !isPoint() && !film();
  if (name === "voltage") return field("electric").value === "voltage";
  if (name === "scandium_fraction") return field("material").value === ALLOY;
  if (name === "thickness") return Boolean(film());
  if (name === "constants") return field("material").value === OWN;
  return true;
}

// Numbers of the form in SI, and what is wrong with them, in words at their places.
function read() {
  const values = {};
  let wrong = false;
  for (const [name, [units, rule, holds, usual]] of Object.entries(NUMBERS)) {
    const input = field(name), note = tell(`${name}-note`), shown = applies(name);
    input.closest(".entry").hidden = !shown;
    let said_ = "", bad = false;
    if (shown) {
      try {
        const { value, bare } = quantity(input.value, units, library);
        values[name] = value;
        if (!Number.isFinite(value) || !holds(value)) [said_, bad] = [rule, true];
        else if (bare && usual && (value < usual[0] || value > usual[1])) said_ = `${digits(value, 3)} is ${digits(value, 3)} ${written(units)}; did you mean ${digits(value, 3)} µ${written(units)}?`;
      } catch (error) { [said_, bad] = [error.message, true]; }
    }
    note.textContent = said_;
    input.setAttribute("aria-invalid", String(bad));
    wrong = wrong || bad;
  }
  field("constants").closest(".entry").hidden = !applies("constants");
  return wrong ? null : values;
}

function chosenMaterial(values) {
  const name = field("material").value;
  if (film()) return library.films[film()].top;
  if (name === ALLOY) return alloyed(library.alloy, values.scandium_fraction);
  const note = tell("constants-note");
  note.textContent = "";
  if (name !== OWN) return library.materials[name];
  try { return ownMaterial(field("constants").value, library); } catch (error) {
    note.textContent = error.message;
    field("constants").setAttribute("aria-invalid", "true");
    return null;
  }
}

// The table of the film and punch that are set.
const tabled = () => tables.find((one) => one.film === film() && one.punch === field("punch").value);

// Quantities of a material, on a film by its table, under a voltage or with nothing connected; an error in words.
function solve({ material, table }, values, voltage) {
  const named = field("punch").value, punch = { profile: profile(), ...library.punches[named] }, conducts = [field("electric").value !== "insulating", field("magnetic").value !== "insulating"];
  for (const name of ["radius", "width", "slope"]) if (applies(name)) punch[name] = values[name];
  const given = { material, punch, conducts, voltage };
  if (!isPoint()) {
    if (film()) throw new Error("a film under a roller");
    return solveLine({ ...given, load: values.load, friction: values.friction, datum: values.datum }, library.digamma);
  }
  if (film() && !(table && conducts[0])) throw new Error(conducts[0] ? `a film under ${named}` : "a film under an insulating punch");
  return solvePoint({ ...given, force: values.force, ...(table ? { film: table, thickness: values.thickness } : {}) });
}

// What is shown, in its order: key, words, units, and what it means. Keys are names of the library where they have one.
function shownRows(found) {
  const line = found.kind === "line", per = line ? " m-1" : "", held = applies("voltage"), couples = (name) => found[name] !== undefined && Math.abs(found[name]) > 0;
  const rows = [
    line ? ["width", "contact width", "m", "from edge to edge"] : ["contact_radius", "contact radius", "m", "of the circle of contact"],
    ["depth", "depth", "m", line ? `approach, against the surface ${said(found.datum, "m", 3)} away` : "approach of the punch"],
    ["peak_pressure", "largest pressure", "Pa", found.peak_pressure === undefined ? "infinite at a corner of the punch" : "under the punch"],
    ...(line ? [["trailing_tension", "tension", "Pa", "along the surface, just behind the contact"]]
      : film() ? [] : [["edge_tension", "tension", "Pa", "radial, in the surface just beside the contact"]]),
  ];
  if (couples("charge_per_force")) {
    rows.push(["charge_per_force", "charge per force", "C N-1", "with the punch at zero volts"]);
    rows.push(held ? ["charge", "charge", `C${per}`, "at this voltage"] : ["short_charge", "charge", `C${per}`, "with the punch at zero volts"]);
    rows.push(held ? ["open_voltage", "voltage, open", "V", "with nothing connected"] : ["voltage", "voltage", "V", "open circuit, no charge"]);
  }
  if (found.capacitance !== undefined) rows.push(["capacitance", "capacitance", `F${per}`, line ? "of the contact, against the datum" : "of the contact"]);
  if (couples("stroke_per_volt")) rows.push(["stroke_per_volt", "stroke per volt", "m V-1", "at this force"], line ? ["blocked_load_per_volt", "blocked load per volt", "N m-1 V-1", "at this depth"] : ["blocked_force_per_volt", "blocked force per volt", "N V-1", "at this depth"]);
  if (!line) rows.push(["contact_stiffness", "contact stiffness", "N m-1", "at held voltage"]);
  if (couples("flux_per_force")) rows.push(["magnetic_potential", "magnetic potential", "A", "no flux taken"], ["flux_per_force", "flux per force", "Wb N-1", "with the punch at zero magnetic potential"]);
  return rows;
}

// Figures that follow from the solver's.
function completed(found, values, open) {
  const force = found.kind === "line" ? values.load : values.force;
  return { ...found, width: 2 * found.half, datum: values.datum, thickness: values.thickness, short_charge: found.charge_per_force * force, open_voltage: open.voltage };
}

function everything(body, values) {
  const open = solve(body, values);
  return completed(applies("voltage") ? solve(body, values, values.voltage) : open, values, open);
}

/* What is set, and after it the same under the other published constants, which make its band. Those tables of a film
   have the pressure at the centre alone: where it is not the largest, it has no band. */
function underConstants(material, values) {
  const table = film() && tabled(), own = everything({ material, table }, values);
  const bodies = table ? table.variants.map((one) => ({ material: one.top, table: { ...table, ...one } }))
    : material.alternatives.map((other) => ({ material: { ...material, ...other, alternatives: [] } }));
  const others = bodies.map((one) => everything(one, values));
  if (table && !(own.pressure(0) >= own.peak_pressure * (1 - 1e-9))) for (const one of others) delete one.peak_pressure;
  return [own, ...others];
}

// What is beyond linear theory, as workflow/design/verdict/linearity.py judges it.
function beyond(material, several) {
  const worst = (value) => Math.max(...several.map((one) => Math.abs(value(one) || 0))), lines = [], known = new Set();
  const field_ = (one) => (film() ? Math.abs(one.voltage) / one.thickness : Math.abs(one.voltage) / (2 * one.half));
  const bounds = {
    tensile_strength: ["the tension beside the contact", (one) => Math.max(0, one.kind === "line" ? one.trailing_tension || 0 : one.edge_tension || 0)],
    depoling_stress: ["the largest pressure", (one) => one.peak_pressure],
    coercive_field: [film() ? "the voltage over the film's thickness" : "the voltage over the contact's width", field_],
    breakdown_field: [film() ? "the voltage over the film's thickness" : "the voltage over the contact's width", field_],
  };
  for (const [name, [words, value]] of Object.entries(bounds)) {
    const limit = material.limits[name];
    if (!limit) continue;
    known.add(name);
    const { title, units } = library.limits[name], size = worst(value);
    lines.push({ bad: size > limit.value, text: `${capital(words)}, ${said(size, units, 3)}, is ${size > limit.value ? "above" : "below"} the ${title}, ${said(limit.value, units, 3)}.`, source: limit.source });
  }
  const size = worst(field_);
  if (!known.has("coercive_field") && !known.has("breakdown_field") && size > 3e5)
    lines.push({ bad: true, text: `${capital(bounds.coercive_field[0])}, ${said(size, "V m-1", 3)}, is above 300 kV/m, beyond which ferroelectric ceramics are not linear.`, source: "the library has no coercive or breakdown field of the material" });
  return { lines, known };
}

// What the shape of the punch is good for.
function geometry(found) {
  const { wide, deep } = library.small_strain;
  const round = profile() === "sphere" || profile() === "cylinder", ratio = round ? found.half / quantity(field("radius").value, "m", library).value : 0;
  if (ratio > wide) return `Half the contact's width is ${digits(ratio, 2)} of the punch's radius: strains are small only up to ${wide}.`;
  const sunk = film() ? found.depth / found.thickness : 0;
  if (sunk > deep) return `The depth is ${digits(sunk, 2)} of the film's thickness: strains are small only up to ${deep}.`;
  const slope = applies("slope") ? quantity(field("slope").value, "1", library).value : 0;
  return slope > 0.3 ? `A slope of ${digits(slope, 2)} is steep: linear theory is for gentle ones, below 0.3 or so.` : "";
}

const capital = (text) => text[0].toUpperCase() + text.slice(1);
const element = (name, content, attributes = {}) => Object.assign(document.createElement(name), { textContent: content, ...attributes });
// Three digits, zeros among them, with prefix and unit.
function three(value, units) {
  if (value === undefined || !Number.isFinite(value)) return "–";
  if (!value) return `0 ${written(units)}`;
  const shown = engineering(value, units, 3), text = (value / shown.size).toPrecision(3);
  return text.includes("e") ? said(value, units, 3) : `${text.replace("-", "−")} ${shown.units}`.trim();
}
// Least band that is shown: tables of balls in air under other constants are good to 1.5e-3.
const least = () => (film() && profile() === "sphere" ? 0.002 : 0.0005);
const percent = (share) => (share < least() ? "" : `± ${digits(100 * share, share < 0.1 ? 1 : 2)} %`);

function show(values) {
  const material = chosenMaterial(values);
  if (!material) return refuse("Own constants are needed.");
  let several;
  try { several = underConstants(material, values); } catch (error) { return refuse(error.message); }
  tell("refused").hidden = true;
  tell("answer").hidden = false;
  const [own, ...others] = several, rows = shownRows(own);
  const spread = (key) => others.reduce((most, one) => Math.max(most, Math.abs(one[key] - own[key]) || 0), 0);
  tell("figures").replaceChildren(...rows.map(([key, words, units, meaning]) => {
    const value = own[key], card = element("div", "", { className: "figure" }), share = others.length && value ? spread(key) / Math.abs(value) : 0;
    card.append(element("dt", words), element("dd", three(value, units), { className: "value" }));
    card.append(element("dd", percent(share), { className: "band" }), element("dd", meaning, { className: "meaning" }));
    card.dataset.name = key;
    return card;
  }));
  tell("band-words").textContent = (film() ? "The face between film and base is grounded. " : "") + (others.length
    ? `The band is how far ${others.length} other published ${others.length === 1 ? "set of constants moves" : "sets of constants move"} a figure${rows.some(([key]) => own[key] && spread(key) > least() * Math.abs(own[key])) ? "" : "; here it moves none"}.`
    : "The library knows one published set of these constants: there is no band.")
    + (film() && profile() === "sphere" ? " Air surrounds the contact." : " The surface outside the contact is insulated.")
    + (!film() && ["sphere", "cylinder"].includes(profile()) ? ' With air there ("surroundings: air" of meecontact solve) voltages are smaller and capacitances larger.' : "");
  const { lines, known } = beyond(material, several), bad = lines.some((one) => one.bad), steep = geometry(own);
  const verdict = tell("verdict");
  verdict.className = bad || steep ? "bad" : lines.length ? "good" : "edge";
  verdict.textContent = bad || steep ? "Beyond linear theory" : lines.length ? "Within what is known of the material" : "No strength of this material is known here";
  const unknown = ["tensile_strength", "depoling_stress"].filter((name) => !known.has(name)).map((name) => library.limits[name].title);
  tell("verdict-lines").replaceChildren(...(steep ? [element("li", steep, { className: "over" })] : []),
    ...lines.map((one) => { const item = element("li", one.text, { className: one.bad ? "over" : "" }); item.append(" ", element("span", one.source, { className: "soft" })); return item; }),
    ...(material.limits.yield_strength ? [element("li", `Not judged: the yield strength, ${said(material.limits.yield_strength.value, "Pa", 3)}, which takes the stresses inside.`, { className: "soft" })] : []),
    ...(unknown.length ? [element("li", `Not known: ${unknown.join(", ")}.`, { className: "soft" })] : []));
  const diameter = said(2 * own.half, "m", 3);
  drawContact(tell("drawing"), own, { profile: profile(), radius: values.radius, slope: values.slope }, film() ? values.thickness : 0, `contact ${diameter} ${isPoint() ? "across" : "wide"}`);
  drawPressure(tell("pressure"), own, "pressure under the punch");
  tell("drawing").setAttribute("aria-label", `Punch and body to scale, contact ${diameter}`);
  tell("sources").textContent = `${material.name}: ${material.source}${material.note ? `. ${capital(material.note)}` : ""}`;
}

function refuse(message) {
  tell("answer").hidden = true;
  tell("refused").hidden = false;
  tell("refused-words").textContent = message === "a film under a roller" || message.startsWith("a film under") ? `${capital(message)}: this page has tables of open balls, and of cones and flat ends, under ${[...new Set(tables.map((one) => one.punch))].join(", ")}. The command below solves it.` : `${capital(message)}.`;
}

// The same state on the command line and in Python.
function commands(values) {
  const factors = film() ? { ...library.films[film()].factors, thickness: values.thickness } : field("material").value === ALLOY ? { composite: ALLOY, scandium_fraction: values.scandium_fraction }
    : { material: field("material").value === OWN ? "mine" : field("material").value };
  const case_ = { ...factors, profile: profile() };
  for (const name of ["radius", "width", "slope", "force", "load", "friction", "datum"]) if (applies(name) && values[name] !== undefined) case_[name] = values[name];
  if (film() && !isPoint()) delete case_.datum;
  if (field("punch").value !== "rigid") case_.punch = field("punch").value;
  if (field("electric").value === "insulating") case_.electric = "insulating";
  if (field("magnetic").value === "insulating") case_.magnetic = "insulating";
  const names = Object.keys(case_), shown = (value) => (typeof value === "number" ? String(Number(value.toPrecision(12))) : value);
  const quoted = (value) => (typeof value === "number" ? shown(value) : JSON.stringify(value));
  const own = field("material").value === OWN;
  tell("commands").textContent = [
    "# cases.csv, in SI", names.join(","), names.map((name) => shown(case_[name])).join(","), "",
    `meecontact solve cases.csv -o out.nc${own ? " --materials mine.yaml  # the constants above, name: mine" : ""}`, "",
    "# or in Python", "import solver", `case = {${names.map((name) => `${JSON.stringify(name)}: ${quoted(case_[name])}`).join(", ")}}`,
    own ? "print(solver.solve(case, materials={\"mine\": solver.Material(...)}))  # the constants above" : "print(solver.solve(case))",
    ...(applies("voltage") ? ["# a voltage is held by its charge: the sensitivities of the answer tell it"] : []),
  ].join("\n");
}

function changed() {
  const values = read();
  field("magnetic").closest(".entry").hidden = !magnetic(field("material").value);
  if (!values) { refuse("What is marked is needed."); return; }
  field("constants").setAttribute("aria-invalid", "false");
  show(values);
  commands(values);
  const hash = new URLSearchParams(asSet()).toString();
  history.replaceState(null, "", `#${hash}`);
  slide(values);
}

// Whether a magnetic field has to do with it.
function magnetic(name) {
  const one = library.materials[name];
  return name === OWN || Boolean(one && (one.f31 || one.f33 || one.f15 || one.g11 || one.g33));
}

// Sliders move over decades, or over a plain range; what is typed moves them.
function slide(values) {
  for (const range of form.querySelectorAll("input[type=range]")) {
    const value = values[range.dataset.of];
    if (value !== undefined && document.activeElement !== range) range.value = range.dataset.scale === "log" ? Math.log10(value) : value;
  }
}

function slid(event) {
  const { of, scale } = event.target.dataset, raw = Number(event.target.value), units = NUMBERS[of][0];
  field(of).value = said(Number((scale === "log" ? 10 ** raw : raw).toPrecision(3)), units, 3).replace("−", "-");
  event.target.setAttribute("aria-valuetext", field(of).value);
}

function fill(select, groups) {
  for (const [label, names] of groups) {
    const group = element("optgroup", "", { label });
    group.append(...names.map((name) => element("option", name, { value: name })));
    select.append(group);
  }
}

function begin() {
  const all = Object.entries(library.materials), couples = ([, one]) => one.e31 || one.e33 || one.e15;
  const piezo = all.filter((one) => couples(one) && !magnetic(one[0])), rest = all.filter((one) => !couples(one) && !magnetic(one[0]));
  fill(field("material"), [["Piezoelectric", [...piezo.map(([name]) => name), ALLOY].sort((a, b) => a.localeCompare(b))],
    ["Magnetic, magneto-electro-elastic", all.map(([name]) => name).filter(magnetic)], ["Other", rest.map(([name]) => name)],
    ["Films, under balls, cones and flat ends", Object.keys(library.films)], ["Own", [OWN]]]);
  fill(field("punch"), [["Punch of", ["rigid", ...Object.keys(library.punches)]]]);
  restore();
  form.addEventListener("input", (event) => {
    if (event.target.type === "range") slid(event);
    if (event.target === field("material") && film()) field("thickness").value = library.films[film()].thickness;
    changed();
  });
  form.addEventListener("submit", (event) => event.preventDefault());
  addEventListener("hashchange", () => { restore(); changed(); });
  tell("print").addEventListener("click", () => print());
  tell("copy").addEventListener("click", async () => {
    const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    tell("copied").textContent = copied ? "copied" : "the link stands in the address bar";
  });
  changed();
}

function restore() {
  [field("material").value, field("punch").value] = ["PVDF on glass", "steel"];
  for (const [name, value] of new URLSearchParams(location.hash.slice(1))) {
    const input = form.elements.namedItem(name);
    if (input instanceof HTMLSelectElement && [...input.options].some((one) => one.value === value)) input.value = value;
    else if (input instanceof HTMLInputElement || input instanceof HTMLTextAreaElement) input.value = value.slice(0, 20000);
  }
}

begin();
