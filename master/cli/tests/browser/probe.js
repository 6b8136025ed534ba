// Looks at a page in frames of several widths: what went wrong, what was drawn, what its buttons do.
(async () => {
  const wait = (ms) => new Promise((done) => setTimeout(done, ms));
  const until = async (true_) => { for (let n = 0; n < 400 && !true_(); n += 1) await wait(25); return true_(); };
  const look = async (width) => {
    const frame = document.createElement("iframe");
    frame.style.cssText = `width:${width}px;height:900px;border:0`;
    frame.src = "page.html";
    const loaded = new Promise((done) => frame.addEventListener("load", done));
    document.body.append(frame);
    await loaded;
    const page = frame.contentWindow;
    const root = page.document.documentElement;
    const figures = [...page.document.querySelectorAll(".plot")];
    if (figures.length > 0) await until(() => root.dataset.figures);
    await wait(50);
    // A curve, a mark or a cell of a map.
    const drawn = (box) => box.querySelector("path.js-line, path.point, g.point path, .hm image, .gl-canvas-context") !== null;
    const wide = [...page.document.querySelectorAll("main *")]
      .filter((part) => !part.closest(".scroll, .track, pre, .plot, svg") && part.getBoundingClientRect().right > width + 1);
    // Buttons that a grid has stretched, and names of axes beyond their figure.
    const box = (part) => part.getBoundingClientRect();
    const stretched = [...page.document.querySelectorAll(".tools button")].filter((button) => box(button).height > 60);
    const beyond = [...page.document.querySelectorAll(".plot .axis-title")]
      .filter((title) => box(title).top < box(title.closest(".plot")).top);
    const nameless = figures.filter((figure) => !figure.getAttribute("aria-label").includes(" "));
    const seen = {
      width,
      errors: page.errors,
      figures: figures.length,
      undrawn: figures.filter((box) => !drawn(box)).map((box) => box.id),
      overflow: root.scrollWidth > root.clientWidth ? root.scrollWidth - root.clientWidth : 0,
      wide: wide.slice(0, 3).map((part) => `${part.tagName} ${part.className}`),
      stretched: stretched.map((button) => button.getAttribute("aria-label")),
      beyond: beyond.map((title) => title.textContent),
      nameless: nameless.map((figure) => figure.id),
      buttons: 0,
      idle: [],
    };
    for (const button of page.document.querySelectorAll(".tools button")) {
      seen.buttons += 1;
      const before = page.saved.length;
      button.click();
      await until(() => page.saved.length > before);
      const file = page.saved[before];
      const whole = file && file.name && (file.size > 20 || file.size < 0);
      if (!whole) seen.idle.push(button.getAttribute("aria-label"));
    }
    const play = page.document.querySelector("[data-role=play]");
    if (play) {
      seen.buttons += 1;
      const readout = page.document.querySelector("[data-role=readout]");
      await until(() => readout.textContent !== "");
      // Pictures are drawn by a clock that stands still in a browser without a screen: the slider moves it.
      const [label, before] = [play.textContent, readout.textContent];
      play.click();
      if (play.textContent === label) seen.idle.push("Play");
      const slider = page.document.querySelector("[data-role=time]");
      slider.value = 700;
      slider.dispatchEvent(new page.Event("input"));
      if (!(await until(() => readout.textContent !== before))) seen.idle.push("Time");
    }
    frame.remove();
    return seen;
  };
  const all = [];
  for (const width of WIDTHS) all.push(await look(width));
  document.getElementById("seen").textContent = JSON.stringify(all);
})();
