// Zoom, values under the pointer and labels of the panels over the track.
(function () {
  "use strict";
  const track = document.querySelector(".track"), inner = track.querySelector(".inner");
  const cursor = track.querySelector(".cursor"), place = document.querySelector(".place");
  const controls = document.querySelector(".controls");
  const MARGIN = 68, RIGHT = 20, PER_METRE = 100, CLOSEST = 40, SPAN = 30;
  const from = Number(track.dataset.from), firstSpan = Number(track.dataset.span);
  const evaluated = track.dataset.evaluated.split(" ").map(Number);
  const numbers = (text) => (text.match(/-?\d+/g) || []).map(Number);

  // Pieces of a curve, or ends of bars, in units of the drawing.
  function read(path) {
    const isBar = path.classList.contains("bar");
    return path.getAttribute("d").split("M").slice(1).map((piece) => {
      const n = numbers(piece), points = [[n[0], n[1]]];
      if (isBar) return [[n[0], n[2]]];
      for (let i = 2; i + 1 < n.length; i += 2) {
        const [x, y] = points[points.length - 1];
        points.push([x + n[i], y + n[i + 1]]);
      }
      return points;
    });
  }
  const panels = [...track.querySelectorAll(".panel")].map((figure) => ({
    output: figure.querySelector("output"), top: Number(figure.dataset.top), per: Number(figure.dataset.per),
    digits: Number(figure.dataset.digits),
    curves: [...figure.querySelectorAll("[data-name]")].map((path) => (
      { name: path.dataset.name, bar: path.classList.contains("bar"), pieces: read(path) })),
  }));
  const width = track.querySelector("svg").viewBox.baseVal.width;
  const masts = numbers(track.querySelector(".mast").getAttribute("d").replace(/ 0V\d+/g, " "));
  const bars = panels.flatMap((panel) => panel.curves.filter((curve) => curve.bar));
  const stops = [...new Set([...masts, ...bars.flatMap((curve) => curve.pieces.map((piece) => piece[0][0]))])]
    .sort((a, b) => a - b);

  // Last entry of a sorted list whose key is at most x; -1 before the first.
  function before(list, x, key) {
    let low = -1, high = list.length;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (key(list[middle]) <= x) low = middle; else high = middle;
    }
    return low;
  }
  function valueAt(curve, x, reach) {
    if (curve.bar) {
      let nearest = null;
      for (const [point] of curve.pieces) {
        const away = Math.abs(point[0] - x);
        if (away <= reach && (!nearest || away < Math.abs(nearest[0] - x))) nearest = point;
      }
      return nearest && nearest[1];
    }
    for (const piece of curve.pieces) {
      if (x < piece[0][0] || x > piece[piece.length - 1][0]) continue;
      const i = Math.min(before(piece, x, (point) => point[0]), piece.length - 2), a = piece[i], b = piece[i + 1];
      return b[0] > a[0] ? a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]) : a[1];
    }
    return null;
  }
  const print = (value, digits) => value.toFixed(digits).replace("-", "−");

  let zoom = 1, at = null;
  const view = () => track.clientWidth;
  const perUnit = () => (view() * zoom - MARGIN - RIGHT) / width;

  function show(x) {
    at = x === null ? null : Math.min(width, Math.max(0, x));
    cursor.hidden = at === null;
    if (at === null) { place.textContent = ""; panels.forEach((panel) => { panel.output.textContent = ""; }); return; }
    cursor.style.left = MARGIN + at * perUnit() + "px";
    const mast = before(masts, at, (mast) => mast), onMast = masts[mast] === at;
    const span = firstSpan + Math.min(mast, masts.length - 2);
    const part = onMast ? `mast ${firstSpan + mast}` : `span ${span}`;
    place.textContent = `${print(from + at / PER_METRE, 2)} m · ${part}`;
    const reach = Math.max(8 / perUnit(), 50);
    for (const panel of panels) {
      const values = panel.curves.map((curve) => {
        const y = valueAt(curve, at, reach);
        return y === null ? null : `${curve.name} ${print(panel.top - y / panel.per, panel.digits)}`;
      });
      panel.output.textContent = values.filter(Boolean).join(" · ");
    }
  }

  // Labels that do not overlap those before them.
  function thin() {
    for (const layer of track.querySelectorAll(".labels")) {
      const kept = [], spans = [...layer.children], boxes = spans.map((span) => span.getBoundingClientRect());
      const own = layer.getBoundingClientRect(), apart = 6;
      spans.forEach((span, i) => {
        const box = boxes[i];
        let free = box.left >= own.left - 16 && box.right <= own.right + RIGHT - 1;
        for (let k = 0; free && k < kept.length; k++) {
          const other = kept[k];
          free = box.left > other.right + apart || other.left > box.right + apart ||
            box.top > other.bottom || other.top > box.bottom;
        }
        span.classList.toggle("on", free);
        if (free) kept.push(box);
      });
    }
  }

  // Zooms so that the unit at the pointer (or in the middle) stays where it is.
  function set(next, pointer) {
    const middle = pointer === undefined ? view() / 2 : pointer;
    const unit = (track.scrollLeft + middle - MARGIN) / perUnit();
    const most = Math.max(1, width / PER_METRE * CLOSEST / view());
    zoom = Math.min(most, Math.max(1, next));
    inner.style.width = 100 * zoom + "%";
    inner.style.setProperty("--view", view() + "px");
    inner.style.setProperty("--bar", Math.min(5, Math.max(1, 0.45 * width / stops.length * perUnit())) + "px");
    track.scrollLeft = unit * perUnit() + MARGIN - middle;
    thin();
    show(at);
  }
  function toRange(a, b) {
    const units = [a, b].map((x) => (x - from) * PER_METRE), more = 0.05 * (units[1] - units[0]);
    set(width / (units[1] - units[0] + 2 * more));
    track.scrollLeft = (units[0] - more) * perUnit();
  }
  const zooms = { in: () => set(zoom * 1.5), out: () => set(zoom / 1.5), all: () => set(1),
    evaluated: () => toRange(...evaluated) };
  controls.addEventListener("click", (event) => {
    const zoomed = zooms[event.target.dataset.zoom];
    if (zoomed) zoomed();
  });
  track.addEventListener("wheel", (event) => {
    if (!event.ctrlKey) return;
    event.preventDefault();
    set(zoom * Math.exp(-0.003 * event.deltaY), event.clientX - track.getBoundingClientRect().left);
  }, { passive: false });
  track.addEventListener("pointermove", (event) => {
    show((event.clientX - track.getBoundingClientRect().left + track.scrollLeft - MARGIN) / perUnit());
  });
  track.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse") show(null); });

  function goTo(x) {
    show(x);
    const left = MARGIN + at * perUnit() - track.scrollLeft;
    if (left < MARGIN + 20 || left > view() - 20) track.scrollLeft += left - view() / 2;
  }
  track.addEventListener("keydown", (event) => {
    const x = at === null ? -1 : at;
    const next = { ArrowRight: () => goTo(stops.find((stop) => stop > x) ?? width),
      ArrowLeft: () => goTo([...stops].reverse().find((stop) => stop < x) ?? 0),
      Home: () => goTo(0), End: () => goTo(width), "+": zooms.in, "=": zooms.in, "-": zooms.out, 0: zooms.all,
      Escape: () => show(null) }[event.key];
    if (!next || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    next();
  });
  window.addEventListener("resize", () => set(zoom));
  controls.hidden = false;
  track.classList.add("thin");
  // The whole line where its spans are wide enough to be seen, else as much from the evaluated spans on.
  set(SPAN * (masts.length - 1) / view());
  if (zoom > 1) track.scrollLeft = (evaluated[0] - from) * PER_METRE * perUnit();
  thin();
})();
