// What people type: numbers with units, states in a link, own constants as text. Nothing is evaluated.
"use strict";

/* A unit as [scale, exponents of m, kg, s, A, K]: symbols with their exponents, blanks, * and · between them, / before
   those below, brackets after it. Throws what is no unit. */
function unit(text, { symbols, prefixes }) {
  let scale = 1, exponents = [0, 0, 0, 0, 0], below = false, held = false;
  const parts = text.trim().matchAll(/([/*·()\s]+)|(%|1(?![0-9.])|[A-Za-zµμ]+)\^?([-+]?[0-9]+)?|(.)/g);
  for (const [whole, between, symbol, power, other] of parts) {
    if (other !== undefined) throw new Error(`${whole} is no unit`);
    if (between !== undefined) {
      if (between.includes("/")) below = true;
      if (between.includes("(")) held = true;
      if (between.includes(")")) held = below = false;
      continue;
    }
    const known = Object.hasOwn(symbols, symbol), prefix = Object.hasOwn(prefixes, symbol[0]) && Object.hasOwn(symbols, symbol.slice(1));
    if (!known && !prefix && symbol !== "%" && symbol !== "1") throw new Error(`${symbol} is no unit`);
    const [factor, own] = symbol === "%" ? [0.01, exponents.map(() => 0)] : symbol === "1" ? [1, exponents.map(() => 0)]
      : known ? symbols[symbol] : [symbols[symbol.slice(1)][0] * prefixes[symbol[0]], symbols[symbol.slice(1)][1]];
    const raised = (below ? -1 : 1) * Number(power || 1);
    scale *= factor ** raised;
    exponents = exponents.map((one, k) => one + raised * own[k]);
    if (!held) below = false;
  }
  return { scale, exponents };
}

// A number in SI from "20 um", "2e-5" or "50 %"; `units` are what it is measured in. Throws what is wrong, in words.
function quantity(text, units, library) {
  const found = /^\s*([-+−]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]+)?)\s*(.*)$/.exec(text);
  if (!found) throw new Error(`${text.trim() ? `“${text.trim().slice(0, 30)}” is no number` : "missing"}; ${units === "1" ? "a number" : `a number with its unit, [${written(units)}]`}`);
  const value = Number(found[1].replace("−", "-"));
  if (!found[2].trim()) return { value, bare: true };
  const asked = unit(units, library), given = unit(found[2], library);
  if (asked.exponents.some((one, k) => one !== given.exponents[k])) throw new Error(`${found[2].trim()} does not measure it; it has the unit ${written(units) || "1"}`);
  return { value: (value * given.scale) / asked.scale, bare: false };
}

/* Constants pasted as lines "c11 = 126 GPa" (TOML), "c11: 126 GPa" (YAML) or as JSON; `limits` as "depoling_stress = 10 MPa",
   in a table [limits], or in braces. Throws naming the line and what is allowed. */
function ownMaterial(text, library) {
  const entries = text.trim().startsWith("{") ? fromJson(text) : fromLines(text), found = { limits: {}, alternatives: [], name: "own constants", source: "", note: "" };
  for (const [name, value] of entries) {
    if (["name", "source", "note"].includes(name)) found[name] = String(value).slice(0, 200);
    else if (name === "conductor") continue; // of a layer's faces, which a half-space has not
    else if (Object.hasOwn(library.constants, name)) found[name] = finite(name, value, library.constants[name], library);
    else if (Object.hasOwn(library.limits, name)) {
      found.limits[name] = { value: finite(name, value, library.limits[name].units, library), source: "as pasted" };
      if (!(found.limits[name].value > 0)) throw new Error(`${name}: must be positive`);
    } else throw new Error(`${name.slice(0, 30)}: unknown entry; known are ${[...Object.keys(library.constants), ...Object.keys(library.limits)].join(", ")}`);
  }
  for (const name of ["c11", "c13", "c33", "c44"]) if (found[name] === undefined) throw new Error(`${name}: missing; needed are c11, c13, c33, c44 [Pa]`);
  const material = { ...Object.fromEntries(["e31", "e33", "e15", "f31", "f33", "f15", "g11", "g33"].map((name) => [name, 0])),
    eps11: library.defaults.eps, eps33: library.defaults.eps, mu11: library.defaults.mu, mu33: library.defaults.mu, ...found };
  const wrong = fault(material, library.constants);
  if (wrong) throw new Error(wrong);
  return material;
}

function finite(name, value, units, library) {
  try {
    const { value: number } = quantity(String(value).replaceAll("_", ""), units, library);
    if (!Number.isFinite(number)) throw new Error("is not finite");
    return number;
  } catch (error) { throw new Error(`${name}: ${error.message}`); }
}

const unquoted = (text) => text.trim().replace(/,$/, "").trim().replace(/^(["'])(.*)\1$/, "$2");

function fromLines(text) {
  const found = [];
  let skipped = false;
  for (const [at, line] of text.slice(0, 20000).split("\n").entries()) {
    const bare = line.replace(/(^|\s)#.*$/, "").trim();
    if (!bare) continue;
    const header = /^\[+["']?([^\]"']*)["']?\]+$/.exec(bare), entry = /^([A-Za-z_][\w.]*)\s*[=:]\s*(.*)$/.exec(bare);
    if (header) { if (header[1] !== "limits") found.push(["name", header[1]]); continue; }
    if (skipped && /^[-{}\]]/.test(bare)) continue;
    if (!entry) throw new Error(`line ${at + 1}: “${bare.slice(0, 40)}” is not of the form c11 = 126 GPa`);
    const name = entry[1].replace(/^limits\./, ""), inner = /value\s*[=:]\s*([^,}]*)/.exec(entry[2]);
    skipped = name === "alternatives";
    if (skipped || (name === "limits" && !entry[2])) continue;
    found.push([name, unquoted(inner ? inner[1] : entry[2])]);
  }
  return found;
}

function fromJson(text) {
  let read;
  try { read = JSON.parse(text); } catch { throw new Error("is no JSON; lines such as c11 = 126 GPa are read, too"); }
  const limits = read.limits && typeof read.limits === "object" ? Object.entries(read.limits) : [];
  const own = Object.entries(read).filter(([name]) => name !== "limits" && name !== "alternatives");
  return [...own, ...limits.map(([name, one]) => [name, one && typeof one === "object" ? one.value : one])];
}

// The alloy of a fraction: the parabola through three values of every constant.
function alloyed(alloy, x) {
  const t = 4 * x, weights = [((t - 1) * (t - 2)) / 2, t * (2 - t), (t * (t - 1)) / 2];
  const constants = Object.fromEntries(Object.entries(alloy.values).map(([name, values]) => [name, dot(values, weights)]));
  return { ...constants, name: "AlScN", source: alloy.source, note: "", limits: alloy.limits, alternatives: [] };
}
