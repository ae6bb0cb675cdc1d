// States against each other over the window of time of the drawing: what a plane and a space of three have in common.
"use strict";

/** Points of the curve, cut where sliding begins or ends (the border belongs to both parts), and the jumps. */
saltus.phaseParts = (result, columns, rows, sliding) => {
  const {t} = result.trajectory;
  const part = () => columns.map(() => []);
  const parts = {free: part(), sliding: part(), jumps: part()};
  const leastJumps = columns.map(saltus.leastJump);
  const starts = sliding.map((interval) => interval[0]);
  const slides = (time) => {
    const i = saltus.lowerBound(starts, time);
    const interval = starts[i] === time ? sliding[i] : sliding[i - 1];
    return interval !== undefined && time < interval[1];
  };
  const push = (into, i) => columns.forEach((column, axis) => into[axis].push(i === null ? null : column[i]));
  let current = null;
  for (let n = 0; n + 1 < rows.length; n += 1) {
    const [i, k] = [rows[n], rows[n + 1]];
    const jump = columns.some((column, c) => saltus.jumpsBetween(t, column, i, k, leastJumps[c]));
    if (t[i] === t[k] && !jump) continue;
    const into = slides((t[i] + t[k]) / 2) ? parts.sliding : parts.free;
    if (jump || into !== current) {
      if (current !== null) push(current, null);
      current = jump ? null : into;
      if (!jump) push(into, i);
    }
    if (jump)
      [i, k, null].forEach((row) => push(parts.jumps, row));
    else
      push(into, k);
  }
  return parts;
};

/** What the parts of a curve are called that do not slide; where nothing can slide it is all of it. */
saltus.freeName = (result) => (saltus.bands(result).length > 0 ? "not sliding" : "trajectory");

/** The range of some values with a little room; one that is a point gets room of its own size. */
saltus.roomyRange = (values, room = 0.06) => {
  const [least, greatest] = saltus.range(values);
  const width = greatest - least;
  const more = width > 0 ? room * width : Math.max(0.1 * Math.abs(least), 1e-3);
  return [least - more, greatest + more];
};

/** Where slices of surfaces are taken: the flagged event, or the end of the window. */
saltus.slicePlace = (result, selected, rows) => {
  const event = selected === null ? null : result.events[selected];
  const timeAxis = saltus.axes(result).length - 1;
  if (event !== null && event.x_after.length === result.states.length) return {t: event.t, x: event.x_after, timeAxis};
  // Events of very many keep a few of their states only: the row of the trajectory next to it.
  const {t} = result.trajectory;
  const last = event === null ? rows[rows.length - 1] : saltus.rowsAtOneTime(t, saltus.nearestRow(t, event.t))[1];
  // Only the states that are asked for are unpacked.
  const x = new Proxy([], {get: (_, state) => result.trajectory.x[state]?.[last]});
  return {t: t[last], x, timeAxis};
};

/** What a drawing in phase space shows: rows of the window, parts of the curve, events, the box around it. */
saltus.phaseView = (result, timeline, choice, sliding, buckets) => {
  const {t} = result.trajectory;
  const window_ = timeline.window();
  const chosen = choice.map((i) => saltus.axes(result)[i]);
  const columns = chosen.map(({values}) => values);
  const rows = saltus.rowsToDraw(t, columns, saltus.rowsInWindow(t, window_), buckets)
                   .filter((i) => t[i] >= window_[0] && t[i] <= window_[1]);
  if (rows.length === 0) return null;
  const selected = timeline.selected();
  return {
    rows,
    columns,
    selected,
    branch: timeline.branch(),
    window: window_,
    pixels: buckets,
    events: saltus.visibleMarks(result, timeline.shown(), window_),
    parts: saltus.phaseParts(result, columns, rows, sliding),
    box: columns.map((column, axis) => saltus.roomyRange([
      ...rows.map((i) => column[i]),
      ...(saltus.branchPath(result.branches, (branch) => [saltus.columnOf(branch.trajectory, chosen[axis])], window_, buckets)[0] ??
          []),
      ...(saltus.branchPath(
              saltus.overlaysWith(result, chosen), (other) => [saltus.columnOf(other.trajectory, chosen[axis])], window_,
              buckets)[0] ??
          [])
    ])),
    at: saltus.slicePlace(result, selected, rows),
  };
};

saltus.surfaceStyle = (index, surface, palette) =>
    ({color: palette.surfaces[index % palette.surfaces.length], jump: surface.role === "jump"});

/** More surfaces than this are a wall. */
saltus.mostSurfaces = 40;

/** Of too many surfaces those that events of the window lie on come first. */
saltus.surfacesToDraw = (result, view, drawn) => {
  if (drawn.length <= saltus.mostSurfaces) return drawn;
  // Of all events: marks are thinned to the pixels, and some kinds may be hidden.
  const inWindow = result.events.filter(({t}) => t >= view.window[0] && t <= view.window[1]);
  const met = new Set(inWindow.flatMap(({surfaces}) => surfaces));
  const [first, others] = [true, false].map((is) => drawn.filter(({surface}) => met.has(surface.name) === is));
  return [...first, ...others].slice(0, saltus.mostSurfaces);
};

