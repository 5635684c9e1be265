// Reads surrogate.nc by docs/format.md and evaluates it; shares no code with the program that wrote it. As a module:
//
//   import { read, predict } from "./surrogate.mjs";
//   const model = read("results/quickstart/surrogate.nc");
//   predict(model, { volume_fraction: 0.6, friction: 0.2, radius: 0.1, load: 1e4, charge: 0 }).voltage
//     -> { mean, std, lower, upper, units }
//
// and as a command: `node surrogate.mjs surrogate.nc volume_fraction=0.6 ...`. Needs Node.js, and netCDF's own ncdump.
import { execFileSync } from "node:child_process";
import { createHash } from "node:crypto";
import { readFileSync } from "node:fs";

const Z95 = 1.959963984540054, LOWER = 4, UPPER = 16; // places of the probabilities 0.025 and 0.975
const range = (count) => [...Array(count).keys()];
const clip = (x, low, high) => Math.min(Math.max(x, low), high);
const product = (powers, x) => powers.reduce((all, power, k) => (power ? all * x[k] ** power : all), 1);
const SCALES = { linear: (x) => x, log: Math.log, logit: (x) => Math.log(x / (1 - x)) };

const SEAL = 48, MAGIC = "\x89whole\r\n"; // behind the end of a file: this, its length and its SHA-256
const PROBE_TOLERANCE = 1e-7, NOTHING = 1.22e-77; // a standard deviation below is zero
const MOST_DEGREES = 4096, TEXT_A_BYTE = 40, MOST_TEXT = 2 ** 27; // of what ncdump says of a byte that is stored

// What a file holds, once its seal and its own probes have told that it is whole and understood.
export function read(path) {
  const file = parsed(path, checkSeal(path));
  for (const name of Object.keys(file).filter((one) => /(correction|calibration_trend)_degree$/.test(one))) {
    const most = (file[name]?.values ?? []).reduce((a, b) => Math.max(a, b), 0);
    if (!(most <= MOST_DEGREES)) throw new Error(`${path}: ${name}: ${most}, at most ${MOST_DEGREES}`);
  }
  checkProbes(path, file);
  return file;
}

function checkSeal(path) {
  const bytes = readFileSync(path), body = bytes.subarray(0, -SEAL), seal = bytes.subarray(-SEAL);
  const known = seal.length === SEAL && seal.toString("latin1", 0, 8) === MAGIC;
  if (!known || seal.readBigUInt64LE(8) !== BigInt(body.length)) throw new Error(`${path}: incomplete: no seal at its end`);
  if (!createHash("sha256").update(body).digest().equals(seal.subarray(16))) throw new Error(`${path}: altered`);
  return bytes.length;
}

function checkProbes(path, file) {
  const means = range(file.output.values.length).map((p) => range(file.probe_mean.sizes[0]).map((k) => file.probe_mean(k, p)));
  range(file.probe_point.sizes[0]).forEach((k) => {
    const found = predict(file, Object.fromEntries(file.input.values.map((name, j) => [name, file.probe_point(k, j)])));
    file.output.values.forEach((name, p) => {
      const room = Math.max(...means[p]) - Math.min(...means[p]);
      for (const part of ["mean", "std", "lower", "upper"]) {
        const stored = file[`probe_${part}`](k, p), off = Math.abs(found[name][part] - stored);
        if (!(off <= PROBE_TOLERANCE * (Math.abs(stored) + room) + NOTHING)) {
          throw new Error(`${path}: the stored predictions probe_${part} do not come out again`);
        }
      }
    });
  });
}

