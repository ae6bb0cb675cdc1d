// Multipliers of the constraints of an optimisation over time.
"use strict";

/** As many constraints are drawn together; of more, one is chosen. */
saltus.constraintsTogether = 6;

/** Entries by constraint, those with the largest multiplier first. */
saltus.constraintGroups = (multipliers) => {
  const groups = new Map();
  for (const {name, time, value, range} of multipliers) {
    if (!groups.has(name)) groups.set(name, {name, t: [], values: [], ranges: [], largest: 0});
    const group = groups.get(name);
    if (range !== undefined) group.ranges.push({time, range});
    group.t.push(time);
    group.values.push(value);
    group.largest = Math.max(group.largest, Math.abs(value ?? range?.[0] ?? range?.[1] ?? 0));
  }
  return [...groups.values()].sort((a, b) => b.largest - a.largest);
};

/** From 0 to the value and a gap, for each. */
saltus.stems = ({t, values}) => ({
  x: t.flatMap((time) => [time, time, null]),
  y: values.flatMap((value) => [0, value, null]),
});

/** "at least 0.4": what is known of a multiplier that is not unique. */
saltus.rangeText = ([lower, upper]) => {
  if (lower === null && upper === null) return "not determined";
  if (upper === null) return `at least ${saltus.brief(lower)}`;
  return lower === null ? `at most ${saltus.brief(upper)}` : `${saltus.brief(lower)} to ${saltus.brief(upper)}`;
};

/** Limits of multipliers that are not unique, joined where there are two; 0 stands for none. */
saltus.rangePoints = ({ranges}) => {
  const points = {x: [], y: [], text: []};
  for (const {time, range} of ranges) {
    const limits = range.filter((limit) => limit !== null);
    for (const y of [...(limits.length > 0 ? limits : [0]), null]) {
      points.x.push(time);
      points.y.push(y);
      points.text.push(saltus.rangeText(range));
    }
  }
  return points;
};

saltus.stemTraces = (groups, palette) => groups.flatMap((group, n) => {
  const color = palette.curves[n % palette.curves.length];
  const name = saltus.plain(saltus.shorten(group.name, 40));
  return [
    {
      type: "scatter",
      mode: "lines",
      ...saltus.stems(group),
      legendgroup: String(n),
      showlegend: false,
      hoverinfo: "skip",
      connectgaps: false,
      line: {color, width: 1.6},
    },
    {
      type: "scatter",
      mode: "markers",
      x: group.t,
      y: group.values,
      name,
      legendgroup: String(n),
      hovertemplate: "t = %{x:.6g}: %{y:.6g}<extra>%{fullData.name}</extra>",
      marker: {size: 6, color, symbol: group.values.map((value) => (value === 0 ? "circle-open" : "circle"))},
    },
    ...(group.ranges.length === 0 ? [] : [{
      type: "scatter",
      mode: "lines+markers",
      ...saltus.rangePoints(group),
      name: `${name}: not unique`,
      legendgroup: String(n),
      hovertemplate: "t = %{x:.6g}: %{text}<extra>%{fullData.name}</extra>",
      connectgaps: false,
      line: {color, width: 1, dash: "dot"},
      marker: {size: 8, color, symbol: "diamond-open"},
    }]),
  ];
});

/** A little room on both sides: constraints at the end of the horizon stand at the border. */
saltus.windowWithRoom = ([from, to]) => [from - 0.02 * (to - from), to + 0.02 * (to - from)];

saltus.constraintPicture = (result, timeline) => {
  const {multipliers, multiplier_count: all} = result.optimization;
  const groups = saltus.constraintGroups(multipliers);
  if (groups.length === 0) return null;
  const together = groups.length <= saltus.constraintsTogether;
  let chosen = together ? groups : [groups[0]];
  const figure = (palette, holder) => ({
    data: saltus.stemTraces(chosen, palette),
    layout: saltus.cardLayout(palette, holder, {
      xaxis: saltus.cardAxis(palette, "t", {range: saltus.windowWithRoom(timeline.window()), zeroline: false}),
      yaxis: saltus.cardAxis(palette, "multiplier", {zerolinewidth: 1.4}),
      showlegend: true,
    }),
  });
  const option = (text, value, selected) =>
      saltus.element("option", {value: String(value), ...(selected ? {selected: ""} : {})}, saltus.shorten(text, 40));
  const picker = groups.length === 1 ? [] : [saltus.element(
      "select", {
        "aria-label": "constraint",
        class: "wide",
        onchange: (e) => {
          const i = Number(e.target.value);
          chosen = i < 0 ? groups : [groups[i]];
          card.draw();
        }
      },
      ...(together ? [option("all", -1, true)] : []),
      ...groups.map(({name}, i) => option(name, i, !together && i === 0)))];
  const note = [
    "A multiplier says how much the optimal objective would fall if the constraint were relaxed by one unit. It is",
    "positive where an upper bound or <= is active, negative where a lower bound or >= is active, and 0 (hollow) elsewhere.",
    groups.some(({ranges}) => ranges.length > 0) ?
        "Diamonds: multipliers that are not unique, since gradients of active constraints depend on each other there; the mark is the bound that is known." :
        "",
    all > multipliers.length ? `The first ${multipliers.length} of ${all}.` : ""
  ].join(" ");
  const card = saltus.drawingCard(
      result, {title: "Multipliers of constraints", note, file: "constraints", controls: picker}, figure,
      saltus.followsTime(timeline));
  return card;
};
