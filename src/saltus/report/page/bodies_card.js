// The card of bodies and contacts: the bodies at a time that a slider sets, a strobe behind them, phases of contacts.
"use strict";

saltus.tallestBodies = 420;
/** Room for the numbers at the axes, in pixels. */
saltus.bodiesMargin = {l: 46, r: 12, t: 8, b: 24};
/** Seconds that playing all of it takes: what is shorter is slowed down, what is longer is sped up. */
saltus.playSeconds = [3, 20];
/** What is not deeper than this is a rounding. */
saltus.roundingDepth = 1e-12;

saltus.shapeElements = (placed, picture, colours, opacity) => placed.map(({index, kind, points, radius}) => {
  const stroke = colours[index % colours.length];
  if (kind === "disc") {
    const [x, y] = points[0];
    return saltus.svgElement("circle", {
      cx: picture.x(x), cy: picture.y(y), r: Math.max(1, picture.scale * radius), stroke, fill: stroke,
      "fill-opacity": 0.25 * opacity, "stroke-opacity": opacity, "stroke-width": 1.8,
    });
  }
  const list = points.map(([x, y]) => `${picture.x(x)},${picture.y(y)}`).join(" ");
  return saltus.svgElement("polyline", {
    points: list, fill: "none", stroke, "stroke-opacity": opacity, "stroke-width": 3, "stroke-linecap": "round",
    "stroke-linejoin": "round",
  });
});

/** Axes with one scale: lines of the grid and their numbers. */
saltus.bodiesAxes = (box, picture, palette) => {
  const parts = [];
  const line = (x1, y1, x2, y2) =>
      parts.push(saltus.svgElement("line", {x1, y1, x2, y2, stroke: palette.grid, "stroke-width": 1}));
  const label = (x, y, anchor, text) => {
    const element = saltus.svgElement(
        "text", {x, y, fill: palette.quiet, "text-anchor": anchor, "font-size": 11, "font-family": "system-ui, sans-serif"});
    element.textContent = text;
    parts.push(element);
  };
  for (const tick of saltus.roundTicks(box[0], Math.max(2, Math.floor(picture.width / 80)))) {
    line(picture.x(tick), 0, picture.x(tick), picture.height);
    label(picture.x(tick), picture.height + 15, "middle", saltus.brief(tick, 6));
  }
  for (const tick of saltus.roundTicks(box[1], Math.max(2, Math.floor(picture.height / 45)))) {
    line(0, picture.y(tick), picture.width, picture.y(tick));
    label(-6, picture.y(tick) + 4, "end", saltus.brief(tick, 6));
  }
  return parts;
};

/** The picture of the bodies: `show(time)` moves them, `draw()` makes all of it for the present width and theme. */
saltus.bodiesScene = (result) => {
  const {shapes, trajectory} = result;
  const svg = saltus.svgElement("svg", {class: "bodies", role: "img"});
  const box = saltus.bodiesBox(shapes, trajectory);
  const still = shapes.map((_, i) => saltus.standsStill(shapes, trajectory, i));
  let picture = null;
  let moving = null;
  const at = (time) => saltus.placedShapes(shapes, saltus.bodiesAt(trajectory, time));
  const colours = () => {
    const {curves, quiet} = saltus.palette();
    let next = 0;
    return still.map((stands) => (stands ? quiet : curves[next++ % curves.length]));
  };
  const show = (time) => {
    moving.replaceChildren(...saltus.shapeElements(at(time).filter(({index}) => !still[index]), picture, colours(), 1));
    svg.setAttribute("aria-label", `bodies at t = ${saltus.brief(time, 6)}`);
  };
  const draw = (time, width) => {
    const margin = saltus.bodiesMargin;
    picture = saltus.bodiesPicture(box, width - margin.l - margin.r, saltus.tallestBodies);
    const palette = saltus.palette();
    const whole = [picture.width + margin.l + margin.r, picture.height + margin.t + margin.b];
    for (const [name, value] of [["width", whole[0]], ["height", whole[1]], ["viewBox", `0 0 ${whole.join(" ")}`]])
      svg.setAttribute(name, value);
    const group = saltus.svgElement("g", {transform: `translate(${margin.l},${margin.t})`});
    const back = saltus.svgElement(
        "rect", {x: 0, y: 0, width: picture.width, height: picture.height, fill: palette.panel, stroke: palette.axis});
    moving = saltus.svgElement("g", {class: "moving"});
    const strobe = saltus.svgElement("g", {class: "strobe"});
    const times = saltus.strobeTimes(trajectory);
    times.forEach((moment, i) => {
      const opacity = 0.18 + (0.32 * i) / Math.max(1, times.length - 1);
      strobe.append(...saltus.shapeElements(at(moment).filter(({index}) => !still[index]), picture, colours(), opacity));
    });
    const fixed = saltus.shapeElements(at(trajectory.t[0]).filter(({index}) => still[index]), picture, colours(), 1);
    group.append(back, ...saltus.bodiesAxes(box, picture, palette), ...fixed, strobe, moving);
    svg.replaceChildren(group);
    show(time);
  };
  return {element: svg, draw, show};
};

