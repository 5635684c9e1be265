// A closed section opens when the contents lead to it, a card's reasons open on paper; wide tables scroll by key.
"use strict";

function openLinked() {
  const linked = location.hash.length > 1 ? document.getElementById(decodeURIComponent(location.hash.slice(1))) : null;
  const inside = linked && (linked.querySelector(":scope > details") || linked.closest("details"));
  if (inside) inside.open = true;
}

// What is wider than the page is reached by the keyboard too.
function reachScrolled() {
  for (const one of document.querySelectorAll(".scroll")) {
    if (one.scrollWidth <= one.clientWidth || one.hasAttribute("tabindex")) continue;
    const title = one.closest("section")?.querySelector("h2")?.textContent || "table";
    Object.entries({ tabindex: "0", role: "region", "aria-label": `${title}, scrolls` }).forEach(([key, value]) => one.setAttribute(key, value));
  }
}

let closed = [];
addEventListener("hashchange", openLinked);
addEventListener("beforeprint", () => {
  closed = [...document.querySelectorAll(".answer details:not([open])")];
  closed.forEach((one) => { one.open = true; });
});
addEventListener("afterprint", () => closed.forEach((one) => { one.open = false; }));
openLinked();
reachScrolled();
