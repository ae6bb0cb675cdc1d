// A picture of a sweep: frame, axes, marks of runs, and zooming.
"use strict";

saltus.pictureSize = {height: 340, right: 20, top: 12, bottom: 46};
/** More marks than this have no text of their own that appears under the pointer; a click says all. */
saltus.mostTitles = 4000;

/** Frame, ticks and names of axes; `x(value)` and `y(value)` are places of values, `inside` is what is clipped. */
saltus.pictureFrame = (title, width, names, [across, up]) => {
  const {height, right, top, bottom} = saltus.pictureSize;
  const palette = saltus.palette();
  const ticks = [across.ticks(across.low, across.high), up.ticks(up.low, up.high)];
  // Words need more room than numbers.
  const left = Math.max(70, ...ticks[1].map(([, label]) => 22 + 7.5 * String(label).length));
  const area = {x: left, y: top, width: width - left - right, height: height - top - bottom};
  const placeX = (place) => left + ((place - across.low) / (across.high - across.low)) * area.width;
  const placeY = (place) => top + area.height - ((place - up.low) / (up.high - up.low)) * area.height;
  const text = (x, y, anchor, content, more = {}) => saltus.svgElement(
      "text", {x, y, "text-anchor": anchor, fill: palette.text, "font-size": 12, "font-family": "system-ui, sans-serif", ...more},
      content);
  const line = (x1, y1, x2, y2) => saltus.svgElement("line", {x1, y1, x2, y2, stroke: palette.grid});
  const foot = top + area.height;
  const clip = `clip-${Math.random().toString(36).slice(2)}`;
  const inside = saltus.svgElement("g", {"clip-path": `url(#${clip})`});
  const svg = saltus.svgElement("svg", {
    viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": title, tabindex: "0", class: "sweep-picture",
  });
  svg.append(
      saltus.svgElement("clipPath", {id: clip}, saltus.svgElement("rect", area)),
      ...ticks[0].map(([place]) => line(placeX(place), top, placeX(place), foot)),
      ...ticks[1].map(([place]) => line(left, placeY(place), left + area.width, placeY(place))),
      saltus.svgElement("rect", {...area, fill: "none", stroke: palette.axis}),
      ...ticks[0].map(([place, label]) => text(placeX(place), foot + 16, "middle", label)),
      ...ticks[1].map(([place, label]) => text(left - 6, placeY(place) + 4, "end", label)),
      text(left + area.width / 2, height - 8, "middle", names[0]),
      // Words say themselves what they are.
      ...(up.words ? [] : [text(14, height / 2, "middle", names[1], {transform: `rotate(-90 14 ${height / 2})`})]), inside);
  return {
    svg,
    inside,
    area,
    placeX,
    placeY,
    axes: [across, up],
    x: (value) => placeX(across.at(value)),
    y: (value) => placeY(up.at(value)),
  };
};

/** A mark of a run: a click on it chooses the run. */
saltus.runMark = (table, row, shape, attributes, label) => {
  const mark = saltus.svgElement(shape, {...attributes, "data-run": table.columns.run[row], "data-row": row});
  if (label !== null) mark.append(saltus.svgElement("title", {}, label + saltus.runNote(table, row)));
  return mark;
};

/** A run that stopped early, at a place where it has no value. */
saltus.stoppedMark = (table, row, x, y, label) => saltus.runMark(table, row, "path", {
  d: `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`, fill: "none", stroke: saltus.palette().text, "stroke-width": 1.5, class: "run stopped",
}, `${label}, stopped early`);

/** A run whose solution is not unique. */
saltus.alarmMark = (x, y) => saltus.svgElement("path", {
  d: `M${x - 5} ${y - 5}l10 10m0 -10l-10 10`, fill: "none", stroke: saltus.palette().alarm, "stroke-width": 2, class: "alarm",
});

/** Zooms by dragging, moves with Shift, shows all again by a double click; keys as in the drawings over time. */
saltus.zooms = ({svg, area, axes}, show, choose) => {
  const changed = (parts) => (parts === null || parts.every(saltus.isDrawable)) && show(parts);
  const point = (event) => {
    const box = svg.getBoundingClientRect();
    const scale = svg.viewBox.baseVal.width / box.width;
    return [(event.clientX - box.left) * scale, (event.clientY - box.top) * scale];
  };
  const values = ([px, py]) => [
    axes[0].low + ((px - area.x) / area.width) * (axes[0].high - axes[0].low),
    axes[1].low + ((area.y + area.height - py) / area.height) * (axes[1].high - axes[1].low),
  ];
  const ranges = () => axes.map(({low, high}) => [low, high]);
  const moved = (shares, scale) => changed(ranges().map(([low, high], k) => {
    const [middle, half] = [(low + high) / 2 + shares[k] * (high - low), (scale * (high - low)) / 2];
    return [middle - half, middle + half];
  }));
  const keys = {
    ArrowLeft: () => moved([-0.2, 0], 1), ArrowRight: () => moved([0.2, 0], 1), ArrowUp: () => moved([0, 0.2], 1),
    ArrowDown: () => moved([0, -0.2], 1), "+": () => moved([0, 0], 0.5), "-": () => moved([0, 0], 2), 0: () => changed(null),
  };
  svg.addEventListener("keydown", (event) => {
    if (keys[event.key] === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });
  let from = null;
  const frame = saltus.svgElement("rect", {fill: saltus.palette().select, "fill-opacity": 0.15, "pointer-events": "none"});
  svg.addEventListener("pointerdown", (event) => {
    if (event.button === 0) from = point(event);
  });
  svg.addEventListener("pointermove", (event) => {
    if (from === null || event.shiftKey || event.buttons === 0) return;
    const to = point(event);
    const [x, y] = [Math.min(from[0], to[0]), Math.min(from[1], to[1])];
    for (const [name, value] of [["x", x], ["y", y], ["width", Math.abs(to[0] - from[0])], ["height", Math.abs(to[1] - from[1])]])
      frame.setAttribute(name, value);
    svg.append(frame);
    event.preventDefault();
  });
  svg.addEventListener("pointerup", (event) => {
    if (from === null) return;
    const to = point(event);
    const [start, end] = [values(from), values(to)];
    const far = Math.hypot(to[0] - from[0], to[1] - from[1]);
    from = null;
    frame.remove();
    if (far < 6) return;
    if (event.shiftKey) return changed(ranges().map((range, k) => range.map((value) => value + start[k] - end[k])));
    changed([0, 1].map((k) => {
      // A drag along one axis zooms that one only.
      const pair = [Math.min(start[k], end[k]), Math.max(start[k], end[k])];
      const [low, high] = ranges()[k];
      return pair[1] - pair[0] < 0.02 * (high - low) ? [low, high] : pair;
    }));
  });
  svg.addEventListener("pointerleave", () => {
    from = null;
    frame.remove();
  });
  svg.addEventListener("dblclick", () => changed(null));
  svg.addEventListener("click", (event) => {
    const mark = event.target.closest("[data-row]");
    if (mark !== null) choose(Number(mark.dataset.row));
  });
};
