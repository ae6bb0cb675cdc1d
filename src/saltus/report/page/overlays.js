// Other results of the model over the one that is shown, and how far they are from it.
"use strict";

/** Colour and dashes of a result that lies over the first. */
saltus.overlayLine = (i, palette) => ({
  simplify: false,
  color: [palette.simulated, palette.jump, palette.alarm, palette.accumulation][i % 4],
  width: 1.5,
  dash: ["solid", "dash", "dot", "dashdot"][Math.floor(i / 4) % 4],
});

/** What another result has of a curve over time. */
saltus.overlayCurves = (result, curve, axis, view) => (result.overlays ?? []).flatMap(({trajectory, label}, i) => {
  const values = saltus.columnOf(trajectory, curve);
  if ((values ?? []).length === 0) return [];
  const line = saltus.overlayLine(i, view.palette);
  const {x, y, jumps, envelope} = saltus.pointsOf(result, curve, trajectory.t, values, view);
  return [
    ...saltus.envelopeTraces(envelope, axis, line.color), {
      ...saltus.lineOverTime(axis, x, y),
      meta: "overlay",
      name: saltus.plain(label),
      line: {...line, shape: curve.stepwise ? "hv" : "linear"},
    },
    ...saltus.jumpTraces(curve, jumps, axis, line.color)
  ];
});

/** The other results that have all of some columns. */
saltus.overlaysWith = (result, columns) => (result.overlays ?? []).filter(
    ({trajectory}) => columns.every((column) => (saltus.columnOf(trajectory, column) ?? []).length > 0));

/** Other results in a plane or a space. */
saltus.overlayOrbits = (result, choice, view, palette, type) => (result.overlays ?? []).flatMap((overlay, i) => {
  const {t} = overlay.trajectory;
  const lists = choice.map((axis) => saltus.columnOf(overlay.trajectory, saltus.axes(result)[axis]) ?? []);
  if (t.length === 0 || lists.some((list) => list.length === 0)) return [];
  const rows = saltus.rowsToDraw(t, lists, saltus.rowsInWindow(t, view.window), view.pixels);
  const {free, jumps} = saltus.phaseParts(overlay, lists, rows, []);
  const line = saltus.overlayLine(i, palette);
  const trace = ([x, y, z], style) => ({
    type,
    mode: "lines",
    x,
    y,
    ...(z === undefined ? {} : {z}),
    name: saltus.plain(saltus.shorten(overlay.label, 24)),
    hoverinfo: "skip",
    connectgaps: false,
    line: type === "scatter" ? {...line, ...style} : {color: line.color, width: 3, dash: line.dash, ...style},
  });
  return [
    trace(free, {}), ...(jumps[0].length === 0 ? [] : [{...trace(jumps, {width: 1, dash: "dot"}), showlegend: false}])
  ];
});

/** Values of a column before and behind a time, linear between rows. Null outside of its times. */
saltus.sidesAt = (t, values, time) => {
  if (values.length === 0 || t.length === 0 || time < t[0] || time > t[t.length - 1]) return [null, null];
  const i = saltus.lowerBound(t, time);
  if (t[i] === time) return saltus.rowsAtOneTime(t, i).map((row) => values[row]);
  const [from, to] = [values[i - 1], values[i]];
  const between = from === null || to === null ? null : from + ((time - t[i - 1]) / (t[i] - t[i - 1])) * (to - from);
  return [between, between];
};

/** Other minus first at the times of both, on both sides where one of them jumps, and the largest absolute value. */
saltus.differenceOf = (first, other, column) => {
  const [own, values] = [first, other].map((trajectory) => saltus.columnOf(trajectory, column) ?? []);
  const times = Float64Array.from(new Set([...first.t, ...other.t])).sort();
  const [x, y] = [[], []];
  let largest = null;
  for (const time of times) {
    const [ours, theirs] = [saltus.sidesAt(first.t, own, time), saltus.sidesAt(other.t, values, time)];
    const sides = ours.map((value, side) => (value === null || theirs[side] === null ? null : theirs[side] - value));
    for (const difference of sides[0] === sides[1] ? [sides[0]] : sides) {
      x.push(time);
      y.push(difference);
      if (difference !== null) largest = Math.max(largest ?? 0, Math.abs(difference));
    }
  }
  return {x, y, largest};
};

