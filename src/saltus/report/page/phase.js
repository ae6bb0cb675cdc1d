// Two states against each other over the window of time of the drawing, sliding in its own colour.
"use strict";

/** Points of the curve, cut where sliding begins or ends; the border belongs to both parts. */
saltus.phaseParts = (result, columns, rows, sliding) => {
  const {t} = result.trajectory;
  const parts = {free: {x: [], y: []}, sliding: {x: [], y: []}};
  const starts = sliding.map((interval) => interval[0]);
  const slides = (time) => {
    const i = saltus.lowerBound(starts, time);
    const interval = starts[i] === time ? sliding[i] : sliding[i - 1];
    return interval !== undefined && time < interval[1];
  };
  const push = (part, i) => {
    part.x.push(i === null ? null : columns[0][i]);
    part.y.push(i === null ? null : columns[1][i]);
  };
  let current = null;
  for (let n = 0; n + 1 < rows.length; n += 1) {
    const [i, k] = [rows[n], rows[n + 1]];
    const jump = t[i] === t[k] && (columns[0][i] !== columns[0][k] || columns[1][i] !== columns[1][k]);
    const part = slides((t[i] + t[k]) / 2) ? parts.sliding : parts.free;
    if (t[i] === t[k] && !jump) continue;
    if (jump || part !== current) {
      if (current !== null) push(current, null);
      current = jump ? null : part;
      if (!jump) push(part, i);
    }
    if (!jump) push(part, k);
  }
  return parts;
};

saltus.phaseTraces = (result, choice, rows, sliding, events, palette) => {
  const columns = choice.map((i) => result.trajectory.x[i]);
  const parts = saltus.phaseParts(result, columns, rows, sliding);
  const line = (part, color, width, name) =>
      ({type: "scatter", mode: "lines", ...part, name, line: {simplify: false, color, width}});
  const point = (i, name, symbol) => ({
    type: "scatter",
    mode: "markers",
    name,
    x: [columns[0][i]],
    y: [columns[1][i]],
    marker: {symbol, size: 10, color: palette.text, line: {width: 1.5, color: palette.text}},
  });
  const switches = {
    type: "scatter",
    mode: "markers",
    name: "event",
    customdata: events,
    x: events.map((i) => result.events[i].x_after[choice[0]]),
    y: events.map((i) => result.events[i].x_after[choice[1]]),
    marker: {
      size: events.map((i) => (saltus.isAlarming(result.events[i]) ? 11 : 5)),
      symbol: events.map((i) => (saltus.isAlarming(result.events[i]) ? "x" : "circle")),
      color: events.map((i) => (saltus.isAlarming(result.events[i]) ? palette.alarm : palette.mark)),
    },
  };
  return [
    line(parts.free, palette.curves[0], 1.4, "not sliding"),
    line(parts.sliding, palette.sliding, 3, "sliding"),
    switches,
    point(rows[0], "begin", "circle-open"),
    point(rows[rows.length - 1], "end", "square"),
  ];
};

saltus.phasePlane = (result, timeline, select) => {
  const holder = saltus.element("div", {class: "phase-plot"});
  const choice = [0, 1];
  const sliding = saltus.slidingIntervals(result.trajectory.modes);
  const draw = () => {
    const palette = saltus.palette();
    const window_ = timeline.window();
    const {t, x} = result.trajectory;
    const inside = saltus.rowsInWindow(t, window_);
    const rows = saltus.rowsToDraw(t, choice.map((i) => x[i]), inside, 1500)
                     .filter((i) => t[i] >= window_[0] && t[i] <= window_[1]);
    if (rows.length === 0) return Plotly.purge(holder);
    const marks = saltus.visibleMarks(result, timeline.shown(), window_);
    const axis = (i) => ({
      title: {text: saltus.plain(saltus.shorten(result.states[choice[i]], 30)), standoff: 6},
      gridcolor: palette.grid,
      zerolinecolor: palette.axis,
      linecolor: palette.grid,
      showline: true,
      mirror: true,
      automargin: true,
      exponentformat: "power",
      minexponent: 5,
    });
    const layout = {
      width: holder.clientWidth,
      height: holder.clientHeight,
      margin: {l: 60, r: 12, t: 30, b: 44},
      hovermode: "closest",
      separators: ".",
      paper_bgcolor: "rgba(0,0,0,0)",
      plot_bgcolor: palette.panel,
      font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
      xaxis: axis(0),
      yaxis: axis(1),
      legend: {orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: {size: 11}},
    };
    return Plotly.react(
        holder, saltus.phaseTraces(result, choice, rows, sliding, marks, palette), layout, {displayModeBar: false});
  };
  const picker = (i) => saltus.element(
      "select", {
        "aria-label": `state on axis ${i + 1}`,
        onchange: (e) => {
          choice[i] = Number(e.target.value);
          draw();
        }
      },
      ...result.states.map(
          (name, k) => saltus.element(
              "option", {value: String(k), ...(k === choice[i] ? {selected: ""} : {})}, saltus.shorten(name, 30))));
  const element = saltus.element(
      "section", {class: "card phase"},
      saltus.element(
          "header", {}, saltus.element("h2", {}, "Phase plane"), picker(1), " over ", picker(0),
          saltus.element("span", {class: "quiet"}, "within the time shown above")),
      holder);
  const start = () => {
    draw();
    holder.on("plotly_click", ({points}) => {
      if (points[0].customdata !== undefined) select(points[0].customdata);
    });
  };
  return {element, draw, start};
};
