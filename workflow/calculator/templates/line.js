// Contacts along a line on a half-plane in closed form, as solver/halfplane has them: one power of x as slope, or a flat.
"use strict";

// (digamma(3/2 + delta) - digamma(3/2)) / delta by its series, whose coefficients the page bears.
const digammaDifference = (delta, series) => series.reduceRight((sum, one) => sum * delta + one, 0);

// Coefficients of (1 - t)^-A (1 + t)^-B in powers of t.
function edgeSeries(delta, [m, n], count) {
  const power = m + n - 1, skew = n - m - 2 * delta, series = [1, -skew];
  for (let k = 1; k < count - 1; k++) series.push((-skew * series[k] + (k - 1 + power) * series[k - 1]) / (k + 1));
  return series;
}

// Coefficients of [((1 - t)/(1 + t))^delta - 1] / delta.
function phiSeries(delta, count) {
  const series = [0, -2];
  for (let k = 1; k < count - 1; k++) series.push((-2 * delta * series[k] + (k - 1) * series[k - 1]) / (k + 1));
  return series;
}

// Powers of x to Chebyshev polynomials, by Horner's rule: x T_k = (T_(k+1) + T_|k-1|) / 2.
function chebyshev(power) {
  let found = new Array(power.length).fill(0);
  for (let k = power.length - 1; k >= 0; k--) {
    const next = new Array(power.length).fill(0);
    found.forEach((one, j) => {
      if (!one) return;
      if (j === 0) next[1] += one;
      else { next[j + 1] += one / 2; next[j - 1] += one / 2; }
    });
    next[0] += power[k];
    found = next;
  }
  return found;
}

// S and its moments (solver/halfplane/shape.py) of the factor Q, a polynomial; `angle` is that of friction.
function shape(angle, smooth, factor, series) {
  const [m, n] = smooth, { delta } = angle, sign = m ? -1 : 1;
  let power = factor;
  [-1, 1].forEach((corner, k) => {
    if (smooth[k]) power = [...power, 0].map((one, j) => corner * one + (j ? power[j - 1] : 0));
  });
  const c = chebyshev(power), degree = c.length - 1, phi = phiSeries(2 * delta, degree + 34).map((one) => 2 * one);
  const laurent = (k) => {
    let sum = 0;
    for (let j = -degree; j <= degree; j++) if (k > j) sum += (j ? 0.5 : 1) * c[Math.abs(j)] * phi[k - j];
    return sum;
  };
  const head = Array.from({ length: Math.max(degree, 1) }, (_, k) => laurent(-k));
  const total = sign * Math.PI * (c[0] + delta * head[0]);
  const moment = () => { // of S times log(1 - X) + log 2
    const both = m + n - 1, skew = n - m - 2 * delta;
    const start = Math.PI * Math.min(both + 2, 2) * (m ? 0.5 + delta : 1) * (n ? 0.5 - delta : 1);
    const mean = delta * digammaDifference(delta, series) + 2 - [0, 1, 1.5][both + 1] - (m ? 0 : 1 / (0.5 + delta));
    const plain = [start], logs = [start * mean];
    for (let j = 0; j < factor.length - 1; j++) {
      const before = j ? plain[j - 1] : 0, logBefore = j ? logs[j - 1] : 0;
      plain.push((skew * plain[j] + j * before) / (both + j + 2));
      logs.push((skew * logs[j] - plain[j] - plain[j + 1] + j * logBefore) / (both + j + 2));
    }
    return dot(factor, logs);
  };
  const follower = () => { // of D times log(1 - X)
    const one = phiSeries(delta, power.length), values = [-digammaDifference(delta, series) - 4 / (1 + 2 * delta)];
    for (let j = 0; j < power.length - 1; j++) values.push((one[j + 1] - 2 * delta * values[j] + (j ? j * values[j - 1] : 0)) / (j + 1));
    return -Math.PI * sign * angle.deltaOverTan * dot(power, values);
  };
  const followerAt = (edge) => { // D sqrt(1 - X^2)
    const part = head.reduce((sum, one, k) => sum + (k ? 2 : 1) * one * (edge < 0 && k % 2 ? -1 : 1), 0);
    return -sign * angle.deltaOverTan * part;
  };
  return { factor, total, logarithmicMoment: moment(), followerMoment: follower(), followerAt };
}

