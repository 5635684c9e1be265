// Largest values of learnt curves: the arithmetic of surrogate/curves/curvegp.py, landscape.py, climb.py, measure.py and panels.py.
"use strict";

const STEPS = 10, CLOSE = 3e-4, CLIMBED = 4, RIVAL = 0.1;

function loadCurves(plain) {
  return { ...plain, nets: plain.nets.map(loadNet) };
}

// Mean and vectors of fields: each row in steps of its own, or as it is, over the fields' scales (surrogate/use/export.py).
function readFields({ shape, scales, rows }) {
  const data = new Float32Array(shape[0] * shape[1] * shape[2]);
  rows.forEach(({ step, values }, r) => readArray(values).data.forEach((one, k) => {
    data[r * shape[1] * shape[2] + k] = one * step * scales[k % shape[2]];
  }));
  return { shape, data };
}

// A net of panels: mean and vectors of its fields, the points that are scanned, and pairs of neighbours among these.
function loadNet(plain) {
  const net = { ...plain, whole: readFields(plain.whole), panels: [], scan: [], pairs: [], counts: [Math.max(...plain.across), Math.max(...plain.down)] };
  const all = (count) => Array.from({ length: count }, (_, k) => k);
  const some = (count) => all(count).filter((k) => k % 2 === 0 || k === count - 1);
  let start = 0;
  for (const down of plain.down) {
    for (const across of plain.across) {
      const panel = net.panels.length, rows = some(down), columns = all(across), first = net.scan.length;
      rows.forEach((i) => columns.forEach((j) => net.scan.push({ panel, point: start + i * across + j, u: gauss(across, j), v: gauss(down, i) })));
      rows.forEach((_, i) => columns.forEach((__, j) => {
        const own = first + i * columns.length + j;
        if (j + 1 < columns.length) net.pairs.push([own, own + 1]);
        if (i + 1 < rows.length) net.pairs.push([own, own + columns.length]);
      }));
      net.panels.push({ start, across, down });
      start += across * down;
    }
  }
  const [rank, points, fields] = net.whole.shape;
  net.scanned = new Float64Array(rank * net.scan.length * fields);
  for (let r = 0; r < rank; r++) net.scan.forEach(({ point }, k) => {
    const from = (r * points + point) * fields;
    net.scanned.set(net.whole.data.subarray(from, from + fields), (r * net.scan.length + k) * fields);
  });
  return net;
}

// All fields at the points that are scanned, by the net's scores; 1 comes before these.
function scanned(net, scores) {
  const found = new Float64Array(net.scanned.length / scores.length);
  scores.forEach((score, r) => {
    for (let k = 0, from = r * found.length; k < found.length; k++) found[k] += score * net.scanned[from + k];
  });
  return found;
}

// A measure of the fields at points that are scanned.
function heightsOf({ linear, root }, values, points) {
  const heights = new Float64Array(points).fill(-Infinity), fields = values.length / points;
  const along = (row, at) => { let sum = 0; for (let f = 0; f < row.length; f++) sum += row[f] * values[at + f]; return sum; };
  linear.forEach((row, b) => {
    const rows = root[b].filter((one) => one.some(Boolean));
    for (let k = 0; k < points; k++) {
      let squares = 0;
      for (const one of rows) squares += along(one, k * fields) ** 2;
      heights[k] = Math.max(heights[k], along(row, k * fields) + Math.sqrt(squares));
    }
  });
  return heights;
}

// Chebyshev points on [-1, 1], rising.
const gauss = (count, k) => -Math.cos((Math.PI * (k + 0.5)) / count);

const SERIES = new Map();

// From values at the points to Chebyshev coefficients; row m for the polynomial of degree m.
function series(count) {
  if (!SERIES.has(count)) {
    const at = Array.from({ length: count }, (_, k) => chebyshev(gauss(count, k), count));
    SERIES.set(count, Array.from({ length: count }, (_, m) => at.map((T) => ((m ? 2 : 1) / count) * T[m])));
  }
  return SERIES.get(count);
}

