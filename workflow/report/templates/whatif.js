// The what-if panel: sliders in, every quantity with its interval, the contact pressure and the limits out.
"use strict";

// Two figures of half of an interval's width, as meecontact query prints (workflow/cli/predictions.py).
function figures(size, half) {
  return half > 0 ? Math.min(Math.max(Math.floor(Math.log10(size)) - Math.floor(Math.log10(half)) + 2, 4), 15) : 10;
}

// All figures, zeros at the end too, so that a value and its interval are read against each other.
function fixed(value, count) {
  const text = value.toPrecision(count);
  return text.includes("e") ? digits(value, count) : text.replace("-", "−");
}

function evaluate(tree, values) {
  if (typeof tree === "number") return tree;
  if (typeof tree === "string") return values[tree];
  const [symbol, ...parts] = tree, [a, b] = parts.map((part) => evaluate(part, values));
  switch (symbol) {
    case "+": return a + b;
    case "-": return a - b;
    case "*": return a * b;
    case "/": return a / b;
    case "^": return a ** b;
    case "min": return Math.min(...parts.map((part) => evaluate(part, values)));
    case "max": return Math.max(...parts.map((part) => evaluate(part, values)));
    case "abs": return Math.abs(a);
    case "sqrt": return Math.sqrt(a);
    case "log": return Math.log(a);
    case "exp": return Math.exp(a);
  }
  throw new Error(`unknown operation ${symbol}`);
}

// Closed form of the pressure under a circular punch, from its extents, exponent and peak.
function pressure(values, count) {
  const { contact_trailing: a, contact_leading: b, pressure_exponent: alpha, peak_pressure: peak } = values;
  const l = a + b, points = [];
  for (let k = 0; k <= count; k++) {
    const s = (1 - Math.cos((Math.PI * k) / count)) / 2, x = -b + l * s;
    points.push([x, peak * ((1 - s) / alpha) ** alpha * (s / (1 - alpha)) ** (1 - alpha)]);
  }
  return points;
}