function shapeOfSlope(angle, smooth, slope, series) {
  const power = smooth[0] + smooth[1] - 1, edges = edgeSeries(angle.delta, smooth, slope.length + 1);
  const terms = [];
  for (let j = 0; j < Math.max(slope.length - power, 1); j++) {
    const shift = j + power;
    terms.push((smooth[0] ? -1 : 1) * slope.reduce((sum, one, k) => (k >= shift ? sum + one * edges[k - shift] : sum), 0));
  }
  return shape(angle, smooth, terms, series);
}

// Where the contact is and which shape its pressure has: (3.2) and (4.1).
function pressed(punch, angle, lam, load, series) {
  if (punch.profile === "flat") {
    const smooth = [0, 0], half = punch.width / 2, carried = -1 / shape(angle, smooth, [1], series).total;
    const alone = shape(angle, smooth, [carried], series);
    return { smooth, half, centre: 0, scale: (lam * load) / half, slope: [0], shape: alone, rateShape: alone, rate: 0 };
  }
  const wedge = punch.profile === "wedge", n = wedge ? 0 : 1, gamma = wedge ? punch.slope : 1 / punch.radius;
  const smooth = wedge ? [1, 0] : [1, 1], centre = wedge ? 1 : -2 * angle.delta;
  const slope = wedge ? [1] : [centre, 1], alone = shapeOfSlope(angle, smooth, slope, series);
  const half = ((lam * load) / (gamma * -alone.total)) ** (1 / (n + 1)), rate = 1 / (n + 1);
  const rateShape = shape(angle, smooth, alone.factor.map((one) => one * n * rate), series);
  return { smooth, half, centre, scale: gamma * half ** n, slope, shape: alone, rateShape, rate };
}

// Fields that the punch conducts follow the pressure: M^-1 of the right side over them alone.
function following(compliance, conducts, right) {
  const scale = [1, 2].map((q) => 1 / Math.sqrt(Math.abs(compliance[q][q])));
  const M = [0, 1].map((i) => [0, 1].map((j) => (conducts[i] && conducts[j] ? compliance[i + 1][j + 1] * scale[i] * scale[j] : +(i === j))));
  return solved(M, right.map((one, i) => [conducts[i] ? one * scale[i] : 0])).map(([one], i) => one * scale[i]);
}

/* Quantities of solver/halfplane/quantities.py by their names, SI, and the pressure over X in `pressure`.

   `given`: material, punch (profile, radius, width or slope, modulus, poisson), load, friction, datum, conducts
   (electric, magnetic), charges (T, J), or `voltage`, for which the charge is found. */
