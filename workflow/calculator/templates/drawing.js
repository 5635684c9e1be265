// The contact drawn to scale, and the pressure under it.
"use strict";

const SVG = "http://www.w3.org/2000/svg";
function node(name, attributes = {}, text = "") {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  made.textContent = text;
  return made;
}
const near = (value) => Number(value.toFixed(2));
const path = (points) => points.map(([x, y], k) => `${k ? "L" : "M"}${near(x)} ${near(y)}`).join("");

// The largest of 1, 2, 5 times a power of ten that is at most a value.
function roundLength(value) {
  const power = 10 ** Math.floor(Math.log10(value));
  return [5, 2, 1].find((one) => one * power <= value * (1 + 1e-9)) * power;
}

/* Punch and body in their proportions: `wide` metres across 400 units. The contact is marked; on a film its thickness
   stands beside it. Corners of the drawing are those of its frame. */
function drawContact(svg, found, punch, thickness, words) {
  const width = 400, height = 230, ground = 140, middle = width / 2;
  const { half, centre } = found, round = punch.radius, wide = round ? Math.max(2.6 * round, 6 * half) : Math.max(3.2 * half, thickness ? 2 * thickness : 0);
  const zoom = width / wide, x = (metres) => middle + metres * zoom;
  const parts = [node("rect", { x: 0, y: ground, width, height: height - ground, class: "body" })];
  const shown = thickness && thickness * zoom;
  if (shown && shown < height - ground) {
    parts.push(node("rect", { x: 0, y: ground + shown, width, height: height - ground - shown, class: "base" }));
    if (shown > 16) parts.push(node("text", { x: 8, y: ground + shown / 2 + 4, class: "soft" }, `film ${said(thickness, "m", 3)}`));
  }
  if (round) {
    const r = round * zoom;
    parts.push(r > 1e4 ? node("rect", { x: 0, y: 0, width, height: ground, class: "punch" }) : node("circle", { cx: middle, cy: ground - r, r, class: "punch" }));
    if (r < 1e4 && r > 40) {
      const tip = [middle + r * Math.SQRT1_2, ground - r - r * Math.SQRT1_2];
      parts.push(node("path", { d: path([[middle, ground - r], tip]), class: "measure" }), node("text", { x: middle + r * 0.2, y: ground - r - r * 0.42, "text-anchor": "end" }, `R ${said(round, "m", 3)}`));
    }
  } else if (punch.slope) {
    const rise = Math.min(punch.slope, 20), ends = punch.profile === "cone" ? [-width, width] : [0, width];
    const outline = ends.map((dx) => [middle + dx, ground - Math.abs(dx) * rise]);
    const corner = punch.profile === "cone" ? [[middle, ground]] : [];
    const top = Math.min(-2, ...outline.map(([, y]) => y));
    parts.push(node("path", { d: `${path([[outline[0][0], top], outline[0], ...corner, outline[1], [outline[1][0], top]])}Z`, class: "punch" }));
  } else parts.push(node("rect", { x: x(-half), y: 20, width: 2 * half * zoom, height: ground - 20, class: "punch" }));
  const [left, right] = [x(centre - half), x(centre + half)], least = Math.max(0, 3 - (right - left)) / 2;
  parts.push(node("rect", { x: near(left - least), y: ground - 1.5, width: near(right - left + 2 * least), height: 4, class: "contact" }));
  parts.push(node("text", { x: middle, y: ground + 24, "text-anchor": "middle", class: "strong" }, words));
  const bar = roundLength(wide / 4);
  parts.push(node("path", { d: `M12 ${height - 14}v6h${near(bar * zoom)}v-6`, class: "measure" }), node("text", { x: 16 + bar * zoom, y: height - 8, class: "soft" }, said(bar, "m", 1)));
  parts.push(node("text", { x: width - 8, y: height - 8, "text-anchor": "end", class: "soft" }, "to scale, before it gives way"));
  svg.replaceChildren(...parts);
}

// The pressure over the contact, with a round grid; infinite ends are cut at `ceiling`.
function drawPressure(svg, found, title) {
  const width = 400, height = 230, frame = { left: 58, right: 388, top: 30, bottom: 190 };
  const count = 161, at = Array.from({ length: count }, (_, k) => -Math.cos((Math.PI * (k + 0.5)) / count));
  const values = at.map((one) => found.pressure(one)).map((one) => (Number.isFinite(one) ? one : Infinity));
  const finite = values.filter(Number.isFinite), ordered = [...finite].sort((a, b) => a - b), median = ordered[Math.floor(ordered.length / 2)];
  const infinite = found.peak_pressure === undefined, ceiling = infinite ? 3 * median : Math.max(...finite) * 1.08;
  const { half, centre } = found, reach = 1.25, x = (X) => frame.left + ((X + reach) / (2 * reach)) * (frame.right - frame.left);
  const y = (value) => frame.bottom - (Math.min(value, ceiling) / ceiling) * (frame.bottom - frame.top);
  const parts = [node("text", { x: frame.left, y: 18, class: "strong" }, title)];
  const step = roundLength(ceiling / 2.5), { size, units } = engineering(ceiling, "Pa", 2);
  for (let value = 0; value <= ceiling * 1.001; value += step)
    parts.push(node("path", { d: `M${frame.left} ${near(y(value))}H${frame.right}`, class: "grid" }), node("text", { x: frame.left - 5, y: near(y(value)) + 4, "text-anchor": "end", class: "soft" }, digits(value / size, 3)));
  parts.push(node("text", { x: 4, y: 18, class: "soft" }, units));
  const inner = path(at.map((X, k) => [x(X), y(values[k])]));
  const closed = infinite ? "" : `M${near(x(-1))} ${frame.bottom}L`;
  parts.push(node("path", { d: `M${near(x(-1))} ${frame.bottom}L${inner.slice(1)}L${near(x(1))} ${frame.bottom}Z`, class: "under" }));
  parts.push(node("path", { d: infinite ? inner : `${closed}${inner.slice(1)}L${near(x(1))} ${frame.bottom}`, class: "curve" }));
  const length = roundLength(half), prefix = engineering(reach * half, "m", 2);
  for (let k = -1; k <= 1; k++) {
    const X = (k * length - centre) / half;
    if (Math.abs(X) > reach) continue;
    parts.push(node("path", { d: `M${near(x(X))} ${frame.bottom}v5`, class: "measure" }), node("text", { x: near(x(X)), y: frame.bottom + 18, "text-anchor": "middle", class: "soft" }, digits((k * length) / prefix.size, 3)));
  }
  parts.push(node("text", { x: frame.right, y: frame.bottom + 34, "text-anchor": "end", class: "soft" }, `place [${prefix.units}]`));
  svg.replaceChildren(...parts);
}