/** One row for every result: what differs from the first, and how far it is from it. */
saltus.overlayCard = (result, palette) => {
  const rows = result.overlays.map((overlay, i) => {
    const line = saltus.element("i", {class: "overlay-line", style: `color: ${saltus.overlayLine(i, palette).color}`});
    const most = 200;  // of many states the first ones that move
    const all = saltus.columns(result).filter(({sort}) => sort === "state");
    const states = all.length > most ? saltus.movingFirst(all).slice(0, most) : all;
    const far = states
                    .map((column) => {
                      const [least, greatest] = column.range;
                      const {largest} = saltus.differenceOf(result.trajectory, overlay.trajectory, column);
                      return {name: column.name, part: (largest ?? 0) / (greatest - least || 1)};
                    })
                    .reduce((most, one) => (one.part > most.part ? one : most), {name: "", part: 0});
    const parameters = overlay.parameters.map(([name, value]) => `${name} = ${saltus.exact(value)}`).join(", ");
    const ends =
        `${overlay.status.termination.replaceAll("_", " ")} at t = ${saltus.brief(overlay.status.time_reached, 6)}`;
    return [
      saltus.element("span", {}, line, " ", overlay.label), overlay.method, parameters || "the same",
      String(overlay.events), ends, far.part === 0 ? "none" : `${saltus.brief(far.part, 3)} of the range of ${far.name}`
    ];
  });
  const own = saltus.element("i", {class: "overlay-line", style: `color: ${palette.curves[0]}`});
  rows.unshift([
    saltus.element("span", {}, own, " the first one"), result.method, "", String(result.events.length),
    `${result.status.termination.replaceAll("_", " ")} at t = ${saltus.brief(result.status.time_reached, 6)}`, ""
  ]);
  const head = ["result", "method", "other values", "events", "ends", "largest difference"];
  return saltus.element(
      "section", {class: "card comparison overlays"}, saltus.element("h2", {}, "Results laid over this one"),
      saltus.plainTable(head, rows));
};

/** The differences over time, one column at a time. */
saltus.differencePicture = (result, timeline) => {
  if ((result.overlays ?? []).length === 0) return null;
  const columns = saltus.columns(result);
  const first = saltus.firstPanels(result).panels[0]?.curves[0] ?? 0;
  let chosen = first;
  const figure = (palette, holder) => ({
    data: result.overlays.map((overlay, i) => {
      const {x, y} = saltus.differenceOf(result.trajectory, overlay.trajectory, columns[chosen]);
      return {
        type: "scatter",
        mode: "lines",
        name: saltus.plain(saltus.shorten(overlay.label, 24)),
        x,
        y,
        line: saltus.overlayLine(i, palette),
      };
    }),
    layout: saltus.cardLayout(palette, holder, {
      xaxis: saltus.cardAxis(palette, "t", {range: timeline.window(), zeroline: false}),
      yaxis: saltus.cardAxis(palette, `difference of ${saltus.plain(saltus.columnLabel(columns[chosen]))}`),
      showlegend: true,
    }),
  });
  const option = (column, i) =>
      saltus.element("option", {value: String(i), ...(i === chosen ? {selected: ""} : {})}, saltus.columnLabel(column));
  const picker = saltus.element(
      "select", {
        "aria-label": "column",
        onchange: (event) => {
          chosen = Number(event.target.value);
          card.draw();
        }
      },
      ...columns.map(option));
  const card = saltus.drawingCard(
      result, {
        title: "Differences",
        note: "The other results minus this one, at the times of both, before and after each jump. Between rows it is linear.",
        file: "differences",
        controls: ["of ", picker],
      },
      figure, saltus.followsTime(timeline));
  return card;
};
