// How far the open-loop simulation is from the optimised trajectory, and the lengths of elements of an optimisation.
"use strict";

/** Rows of two ascending lists of times that belong together; of several at one time the last ones. */
saltus.commonRows = (a, b, reach) => {
  const pairs = [];
  let k = 0;
  for (let i = 0; i < a.length; i += 1) {
    if (a[i + 1] !== undefined && a[i + 1] - a[i] <= reach) continue;
    while (k < b.length && b[k] < a[i] - reach) k += 1;
    while (k + 1 < b.length && b[k + 1] <= a[i] + reach) k += 1;
    if (k < b.length && Math.abs(b[k] - a[i]) <= reach) pairs.push([i, k]);
  }
  return pairs;
};

/** |simulated - optimised| of a state by its range, where both have a row; between rows if they have too few in common. */
saltus.openLoopDifference = (trajectory, simulated, state) => {
  const [least, greatest] = saltus.range(trajectory.x[state]);
  const range = greatest > least ? greatest - least : 1;
  const {t} = trajectory;
  const pairs = saltus.commonRows(t, simulated.t, 1e-9 * (t[t.length - 1] - t[0]));
  const values = (x, other) => (x === null || other === null ? null : Math.abs(x - other) / range);
  const common = pairs.length >= 3;
  return {
    x: common ? pairs.map(([i]) => t[i]) : t,
    y: common ? pairs.map(([i, k]) => values(trajectory.x[state][i], simulated.x[state][k])) :
                t.map((time, i) => values(trajectory.x[state][i], saltus.sidesAt(simulated.t, simulated.x[state], time)[1])),
  };
};

/** A difference of 0, as at the start, is a gap: a logarithm has none. Where all are 0 they are drawn at rounding. */
saltus.logarithmic = (values) => {
  const some = values.some((value) => value > 0);
  return values.map((value) => (value === 0 ? (some ? null : saltus.leastResidual) : value));
};

/** More points than this: a line alone. */
saltus.maximumDifferenceMarks = 150;

saltus.openLoopPicture = (result, timeline) => {
  const {open_loop: simulated} = result.optimization;
  if (simulated === null || result.trajectory.t.length < 2) return null;
  const shown = result.states.slice(0, 8);
  const figure = (palette, holder) => ({
    data: shown.map((name, i) => {
      const {x, y} = saltus.openLoopDifference(result.trajectory, simulated, i);
      return {
        type: "scatter",
        mode: x.length > saltus.maximumDifferenceMarks ? "lines" : "lines+markers",
        name: saltus.plain(saltus.shorten(name, 24)),
        x,
        y: saltus.logarithmic(y),
        hovertemplate: "t = %{x:.6g}: %{y:.2e}<extra>%{fullData.name}</extra>",
        line: {simplify: false, color: palette.curves[i % palette.curves.length], width: 1.4},
        marker: {size: 3, color: palette.curves[i % palette.curves.length]},
      };
    }),
    layout: saltus.cardLayout(palette, holder, {
      xaxis: saltus.cardAxis(palette, "t", {range: timeline.window(), zeroline: false}),
      yaxis: saltus.cardAxis(palette, "difference / range", {type: "log", nticks: 8}),
      showlegend: true,
    }),
  });
  const note = [
    "The optimal controls are simulated over the whole horizon, and every switch is located. Curves show how far each",
    "state is from the optimised one, as a share of its range. In an unstable system they part at every accuracy; the",
    "verification above checks each interval on its own.",
    result.states.length > shown.length ? `The first ${shown.length} states.` : ""
  ].join(" ");
  return saltus.drawingCard(
      result, {title: "Simulated against optimised", note, file: "open-loop"}, figure, saltus.followsTime(timeline));
};

/** Lengths of elements and the speed of time where the result has no `elements` to draw them with. */
saltus.lengthPicture = (result, timeline) => {
  const {h, grid, speed_of_time: speed} = result.optimization;
  const has = result.elements !== null && result.elements.t.length > 0;
  if (h.length === 0 || (has && speed.length === 0)) return null;
  const steps = saltus.intervalSteps(grid, h);
  const figure = (palette, holder) => ({
    data: [
      {type: "scatter", mode: "lines", name: "h", ...steps, line: {color: palette.text, width: 1.4}},
      ...(speed.length === 0 ? [] : [{
        type: "scatter",
        mode: "lines",
        name: "speed of time",
        x: grid,
        y: [...speed, speed[speed.length - 1]],
        yaxis: "y2",
        line: {color: palette.curves[2], width: 1.6, shape: "hv"},
      }])
    ],
    layout: saltus.cardLayout(palette, holder, {
      xaxis: saltus.cardAxis(palette, "t", {range: timeline.window(), zeroline: false}),
      yaxis: saltus.cardAxis(palette, "h", {rangemode: "tozero", domain: speed.length === 0 ? [0, 1] : [0, 0.47]}),
      yaxis2: saltus.cardAxis(palette, "speed of time", {domain: [0.53, 1]}),
    }),
  });
  return saltus.drawingCard(
      result, {title: "Lengths of elements", note: "Elements end where the solution switches.", file: "lengths"}, figure,
      saltus.followsTime(timeline));
};

/** Lengths as steps; each interval is filled by its elements. */
saltus.intervalSteps = (grid, h) => {
  const x = [];
  const y = [];
  h.forEach((lengths, k) => {
    const sum = lengths.reduce((all, one) => all + one, 0);
    let from = grid[k];
    for (const length of lengths) {
      const to = from + (length / sum) * (grid[k + 1] - grid[k]);
      x.push(from, to);
      y.push(length, length);
      from = to;
    }
  });
  return {x, y};
};

/** All drawings of an optimisation; none for other results. */
saltus.optimizationPictures = (result, timeline) => {
  if ((result.optimization ?? null) === null) return [];
  return [
    saltus.openLoopPicture(result, timeline), saltus.constraintPicture(result, timeline),
    saltus.lengthPicture(result, timeline), saltus.homotopyPicture(result)
  ].filter((card) => card !== null);
};
