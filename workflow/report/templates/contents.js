// A closed section opens when the contents lead to it, and all of them open on paper.
"use strict";

function openLinked() {
  const linked = location.hash.length > 1 ? document.getElementById(decodeURIComponent(location.hash.slice(1))) : null;
  const inside = linked && (linked.querySelector(":scope > details") || linked.closest("details"));
  if (inside) inside.open = true;
}

let closed = [];
addEventListener("hashchange", openLinked);
addEventListener("beforeprint", () => {
  closed = [...document.querySelectorAll("details:not([open])")];
  closed.forEach((one) => { one.open = true; });
});
addEventListener("afterprint", () => closed.forEach((one) => { one.open = false; }));
openLinked();
