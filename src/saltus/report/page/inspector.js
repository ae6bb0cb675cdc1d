// Everything about one event.
"use strict";

saltus.modeTable = (result, event) => {
  const cell = (values, i) => (values === null ? "–" : saltus.exact(values[i]));
  const box = (mode, i) => (mode === null ? "–" : saltus.modeBoxes([mode[i]]));
  const others = event.alternatives.flatMap((other, k) => [`alternative ${k + 1}`, "α"]);
  const head = ["", "before", "after", "α before", "α after", ...others];
  const rows = result.switching_functions.map((name, i) => [
    name, box(event.mode_before, i), box(event.mode_after, i), cell(event.alpha_before, i), cell(event.alpha_after, i),
    ...event.alternatives.flatMap((other) => [box(other.mode, i), cell(other.alpha, i)]),
  ]);
  return saltus.plainTable(head, rows);
};

saltus.plainTable = (head, rows) =>
  saltus.element("table", { class: "plain" },
    saltus.element("thead", {}, saltus.element("tr", {}, ...head.map((text) => saltus.element("th", {}, text)))),
    saltus.element("tbody", {}, ...rows.map((row) =>
      saltus.element("tr", {}, ...row.map((content, i) => saltus.element("td", { class: i > 0 ? "digits" : "" }, content))))));

saltus.stateTable = (result, event) => {
  const jumps = String(event.x) !== String(event.x_after);
  const rows = result.states.map((name, i) => [name, saltus.exact(event.x[i]), ...(jumps ? [saltus.exact(event.x_after[i])] : [])]);
  return saltus.plainTable(jumps ? ["", "x before", "x after"] : ["", "x"], rows);
};

saltus.inspector = (result, actions) => {
  const element = saltus.element("section", { class: "inspector" });
  const button = (text, title, onclick) => saltus.element("button", { title, onclick }, text);
  const show = (i) => {
    element.hidden = i === null;
    if (i === null) return;
    const event = result.events[i];
    const verdict = {
      true: null,
      false: saltus.element("p", { class: "alarm-text" },
        `The solution is not unique here: ${saltus.count(event.alternatives.length, "other continuation")} listed.`),
      null: saltus.element("p", { class: "undecided" }, "Whether the solution is unique here was not decided."),
    }[String(event.unique)];
    element.replaceChildren(
      saltus.element("header", {},
        saltus.element("h3", {}, `Event ${i + 1}: ${saltus.kindLabel(event.kind)}`),
        button("◀", "previous event", () => actions.step(i, -1)),
        button("▶", "next event", () => actions.step(i, 1)),
        button("zoom", "show the neighbourhood of this event", () => actions.zoomTo(i)),
        button("✕", "take the flag away", () => actions.select(null))),
      saltus.element("p", {}, "t = ", saltus.element("span", { class: "digits" }, saltus.exact(event.t)),
        event.name === null ? "" : `, name: ${event.name}`, event.surfaces.length === 0 ? "" : `, on ${event.surfaces.join(", ")}`),
      ...(verdict === null ? [] : [verdict]),
      ...(event.reason === "" ? [] : [saltus.element("p", {}, event.reason)]),
      saltus.element("div", { class: "tables" },
        ...(result.switching_functions.length > 0 ? [saltus.modeTable(result, event)] : []), saltus.stateTable(result, event)));
  };
  show(null);
  return { element, show };
};
