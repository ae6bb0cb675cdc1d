// The drawing over time: one axis of time for all panels, redrawn with the rows that the window needs.
"use strict";

saltus.fullWindow = (result) => {
  const {t} = result.trajectory;
  if (t.length === 0) return [0, 1];
  const ends = [...result.branches, ...(result.overlays ?? [])].map((other) => other.trajectory.t.at(-1) ?? t[0]);
  const [from, to] = [t[0], ends.reduce((latest, end) => Math.max(latest, end), t[t.length - 1])];
  return from < to ? [from, to] : [from - 0.5, from + 0.5];
};

saltus.axisName = (panel) => (panel === 0 ? "y" : `y${panel + 1}`);
saltus.axisKey = (panel) => (panel === 0 ? "yaxis" : `yaxis${panel + 1}`);

/**
 * Modes of one switching function as rectangles: psi < 0 the lower lane of its row, psi > 0 the upper one, sliding all of
 * it. Where it chatters each lane is as full as its part of the time, and the middle is hatched.
 */
saltus.modeTraces = (cells, row, axis, palette) => {
  const paths = {"-1": [[], []], 0: [[], []], 1: [[], []], chattering: [[], []]};
  const add = ([x, y], {from, to}, low, high) => {
    x.push(from, to, to, from, from, null);
    y.push(row + low, row + low, row + high, row + high, row + low, null);
  };
  for (const cell of cells) {
    const {minus, sliding, plus} = cell.share;
    if (cell.count > 1) add(paths.chattering, cell, -0.1, 0.1);
    if (minus > 0) add(paths[-1], cell, -0.1 - 0.32 * minus, -0.1);
    if (plus > 0) add(paths[1], cell, 0.1, 0.1 + 0.32 * plus);
    // Sliding must be seen, however short it is.
    if (sliding > 0) add(paths[0], cell, sliding === 1 ? -0.42 : -0.1, sliding === 1 ? 0.42 : 0.1);
  }
  const looks = {
    chattering: {fillcolor: palette.panel, fillpattern: {shape: "/", fgcolor: palette.text, size: 4, solidity: 0.25}},
    "-1": {fillcolor: palette.minus},
    1: {fillcolor: palette.plus},
    0: {fillcolor: palette.sliding},
  };
  return Object.entries(looks).filter(([kind]) => paths[kind][0].length > 0).map(([kind, look]) => ({
    type: "scatter",
    mode: "lines",
    xaxis: "x",
    yaxis: axis,
    x: paths[kind][0],
    y: paths[kind][1],
    fill: "toself",
    hoverinfo: "none",
    meta: `mode ${kind}`,
    line: {width: 0, simplify: false},
    ...look,
  }));
};

saltus.curveColour = ({firstColour}, i, palette) => palette.curves[(firstColour + i) % palette.curves.length];

/** More jumps than this in one view: dotted lines alone, their ends would cover each other. */
saltus.maximumJumpEnds = 80;

/** Jumps of one curve, if there are any: a dotted line, open where the curve ends, full where it goes on. */
saltus.jumpTraces = (curve, jumps, axis, color) => {
  if (jumps.x.length === 0) return [];
  const ends = !saltus.isFraction(curve.sort) && jumps.x.length <= 3 * saltus.maximumJumpEnds;
  return [{
    type: "scatter",
    mode: ends ? "lines+markers" : "lines",
    xaxis: "x",
    yaxis: axis,
    hoverinfo: "none",
    connectgaps: false,
    ...jumps,
    marker: {size: 5, color, symbol: jumps.x.map((_, i) => (i % 3 === 0 ? "circle-open" : "circle")), line: {width: 1}},
    line: {simplify: false, color, width: 1, dash: "dot"},
  }];
};

saltus.lineOverTime = (axis, x, y) => ({
  type: "scatter",
  mode: "lines",
  xaxis: "x",
  yaxis: axis,
  hoverinfo: "none",
  connectgaps: false,
  x,
  y,
});

