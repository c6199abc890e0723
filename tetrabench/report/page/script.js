// Makes the charts of a page live: they are redrawn from their specifications as the controls say, and the tables follow.
"use strict";
(async () => {
  /** Text that the page holds packed: the numbers, and what draws them. It says all it has to say without them too. */
  async function unpacked(name) {
    const packed = Uint8Array.from(atob(document.getElementById(name).textContent), (sign) => sign.charCodeAt(0));
    return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).text();
  }

  const figures = JSON.parse(await unpacked("figures"));
  const form = document.getElementById("controls");
  const charts = [...document.querySelectorAll(".chart")];
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const rowsOf = new Map();

  /** The numbers of a figure, a row each. */
  function rows(name) {
    if (!rowsOf.has(name)) {
      const columns = Object.entries(figures[name].columns);
      const count = columns.length ? columns[0][1].length : 0;
      rowsOf.set(name, Array.from({ length: count }, (_, n) => Object.fromEntries(columns.map(([key, all]) => [key, all[n]]))));
    }
    return rowsOf.get(name);
  }

  /** What the controls say. */
  function asked() {
    const data = new FormData(form);
    return { backends: data.getAll("backends"), models: data.getAll("models"), base: data.get("base"), scale: data.get("scale") };
  }

  /** Call `change` with each scale of a specification. */
  function eachScale(part, change) {
    if (part === null || typeof part !== "object") return;
    for (const [key, inner] of Object.entries(part)) {
      if (key === "scale" && inner && inner.type === "log") change(inner);
      else eachScale(inner, change);
    }
  }

  /** A specification as it is asked for, as wide as there is room. */
  function specified(name, want, room) {
    const spec = structuredClone(figures[name].spec);
    spec.data.values = rows(name);
    for (const one of spec.params) if (one.name in want) one.value = want[one.name];
    for (const one of spec.params) if (one.name === "hovered") one.value = true;
    if (want.scale === "linear") eachScale(spec, (scale) => { scale.type = "linear"; });
    if (spec.layer) {
      spec.width = room;
      if (spec.usermeta) spec.height = spec.usermeta.row * Math.max(1, want.backends.length) * Math.max(1, want.models.length);
    } else if (spec.facet.row) spec.spec.width = Math.max(120, room - 70);
    else {
      const panel = spec.spec.width + 64;
      spec.columns = Math.max(1, Math.min(Math.floor(room / panel), 4));
      spec.spec.width = Math.max(120, Math.min(Math.floor(room / spec.columns) - 64, 320));
    }
    return spec;
  }

  async function draw(chart) {
    const name = chart.dataset.figure;
    const want = asked();
    const room = Math.max(240, chart.clientWidth - 4);
    const stage = document.createElement("div");
    const turn = (chart.turn = (chart.turn || 0) + 1);
    try {
      await vegaEmbed(stage, specified(name, want, room), { actions: false, renderer: "svg", logLevel: 1, tooltip: { theme: dark.matches ? "dark" : "light" } });
    } catch (error) {
      console.error(`${name}: not drawn`, error); // what was drawn beforehand stays
      return;
    }
    if (turn !== chart.turn) return; // asked anew meanwhile
    stage.querySelector("svg").setAttribute("aria-hidden", "true"); // the chart has words, and the table has the numbers
    chart.replaceChildren(stage);
    chart.dataset.drawn = String(turn);
  }

  /** Tables show what is asked for, compared as is asked for. */
  function follow(want) {
    for (const line of document.querySelectorAll("tr[data-backend]")) {
      const { backend, model } = line.dataset;
      line.classList.toggle("away", !want.backends.includes(backend) || Boolean(model && !want.models.includes(model)));
    }
    for (const figure of document.querySelectorAll("figure")) {
      const lines = [...figure.querySelectorAll("tbody tr")];
      figure.hidden = lines.length > 0 && lines.every((line) => line.classList.contains("away"));
    }
    for (const chart of charts) {
      if (figures[chart.dataset.figure].kind !== "times") continue;
      const found = new Map(rows(chart.dataset.figure).filter((row) => row.base === want.base).map((row) => [JSON.stringify([row.model, row.backend]), row]));
      for (const line of chart.closest("figure").querySelectorAll("tr[data-backend]")) {
        const row = found.get(JSON.stringify([line.dataset.model, line.dataset.backend]));
        const text = line.querySelector("td.text"), span = line.querySelector("td.span"), verdict = line.querySelector("td.verdict");
        const shown = document.createElement("data");
        shown.value = row && row.value !== null ? row.value : "";
        shown.textContent = row ? row.text || row.word : "";
        text.replaceChildren(shown);
        span.textContent = row ? row.span : "";
        verdict.textContent = row ? row.verdict : "";
      }
    }
    for (const chart of charts) {
      const compared = figures[chart.dataset.figure].kind === "times" ? `, compared with ${form.elements.base.selectedOptions[0].textContent}` : "";
      chart.setAttribute("aria-label", `${chart.dataset.words}${compared}.`);
    }
    const count = (number, thing) => `${number} ${thing}${number === 1 ? "" : "s"}`;
    const against = form.elements.base.selectedOptions[0].textContent;
    document.getElementById("said").textContent = `${count(want.backends.length, "backend")} on ${count(want.models.length, "model")}, compared with ${against}.`;
  }

  const near = new IntersectionObserver((seen) => {
    for (const one of seen) if (one.isIntersecting && !one.target.dataset.asked) {
      one.target.dataset.asked = "yes";
      draw(one.target);
    }
  }, { rootMargin: "200px" });

  function redraw() {
    for (const chart of charts) {
      delete chart.dataset.asked;
      near.unobserve(chart);
      near.observe(chart);
    }
  }

  /** Draw what nobody has scrolled to as well, when there is time: on paper all charts and tables must say the same. */
  let rest = 0;
  async function drawRest() {
    const turn = ++rest;
    for (const chart of charts) {
      await new Promise((resume) => setTimeout(resume, 30));
      if (turn !== rest) return;
      if (chart.dataset.asked || chart.closest("figure").hidden) continue;
      chart.dataset.asked = "yes";
      await draw(chart);
    }
  }

  const library = document.createElement("script");
  library.textContent = await unpacked("library");
  document.head.append(library);
  form.hidden = false;
  if (matchMedia("(max-width: 40rem)").matches || form.querySelectorAll("[name=backends]").length > 16) form.querySelector("details").open = false;
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("change", () => { follow(asked()); redraw(); drawRest(); });
  dark.addEventListener("change", redraw);
  let width = innerWidth, waiting;
  addEventListener("resize", () => {
    clearTimeout(waiting);
    waiting = setTimeout(() => { if (innerWidth !== width) { width = innerWidth; redraw(); } }, 200);
  });
  follow(asked());
  redraw();
})();
