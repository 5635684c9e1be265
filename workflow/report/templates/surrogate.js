// The trained surrogate in the browser: rounded means (surrogate/use/export.py), the variance of gridgp.py and conformal.py.
"use strict";

const TYPES = { i1: Int8Array, i2: Int16Array, f4: Float32Array, f8: Float64Array };

function readArray(stored) {
  const bytes = Uint8Array.from(atob(stored.data), (c) => c.charCodeAt(0));
  return { shape: stored.shape, data: new TYPES[stored.type](bytes.buffer) };
}

function loadSurrogate(plain) {
  const model = { ...plain, trains: plain.trains.map((train) => ({ ...train, numbers: readArray(train.numbers).data })) };
  for (const name of ["amplitude", "variance"]) if (plain[name]) model[name] = readArray(plain[name]);
  model.factors = plain.factors?.map((one) => ({ ...one, decay: readArray(one.decay).data, unknown: readArray(one.unknown).data }));
  if (plain.calibration) {
    model.calibration = {};
    for (const name of Object.keys(plain.calibration)) model.calibration[name] = readArray(plain.calibration[name]);
  }
  if (plain.curves) model.curves = loadCurves(plain.curves);
  if (plain.together) model.together = loadTogether(plain.together);
  if (plain.interval) {
    model.interval = { level: plain.interval.level };
    for (const name of ["lower", "upper", "rooms"]) model.interval[name] = readArray(plain.interval[name]).data;
  }
  return model;
}

// Scores of the held-out rows, in deviations, row by row (surrogate/intervals/copula.py).
function loadTogether({ ranks, probabilities, quantiles }) {
  const { shape: [rows, outputs], data } = readArray(ranks), of = readArray(quantiles).data;
  const scores = Float64Array.from(data, (rank, n) => {
    const share = (rank + 0.5) / rows, column = n % outputs;
    const k = Math.max(probabilities.findIndex((next) => next >= share), 1), wide = probabilities[k] - probabilities[k - 1];
    const below = of[(k - 1) * outputs + column], above = of[k * outputs + column];
    return below + ((above - below) / wide) * (share - probabilities[k - 1]);
  });
  return { rows, outputs, scores };
}

function logit(share) {
  return Math.log(share / (1 - share));
}

function toUnit(input, value) {
  if (input.scale === "logit") {
    return (2 * (logit(value) - logit(input.low))) / (logit(input.high) - logit(input.low)) - 1;
  }
  if (input.scale === "log") return (2 * Math.log(value / input.low)) / Math.log(input.high / input.low) - 1;
  return (2 * (value - input.low)) / (input.high - input.low) - 1;
}

function fromUnit(input, t) {
  if (t <= -1) return input.low;
  if (t >= 1) return input.high;
  const share = (t + 1) / 2;
  if (input.scale === "log") return input.low * Math.exp(share * Math.log(input.high / input.low));
  if (input.scale === "logit") return 1 / (1 + Math.exp(-logit(input.low) - share * (logit(input.high) - logit(input.low))));
  return input.low + share * (input.high - input.low);
}

function chebyshev(t, count) {
  const T = new Float64Array(count);
  T[0] = 1;
  if (count > 1) T[1] = t;
  for (let m = 2; m < count; m++) T[m] = 2 * t * T[m - 1] - T[m - 2];
  return T;
}

// What one factor contributes to the variance, from its polynomials: prior, and what is unknown.
function features(factor, T) {
  const n = factor.levels;
  let prior = 0, residual = 0;
  for (let m = 0; m < factor.decay.length; m++) prior += factor.decay[m] * T[m] * T[m];
  if (!factor.affine) {
    for (let m = 0; m < n; m++) residual += factor.unknown[m] * T[m] * T[m];
    residual *= T[n] * T[n];
  }
  return { prior, residual };
}

// The mean of one output, from the polynomials of every axis.
function contract({ modes, ranks, numbers, offset }, order, T) {
  let state = [1], place = 0;
  order.forEach((k, position) => {
    const next = new Float64Array(ranks[position]);
    for (const one of state) {
      for (let m = 0; m < modes[position]; m++) {
        const weight = one * T[k][m];
        for (let j = 0; j < next.length; j++) next[j] += weight * numbers[place++];
      }
    }
    state = next;
  });
  return state[0] + offset;
}

// The arithmetic of surrogate/gp/grouping.py: axes, scales and added logarithms are products of powers of the inputs.
// Coordinates along the axes at scaled coordinates of the inputs, and what takes learnt outputs to those of the inputs.
function grouped(model, t) {
  const g = model.groups, X = model.inputs.map((input, k) => fromUnit(input, t[k]));
  const product = (powers, values) => powers.reduce((all, power, k) => (power ? all * Math.pow(values[k], power) : all), 1);
  const along = model.axes.map((axis, a) => {
    const value = g.axis_constant[a] * product(g.axis_power[a], X);
    return toUnit(axis, Math.min(Math.max(value, axis.low), axis.high));
  });
  const relative = X.map((x, k) => x / g.reference[k]), added = Math.log(product(g.added_power, relative));
  return {
    along,
    told: (learnt, p) => {
      const scale = product(g.scale_power[p], relative), sign = g.logarithm[p];
      return scale * (sign ? sign * Math.exp(sign * learnt) : learnt + g.added_coefficient[p] * added);
    },
    size: (mean, p) => (g.logarithm[p] ? Math.abs(mean) : product(g.scale_power[p], relative)),
  };
}

