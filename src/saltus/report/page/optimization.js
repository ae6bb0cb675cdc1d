// What an optimisation adds to the drawings of its trajectory: bounds, steps of controls, the open-loop simulation; and
// what certificate and verification say.
"use strict";

/** A bound farther from the curve than so much of its range would flatten it. */
saltus.boundDistance = 0.6;

/** The bounds of a curve that are near enough to be drawn. */
saltus.boundsNear = (result, curve) => {
  const {bounds} = result.optimization ?? {};
  const pair = {state: bounds?.x, input: bounds?.u}[curve.sort]?.[curve.index];
  if (pair === undefined) return [];
  const [least, greatest] = saltus.range(curve.values);
  const room = saltus.boundDistance * (greatest > least ? greatest - least : Math.max(1, Math.abs(least)));
  return [...new Set(pair)].filter((bound) => bound !== null && bound >= least - room && bound <= greatest + room);
};

/** A control as it was optimised: constant in each interval; null for other curves. */
saltus.controlSteps = (result, curve) => {
  const {grid, u} = result.optimization ?? {};
  if (curve.sort !== "input" || u === undefined || grid.length < 2) return null;
  const values = u[curve.index];
  return {x: grid, y: [...values, values[values.length - 1]], jumps: {x: [], y: []}};
};

/** Bounds of a curve over time: dashed lines behind it. */
saltus.boundLines = (result, curve, axis, {window: [from, to], palette}) => saltus.boundsNear(result, curve).map((bound) => ({
  ...saltus.lineOverTime(axis, [from, to], [bound, bound]),
  meta: "bound",
  line: {color: palette.mark, width: 1.2, dash: "dash"},
}));

/** The open-loop simulation of a state over time: dots on its curve. */
saltus.simulatedCurve = (result, curve, axis, view) => {
  const simulated = result.optimization?.open_loop ?? null;
  if (curve.sort !== "state" || simulated === null) return [];
  const {x, y} = saltus.points(simulated.t, simulated.x[curve.index], view.window, view.pixels, true);
  const line = {simplify: false, color: view.palette.simulated, width: 2, dash: "2px,7px"};
  return [{...saltus.lineOverTime(axis, x, y), meta: "simulated", line}];
};

/** The open-loop simulation in a plane or a space of states. */
saltus.simulatedOrbit = (result, choice, view, palette, type) => {
  const simulated = result.optimization?.open_loop ?? null;
  if (simulated === null) return [];
  const chosen = choice.map((i) => saltus.axes(result)[i]);
  if (chosen.some(({sort}) => sort !== "state" && sort !== "time")) return [];
  const lists = chosen.map((column) => saltus.columnOf(simulated, column));
  const rows = saltus.rowsToDraw(simulated.t, lists, saltus.rowsInWindow(simulated.t, view.window), view.pixels);
  const [x, y, z] = lists.map((list) => rows.map((i) => list[i]));
  return [{
    type,
    mode: "lines",
    x,
    y,
    ...(z === undefined ? {} : {z}),
    name: "simulated",
    hoverinfo: "skip",
    line: {simplify: false, color: palette.simulated, width: type === "scatter" ? 2.4 : 4, dash: type === "scatter" ? "2px,7px" : "dot"},
  }];
};

saltus.optimizationSwatches = (result, swatch) => {
  const {bounds, open_loop: simulated} = result.optimization ?? {};
  const bounded = bounds !== undefined && [...bounds.x, ...bounds.u].flat().some((bound) => bound !== null);
  return [
    ...(bounded ? [swatch("bound-line", "bound")] : []),
    ...(simulated ? [swatch("simulated-line", "controls simulated from the start")] : [])
  ];
};

saltus.optimizationFacts = (result) => {
  const {objective, horizon, method, homotopy, statistics} = result.optimization;
  return [
    ["method", method], ["objective", saltus.brief(objective, 8)], ["horizon", saltus.brief(horizon, 8)],
    ["events", result.events.length.toLocaleString("en-US")], ["problems", homotopy.length.toLocaleString("en-US")],
    ["iterations", statistics.iterations.toLocaleString("en-US")], ["time", `${saltus.brief(statistics.wall_seconds, 3)} s`]
  ];
};

saltus.optimizationStatistics = (result) => {
  const {statistics, homotopy} = result.optimization;
  const number = (n) => n.toLocaleString("en-US");
  const seconds = (s) => `${saltus.brief(s, 4)} s`;
  return [
    ["problems solved", number(homotopy.length)], ["iterations", number(statistics.iterations)],
    ["variables", number(statistics.variables)], ["equations", number(statistics.equations)],
    ["complementarities", number(statistics.pairs)], ["building the problem", seconds(statistics.build_seconds)],
    ["functions and derivatives, all threads", seconds(statistics.evaluation_seconds)],
    ["linear algebra, all threads", seconds(statistics.linear_algebra_seconds)], ["wall time", seconds(statistics.wall_seconds)]
  ];
};

/** Sentences with a sign before each: what is good, what is bad, what is only said. */
saltus.findingList = (findings) => saltus.element(
    "ul", {class: "findings"},
    ...findings.map(
        ({tone, text}) => saltus.element(
            "li", {class: tone},
            saltus.element("span", {class: "sign", "aria-hidden": "true"}, {good: "✓", bad: "✗", neutral: "·"}[tone]),
            saltus.element("span", {}, text))));

/** Objective, certificate and verification in words; null for a result that is no optimisation. */
saltus.verdictCard = (result) => {
  const optimization = result.optimization ?? null;
  if (optimization === null) return null;
  const {objective, terms, horizon, parameters, certificate, verification} = optimization;
  const rows = [
    ["objective", saltus.exact(objective)],
    ...(terms.length < 2 ? [] : terms.map(([name, value]) => [`of it ${name}`, saltus.exact(value)])),
    ["horizon", saltus.exact(horizon)], ...parameters.map(([name, value]) => [name, saltus.exact(value)])
  ];
  const part = (title, note, ...content) => saltus.element(
      "div", {}, saltus.element("h3", {title: note}, title), ...content);
  const element = saltus.element(
      "section", {class: "card verdict"}, saltus.element("h2", {}, "Certificate and verification"),
      saltus.element(
          "div", {class: "verdict-parts"}, part("Optimum", "what was found", saltus.pairTable(rows)),
          part(
              "Certificate: is it an optimum of the discretised problem?",
              "residuals of the optimality conditions, with complementarities as they are, not relaxed",
              saltus.findingList(certificate)),
          part(
              "Verification: does the system do it?",
              "simulated again by the engine that locates every switch, with the controls found",
              saltus.findingList(verification))));
  return element;
};
