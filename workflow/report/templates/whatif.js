// The what-if panel: sliders in, every quantity with its interval and the limits out; map, stack and fields watch it.
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

const spaced = (name) => name.replaceAll("_", " ");

function startWhatIf(root) {
  const data = JSON.parse(document.getElementById("whatif-data").textContent);
  const model = loadSurrogate(data.surrogate), sliders = [...root.querySelectorAll("input[type=range]")];
  const point = [...data.start]; // finer than a slider's step
  const choosers = [...root.querySelectorAll("select[data-category]")];
  const watchers = [], targeted = []; // who is told of every move, and of every choice of a target
  let kind = data.kinds[data.kind]; // one combination of the categories
  let chosen = 0, design = data.cases.length ? 0 : null; // whose limits; the design shown, until something moves

  const panel = {
    data, model, point, values: (t = point) => judge.values(t), judged: (t) => judge.cell(t), choose, move,
    get kind() { return kind; },
    get chosen() { return chosen; },
    get goal() { return judge.goal(); },
    watch: (told) => watchers.push(told),
    onTarget: (told) => targeted.push(told),
  };
  const judge = judging(panel);

  function show() {
    const answer = predict(model, point), found = judge.values(point, answer.mean);
    const [mean, lower, upper] = [answer.mean, answer.lower, answer.upper].map((all) => kind.columns.map((column) => all[column]));
    showInputs(found);
    showOutputs(mean, lower, upper);
    showFigures(found, judge.reaches(answer));
    showLimits();
    watchers.forEach((told) => told(found));
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
      const row = root.querySelector(`tr[data-output="${output.name}"]`);
      showValue(row, output.units, mean[p], lower[p], upper[p]);
      const [low, high] = data.ranges[kind.columns[p]], share = high > low ? (mean[p] - low) / (high - low) : 0.5;
      row.querySelector("i").style.left = `${100 * Math.min(Math.max(share, 0), 1)}%`;
    });
  }

  // Figures of the device: as far as the intervals of their quantities take them.
  function showFigures(found, reach) {
    data.figures.forEach(({ name, units, tree }) => {
      const value = evaluate(tree, found), away = carried(tree, found, reach);
      showValue(root.querySelector(`tr[data-figure="${name}"]`), units, value, value - away, value + away);
    });
  }

  function showValue(row, units, mean, lower, upper) {
    const shown = engineering(mean, units), ends = [lower, upper];
    const count = figures(Math.max(...ends.map(Math.abs)), (upper - lower) / 2);
    [row.dataset.mean, row.dataset.lower, row.dataset.upper] = [mean, lower, upper].map(String);
    row.cells[1].textContent = fixed(mean / shown.size, count);
    row.cells[2].textContent = `[${ends.map((end) => fixed(end / shown.size, count)).join(", ")}]`;
    row.cells[3].textContent = shown.units;
  }

  // Exact at the design, as workflow/design/verdict/assessment.py has it; elsewhere on the surrogate.
  function verdict(limit, points) {
    if (design !== null) return { value: limit.exact, room: 0, words: limit.held ? "held" : "broken" };
    if (!limit.judged) return { value: null, room: 0, words: "not judged at one point" };
    const { value, excess, room } = judge.worst(limit, points);
    return { value, room, words: excess > room ? "broken" : excess < -room ? "held" : "on the limit, as exactly as the surrogate can say" };
  }

  function showLimits() {
    const list = root.querySelector("ul.limits"), target = data.cases[chosen];
    if (!list) return;
    const over = target.over ? ` over ${target.over}` : "", name = spaced(target.name);
    const how = design === null ? `on the surrogate${over}${over ? ", whatever the sliders say of that" : ""}` : `exact${over}, at its design`;
    document.getElementById("judged").textContent = target.limits.length ? `Limits of ${name}, ${how}:` : `${name} has no limits.`;
    const found = design === null && target.limits.some(({ judged: one }) => one) ? judge.scenarios(target, point) : [];
    list.replaceChildren(...target.limits.map((limit) => {
      const { value, room, words: said_ } = verdict(limit, found), row = document.createElement("li");
      row.className = said_ === "broken" ? "bad" : said_.startsWith("not") ? "soft" : "good";
      Object.assign(row.dataset, { limit: limit.text, verdict: said_, value: String(value), room: String(room) });
      row.textContent = `${limit.words}: ${value === null ? "" : `${said(value, limit.units, 5)}, `}${said_}`.replaceAll(" %", "\u00a0%");
      return row;
    }));
    root.querySelectorAll("button[data-case]").forEach((button, k) => button.setAttribute("aria-pressed", String(k === chosen)));
  }

  function place(k, t) {
    point[k] = Math.min(Math.max(t, -1), 1); // finer than a slider's step
    sliders[k].value = String(point[k]);
  }

  // Goes to scaled coordinates of some inputs, by their places, and to a combination of the categories.
  function move(places, t, of = kind) {
    places.forEach((k, n) => place(k, t[n]));
    design = null;
    take(of);
  }

  function take(of) {
    kind = of;
    choosers.forEach((one) => { one.value = kind.names[one.dataset.category]; });
    show();
  }

  // A target's design: its own verdict is shown.
  function choose(number) {
    chosen = design = number;
    const target = data.cases[chosen];
    model.inputs.forEach((input, k) => place(k, toUnit(input, target.values[input.name])));
    targeted.forEach((told) => told(target));
    take(data.kinds[target.kind]);
  }

  sliders.forEach((slider, k) => slider.addEventListener("input", () => { point[k] = Number(slider.value); design = null; show(); }));
  choosers.forEach((one) => one.addEventListener("change", () => {
    move([], [], data.kinds.find(({ names }) => choosers.every((other) => names[other.dataset.category] === other.value)));
  }));
  root.querySelectorAll("button[data-case]").forEach((button) => button.addEventListener("click", () => choose(Number(button.dataset.case))));
  const parts = { "[data-stack]": showStack, "[data-fields]": showFields, "[data-map]": startMap };
  Object.entries(parts).forEach(([where, start]) => { const found = root.querySelector(where); if (found) start(panel, found); });
  if (data.cases.length) targeted.forEach((told) => told(data.cases[0]));
  show();
  startSharing(panel, root);
}

const whatIf = document.getElementById("whatif");
if (whatIf && document.getElementById("whatif-data")) startWhatIf(whatIf);
