// Other continuations that were followed: thin dashed curves beside the trajectory, and a list of the tree.
"use strict";

/** The column of a branch that belongs to a curve of the drawing. */
saltus.branchColumn = (branch, curve) => saltus.columnOf(branch.trajectory, curve);

/** One path for the given columns of all branches, cut between them; `columns(branch)` gives one list for each axis. */
saltus.branchPath = (branches, columns, window, buckets) => {
  const path = [];
  for (const branch of branches) {
    const {t} = branch.trajectory;
    if (t.length === 0 || t[t.length - 1] < window[0] || t[0] > window[1]) continue;
    const lists = columns(branch);
    const rows = saltus.rowsToDraw(t, lists, saltus.rowsInWindow(t, window), buckets);
    lists.forEach((list, axis) => {
      path[axis] ??= [];
      // The first of the two rows of the event it left at is the parent's: it joins the curves.
      for (const i of rows) path[axis].push(list[i]);
      path[axis].push(null);
    });
  }
  return path;
};

/** All branches as one trace, and the chosen one solid on top. `trace(path)` says what a path is drawn as. */
saltus.branchTraces = (result, chosen, columns, view, trace) => {
  const {branches} = result;
  if (branches.length === 0) return [];
  const style = (some, line) => {
    const path = saltus.branchPath(some, columns, view.window, view.pixels);
    return path.length === 0 ? [] : [{...trace(path), line: {simplify: false, ...line}}];
  };
  const others = branches.filter((_, i) => i !== chosen);
  return [
    ...style(others, {width: 1.1, dash: "dash"}),
    ...(chosen === null ? [] : style([branches[chosen]], {width: 2.4, dash: "solid"})),
  ];
};

/** The branches in a plane or a space of states, in the colour of the curve. */
saltus.branchOrbits = (result, choice, view, palette, type) =>
    saltus
        .branchTraces(
            result, view.branch, (branch) => choice.map((i) => saltus.columnOf(branch.trajectory, saltus.axes(result)[i])), view,
            ([x, y, z]) => ({
              type,
              mode: "lines",
              x,
              y,
              ...(z === undefined ? {} : {z}),
              hoverinfo: "skip",
              connectgaps: false,
            }))
        .map((trace) => ({
               ...trace,
               name: trace.line.dash === "solid" ? saltus.plain(`branch ${result.branches[view.branch].label}`) :
                                                   "branches",
               line: {...trace.line, color: palette.curves[0]},
             }));

/** The branches of one curve over time. */
saltus.branchCurves = (result, curve, axis, color, view) =>
    saltus
        .branchTraces(
            result, view.branch, (branch) => [branch.trajectory.t, saltus.branchColumn(branch, curve)], view,
            ([x, y]) => ({...saltus.lineOverTime(axis, x, y), meta: "branches"}))
        .map((trace) => ({...trace, line: {...trace.line, color}}));

saltus.branchEnd = (branch) => {
  const pieces = branch.final.x.slice(0, 3).map((value) => saltus.brief(value, 6));
  return `(${pieces.join(", ")}${branch.final.x.length > 3 ? ", …" : ""})`;
};

/**
 * The tree as a list, or null if nothing was followed.
 * @param actions  select(event) of the trajectory itself, choose(number of a branch, or null)
 */
saltus.branchCard = (result, actions) => {
  const {branches, not_followed: left} = result;
  if (branches.length === 0) return null;
  const rows = branches.map((branch, i) => {
    const depth = branch.label.split(".").length;
    const {event} = branch.left_at;
    const later = branch.left_at.later ? "after " : "";
    const place = branch.parent === 0 ? saltus.element(
                                            "button", {
                                              title: "show this event",
                                              onclick: (e) => {
                                                e.stopPropagation();
                                                actions.select(event);
                                              }
                                            },
                                            `${later}event ${event + 1}`) :
                                        `${later}event ${event + 1} of ${branches[branch.parent - 1].label}`;
    const cells = [
      "\u2003".repeat(depth - 1) + branch.label, place, saltus.brief(branch.left_at.t, 8),
      branch.left_at.regions === null ? saltus.modeBoxes(branch.left_at.mode) :
                                        saltus.regionsText(branch.left_at.regions),
      String(branch.events),
      `${branch.status.termination.replaceAll("_", " ")} at t = ${saltus.brief(branch.status.time_reached, 6)}`,
      saltus.branchEnd(branch)
    ];
    return saltus.element(
        "tr", {class: branch.status.done ? null : "alarming", title: branch.status.message, onclick: () => pick(i)},
        ...cells.map((cell, column) => saltus.element("td", column > 1 ? {class: "digits"} : {}, cell)));
  });
  const pick = (i) => {
    const next = actions.chosen() === i ? null : i;
    rows.forEach((row, k) => row.classList.toggle("selected", k === next));
    actions.choose(next);
  };
  const head = ["branch", "leaves at", "t", "into", "events", "ends", "with x"];
  const more =
      left === 0 ? "" : ` ${saltus.count(left, "further continuation")} ${left === 1 ? "was" : "were"} not followed.`;
  return saltus.element(
      "section", {class: "card branches"},
      saltus.element("header", {}, saltus.element("h2", {}, saltus.count(branches.length, "branch", "branches"))),
      saltus.element(
          "table", {class: "events"},
          saltus.element("thead", {}, saltus.element("tr", {}, ...head.map((text) => saltus.element("th", {}, text)))),
          saltus.element("tbody", {}, ...rows)),
      saltus.element(
          "p", {class: "quiet note"}, `Branches are dashed in the drawings. Click a row to draw its branch solid.${more}`));
};

/** The continua of other solutions, in words, one row each; null if there are none. */
saltus.familyCard = (result) => {
  const {families} = result;
  if (families.length === 0) return null;
  const most = 32;
  const place = ({of, event}) => `${of === 0 ? "" : `branch ${result.branches[of - 1].label}, `}event ${event + 1}`;
  const rows = families.slice(0, most).map((family) => {
    const spiral = family.kind === "spiral";
    return saltus.element(
        "tr", {},
        ...[spiral ? "spirals of any phase" : "leaves at any later time", place(family),
            spiral ? saltus.brief(family.from, 8) :
                     `${saltus.brief(family.from, 8)} to ${saltus.brief(family.until, 8)}`,
            family.regions.length > 0 ? saltus.regionsText(family.regions) : saltus.modeBoxes(family.mode)]
            .map((cell, column) => saltus.element("td", column > 1 ? {class: "digits"} : {}, cell)));
  });
  const head = ["family", "after", "t", "into"];
  const more = families.length > most ? ` ${families.length - most} more are in the result.` : "";
  return saltus.element(
      "section", {class: "card branches"},
      saltus.element(
          "header", {},
          saltus.element("h2", {}, saltus.count(families.length, "family of solutions", "families of solutions"))),
      saltus.element(
          "table", {class: "events"},
          saltus.element("thead", {}, saltus.element("tr", {}, ...head.map((text) => saltus.element("th", {}, text)))),
          saltus.element("tbody", {}, ...rows)),
      saltus.element(
          "p", {class: "quiet note"},
          `Each family is a continuum of solutions. The option simulate.event.members follows some of each.${more}`));
};
