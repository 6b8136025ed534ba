// Plays the recorded pictures of line and pantograph on a canvas.
pantoline.data(document.getElementById("films")).then((films) => {
  "use strict";
  const player = document.getElementById("player");
  const canvas = player.querySelector("canvas");
  const part = (role) => player.querySelector(`[data-role=${role}]`);
  const colour = { contact: "#1f5fa8", messenger: "#5b6675", dropper: "#8b95a3", slack: "#d1661b",
                   pantograph: "#1d7a46", support: "#c3cad3", text: "#5b6675" };
  let film, time, playing = false, last = 0, bounds;

  const mix = (a, b, s) => a + (b - a) * s;
  // Interpolates two nested arrays of numbers; where their shapes differ the first one is shown.
  function between(a, b, s) {
    if (typeof a === "number") return typeof b === "number" ? mix(a, b, s) : a;
    if (!Array.isArray(a) || !Array.isArray(b) || a.length !== b.length) return a;
    return a.map((v, i) => between(v, b[i], s));
  }

  function pictureAt(t) {
    const frames = film.frames;
    let low = 0, high = frames.length - 1;
    while (high - low > 1) {
      const middle = (low + high) >> 1;
      if (frames[middle].time <= t) low = middle; else high = middle;
    }
    const a = frames[low], b = frames[high];
    const s = b.time > a.time ? Math.min(1, Math.max(0, (t - a.time) / (b.time - a.time))) : 0;
    return { contact: between(a.contact_wire, b.contact_wire, s), messenger: between(a.messenger_wire, b.messenger_wire, s),
             further: between(a.further_wires || [], b.further_wires || [], s),
             droppers: between(a.droppers, b.droppers, s), slack: (s < 0.5 ? a : b).droppers.map((d) => d[4] > 0),
             pantographs: between(a.pantographs, b.pantographs, s), forces: between(a.forces, b.forces, s),
             contacts: between(a.contacts, b.contacts, s) };
  }

  function choose(index) {
    film = films[index];
    bounds = { x0: Infinity, x1: -Infinity, low: Infinity, top: -Infinity };
    for (const frame of film.frames) {
      for (const [x, z] of frame.contact_wire) {
        bounds.x0 = Math.min(bounds.x0, x); bounds.x1 = Math.max(bounds.x1, x);
        bounds.low = Math.min(bounds.low, z); bounds.top = Math.max(bounds.top, z);
      }
      for (const [, z] of frame.messenger_wire) bounds.top = Math.max(bounds.top, z);
      for (const [, wire] of frame.further_wires || []) for (const [x, z] of wire) {
        bounds.x0 = Math.min(bounds.x0, x); bounds.x1 = Math.max(bounds.x1, x);
        bounds.low = Math.min(bounds.low, z); bounds.top = Math.max(bounds.top, z);
      }
    }
    time = film.frames[0].time;
    draw();
  }

  function stripCentre(polylines) {
    const strip = polylines && polylines[0];
    if (!strip || !strip.length) return null;
    const sum = strip.reduce((a, p) => [a[0] + p[0], a[1] + p[1]], [0, 0]);
    return [sum[0] / strip.length, sum[1] / strip.length];
  }

  function draw() {
    const ratio = window.devicePixelRatio || 1;
    const width = canvas.clientWidth, height = canvas.clientHeight;
    if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
    if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);

    const picture = pictureAt(time);
    const lead = stripCentre(picture.pantographs[0]);
    const left = 42, right = 8, top = 22, bottom = 26;
    const whole = bounds.x1 - bounds.x0;
    const span = Math.min(Number(part("view").value) || whole, whole);
    let x0 = (lead ? lead[0] : bounds.x0 + whole / 2) - span / 2;
    x0 = Math.max(bounds.x0, Math.min(bounds.x1 - span, x0));
    const perX = (width - left - right) / span;
    // The lower third is for the pantograph.
    const room = height - top - bottom;
    const fit = 0.66 * room / Math.max(bounds.top - bounds.low, 0.05) / perX;
    const exaggeration = Number(part("exaggeration").value) || fit;
    const perZ = perX * exaggeration;
    const zTop = exaggeration === fit ? bounds.top : bounds.low + Math.min(bounds.top - bounds.low, 0.66 * room / perZ);
    const X = (x) => left + (x - x0) * perX;
    const Z = (z) => top + (zTop - z) * perZ;

    g.font = "12px system-ui, sans-serif"; g.fillStyle = colour.text; g.lineWidth = 1;
    // Scale of heights.
    let step = 0.01;
    for (const nice of [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20]) { step = nice; if (nice * perZ >= 34) break; }
    g.textAlign = "right"; g.textBaseline = "middle"; g.strokeStyle = "#edf0f3";
    for (let n = Math.ceil((zTop - (height - top - bottom) / perZ) / step); n * step <= zTop + (top - 8) / perZ; n++) {
      const y = Z(n * step);
      g.beginPath(); g.moveTo(left, y); g.lineTo(width - right, y); g.stroke();
      g.fillText((n * step).toFixed(step < 0.1 ? 2 : 1), left - 6, y);
    }
    g.save();
    g.beginPath(); g.rect(left, 0, width - left - right, height - bottom + 1); g.clip();
    // Supports.
    g.strokeStyle = colour.support; g.lineWidth = 2;
    film.supports.forEach((x) => { g.beginPath(); g.moveTo(X(x), top - 4); g.lineTo(X(x), height - bottom); g.stroke(); });

    const stroke = (points, style, lineWidth, dash) => {
      if (!points.length) return;
      g.strokeStyle = style; g.lineWidth = lineWidth; g.setLineDash(dash || []);
      g.beginPath(); points.forEach(([x, z], i) => (i ? g.lineTo(X(x), Z(z)) : g.moveTo(X(x), Z(z)))); g.stroke();
      g.setLineDash([]);
    };
    picture.droppers.forEach(([xa, za, xb, zb], i) =>
      stroke([[xa, za], [xb, zb]], picture.slack[i] ? colour.slack : colour.dropper, picture.slack[i] ? 2.5 : 1.2, picture.slack[i] ? [4, 3] : []));
    stroke(picture.messenger, colour.messenger, 1.6);
    picture.further.forEach(([contact, wire]) => stroke(wire, contact ? colour.contact : colour.messenger, contact ? 2 : 1.3));
    stroke(picture.contact, colour.contact, 2);
    picture.pantographs.forEach((polylines) => polylines.forEach((line, i) => {
      if (i === 0) {
        // A strip seen from the side is a point or a short line: mark it.
        const centre = stripCentre([line]);
        if (centre) { g.fillStyle = colour.pantograph; g.fillRect(X(centre[0]) - 7, Z(centre[1]), 14, 4); }
      }
      stroke(line, colour.pantograph, 2);
    }));
    g.restore();
    // Supports by number, below.
    g.fillStyle = colour.text; g.textAlign = "center"; g.textBaseline = "top";
    let free = -Infinity;
    film.supports.forEach((x, i) => {
      const at = X(x), text = `${i + 1}: ${x.toFixed(0)} m`, half = g.measureText(text).width / 2 + 5;
      if (at - half < left - 8 || at + half > width || at - half < free) return;
      g.fillText(text, at, height - bottom + 6); free = at + half;
    });
    g.textAlign = "left"; g.fillText("m", 6, 6);
    g.textAlign = "right"; g.fillText(`heights ${exaggeration < 10 ? exaggeration.toFixed(1) : exaggeration.toFixed(0)}×`, width - right, 4);

    const forces = picture.forces.map((f, i) => {
      const x = picture.contacts[i];
      const name = picture.forces.length > 1 ? `pantograph ${i + 1}: ` : "";
      return `${name}${typeof x === "number" ? `x = ${x.toFixed(1)} m, ` : ""}contact force ${f === null ? "–" : f.toFixed(0)} N`;
    });
    part("readout").textContent = [`t = ${time.toFixed(2)} s`, ...forces].join(" · ") +
      ` · slack droppers ${picture.slack.filter(Boolean).length}`;
    const first = film.frames[0].time, end = film.frames[film.frames.length - 1].time;
    part("time").value = end > first ? Math.round(1000 * (time - first) / (end - first)) : 0;
  }

  function tick(now) {
    if (!playing) return;
    const end = film.frames[film.frames.length - 1].time;
    time = Math.min(end, time + Math.min(0.1, (now - last) / 1000) * Number(part("speed").value));
    last = now;
    draw();
    if (time >= end) return play(false);
    requestAnimationFrame(tick);
  }

  function play(on) {
    const first = film.frames[0].time, end = film.frames[film.frames.length - 1].time;
    if (on && time >= end) time = first;
    playing = on;
    part("play").textContent = on ? "Pause" : "Play";
    if (on) { last = performance.now(); requestAnimationFrame(tick); }
  }

  part("play").addEventListener("click", () => play(!playing));
  part("time").addEventListener("input", (event) => {
    const first = film.frames[0].time, end = film.frames[film.frames.length - 1].time;
    time = mix(first, end, Number(event.target.value) / 1000);
    draw();
  });
  part("run").addEventListener("change", (event) => { play(false); choose(Number(event.target.value)); });
  ["exaggeration", "view"].forEach((role) => part(role).addEventListener("change", draw));
  window.addEventListener("resize", draw);
  choose(0);
});
