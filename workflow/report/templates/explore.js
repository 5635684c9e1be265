// The map beside the sliders: the goal of the chosen target over two factors, with its limits and its design; a click moves there.
"use strict";

const NODES = 29, FINER = 5, PAUSE = 150, SLICE = 12; // nodes a side, and parts of an interval of theirs that are shaded; milliseconds
const COARSE = 4; // every so many nodes a side are the first picture
const PLOT = { left: 64, right: 470, top: 12, bottom: 318, bar: 486, wide: 14, near: 12 };
const LETTER = 7.9, LINE = 17, LONG = 26; // width of a letter of a limit's name, about, height of its line, and letters of one line
// viridis (S. van der Walt and N. Smith, 2015; CC0), which readers of every kind of sight can order
const VIRIDIS = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [109, 205, 89], [180, 222, 44], [253, 231, 37]];

function viridis(share) {
  const place = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1), k = Math.min(Math.floor(place), VIRIDIS.length - 2);
  return VIRIDIS[k].map((one, c) => Math.round(one + (place - k) * (VIRIDIS[k + 1][c] - one)));
}

// Columns and rows of nodes by their number, the node of the coarse ones that is next to one, and their order: coarse ones first.
const placed = (n) => [n % NODES, Math.floor(n / NODES)], coarsest = (n) => placed(n).reduce((sum, one, k) => sum + COARSE * Math.round(one / COARSE) * NODES ** k, 0);
const ALL = Array.from({ length: NODES * NODES }, (_, n) => n), ORDER = [...ALL.filter((n) => coarsest(n) === n), ...ALL.filter((n) => coarsest(n) !== n)];
const FIRST = ((NODES - 1) / COARSE + 1) ** 2;

// The scaled coordinate of a node, both ends of the range among them, and the place of a coordinate in the picture.
const node = (k) => -1 + (2 * k) / (NODES - 1);
const acrossAt = (t) => PLOT.left + ((t + 1) / 2) * (PLOT.right - PLOT.left);
const upAt = (t) => PLOT.bottom - ((t + 1) / 2) * (PLOT.bottom - PLOT.top);

// Between nodes: values (NODES x NODES, rows upwards) at fractions of them.
function between(values, x, y) {
  const i = Math.min(Math.floor(x), NODES - 2), j = Math.min(Math.floor(y), NODES - 2), at = (k, l) => values[(j + l) * NODES + i + k];
  return (1 - y + j) * ((1 - x + i) * at(0, 0) + (x - i) * at(1, 0)) + (y - j) * ((1 - x + i) * at(0, 1) + (x - i) * at(1, 1));
}

// Where values over the nodes change their sign, as segments [[x, y], [x, y]] of scaled coordinates: marching squares.
function zeroLine(values) {
  const found = [];
  for (let j = 0; j < NODES - 1; j++) {
    for (let i = 0; i < NODES - 1; i++) {
      const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]], of = ([k, l]) => values[l * NODES + k];
      const crossed = corners.flatMap((one, k) => {
        const other = corners[(k + 1) % 4], [a, b] = [of(one), of(other)];
        if (a > 0 === b > 0 || !Number.isFinite(a - b)) return [];
        return [[0, 1].map((n) => node(one[n] + (a / (a - b)) * (other[n] - one[n])))];
      });
      for (let k = 0; k + 1 < crossed.length; k += 2) found.push([crossed[k], crossed[k + 1]]);
    }
  }
  return found;
}

// Round values of a factor between its ends, as many as have room.
function roundValues({ low, high, scale }) {
  if (scale !== "log") return ticks(low, high, 5);
  const decades = Math.log10(high / low), steps = decades < 1.4 ? [1, 2, 5] : decades < 2.6 ? [1, 3] : [1], first = Math.floor(Math.log10(low));
  const all = Array.from({ length: Math.ceil(decades) + 2 }, (_, k) => steps.map((one) => one * 10 ** (first + k))).flat();
  return all.filter((one) => one >= low * (1 - 1e-9) && one <= high * (1 + 1e-9));
}

