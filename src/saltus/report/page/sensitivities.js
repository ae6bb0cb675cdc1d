// The derivatives of the end state as a table whose cells are coloured by sign and size.
"use strict";

/** Share of the largest entry, on a scale of logarithms over four decades: 1 at the largest, 0 below 1e-4 of it. */
saltus.heat = (value, largest) => {
  if (value === null || value === 0 || largest === 0) return 0;
  return Math.max(0, 1 + Math.log10(Math.abs(value) / largest) / 4);
};

saltus.sensitivityTable = (rows, columns, values) => {
  const largest = values.flat().reduce((most, value) => (value === null ? most : Math.max(most, Math.abs(value))), 0);
  const cell = (value) => {
    if (value === null) return saltus.element("td", {class: "quiet", title: "not defined"}, "–");
    // As much as leaves numbers readable, also in the dark.
    const share = Math.round(45 * saltus.heat(value, largest));
    const colour = value < 0 ? "--curve-1" : "--sliding";
    const style = `background: color-mix(in srgb, var(${colour}) ${share}%, transparent)`;
    return saltus.element("td", {class: "digits", style, title: saltus.exact(value)}, saltus.brief(value, 5));
  };
  const head = (name) => saltus.element("th", {title: name}, saltus.shorten(name, 14));
  return saltus.element(
      "table", {class: "heat"},
      saltus.element("thead", {}, saltus.element("tr", {}, saltus.element("td", {}), ...columns.map(head))),
      saltus.element(
          "tbody", {}, ...rows.map((name, i) => saltus.element("tr", {}, head(name), ...values[i].map(cell)))));
};

/** The card; null for a result without sensitivities. */
saltus.sensitivityCard = (result) => {
  const {sensitivities, sizes, sensitivity_parameters: all} = result;
  if (sensitivities === null) return null;
  const {x0, p, parameters} = sensitivities;
  const t = saltus.brief(result.final.t, 8);
  const states = result.states;
  const parts = [
    saltus.element("h3", {}, `∂x(${t}) / ∂x(t₀)`), saltus.sensitivityTable(states, states, x0),
    ...(parameters.length === 0 ?
            [] :
            [saltus.element("h3", {}, `∂x(${t}) / ∂p`), saltus.sensitivityTable(states, parameters, p)])
  ];
  const cut = sizes.states > states.length || all > parameters.length;
  const element = saltus.card(
      "Sensitivities", ...parts,
      saltus.element(
          "p", {class: "quiet note"},
          "Rows: states at the end. Orange: positive, blue: negative, shaded by logarithm of the size. ",
          ...(result.method === "timestepping" ?
                  ["Without switch detection these derivatives are wrong, however short the step is. "] :
                  []),
          ...(cut ? ["The result file has all of them."] : [])));
  element.classList.add("sensitivities");
  return element;
};
