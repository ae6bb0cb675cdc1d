// Colours of runs: by the value of a second parameter, by a number on a scale, by a word.
"use strict";

/** From dark to light; lightness alone tells the order, too. */
saltus.scaleStops = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
saltus.scaleColour = (share) => {
  const place = Math.min(1, Math.max(0, share)) * (saltus.scaleStops.length - 1);
  const k = Math.min(saltus.scaleStops.length - 2, Math.floor(place));
  const [from, to] = [saltus.scaleStops[k], saltus.scaleStops[k + 1]];
  return `rgb(${from.map((value, i) => Math.round(value + (place - k) * (to[i] - value))).join(", ")})`;
};

/** As many values have a colour each; more lie on a scale. */
saltus.mostColours = 10;

/** Colours of the values of a column: `of(value)`, and a legend. */
saltus.coloursOfValues = (title, values) => {
  const unique = [...new Set(values)].sort((a, b) => (typeof a === "number" && typeof b === "number" ? a - b : 0));
  const {curves} = saltus.palette();
  if (unique.length <= saltus.mostColours || unique.some((value) => typeof value === "string")) {
    const of = (value) => curves[unique.indexOf(value) % curves.length];
    return {of, legend: saltus.swatches(title, unique.map((value) => [of(value), saltus.sweepNumber(value)]))};
  }
  const [low, high] = saltus.finiteRange(unique) ?? [0, 1];
  return {of: (value) => saltus.scaleColour((value - low) / (high - low || 1)), legend: saltus.scaleLegend(title, low, high)};
};

saltus.swatches = (title, entries) => [
  ...(title === "" ? [] : [saltus.element("span", {class: "quiet"}, title)]),
  ...entries.map(([colour, text]) => saltus.element(
      "span", {class: "swatch"}, saltus.element("i", {class: "dot", style: `background: ${colour}`}), text)),
];

saltus.scaleLegend = (title, low, high) => {
  const stops = [0, 0.25, 0.5, 0.75, 1].map(saltus.scaleColour).join(", ");
  return [
    ...(title === "" ? [] : [saltus.element("span", {class: "quiet"}, title)]),
    saltus.element(
        "span", {class: "swatch"}, saltus.sweepNumber(low),
        saltus.element("i", {class: "scale-bar", style: `background: linear-gradient(to right, ${stops})`}),
        saltus.sweepNumber(high)),
  ];
};

/** Colours of statuses: what was done, and what was not. */
saltus.statusColour = (statuses, status) => {
  const {curves, alarm} = saltus.palette();
  if (status === "completed") return curves[1];
  if (status === "stopped_by_event") return curves[0];
  const others = statuses.filter((other) => !saltus.doneStatuses.includes(other));
  return [alarm, curves[6], curves[2], curves[4]][others.indexOf(status) % 4];
};
