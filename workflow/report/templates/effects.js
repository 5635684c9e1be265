// The effects of a parametric study in one panel: a factor from a list, its value by a slider; from the figures' own data.
"use strict";

function startEffects(root) {
  const chooser = root.querySelector("select"), slider = root.querySelector("input"), said_ = root.querySelector("output");
  const charts = [...root.querySelectorAll("svg")];
  let axes = [], values = [], along = "";

  function show() {
    const value = values[Number(slider.value)];
    said_.textContent = value;
    slider.setAttribute("aria-valuetext", value);
    charts.forEach((svg, k) => {
      svg.toggleAttribute("hidden", !axes[k]);
      if (!axes[k]) return;
      const { x, y, curves } = axes[k], own = curves.filter(({ label }) => values.includes(label));
      const sorted = [...own.filter(({ label }) => label !== value), ...own.filter(({ label }) => label === value)];
      drawChart(svg, { title: y.label, x: { ...x, label: along }, y, curves: sorted.map((one) => ({ ...one, faint: one.label !== value })) });
      svg.setAttribute("aria-label", `${y.label} at ${value}`);
    });
  }

  function take() {
    const stored = document.querySelector(`#figure-effect_${chooser.value} metadata.hover`);
    axes = JSON.parse(stored.textContent).filter(({ curves }) => curves.length);
    along = axes.some(({ x }) => x.label === "r/a") ? "r/a" : "(x − c)/h"; // which the lowest axes say
    values = [...new Set(axes[0].curves.map(({ label }) => label).filter(Boolean))];
    slider.max = String(values.length - 1);
    slider.value = slider.max;
    show();
  }

  chooser.addEventListener("change", take);
  slider.addEventListener("input", show);
  take();
  root.hidden = false;
}

const effectsPanel = document.getElementById("effects-panel");
if (effectsPanel) startEffects(effectsPanel);
