// Phases of contacts over time, and what their colours mean.
"use strict";

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
