// What is said in words: head, warnings, end state, parameters, options, statistics, notes.
"use strict";

saltus.option = (result, ending) => {
  const found = result.options.find(([name]) => name === ending || name.endsWith(`.${ending}`));
  return found === undefined ? null : String(found[1]);
};

/** What computes: the integrator, or the scheme of finite elements with its stages and form. */
saltus.computedBy = (result) => {
  const part = (name) => saltus.option(result, `${result.method}.${name}`);
  if (part("scheme") !== null) return [`${part("scheme")} ${part("stages")}`, part("reformulation")];
  return [saltus.option(result, "integrator")];
};

saltus.statusBadge = (result) => {
  const {termination, done} = result.status;
  const kind = termination === "completed" ? "good" : done ? "notice" : "bad";
  return saltus.element("span", {class: `badge ${kind}`}, termination.replaceAll("_", " "));
};

saltus.facts = (result) => {
  if (result.optimization) return saltus.optimizationFacts(result);
  const {t} = result.trajectory;
  const facts = [["method", [result.method, ...saltus.computedBy(result).filter((part) => part !== null)].join(", ")]];
  // Finite elements have steps and no tolerances.
  for (const name of ["fesd", "timestepping"].includes(result.method) ? [] : ["rtol", "atol"]) {
    const value = saltus.option(result, name);
    if (value !== null) facts.push([name, value]);
  }
  if (t.length > 0) facts.push(["t", `${saltus.brief(t[0], 8)} … ${saltus.brief(result.status.time_reached, 8)}`]);
  facts.push(["events", result.events.length.toLocaleString("en-US")]);
  facts.push(["steps", result.statistics.steps.toLocaleString("en-US")]);
  return facts;
};

saltus.pageHeader = (result, toggleTheme) => saltus.element(
    "header", {class: "head"},
    saltus.element(
        "div", {class: "title"}, saltus.element("h1", {}, result.model.name || "simulation"),
        saltus.statusBadge(result),
        saltus.element("span", {class: "description", title: result.model.description}, result.model.description)),
    saltus.element(
        "div", {class: "aside"},
        saltus.element(
            "dl", {class: "facts"},
            ...saltus.facts(result).map(
                ([name, value]) =>
                    saltus.element("div", {}, saltus.element("dt", {}, name), saltus.element("dd", {}, value)))),
        saltus.element(
            "button", {class: "theme", title: "light or dark", "aria-label": "light or dark", onclick: toggleTheme},
            "◐")));

saltus.banners = (result, select) => {
  const {status, events} = result;
  const banners = [];
  if (status.termination !== "completed") {
    banners.push(saltus.element(
        "div", {class: `banner ${status.done ? "notice" : "bad"}`, role: "alert"},
        saltus.element(
            "strong", {},
            status.done ? "Stopped by an event" : `Not completed: ${status.termination.replaceAll("_", " ")}`),
        status.message.includes("t = ") || result.optimization ? ": " : ` at t = ${saltus.exact(status.time_reached)}. `, status.message));
  }
  if (status.termination === "completed" && status.message !== "")
    banners.push(saltus.element("div", {class: "banner notice", role: "status"}, status.message));
  const list = (chosen, title) => {
    if (chosen.length === 0) return;
    const buttons = chosen.slice(0, 8).map(
        (i) => saltus.element(
            "button", {onclick: () => select(i)}, `event ${i + 1}, t = ${saltus.brief(events[i].t, 6)}`));
    const left = chosen.length - buttons.length;
    banners.push(saltus.element(
        "div", {class: "banner notice", role: "status"}, saltus.element("strong", {}, title), " ", ...buttons,
        left > 0 ? ` and ${left} more in the table` : null));
  };
  const numbered = (wanted) => events.map((_, i) => i).filter((i) => events[i].unique === wanted);
  const no = numbered(false);
  list(no, `The solution is not unique at ${saltus.count(no.length, "event")}.`);
  const open = result.optimization ? [] : numbered(null);  // an optimum is one solution, verified by itself
  list(open, `Uniqueness was not decided at ${saltus.count(open.length, "event")}.`);
  return banners;
};

saltus.card = (title, ...content) =>
    saltus.element("section", {class: "card"}, saltus.element("h2", {}, title), ...content);

