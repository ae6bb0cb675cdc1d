// The picture of the bodies: axes with one scale, what stands still, ghosts, and the bodies at a time.
"use strict";

/** Room for the numbers at the axes, in pixels. */
saltus.bodiesMargin = {l: 46, r: 12, t: 8, b: 24};

/** Height that the picture may take: most of the first screen, so that the times below it are still seen. */
saltus.tallestBodies = () => Math.min(640, Math.max(300, 0.62 * window.innerHeight));

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

/** What moves beside what stands still: their numbers, and the colours of all shapes. */
saltus.bodiesLooks = (shapes, trajectory) => {
  const still = shapes.map((_, i) => saltus.standsStill(shapes, trajectory, i));
  const colours = () => {
    const {curves, quiet} = saltus.palette();
    let next = 0;
    return still.map((stands) => (stands ? quiet : curves[next++ % curves.length]));
  };
  return {still, colours};
};

/**
 * The picture of the bodies: `show(time)` moves them, `draw(time, width)` makes all of it for the present width and theme.
 * @param settings  ghosts: drawn at all; trail: those up to the time only; follow: the picture goes with what moves
 */
saltus.bodiesScene = (result, settings) => {
  const {shapes, trajectory} = result;
  const svg = saltus.svgElement("svg", {class: "bodies", role: "img"});
  const all = saltus.bodiesBox(shapes, trajectory);
  const {still, colours} = saltus.bodiesLooks(shapes, trajectory);
  const window_ = saltus.followBox(shapes, trajectory, still, all);
  const times = saltus.strobeTimes(trajectory);
  const clip = `bodies-${Math.random().toString(36).slice(2)}`;
  let width = 0;
  let parts = null;
  const placed = (time, moves) => saltus.placedShapes(shapes, saltus.bodiesAt(trajectory, time))
                                      .filter(({index}) => still[index] !== moves);
  const boxAt = (time) => (settings.follow && window_ !== null ? window_(placed(time, true)) : all);
  const elements = (time, moves, opacity) => saltus.shapeElements(placed(time, moves), parts.picture, colours(), opacity);
  const ghosts = () => times.map((moment, i) => {
    const opacity = 0.18 + (0.32 * i) / Math.max(1, times.length - 1);
    return saltus.svgElement("g", {class: "ghost", "data-t": moment}, ...elements(moment, true, opacity));
  });
  const fill = (time) => {
    const box = boxAt(time);
    const palette = saltus.palette();
    const {l, r, t, b} = saltus.bodiesMargin;
    parts.picture = saltus.bodiesPicture(box, width - l - r, saltus.tallestBodies());
    const {width: wide, height: tall} = parts.picture;
    const whole = [wide + l + r, tall + t + b];
    for (const [name, value] of [["width", whole[0]], ["height", whole[1]], ["viewBox", `0 0 ${whole.join(" ")}`]])
      svg.setAttribute(name, value);
    const area = {x: 0, y: 0, width: wide, height: tall};
    const inside = saltus.svgElement("g", {class: "inside", "clip-path": `url(#${clip})`});
    inside.append(...elements(trajectory.t[0], false, 1), parts.strobe, parts.moving);
    const cut = saltus.svgElement("clipPath", {id: clip});
    cut.append(saltus.svgElement("rect", area));
    parts.strobe.replaceChildren(...ghosts());
    const group = saltus.svgElement("g", {transform: `translate(${l},${t})`});
    group.append(
        cut, saltus.svgElement("rect", {...area, fill: palette.panel, stroke: palette.axis}),
        ...saltus.bodiesAxes(box, parts.picture, palette), inside);
    svg.replaceChildren(group);
  };
  const show = (time) => {
    if (settings.follow && window_ !== null) fill(time);
    parts.moving.replaceChildren(...elements(time, true, 1));
    for (const ghost of parts.strobe.children)
      ghost.setAttribute("display", settings.ghosts && !(settings.trail && Number(ghost.dataset.t) > time) ? "inline" : "none");
    svg.setAttribute("aria-label", `bodies at t = ${saltus.brief(time, 6)}`);
  };
  const draw = (time, wide) => {
    width = wide;
    parts = {
      moving: saltus.svgElement("g", {class: "moving"}),
      strobe: saltus.svgElement("g", {class: "strobe"}),
      picture: null,
    };
    fill(time);
    show(time);
  };
  return {element: svg, draw, show, follows: window_ !== null};
};
