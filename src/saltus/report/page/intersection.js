// Decisions where two surfaces meet: the square of the selections with g1 = 0, g2 = 0 and the hidden dynamics in it
// (Figs. 11 to 13 of Guglielmi & Hairer 2022).
"use strict";

/** The normal components at selections (a, b): bilinear in them. */
saltus.normalComponents = ({velocities}, [a, b]) =>
    velocities.map((v) => (1 - a) * (1 - b) * v[0] + a * (1 - b) * v[1] + (1 - a) * b * v[2] + a * b * v[3]);

saltus.clampUnit = (value) => Math.min(1, Math.max(0, value));

/** Where g_j = 0 in the closed unit square: pieces [[a, …], [b, …]], one for each branch of the hyperbola. */
saltus.zeroCurve = (v, points = 400) => {
  const [c, ca, cb] = [v[0], v[1] - v[0], v[2] - v[0]];
  const cab = v[0] - v[1] - v[2] + v[3];
  const inside = (value) => value >= 0 && value <= 1;
  const pieces = [];
  // Solved for one selection over the other, both ways: steep parts of one are flat parts of the other.
  for (const swapped of [false, true]) {
    const [c1, c2] = swapped ? [cb, ca] : [ca, cb];
    let piece = null;
    for (let k = 0; k <= points; k += 1) {
      const b = k / points;
      const slope = c1 + cab * b;
      const a = slope === 0 ? NaN : -(c + c2 * b) / slope;
      if (!inside(a)) {
        piece = null;
        continue;
      }
      const point = swapped ? [b, a] : [a, b];
      const last = piece === null ? null : [piece[0].at(-1), piece[1].at(-1)];
      // Two branches are not joined across their pole.
      if (last === null || Math.hypot(point[0] - last[0], point[1] - last[1]) > 0.5) {
        piece = [[], []];
        pieces.push(piece);
      }
      piece[0].push(point[0]);
      piece[1].push(point[1]);
    }
  }
  return pieces.filter((piece) => piece[0].length > 1);
};

/**
 * The hidden dynamics u_j' = w_j g_j(pi(u)) / max |g_j|, pi(u) = min(max(u, 0), 1), from a start until it leaves
 * `reach` around the square or stands still: Runge-Kutta steps of at most 1/200 of the square, points as far apart.
 */
saltus.hiddenPath = (meeting, start, weights = [1, 1], reach = 0.25) => {
  const h = 5e-3;
  const steps = 6000 / Math.min(...weights);
  const speed = meeting.velocities.map((v, j) => weights[j] / (Math.max(...v.map(Math.abs)) || 1));
  const slope = (u) => saltus.normalComponents(meeting, u.map(saltus.clampUnit)).map((value, j) => value * speed[j]);
  const path = [[start[0]], [start[1]]];
  let u = start;
  for (let n = 0; n < steps; n += 1) {
    const move = (k, s) => u.map((value, j) => value + s * k[j]);
    const k1 = slope(u);
    if (Math.hypot(...k1) < 1e-7) break;
    const k2 = slope(move(k1, h / 2));
    const k3 = slope(move(k2, h / 2));
    const k4 = slope(move(k3, h));
    u = u.map((value, j) => value + (h / 6) * (k1[j] + 2 * k2[j] + 2 * k3[j] + k4[j]));
    const left = u.some((value) => value < -reach || value > 1 + reach);
    if (left || Math.hypot(u[0] - path[0].at(-1), u[1] - path[1].at(-1)) > h / 2) {
      path[0].push(u[0]);
      path[1].push(u[1]);
    }
    if (left) break;
  }
  return path;
};

/**
 * Where the hidden dynamics goes from a start: [k1, k2], 0 where a selection comes to rest or goes round; equal speeds.
 * Known once both have left the square for good, or one has and the other one is drawn to a zero of its component.
 */
