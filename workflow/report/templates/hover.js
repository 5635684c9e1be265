// A pointer over a figure: the nearest point of its curves, or the value of its map, with names and units.
"use strict";

(function () {
  const tip = document.createElement("div");
  tip.className = "tip";
  tip.hidden = true;
  document.body.append(tip);

  const forward = (scale, value) => (scale.log ? Math.log10(value) : value);
  const place = (scale, value) => {
    const [low, high] = scale.limits.map((end) => forward(scale, end));
    return (forward(scale, value) - low) / (high - low);
  };
  const split = (label) => {
    const match = /^(.*?)\s*\[([^\]]*)\]/.exec(label);
    return match ? [match[1], ` ${match[2]}`] : [label, ""];
  };
  const named = (label, value) => {
    const [name, unit] = split(label);
    return `${name ? `${name}: ` : ""}${digits(value, 5)}${unit}`;
  };

  function nearestOfCurves(axes, u, v, aspect) {
    let best = null;
    for (const curve of axes.curves) {
      for (let k = 0; k < curve.x.length; k++) {
        const s = place(axes.x, curve.x[k]), t = place(axes.y, curve.y[k]);
        if (!(s >= -0.01 && s <= 1.01 && t >= -0.01 && t <= 1.01)) continue;
        const distance = Math.hypot((s - u) * aspect, t - v);
        if (!best || distance < best.distance) best = { distance, s, t, lines: [curve.label, named(axes.x.label, curve.x[k]), axes.names.length ? axes.names[Math.round(curve.y[k])] || "" : named(axes.y.label, curve.y[k])] };
      }
    }
    return best && best.distance < 0.12 ? best : null;
  }

  function valueOfMap(axes, u, v) {
    const { x, y, values, label } = axes.map;
    const closest = (scale, list, share) => list.reduce((best, one, k) => (Math.abs(place(scale, one) - share) < Math.abs(place(scale, list[best]) - share) ? k : best), 0);
    const i = closest(axes.x, x, u), j = closest(axes.y, y, v);
    return { s: u, t: v, lines: [named(label, values[j * x.length + i]), named(axes.x.label, x[i]), named(axes.y.label, y[j])] };
  }

  for (const svg of document.querySelectorAll("svg.figure")) {
    const stored = svg.querySelector("metadata.hover");
    if (!stored) continue;
    let described = null;
    const mark = document.createElementNS("http://www.w3.org/2000/svg", "circle");
    mark.setAttribute("class", "mark");
    mark.setAttribute("r", "3.5");
    const [, , width, height] = svg.getAttribute("viewBox").split(" ").map(Number);
    const leave = () => { tip.hidden = true; mark.remove(); };
    svg.addEventListener("pointermove", (event) => {
      described = described || JSON.parse(stored.textContent);
      const frame = svg.getBoundingClientRect();
      const X = (event.clientX - frame.left) / frame.width, Y = (event.clientY - frame.top) / frame.height;
      const axes = described.find(({ box }) => X >= box[0] && X <= box[2] && Y >= box[1] && Y <= box[3]);
      if (!axes) return leave();
      const [x0, y0, x1, y1] = axes.box, u = (X - x0) / (x1 - x0), v = (y1 - Y) / (y1 - y0);
      const aspect = ((x1 - x0) * width) / ((y1 - y0) * height);
      const found = axes.map ? nearestOfCurves(axes, u, v, aspect) && nearestOfCurves(axes, u, v, aspect).distance < 0.03 ? nearestOfCurves(axes, u, v, aspect) : valueOfMap(axes, u, v) : nearestOfCurves(axes, u, v, aspect);
      if (!found) return leave();
      tip.replaceChildren(...found.lines.filter(Boolean).map((line) => Object.assign(document.createElement("div"), { textContent: line })));
      tip.hidden = false;
      const left = Math.min(event.pageX + 14, document.documentElement.clientWidth - tip.offsetWidth - 8);
      tip.style.left = `${Math.max(left, 4)}px`;
      tip.style.top = `${event.pageY + 16}px`;
      mark.setAttribute("cx", (x0 + found.s * (x1 - x0)) * width);
      mark.setAttribute("cy", (y1 - found.t * (y1 - y0)) * height);
      svg.append(mark);
    });
    svg.addEventListener("pointerleave", leave);
  }
})();