// What takes values at the points of a coordinate to value and two derivatives at a place.
function jetRows(count, t) {
  if (count === 1) return [[1], [0], [0]];
  const T = [new Float64Array(count), new Float64Array(count), new Float64Array(count)];
  T[0][0] = 1;
  T[0][1] = t;
  T[1][1] = 1;
  for (let m = 2; m < count; m++) {
    T[0][m] = 2 * t * T[0][m - 1] - T[0][m - 2];
    T[1][m] = 2 * T[0][m - 1] + 2 * t * T[1][m - 1] - T[1][m - 2];
    T[2][m] = 4 * T[1][m - 1] + 2 * t * T[2][m - 1] - T[2][m - 2];
  }
  const to = series(count);
  return T.map((own) => {
    const row = new Float64Array(count);
    for (let m = 0; m < count; m++) for (let k = 0; k < count; k++) row[k] += own[m] * to[m][k];
    return row;
  });
}

// Fields at a point of a net, by its scores; 1 comes before these.
function fieldsAt(net, scores, point, count) {
  const [rank, points, fields] = net.whole.shape, found = new Float64Array(count);
  for (let r = 0; r < rank; r++) {
    const row = (r * points + point) * fields;
    for (let f = 0; f < count; f++) found[f] += scores[r] * net.whole.data[row + f];
  }
  return found;
}

// Value and derivatives of fields at a place of a panel: u, v, uu, vv, uv by field.
function jet(panel, values, u, v) {
  const across = jetRows(panel.across, u), down = jetRows(panel.down, v);
  const of = (p, q) => values.map((field) => {
    let sum = 0;
    for (let i = 0; i < panel.down; i++) for (let j = 0; j < panel.across; j++) sum += down[q][i] * across[p][j] * field[i * panel.across + j];
    return sum;
  });
  return { value: of(0, 0), u: of(1, 0), v: of(0, 1), uu: of(2, 0), vv: of(0, 2), uv: of(1, 1) };
}

const dot = (a, b) => a.reduce((sum, one, k) => sum + one * b[k], 0);

// The branches of a measure at fields s: linear . s + |root s|.
function branches({ linear, root }, s) {
  return linear.map((row, k) => {
    const inner = root[k].map((one) => dot(one, s)), norm = Math.sqrt(dot(inner, inner));
    return { value: dot(row, s) + norm, row, root: root[k], inner, norm };
  });
}

// A measure with its slope by the fields along the largest branch, and its bend along two directions of the fields.
function bent(measure, s) {
  const { value, row, root, inner, norm } = branches(measure, s).reduce((best, one) => (one.value > best.value ? one : best));
  const size = Math.max(norm, 2.2250738585072014e-308);
  const along = s.map((_, f) => root.reduce((sum, one, k) => sum + inner[k] * one[f], 0) / size);
  const bend = (a, b) => {
    if (!(size > 2.2250738585072014e-308)) return 0;
    return (root.reduce((sum, one) => sum + dot(one, a) * dot(one, b), 0) - dot(along, a) * dot(along, b)) / size;
  };
  return { value, slope: row.map((one, f) => one + along[f]), bend };
}

// About the distance of Chebyshev points near a place.
function spacing(place, count) {
  const angle = Math.PI / count;
  return angle * Math.sqrt(Math.max(1 - place * place, 0)) + (angle * angle) / 2;
}

const held = (place, slope, count) => (Math.abs(place) >= 1 && place * slope > 0) || count === 1;
const clipped = (one, most) => Math.min(Math.max(one, -most), most);

// Newton's step uphill, no longer than points lie apart; along an end of the panel that holds it.
function stepped([gu, gv], [uu, vv, uv], u, v, counts) {
  const fixed = [held(u, gu, counts[0]), held(v, gv, counts[1])], room = [spacing(u, counts[0]), spacing(v, counts[1])];
  const gradient = [fixed[0] ? 0 : gu, fixed[1] ? 0 : gv], determinant = uu * vv - uv * uv;
  let step = gradient.map((one, k) => one / Math.max(Math.abs(k ? vv : uu), Math.abs(one) / room[k] + 1e-300));
  if (uu < 0 && determinant > 0 && !fixed[0] && !fixed[1]) {
    step = [(uv * gradient[1] - vv * gradient[0]) / determinant, (uv * gradient[0] - uu * gradient[1]) / determinant];
  }
  return step.map((one, k) => clipped(one, room[k]));
}

