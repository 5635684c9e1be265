// Takes a point of the panel elsewhere: a link that restores it, and its numbers as CSV.
"use strict";

const LINK = "#whatif?";

// The panel's point as the fragment of an address: every factor in SI units, categories and target by name.
function linkTo(panel, values) {
  const parts = new URLSearchParams(panel.model.inputs.map(({ name }) => [name, String(values[name])]));
  Object.entries(panel.kind.names).forEach(([name, kind]) => parts.set(name, kind));
  if (panel.data.cases.length) parts.set("target", panel.data.cases[panel.chosen].name);
  return LINK + parts;
}

// Goes to the point that the address names; names that are none, and values that are no numbers, are passed over.
function restore(panel) {
  if (!location.hash.startsWith(LINK)) return;
  const parts = new URLSearchParams(location.hash.slice(LINK.length));
  const chosen = panel.data.cases.findIndex(({ name }) => name === parts.get("target"));
  if (chosen >= 0) panel.choose(chosen);
  const kind = panel.data.kinds.find(({ names }) => Object.entries(names).every(([name, one]) => !parts.has(name) || parts.get(name) === one));
  const known = panel.model.inputs.flatMap((input, k) => {
    const value = parts.has(input.name) ? Number(parts.get(input.name)) : NaN;
    return Number.isFinite(value) ? [[k, toUnit(input, value)]] : [];
  });
  panel.move(known.map(([k]) => k), known.map(([, t]) => t), kind);
  document.getElementById("whatif").scrollIntoView();
}

// One row, with the columns of `meecontact query`; categories stand before the factors.
function asCsv(panel, values, answer) {
  const columns = Object.entries(panel.kind.names);
  panel.model.inputs.forEach(({ name }) => columns.push([name, values[name]]));
  panel.data.quantities.forEach(({ name }, p) => {
    const column = panel.kind.columns[p];
    columns.push([name, answer.mean[column]], [`${name}_std`, answer.std[column]], [`${name}_lower`, answer.lower[column]], [`${name}_upper`, answer.upper[column]]);
  });
  return `${columns.map(([name]) => csvCell(name)).join(",")}\n${columns.map(([, value]) => csvCell(value)).join(",")}\n`;
}

// A cell of CSV: quoted where it holds what separates cells, behind an apostrophe where a spreadsheet would calculate.
function csvCell(value) {
  if (typeof value !== "string") return value;
  const text = /^[=+\-@\t\r]/.test(value) ? `'${value}` : value;
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function startSharing(panel, root) {
  const status = root.querySelector("[data-share=status]");
  root.querySelector("[data-share=link]").addEventListener("click", async () => {
    history.replaceState(null, "", linkTo(panel, panel.values()));
    const copied = await navigator.clipboard?.writeText(location.href).then(() => true, () => false);
    status.textContent = copied ? "The link is copied." : "The link stands in the address bar.";
  });
  root.querySelector("[data-share=csv]").addEventListener("click", () => {
    const file = new Blob([asCsv(panel, panel.values(), predict(panel.model, panel.point))], { type: "text/csv" });
    const link = Object.assign(document.createElement("a"), { href: URL.createObjectURL(file), download: "point.csv" });
    link.click();
    URL.revokeObjectURL(link.href);
    status.textContent = "point.csv is written.";
  });
  addEventListener("hashchange", () => restore(panel));
  restore(panel);
}
