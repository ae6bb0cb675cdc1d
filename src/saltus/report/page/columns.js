// The columns of a trajectory: what can be drawn over time and along the axes of phase space, and what is drawn first.
"use strict";

/** Where the columns of a sort lie in a trajectory. */
saltus.columnTables = {state: "x", output: "outputs", input: "u", alpha: "alpha", theta: "theta"};

/** A column as it is called in drawings: selections by their sign. */
saltus.columnLabel = ({name, sort}) => ({alpha: `α(${name})`, theta: `θ(${name})`})[sort] ?? name;

/** The same on an axis: with its unit. */
saltus.columnTitle = (column) => `${saltus.columnLabel(column)}${column.caption?.unit ? ` [${column.caption.unit}]` : ""}`;

/** Letters of a line beside a panel. */
saltus.lineLetters = 18;

/** The same beside a panel: the unit on a line of its own if it is long, and behind it what the model says. */
saltus.columnLines = (column, alone = true) => {
  const title = saltus.columnTitle(column);
  const {unit = "", label = ""} = column.caption ?? {};
  const fits = title.length <= saltus.lineLetters || unit === "" || !alone;
  return [...(fits ? [title] : [saltus.columnLabel(column), `[${unit}]`]), ...(alone && label !== "" ? [label] : [])];
};

/** Unit and label of a name, as the model states them. */
saltus.captionOf = (result, name) => result.captions?.[name] ?? {unit: "", label: ""};

/** The values of a column in a trajectory, that of a branch for example. */
saltus.columnOf = (trajectory, {sort, index}) =>
    sort === "time" ? trajectory.t : trajectory[saltus.columnTables[sort]][index];

/** Whether a column changes by more than rounding. */
saltus.moves = (values) => saltus.isWide(saltus.range(values));
saltus.isWide = ([least, greatest]) => greatest - least > 1e-12 * Math.max(Math.abs(least), Math.abs(greatest));

/** What a column is kept by, without unpacking it; null where all of it is there. */
saltus.keptColumn = (trajectory, {sort, index}) =>
    saltus.packedOf.get(trajectory[saltus.columnTables[sort]])?.[index] ?? null;

/** Whether the column changes at doubled rows only, and whether it is piecewise constant. */
saltus.isDiscreteColumn = (trajectory, column) => {
  const kept = saltus.keptColumn(trajectory, column);
  if (kept === null || kept.places === null)
    return saltus.isDiscrete(trajectory.t, kept?.values ?? saltus.columnOf(trajectory, column));
  return saltus.isDiscrete(Array.from(kept.places, (place) => trajectory.t[place]), kept.values);
};
saltus.isStepwiseColumn = (trajectory, column) => {
  const kept = saltus.keptColumn(trajectory, column);
  return kept === null || kept.places === null ? saltus.isStepwise(kept?.values ?? saltus.columnOf(trajectory, column)) :
                                                 saltus.isDiscreteColumn(trajectory, column);
};

/** All columns, states first in their order, so that the number of a state is that of its column. */
saltus.columns = (result) => {
  const held = saltus.columnsOf.get(result);
  if (held !== undefined) return held;
  const {trajectory} = result;
  const tolerance = saltus.absoluteTolerance(result);
  const names = {
    state: result.states,
    output: result.output_names,
    input: result.controls,
    alpha: result.switching_functions,
    theta: result.regions,
  };
  const columns = Object.entries(names).flatMap(([sort, list]) => (list ?? []).map((name, index) => {
    const place = {sort, index};
    const column = {
      name,
      ...place,
      tolerance,
      caption: ["state", "output", "input"].includes(sort) ? saltus.captionOf(result, name) : null,
      stepwise: sort === "input" && saltus.isStepwiseColumn(trajectory, place),
      discrete: sort === "state" && saltus.isDiscreteColumn(trajectory, place),
    };
    saltus.lazily(column, "values", () => saltus.columnOf(trajectory, place));
    saltus.lazily(
        column, "range", () => saltus.range(saltus.keptColumn(trajectory, place)?.values ?? column.values));
    return column;
  }));
  saltus.columnsOf.set(result, columns);
  return columns;
};
saltus.columnsOf = new WeakMap();

/** What an axis of phase space can be: every column, and the time behind them. */
saltus.axes = (result) =>
    [...saltus.columns(result), {name: "t", sort: "time", index: 0, values: result.trajectory.t}];

