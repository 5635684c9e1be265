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
    data, model, point, values, judged, choose, move,
    get kind() { return kind; },
    get chosen() { return chosen; },
    get goal() { return goal(); },
    watch: (told) => watchers.push(told),
    onTarget: (told) => targeted.push(told),
  };

  // Values of every name at scaled coordinates t, on the means of the surrogate.
  function values(t = point, mean = means(model, t)) {
    const found = { ...data.fixed };
    model.inputs.forEach((input, k) => { found[input.name] = fromUnit(input, t[k]); });
    data.quantities.forEach((output, p) => { found[output.name] = mean[kind.columns[p]]; });
    return found;
  }

  function show() {
    const answer = predict(model, point), found = values(point, answer.mean);
    const [mean, lower, upper] = [answer.mean, answer.lower, answer.upper].map((all) => kind.columns.map((column) => all[column]));
    showInputs(found);
    showOutputs(mean, lower, upper);
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

  // The scaled coordinates of some scenarios of a target at a point: what it must stand, and what is off as built.
  function scenarios(target, t, some = Array.from({ length: target.count }, (_, s) => s)) {
    const built = (input, k, offset) => {
      const value = fromUnit(input, t[k]), [absolute, share] = target.tolerances[input.name];
      return Math.min(Math.max(toUnit(input, value * (1 + share * offset) + absolute * offset), -1), 1);
    };
    return some.map((s) => model.inputs.map((input, k) => {
      if (input.name in target.scenarios) return toUnit(input, target.scenarios[input.name][s]);
      return input.name in target.offsets ? built(input, k, target.offsets[input.name][s]) : t[k];
    }));
  }

  // Values of every name in each scenario at the point, and how far the intervals of the quantities reach from their means.
  function cases(target) {
    return scenarios(target, point).map((t, s) => {
      const answer = predict(model, t), found = values(t, answer.mean), reach = {};
      Object.entries(target.scenarios).forEach(([name, all]) => { found[name] = all[s]; });
      data.quantities.forEach(({ name }, p) => {
        const column = kind.columns[p], mean = answer.mean[column];
        reach[name] = Math.max(answer.upper[column] - mean, mean - answer.lower[column]);
      });
      return { values: found, reach };
    });
  }

  // The goal of the chosen target; without targets, the first quantity.
  function goal() {
    if (data.cases.length) return data.cases[chosen].goal;
    const { name, title, units } = data.quantities[0];
    return { title, tree: name, units, worst: false };
  }

  // The goal at scaled coordinates t, over the scenarios where it counts at worst, and whether some limit is broken there.
  function judged(t) {
    const target = data.cases[chosen], { tree, worst, maximise } = goal();
    const all = target ? scenarios(target, t, target.few).map((one) => values(one)) : [values(t)];
    const found = worst ? all.map((one) => evaluate(tree, one)) : [evaluate(tree, values(t))];
    const limits = target ? target.limits.filter((one) => one.judged) : [];
    const broken = limits.some(({ tree: of, value, upper }) => all.some((one) => (upper ? evaluate(of, one) > value : evaluate(of, one) < value)));
    return { goal: (maximise ? Math.min : Math.max)(...found), broken };
  }

  // The verdict of workflow/design/verdict/assessment.py: exact at the design; elsewhere the worst scenario on the surrogate, where what
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
    const over = target.over ? ` over ${target.over}` : "", name = spaced(target.name);
    const how = design === null ? `on the surrogate${over}${over ? ", whatever the sliders say of that" : ""}` : `exact${over}, at its design`;
    document.getElementById("judged").textContent = target.limits.length ? `Limits of ${name}, ${how}:` : `${name} has no limits.`;
    const found = design === null && target.limits.some(({ judged: one }) => one) ? cases(target) : [];
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