/** Phases of contacts over time, a row for each, and a line at the time of the slider. */
saltus.contactStrip = (result) => {
  const {contacts, trajectory} = result;
  const [from, to] = [trajectory.t[0], trajectory.t.at(-1)];
  const svg = saltus.svgElement("svg", {class: "contact-strip", role: "img", "aria-label": "phases of contacts over time"});
  const rowHeight = 16;
  let cursor = null;
  let place = null;
  const colours = (palette) => ({closed: palette.minus, stick: palette.minus, slip: palette.sliding});
  const row = (name, {edges, values}, i, palette, label) => {
    const y = i * rowHeight;
    const text = saltus.svgElement(
        "text", {x: label - 6, y: y + 12, fill: palette.text, "text-anchor": "end", "font-size": 11,
                 "font-family": "system-ui, sans-serif"});
    text.textContent = saltus.shorten(name, 16);
    const middle = y + rowHeight / 2;
    const base = saltus.svgElement(
        "line", {x1: place(from), x2: place(to), y1: middle, y2: middle, stroke: palette.axis, "stroke-width": 1});
    const closed = values.flatMap((mode, k) => (mode === "open" ? [] : [{mode, from: edges[k], to: edges[k + 1]}]));
    const boxes = closed.map((phase) => {
      const x = place(phase.from);
      const fill = colours(palette)[phase.mode] ?? palette.quiet;
      const box = saltus.svgElement("rect", {x, y: y + 2, width: Math.max(1, place(phase.to) - x), height: rowHeight - 4, fill});
      const title = saltus.svgElement("title", {});
      title.textContent = `${name} ${saltus.contactWord(phase.mode)}, t = ${saltus.brief(phase.from)} … ${saltus.brief(phase.to)}`;
      box.append(title);
      return box;
    });
    return [text, base, ...boxes];
  };
  const show = (time) => {
    if (cursor === null) return;
    for (const end of ["x1", "x2"]) cursor.setAttribute(end, place(time));
  };
  const draw = (time, width) => {
    const palette = saltus.palette();
    const label = Math.min(120, 12 + 7 * contacts.reduce((most, name) => Math.max(most, Math.min(16, name.length)), 0));
    place = (t) => label + ((width - label - 8) * (t - from)) / (to - from || 1);
    const height = contacts.length * rowHeight;
    for (const [name, value] of [["width", width], ["height", height], ["viewBox", `0 0 ${width} ${height}`]])
      svg.setAttribute(name, value);
    cursor = saltus.svgElement("line", {y1: 0, y2: height, stroke: palette.text, "stroke-width": 1, "stroke-dasharray": "3 2"});
    svg.replaceChildren(
        ...contacts.flatMap((name, i) => row(name, trajectory.contact_modes[i], i, palette, label)), cursor);
    show(time);
  };
  return {element: svg, draw, show};
};

saltus.contactLegend = (result) => {
  const used = new Set(result.trajectory.contact_modes.flatMap(({values}) => values));
  return ["closed", "stick", "slip"].filter((mode) => used.has(mode)).map(
      (mode) => saltus.element(
          "span", {class: "swatch"}, saltus.element("i", {class: `mode contact-${mode}`}), saltus.contactWord(mode)));
};