// Where a name of some size stands beside its line, given as segments [[x, y], [x, y]]: over nothing of `taken`, crossed by
// as little as can be of all lines, and next to the middle.
function namePlace(segments, wide, high, all, taken) {
  const points = all.flatMap(([a, b]) => [a, b, [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2]]), within = (value, low, most) => Math.max(Math.min(value, most), low);
  const sides = [-wide / 2, 8, -wide - 8].flatMap((aside) => [6, -high - 6, -high / 2].map((down) => [aside, down]));
  const places = segments.flatMap(([[x, y]]) => sides.map(([aside, down]) => {
    const left = within(x + aside, PLOT.left + 6, PLOT.right - wide - 6), top = within(y + down, PLOT.top + 2, PLOT.bottom - high - 2), right = left + wide, bottom = top + high;
    const covered = taken.filter((one) => left < one.right && right > one.left && top < one.bottom && bottom > one.top).length;
    const crossed = points.filter(([px, py]) => px > left - 4 && px < right + 4 && py > top - 2 && py < bottom + 2).length;
    return { left, right, top, bottom, cost: 1000 * covered + crossed, off: Math.hypot(2 * x - PLOT.left - PLOT.right, 2 * y - PLOT.top - PLOT.bottom) };
  }));
  return places.reduce((best, one) => (one.cost < best.cost || (one.cost === best.cost && one.off < best.off) ? one : best));
}

// A name in one line, or in two that part where they are most alike.
function inLines(words) {
  if (words.length <= LONG) return [words];
  const blanks = [...words].flatMap((letter, k) => (letter === " " ? [k] : [])), middle = words.length / 2;
  if (!blanks.length) return [words];
  const at = blanks.reduce((best, k) => (Math.abs(k - middle) < Math.abs(best - middle) ? k : best));
  return [words.slice(0, at), words.slice(at + 1)];
}

