// The drawing over time: one axis of time for all panels, redrawn with the rows that the window needs.
"use strict";

saltus.fullWindow = (result) => {
  const {t} = result.trajectory;
  if (t.length === 0) return [0, 1];
  const ends = result.branches.map((branch) => branch.trajectory.t.at(-1) ?? t[0]);
  const [from, to] = [t[0], ends.reduce((latest, end) => Math.max(latest, end), t[t.length - 1])];
  return from < to ? [from, to] : [from - 0.5, from + 0.5];
};

saltus.axisName = (panel) => (panel === 0 ? "y" : `y${panel + 1}`);
saltus.axisKey = (panel) => (panel === 0 ? "yaxis" : `yaxis${panel + 1}`);

/** Modes of one switching function: -1 the lower part of its row, +1 the upper part, sliding all of it. */
saltus.modeTrace = (intervals, row, axis, palette) => {
  const cells = {"-1": [-1, null, null], 0: [0, 0, 0], 1: [null, null, 1]};
  const z = [0, 1, 2].map((part) => intervals.values.map((mode) => (mode === null ? null : cells[mode][part])));
  return {
    type: "heatmap",
    xaxis: "x",
    yaxis: axis,
    x: intervals.edges,
    z,
    hoverinfo: "none",
    hoverongaps: false,
    y: [row - 0.42, row - 0.1, row + 0.1, row + 0.42],
    zmin: -1.5,
    zmax: 1.5,
    showscale: false,
    colorscale: [
      [0, palette.minus], [1 / 3, palette.minus], [1 / 3, palette.sliding], [2 / 3, palette.sliding],
      [2 / 3, palette.plus], [1, palette.plus]
    ],
  };
};

/** Many short intervals: those of one pixel become one, sliding first because it must be seen. */
saltus.thinIntervals = ({edges, values}, [from, to], pixels) => {
  if (values.length <= 4 * pixels) return {edges, values};
  const thin = {edges: [], values: []};
  const step = (to - from) / pixels;
  let i = Math.max(0, saltus.lowerBound(edges, from) - 1);
  while (i < values.length && edges[i] <= to) {
    let k = i + 1;
    let mode = values[i];
    while (k < values.length && edges[k + 1] < edges[i] + step) {
      if (values[k] === 0) mode = 0;
      k += 1;
    }
    thin.edges.push(edges[i]);
    thin.values.push(mode);
    i = k;
  }
  thin.edges.push(edges[Math.min(i, edges.length - 1)]);
  return thin;
};

saltus.curveColour = (panel, i, palette) => {
  const first = {state: 0, output: 1, input: 2, alpha: 3, theta: 4}[panel.sort];
  return palette.curves[(panel.curves.length === 1 ? first : i) % palette.curves.length];
};

/** More jumps than this in one view: dotted lines alone, their ends would cover each other. */
saltus.maximumJumpEnds = 80;

