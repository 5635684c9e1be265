// A pointer over a figure: the nearest point of its curves, or the value of its map, with names and units.
"use strict";

const TIP_MARGIN = 8; // pixels between the words and the end of the page
const tip = Object.assign(document.createElement("div"), { className: "tip", hidden: true });
document.querySelector("main").append(tip);

function showTip(lines, event) {
  tip.replaceChildren(...lines.filter(Boolean).map((line) => Object.assign(document.createElement("div"), { textContent: line })));
  tip.hidden = false;
  const most = document.documentElement.clientWidth - tip.offsetWidth - TIP_MARGIN;
  tip.style.left = `${Math.max(Math.min(event.pageX + 14, most), TIP_MARGIN / 2)}px`;
  tip.style.top = `${event.pageY + 16}px`;
}

function hideTip() {
  tip.hidden = true;
}

(function () {
  const REACH = 0.12, ON_CURVE = 0.03; // shares of a panel's height within which a curve is meant, beside no map and over one

  // Where a value lies along an axis, and where a pointer lies in a panel, both from 0 to 1.
  function place(scale, value) {
    const forward = scale.log ? Math.log10 : (one) => one;
    const [low, high] = scale.limits.map(forward);
    return (forward(value) - low) / (high - low);
  }

  const within = (share) => share >= -0.01 && share <= 1.01;

  // "load [kN]" and 5 as "load: 5 kN".
  function named(label, value) {
    const [, name, unit] = /^(.*?)\s*(?:\[([^\]]*)\])?$/.exec(label);
    return `${name ? `${name}: ` : ""}${digits(value, 5)}${unit ? ` ${unit}` : ""}`;
  }

  function wordsOfPoint({ x, y, names }, curve, k) {
    const height = names.length ? names[Math.round(curve.y[k])] || "" : named(y.label, curve.y[k]);
    return [curve.label, named(x.label, curve.x[k]), height];
  }

  // The point of all curves that is nearest to a pointer, if it is within reach.
  function nearest(axes, pointer, aspect, reach) {
    let best = { distance: reach };
    for (const curve of axes.curves) {
      for (let k = 0; k < curve.x.length; k++) {
        const s = place(axes.x, curve.x[k]), t = place(axes.y, curve.y[k]);
        const distance = Math.hypot((s - pointer.s) * aspect, t - pointer.t);
        if (within(s) && within(t) && distance < best.distance) best = { distance, s, t, curve, k };
      }
    }
    return best.curve && { s: best.s, t: best.t, lines: wordsOfPoint(axes, best.curve, best.k) };
  }

  function closest(scale, values, share) {
    const distance = (k) => Math.abs(place(scale, values[k]) - share);
    return values.reduce((best, _, k) => (distance(k) < distance(best) ? k : best), 0);
  }

  function valueOfMap({ x: across, y: up, map: { x, y, values, label } }, { s, t }) {
    const i = closest(across, x, s), j = closest(up, y, t);
    const value = values[j * x.length + i]; // null where there is none, as in a rigid base
    return { s, t, lines: [value === null ? "" : named(label, value), named(across.label, x[i]), named(up.label, y[j])] };
  }

  // What is told at a pointer: a point of a curve, or the value of the map below it.
  function told(axes, pointer, aspect) {
    if (!axes.map) return nearest(axes, pointer, aspect, REACH);
    return nearest(axes, pointer, aspect, ON_CURVE) || valueOfMap(axes, pointer);
  }

  // Lets a figure answer; what it knows stands in it, or is read at the first move of a pointer over it.
  function watch(svg) {
    const mark = document.createElementNS("http://www.w3.org/2000/svg", "circle");
    mark.setAttribute("class", "mark");
    mark.setAttribute("r", "3.5");

    function leave() {
      hideTip();
      mark.remove();
    }

    function move(event) {
      svg.described = svg.described || JSON.parse(svg.querySelector("metadata.hover").textContent);
      const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
      const frame = svg.getBoundingClientRect();
      const X = (event.clientX - frame.left) / frame.width, Y = (event.clientY - frame.top) / frame.height;
      const axes = svg.described.find(({ box: [x0, y0, x1, y1] }) => X >= x0 && X <= x1 && Y >= y0 && Y <= y1);
      if (!axes) return leave();
      const [x0, y0, x1, y1] = axes.box, wide = (x1 - x0) * width, high = (y1 - y0) * height;
      const found = told(axes, { s: (X - x0) / (x1 - x0), t: (y1 - Y) / (y1 - y0) }, wide / high);
      if (!found) return leave();
      showTip(found.lines, event);
      mark.setAttribute("cx", x0 * width + found.s * wide);
      mark.setAttribute("cy", y1 * height - found.t * high);
      svg.append(mark);
    }

    svg.addEventListener("pointermove", move);
    svg.addEventListener("pointerleave", leave);
  }

  for (const svg of document.querySelectorAll("svg.figure, svg.chart")) {
    if (svg.matches(".chart") || svg.querySelector("metadata.hover")) watch(svg);
  }
})();