function startMap(panel, root) {
  const svg = root.querySelector("svg"), layer = (name) => svg.querySelector(`[data-layer=${name}]`);
  const choosers = [...root.querySelectorAll("select")], inputs = panel.model.inputs;
  let nodes = [], drawn = "", finished = "", timer = 0, running = 0;

  const axes = () => choosers.map((one) => Number(one.value));
  const titled = (k) => panel.data.titles[inputs[k].name];

  // What the map shows does not change with the two sliders that it is over.
  function key() {
    const rest = panel.point.map((one, k) => (axes().includes(k) ? "" : one));
    return JSON.stringify([panel.chosen, panel.data.kinds.indexOf(panel.kind), axes(), rest]);
  }

  function at(s, t) {
    const point = [...panel.point], [x, y] = axes();
    [point[x], point[y]] = [s, t];
    return point;
  }

  // Where the chosen design lies, if it is of what the map shows: the other sliders where they matter stand at it.
  function starred() {
    const target = panel.data.cases[panel.chosen];
    if (!target || panel.data.kinds[target.kind] !== panel.kind) return null;
    const t = inputs.map((input) => toUnit(input, target.values[input.name]));
    const same = (k) => axes().includes(k) || inputs[k].name in target.scenarios || Math.abs(t[k] - panel.point[k]) < 1e-9;
    return inputs.every((_, k) => same(k)) ? axes().map((k) => t[k]) : null;
  }

  // Coarsely at first, at once where a page is printed.
  function compute(slice = SLICE) {
    const run = ++running, wanted = key(), found = [];
    let rough = false, n = 0;
    const shown = (all) => { [nodes, drawn] = [all, wanted]; paint(); };
    const step = () => {
      const end = performance.now() + slice;
      while (n < ORDER.length && performance.now() < end) found[ORDER[n]] = panel.judged(at(...placed(ORDER[n++]).map(node)), true);
      if (run !== running) return;
      if (n === ORDER.length) { finished = wanted; return shown(found); }
      if (!rough && n >= FIRST) { rough = true; shown(ALL.map((k) => found[coarsest(k)])); }
      setTimeout(step);
    };
    step();
  }

  addEventListener("beforeprint", () => { if (finished !== key()) { clearTimeout(timer); compute(Infinity); } });

  function paint() {
    const goals = nodes.map(({ goal }) => goal), star = starred(), best = star ? [panel.goal.exact ?? panel.judged(at(...star)).goal] : [];
    const known = [...goals, ...best].filter(Number.isFinite), low = Math.min(...known), high = Math.max(...known);
    const lines = (nodes[0]?.limits ?? []).map((_, n) => nodes.map(({ limits }) => limits[n]));
    layer("shade").setAttribute("href", shaded(goals, lines, low, high));
    const taken = star ? [{ left: acrossAt(star[0]) - LINE, right: acrossAt(star[0]) + LINE, top: upAt(star[1]) - LINE, bottom: upAt(star[1]) + LINE }] : [];
    const limits = panel.data.cases[panel.chosen].limits.filter(({ judged }) => judged), drawnLines = lines.map((values) => zeroLine(values).map((ends) => ends.map(([s, t]) => [acrossAt(s), upAt(t)])));
    layer("limits").innerHTML = drawnLines.map((segments, n) => limitLine(segments, limits[n].words, drawnLines.flat(), taken)).join("");
    layer("axes").innerHTML = axis(0) + axis(1) + colourBar(low, high);
    const { title } = panel.goal, [x, y] = axes().map(titled);
    Object.assign(svg.dataset, { low: String(low), high: String(high), broken: String(nodes.filter(({ broken }) => broken).length) });
    svg.setAttribute("aria-label", `map of ${title} over ${x} and ${y}; the sliders do the same as a click on it`);
    show();
  }

  // The shading as a picture; what breaks a limit is faint.
  function shaded(goals, lines, low, high) {
    const side = (NODES - 1) * FINER, canvas = Object.assign(document.createElement("canvas"), { width: side, height: side });
    const context = canvas.getContext("2d"), image = context.createImageData(side, side);
    for (let j = 0; j < side; j++) {
      for (let i = 0; i < side; i++) {
        const [x, y] = [(i + 0.5) / FINER, (j + 0.5) / FINER], goal = between(goals, x, y), broken = lines.some((one) => between(one, x, y) > 0);
        const colour = Number.isFinite(goal) ? viridis(high > low ? (goal - low) / (high - low) : 0.5) : [128, 128, 128];
        image.data.set([...colour, broken ? 90 : 255], 4 * ((side - 1 - j) * side + i));
      }
    }
    context.putImageData(image, 0, 0);
    return canvas.toDataURL();
  }

  // A limit's line with its name beside it.
  function limitLine(segments, words, all, taken) {
    if (!segments.length) return "";
    const path = segments.map((ends) => `M${ends.map((end) => end.map((one) => one.toFixed(1)).join(" ")).join("L")}`).join("");
    const parts = inLines(words), place = namePlace(segments, LETTER * Math.max(...parts.map(({ length }) => length)), LINE * parts.length, all, taken), x = place.left.toFixed(1);
    taken.push(place);
    const lines = parts.map((part, k) => `<tspan x="${x}" y="${(place.top + 14 + k * LINE).toFixed(1)}">${escaped(part)}${k + 1 < parts.length ? " " : ""}</tspan>`);
    return `<path class="limit" d="${path}"/><text class="halo">${lines.join("")}</text>`;
  }

  function axis(n) {
    const k = axes()[n], input = inputs[k], shown = engineering(Math.max(Math.abs(input.low), Math.abs(input.high)), input.units, 3);
    const label = `${titled(k)}${shown.units ? ` [${shown.units}]` : ""}`, middle = (PLOT.top + PLOT.bottom) / 2;
    const marks = roundValues(input).map((value) => {
      const t = toUnit(input, value), text = digits(value / shown.size, 3);
      return n ? `<text x="${PLOT.left - 6}" y="${(upAt(t) + 4).toFixed(1)}" text-anchor="end">${text}</text><path d="M${PLOT.left - 4} ${upAt(t).toFixed(1)}h4"/>`
        : `<text x="${acrossAt(t).toFixed(1)}" y="${PLOT.bottom + 18}" text-anchor="middle">${text}</text><path d="M${acrossAt(t).toFixed(1)} ${PLOT.bottom}v4"/>`;
    });
    const named = n ? `<text transform="translate(14 ${middle}) rotate(-90)" text-anchor="middle">${escaped(label)}</text>`
      : `<text x="${(PLOT.left + PLOT.right) / 2}" y="${PLOT.bottom + 36}" text-anchor="middle">${escaped(label)}</text>`;
    return marks.join("") + named;
  }

  function colourBar(low, high) {
    const { units } = panel.goal, { bar, wide, top, bottom } = PLOT, shown = engineering(Math.max(Math.abs(low), Math.abs(high)), units, 3);
    const steps = Array.from({ length: 32 }, (_, k) => `<rect x="${bar}" y="${(bottom - ((k + 1) * (bottom - top)) / 32).toFixed(1)}" width="${wide}" height="${((bottom - top) / 32 + 0.6).toFixed(1)}" style="fill: rgb(${viridis((k + 0.5) / 32).join(",")})"/>`);
    const marks = (high > low ? ticks(low / shown.size, high / shown.size, 5) : []).map((one) => {
      const y = bottom - ((one * shown.size - low) / (high - low)) * (bottom - top);
      return `<text x="${bar + wide + 4}" y="${(y + 4).toFixed(1)}">${digits(one, 3)}</text>`;
    });
    return `${steps.join("")}${marks.join("")}<text transform="translate(${bar + wide + 52} ${(top + bottom) / 2}) rotate(-90)" text-anchor="middle">${escaped(`${panel.goal.short}${shown.units ? ` [${shown.units}]` : ""}`)}</text>`;
  }

  function show() {
    const [x, y] = axes().map((k) => panel.point[k]), star = starred();
    const mark = star ? `<path class="star" data-star d="${starAt(acrossAt(star[0]), upAt(star[1]))}"/>` : "";
    layer("here").innerHTML = `${mark}<circle class="here" cx="${acrossAt(x).toFixed(1)}" cy="${upAt(y).toFixed(1)}" r="7"/>`;
    if (key() === drawn) return;
    running++;
    clearTimeout(timer);
    timer = setTimeout(compute, PAUSE);
  }

  // Scaled coordinates below a pointer, those of the design where it is meant; null beside the map.
  function pointed(event) {
    const frame = svg.getBoundingClientRect(), [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
    const X = ((event.clientX - frame.left) / frame.width) * width, Y = ((event.clientY - frame.top) / frame.height) * height;
    const t = [(2 * (X - PLOT.left)) / (PLOT.right - PLOT.left) - 1, (2 * (PLOT.bottom - Y)) / (PLOT.bottom - PLOT.top) - 1];
    if (t.some((one) => Math.abs(one) > 1)) return null;
    const star = starred();
    return star && Math.hypot(X - acrossAt(star[0]), Y - upAt(star[1])) < PLOT.near ? { t: star, star } : { t };
  }

  function tell(event) {
    const found = pointed(event);
    if (!found || !nodes.length) return hideTip();
    const { title, units, exact } = panel.goal, { goal, broken } = panel.judged(at(...found.t));
    const where = axes().map((k, n) => `${titled(k)}: ${said(fromUnit(inputs[k], found.t[n]), inputs[k].units, 3)}`);
    const held = found.star ? panel.data.cases[panel.chosen].limits.every((one) => one.held) : !broken;
    showTip([found.star ? "the design, exact" : "", `${title}: ${said(found.star ? exact ?? goal : goal, units, 3)}`, ...where, held ? "" : "a limit is broken"], event);
  }

  svg.addEventListener("click", (event) => {
    const found = pointed(event);
    if (found) (found.star ? panel.choose(panel.chosen) : panel.move(axes(), found.t));
  });
  svg.addEventListener("pointermove", tell);
  svg.addEventListener("pointerdown", tell);
  svg.addEventListener("pointerleave", hideTip);
  choosers.forEach((one, n) => one.addEventListener("change", () => {
    const other = choosers[1 - n];
    if (other.value === one.value) other.value = String((Number(one.value) + 1) % inputs.length);
    show();
  }));

  // The variables of the chosen target, as far as there are two.
  panel.onTarget(({ variables }) => {
    const wanted = [...variables, ...inputs.map(({ name }) => name)].filter((one, k, all) => all.indexOf(one) === k);
    choosers.forEach((one, n) => { one.value = String(inputs.findIndex(({ name }) => name === wanted[n])); });
  });
  panel.watch(show);
}

const escaped = (text) => text.replace(/[&<>]/g, (c) => `&#${c.charCodeAt(0)};`);

// Five points around a place, as a path.
function starAt(x, y, size = 10) {
  const corner = (k) => [x + (k % 2 ? 0.42 : 1) * size * Math.sin((k * Math.PI) / 5), y - (k % 2 ? 0.42 : 1) * size * Math.cos((k * Math.PI) / 5)];
  return `M${Array.from({ length: 10 }, (_, k) => corner(k).map((one) => one.toFixed(1)).join(" ")).join("L")}Z`;
}