/** A colour of the palette, see-through. */
saltus.faint = (colour, part) => `${colour}${Math.round(255 * part).toString(16).padStart(2, "0")}`;

/** Where a curve jumps to and fro within pixels: between which values, and its mean there. */
saltus.envelopeTraces = (envelope, axis, color) => {
  if ((envelope?.x ?? []).length === 0) return [];
  const {x, low, high, mean} = envelope;
  const box = {x: [], y: []};
  const line = {x: [], y: []};
  x.forEach(([from, to], i) => {
    box.x.push(from, to, to, from, from, null);
    box.y.push(low[i], low[i], high[i], high[i], low[i], null);
    line.x.push(from, to, ...(x[i + 1]?.[0] === to ? [] : [null]));
    line.y.push(mean[i], mean[i], ...(x[i + 1]?.[0] === to ? [] : [null]));
  });
  return [
    {
      ...saltus.lineOverTime(axis, box.x, box.y),
      fill: "toself",
      fillcolor: saltus.faint(color, 0.3),
      meta: "envelope",
      line: {width: 0, simplify: false},
    },
    {...saltus.lineOverTime(axis, line.x, line.y), meta: "mean", line: {simplify: false, color, width: 1.6}}
  ];
};

/** What is drawn of a curve, of this result or another one: stems of impulses, else lines with gaps at jumps. */
saltus.pointsOf = (result, curve, t, values, view) => saltus.isImpulse(result, curve) ?
    saltus.impulseLines(t, values, view.window, view.pixels) :
    saltus.points(t, values, view.window, view.pixels, curve.discrete);

saltus.curveTraces = (result, panel, axis, view) => panel.curves.flatMap((curve, i) => {
  const color = saltus.curveColour(panel, i, view.palette);
  const steps = saltus.controlSteps(result, curve);
  const {x, y, jumps, envelope} = steps ?? saltus.pointsOf(result, curve, result.trajectory.t, curve.values, view);
  const line = {
    ...saltus.lineOverTime(axis, x, y),
    // Plotly's own simplification moves curves visibly off their points (a sliding v = 0.2 sank below its line).
    line: {simplify: false, color, width: 1.6, shape: curve.stepwise || steps !== null ? "hv" : "linear"},
  };
  return [
    ...saltus.boundLines(result, curve, axis, view), ...saltus.branchCurves(result, curve, axis, color, view),
    ...saltus.envelopeTraces(envelope, axis, color), line, ...saltus.jumpTraces(curve, jumps, axis, color),
    ...saltus.simulatedCurve(result, curve, axis, view), ...saltus.overlayCurves(result, curve, axis, view)
  ];
});

saltus.figureTraces = (result, stack, view) => stack.panels.flatMap((panel, i) => {
  const axis = saltus.axisName(i);
  if (panel.kind === "events") return [saltus.markTrace(result, view.marks, view.selected, view.palette)];
  if (panel.kind === "modes") {
    const intervals = saltus.bandIntervals(result);
    return panel.bands.flatMap((band, row) => {
      const cells = saltus.modeCells(intervals[band], view.window, view.pixels);
      return saltus.modeTraces(cells, panel.bands.length - 1 - row, axis, view.palette);
    });
  }
  return saltus.curveTraces(result, panel, axis, view);
});

saltus.panelDomain =
    (panel, stack) => [Math.max(0, 1 - (panel.top + panel.height) / stack.height), 1 - panel.top / stack.height];

saltus.panelAxis = (panel, stack, palette) => {
  const domain = saltus.panelDomain(panel, stack);
  const bare = {domain, fixedrange: true, showgrid: false, zeroline: false, showticklabels: false, ticks: ""};
  if (panel.kind === "events") return {...bare, range: [0, 1]};
  if (panel.kind === "modes") return {...bare, range: [-0.5, panel.bands.length - 0.5]};
  const alpha = panel.fractions ? {range: [-0.06, 1.06], tickvals: [0, 0.5, 1], fixedrange: true} : {};
  return {
    domain,
    gridcolor: palette.grid,
    zerolinecolor: palette.axis,
    zerolinewidth: 1,
    nticks: Math.max(3, Math.round(panel.height / 24)),
    automargin: "left",  // plotly draws all of it a second time where a margin grows
    exponentformat: "power",
    minexponent: 5,
    tickfont: {size: 11},
    title: {text: saltus.plain(saltus.shorten(panel.title, Math.floor(panel.height / 7))), standoff: 4, font: {size: 11, color: palette.quiet}},
    ...(panel.log ? {type: "log"} : {}),
    ...alpha,
  };
};