function solveLine(given, series) {
  const { material, punch, load, friction, datum, conducts } = given, body = surface(material), own = elasticity(punch);
  const N = body.compliance.map((row, i) => row.map((one, j) => one + (i + j ? 0 : own.compliance)));
  const k = body.coupling.map((one, i) => one - (i ? 0 : own.coupling));
  const screening = following(body.compliance, conducts, [1, 2].map((q) => body.compliance[q][0]));
  const frictionScreening = following(body.compliance, conducts, [1, 2].map((q) => body.coupling[q]));
  const left = (mine, follower) => [0, 1, 2].map((J) => (J && conducts[J - 1] ? 0 : mine[J] - dot(body.compliance[J].slice(1), follower)));
  const normal = left(N.map((row) => row[0]), screening), sheared = left(k, frictionScreening);
  const lam = normal[0], tan = (friction * sheared[0]) / lam, cos = 1 / Math.hypot(1, tan), delta = Math.atan(tan) / Math.PI;
  const angle = { tan, cos, delta, deltaOverTan: delta ? delta / tan : 1 / Math.PI };
  const at = pressed(punch, angle, lam, load, series), scale = at.scale / lam, { half, centre } = at;

  const logWidth = Math.log(half / (2 * datum)), punchDatum = punch.radius || punch.width || datum;
  const bracket = (one) => [0, 1, 2].map((J) => (normal[J] * one.logarithmicMoment + (k[J] - sheared[J]) * friction * one.followerMoment) / (Math.PI * at.shape.total));
  const shear = k.map((one) => (friction * one) / 2), still = bracket(at.shape), moved = bracket(at.rateShape);
  const datumPart = own.compliance ? (own.compliance / Math.PI) * Math.log(datum / punchDatum) : 0;
  const loadPart = (J) => (N[J][0] / Math.PI) * logWidth + still[J] - shear[J] + (J ? 0 : datumPart);
  const charges = [...(given.charges || [0, 0])];
  const displacement = (J) => loadPart(J) * load + (dot(N[J].slice(1), charges) / Math.PI) * logWidth;
  const capacitance = Math.PI / (N[1][1] * logWidth);
  if (given.voltage !== undefined) charges[0] += (given.voltage - displacement(1)) * capacitance;
  const loadTangent = (J, charged) => N[J][0] * (logWidth / Math.PI + at.rate / Math.PI) + at.rate * still[J] + moved[J] - shear[J]
    + (J ? 0 : datumPart) + (charged ? (dot(N[J].slice(1), charges) * (at.rate / Math.PI)) / load : 0);
  const rise = half * at.scale * at.slope.reduce((sum, one, p) => sum + (one * (1 - (-centre) ** (p + 1))) / (p + 1), 0);
  const riseRate = half * at.scale * at.slope.reduce((sum, one) => sum + one, 0) * at.rate * (centre + 1);
  const depthTangent = riseRate / load - loadTangent(0, true);
  const value = (polynomial, x) => polynomial.reduceRight((sum, one) => sum * x + one, 0);
  const [A, B] = [at.smooth[0] - 0.5 + delta, at.smooth[1] - 0.5 - delta];
  const pressure = (X) => -scale * cos * (1 - X) ** A * (1 + X) ** B * value(at.shape.factor, X);
  const edgeStress = (X) => body.inPlane * body.tangential * friction * scale * value(at.slope, X);
  const density = charges.map((one, q) => -(one + screening[q] * load) / (Math.PI * half));
  const intensity = (X, q) => Math.sqrt(Math.PI * half) * (friction * at.shape.followerAt(X) * scale * frictionScreening[q] + density[q]);

  const out = {
    contact_trailing: half * (1 + centre), contact_leading: half * (1 - centre), pressure_exponent: 0.5 + delta,
    depth: rise - displacement(0),
  };
  if (at.smooth[0] && at.smooth[1]) out.peak_pressure = pressure(-2 * delta);
  if (at.smooth[0]) out.trailing_tension = edgeStress(1);
  if (at.smooth[1]) out.leading_compression = edgeStress(-1);
  for (const [edge, X, smooth] of [["trailing", 1, at.smooth[0]], ["leading", -1, at.smooth[1]]])
    if (smooth) ["electric", "magnetic"].forEach((field, q) => { out[`${field}_edge_intensity_${edge}`] = intensity(X, q); });
  [["voltage", "voltage_per_load", "charge_per_force", "stroke_per_volt", "blocked_load_per_volt"],
    ["magnetic_potential", "magnetic_potential_per_load", "flux_per_force", "stroke_per_ampere", "blocked_load_per_ampere"]].forEach((names, q) => {
    if (!conducts[q]) return;
    const J = q + 1, cross = N[0][J], mine = N[J][J];
    [displacement(J), loadTangent(J, false), (-Math.PI * loadPart(J)) / (mine * logWidth), -cross / mine,
      cross / (loadTangent(J, true) * cross + mine * depthTangent)].forEach((one, k) => { out[names[k]] = one; });
  });
  return { ...out, charge: charges[0], capacitance: conducts[0] ? capacitance : undefined, half, centre: half * centre, pressure, kind: "line" };
}