saltus.hiddenOutcome = ({velocities}, [a0, b0]) => {
  const size = velocities.map((v) => Math.max(...v.map(Math.abs)) || 1);
  const terms = velocities.map(([v, va, vb, vab], j) => [v, va - v, vb - v, v - va - vb + vab].map((c) => c / size[j]));
  const [[p0, pa, pb, pab], [q0, qa, qb, qab]] = terms;
  const clamp = saltus.clampUnit;
  const g1 = (a, b) => p0 + pa * a + (pb + pab * a) * b;
  const g2 = (a, b) => q0 + qa * a + (qb + qab * a) * b;
  const beyond = (value) => (value > 1 ? 1 : value < 0 ? -1 : 0);
  // On the strip where one selection is saturated the other one is drawn to a zero from which the first goes on out.
  const drawnTo = (out, other, side, value) => {
    const [start, end] = [other(0), other(1)];
    if (!(start > 0 && end < 0)) return false;
    return side * out(value) > 0 && side * out(start / (start - end)) > 0;
  };
  let [u, w] = [a0, b0];
  for (let n = 0; n < 4000; n += 1) {
    const [i, k, a, b] = [beyond(u), beyond(w), clamp(u), clamp(w)];
    const [f1, f2] = [g1(a, b), g2(a, b)];
    if (i !== 0 && k !== 0 && i * f1 > 0 && k * f2 > 0) return [i, k];
    if (i !== 0 && k === 0 && drawnTo((s) => g1(a, s), (s) => g2(a, s), i, b)) return [i, 0];
    if (k !== 0 && i === 0 && drawnTo((s) => g2(s, b), (s) => g1(s, b), k, a)) return [0, k];
    const speed = Math.hypot(f1, f2);
    if (speed < 1e-6) return [0, 0];
    const h = 0.03;
    const [a1, b1] = [clamp(u + (h / 2) * f1), clamp(w + (h / 2) * f2)];
    const [e1, e2] = [g1(a1, b1), g2(a1, b1)];
    const [a2, b2] = [clamp(u + (h / 2) * e1), clamp(w + (h / 2) * e2)];
    const [c1, c2] = [g1(a2, b2), g2(a2, b2)];
    const [a3, b3] = [clamp(u + h * c1), clamp(w + h * c2)];
    u += (h / 6) * (f1 + 2 * (e1 + c1) + g1(a3, b3));
    w += (h / 6) * (f2 + 2 * (e2 + c2) + g2(a3, b3));
  }
  return [0, 0];
};

/**
 * The basins of the hidden dynamics over the square with a margin (Fig. 13): {axis, modes, parts}, parts[row][column]
 * a number in modes, which are those that occur. Null if there is only one.
 */
saltus.basins = (meeting, cells = 72, margin = 0.27) => {
  const axis = Array.from({length: cells}, (_, i) => -margin + ((1 + 2 * margin) * (i + 0.5)) / cells);
  const modes = [];
  const parts = axis.map((b) => axis.map((a) => {
    const mode = saltus.hiddenOutcome(meeting, [a, b]);
    const known = modes.findIndex((other) => other[0] === mode[0] && other[1] === mode[1]);
    return known >= 0 ? known : modes.push(mode) - 1;
  }));
  return modes.length > 1 ? {axis, modes, parts} : null;
};

/** Each basin as one trace: cells in a light colour. */
saltus.basinTraces =
    (basins, palette) =>
        basins.modes.map((mode, number) => ({
                           type: "heatmap",
                           x: basins.axis,
                           y: basins.axis,
                           z: basins.parts.map((row) => row.map((part) => (part === number ? 1 : null))),
                           name: `ends in (${
                               mode.map(
                                       (k) =>
                                           (k > 0     ? "+" :
                                                k < 0 ? "−" :
                                                        "0"))
                                   .join(" ")})`,
                           showscale: false,
                           showlegend: true,
                           hoverinfo: "name",
                           hoverongaps: false,
                           opacity: 0.3,
                           colorscale: [[0, palette.curves[(number + 1) % 6]], [1, palette.curves[(number + 1) % 6]]],
                         }));

/** How much faster the surface that was slid on is made in the second path. */
saltus.dominance = 30;

/** Weights to draw hidden dynamics with: equal ones; and where one surface was slid on, one that it dominates. */
saltus.hiddenWeights = ({alpha_before: before, surfaces}) => {
  const equal = {weights: [1, 1], name: "hidden dynamics", dash: "solid"};
  if (before === null) return [equal];
  const slid = before.map((alpha) => alpha > 0 && alpha < 1);
  if (slid[0] === slid[1]) return [equal];
  const active = slid[0] ? 0 : 1;
  const weights = [0, 1].map((j) => (j === active ? 1 : 1 / saltus.dominance));
  const name = `${saltus.dominance} times faster for ${saltus.shorten(surfaces[active], 18)}`;
  return [equal, {weights, name: saltus.plain(name), dash: "dash"}];
};

/** Starts of the hidden dynamics: where the solution comes from; at a start the corners of the square. */
saltus.hiddenStarts = ({alpha_before: before}) => (before === null ? [[0, 0], [1, 0], [0, 1], [1, 1]] : [before]);

