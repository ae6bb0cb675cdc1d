// Which pictures the page of a sweep has, and what can be chosen for them.
"use strict";

/** What is chosen at first. */
saltus.sweepState = (table, data) => ({
  value: saltus.variedValue(table),
  x: table.swept[0],
  kind: table.kinds[0],
  after: -Infinity,
  // Of other parameters the value that is drawn; null: all of them.
  only: Object.fromEntries(table.swept.map((name) => [name, null])),
  asMap: table.swept.length === 2 && data.grid,
});

/** Parameters beside the one along the axis. */
saltus.otherParameters = ({table, state}) => table.swept.filter((name) => name !== state.x);

saltus.sweepControls = (page, changed) => {
  const {table, state, data} = page;
  const selector = (label, options, value, choose) => {
    const select = saltus.element(
        "select", {onchange: () => { choose(select.value); changed(); }},
        ...options.map(([key, text]) => saltus.element("option", {value: key, ...(key === value ? {selected: ""} : {})}, text)));
    return saltus.element("label", {}, `${label} `, select);
  };
  const same = (names) => names.map((name) => [name, name]);
  const valuesOf = (name) => [...new Set(table.runRows.map((row) => table.at(name, row)))];
  const only = saltus.element("span", {class: "switches"});
  const fillOnly = () => only.replaceChildren(...saltus.otherParameters(page).filter((name) => valuesOf(name).length <= 200).map((name) => {
    const values = valuesOf(name);
    const options = [["all", "all, by colour"], ...values.map((value, k) => [String(k), saltus.sweepNumber(value)])];
    const held = state.only[name] === null ? "all" : String(values.indexOf(state.only[name]));
    return selector(name, options, held, (key) => (state.only[name] = key === "all" ? null : values[Number(key)]));
  }));
  fillOnly();
  const after = saltus.element("input", {
    type: "number",
    step: "any",
    class: "after",
    onchange: () => {
      state.after = after.value === "" ? -Infinity : Number(after.value);
      changed();
    },
  });
  const over = (value) => {
    state.only = Object.fromEntries(table.swept.map((name) => [name, null]));
    state.x = value;
    fillOnly();
  };
  const grid = table.swept.length === 2 && data.grid;
  return [
    ...(table.values.length > 0 ? [selector("value", same(table.values), state.value, (value) => (state.value = value))] : []),
    ...(table.swept.length > 1 ? [selector("over", same(table.swept), state.x, over)] : []), only,
    ...(grid ? [selector("drawn as", [["map", "map"], ["curves", "curves"]], "map", (value) => (state.asMap = value === "map"))] : []),
    ...(table.kinds.length > 0 ?
            [
              selector("event", same(table.kinds), state.kind, (kind) => (state.kind = kind)),
              saltus.element("label", {title: "events of the transient before it are left out"}, "after t ", after)
            ] :
            []),
    saltus.element("span", {class: "quiet help"}, "drag: zoom, with Shift: move, double click: all"),
  ];
};

/** Rows of the parameters that are chosen. */
saltus.chosenRows = (page, rows) => rows.filter((row) => saltus.otherParameters(page).every(
    (name) => page.state.only[name] === null || page.table.at(name, row) === page.state.only[name]));

/** Colour of a run: by the first other parameter of which all values are drawn. */
saltus.runColours = (page) => {
  const {table, state} = page;
  const by = saltus.otherParameters(page).find((name) => state.only[name] === null);
  const [usual] = saltus.palette().curves;
  if (by === undefined) return {colourOf: () => usual, legend: []};
  const {of, legend} = saltus.coloursOfValues(by, table.runRows.map((row) => table.at(by, row)));
  return {colourOf: (row) => of(table.at(by, row)), legend};
};

/** The diagram of values at events, with ends of runs that have none. */
saltus.eventPicture = (page, colours) => {
  const {table, state} = page;
  const rows = saltus.chosenRows(page, table.eventRows)
                   .filter((row) => table.kindOf(row) === state.kind && table.columns.t[row] > state.after);
  const ends = saltus.chosenRows(page, saltus.quietRuns(table, state.kind, state.after)).flatMap((row) => {
    const value = saltus.endValue(table, state.value, row);
    return value === null ? [] : [[row, value]];
  });
  const stopped = saltus.chosenRows(page, table.runRows).filter((row) => !table.isDone(row));
  const after = state.after > -Infinity ? ` after t = ${saltus.sweepNumber(state.after)}` : "";
  const plot = {x: state.x, rows, yOf: (row) => table.at(state.value, row), colourOf: colours.colourOf, joined: false, stopped, ends};
  const endLegend = ends.length === 0 ? [] : [saltus.element("span", {class: "quiet"}, `◇ at the end, where a run has no "${state.kind}"`)];
  return {
    title: `${state.value} at every event "${state.kind}"${after}`,
    legend: [...colours.legend, ...endLegend],
    make: (width, zoom) => saltus.pointsPicture(
        table, `${state.value} at events`, width, plot, zoom, table.axisOf(state.value)),
  };
};

