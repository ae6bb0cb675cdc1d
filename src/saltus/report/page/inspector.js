// Everything about one event.
"use strict";

saltus.modeTable = (result, event) => {
  const cell = (values, i) => (values === null ? "–" : saltus.brief(values[i], 10));
  const box = (mode, i) => (mode === null ? "–" : saltus.modeBoxes([mode[i]]));
  const rows = result.switching_functions.map(
      (name, i) =>
          [name, box(event.mode_before, i), box(event.mode_after, i), cell(event.alpha_before, i),
           cell(event.alpha_after, i)]);
  return saltus.plainTable(["", "before", "after", "α before", "α after"], rows);
};

saltus.alternatives = (event) => event.alternatives.map((other, i) => {
  const alpha = `(${other.alpha.map((value) => saltus.brief(value, 8)).join(", ")})`;
  const modes = other.mode.length === 0 ?
      [] :
      ["mode ", saltus.modeBoxes(other.mode), ", α = ", saltus.element("span", {class: "digits"}, alpha)];
  const regions = other.regions.length === 0 ? [] : [`regions ${saltus.regionsText(other.regions)}`];
  const comma = modes.length > 0 && regions.length > 0 ? [", "] : [];
  return saltus.element("p", {}, `alternative ${i + 1}: `, ...modes, ...comma, ...regions);
});

/** Weights of the modes by `indicator` on both sides of an event, from the rows of the trajectory. */
saltus.weightTable = (result, event) => {
  const {t, theta} = result.trajectory;
  const row = saltus.lowerBound(t, event.t);
  if (t[row] !== event.t) return [];
  const [first, last] = saltus.rowsAtOneTime(t, row);
  const rows =
      result.regions.map((name, i) => [name, saltus.brief(theta[i][first], 10), saltus.brief(theta[i][last], 10)]);
  return [saltus.plainTable(["", "θ before", "θ after"], rows)];
};

saltus.plainTable = (head, rows) => saltus.element(
    "table", {class: "plain"},
    saltus.element("thead", {}, saltus.element("tr", {}, ...head.map((text) => saltus.element("th", {}, text)))),
    saltus.element(
        "tbody", {},
        ...rows.map(
            (row) => saltus.element(
                "tr", {},
                ...row.map(
                    (content, i) => saltus.element("td", i > 0 ? {class: "digits"} : {title: content}, content))))));

saltus.stateTable = (result, event) => {
  const jumps = String(event.x) !== String(event.x_after);
  const rows = result.states.map(
      (name, i) => [name, saltus.exact(event.x[i]), ...(jumps ? [saltus.exact(event.x_after[i])] : [])]);
  return saltus.plainTable(jumps ? ["", "x before", "x after"] : ["", "x"], rows);
};

saltus.inspector = (result, actions) => {
  const element = saltus.element("section", {class: "inspector"});
  const button = (text, title, onclick) => saltus.element("button", {title, onclick}, text);
  const show = (i) => {
    element.hidden = i === null;
    if (i === null) return;
    const event = result.events[i];
    const verdict = {
      true: null,
      false: saltus.element(
          "p", {class: "alarm-text"},
          `The solution is not unique here; ${
              event.alternatives.length === 0 ? "no other continuation is recorded" :
                                                saltus.count(event.alternatives.length, "other continuation")}.`),
      null: saltus.element("p", {class: "undecided"}, "Whether the solution is unique here was not decided."),
    }[String(event.unique)];
    element.replaceChildren(
        saltus.element(
            "header", {},
            saltus.element("h3", {}, `${saltus.kindSign(event.kind)} Event ${i + 1}: ${saltus.kindLabel(event.kind)}`),
            button("◀", "previous event", () => actions.step(i, -1)),
            button("▶", "next event", () => actions.step(i, 1)),
            button("zoom", "show the neighbourhood of this event", () => actions.zoomTo(i)),
            button("✕", "deselect", () => actions.select(null))),
        saltus.element(
            "p", {}, "t = ", saltus.element("span", {class: "digits"}, saltus.exact(event.t)),
            event.name === null ? "" : `, name: ${saltus.eventName(event)}`,
            event.surfaces.length === 0 ? "" : `, on ${event.surfaces.join(", ")}`),
        ...(verdict === null ? [] : [verdict]), ...saltus.alternatives(event),
        ...(event.reason === "" ? [] : [saltus.element("p", {}, event.reason)]),
        saltus.element(
            "div", {class: "tables"},
            ...(result.switching_functions.length > 0 ? [saltus.modeTable(result, event)] : []),
            ...(result.regions.length > 0 ? saltus.weightTable(result, event) : []), saltus.stateTable(result, event)));
  };
  show(null);
  return {element, show};
};