/** Names of the curves and switching functions at the right border, in the colour of the curve. */
saltus.panelLabels = (panel, stack, palette, result) => {
  const label = (lines, fromTop, color) => ({
    text: lines.map((line) => saltus.plain(saltus.shorten(line, saltus.lineLetters))).join("<br>"),
    hovertext: saltus.plain(lines.join(" ")),
    xref: "paper",
    yref: "paper",
    x: 1,
    xanchor: "left",
    xshift: 6,
    y: 1 - (panel.top + fromTop) / stack.height,
    yanchor: "middle",
    showarrow: false,
    align: "left",
    font: {size: 12, color},
  });
  if (panel.kind === "events") return [label(["events"], panel.height / 2, palette.quiet)];
  if (panel.kind === "modes") {
    const bands = saltus.bands(result);
    const row = panel.height / panel.bands.length;
    return panel.bands.map((band, i) => label([bands[band]], (i + 0.5) * row, palette.text));
  }
  const step = Math.min(17, panel.height / panel.curves.length);
  const first = panel.height / 2 - ((panel.curves.length - 1) / 2) * step;
  return panel.curves.map((curve, i) => {
    const colour = saltus.curveColour(panel, i, palette);
    return label(saltus.columnLines(curve, panel.curves.length === 1), first + i * step, colour);
  });
};

/** A thin frame around every panel of curves. */
saltus.frameShapes = (stack, palette) => stack.panels.filter((panel) => panel.kind === "curves").map((panel) => {
  const [y0, y1] = saltus.panelDomain(panel, stack);
  const line = {color: palette.axis, width: 1};
  return {type: "rect", xref: "paper", yref: "paper", x0: 0, x1: 1, y0, y1, line, layer: "above"};
});

saltus.labelWidth = (result) => {
  const names = [...saltus.bands(result), ...saltus.columns(result).flatMap((column) => saltus.columnLines(column))];
  const letters = names.reduce((most, name) => Math.max(most, Math.min(saltus.lineLetters, name.length)), 6);
  return 12 + Math.round(7.2 * letters);
};

saltus.figureLayout = (result, stack, view) => {
  const {palette} = view;
  const margin = {l: 66, r: saltus.labelWidth(result), t: 10, b: 38};
  const layout = {
    height: stack.height + margin.t + margin.b,
    margin,
    separators: ".",
    showlegend: false,
    dragmode: "zoom",
    hovermode: "closest",
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: palette.panel,
    autosize: true,
    font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
    xaxis: {
      range: view.window,
      anchor: saltus.axisName(stack.panels.length - 1),
      gridcolor: palette.grid,
      zeroline: false,
      title: {text: "t", standoff: 4},
      exponentformat: "power",
      minexponent: 5,
      tickfont: {size: 11},
    },
    shapes: [
      ...saltus.frameShapes(stack, palette),
      ...saltus.slidingShapes(view.sliding, stack.panels, stack.height, view.window, palette),
      ...saltus.markShapes(result, view.marks, view.selected, palette),
    ],
    annotations: stack.panels.flatMap((panel) => saltus.panelLabels(panel, stack, palette, result)),
  };
  stack.panels.forEach((panel, i) => {
    layout[saltus.axisKey(i)] = {...saltus.panelAxis(panel, stack, palette), ...view.ranges[i]};
  });
  return layout;
};

saltus.plotConfig = {
  displayModeBar: false,
  doubleClick: false,
  showTips: false,
};