/** Jumps of one curve: a dotted line, open where the curve ends, full where it goes on. */
saltus.jumpTrace = (curve, jumps, axis, color) => {
  const ends = !saltus.isFraction(curve.sort) && jumps.x.length <= 3 * saltus.maximumJumpEnds;
  return {
    type: "scatter",
    mode: ends ? "lines+markers" : "lines",
    xaxis: "x",
    yaxis: axis,
    hoverinfo: "none",
    connectgaps: false,
    ...jumps,
    marker: {size: 5, color, symbol: jumps.x.map((_, i) => (i % 3 === 0 ? "circle-open" : "circle")), line: {width: 1}},
    line: {simplify: false, color, width: 1, dash: "dot"},
  };
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

saltus.curveTraces = (result, panel, axis, view) => panel.curves.flatMap((curve, i) => {
  const color = saltus.curveColour(panel, i, view.palette);
  const {x, y, jumps} = saltus.controlSteps(result, curve) ??
      saltus.points(result.trajectory.t, curve.values, view.window, view.pixels, curve.discrete);
  const line = {
    ...saltus.lineOverTime(axis, x, y),
    // Plotly's own simplification moves curves visibly off their points (a sliding v = 0.2 sank below its line).
    line: {simplify: false, color, width: 1.6, shape: curve.stepwise || saltus.controlSteps(result, curve) !== null ? "hv" : "linear"},
  };
  const jumpTraces = jumps.x.length === 0 ? [] : [saltus.jumpTrace(curve, jumps, axis, color)];
  return [
    ...saltus.boundLines(result, curve, axis, view), ...saltus.branchCurves(result, curve, axis, color, view), line,
    ...jumpTraces, ...saltus.simulatedCurve(result, curve, axis, view)
  ];
});

saltus.figureTraces = (result, stack, view) => stack.panels.flatMap((panel, i) => {
  const axis = saltus.axisName(i);
  if (panel.kind === "events") return [saltus.markTrace(result, view.marks, view.selected, view.palette)];
  if (panel.kind === "modes") {
    const rows = saltus.bandIntervals(result).map((mode) => saltus.thinIntervals(mode, view.window, view.pixels));
    return rows.map((mode, row) => saltus.modeTrace(mode, rows.length - 1 - row, axis, view.palette));
  }
  return saltus.curveTraces(result, panel, axis, view);
});

saltus.panelDomain =
    (panel, stack) => [Math.max(0, 1 - (panel.top + panel.height) / stack.height), 1 - panel.top / stack.height];

saltus.panelAxis = (panel, stack, palette, result) => {
  const domain = saltus.panelDomain(panel, stack);
  const bare = {domain, fixedrange: true, showgrid: false, zeroline: false, showticklabels: false, ticks: ""};
  if (panel.kind === "events") return {...bare, range: [0, 1]};
  if (panel.kind === "modes") return {...bare, range: [-0.5, saltus.bands(result).length - 0.5]};
  const alpha = saltus.isFraction(panel.sort) ? {range: [-0.06, 1.06], tickvals: [0, 0.5, 1], fixedrange: true} : {};
  return {
    domain,
    gridcolor: palette.grid,
    zerolinecolor: palette.axis,
    zerolinewidth: 1,
    nticks: Math.max(3, Math.round(panel.height / 24)),
    automargin: true,
    exponentformat: "power",
    minexponent: 5,
    tickfont: {size: 11},
    ...alpha,
  };
};

/** Names of the curves and switching functions at the right border, in the colour of the curve. */
saltus.panelLabels = (panel, stack, palette, result) => {
  const label = (name, fromTop, color) => ({
    text: saltus.plain(saltus.shorten(name, 18)),
    hovertext: saltus.plain(name),
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
  if (panel.kind === "events") return [label("events", panel.height / 2, palette.quiet)];
  if (panel.kind === "modes") {
    const bands = saltus.bands(result);
    const row = panel.height / bands.length;
    return bands.map((name, i) => label(name, (i + 0.5) * row, palette.text));
  }
  const step = Math.min(17, panel.height / panel.curves.length);
  const first = panel.height / 2 - ((panel.curves.length - 1) / 2) * step;
  return panel.curves.map((curve, i) => {
    const sign = {alpha: "α", theta: "θ"}[curve.sort];
    const name = sign === undefined ? curve.name : `${sign}(${curve.name})`;
    return label(name, first + i * step, saltus.curveColour(panel, i, palette));
  });
};

/** A thin frame around every panel of curves. */
saltus.frameShapes = (stack, palette) => stack.panels.filter((panel) => panel.kind === "curves").map((panel) => {
  const [y0, y1] = saltus.panelDomain(panel, stack);
  const line = {color: palette.axis, width: 1};
  return {type: "rect", xref: "paper", yref: "paper", x0: 0, x1: 1, y0, y1, line, layer: "above"};
});

saltus.labelWidth = (result) => {
  const longest = (names, extra = 0) =>
      names.reduce((most, name) => Math.max(most, Math.min(18, name.length + extra)), 0);
  const letters = Math.max(
      6, longest(result.states), longest(result.output_names), longest(result.controls),
      longest(saltus.bands(result), 3));
  return 12 + Math.round(7.2 * letters);
};

saltus.figureLayout = (result, stack, view) => {
  const {palette} = view;
  const margin = {l: 52, r: saltus.labelWidth(result), t: 4, b: 38};
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
    layout[saltus.axisKey(i)] = {...saltus.panelAxis(panel, stack, palette, result), ...view.ranges[i]};
  });
  return layout;
};

saltus.plotConfig = {
  displayModeBar: false,
  doubleClick: false,
  showTips: false,
};
