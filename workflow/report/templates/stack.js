// The punch on its body to scale, as workflow/report/device.py draws it, from the numbers of the sliders.
"use strict";

const PICTURE = { words: 46, width: 560, height: 250, surface: 128, whole: [14, 206], near: [236, 546], top: 26, low: 222 };
const STEEP = { device: 84, wider: 2.6, deep: 62, tips: 10, line: 22, points: 97, letter: 8.5, bar: [4, 90] };
const TINT = {
  ink: "var(--ink)", paper: "var(--card)", accent: "var(--accent)", soft: "var(--soft)", bad: "var(--bad)",
  body: "color-mix(in srgb, var(--accent) 10%, var(--card))", punch: "color-mix(in srgb, var(--ink) 12%, var(--card))",
};

const FLAT = ["flat", "disc"], POWERS = ["cone", "power"], ENDLESS = ["wedge", ...POWERS]; // of the last a part is drawn
const CORNERED = ["wedge", "half_cylinder"]; // which lie on one side of their edge
const SIZES = { flat: "w = ", disc: "w = ", wedge: "slope ", cone: "slope ", power: "C = " };

// How far from the sharp edge, towards the other.
const ahead = (device, x) => (device.corner === "leading" ? x + device.leading : device.trailing - x);

// Of the punch's face over its lowest point; NaN beside the punch.
function faceHeight(device, x) {
  const { profile, size } = device;
  if (FLAT.includes(profile)) return Math.abs(x) <= size / 2 ? 0 : NaN;
  if (POWERS.includes(profile)) return Math.abs(size) * Math.abs(x) ** device.exponent;
  if (profile === "wedge") return ahead(device, x) >= 0 ? Math.abs(size) * ahead(device, x) : NaN;
  const whole = profile !== "half_cylinder", along = whole ? x : ahead(device, x);
  const inside = Math.abs(along) <= size && (whole || along >= 0);
  return inside ? size - Math.sqrt(Math.max(size * size - along * along, 0)) : NaN;
}

// What the drawing needs beside the numbers of a punch: scales, and how deep its lowest point is.
function measured(device) {
  const contact = device.trailing + device.leading;
  const reach = ENDLESS.includes(device.profile) ? 2 * contact : FLAT.includes(device.profile) ? device.size / 2 : device.size;
  const ends = [-device.leading, device.trailing].map((x) => faceHeight(device, x * (1 - 1e-9))).filter((one) => !Number.isNaN(one));
  const wide = (PICTURE.near[1] - PICTURE.near[0]) / (STEEP.wider * contact);
  return {
    contact, reach, sunk: ends.length ? Math.max(...ends) : 0,
    whole: (PICTURE.whole[1] - PICTURE.whole[0] - 24) / (2 * reach),
    near: device.thickness === null ? wide : Math.min(wide, STEEP.deep / device.thickness),
  };
}

const at = (value) => value.toFixed(2);
const stroke = (x0, y0, x1, y1, colour = TINT.ink, wide = 1.2, more = "") =>
  `<line x1="${at(x0)}" y1="${at(y0)}" x2="${at(x1)}" y2="${at(y1)}" stroke="${colour}" stroke-width="${wide}"${more}/>`;
const words = (x, y, text, colour = TINT.ink, anchor = "middle") =>
  `<text x="${x.toFixed(1)}" y="${y.toFixed(1)}" fill="${colour}" text-anchor="${anchor}">${text.replace(/[&<>]/g, (c) => `&#${c.charCodeAt(0)};`)}</text>`;
const tipped = `stroke="${TINT.ink}" stroke-width="1.6" marker-start="url(#stack-tip)" marker-end="url(#stack-tip)"`;

// Body and punch between two places of the picture, with its middle under the contact's.
function stackPart(device, size, [left, right], scale) {
  const { surface, low, top } = PICTURE, middle = (device.trailing - device.leading) / 2, width = right - left;
  const parts = [`<rect x="${left}" y="${surface}" width="${width}" height="${low - surface}" fill="${TINT.body}"/>`];
  if (device.thickness !== null) {
    const interface_ = Math.min(surface + Math.max(device.thickness * scale, 1.2), low);
    parts.push(`<rect x="${left}" y="${at(interface_)}" width="${width}" height="${at(low - interface_)}" fill="${TINT.punch}"/>`);
    if (device.grounded) parts.push(stroke(left, interface_, right, interface_, TINT.accent, 2.2));
  }
  const inside = 1 - 1e-9, edges = FLAT.includes(device.profile) ? [-0.5, 0.5].map((one) => one * device.size * inside)
    : [-device.leading, device.trailing, -size.reach, size.reach].map((one) => one * inside);
  const even = Array.from({ length: STEEP.points }, (_, k) => middle + (width * ((2 * k) / (STEEP.points - 1) - 1)) / 2 / scale);
  const shown = [...even, ...edges].sort((a, b) => a - b)
    .filter((x) => Math.abs(x - middle) * scale <= (width / 2) * (1 + 1e-9) && !Number.isNaN(faceHeight(device, x)));
  const place = (x) => (left + right) / 2 + (x - middle) * scale;
  const roof = scale === size.whole ? Math.max(top, surface - STEEP.device) : top;
  const outline = shown.map((x) => `${at(place(x))},${at(Math.max(surface - (faceHeight(device, x) - size.sunk) * scale, roof))}`).join(" ");
  parts.push(stroke(left, surface, right, surface));
  parts.push(`<polygon points="${at(place(shown[0]))},${roof} ${outline} ${at(place(shown.at(-1)))},${roof}" fill="${TINT.punch}" stroke="${TINT.ink}"/>`);
  if (device.conducts) parts.push(`<polyline points="${outline}" fill="none" stroke="${TINT.accent}" stroke-width="2.2"/>`);
  const [a, b] = [-device.leading, device.trailing].map(place);
  parts.push(stroke(a, surface, Math.max(b, a + 1.2), surface, TINT.bad, 4));
  return parts;
}