// Every variable as a function of its indices that knows its `sizes` and `values`.
function parsed(path, bytes) {
  const most = Math.min(TEXT_A_BYTE * bytes + 2 ** 16, MOST_TEXT); // small files can hold very much
  const text = execFileSync("ncdump", ["-p", "9,17", path], { encoding: "utf8", maxBuffer: most, stdio: "pipe" });
  const data = text.indexOf("\ndata:\n"), head = text.slice(0, data), file = {};
  const told = Object.fromEntries([...head.matchAll(/^\t\t:(\w+) = (.*) ;$/gm)].map((m) => [m[1], m[2]]));
  if (told.format !== '"surrogate"' || told.format_version !== "4LL") throw new Error(`${path}: not of format 4`);
  if (!['"grid"', '"grouped"'].includes(told.engine)) throw new Error(`${path}: engine ${told.engine} is not read here`);
  if (told.kernel !== '"chebyshev"') throw new Error(`${path}: kernel ${told.kernel} is not read here`);
  const length = Object.fromEntries([...head.matchAll(/^\t(\w+) = (\d+) ;/gm)].map((m) => [m[1], Number(m[2])]));
  const declared = [...head.matchAll(/^\t\w+ (\w+)(?:\((.*)\))? ;/gm)].map((m) => [m[1], m[2]?.split(", ") ?? []]);
  const sizes = Object.fromEntries(declared.map(([name, dims]) => [name, dims.map((dim) => length[dim])]));
  for (const [, name, list] of text.slice(data).matchAll(/^ (\w+) =\s([^]*?) ;$/gm)) {
    const words = [...list.matchAll(/"((?:[^"\\]|\\.)*)"|[^\s,]+/g)]; // an empty text is _
    const values = words.map((m) => m[1]?.replace(/\\(.)/g, "$1") ?? (m[0] === "_" ? "" : Number(m[0])));
    const at = (...indices) => values[indices.reduce((flat, i, k) => flat * sizes[name][k] + i, 0)];
    file[name] = Object.assign(at, { sizes: sizes[name], values });
  }
  return file;
}

function chebyshev(t, count) {
  const T = [1, t];
  while (T.length < count) T.push(2 * t * T.at(-1) - T.at(-2));
  return T;
}

// Section 2: what an axis of n levels gives to the mean, its kernel, and what the levels leave of this unknown.
function along(t, n, modes, rho) {
  const T = chebyshev(t, 2 * n);
  if (n === 2) return { mean: T.slice(0, modes), kernel: t * t, unknown: 0 };
  const share = (m) => rho ** (2 * n - 2 * m) / (1 + rho ** (2 * n - 2 * m));
  const mean = range(modes).map((m) => (m ? T[m] - 2 * share(m) * T[n] * T[n - m] : 1));
  let kernel = 0, unknown = rho ** n;
  for (let m = 1; m < 2 * n; m++) kernel += rho ** m * T[m] ** 2;
  for (let m = 1; m < n; m++) unknown += 4 * rho ** m * share(m) * T[n - m] ** 2;
  return { mean, kernel, unknown: unknown * T[n] ** 2 };
}

// Section 3: what held-out cases add to the mean of output p.
function correction(file, t, p) {
  if (!file.correction_degree) return 0;
  const degree = file.correction_degree, n = t.map((_, f) => file[`levels_${f}`].sizes[0]);
  const T = t.map((one) => chebyshev(one, 1 + Math.max(...n, ...degree.values)));
  return range(degree.sizes[0]).reduce((sum, a) => {
    const term = T.reduce((all, own, f) => all * own[degree(a, f)], 1);
    return sum + t.reduce((all, _, f) => all + T[f][n[f]] * term * file.correction_coefficient(f, a, p), 0);
  }, 0);
}

// Section 4: the largest guard of slabs, of corners of two inputs, and, of the outer one, of all corners together.
function guarded(own, corner, pooled, t, p) {
  const slabs = own.sizes[1];
  const slab = t.map((one) => clip(Math.floor(((one + 1) / 2) * slabs), 0, slabs - 1));
  const edge = slab.map((one) => (one > 0) + (one === slabs - 1));
  const pairs = t.flatMap((_, i) => t.slice(i + 1).map((_, j) => [i, i + 1 + j]));
  const guards = slab.map((one, f) => own(f, one, p));
  guards.push(...pairs.map(([i, j], k) => corner(k, edge[i], edge[j], p)));
  if (pooled && edge.filter((one) => one !== 1).length > 1) guards.push(pooled(p));
  return Math.max(...guards);
}

