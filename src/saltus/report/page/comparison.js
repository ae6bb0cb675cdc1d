// The card of `compare`: one row for every run.
"use strict";

/** A difference as a bar: 1e-16 is none of it, 1 all of it. */
saltus.differenceBar = (value) => {
  if (value === null) return saltus.element("span", {class: "quiet"}, "–");
  const share = value > 0 ? Math.min(1, Math.max(0, (16 + Math.log10(value)) / 16)) : 0;
  return saltus.element(
      "span", {class: "difference", title: saltus.exact(value)},
      saltus.element("i", {style: `width: ${Math.round(60 * share)}px`}),
      value === 0 ? "0" : value.toExponential(1));
};

saltus.comparedRow = (run, isReference, states) => {
  if (run.reason !== "") {
    return saltus.element(
        "tr", {class: "absent"}, saltus.element("td", {}, run.method), saltus.element("td", {}, run.variant),
        saltus.element("td", {colspan: String(states + 5), class: "quiet"}, `not run: ${run.reason}`));
  }
  const cell = (content) => saltus.element("td", {class: "digits"}, content);
  const dash = (value) => (value === null ? "–" : saltus.brief(value, 10));
  const values = Array.from({length: states}, (_, i) => cell(dash(run.x[i] ?? null)));  // none where it did not get there
  const differences = isReference ? ["reference", ""] :
                                    [run.state_difference, run.switch_time_difference].map(saltus.differenceBar);
  const stop = run.status.done ? [] : [saltus.statusBadge(run), ` at t = ${saltus.brief(run.status.time_reached, 8)}`];
  return saltus.element(
      "tr", {class: isReference ? "reference" : null, title: run.status.message},
      saltus.element("td", {}, run.method), saltus.element("td", {}, run.variant, " ", ...stop),
      ...values, cell(dash(run.switches)), cell(dash(run.last_switch)), ...differences.map(cell), cell(saltus.brief(run.statistics.wall_seconds, 3)));
};

/** The card; null for a result without a comparison. */
saltus.comparisonCard = (result) => {
  const {comparison} = result;
  if (comparison === null) return null;
  const states = Math.min(4, result.states.length);
  const head = [
    "method", "variant", ...result.states.slice(0, states), "switches", "last at t", "end state differs by",
    "switching times differ by", "seconds"
  ];
  return saltus.element(
      "section", {class: "card comparison"}, saltus.element("h2", {}, "Comparison"),
      saltus.element(
          "table", {class: "plain"},
          saltus.element("thead", {}, saltus.element("tr", {}, ...head.map((text) => saltus.element("th", {}, text)))),
          saltus.element(
              "tbody", {},
              ...comparison.runs.map((run, i) => saltus.comparedRow(run, i === comparison.reference, states)))),
      ...comparison.runs.filter((run) => run.reason === "" && run.status.termination !== "stopped_by_event" && run.status.message !== "")
          .map((run) => saltus.element("p", {class: "note"}, `${run.method} (${run.variant}): ${run.status.message}`)),
      saltus.element(
          "p", {class: "quiet note"},
          "Differences are the largest ones from the reference; bars show their logarithms from 1e-16 to 1. ",
          "Seconds include building the problem. The drawings below show the reference."));
};
