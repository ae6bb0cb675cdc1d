// Kinds of columns: what may share an axis, and what the axis is called.
"use strict";

/** Pairs [position, velocity] as numbers of states: those of which the model states that one is the rate of the other. */
saltus.ratePairs = (result) => {
  const place = new Map(result.states.map((name, i) => [name, i]));
  return (result.model?.equations ?? []).flatMap(([left, right]) => {
    const [position, velocity] = [place.get(left.replace(/'$/, "")), place.get(right)];
    return left.endsWith("'") && position !== undefined && velocity !== undefined ? [[position, velocity]] : [];
  });
};

/** Whether bodies or contacts make the states positions and velocities. */
saltus.isMechanical = (result) => (result.contacts ?? []).length > 0 || (result.shapes ?? []).length > 0;

/** Of every column a word for what it is: "position", "force"; columns of different kinds do not share a panel at first. */
saltus.kindsOfColumns = (result) => {
  const pairs = saltus.isMechanical(result) ? saltus.ratePairs(result) : [];
  const [positions, velocities] = [0, 1].map((side) => new Set(pairs.map((pair) => pair[side])));
  const ofState = (index) => (velocities.has(index) ? "velocity" : positions.has(index) ? "position" : "state");
  return ({name, sort, index}) => {
    if (sort === "state") return ofState(index);
    // Of a contact: gap(foot), force(foot).
    const family = /^(\w+)\(.*\)$/.exec(name);
    return sort === "output" && family !== null ? family[1] : sort;
  };
};

/** Curves of a sort in panels: by kind, unit, and whether they are piecewise constant; then by their scales. */
saltus.panelsByKind = (result, curves) => {
  const kindOf = saltus.kindsOfColumns(result);
  const mechanical = saltus.isMechanical(result);
  const byKind = new Map();
  for (const curve of curves) {
    const kind = kindOf(curve);
    // Without gravity a velocity changes at impacts only, and is a velocity still.
    const steps = (curve.discrete || curve.stepwise) && kind !== "velocity";
    const key = `${kind} ${curve.caption?.unit ?? ""} ${steps}`;
    byKind.set(key, [...(byKind.get(key) ?? []), curve]);
  }
  if (curves.length <= saltus.singlePanels && !mechanical) return curves.map((curve) => [curve]);
  return [...byKind.values()].flatMap((group) => saltus.groupCurves(group, mechanical ? 1 : saltus.singlePanels));
};

/** What stands at the axis of a panel: the column with its unit, or the kind of several and the unit that all have. */
saltus.panelTitle = (panel, kindOf) => {
  if (panel.curves.length === 1) return saltus.columnTitle(panel.curves[0]);
  const kinds = new Set(panel.curves.map(kindOf));
  const units = new Set(panel.curves.map(({caption}) => caption?.unit ?? ""));
  const [kind] = kinds;
  const words = {alpha: "selection α", theta: "weight θ", state: "states", input: "inputs", output: "outputs"};
  const [unit] = units;
  const word = kinds.size === 1 ? (words[kind] ?? kind) : "";
  return `${word}${units.size === 1 && unit !== "" ? ` [${unit}]` : ""}`.trim();
};
