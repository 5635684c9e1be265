// Small charts that follow the sliders: curves on two linear axes, told about by the same pointer as every figure.
"use strict";

const CHART = { width: 320, height: 190, left: 50, right: 10, top: 26, bottom: 34 };

// Round steps that divide a range into about so many parts.
function ticks(low, high, count = 4) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((one) => one * power >= raw * (1 - 1e-9));
  const first = Math.ceil(low / step - 1e-9), last = Math.floor(high / step + 1e-9);
  return Array.from({ length: last - first + 1 }, (_, k) => (first + k) * step);
}

// Draws curves [{x, y, label, faint}] between limits of x and y, with a title; what is beyond the limits of y is cut.
function drawChart(svg, { title, x, y, curves }) {
  const { width, height, left, right, top, bottom } = CHART;
  const X = (value) => left + ((width - left - right) * (value - x.limits[0])) / (x.limits[1] - x.limits[0]);
  const Y = (value) => height - bottom - ((height - top - bottom) * (value - y.limits[0])) / (y.limits[1] - y.limits[0]);
  const held = (value) => Math.min(Math.max(Y(value), -height), 2 * height);
  const across = ticks(...x.limits).map((one) => `<text x="${X(one).toFixed(1)}" y="${height - bottom + 14}" text-anchor="middle">${digits(one, 3)}</text>`);
  const up = ticks(...y.limits).map((one) => `<text x="${left - 6}" y="${(Y(one) + 4).toFixed(1)}" text-anchor="end">${digits(one, 3)}</text><line class="grid" x1="${left}" x2="${width - right}" y1="${Y(one).toFixed(1)}" y2="${Y(one).toFixed(1)}"/>`);
  const lines = curves.map((one) => `<polyline class="curve${one.faint ? " faint" : ""}" points="${one.x.map((value, k) => `${X(value).toFixed(2)},${held(one.y[k]).toFixed(2)}`).join(" ")}"/>`);
  const clip = `${svg.id}-clip`, start = Math.min(left, Math.max(4, width - 4 - 6.3 * title.length)); // a letter has 6 px
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.innerHTML = `<clipPath id="${clip}"><rect x="${left}" y="${top}" width="${width - left - right}" height="${height - top - bottom}"/></clipPath>
    <text x="${start}" y="14" class="title">${title}</text>${up.join("")}${across.join("")}<g clip-path="url(#${clip})">${lines.join("")}</g>
    <text x="${(left + width - right) / 2}" y="${height - 4}" text-anchor="middle" class="soft">${x.label}</text>`;
  const box = [left / width, top / height, 1 - right / width, 1 - bottom / height];
  svg.described = [{ box, x: { ...x, log: false }, y: { ...y, label: title, log: false }, names: [], curves: curves.filter(({ faint }) => !faint), map: null }];
}