/** As many curves, and bands of modes, are drawn at first; the others wait in the list of columns. */
saltus.firstCurves = (columns) => (columns.length > 200 ? 16 : 48);
saltus.firstBands = (columns) => (columns.length > 200 ? 8 : 24);

/** The absolute tolerance of the run; the default one where its method has none. */
saltus.absoluteTolerance = (result) => {
  const found = (result.options ?? []).find(([name]) => name === "simulate.atol");
  return typeof found?.[1] === "number" ? found[1] : 1e-10;
};

/**
 * Columns of a sort that move by more than their own rounding. What is below the tolerance of the run counts as that of
 * others, too: it is rounding if it is that of the largest among them.
 */
saltus.movingOf = (columns) => {
  const largest = columns.reduce((most, {range}) => Math.max(most, Math.abs(range[0]), Math.abs(range[1])), 0);
  return columns.filter(
      ({range, tolerance}) => saltus.isWide(range) && range[1] - range[0] > Math.min(tolerance, 1e-15 * largest));
};

/** Columns of a sort that move, all if none does; of very many those that move most; discrete ones last. */
saltus.movingFirst = (columns) => {
  const moving = saltus.movingOf(columns);
  const shown = moving.length > 0 ? moving : columns;
  const size = ({range: [least, greatest]}) => greatest - least;
  const most = new Set([...shown].sort((a, b) => size(b) - size(a)).slice(0, saltus.firstCurves(columns)));
  const kept = shown.filter((column) => most.has(column));
  return [...kept.filter((column) => !column.discrete), ...kept.filter((column) => column.discrete)];
};

/** Bands of modes at first: all if there are few, else those whose mode changes. */
saltus.movingBands = (result) => {
  const bands = saltus.bandIntervals(result);
  const all = bands.map((_, i) => i);
  if (all.length <= saltus.firstBands(all)) return all;
  const changing = all.filter((i) => new Set(bands[i].values).size > 1);
  return (changing.length > 0 ? changing : all).slice(0, saltus.firstBands(all));
};

/** The panels at first, from top to bottom, as numbers of columns; and the bands of modes. */
saltus.firstPanels = (result) => {
  const columns = saltus.columns(result);
  const numbers = new Map(columns.map((column, i) => [column, i]));
  const of = (sort) => columns.filter((column) => column.sort === sort);
  const kindOf = saltus.kindsOfColumns(result);
  const groups = ["state", "output", "input"].flatMap((sort) => saltus.panelsByKind(result, saltus.movingFirst(of(sort))));
  for (const sort of ["alpha", "theta"]) {
    const selections = of(sort);
    const all = saltus.movingFirst(selections).slice(0, saltus.firstBands(selections));
    for (let i = 0; i < all.length; i += saltus.perPanel) groups.push(all.slice(i, i + saltus.perPanel));
  }
  const isLast = (group) => group.every((column) => column.discrete && kindOf(column) !== "velocity");
  const ordered = [...groups.filter((group) => !isLast(group)), ...groups.filter(isLast)];
  return {
    panels: ordered.map((group) => ({curves: group.map((column) => numbers.get(column)), log: false})),
    bands: saltus.movingBands(result),
  };
};

/** A choice of panels as text for the address: "0,1+2,l3;0,1" (l: logarithmic; behind the semicolon the bands). */
saltus.panelsText = ({panels, bands}) =>
    `${panels.map(({curves, log}) => `${log ? "l" : ""}${curves.join("+")}`).join(",")};${bands.join(",")}`;

/** The choice that such a text stands for; null if it does not fit the result. */
saltus.panelsFromText = (result, text) => {
  const match = /^((?:l?\d+(?:\+\d+)*(?:,|(?=;)))*);((?:\d+(?:,|$))*)$/.exec(text ?? "");
  if (match === null) return null;
  const list = (part) => part.split(",").filter((entry) => entry !== "");
  const panels = list(match[1]).map(
      (entry) => ({log: entry.startsWith("l"), curves: entry.replace("l", "").split("+").map(Number)}));
  const bands = list(match[2]).map(Number);
  const fits = panels.every(({curves}) => curves.every((i) => i < saltus.columns(result).length)) &&
      bands.every((i) => i < saltus.bands(result).length);
  return fits ? {panels, bands} : null;
};

/** Axes as text for the address: "1,0"; null if they do not fit the result. */
saltus.axesFromText = (result, text, size = 2) => {
  if (!/^\d+(,\d+)*$/.test(text ?? "")) return null;
  const axes = text.split(",").map(Number);
  return axes.length === size && axes.every((i) => i < saltus.axes(result).length) ? axes : null;
};