// The highest point met from a starting point by Newton's iteration.
function climbed(net, measure, values, start) {
  const panel = net.panels[start.panel], best = { panel: start.panel, u: start.u, v: start.v, value: -Infinity };
  let { u, v } = start;
  for (let n = 0; n < STEPS; n++) {
    const at = jet(panel, values, u, v), { value, slope, bend } = bent(measure, at.value);
    const gradient = [dot(slope, at.u), dot(slope, at.v)];
    const bends = [dot(slope, at.uu) + bend(at.u, at.u), dot(slope, at.vv) + bend(at.v, at.v), dot(slope, at.uv) + bend(at.u, at.v)];
    const step = stepped(gradient, bends, u, v, net.counts), close = Math.max(...step.map(Math.abs)) < CLOSE;
    const ahead = [clipped(u + step[0], 1), clipped(v + step[1], 1)];
    // what the last step brings is its gain on a parabola, to the third order of it
    const gain = close ? Math.max(gradient[0] * (ahead[0] - u) + gradient[1] * (ahead[1] - v), 0) / 2 : 0;
    if (value + gain > best.value) Object.assign(best, { u: close ? ahead[0] : u, v: close ? ahead[1] : v, value: value + gain });
    if (close) break;
    [u, v] = ahead;
  }
  return best;
}

// Values of the first fields at the points of a panel.
function onPanel(net, scores, number, count) {
  const { start, across, down } = net.panels[number];
  const points = Array.from({ length: across * down }, (_, k) => fieldsAt(net, scores, start + k, count));
  return Array.from({ length: count }, (_, f) => points.map((one) => one[f]));
}

// Where a measure of curves is largest: the highest hills of the scan, whose fields are given, are climbed.
function summit(net, scores, measure, fields) {
  const count = measure.linear[0].length, heights = heightsOf(measure, fields, net.scan.length), hills = heights.slice();
  net.pairs.forEach(([a, b]) => {
    if (heights[a] < heights[b]) hills[a] = -Infinity;
    if (heights[b] < heights[a]) hills[b] = -Infinity;
  });
  let best = null, floor = -Infinity;
  for (let n = 0; n < CLIMBED; n++) {
    const top = hills.reduce((high, one, k) => (one > hills[high] ? k : high), 0);
    if (n && !(hills[top] > floor)) break;
    if (!n) floor = hills[top] - RIVAL * Math.abs(hills[top]);
    const start = net.scan[top], found = climbed(net, measure, onPanel(net, scores, start.panel, count), start);
    if (!best || found.value > best.value) best = found;
    hills[top] = -Infinity;
  }
  return best;
}

// Means of all outputs from those of the smooth ones, and how large their deviations are over those of their witnesses.
function followed(curves, smooth) {
  const count = curves.witness.length, mean = new Float64Array(count), spread = Float64Array.from(curves.spread);
  const found = new Map(); // outputs that share a measure share the search
  const scores = curves.nets.map((net) => [1, ...net.scores.map((row) => smooth[row])]);
  const fields = curves.nets.map((net, k) => scanned(net, scores[k]));
  curves.plain.forEach(([p, row]) => { mean[p] = smooth[row]; });
  curves.largest.forEach(({ output, net: number, measure, place, size: row }) => {
    const net = curves.nets[number], own = scores[number], key = `${number} ${measure}`;
    if (!found.has(key)) found.set(key, summit(net, own, curves.measures[measure], fields[number]));
    const top = found.get(key), size = row < 0 ? 1 : curves.logarithms ? Math.exp(smooth[row]) : smooth[row];
    const read = () => jet(net.panels[top.panel], onPanel(net, own, top.panel, place + 1), top.u, top.v).value[place];
    mean[output] = size * (place < 0 ? top.value : read());
    spread[output] *= size;
  });
  return { mean, spread };
}
