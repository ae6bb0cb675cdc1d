// The table of a sweep: what was swept, runs and how they ended, events.
"use strict";

/** How runs end that did what was asked; where others stopped is no end of theirs. */
saltus.doneStatuses = ["completed", "stopped_by_event"];

/** Reads the data of the page; rows are numbers of rows of the table. */
saltus.sweepTable = (data) => {
  const {columns, swept} = data;
  const names = Object.keys(columns);
  const isNumber = (name) => columns[name].every((value) => value === null || typeof value === "number");
  // Events and trajectories have several rows for a run: the last one of a trajectory is its end.
  const rowOf = new Map();
  columns.run.forEach((run, row) => {
    if (!columns.kind || !rowOf.has(run)) rowOf.set(run, row);
  });
  const runRows = [...rowOf.values()];
  const isDone = (row) => saltus.doneStatuses.includes(columns.status[row]);
  const eventsOf = (row) => columns.events?.[row] ?? null;
  // Of kept events; a run without one has a row that names none.
  const eventRows = columns.kind ? columns.run.map((_, row) => row).filter((row) => columns.kind[row]) : [];
  const kindOf = (row) => columns.name[row] ||
      (columns.surfaces[row] ? `${columns.kind[row]} ${columns.surfaces[row]}` : columns.kind[row]);
  // What the model calls an event comes first: at a switching surface its own value is a threshold. All begin with a start.
  const ranked = [
    ...eventRows.filter((row) => columns.name[row]), ...eventRows.filter((row) => columns.kind[row] !== "start"), ...eventRows
  ];
  const hidden = ["run", "event", "events", "unique", ...swept];
  return {
    columns,
    swept,
    runRows,
    eventRows,
    kindOf,
    isNumber,
    isDone,
    eventsOf,
    kinds: [...new Set(ranked.map(kindOf))],
    values: names.filter((name) => isNumber(name) && !hidden.includes(name) && !name.endsWith("(end)")),
    // Label and unit of a column; what is no column says itself.
    axisOf: (name) => data.axes[names.indexOf(name)] || name,
    // Other solutions are admissible (older tables do not say it).
    isAlarming: (row) => columns.unique?.[row] === 0,
    hasAllEvents: eventRows.length === runRows.reduce((sum, row) => sum + eventsOf(row), 0),
    at: (name, row) => columns[name][row],
  };
};

saltus.sweepNumber = (value) => (value === null ? "nan" : typeof value === "number" ? saltus.brief(value, 6) : value);

/** What is to be said of a run beside its values. */
saltus.runDoubts = (table, row) => {
  if (table.isAlarming(row)) return "the solution is not unique, --branch all follows the others (but those of contacts)";
  return table.columns.unique?.[row] < 0 ? "uniqueness not decided" : "";
};
saltus.runNote = (table, row) => {
  const said = table.isDone(row) ? saltus.runDoubts(table, row) : table.columns.status[row];
  return said === "" ? "" : `; ${said}`;
};

/** "run 3: Kr = 0.1, Kp = 2; completed, 14 events". */
saltus.runText = (table, row) => {
  const values = table.swept.map((name) => `${name} = ${saltus.sweepNumber(table.at(name, row))}`).join(", ");
  const events = table.eventsOf(row);
  const doubts = saltus.runDoubts(table, row);
  return `run ${table.columns.run[row]}: ${values}; ${table.columns.status[row]}, ${events} event${events === 1 ? "" : "s"}${
      doubts === "" ? "" : `; ${doubts}`}`;
};

/** What runs this one alone. */
saltus.runCommand = (table, data, row) => {
  const settings = table.swept.map((name, k) => `--set ${data.names[k]}=${table.at(name, row) ?? "nan"}`);
  const unknown = "The shares do not say their model and its other settings. What was changed:";
  const page = data.command ? [`--report run${table.columns.run[row]}.html`] : [];
  return [data.command || unknown, ...settings, ...page].join(" ");
};

/** Value at the end of a run, of a table of events; null where it is not known. */
saltus.endValue = (table, name, row) => name === "t" ? null : table.columns[`${name.replace(/\(after\)$/, "")}(end)`]?.[row] ?? null;

/** Rows of runs that came to their end without an event of a kind after a time: the state rests, or moves without them. */
saltus.quietRuns = (table, kind, after) => {
  const isOne = (row) => table.kindOf(row) === kind && table.columns.kind[row] !== "start" && table.columns.t[row] > after;
  const moving = new Set(table.eventRows.filter(isOne).map((row) => table.columns.run[row]));
  const isThere = (row) => table.isDone(row) && (table.columns["t(end)"]?.[row] ?? -Infinity) > after;
  return table.runRows.filter((row) => isThere(row) && !moving.has(table.columns.run[row]));
};

/** The first value that varies nearly as much as any, for its size: at a surface a value is its threshold in every run. */
saltus.variedValue = (table) => {
  const {columns, kinds, values} = table;
  const of = kinds.length > 0 ? table.eventRows.filter((row) => table.kindOf(row) === kinds[0]) : table.runRows;
  const names = values.filter((name) => name !== "t");
  const ranges = names.map((name) => saltus.finiteRange(of.map((row) => columns[name][row])));
  const sizes = ranges.map((range) => (range === null ? 0 : Math.max(Math.abs(range[0]), Math.abs(range[1]))));
  // What is that small is rounding.
  const least = 1e-12 * Math.max(0, ...sizes);
  const scores = ranges.map((range, k) => (sizes[k] > least ? (range[1] - range[0]) / sizes[k] : 0));
  const best = Math.max(0, ...scores);
  return names[scores.findIndex((score) => score >= best / 4)] ?? values[0];
};
