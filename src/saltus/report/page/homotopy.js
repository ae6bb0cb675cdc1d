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

/** The number of the problem whose solution was taken: the last one without relaxation with the objective found; -1 if none. */
saltus.solutionPlace = (homotopy, objective) => homotopy.findLastIndex(
    ({phase, termination, message, objective: own}) => phase !== "relaxed" && termination === "completed" &&
        !message.startsWith("refused") && Math.abs(own - objective) <= 1e-9 * Math.max(1, Math.abs(objective)));

/** What a problem was for the optimum: on the way to it, the one taken, another branch that was tried, or not solved. */
saltus.problemRoles = (homotopy, objective = null) => {
  const taken = objective === null ? -1 : saltus.solutionPlace(homotopy, objective);
  return homotopy.map(({phase, termination, message}, k) => {
    if (k === taken) return "taken";
    // With a solution in hand, other mode sequences are tried; most of them have none, or none that is better.
    const other = message.startsWith("another mode sequence") || (taken >= 0 && k > taken && phase !== "relaxed");
    if (other) return "other";
    return termination === "completed" ? "path" : "failed";
  });
};

saltus.problemText = (step, k, role) => {
  const ending = step.termination.replaceAll("_", " ");
  const said = [
    `${saltus.phaseLooks[step.phase].label}, ${step.solver}: ${saltus.count(step.iterations, "iteration")}`,
    ...(role === "other" ? [step.termination === "completed" ? "tried, not better" : `tried, no solution (${ending})`] : [ending]),
  ].join(", ");
  return saltus.plain(`${k + 1}. ${said}${step.message === "" ? "" : ` (${step.message})`}`);
};

saltus.homotopyKeys = (homotopy, roles, palette) => {
  const phases = homotopy.filter((_, k) => roles[k] !== "other").map(({phase}) => phase);
  const kinds = [...new Set(phases)].map((phase) => [saltus.phaseLooks[phase].symbol, saltus.phaseLooks[phase].label]);
  if (roles.includes("failed")) kinds.push(["x-thin", roles.includes("taken") ? "not solved, the path went on" : "not solved"]);
  if (roles.includes("other")) kinds.push(["square-open", "another branch, tried"]);
  return kinds.map(([symbol, name]) => ({
    type: "scatter",
    mode: "markers",
    x: [null],
    y: [null],
    name,
    hoverinfo: "skip",
    marker: {size: 7, symbol, color: palette.quiet, line: {width: symbol === "x-thin" ? 2 : symbol.endsWith("open") ? 1 : 0, color: palette.quiet}},
  }));
};

saltus.homotopyTraces = (homotopy, palette, objective = null) => {
  const all = saltus.iterationsCumulated(homotopy);
  const roles = saltus.problemRoles(homotopy, objective);
  const places = homotopy.map((_, k) => k);
  const onPath = places.filter((k) => roles[k] !== "other");
  const tried = places.filter((k) => roles[k] === "other");
  const marks = (chosen, key, more) => ({
    type: "scatter",
    x: chosen.map((k) => all[k]),
    y: chosen.map((k) => (homotopy[k][key] === null ? null : more.yaxis ? homotopy[k][key] : Math.max(homotopy[k][key], saltus.leastResidual))),
    customdata: chosen.map((k) => saltus.brief(homotopy[k][key], 4)),
    text: chosen.map((k) => saltus.problemText(homotopy[k], k, roles[k])),
    hovertemplate: `%{text}<br>${more.title} %{customdata}<extra></extra>`,
  });
  const curve = (title, key, color, more = {}) => {
    const symbol = (k) => (roles[k] === "failed" ? "x-thin" : saltus.phaseLooks[homotopy[k].phase].symbol);
    const path = {
      ...marks(onPath, key, {title, ...more}),
      mode: "lines+markers",
      name: title,
      line: {simplify: false, color, width: 1.6},
      marker: {
        size: 7,
        color,
        symbol: onPath.map(symbol),
        line: {width: onPath.map((k) => (roles[k] === "failed" ? 2 : 0)), color},
      },
      ...more,
    };
    if (tried.length === 0) return [path];
    const others = {...marks(tried, key, {title, ...more}), ...more, mode: "markers", name: `${title}, tried`, showlegend: false};
    return [path, {...others, marker: {size: 7, color, symbol: "square-open", line: {width: 1, color}}}];
  };
  const taken = roles.indexOf("taken");
  const optimum = taken < 0 ? [] : [{
    type: "scatter",
    mode: "markers",
    x: [all[taken]],
    y: [homotopy[taken].objective],
    yaxis: "y2",
    name: "the optimum",
    hoverinfo: "skip",
    marker: {size: 15, symbol: "circle-open", color: palette.text, line: {width: 1.6, color: palette.text}},
  }];
  return [
    ...curve("σ", "sigma", palette.mark, {line: {simplify: false, color: palette.mark, width: 1.4, dash: "dash"}}),
    ...curve("infeasibility", "primal_infeasibility", palette.curves[5]),
    ...curve("complementarity", "complementarity_residual", palette.curves[0]),
    ...curve("objective", "objective", palette.curves[1], {yaxis: "y2", showlegend: false}), ...optimum,
    ...saltus.homotopyKeys(homotopy, roles, palette)
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
  const {homotopy, objective} = result.optimization;
  if (homotopy.length === 0) return null;
  const figure = (palette, holder) => ({
    data: saltus.homotopyTraces(homotopy, palette, objective),
    layout: saltus.cardLayout(palette, holder, {
      margin: {l: 60, r: 14, t: 56, b: 42},
      xaxis: saltus.cardAxis(palette, "iterations", {anchor: "y", zeroline: false, rangemode: "tozero"}),
      yaxis: saltus.cardAxis(palette, "residuals", {type: "log", domain: [0, 0.66], exponentformat: "power", dtick: null, nticks: 8}),
      yaxis2: saltus.cardAxis(palette, "objective", {domain: [0.72, 1], nticks: 5, zeroline: false}),
      shapes: saltus.crossoverShape(homotopy, palette),
    }),
  });
  const note = [
    `Each mark is a problem that was solved. σ is the largest value that the product of a complementary pair may have. Residuals of 0 are drawn at ${saltus.leastResidual}.`,
    "Shaded: problems without relaxation after the last relaxed one.",
    saltus.problemRoles(homotopy, objective).includes("other") ?
        "Open squares: with the optimum in hand, other mode sequences were tried; none was better." :
        ""
  ].join(" ").trim();
  return saltus.drawingCard(result, {title: "Path of problems", note, file: "homotopy"}, figure);
};
