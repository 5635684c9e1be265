// Surface fields under the punch at the sliders: regular parts from their surrogate, the known edges around them
// (the arithmetic of workflow/learning/surface.py).
"use strict";

const NEAR_EDGE = 0.02; // distance in X from an edge within which a singular field sets no scale
const PLACES_UNDER = 61;

// Fields at positions X under the punch: {name: values}; `t` holds the scaled coordinates of the factors.
function surfaceFields(fields, t, exponent, X) {
  const angle = fields.inputs.length - 1, columns = fields.outputs.map(() => []);
  for (const x of X) {
    const regular = means(fields, [...t, toUnit(fields.inputs[angle], Math.acos(-x))]);
    const edge = (1 - x * x) ** -0.5, pressure = (1 - x) ** exponent * (1 + x) ** (1 - exponent);
    fields.outputs.forEach(({ name }, p) => columns[p].push(regular[p] * (name === "contact_pressure" ? pressure : edge)));
  }
  return Object.fromEntries(fields.outputs.map(({ name }, p) => [name, columns[p]]));
}

// Pressure under a circular punch in closed form, from its exponent and peak.
function pressureUnder(values, X) {
  const { pressure_exponent: alpha, peak_pressure: peak } = values;
  return X.map((x) => peak * ((1 - x) / (2 * alpha)) ** alpha * ((1 + x) / (2 * (1 - alpha))) ** (1 - alpha));
}

function showFields(panel, root) {
  const fields = panel.data.fields ? loadSurrogate(panel.data.fields) : null;
  const X = Array.from({ length: PLACES_UNDER }, (_, k) => -Math.cos((Math.PI * (k + 0.5)) / PLACES_UNDER));
  panel.watch((values) => {
    const pressures = panel.kind.pressure ? { contact_pressure: pressureUnder(values, X) } : {};
    const found = fields ? surfaceFields(fields, panel.point, values.pressure_exponent, X) : pressures;
    root.hidden = !Object.keys(found).length;
    for (const svg of root.querySelectorAll("svg[data-field]")) {
      const field = found[svg.dataset.field];
      svg.toggleAttribute("hidden", !field);
      if (field) showField(svg, X, field, values);
    }
  });
}

function showField(svg, X, field, values) {
  const away = field.filter((_, k) => 1 - Math.abs(X[k]) > NEAR_EDGE);
  const low = Math.min(...away, 0), high = Math.max(...away, 0), pad = 0.06 * (high - low) || 1;
  const size = engineering(Math.max(-low, high), svg.dataset.units, 3);
  const unit = size.units ? ` [${size.units}]` : "";
  const known = Number.isFinite(values.contact_trailing); // then places are lengths, else shares of half the contact
  const half = known ? (values.contact_trailing + values.contact_leading) / 2 : 1;
  const middle = known ? (values.contact_trailing - values.contact_leading) / 2 : 0;
  const along = engineering(half, "m", 3), x = X.map((one) => (known ? (middle + half * one) / along.size : one));
  const ends = [-1, 1].map((one) => (known ? (middle + half * one) / along.size : one));
  drawChart(svg, {
    title: `${svg.dataset.title}${unit}`,
    x: { label: known ? `x [${along.units}]` : "(x − c)/h", limits: ends },
    y: { limits: [(low - pad) / size.size, (high + pad) / size.size] },
    curves: [{ label: "", x, y: field.map((one) => one / size.size) }],
  });
}
