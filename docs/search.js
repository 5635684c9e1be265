// Search in the reader's browser, from a folder as from a server: lunr and the index come as scripts.
const found = document.getElementById("mkdocs-search-results");
const input = document.getElementById("mkdocs-search-query");

function escaped(text) {
  return text.replace(/[&<>"]/g, (one) => `&#${one.charCodeAt(0)};`);
}

function searched(data) { // called by search/index.js
  const pages = new Map(data.docs.map((page) => [page.location, page]));
  const index = lunr(function () {
    this.field("title", { boost: 10 });
    this.field("text");
    this.ref("location");
    data.docs.forEach((page) => this.add(page));
  });
  const show = () => {
    const words = input.value.toLowerCase().split(/[^\p{L}\p{N}_.]+/u).filter((word) => word);
    const terms = words.flatMap((word) => [{ term: word, boost: 5 }, { term: word, wildcard: 2, usePipeline: false }]);
    const results = words.length ? index.query((query) => terms.forEach((term) => query.term(term.term, term))) : [];
    const articles = results.slice(0, 30).map(({ ref }) => {
      const page = pages.get(ref);
      const text = escaped(page.text.slice(0, 200));
      return `<article><h3><a href="${base_url}/${escaped(ref)}">${escaped(page.title)}</a></h3><p>${text}</p></article>`;
    });
    found.innerHTML = articles.join("") || `<p>${found.dataset.noResultsText}</p>`;
  };
  input.value = new URLSearchParams(location.search).get("q") ?? "";
  input.addEventListener("input", show);
  show();
}

if (found) {
  for (const name of ["lunr.js", "index.js"]) {
    const script = document.createElement("script");
    script.async = false; // in this order
    script.src = `${base_url}/search/${name}`;
    document.head.append(script);
  }
}
