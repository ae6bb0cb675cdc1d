// Events in the drawing: a marker in the strip on top and a thin line through all panels.
"use strict";

/** More lines than this in one view could not be told apart: one per bin then, uncertain ones first. */
saltus.maximumMarks = 400;

saltus.isAlarming = (event) => event.unique === false;

/** Events of the window to draw, at most one per bin if there are too many; indices into result.events. */
saltus.visibleMarks = (result, shown, [from, to]) => {
  const inside = shown.filter((i) => result.events[i].t >= from && result.events[i].t <= to);
  if (inside.length <= saltus.maximumMarks) return inside;
  const bins = new Map();
  for (const i of inside) {
    const bin = Math.floor(((result.events[i].t - from) / (to - from)) * saltus.maximumMarks);
    const held = bins.get(bin);
    if (held === undefined || (saltus.isAlarming(result.events[i]) && !saltus.isAlarming(result.events[held])))
      bins.set(bin, i);
  }
  return [...bins.values()];
};

/** All events of one look are one path: hundreds of shapes would take plotly most of a second. */
saltus.markShapes = (result, marks, selected, palette) => {
  const time = (i) => result.events[i].t;
  const line = (i, style) => ({
    type: "line",
    layer: "above",
    xref: "x",
    yref: "paper",
    x0: time(i),
    x1: time(i),
    y0: 0,
    y1: 1,
    line: style,
  });
  const calm = marks.filter((i) => !saltus.isAlarming(result.events[i]));
  const dense = marks.length > 60;
  const shapes = marks.filter((i) => saltus.isAlarming(result.events[i]))
                     .map((i) => line(i, {color: palette.alarm, width: 2, dash: "dash"}));
  for (const look of [undefined, "jump", "accumulation"]) {
    const alike = calm.filter((i) => saltus.kinds[result.events[i].kind]?.look === look);
    if (alike.length === 0) continue;
    const style = {
      // Not dotted: together with the dots of a curve that jumps there it would look like a solid line.
      jump: {color: palette.jump, width: dense ? 0.5 : 1},
      accumulation: {color: palette.accumulation, width: 2, dash: "dashdot"},
    }[look] ??
        {color: palette.mark, width: dense ? 0.5 : 0.8};
    shapes.push({
      type: "path",
      layer: "below",
      xref: "x",
      yref: "paper",
      // Fainter than any curve: they say when, not what.
      opacity: look === "accumulation" ? 0.7 : look === "jump" || dense ? 0.25 : 0.45,
      path: alike.map((i) => `M${time(i)},0L${time(i)},1`).join(""),
      line: style,
    });
  }
  if (selected !== null) shapes.push(line(selected, {color: palette.select, width: 2}));
  return shapes;
};

/** Background of the intervals of sliding, behind every panel of curves. */
saltus.slidingShapes = (intervals, panels, totalHeight, [from, to], palette) => {
  const visible = intervals.filter((interval) => interval[1] >= from && interval[0] <= to);
  if (visible.length > saltus.maximumMarks) return [];
  const first = panels.find((panel) => panel.kind === "curves");
  if (first === undefined) return [];
  return visible.map(([x0, x1]) => ({
                       type: "rect",
                       xref: "x",
                       yref: "paper",
                       x0,
                       x1,
                       y0: 0,
                       y1: 1 - first.top / totalHeight,
                       layer: "below",
                       line: {width: 0},
                       fillcolor: palette.slidingShade,
                     }));
};

saltus.markTrace = (result, marks, selected, palette) => {
  const colour = (i) => {
    if (i === selected) return palette.select;
    if (saltus.isAlarming(result.events[i])) return palette.alarm;
    return palette[saltus.kinds[result.events[i].kind]?.look] ?? palette.text;
  };
  const alarming = (i) => saltus.isAlarming(result.events[i]);
  return {
    type: "scatter",
    mode: "markers",
    xaxis: "x",
    yaxis: "y",
    hoverinfo: "none",
    cliponaxis: false,
    x: marks.map((i) => result.events[i].t),
    y: marks.map(() => 0.5),
    customdata: marks,
    marker: {
      symbol: marks.map((i) => (alarming(i) ? "x" : (saltus.kinds[result.events[i].kind]?.symbol ?? "circle"))),
      size: marks.map((i) => (alarming(i) ? 13 : 9)),
      color: marks.map(colour),
      line: {width: 1.5, color: marks.map(colour)},
    },
  };
};
