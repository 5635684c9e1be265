// What a target comes to on the surrogate, at the sliders and in each cell of the map: its goal, and its limits with their room.
"use strict";

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

// How far an expression moves when each value that has a size moves by it.
function carried(tree, values, sizes) {
  return Object.entries(sizes).reduce((sum, [name, size]) => {
    const at = (one) => evaluate(tree, { ...values, [name]: one });
    return sum + Math.abs(at(values[name] + size) - at(values[name] - size)) / 2;
  }, 0);
}

// How far an expression of several values may be off, their errors going together as those of the held-out rows did: the rule of
// surrogate/intervals/copula.py at one point. Of each value its column in the model, its deviation and how far its interval reaches.
function offBy(model, tree, values, errors) {
  const told = Object.entries(errors).map(([name, one]) => {
    const at = (size) => evaluate(tree, { ...values, [name]: values[name] + size });
    return { ...one, slope: one.std > 0 ? (at(one.std) - at(-one.std)) / 2 : 0 };
  }).filter(({ slope }) => slope !== 0);
  const alone = (size) => told.reduce((sum, one) => sum + (Math.abs(one.slope) * one[size]) / one.std, 0);
  if (!model.together || told.length < 2) return alone("reach");
  const { rows, outputs, scores } = model.together;
  const sums = Float64Array.from({ length: rows }, (_, row) =>
    told.reduce((sum, { slope, column }) => sum + slope * scores[row * outputs + column], 0)).sort();
  const end = (share) => {
    const place = Math.min(Math.max(share * (rows + 1) - 1, 0), rows - 1), below = Math.floor(place);
    return sums[below] + (place - below) * (sums[Math.min(below + 1, rows - 1)] - sums[below]);
  };
  return Math.max(Math.abs(end((1 - model.interval.level) / 2)), Math.abs(end((1 + model.interval.level) / 2))) + alone("room");
}

// Of a panel: its data and model, and which kind of case and which target are chosen.
function judging(panel) {
  const { data, model } = panel;

  // Values of every name at scaled coordinates t, on the means of the surrogate.
  function values(t, mean = means(model, t)) {
    const found = { ...data.fixed };
    model.inputs.forEach((input, k) => { found[input.name] = fromUnit(input, t[k]); });
    data.quantities.forEach(({ name }, p) => { found[name] = mean[panel.kind.columns[p]]; });
    return found;
  }

  // Of every quantity its deviation and how far its interval reaches from the mean.
  function errors({ mean, std, lower, upper }) {
    return Object.fromEntries(data.quantities.map(({ name }, p) => {
      const column = panel.kind.columns[p];
      return [name, { column, std: std[column], room: model.interval.rooms[column], reach: Math.max(upper[column] - mean[column], mean[column] - lower[column]) }];
    }));
  }

  // Some scenarios of a target at a point: what it must stand, and what is off as built; scaled coordinates and values.
  function scenarios(target, t, some = Array.from({ length: target.count }, (_, s) => s)) {
    const built = (input, k, offset) => {
      const value = fromUnit(input, t[k]), [absolute, share] = target.tolerances[input.name];
      return Math.min(Math.max(toUnit(input, value * (1 + share * offset) + absolute * offset), -1), 1);
    };
    return some.map((s) => {
      const at = model.inputs.map((input, k) => {
        if (input.name in target.scenarios) return toUnit(input, target.scenarios[input.name][s]);
        return input.name in target.offsets ? built(input, k, target.offsets[input.name][s]) : t[k];
      });
      const stood = Object.fromEntries(Object.entries(target.scenarios).map(([name, all]) => [name, all[s]]));
      return { t: at, values: { ...values(at), ...stood } };
    });
  }

  // The worst of some scenarios for a limit: its value, what that is beyond the limit, and by how much it may be so: the rule of
  // workflow/design/verdict/assessment.py, by which what is within its interval and the study's tolerance counts as held.
  function worst(limit, points) {
    const all = points.map((one) => evaluate(limit.tree, one.values)), value = (limit.upper ? Math.max : Math.min)(...all);
    const { t, values: there } = points[all.findIndex((one) => Object.is(one, value))];
    return { value, excess: limit.upper ? value - limit.value : limit.value - value, get room() { return room(limit, t, there); } };
  }

  function room(limit, t, there) {
    const off = offBy(model, limit.tree, there, errors(predict(model, t)));
    return off + carried(limit.tree, there, panel.kind.allowances) + 1e-12 * Math.abs(limit.value);
  }

  // By how much a limit is broken, negative where it is kept; an interval is asked for only where the mean is beyond the limit.
  function beyond(limit, points) {
    const found = worst(limit, points);
    return found.excess > 0 ? found.excess - found.room : found.excess;
  }

  // The goal of the chosen target; without targets, the first quantity.
  function goal() {
    if (data.cases.length) return data.cases[panel.chosen].goal;
    const { name, title, units } = data.quantities[0];
    return { title, short: title, tree: name, units, worst: false };
  }

  // At scaled coordinates t: the goal, over the scenarios where it counts at worst, and by how much every limit that a point
  // decides is broken. The shading of a map takes few scenarios, what is told of a point takes all.
  function cell(t, few = false) {
    const target = data.cases[panel.chosen], { tree, worst: over, maximise } = goal();
    const points = target ? scenarios(target, t, few ? target.few : undefined) : [];
    const found = over ? points.map((one) => evaluate(tree, one.values)) : [evaluate(tree, values(t))];
    const limits = target ? target.limits.filter((one) => one.judged).map((one) => beyond(one, points)) : [];
    const broken = limits.some((one) => one > 0);
    return { goal: (maximise ? Math.min : Math.max)(...found), limits, broken };
  }

  return { values, errors, scenarios, worst, goal, cell };
}