/** What a drawing of surfaces says in words: which are cuts, which move, and which it cannot show. */
saltus.surfaceNote = ({cuts = [], moving = [], absent = [], leftOut = 0}, at) => {
  const names = (list) => {
    const unique = [...new Set(list.map((surface) => surface.name))];
    const shown = unique.slice(0, 4).map((name) => saltus.shorten(name, 24)).join(", ");
    return unique.length > 4 ? `${shown} and ${unique.length - 4} more` : shown;
  };
  const when = saltus.brief(at.t, 6);
  const notes = [];
  if (cuts.length > 0) notes.push(`Sections at t = ${when}, with the other states at their values there: ${names(cuts)}.`);
  if (moving.length > 0) {
    const times = [...new Set(moving.flatMap((surface) => surface.curves.map(({t}) => saltus.brief(t, 4))))];
    notes.push(`Moving surfaces, drawn at t = ${times.slice(0, 9).join(", ")}: ${names(moving)}.`);
  }
  if (leftOut > 0)
    notes.push(`${saltus.count(leftOut, "more surface")} not drawn: those with events in the window of time come first.`);
  if (absent.length > 0) notes.push(`Not drawn, since they depend on time or on other states: ${names(absent)}.`);
  return notes.join(" ");
};

/** Of a system with contacts the moving coordinate whose velocity jumps at most events, with it; null of others. */
saltus.jumpingPair = (result) => {
  if ((result.contacts ?? []).length === 0) return null;
  const jumps = ([, v]) => result.events.filter(({x, x_after: after}) => v < x.length && x[v] !== after[v]).length;
  const columns = saltus.columns(result);
  const moving = new Set(saltus.movingOf(columns.slice(0, result.states.length)));
  const pairs = saltus.ratePairs(result).filter(([position]) => moving.has(columns[position]));
  const counted = pairs.map((pair) => ({pair, count: jumps(pair)}));
  return counted.reduce((best, one) => (best === null || one.count > best.count ? one : best), null)?.pair ?? null;
};

/**
 * Columns to begin with: the states of the first surface of moving states, filled up with the first states that move, in
 * space with the time, then with any state; in their order. A counter or a phase of a cycle shows little on an axis.
 */
saltus.firstChoice = (result, size) => {
  const mechanical = size === 2 ? saltus.jumpingPair(result) : null;
  if (mechanical !== null) return mechanical;
  const columns = saltus.columns(result).slice(0, result.states.length);
  const moving = new Set(saltus.movingOf(columns));
  const moves = (state) => moving.has(columns[state]) && !columns[state].discrete;
  const first = result.surfaces.find((surface) => surface.states.every(moves));
  const states = columns.map((_, i) => i);
  const time = size > 2 ? [saltus.axes(result).length - 1] : [];
  const ranked = [...(first?.states ?? []), ...states.filter(moves), ...time, ...states];
  return [...new Set(ranked)].slice(0, size).sort((a, b) => a - b);
};

/** Where an event stands on an axis: behind it. */
saltus.eventCoordinate = (result, i, axis) => {
  const {sort, index, values} = saltus.axes(result)[axis];
  const event = result.events[i];
  if (sort === "time") return event.t;
  if (sort === "state" && index < event.x_after.length) return event.x_after[index];
  const {t} = result.trajectory;
  return values[saltus.rowsAtOneTime(t, saltus.nearestRow(t, event.t))[1]];
};

/** What stands on an axis: what the model says about the column, and its name with the unit. */
saltus.axisLabel = (result, axis) => {
  const column = saltus.axes(result)[axis];
  return `${column.caption?.label ?? ""} ${saltus.columnTitle(column)}`.trim();
};

/** A choice of one column per axis; `changed` is called after every change of `choice`. */
saltus.axisPickers = (result, choice, changed) => {
  const axes = saltus.axes(result);
  const sorts = {state: "states", output: "outputs", input: "inputs", alpha: "selections", theta: "weights", time: "time"};
  return choice.map((_, axis) => {
    const option = (k) => saltus.element(
        "option", {value: String(k), ...(k === choice[axis] ? {selected: ""} : {})},
        saltus.shorten(saltus.columnLabel(axes[k]), 30));
    const groups = () => Object.entries(sorts).map(([sort, label]) => {
      const numbers = axes.map((_column, k) => k).filter((k) => axes[k].sort === sort);
      return numbers.length === 0 ? null : saltus.element("optgroup", {label}, ...numbers.map(option));
    });
    // Of very many not before they are wanted.
    const many = axes.length > 400;
    const fill = () => {
      if (picker.childElementCount === 1) picker.replaceChildren(...groups().filter((group) => group !== null));
    };
    const picker = saltus.element(
        "select", {
          "aria-label": `axis ${axis + 1}`,
          onchange: (e) => {
            choice[axis] = Number(e.target.value);
            changed();
          },
          ...(many ? {onfocus: fill, onpointerdown: fill} : {}),
        },
        ...(many ? [option(choice[axis])] : groups()));
    return picker;
  });
};
