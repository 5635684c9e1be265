// The trained surrogate in the browser: the arithmetic of surrogate/gp/gridgp.py, factors.py, correction.py and conformal.py.
"use strict";

function readArray(stored) {
  const bytes = Uint8Array.from(atob(stored.data), (c) => c.charCodeAt(0));
  return { shape: stored.shape, data: new Float64Array(bytes.buffer) };
}

// Whole numbers by groups of seven bits, times a number for the row and one for the column (surrogate/use/packing.py).
function readCore(stored) {
  const [r, modes, s] = stored.shape, text = atob(stored.data), data = new Float64Array(r * modes * s);
  const rows = readArray(stored.rows).data, columns = readArray(stored.columns).data;
  let place = 0;
  for (let n = 0; n < data.length; n++) {
    let whole = 0, size = 1, byte;
    do {
      byte = text.charCodeAt(place++);
      whole += (byte & 127) * size;
      size *= 128;
    } while (byte > 127);
    data[n] = (whole % 2 ? -(whole + 1) / 2 : whole / 2) * rows[Math.floor(n / (modes * s))] * columns[n % s];
  }
  return { shape: stored.shape, data };
}

function loadSurrogate(plain) {
  const model = { ...plain, cores: plain.cores?.map(readCore) };
  for (const name of ["offset", "scale", "amplitude", "variance"]) if (plain[name]) model[name] = readArray(plain[name]);
  if (plain.calibration) {
    model.calibration = {};
    for (const name of Object.keys(plain.calibration)) model.calibration[name] = readArray(plain.calibration[name]);
  }
  if (plain.correction) model.correction = { ...plain.correction, coefficients: readArray(plain.correction.coefficients) };
  if (plain.curves) model.curves = loadCurves(plain.curves);
  if (plain.together) model.together = loadTogether(plain.together);
  if (plain.region) model.region = { ...plain.region, coefficients: readArray(plain.region.coefficients).data, places: readArray(plain.region.places) };
  if (plain.interval) model.interval = { level: plain.interval.level, lower: readArray(plain.interval.lower), upper: readArray(plain.interval.upper) };
  return model;
}

// Scores of the held-out rows, in deviations, row by row (surrogate/intervals/copula.py).
function loadTogether({ ranks, probabilities, quantiles }) {
  const { shape: [rows, , outputs], data } = readCore(ranks), of = readArray(quantiles).data;
  const scores = data.map((rank, n) => {
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

// What one factor contributes: functions that multiply the coefficients of the mean, prior variance, what is unknown.
function features(factor, t, modes) {
  const n = factor.levels, T = chebyshev(t, factor.decay.length), mean = T.slice(0, modes);
  for (let m = factor.firstDamped; m < modes; m++) mean[m] -= 2 * factor.damping[m] * T[n] * T[n - m];
  let prior = 0, residual = 0;
  for (let m = 0; m < factor.decay.length; m++) prior += factor.decay[m] * T[m] * T[m];
  if (!factor.affine) {
    for (let m = 0; m < n; m++) residual += factor.unknown[m] * T[m] * T[m];
    residual *= T[n] * T[n];
  }
  return { mean, prior, residual };
}

function contract(state, core, feature) {
  const [r, modes, s] = core.shape, next = new Float64Array(s);
  for (let i = 0; i < r; i++) {
    for (let m = 0; m < modes; m++) {
      const weight = state[i] * feature[m], row = (i * modes + m) * s;
      for (let j = 0; j < s; j++) next[j] += weight * core.data[row + j];
    }
  }
  return next;
}

// What held-out cases have told of the error of the means (correction.py): added to them.
function correct(correction, t, mean) {
  const { levels, degrees, coefficients } = correction, count = mean.length;
  const T = t.map((one, k) => chebyshev(one, Math.max(levels[k], ...degrees.map((index) => index[k])) + 1));
  degrees.forEach((index, a) => {
    const product = index.reduce((all, degree, k) => all * T[k][degree], 1);
    levels.forEach((n, f) => {
      const row = (f * degrees.length + a) * count, weight = T[f][n] * product;
      for (let p = 0; p < count; p++) mean[p] += weight * coefficients.data[row + p];
    });
  });
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

// What the process has learnt at scaled coordinates t, one an input: itself, coordinates along its axes, what every factor
// contributes there, means with their corrections, and what a deviation along the axes is of an output.
function learnt(model, t) {
  const by = model.groups ? grouped(model, t) : { along: t, told: (mean) => mean, size: () => 1 };
  const modes = new Array(by.along.length);
  model.order.forEach((k, position) => { modes[k] = model.cores[position].shape[1]; });
  const parts = model.factors.map((factor, k) => features(factor, by.along[k], modes[k]));
  let state = new Float64Array([1]);
  model.order.forEach((k, position) => { state = contract(state, model.cores[position], parts[k].mean); });
  const own = state.map((one, p) => one * model.scale.data[p] + model.offset.data[p]);
  if (model.correction) correct(model.correction, by.along, own);
  const mean = own.map(by.told);
  return { process: model, along: by.along, parts, mean, size: (p) => by.size(mean[p], p) };
}

// Why a point has no answer: the reason of the nearest known case that is refused; empty where it has one.
function refusal({ region }, t) {
  if (!region) return "";
  const T = t.map((x) => chebyshev(x, region.degree + 1));
  const terms = region.degrees.map((row) => row.reduce((product, degree, k) => product * T[k][degree], 1));
  if (terms.reduce((sum, term, m) => sum + region.coefficients[m] * term, -region.least) >= 0) return "";
  const far = region.which.map((_, n) => t.reduce((sum, x, k) => sum + (x - region.places.data[n * t.length + k]) ** 2, 0));
  return region.reasons[region.which[far.indexOf(Math.min(...far))]];
}

// Means of all outputs.
function means(model, t) {
  const { mean } = learnt(model, t);
  return model.curves ? followed(model.curves, mean).mean : mean;
}

// Means, standard deviations and ends of the intervals of all outputs at scaled coordinates t, one an input.
function predict(model, t) {
  const { process, along, parts, mean: smooth, size } = learnt(model, t), count = model.outputs.length;
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
  const ends = (away) => mean.map((one, p) => one + away.data[p] * std[p]);
  return { mean, std, lower: ends(model.interval.lower), upper: ends(model.interval.upper) };
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
