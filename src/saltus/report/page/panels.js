// Which curves share a panel, and how tall the panels are.
"use strict";

saltus.range = (values) => {
  let least = Infinity;
  let greatest = -Infinity;
  for (const value of values) {
    if (value === null) continue;
    if (value < least) least = value;
    if (value > greatest) greatest = value;
  }
  return least <= greatest ? [least, greatest] : [0, 0];
};

/** More curves of one sort than this share panels, up to `perPanel` of them, as long as their scales go together. */
saltus.singlePanels = 6;
saltus.perPanel = 4;
/** Curves whose ranges differ by more than this factor would flatten each other. */
saltus.scaleRatio = 20;

saltus.groupCurves = (curves) => {
  if (curves.length <= saltus.singlePanels) return curves.map((curve) => [curve]);
  const groups = [];
  let spans = [];
  let hull = [];
  for (const curve of curves) {
    const [least, greatest] = saltus.range(curve.values);
    const candidate = [Math.min(hull[0] ?? least, least), Math.max(hull[1] ?? greatest, greatest)];
    const smallest = Math.min(...spans.filter((span) => span > 0), greatest > least ? greatest - least : Infinity);
    const fits = smallest === Infinity || candidate[1] - candidate[0] <= saltus.scaleRatio * smallest;
    const group = groups[groups.length - 1];
    if (group !== undefined && group.length < saltus.perPanel && fits) {
      group.push(curve);
      spans.push(greatest - least);
      hull = candidate;
    } else {
      groups.push([curve]);
      spans = [greatest - least];
      hull = [least, greatest];
    }
  }
  return groups;
};

/** Rows of the bands: switching functions, then modes by `indicator` (alone: 1, with others: 0, not active: null). */
saltus.bands = (result) => [...result.switching_functions, ...result.regions];
saltus.bandIntervals = (result) => [...result.trajectory.modes, ...result.trajectory.regions];

/** Selections and weights are between 0 and 1. */
saltus.isFraction = (sort) => sort === "alpha" || sort === "theta";

/** Panels of curves, top to bottom: states, outputs, inputs, alpha, theta. */
saltus.curvePanels = (result) => {
  const {trajectory} = result;
  const curves = (names, columns, sort) =>
      names.map((name, i) => ({
                  name,
                  sort,
                  index: i,
                  values: columns[i],
                  stepwise: sort === "input" && saltus.isStepwise(columns[i]),
                  discrete: sort === "state" && saltus.isDiscrete(trajectory.t, columns[i]),
                }));
  const panels = [
    ...saltus.groupCurves(curves(result.states, trajectory.x, "state")),
    ...saltus.groupCurves(curves(result.output_names, trajectory.outputs, "output")),
    ...saltus.groupCurves(curves(result.controls, trajectory.u, "input")),
  ].map((group) => ({kind: "curves", sort: group[0].sort, curves: group}));
  const fractions = (names, columns, sort) => {
    const all = curves(names, columns, sort);
    for (let i = 0; i < all.length; i += saltus.perPanel) {
      panels.push({kind: "curves", sort, curves: all.slice(i, i + saltus.perPanel)});
    }
  };
  fractions(result.switching_functions, trajectory.alpha, "alpha");
  fractions(result.regions, trajectory.theta, "theta");
  return panels;
};

/**
 * All panels with their place in pixels from the top of the drawing: the strip of events, the bands of modes, the
 * curves. They fill `height` if that leaves every curve enough room, otherwise the drawing becomes taller.
 */
saltus.stackPanels = (result, height) => {
  const bands = saltus.bands(result).length;
  const curves = saltus.curvePanels(result);
  const panels = [{kind: "events", height: 22}];
  if (bands > 0) panels.push({kind: "modes", height: bands === 1 ? 26 : 20 * bands});
  const gap = 12;
  const fixed = panels.reduce((sum, panel) => sum + panel.height + gap, 0);
  const weights = curves.map((panel) => (saltus.isFraction(panel.sort) ? 0.65 : 1));
  const total = weights.reduce((sum, weight) => sum + weight, 0);
  const least = curves.length > 5 ? 92 : 110;
  const free = height - fixed - gap * (curves.length - 1);
  const unit = Math.min(340, Math.max(least, total > 0 ? free / total : 0));
  curves.forEach((panel, i) => panels.push({...panel, height: Math.round(unit * weights[i])}));
  let top = 0;
  for (const panel of panels) {
    panel.top = top;
    top += panel.height + gap;
  }
  return {panels, height: top - gap};
};