// A bar of 10 mm beside the words, or of as many times ten as can be seen.
function scaleBar(scale) {
  let length = 0.01;
  while (length * scale > STEEP.bar[1]) length /= 10;
  while (length * scale < STEEP.bar[0]) length *= 10;
  const start = PICTURE.whole[0] + 62, end = start + length * scale, y = PICTURE.height - 14;
  return [stroke(start, y, end, y, TINT.ink, 3), words(end + 6, PICTURE.height - 10, said(length, "m", 3), TINT.soft, "start")];
}

// The size of the punch: in it, or beside the sharp edge of a half cylinder, in which there is no room.
function sizeWords(device, size, middle, text) {
  const y = PICTURE.surface - 50, side = device.corner === "leading" ? -1 : 1; // of the edge
  if (!CORNERED.includes(device.profile)) return words(middle, y, text);
  const edge = middle + (side * size.contact * size.whole) / 2;
  if (device.profile === "wedge") return words((edge + PICTURE.whole[side < 0 ? 1 : 0]) / 2, y, text);
  return words(edge + 8 * side, y, text, TINT.ink, side < 0 ? "end" : "start");
}

// The size of the contact: over it, or beside a punch that is narrower than the words.
function extentWords(device, size, centre, text) {
  const y = PICTURE.surface - 24, half = size.reach * size.near;
  if (CORNERED.includes(device.profile) || 2 * half > STEEP.letter * text.length) return words(centre, y, text);
  return words(centre + half + 8, y, text, TINT.ink, "start");
}

// Words of either part: of the punch whole, and of its contact.
function stackWords(device, size) {
  const { surface, height, low, whole, near } = PICTURE, middle = (whole[0] + whole[1]) / 2, centre = (near[0] + near[1]) / 2;
  const half = (size.contact * size.near) / 2;
  const name = SIZES[device.profile] || "R = ";
  const extent = device.point ? `a = ${said(device.trailing, "m", 3)}` : said(size.contact, "m", 3);
  const tip = ' marker-end="url(#stack-tip)"', { bad, soft, ink } = TINT;
  const ofWhole = [
    stroke(middle, 4, middle, 38, bad, 1.6, tip), words(middle + 8, 16, said(device.load, device.units, 3), bad, "start"),
    ...(!device.slides ? [] : [stroke(whole[0] + 56, 28, whole[0] + 4, 28, bad, 1.6, tip), words(whole[0] + 4, 18, "slides", bad, "start")]),
    sizeWords(device, size, middle, name + (ENDLESS.includes(device.profile) ? digits(device.size, 3) : said(device.size, "m", 3))),
    words(whole[0], height - 10, "to scale", soft, "start"), ...scaleBar(size.whole),
  ];
  const parts = [
    words(near[0], height - 10, `the contact, at ${digits(size.near / size.whole, 2)} times that scale`, soft, "start"),
    half > STEEP.tips ? `<path d="M${at(device.point ? centre : centre - half)} ${surface - 16} H${at(centre + half)}" ${tipped}/>` : "",
    extentWords(device, size, centre, extent),
  ];
  if (device.thickness === null) return [ofWhole, [...parts, words(near[0] + 8, low - 10, device.point ? "half-space" : "half-plane", soft, "start")]];
  const interface_ = surface + device.thickness * size.near, place = near[1] - 14;
  const electrode = `${device.base ? ", " : ""}grounded electrode between`;
  const between = !device.grounded ? "" : (device.base + electrode).length <= PICTURE.words ? electrode : ", electrode";
  return [ofWhole, [
    ...parts,
    `<path d="M${place} ${surface} V${at(interface_)}" ${tipped}/>`,
    words(place - 8, interface_ - surface > STEEP.line ? (surface + interface_) / 2 + 5 : interface_ + STEEP.line - 4, `${device.top} ${said(device.thickness, "m", 3)}`, ink, "end"),
    words(near[0] + 8, low - 10, device.base + between, soft, "start"),
  ]];
}

// The whole picture; `device` as in device.py: profile, corner, size, trailing, leading, load, conducts, thickness, base, grounded,
// exponent, slides, top, point; and the unit of the load.
function stackPicture(device) {
  const size = measured(device), [ofWhole, ofNear] = stackWords(device, size);
  return [
    `<rect width="${PICTURE.width}" height="${PICTURE.height}" fill="${TINT.paper}"/>`,
    '<marker id="stack-tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto-start-reverse"><path d="M0 0 8 4 0 8z" fill="context-stroke"/></marker>',
    ...stackPart(device, size, PICTURE.whole, size.whole), ...ofWhole,
    ...stackPart(device, size, PICTURE.near, size.near), ...ofNear,
  ].join("");
}

// The punch of a combination of the categories at values of every name.
function deviceAt(body, values) {
  const number = (one) => (typeof one === "string" ? values[one] : one);
  const [trailing, leading] = body.ends.map((name) => values[name]);
  return { ...body, size: number(body.size), exponent: number(body.exponent), thickness: number(body.thickness),
    slides: number(body.slides) > 0, load: values[body.pressing], trailing, leading };
}

function showStack(panel, svg) {
  panel.watch((values) => {
    const device = deviceAt(panel.kind.body, values);
    svg.innerHTML = stackPicture(device);
    svg.setAttribute("aria-label", `drawn to scale: contact ${said(device.trailing + device.leading, "m", 3)}`);
  });
}