// What the process has learnt at scaled coordinates t, one an input: itself, coordinates along its axes and polynomials
// there, means, and what a deviation along the axes is of an output.
function learnt(model, t) {
  const by = model.groups ? grouped(model, t) : { along: t, told: (mean) => mean, size: () => 1 };
  const counts = model.order.map((_, position) => Math.max(2, ...model.trains.map(({ modes }) => modes[position])));
  const T = by.along.map((one, k) => chebyshev(one, Math.max(counts[model.order.indexOf(k)], model.factors?.[k].decay.length ?? 0)));
  const mean = Float64Array.from(model.trains, (train, p) => by.told(contract(train, model.order, T), p));
  return { process: model, along: by.along, T, mean, size: (p) => by.size(mean[p], p) };
}

// Means of all outputs.
function means(model, t) {
  const { mean } = learnt(model, t);
  return model.curves ? followed(model.curves, mean).mean : mean;
}

// Means, standard deviations and ends of the intervals of all outputs at scaled coordinates t, one an input.
function predict(model, t) {
  const { process, along, T, mean: smooth, size } = learnt(model, t), count = model.outputs.length;
  const parts = process.factors.map((factor, k) => features(factor, T[k]));
  const { mean, spread } = model.curves ? followed(model.curves, smooth) : { mean: smooth, spread: null };
  const terms = trendTerms(model.calibration, spread ? t : along);
  const std = mean.map((_, p) => {
    let unknown = 0, known = 1;
    parts.forEach((part, f) => {
      const amplitude = process.amplitude.data[f * count + p];
      const weight = model.calibration ? model.calibration.weights.data[f * count + p] : 1;
      const k = amplitude * part.prior + 1, r = amplitude * part.residual;
      unknown = unknown * k + known * r * weight;
      known *= k - r;
    });
    unknown *= process.variance.data[p];
    // largest values are calibrated over the inputs, by the size that the deviation of one smooth output then has
    if (spread) return calibrated(model, t, terms, p, unknown * (size(model.curves.witness[p]) * spread[p]) ** 2);
    const c = model.calibration; // groups have a guard over the inputs too
    const outer = c && c.outer_guard
      ? guarded(c.outer_guard, c.outer_corner_guard, c.outer_pooled_guard, t, p, count) : 0;
    return calibrated(model, along, terms, p, unknown) * size(p) * Math.exp(outer);
  });
  const { lower, upper, rooms } = model.interval; // wider by the largest error of the rounding
  return {
    mean, std,
    lower: mean.map((one, p) => one + lower[p] * std[p] - rooms[p]),
    upper: mean.map((one, p) => one + upper[p] * std[p] + rooms[p]),
  };
}

// Below the square root of the square root of the smallest double a standard deviation is rounding, as of what is 0 always.
const meaningful = (std) => (std < 1.22e-77 ? 0 : std);

const withinBox = (t) => t.map((one) => Math.min(Math.max(one, -1), 1));

// Products of Chebyshev polynomials that the logarithm of the local scale is made of.
function trendTerms(c, t) {
  if (!c) return null;
  const [count, inputs] = c.trend_degree.shape, degrees = c.trend_degree.data;
  const T = withinBox(t).map((one) => chebyshev(one, Math.max(...degrees) + 1));
  return Float64Array.from({ length: count }, (_, m) =>
    T.reduce((product, own, k) => product * own[degrees[m * inputs + k]], 1));
}

function calibrated(model, t, terms, p, variance) {
  const c = model.calibration, count = model.outputs.length;
  if (!c) return meaningful(Math.sqrt(variance));
  let scale = 0;
  terms.forEach((term, m) => { scale += term * c.trend.data[m * count + p]; });
  scale = Math.min(Math.max(scale, c.trend_range.data[p]), c.trend_range.data[count + p]);
  const guard = guarded(c.guard, c.corner_guard, null, t, p, count);
  return meaningful(Math.sqrt(variance + c.floor.data[p]) * Math.exp(scale + guard));
}

// What the local scale needs beyond it (guard.py): the largest of slabs, of corners of two inputs, and of all corners together.
function guarded(own, corners, pooled, t, p, count) {
  const slabs = own.shape[1];
  const slab = withinBox(t).map((one) => Math.min(Math.max(Math.trunc(((one + 1) / 2) * slabs), 0), slabs - 1));
  const edge = slab.map((one) => (one > 0) + (one === slabs - 1)); // 0 in the lowest slab, 2 in the highest
  let guard = -Infinity, pair = 0;
  slab.forEach((one, k) => { guard = Math.max(guard, own.data[(k * slabs + one) * count + p]); });
  for (let i = 0; i < t.length; i++) {
    for (let j = i + 1; j < t.length; j++, pair++) {
      guard = Math.max(guard, corners.data[((pair * 3 + edge[i]) * 3 + edge[j]) * count + p]);
      if (pooled && edge[i] !== 1 && edge[j] !== 1) guard = Math.max(guard, pooled.data[p]);
    }
  }
  return guard;
}
