// Behaviour of every page: figures from their data, tables and figures as files, colours of the dark mode.
const pantoline = (() => {
  "use strict";
  const dark = matchMedia("(prefers-color-scheme: dark)");
  // Colours of figures on paper, and on a dark ground.
  const GROUND = {
    "#e6eaee": "#2f3a47", "#aeb7c2": "#5d6875", "#5b6675": "#a3adba", "#eef4fa": "#1b2530",
    "#1f5fa8": "#6ea8ee", "#d1661b": "#f0914f", "#1d7a46": "#58c088", "#a0338a": "#d979c5", "#8a6d00": "#d2b23c",
    "#3aa0c4": "#6cc6e4", "#b3261e": "#f2837c",
    "#b5cbe4": "#35506f", "#f0cbae": "#6b4a33", "#b3d6c1": "#2f5c45", "#e0bcd9": "#653a5d", "#dcd09f": "#5d5226",
    "#bfe1ed": "#2f5866", "#e6b8b5": "#69403d",
  };
  const recoloured = (value) => {
    if (typeof value === "string") return GROUND[value.toLowerCase()] || value;
    if (Array.isArray(value)) return typeof value[0] === "number" ? value : value.map(recoloured);
    if (value && typeof value === "object") {
      return Object.fromEntries(Object.entries(value).map(([key, entry]) => [key, recoloured(entry)]));
    }
    return value;
  };
  const ink = () => getComputedStyle(document.documentElement).getPropertyValue("--ink").trim();
  const themed = ({ data, layout, config }, onDark) => {
    const clear = { paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)" };
    const font = { ...layout.font, color: onDark ? ink() : "#1c2430" };
    const plain = { ...layout, ...clear, font };
    return onDark ? [recoloured(data), recoloured(plain), config] : [data, plain, config];
  };

  const unpacked = async (text) => {
    const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).text();
  };
  // Data of a script element, which may be packed.
  const data = async (script) =>
    JSON.parse(script.type === "text/plain" ? await unpacked(script.textContent) : script.textContent);
  const library = async () => {
    const packed = document.getElementById("plotly");
    if (window.Plotly || !packed) return;
    const script = document.createElement("script");
    script.textContent = await unpacked(packed.textContent);
    document.head.append(script);
  };

  const save = (name, type, text) => {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([text], { type }));
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 1000);
  };
  const button = (text, what, act) => {
    const made = document.createElement("button");
    made.type = "button";
    made.textContent = text;
    made.setAttribute("aria-label", what);
    made.addEventListener("click", act);
    return made;
  };
  const tools = (after, buttons) => {
    const bar = document.createElement("div");
    bar.className = "tools";
    bar.append(...buttons);
    after.after(bar);
  };

  // One field of a table as CSV: quoted where a comma, a quote or a line break would break it.
  const field = (text) => (/[",\n]/.test(text) ? `"${text.replace(/"/g, '""')}"` : text);
  const csv = (table) =>
    [...table.rows]
      .map((row) => [...row.cells].map((cell) => field(cell.innerText.replace(/\s+/g, " ").trim())).join(","))
      .join("\n") + "\n";
  const offerTables = () => {
    for (const table of document.querySelectorAll("table[data-csv]")) {
      const name = `${table.dataset.csv}.csv`;
      tools(table.closest(".scroll") || table, [
        button("CSV", `Save the table as ${name}`, () => save(name, "text/csv", csv(table))),
      ]);
    }
    // Tables that are wider than the page scroll by the keyboard too.
    for (const box of document.querySelectorAll(".scroll")) box.tabIndex = 0;
  };

  const drawAll = async () => {
    const scripts = [...document.querySelectorAll("script.figure")];
    if (scripts.length === 0) return;
    const figures = scripts.map((script) => ({ script, box: document.getElementById(script.dataset.for) }));
    const draw = (onDark) =>
      Promise.all(figures.map(({ box, figure }) => Plotly.react(box, ...themed(figure, onDark))));
    try {
      await library();
      await Promise.all(figures.map(async (entry) => { entry.figure = await data(entry.script); }));
      await draw(dark.matches);
    } catch (error) {
      for (const { box } of figures) box.textContent = `The figure could not be drawn: ${error}`;
      throw error;
    }
    for (const { box } of figures) {
      const file = (format) => () =>
        Plotly.downloadImage(box, { format, filename: box.id, width: box.clientWidth, height: box.clientHeight });
      tools(box, ["png", "svg"].map((format) => {
        const text = format.toUpperCase();
        return button(text, `Save the figure as ${text}: ${box.getAttribute("aria-label")}`, file(format));
      }));
    }
    dark.addEventListener("change", () => draw(dark.matches));
    addEventListener("beforeprint", () => draw(false));
    addEventListener("afterprint", () => draw(dark.matches));
  };

  addEventListener("DOMContentLoaded", () => {
    offerTables();
    // The state stands on the page, so that it can be waited for.
    const state = (word) => () => { document.documentElement.dataset.figures = word; };
    drawAll().then(state("drawn"), (error) => { state("failed")(); throw error; });
  });
  return { data };
})();
