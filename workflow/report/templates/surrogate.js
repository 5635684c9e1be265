// The trained surrogate in the browser: the arithmetic of surrogate/gp/gridgp.py, factors.py and conformal.py.
"use strict";

function readArray(stored) {
  const bytes = Uint8Array.from(atob(stored.data), (c) => c.charCodeAt(0));
  return { shape: stored.shape, data: new Float64Array(bytes.buffer) };
}

function loadSurrogate(plain) {
  const model = { ...plain, cores: plain.cores.map(readArray) };
  for (const name of ["offset", "scale", "amplitude", "variance"]) model[name] = readArray(plain[name]);
  if (plain.calibration) {
    model.calibration = {};
    for (const name of Object.keys(plain.calibration)) model.calibration[name] = readArray(plain.calibration[name]);
  }
  return model;
}

function toUnit(input, value) {
  if (input.scale === "log") return (2 * Math.log(value / input.low)) / Math.log(input.high / input.low) - 1;
  return (2 * (value - input.low)) / (input.high - input.low) - 1;
}

function fromUnit(input, t) {
  if (t <= -1) return input.low;
  if (t >= 1) return input.high;
  const share = (t + 1) / 2;
  if (input.scale === "log") return input.low * Math.exp(share * Math.log(input.high / input.low));
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

// Means and standard deviations of all outputs at scaled coordinates t, one an input.
function predict(model, t) {
  const modes = new Array(t.length);
  model.order.forEach((k, position) => { modes[k] = model.cores[position].shape[1]; });
  const parts = model.factors.map((factor, k) => features(factor, t[k], modes[k]));
  let state = new Float64Array([1]);
  model.order.forEach((k, position) => { state = contract(state, model.cores[position], parts[k].mean); });
  const count = model.outputs.length, mean = new Float64Array(count), std = new Float64Array(count);
  for (let p = 0; p < count; p++) {
    mean[p] = state[p] * model.scale.data[p] + model.offset.data[p];
    let unknown = 0, known = 1;
    parts.forEach((part, f) => {
      const amplitude = model.amplitude.data[f * count + p];
      const weight = model.calibration ? model.calibration.weights.data[f * count + p] : 1;
      const k = amplitude * part.prior + 1, r = amplitude * part.residual;
      unknown = unknown * k + known * r * weight;
      known *= k - r;
    });
    std[p] = calibrated(model, t, p, unknown * model.variance.data[p]);
  }
  return { mean, std };
}

function calibrated(model, t, p, variance) {
  const c = model.calibration, count = model.outputs.length;
  if (!c) return Math.sqrt(variance);
  const degree = (c.trend.shape[0] - 1) / t.length, slabs = c.guard.shape[1];
  let scale = c.trend.data[p], guard = -Infinity;
  t.forEach((one, k) => {
    const inside = Math.min(Math.max(one, -1), 1), T = chebyshev(inside, degree + 1);
    for (let m = 1; m <= degree; m++) scale += T[m] * c.trend.data[(k * degree + m) * count + p];
    const slab = Math.min(Math.max(Math.trunc(((inside + 1) / 2) * slabs), 0), slabs - 1);
    guard = Math.max(guard, c.guard.data[(k * slabs + slab) * count + p]);
  });
  return Math.sqrt(variance + c.floor.data[p]) * Math.exp(scale + guard);
}