/** A number of every run: over one parameter, or as a map over two. */
saltus.numberPicture = (page, colours, title, of) => {
  const {table, state, data} = page;
  const valueOf = (row) => (table.isDone(row) ? of(row) : null);
  const rows = saltus.chosenRows(page, table.runRows);
  const others = saltus.otherParameters(page);
  if (state.asMap && others.length === 1 && state.only[others[0]] === null) {
    const [low, high] = saltus.finiteRange(rows.map(valueOf)) ?? [0, 1];
    const plot = {x: state.x, y: others[0], rows, valueOf, colourOf: (value) => saltus.scaleColour(high > low ? (value - low) / (high - low) : 0.5)};
    return {
      title,
      legend: low < high ? saltus.scaleLegend("", low, high) : saltus.swatches("", [[saltus.scaleColour(0.5), `${saltus.sweepNumber(low)} in all runs`]]),
      make: (width, zoom) => saltus.mapPicture(table, title, width, plot, zoom),
    };
  }
  const groupOf = (row) => others.map((name) => String(table.at(name, row))).join("\n");
  const plot = {
    x: state.x, rows, yOf: valueOf, groupOf, colourOf: colours.colourOf, stopped: rows.filter((row) => !table.isDone(row)),
    // Random samples are no line.
    joined: data.grid && table.isNumber(state.x),
  };
  return {title, legend: colours.legend, make: (width, zoom) => saltus.pointsPicture(table, title, width, plot, zoom, table.axisOf(title))};
};

/** How the runs ended, where they ended in several ways. */
saltus.statusPicture = (page) => {
  const {table, state} = page;
  const statuses = [...new Set(table.columns.status)];
  if (statuses.length < 2) return [];
  const statusOf = (row) => table.columns.status[row];
  const rows = saltus.chosenRows(page, table.runRows);
  const colourOf = (status) => saltus.statusColour(statuses, status);
  const others = saltus.otherParameters(page);
  const isMap = state.asMap && others.length === 1 && state.only[others[0]] === null;
  const legend = saltus.swatches("", statuses.map((status) => [colourOf(status), status]));
  const make = isMap ?
      (width, zoom) => saltus.mapPicture(table, "status", width, {x: state.x, y: others[0], rows, valueOf: statusOf, colourOf}, zoom) :
      (width, zoom) => saltus.pointsPicture(
          table, "status", width, {x: state.x, rows, yOf: statusOf, colourOf: (row) => colourOf(statusOf(row)), joined: false}, zoom, "status");
  return [{title: "status", legend, make}];
};

saltus.sweepPictures = (page) => {
  const {table, state} = page;
  if (table.runRows.length === 0 || table.swept.length === 0) return [];
  const colours = saltus.runColours(page);
  const numbers = (title, of) => saltus.numberPicture(page, colours, title, of);
  const pictures = [];
  if (table.kinds.length > 0) {
    pictures.push(saltus.eventPicture(page, colours));
  } else if (!table.columns.kind && state.value !== undefined) {
    pictures.push(numbers(state.value, (row) => table.at(state.value, row)));
  }
  // Of the chosen kind where all events are there: two pictures of numbers would look alike.
  const after = state.after > -Infinity ? ` after t = ${saltus.sweepNumber(state.after)}` : "";
  if (table.kinds.length > 0 && table.hasAllEvents) {
    const counts = new Map();
    for (const row of table.eventRows) {
      if (table.kindOf(row) === state.kind && table.columns.t[row] > state.after)
        counts.set(table.columns.run[row], (counts.get(table.columns.run[row]) ?? 0) + 1);
    }
    pictures.push(numbers(`number of events "${state.kind}"${after}`, (row) => counts.get(table.columns.run[row]) ?? 0));
  } else {
    pictures.push(numbers("number of events", table.eventsOf));
  }
  return [...pictures, ...saltus.statusPicture(page)];
};