function startWhatIf(root) {
  const data = JSON.parse(document.getElementById("whatif-data").textContent);
  const model = loadSurrogate(data.surrogate), sliders = [...root.querySelectorAll("input[type=range]")];
  const point = [...data.start]; // finer than a slider's step
  const choosers = [...root.querySelectorAll("select[data-category]")], svg = root.querySelector("svg");
  let kind = data.kinds[data.kind]; // one combination of the categories
  let chosen = 0, design = data.cases.length ? 0 : null; // whose limits; the design shown, until something moves

  function show() {
    const answer = predict(model, point), values = { ...data.fixed };
    const [mean, lower, upper] = [answer.mean, answer.lower, answer.upper].map((all) => kind.columns.map((column) => all[column]));
    model.inputs.forEach((input, k) => { values[input.name] = fromUnit(input, point[k]); });
    data.quantities.forEach((output, p) => { values[output.name] = mean[p]; });
    showInputs(values);
    showOutputs(mean, lower, upper);
    showLimits();
    if (svg) svg.closest("figure").hidden = !kind.pressure;
    if (kind.pressure) drawPressure(svg, values);
  }

  function showInputs(values) {
    model.inputs.forEach((input, k) => {
      const out = root.querySelector(`output[data-input="${input.name}"]`), value = values[input.name];
      out.textContent = said(value, input.units, 4);
      out.dataset.value = String(value);
      sliders[k].setAttribute("aria-valuetext", out.textContent);
    });
  }

  function showOutputs(mean, lower, upper) {
    data.quantities.forEach((output, p) => {
      const row = root.querySelector(`tr[data-output="${output.name}"]`), shown = engineering(mean[p], output.units);
      row.dataset.mean = String(mean[p]);
      const ends = [lower[p], upper[p]], count = figures(Math.max(...ends.map(Math.abs)), (upper[p] - lower[p]) / 2);
      [row.dataset.lower, row.dataset.upper] = ends.map(String);
      row.cells[1].textContent = fixed(mean[p] / shown.size, count);
      row.cells[2].textContent = `[${ends.map((end) => fixed(end / shown.size, count)).join(", ")}]`;
      row.cells[3].textContent = shown.units;
      const [low, high] = data.ranges[kind.columns[p]], share = high > low ? (mean[p] - low) / (high - low) : 0.5;
      row.querySelector("i").style.left = `${100 * Math.min(Math.max(share, 0), 1)}%`;
    });
  }

  // Values of every name in each scenario of a target at the point, and how far the intervals of the quantities reach from their means.
  function scenarios(target) {
    return Array.from({ length: target.count }, (_, s) => {
      const t = model.inputs.map((input, k) => (input.name in target.scenarios ? toUnit(input, target.scenarios[input.name][s]) : point[k]));
      const answer = predict(model, t), values = { ...data.fixed }, reach = {};
      model.inputs.forEach((input, k) => { values[input.name] = input.name in target.scenarios ? target.scenarios[input.name][s] : fromUnit(input, t[k]); });
      data.quantities.forEach(({ name }, p) => {
        const column = kind.columns[p], mean = answer.mean[column];
        values[name] = mean;
        reach[name] = Math.max(answer.upper[column] - mean, mean - answer.lower[column]);
      });
      return { values, reach };
    });
  }

  // The verdict of workflow/design/assessment.py: exact at the design; elsewhere the worst scenario on the surrogate, where what
  // is within its interval and the study's tolerance of the limit counts as held.
  function verdict(limit, cases) {
    if (design !== null) return { value: limit.exact, room: 0, words: limit.held ? "held" : "broken" };
    if (!limit.judged) return { value: null, room: 0, words: "not judged at one point" };
    const all = cases.map(({ values }) => evaluate(limit.tree, values)), value = (limit.upper ? Math.max : Math.min)(...all);
    const { values, reach } = cases[all.indexOf(value)];
    const room = data.quantities.reduce((sum, { name }) => {
      const size = reach[name] + kind.allowances[name], at = (one) => evaluate(limit.tree, { ...values, [name]: one });
      return sum + Math.abs(at(values[name] + size) - at(values[name] - size)) / 2;
    }, 1e-12 * Math.abs(limit.value));
    const excess = limit.upper ? value - limit.value : limit.value - value;
    return { value, room, words: excess > room ? "broken" : excess < -room ? "held" : "on the limit, as exactly as the surrogate can say" };
  }

  function showLimits() {
    const list = root.querySelector("ul.limits"), target = data.cases[chosen];
    if (!list) return;
    const over = target.over ? ` over ${target.over}` : "", name = target.name.replaceAll("_", " ");
    const how = design === null ? `on the surrogate${over}${over ? ", whatever the sliders say of that" : ""}` : `exact${over}, at its design`;
    document.getElementById("judged").textContent = target.limits.length ? `Limits of ${name}, ${how}:` : `${name} has no limits.`;
    const cases = design === null && target.limits.some(({ judged }) => judged) ? scenarios(target) : [];
    list.replaceChildren(...target.limits.map((limit) => {
      const { value, room, words } = verdict(limit, cases), row = document.createElement("li");
      row.className = words === "broken" ? "bad" : words.startsWith("not") ? "soft" : "good";
      Object.assign(row.dataset, { limit: limit.text, verdict: words, value: String(value), room: String(room) });
      row.textContent = `${limit.text}: ${value === null ? "" : `${said(value, limit.units, 5)}, `}${words}`;
      return row;
    }));
    root.querySelectorAll("button[data-case]").forEach((button, k) => button.setAttribute("aria-pressed", String(k === chosen)));
  }

  sliders.forEach((slider, k) => slider.addEventListener("input", () => { point[k] = Number(slider.value); design = null; show(); }));
  choosers.forEach((one) => one.addEventListener("change", () => {
    kind = data.kinds.find(({ names }) => choosers.every((other) => names[other.dataset.category] === other.value));
    design = null;
    show();
  }));
  root.querySelectorAll("button[data-case]").forEach((button) => button.addEventListener("click", () => {
    chosen = design = Number(button.dataset.case);
    const { values, kind: k } = data.cases[chosen];
    kind = data.kinds[k];
    choosers.forEach((one) => { one.value = kind.names[one.dataset.category]; });
    model.inputs.forEach((input, k) => {
      point[k] = Math.min(Math.max(toUnit(input, values[input.name]), -1), 1); // finer than a slider's step
      sliders[k].value = String(point[k]);
    });
    show();
  }));
  show();
}

function drawPressure(svg, values) {
  const points = pressure(values, 96), width = 420, height = 190, left = 52, bottom = 30, top = 8;
  const reach = Math.max(values.contact_trailing, values.contact_leading) * 1.12, peak = values.peak_pressure;
  const xs = engineering(reach, "m"), ys = engineering(peak, "Pa"), most = 1.12 * peak;
  const X = (x) => left + ((width - left - 8) * (x + reach)) / (2 * reach);
  const Y = (y) => top + (height - top - bottom) * (1 - y / most);
  const line = points.map(([x, y]) => `${X(x).toFixed(2)},${Y(y).toFixed(2)}`).join(" ");
  const ticks = [0, 0.5, 1].map((s) => `<text x="${left - 6}" y="${Y(s * peak) + 4}" text-anchor="end">${digits((s * peak) / ys.size, 3)}</text><line class="grid" x1="${left}" x2="${width - 8}" y1="${Y(s * peak)}" y2="${Y(s * peak)}"/>`);
  const ends = [[-values.contact_leading, "leading"], [values.contact_trailing, "trailing"]].map(([x, name]) => `<text x="${X(x)}" y="${height - 16}" text-anchor="middle">${digits(x / xs.size, 3)}</text><text class="soft" x="${x < 0 ? left : width - 8}" y="${height - 3}" text-anchor="${x < 0 ? "start" : "end"}">${name} edge [${xs.units}]</text>`);
  svg.innerHTML = `${ticks.join("")}${ends.join("")}<polygon class="area" points="${line}"/><polyline class="curve" points="${line}"/><text x="${left}" y="${top + 4}" class="soft">p [${ys.units}]</text>`;
}

const whatIf = document.getElementById("whatif");
if (whatIf && document.getElementById("whatif-data")) startWhatIf(whatIf);