// Section 4: standard deviation of output p, and the ends of its interval in standard deviations.
function spread(file, t, parts, p) {
  let unknown = 0, known = 1;
  parts.forEach((part, f) => {
    const kernel = 1 + file.amplitude(f, p) * part.kernel, left = file.amplitude(f, p) * part.unknown;
    unknown = unknown * kernel + known * left * (file.calibration_weights?.(f, p) ?? 1);
    known *= kernel - left;
  });
  const raw = unknown * file.variance(p) * file.output_scale(p) ** 2;
  if (!file.calibration_trend) return { std: Math.sqrt(raw), ends: [-Z95, Z95] };
  const degree = file.calibration_trend_degree, T = t.map((one) => chebyshev(one, Math.max(...degree.values) + 1));
  const term = (j) => T.reduce((all, own, f) => all * own[degree(j, f)], file.calibration_trend(j, p));
  const sum = range(degree.sizes[0]).reduce((all, j) => all + term(j), 0);
  const trend = clip(sum, file.calibration_trend_range(0, p), file.calibration_trend_range(1, p));
  const guard = guarded(file.calibration_guard, file.calibration_corner_guard, null, t, p);
  const std = Math.sqrt(raw + file.calibration_floor(p)) * Math.exp(trend + guard);
  return { std, ends: [LOWER, UPPER].map((place) => file.calibration_quantile(place, p)) };
}

// Mean, standard deviation and 95 % interval of every output at a point of the box.
export function predict(whole, point) {
  const inputs = whole.input.values, x = inputs.map((name) => point[name]), grouped = "reduced_input" in whole;
  const own = Object.entries(whole).filter(([name]) => name.startsWith("reduced_"));
  const file = grouped ? Object.fromEntries(own.map(([name, one]) => [name.slice("reduced_".length), one])) : whole;
  const row = (name, k) => range(inputs.length).map((j) => whole[name](k, j));
  const outside = inputs.findIndex((_, k) => !(x[k] >= whole.low(k) && x[k] <= whole.high(k)));
  if (outside >= 0) throw new Error(`${inputs[outside]} is from ${whole.low(outside)} to ${whole.high(outside)}`);
  const t = file.hyperparameter.values.map((_, k) => {
    const [low, high, scale] = ["low", "high", "scale"].map((end) => file[end](k));
    const value = grouped ? clip(whole.axis_constant(k) * product(row("axis_power", k), x), low, high) : x[k];
    const on = SCALES[scale];
    return (2 * (on(value) - on(low))) / (on(high) - on(low)) - 1; // section 1
  });
  const box = x.map((value, k) => {
    const on = SCALES[whole.scale(k)], low = whole.low(k);
    return (2 * (on(value) - on(low))) / (on(whole.high(k)) - on(low)) - 1;
  });
  const parts = [];
  const state = file.contraction_order.values.reduce((before, f, position) => {
    const core = file[`core_${position}`], [, modes, after] = core.sizes;
    const { mean } = (parts[f] = along(t[f], file[`levels_${f}`].sizes[0], modes, file.hyperparameter(f)));
    const from = (i, j) => mean.reduce((sum, one, k) => sum + one * core(i, k, j), 0);
    return range(after).map((j) => before.reduce((sum, one, i) => sum + one * from(i, j), 0));
  }, [1]);
  return Object.fromEntries(file.output.values.map((name, p) => {
    let mean = file.output_offset(p) + file.output_scale(p) * state[p] + correction(file, t, p);
    let { std, ends } = spread(file, t, parts, p);
    if (std < NOTHING) std = 0;
    if (grouped) { // section 5
      const relative = x.map((one, k) => one / whole.reference(k)), sign = whole.logarithm(p);
      const scale = product(row("scale_power", p), relative);
      mean += whole.added_coefficient(p) * Math.log(product(whole.added_power.values, relative));
      mean = scale * (sign ? sign * Math.exp(sign * mean) : mean);
      std *= sign ? Math.abs(mean) : scale;
      const { calibration_outer_guard: slabs, calibration_outer_corner_guard: corners } = file;
      if (slabs) std *= Math.exp(guarded(slabs, corners, file.calibration_outer_pooled_guard, box, p));
    }
    return [name, { mean, std, lower: mean + ends[0] * std, upper: mean + ends[1] * std, units: whole.output_units(p) }];
  }));
}

if (process.argv[1]?.endsWith("surrogate.mjs")) {
  const [path, ...given] = process.argv.slice(2);
  const point = Object.fromEntries(given.map((one) => one.split("=")).map(([name, value]) => [name, Number(value)]));
  try {
    for (const [name, { mean, lower, upper, units }] of Object.entries(predict(read(path), point))) {
      console.log(`${name}: ${mean} [${lower}, ${upper}] ${units}`);
    }
  } catch (error) {
    console.error(String(error.message).split("\n")[0]);
    process.exit(2);
  }
}
