// How the path of problems of an optimisation went.
"use strict";

/** Residuals below this, 0 among them, are drawn here: a logarithm has no 0. */
saltus.leastResidual = 1e-16;
saltus.phaseLooks = {
  relaxed: {symbol: "circle", label: "relaxed problem"},
  branch: {symbol: "square", label: "branch problem"},
  lpcc: {symbol: "diamond", label: "linear program"},
};

/** Where problems ended: iterations of all up to them. */
saltus.iterationsCumulated = (homotopy) => {
  let sum = 0;
  return homotopy.map(({iterations}) => (sum += iterations));
};

saltus.homotopyTraces = (homotopy, palette) => {
  const x = saltus.iterationsCumulated(homotopy);
  const text = homotopy.map((step, k) => saltus.plain(
      `${k + 1}. ${saltus.phaseLooks[step.phase].label}, ${step.solver}: ${saltus.count(step.iterations, "iteration")}, ${
          step.termination.replaceAll("_", " ")}${step.message === "" ? "" : ` (${step.message})`}`));
  const failed = homotopy.map(({termination}) => termination !== "completed");
  const curve = (name, key, color, more = {}) => ({
    type: "scatter",
    mode: "lines+markers",
    name,
    x,
    y: homotopy.map((step) => (step[key] === null ? null : more.yaxis ? step[key] : Math.max(step[key], saltus.leastResidual))),
    customdata: homotopy.map((step) => saltus.brief(step[key], 4)),
    text,
    hovertemplate: "%{text}<br>%{fullData.name} %{customdata}<extra></extra>",
    line: {simplify: false, color, width: 1.6},
    marker: {
      size: 7,
      color,
      symbol: homotopy.map(({phase}, k) => (failed[k] ? "x-thin" : saltus.phaseLooks[phase].symbol)),
      line: {width: failed.map((one) => (one ? 2 : 0)), color},
    },
    ...more,
  });
  const kinds = [...new Set(homotopy.map(({phase}) => phase))].map((phase) => [saltus.phaseLooks[phase].symbol, saltus.phaseLooks[phase].label]);
  if (failed.some((one) => one)) kinds.push(["x-thin", "not solved"]);
  const keys = kinds.map(([symbol, name]) => ({
    type: "scatter",
    mode: "markers",
    x: [null],
    y: [null],
    name,
    hoverinfo: "skip",
    marker: {size: 7, symbol, color: palette.quiet, line: {width: symbol === "x-thin" ? 2 : 0, color: palette.quiet}},
  }));
  return [
    {...curve("σ", "sigma", palette.mark), line: {simplify: false, color: palette.mark, width: 1.4, dash: "dash"}},
    curve("infeasibility", "primal_infeasibility", palette.curves[5]),
    curve("complementarity", "complementarity_residual", palette.curves[0]),
    curve("objective", "objective", palette.curves[1], {yaxis: "y2", showlegend: false}), ...keys
  ];
};

/** From the last relaxed problem on, where others follow: shaded. */
saltus.crossoverShape = (homotopy, palette) => {
  const last = homotopy.findLastIndex(({phase}) => phase === "relaxed");
  if (last < 0 || last + 1 === homotopy.length) return [];
  const x = saltus.iterationsCumulated(homotopy);
  return [{
    type: "rect",
    x0: x[last],
    x1: Math.max(x[x.length - 1], x[last] + 0.01 * x[x.length - 1]),
    yref: "paper",
    y0: 0,
    y1: 1,
    fillcolor: palette.slidingShade,
    line: {width: 0},
    layer: "below",
  }];
};

saltus.homotopyPicture = (result) => {
  const {homotopy} = result.optimization;
  if (homotopy.length === 0) return null;
  const figure = (palette, holder) => ({
    data: saltus.homotopyTraces(homotopy, palette),
    layout: saltus.cardLayout(palette, holder, {
      margin: {l: 60, r: 14, t: 56, b: 42},
      xaxis: saltus.cardAxis(palette, "iterations", {anchor: "y", zeroline: false, rangemode: "tozero"}),
      yaxis: saltus.cardAxis(palette, "residuals", {type: "log", domain: [0, 0.66], exponentformat: "power", dtick: null, nticks: 8}),
      yaxis2: saltus.cardAxis(palette, "objective", {domain: [0.72, 1], nticks: 5, zeroline: false}),
      shapes: saltus.crossoverShape(homotopy, palette),
    }),
  });
  const note = [
    `Each mark is a problem solved. σ is what the product of a complementary pair may be at most; residuals of 0 are drawn at ${saltus.leastResidual}.`,
    "Shaded: problems without relaxation behind the last relaxed one."
  ].join(" ");
  return saltus.drawingCard(result, {title: "Path of problems", note, file: "homotopy"}, figure);
};