/** Cards that scroll are reached by the keyboard, as long as they do. */
saltus.reachCards = () => {
  for (const card of document.querySelectorAll(".card")) {
    const {overflowX, overflowY} = getComputedStyle(card);
    const scrolls = (overflowX === "auto" && card.scrollWidth > card.clientWidth) ||
        (overflowY === "auto" && card.scrollHeight > card.clientHeight);
    if (scrolls) {
      card.setAttribute("tabindex", "0");
      card.setAttribute("aria-label", card.querySelector("h2")?.textContent ?? "card");
    } else {
      card.removeAttribute("tabindex");
    }
  }
};

/** Rows of a table of values at first; the others are in the result file. */
saltus.firstRows = 100;

/** A long name, which may be broken after its dots and underscores. */
saltus.breakable = (name) => name.split(/(?<=[._])/).flatMap((part, i) => (i === 0 ? [part] : [saltus.element("wbr"), part]));

/** Of very many pairs the first ones. */
saltus.pairTable = (pairs) => {
  const shown = pairs.length > 3 * saltus.firstRows ? pairs.slice(0, saltus.firstRows) : pairs;
  const left = pairs.length - shown.length;
  return saltus.element(
      "table", {class: "plain"},
      saltus.element(
          "tbody", {},
          ...shown.map(
              ([name, value, about = ""]) => saltus.element(
                  "tr", {}, saltus.element("td", {title: name}, ...saltus.breakable(name)), saltus.element("td", {class: "digits"}, value),
                  about === "" ? null : saltus.element("td", {class: "quiet"}, about))),
          ...(left === 0 ? [] : [saltus.element("tr", {}, saltus.element("td", {class: "quiet"}, `and ${left} more`))])));
};

/** A row of a table: a name, its value with the unit, and what the model says about the name. */
saltus.captionedRow = (result, name, value) => {
  const {unit, label} = saltus.captionOf(result, name);
  return [name, `${saltus.exact(value)} ${unit}`.trim(), label];
};

/** Places of the first names that match. */
saltus.firstOf = (names, matches) => {
  const places = [];
  for (let i = 0; i < names.length && places.length < saltus.firstRows; i += 1) {
    if (matches(names[i])) places.push(i);
  }
  return places;
};

saltus.finalCard = (result) => {
  const {final} = result;
  const names = [...result.states, ...result.output_names];
  const values = [...final.x, ...final.outputs];
  // Of many the first ones, and a search for the others.
  const valueTable = (matches) => saltus.pairTable([
    ["t", saltus.exact(final.t)],
    ...saltus.firstOf(names, matches).map((i) => saltus.captionedRow(result, names[i], values[i]))
  ]);
  const functions = result.switching_functions;
  const surfaces = (matches) => saltus.plainTable(["ψ", "mode", "α"], saltus.firstOf(functions, matches).map((i) => [
    functions[i], saltus.modeBoxes([final.mode[i] ?? null]), saltus.selection(final.alpha[i])
  ]));
  const tables = (matches) => [valueTable(matches), ...(functions.length > 0 ? [surfaces(matches)] : [])];
  const many = Math.max(names.length, functions.length) > saltus.firstRows;
  const held = saltus.element("div", {}, ...tables(() => true));
  const search = saltus.element("input", {
    type: "search",
    class: "column-search",
    placeholder: `search ${names.length} values`,
    "aria-label": "search the end state",
    oninput: (event) => {
      const text = event.target.value.trim().toLowerCase();
      held.replaceChildren(...tables((name) => name.toLowerCase().includes(text)));
    },
  });
  return saltus.card(
      "End state", ...(many ? [search] : []), held,
      ...(result.regions.length > 0 ?
              [saltus.plainTable(
                  ["region", "θ"], result.regions.map((name, i) => [name, saltus.selection(final.theta[i])]))] :
              []));
};

/** Whether an option stands in the table of another method than the one that ran. */
saltus.isOfOtherMethod = (name, method) =>
    ["event", "smoothed", "fesd", "timestepping"].some(
        (other) => other !== method && name.startsWith(`simulate.${other}.`));

