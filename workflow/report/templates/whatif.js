// The what-if panel: sliders in, every quantity with its interval and the limits out; map, stack and fields watch it.
"use strict";

const LEAST = 1e-5; // share of a value that is told of its interval

// A title within a sentence: its first letter small, unless it begins an abbreviation or a formula.
const within = (title) => (/^[A-Z][a-z]+(?![A-Z])/.test(title) ? title[0].toLowerCase() + title.slice(1) : title);
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
    data, model, point, values: (t = point) => judge.values(t), judged: (t, few) => judge.cell(t, few), choose, move,
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
    showFigures(found, judge.errors(answer));
    showLimits();
    showHeadlines(found);
    watchers.forEach((told) => told(found));
  }

  function showInputs(values) {
    model.inputs.forEach((input, k) => {
      const out = root.querySelector(`output[data-input="${input.name}"]`), value = values[input.name];
      out.textContent = said(value, input.units, 3);
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
  function showFigures(found, errors) {
    data.figures.forEach(({ name, units, tree }) => {
      const value = evaluate(tree, found), away = offBy(model, tree, found, errors);
      showValue(root.querySelector(`tr[data-figure="${name}"]`), units, value, value - away, value + away);
    });
  }

  // A value with half of its interval, as a share of it where it is not next to nothing.
  function showValue(row, units, mean, lower, upper) {
    const half = (upper - lower) / 2, share = half / Math.abs(mean), shown = engineering(mean, units, 3);
    [row.dataset.mean, row.dataset.lower, row.dataset.upper] = [mean, lower, upper].map(String);
    row.cells[1].textContent = digits(mean / shown.size, 3);
    row.cells[2].textContent = share < LEAST ? `± < ${said(LEAST, "%", 1)}` : `± ${share < 1 ? said(share, "%", 2) : said(half, units, 2)}`;
    row.cells[3].textContent = shown.units;
  }

  // The large numbers: the goal as it counts, figures of the device, and whether every limit is kept.
  function showHeadlines(found) {
    const write = (tile, value, text) => {
      tile.querySelector("b").textContent = value;
      const below = tile.querySelector("span");
      if (below) below.textContent = text;
    };
    const { title, short, units, exact } = judge.goal(), { goal, broken } = judge.cell(point), target = data.cases[chosen], tile = root.querySelector("[data-goal]");
    const value = design === null ? goal : exact ?? goal;
    tile.dataset.value = String(value);
    write(tile, said(value, units, 3), title);
    root.querySelectorAll("[data-headline]").forEach((one) => {
      const figure = data.figures.find(({ name }) => name === one.dataset.headline);
      one.hidden = figure.title === short; // the goal says it
      write(one, said(evaluate(figure.tree, found), figure.units, 3));
    });
    const verdict_ = root.querySelector("[data-verdict]");
    if (!verdict_) return;
    const missed = design === null ? broken : target.limits.some(({ held }) => !held), judged = target.limits.some((one) => one.judged);
    const beyond = design !== null && !missed && target.beyond; // as its card says
    Object.assign(verdict_.dataset, { verdict: missed ? "broken" : "kept" });
    verdict_.className = `tile ${missed ? "bad" : beyond ? "edge" : "good"}`;
    verdict_.hidden = !target.limits.length || (design === null && !judged);
    write(verdict_, missed ? "a limit is broken" : beyond ? "beyond linear theory" : "limits are kept", design === null ? "on the surrogate" : `exact, at the design${beyond ? ", which keeps its limits" : ""}: ${within(target.title)}`);
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
    const over = target.over ? ` over ${target.over}` : "", name = target.title;
    const how = design === null ? `on the surrogate${over}${over ? ", whatever the sliders say of that" : ""}` : `exact${over}, at its design`;
    document.getElementById("judged").textContent = target.limits.length ? `Limits of \u201c${name}\u201d, ${how}:` : `\u201c${name}\u201d has no limits.`;
    const found = design === null && target.limits.some(({ judged: one }) => one) ? judge.scenarios(target, point) : [];
    list.replaceChildren(...target.limits.map((limit) => {
      const { value, room, words: said_ } = verdict(limit, found), row = document.createElement("li");
      row.className = said_ === "broken" ? "bad" : said_.startsWith("not") ? "soft" : "good";
      Object.assign(row.dataset, { limit: limit.text, verdict: said_, value: String(value), room: String(room) });
      row.textContent = `${limit.words}: ${value === null ? "" : `${said(value, limit.units, 3)}, `}${said_}`.replaceAll(" %", "\u00a0%");
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