/** Play and pause, the slider and its time; `show(time)` after every change. */
saltus.timeSlider = (trajectory, show) => {
  const [from, to] = [trajectory.t[0], trajectory.t.at(-1)];
  const steps = 1000;
  let time = from;
  let playing = null;
  const reading = saltus.element("span", {class: "digits slider-time"});
  const slider = saltus.element(
      "input", {type: "range", min: "0", max: String(steps), value: "0", class: "grow", "aria-label": "time",
                oninput: (event) => set(from + ((to - from) * Number(event.target.value)) / steps)});
  const set = (next) => {
    time = next;
    slider.value = String(Math.round((steps * (time - from)) / (to - from || 1)));
    reading.textContent = `t = ${saltus.brief(time, 5)}`;
    slider.setAttribute("aria-valuetext", reading.textContent);
    show(time);
  };
  const seconds = Math.min(Math.max(to - from, saltus.playSeconds[0]), saltus.playSeconds[1]);
  const stop = () => {
    cancelAnimationFrame(playing);
    playing = null;
    button.textContent = "play";
  };
  const play = () => {
    const start = performance.now() - (time < to ? (1000 * seconds * (time - from)) / (to - from || 1) : 0);
    const step = (now) => {
      const next = from + (Math.max(0, now - start) / (1000 * seconds)) * (to - from);
      set(Math.min(next, to));
      if (next >= to) return stop();
      playing = requestAnimationFrame(step);
      return playing;
    };
    button.textContent = "pause";
    playing = requestAnimationFrame(step);
  };
  const button = saltus.element("button", {onclick: () => (playing === null ? play() : stop())}, "play");
  const factor = (to - from) / seconds;
  const speed = Math.abs(factor - 1) < 1e-9 ? "" : `played at ${saltus.brief(factor, 2)} times its speed`;
  const element = saltus.element(
      "div", {class: "slider controls"}, button, slider, reading, saltus.element("span", {class: "quiet"}, speed));
  return {element, set, time: () => time};
};

/** The card of a mechanical system; null if nothing is drawn and nothing touches. */
saltus.bodiesCard = (result, timeline) => {
  const {shapes, contacts, trajectory, penetration} = result;
  if (trajectory.t.length === 0 || (shapes.length === 0 && contacts.length === 0)) return null;
  const parts = [
    ...(shapes.length > 0 ? [saltus.bodiesScene(result)] : []), ...(contacts.length > 0 ? [saltus.contactStrip(result)] : [])
  ];
  const holder = saltus.element("div", {class: "bodies-holder"}, ...parts.map((part) => part.element));
  const slider = saltus.timeSlider(trajectory, (time) => parts.forEach((part) => part.show(time)));
  const save = () => {
    const [svg] = holder.getElementsByTagName("svg");
    const text = new XMLSerializer().serializeToString(svg);
    saltus.saveText(saltus.fileName(result, "-bodies.svg"), text, "image/svg+xml");
  };
  const deepest = !(penetration > saltus.roundingDepth) ? [] :
      [`Bodies are at most ${saltus.brief(penetration, 2)} deep in each other.`];
  const note = [
    ...(shapes.length > 0 ? ["Both axes have one scale. Faint: the bodies at times of equal distance, later ones darker."] : []),
    ...deepest,
  ];
  const element = saltus.element(
      "section", {class: "card bodies-card"},
      saltus.element(
          "header", {}, saltus.element("h2", {}, shapes.length > 0 ? "Bodies" : "Contacts"), ...saltus.contactLegend(result),
          saltus.element("span", {class: "grow"}),
          saltus.element("button", {class: "save", title: "save the picture as SVG", onclick: save}, "SVG")),
      holder, slider.element, saltus.element("p", {class: "quiet note"}, note.join(" ")));
  let flagged = null;
  const draw = () => {
    const width = Math.max(200, holder.clientWidth);
    parts.forEach((part) => part.draw(slider.time(), width));
    const selected = timeline.selected();
    if (selected !== null && selected !== flagged) slider.set(result.events[selected].t);
    flagged = selected;
  };
  const start = () => {
    draw();
    slider.set(slider.time());
  };
  return {element, draw, start};
};
