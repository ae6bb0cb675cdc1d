// Which curves share a panel, and how tall the panels are.
"use strict";

saltus.range = (values) => {
  let least = Infinity;
  let greatest = -Infinity;
  for (const value of values) {
    if (value === null || value !== value) continue;  // missing, in packed columns NaN
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

/** @param single  so many curves have a panel each */
saltus.groupCurves = (curves, single = saltus.singlePanels) => {
  if (curves.length <= single) return curves.map((curve) => [curve]);
  const groups = [];
  for (const curve of curves) {
    const [least, greatest] = curve.range ?? saltus.range(curve.values);
    const span = greatest > least ? greatest - least : Infinity;
    const fits = ({members, hull, smallest}) => {
      const together = Math.max(hull[1], greatest) - Math.min(hull[0], least);
      const finest = Math.min(smallest, span);
      return members.length < saltus.perPanel && (finest === Infinity || together <= saltus.scaleRatio * finest);
    };
    const group = groups.find(fits);
    if (group === undefined) {
      groups.push({members: [curve], hull: [least, greatest], smallest: span});
    } else {
      group.members.push(curve);
      group.hull = [Math.min(group.hull[0], least), Math.max(group.hull[1], greatest)];
      group.smallest = Math.min(group.smallest, span);
    }
  }
  return groups.map(({members}) => members);
};

/** Rows of the bands: switching functions, then modes by `indicator` (alone: 1, with others: 0, not active: null). */
saltus.bands = (result) => [...result.switching_functions, ...result.regions];
saltus.bandIntervals = (result) => [...result.trajectory.modes, ...result.trajectory.regions];

/** Selections and weights are between 0 and 1. */
saltus.isFraction = (sort) => sort === "alpha" || sort === "theta";

/** The panels of a choice with their curves. */
saltus.curvePanels = (result, choice) => {
  const columns = saltus.columns(result);
  const kindOf = saltus.kindsOfColumns(result);
  // Colours go on from panel to panel: one that comes back is far away.
  let next = 0;
  const panel = (entry) => ({...entry, title: saltus.panelTitle(entry, kindOf), firstColour: (next += entry.curves.length) - entry.curves.length});
  return choice.panels.map(({curves, log}) => panel({
                             kind: "curves",
                             sort: columns[curves[0]].sort,
                             log,
                             curves: curves.map((i) => columns[i]),
                             fractions: !log && curves.every((i) => saltus.isFraction(columns[i].sort)),
                           }));
};

/**
 * All panels with their place in pixels from the top of the drawing: the strip of events, the bands of modes, the
 * curves. They fill `height` if that leaves every curve enough room, otherwise the drawing becomes taller.
 */
saltus.stackPanels = (result, height, choice = saltus.firstPanels(result)) => {
  const bands = choice.bands.length;
  const curves = saltus.curvePanels(result, choice);
  const panels = [{kind: "events", height: 22}];
  if (bands > 0) panels.push({kind: "modes", bands: choice.bands, height: bands === 1 ? 26 : 20 * bands});
  const gap = 16;  // room for the lowest and the highest number of neighbours
  const fixed = panels.reduce((sum, panel) => sum + panel.height + gap, 0);
  const weights = curves.map((panel) => (panel.fractions ? 0.65 : 1));
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