/** The options in force, those of other methods folded away. */
saltus.optionsCard = (result) => {
  const ofOther = ([name]) => saltus.isOfOtherMethod(name, result.method);
  const table = (options) => saltus.pairTable(options.map(([name, value]) => [name, saltus.optionText(value)]));
  const others = result.options.filter(ofOther);
  const fold = saltus.element(
      "details", {}, saltus.element("summary", {class: "quiet"}, `${others.length} of other methods`), table(others));
  return saltus.card(
      "Options", table(result.options.filter((option) => !ofOther(option))), ...(others.length > 0 ? [fold] : []));
};

saltus.optionText = (value) => {
  if (Array.isArray(value))
    return value.length <= 6 ?
        `[${value.map(saltus.exact).join(", ")}]` :
        `${value.length} values, ${saltus.exact(value[0])} … ${saltus.exact(value[value.length - 1])}`;
  return saltus.exact(value);
};

saltus.infoCards = (result) => {
  const {statistics, model} = result;
  const numbers = [
    ["steps", statistics.steps.toLocaleString("en-US")],
    ["rejected steps", statistics.rejected.toLocaleString("en-US")],
    ["right-hand sides evaluated", statistics.rhs_evaluations.toLocaleString("en-US")],
    ["wall time", `${saltus.brief(statistics.wall_seconds, 4)} s`]
  ];
  if (statistics.thinned_from !== null)
    numbers.push(["rows between events thinned from", `t = ${saltus.brief(statistics.thinned_from, 8)}`]);
  const quiet = (text) => saltus.element("p", {class: "quiet"}, text);
  return [
    saltus.modelCard(result),
    saltus.startCard(result),
    saltus.finalCard(result),
    saltus.card(
        "Parameters",
        model.parameters.length > 0 ?
            saltus.pairTable(model.parameters.map(([name, value]) => saltus.captionedRow(result, name, value))) :
            quiet("The model has none.")),
    result.options.length > 0 ? saltus.optionsCard(result) : saltus.card("Options", quiet("None are recorded.")),
    saltus.card("Statistics", saltus.pairTable(result.optimization ? saltus.optimizationStatistics(result) : numbers)),
  ].filter((card) => card !== null);
};

saltus.notes = (result) => {
  const {rows, t} = result.trajectory;
  const number = (n) => n.toLocaleString("en-US");
  const tolerance = result.trajectory.line_tolerance ?? 0;
  const lines = tolerance === 0 ?
      "" :
      `Each column is stored as a polyline that is off by at most ${saltus.brief(tolerance, 1)} of its range. The result file has all values. `;
  const kept = t.length === rows ? `This page holds all ${number(rows)} rows of the trajectory and its events. ` : [
    `This page holds ${number(t.length)} of the ${
        number(rows)} rows of the trajectory and its events: the least and greatest value of`,
    "every curve in each stretch of time, and the rows before and after each event. The result file has all rows. "
  ].join(" ");
  const drawn = [
    "Curves show the least and the greatest value of each pixel, and the values before and after up to 2,000 events.",
    "Zoom in to see every row. With more than 400 events in view, one line stands for several events.",
    "Where a mode changes more than once per pixel, the height of its band is the share of time spent in the mode,",
    "and the band is hatched. A curve that jumps there is drawn by its envelope and its mean.",
    "Dotted lines are jumps. Discrete states are drawn as steps."
  ].join(" ");
  const names = {
    states: result.states,
    controls: result.controls,
    "switching functions": result.switching_functions,
    outputs: result.output_names,
  };
  const cut = Object.entries(result.sizes).filter(([sort, size]) => size > names[sort].length);
  const left = cut.map(([sort, size]) => `the first ${names[sort].length} of ${number(size)} ${sort}`).join(", ");
  const columns = left === "" ? "" : `It shows ${left}. `;
  const chosen = Object.entries(result.kept ?? {})
                     .filter(([sort, size]) => size > names[sort].length)
                     .map(([sort, size]) => `${number(names[sort].length)} of ${number(size)} ${sort}`);
  const few = chosen.length === 0 ? "" : `The run was asked to store ${chosen.join(", ")} only. `;
  const {sha256} = result.model;
  const model = sha256 === "" ? "No model file is recorded." : `SHA-256 of the model file: ${sha256}`;
  return saltus.element(
      "footer", {}, saltus.element("p", {}, kept, lines, few, columns, drawn),
      saltus.element("p", {class: "digits"}, `Saltus ${result.saltus}, command ${result.command}. ${model}`));
};
