// Numbers for people, as workflow/language/numbers.py writes them: decimal prefixes, units with a slash.
"use strict";

const PREFIXES = { "-15": "f", "-12": "p", "-9": "n", "-6": "µ", "-3": "m", 0: "", 3: "k", 6: "M", 9: "G", 12: "T" };
const DEGREE = Math.PI / 180; // rad
const SUPERSCRIPT = { "-": "⁻", 0: "⁰", 1: "¹", 2: "²", 3: "³", 4: "⁴", 5: "⁵", 6: "⁶", 7: "⁷", 8: "⁸", 9: "⁹", "/": "ᐟ" };

const raised = (text) => [...text].map((c) => SUPERSCRIPT[c]).join("");
const decimalPower = (value, count) => Number(value.toExponential(count - 1).split("e")[1]);

// A unit as people write it: "V m N-1" as V·m/N.
function written(units) {
  const parts = units === "1" ? [] : [...units.matchAll(/([A-Za-zµΩ%]+)(-?)([0-9/]*)/g)];
  const side = (sign) => parts.filter(([, , minus]) => minus === sign).map(([, symbol, , power]) => symbol + (power === "1" ? "" : raised(power)));
  const over = side(""), under = side("-"), below = under.join("·");
  if (!under.length) return over.join("·");
  return `${over.join("·") || "1"}/${under.length === 1 ? below : `(${below})`}`;
}

// A prefix fits where the first symbol of a unit has no exponent, as in "V m N-1", or is an area; `count` digits will be shown.
// Angles are in degrees from one degree on.
function engineering(value, units, count = 15) {
  if (units === "rad" && Math.abs(value) >= DEGREE && Number.isFinite(value)) return { size: DEGREE, units: "deg" };
  const scalable = units && /^([A-Za-z]+|m2)( |$)/.test(units) && !units.startsWith("kg");
  const [exponent, shift, least, most] = units && units.startsWith("m2") ? [2, 2, -9, 0] : [1, 0, -15, 12]; // 0.01 to 9999 mm²
  const some = scalable && value !== 0 && Number.isFinite(value);
  const power = some ? Math.min(Math.max(3 * Math.floor((decimalPower(value, count) + shift) / (3 * exponent)), least), most) : 0;
  return { size: 10 ** (exponent * power), units: (scalable ? PREFIXES[power] : "") + written(units) };
}

function digits(value, count = 4) {
  if (!Number.isFinite(value)) return "–";
  const power = value === 0 ? 0 : decimalPower(value, count);
  if (power >= -3 && power < 5) return Number(value.toPrecision(count)).toString().replace("-", "−");
  const mantissa = Number(value.toExponential(count - 1).split("e")[0]);
  return `${mantissa}×10${raised(String(power))}`.replace("-", "−");
}

// A value with its prefix and unit, as 122.61 mm.
function said(value, units, count = 5) {
  if (!Number.isFinite(value)) return "–";
  if (units === "%") return `${digits(100 * value, count)} %`; // a share
  const shown = engineering(value, units, count);
  return `${digits(value / shown.size, count)} ${shown.units}`.trim();
}
