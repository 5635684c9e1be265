// The map beside the sliders: the goal of the chosen target over two factors; a click moves the sliders there.
"use strict";

const CELLS = 25, PAUSE = 150, SLICE = 12; // cells a side; milliseconds without a move before it is drawn anew, and at a stretch
// viridis (S. van der Walt and N. Smith, 2015; CC0), which readers of every kind of sight can order
const VIRIDIS = [[68, 1, 84], [72, 40, 120], [62, 74, 137], [49, 104, 142], [38, 130, 142], [31, 158, 137], [53, 183, 121], [109, 205, 89], [180, 222, 44], [253, 231, 37]];

function viridis(share) {
  const place = Math.min(Math.max(share, 0), 1) * (VIRIDIS.length - 1), k = Math.min(Math.floor(place), VIRIDIS.length - 2);
  return VIRIDIS[k].map((one, c) => Math.round(one + (place - k) * (VIRIDIS[k + 1][c] - one)));
}

// The scaled coordinate of the middle of a cell.
const cell = (k) => -1 + (2 * k + 1) / CELLS;

function startMap(panel, root) {
  const canvas = root.querySelector("canvas"), here = root.querySelector(".here"), context = canvas.getContext("2d");
  const choosers = [...root.querySelectorAll("select")], inputs = panel.model.inputs;
  let cells = [], drawn = "", timer = 0, running = 0;

  const axes = () => choosers.map((one) => Number(one.value));

  // What the map shows does not change with the two sliders that it is over.
  function key() {
    const rest = panel.point.map((one, k) => (axes().includes(k) ? "" : one));
    return JSON.stringify([panel.chosen, panel.data.kinds.indexOf(panel.kind), axes(), rest]);
  }

  function place(i, j) {
    const t = [...panel.point], [x, y] = axes();
    t[x] = cell(i);
    t[y] = cell(j);
    return t;
  }

  function compute() {
    const run = ++running, wanted = key(), found = [];
    const step = () => {
      const end = performance.now() + SLICE;
      while (found.length < CELLS * CELLS && performance.now() < end) {
        found.push(panel.judged(place(found.length % CELLS, Math.floor(found.length / CELLS))));
      }
      if (run !== running) return;
      if (found.length < CELLS * CELLS) return void setTimeout(step);
      [cells, drawn] = [found, wanted];
      paint();
    };
    step();
  }

  function paint() {
    const goals = cells.map(({ goal }) => goal).filter(Number.isFinite), low = Math.min(...goals), high = Math.max(...goals);
    const image = context.createImageData(CELLS, CELLS);
    cells.forEach(({ goal, broken }, k) => {
      const i = k % CELLS, j = CELLS - 1 - Math.floor(k / CELLS), shade = broken ? 0.35 : 1; // broken ones are faint
      const colour = Number.isFinite(goal) ? viridis(high > low ? (goal - low) / (high - low) : 0.5) : [128, 128, 128];
      image.data.set([...colour, 255 * shade], 4 * (j * CELLS + i));
    });
    context.putImageData(image, 0, 0);
    const { title, units } = panel.goal, [x, y] = axes().map((k) => inputs[k]);
    const ends = ({ low: a, high: b, units: u }) => `${said(a, u, 3)} to ${said(b, u, 3)}`;
    root.querySelector(".scale").textContent = `${title}: ${said(low, units, 3)} (dark) to ${said(high, units, 3)} (bright)`;
    root.querySelector(".axes").textContent = `Across: ${spaced(x.name)} ${ends(x)}; up: ${spaced(y.name)} ${ends(y)}`;
    canvas.setAttribute("aria-label", `map of ${title} over ${spaced(x.name)} and ${spaced(y.name)}; the sliders do the same as a click on it`);
  }

  function show() {
    const [x, y] = axes(), percent = (t) => `${50 * (t + 1)}%`;
    here.style.left = percent(panel.point[x]);
    here.style.bottom = percent(panel.point[y]);
    if (key() === drawn) return;
    running++;
    clearTimeout(timer);
    timer = setTimeout(compute, PAUSE);
  }

  // Scaled coordinates below a pointer.
  function pointed(event) {
    const frame = canvas.getBoundingClientRect(), scaled = (share) => Math.min(Math.max(2 * share - 1, -1), 1);
    return [scaled((event.clientX - frame.left) / frame.width), scaled((frame.bottom - event.clientY) / frame.height)];
  }

  canvas.addEventListener("click", (event) => panel.move(axes(), pointed(event)));
  canvas.addEventListener("pointermove", (event) => {
    if (!cells.length) return;
    const t = pointed(event), [i, j] = t.map((one) => Math.min(Math.floor(((one + 1) / 2) * CELLS), CELLS - 1));
    const { goal, broken } = cells[j * CELLS + i], { title, units } = panel.goal;
    const at = axes().map((k, n) => `${spaced(inputs[k].name)}: ${said(fromUnit(inputs[k], t[n]), inputs[k].units, 4)}`);
    showTip([`${title}: ${said(goal, units, 4)}`, ...at, broken ? "a limit is broken" : ""], event);
  });
  canvas.addEventListener("pointerleave", hideTip);
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