saltus.intersectionTraces = (meeting, palette, basins = null) => {
  const line = ([x, y], name, style, more = {}) => ({
    type: "scatter",
    mode: "lines",
    x,
    y,
    name,
    hoverinfo: "skip",
    line: {simplify: false, ...style},
    ...more,
  });
  const point = ([x, y], name, marker) =>
      ({type: "scatter", mode: "markers", x: [x], y: [y], name, marker, cliponaxis: false});
  const zeros = meeting.velocities.flatMap(
      (v, j) => saltus.zeroCurve(v).map(
          (piece, n) => line(
              piece, saltus.plain(`${j === 0 ? "g₁" : "g₂"} = 0 (${saltus.shorten(meeting.surfaces[j], 18)})`),
              {color: palette.surfaces[j], width: 2}, {legendgroup: `g${j}`, showlegend: n === 0})));
  const paths = saltus.hiddenWeights(meeting).flatMap(
      ({weights, name, dash}) => saltus.hiddenStarts(meeting).map(
          (start, n) => line(
              saltus.hiddenPath(meeting, start, weights), name, {color: palette.curves[0], width: 1.8, dash},
              {legendgroup: name, showlegend: n === 0})));
  const before = meeting.alpha_before === null ? [] : [
    point(meeting.alpha_before, "comes from", {symbol: "circle-open", size: 11, color: palette.text, line: {width: 2}})
  ];
  return [
    ...(basins === null ? [] : saltus.basinTraces(basins, palette)), ...zeros, ...paths, ...before,
    point(meeting.alpha_after, "goes on with", {symbol: "circle", size: 11, color: palette.select})
  ];
};

saltus.intersectionLayout = (meeting, holder, palette) => {
  const axis = (j) => ({
    title: {text: `u${"₁₂"[j]}: ${saltus.plain(saltus.shorten(meeting.surfaces[j], 24))}`, standoff: 6},
    range: [-0.27, 1.27],
    tickvals: [0, 0.5, 1],
    fixedrange: true,
    showgrid: false,
    zeroline: false,
    automargin: true,
  });
  return {
    width: holder.clientWidth,
    height: holder.clientHeight,
    margin: {l: 54, r: 12, t: 30, b: 44},
    hovermode: "closest",
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: palette.panel,
    font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
    xaxis: axis(0),
    yaxis: {...axis(1), scaleanchor: "x"},
    legend: {orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: {size: 11}},
    shapes: [{
      type: "rect",
      x0: 0,
      x1: 1,
      y0: 0,
      y1: 1,
      layer: "below",
      line: {color: palette.axis, width: 1.5},
      fillcolor: palette.slidingShade,
    }],
  };
};

/** The event whose decision is shown: the flagged one, else the first that has a picture. */
saltus.intersectionShown = (result, selected) => {
  if (selected !== null && result.events[selected].intersection !== null) return selected;
  const first = result.events.findIndex((event) => event.intersection !== null);
  return first < 0 ? null : first;
};

/** The card with the picture; null if no event has one. */
saltus.intersectionPicture = (result, timeline, select) => {
  if (saltus.intersectionShown(result, null) === null) return null;
  const holder = saltus.element("div", {class: "phase-plot square"});
  const note = saltus.element("p", {class: "quiet note"});
  const title = saltus.element("button", {title: "show this event", onclick: () => select(shown())}, "");
  const shown = () => saltus.intersectionShown(result, timeline.selected());
  const known = new Map();
  // Where the solution is unique they say nothing about it.
  const basinsOf = (i) => {
    if (!known.has(i)) {
      known.set(i, result.events[i].unique === false ? saltus.basins(result.events[i].intersection) : null);
    }
    return known.get(i);
  };
  const draw = () => {
    const i = shown();
    const event = result.events[i];
    const palette = saltus.palette();
    title.textContent = `event ${i + 1}, t = ${saltus.brief(event.t, 8)}`;
    const from = event.intersection.alpha_before === null ? " from the four corners" : "";
    const shades = basinsOf(i) === null ? "" : " Shades: where it ends, from there and equal speeds.";
    note.textContent =
        `The square of the selections, and the hidden dynamics u′ = g(π(u))${from}. ${event.reason}.${shades}`;
    return Plotly.react(
        holder, saltus.intersectionTraces(event.intersection, palette, basinsOf(i)),
        saltus.intersectionLayout(event.intersection, holder, palette), saltus.plotConfig);
  };
  const element = saltus.element(
      "section", {class: "card phase"},
      saltus.element(
          "header", {}, saltus.element("h2", {}, "Intersection of surfaces"),
          saltus.element("span", {class: "controls grow"}, title),
          ...saltus.saveButtons(result, holder, "intersection")),
      holder, note);
  return {element, draw, start: draw};
};
