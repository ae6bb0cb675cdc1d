// The phase plane of two states with the surfaces in it.
"use strict";

/** More surfaces than this have one entry of the legend together. */
saltus.maximumLegendSurfaces = 8;

saltus.planeSurfaces = (result, choice, view, palette, logs = [false, false]) => {
  // Wider than what is shown at first: lines still reach the border when one zooms out or moves.
  const [x, y] = view.box.map(([from, to]) => [from - 2 * (to - from), to + 2 * (to - from)]);
  const all = [];
  result.surfaces.forEach((surface, index) => {
    const parts = saltus.surfaceInPlane(surface, choice, view.at, view.window);
    if (parts === null) return;
    const path = saltus.surfacePath(parts, {x, y}, logs.includes(true) ? 200 : 1);
    if (path.x.length > 0) all.push({surface, index, kind: parts.kind, path});
  });
  const drawn = saltus.surfacesToDraw(result, view, all);
  const labels = new Set(drawn.map(({surface}) => saltus.surfaceLabel(surface)));
  const single = labels.size <= saltus.maximumLegendSurfaces;
  const seen = new Map();
  const traces = drawn.map(({surface, index, kind, path}, n) => {
    const style = saltus.surfaceStyle(index, surface, palette);
    const label = saltus.surfaceLabel(surface);
    const first = !seen.has(label);
    if (first) seen.set(label, style.color);
    return {
      type: "scatter",
      mode: "lines",
      ...path,
      name: saltus.plain(single ? label : "surfaces"),
      legendgroup: single ? label : "surfaces",
      showlegend: single ? first : n === 0,
      hoverinfo: "name",
      line: {
        simplify: false,
        color: seen.get(label),
        width: 1.3,
        dash: style.jump ? "dashdot" : {exact: "solid", cut: "dash", moving: "dot"}[kind]
      },
    };
  });
  const ofKind = (kind) => drawn.filter((entry) => entry.kind === kind).map((entry) => entry.surface);
  return {traces, cuts: ofKind("cut"), moving: ofKind("moving"), leftOut: all.length - drawn.length};
};

saltus.planeTraces = (result, choice, view, palette) => {
  const {rows, columns, parts, events, selected} = view;
  const line = ([x, y], name, style) => ({
    type: "scatter",
    mode: "lines",
    x,
    y,
    name,
    hoverinfo: "skip",
    showlegend: x.length > 0,
    line: {simplify: false, ...style},
  });
  const point = (i, name, symbol) => ({
    type: "scatter",
    mode: "markers",
    name,
    x: [columns[0][i]],
    y: [columns[1][i]],
    marker: {symbol, size: 10, color: palette.text, line: {width: 1.5, color: palette.text}},
  });
  const event = (i) => result.events[i];
  const alarming = (i) => saltus.isAlarming(event(i));
  const marks = {
    type: "scatter",
    mode: "markers",
    name: "event",
    showlegend: events.length > 0,
    customdata: events,
    x: events.map((i) => saltus.eventCoordinate(result, i, choice[0])),
    y: events.map((i) => saltus.eventCoordinate(result, i, choice[1])),
    text: events.map(
        (i) => saltus.plain(`${i + 1}. ${saltus.kindLabel(event(i).kind)}, t = ${saltus.brief(event(i).t, 8)}`)),
    hovertemplate: "%{text}<extra></extra>",
    marker: {
      size: events.map((i) => (alarming(i) ? 11 : 6)),
      symbol: events.map((i) => (alarming(i) ? "x" : (saltus.kinds[event(i).kind]?.planeSymbol ?? "circle"))),
      color: events.map((i) => (alarming(i) ? palette.alarm : palette.mark)),
      line: {width: 0.8, color: palette.panel},
    },
  };
  const flagged = selected === null ? [] : [{
    type: "scatter",
    mode: "markers",
    name: `event ${selected + 1}`,
    hoverinfo: "skip",
    x: [saltus.eventCoordinate(result, selected, choice[0])],
    y: [saltus.eventCoordinate(result, selected, choice[1])],
    marker: {symbol: "circle-open", size: 17, color: palette.select, line: {width: 2.5}},
  }];
  return [
    ...saltus.branchOrbits(result, choice, view, palette, "scatter"),
    line(parts.free, saltus.freeName(result), {color: palette.curves[0], width: 1.4}),
    line(parts.sliding, "sliding", {color: palette.sliding, width: 3.2}),
    line(parts.jumps, "jump", {color: palette.jump, width: 1.4, dash: "dot"}),
    marks,
    point(rows[0], "begin", "circle-open"),
    point(rows[rows.length - 1], "end", "square"),
    ...flagged,
    ...saltus.simulatedOrbit(result, choice, view, palette, "scatter"),
    ...saltus.overlayOrbits(result, choice, view, palette, "scatter"),
  ];
};

/** An axis with its range; a logarithmic one from the least positive value on, which plotly wants as a logarithm. */
saltus.scaleOf = (range, values, log) => {
  const positive = log ? values.filter((value) => value > 0) : [];
  if (positive.length === 0) return {range};
  return {type: "log", range: saltus.roomyRange(positive.map(Math.log10))};
};

saltus.planeLayout = (result, choice, view, holder, palette, {equal, logs, resets}) => {
  const axis = (i, automargin) => ({
    title: {text: saltus.plain(saltus.shorten(saltus.axisLabel(result, choice[i]), 48)), standoff: 6},
    ...saltus.scaleOf(view.box[i], view.rows.map((row) => view.columns[i][row]), logs[i]),
    gridcolor: palette.grid,
    zerolinecolor: palette.axis,
    linecolor: palette.axis,
    showline: true,
    mirror: true,
    automargin,
    exponentformat: "power",
    minexponent: 5,
  });
  return {
    width: holder.clientWidth,
    height: holder.clientHeight,
    margin: {l: 60, r: 16, t: 44, b: 48},
    hovermode: "closest",
    separators: ".",
    // What the reader has zoomed to stays until other states or another time are chosen, or a double click.
    uirevision: JSON.stringify([choice, view.box, equal, logs, resets]),
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: palette.panel,
    font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
    xaxis: axis(0, "bottom"),
    yaxis: {...axis(1, "left"), ...(equal ? {scaleanchor: "x"} : {})},
    legend: {orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: {size: 11}},
  };
};

saltus.phasePlane = (result, timeline, select, address) => {
  const holder = saltus.element("div", {class: "phase-plot"});
  const note = saltus.element("p", {class: "quiet note"});
  const choice = saltus.axesFromText(result, address.get("plane")) ?? saltus.firstChoice(result, 2);
  const sliding = saltus.slidingIntervals(saltus.bandIntervals(result));
  const chosen = () => {
    address.set("plane", choice.join(","));
    draw();
  };
  const asked = (address.get("scales") ?? "").split("+");
  const box = (text, title, onchange = () => draw()) => {
    const input = saltus.element("input", {type: "checkbox", onchange});
    input.checked = asked.includes(text.replace(" ", "-"));
    return {input, label: saltus.element("label", {class: "controls", title}, input, text)};
  };
  const scaled = () => {
    const checked = [...logs, equal].filter(({input}) => input.checked).map(({label}) => label.textContent);
    address.set("scales", checked.length > 0 ? checked.join("+").replaceAll(" ", "-") : null);
    draw();
  };
  const equal = box("equal scales", "one unit is as long on both axes", scaled);
  const field = box("vector field", "where solutions go, at the end of the run; for models with two states");
  field.input.checked = true;
  field.label.hidden = result.vector_field === null;
  const logs = ["log x", "log y"].map((text) => box(text, "a logarithmic axis; shows what is positive", scaled));
  let resets = 0;
  const draw = () => {
    const palette = saltus.palette();
    const view = saltus.phaseView(result, timeline, choice, sliding, 1500);
    note.textContent = "";  // of what was drawn before
    if (view === null) return Plotly.purge(holder);
    const scales = {equal: equal.input.checked, logs: logs.map(({input}) => input.checked), resets};
    const surfaces = saltus.planeSurfaces(result, choice, view, palette, scales.logs);
    const said = saltus.surfaceNote({...surfaces, absent: saltus.surfacesNotDrawn(result, choice)}, view.at);
    note.textContent = `${said} Drag: zoom, with Shift: move, double click: all.`.trim();
    return Plotly.react(
        holder, [...(field.input.checked ? saltus.fieldTraces(result, choice, view, palette, scales.logs) : []),
                 ...surfaces.traces, ...saltus.planeTraces(result, choice, view, palette)],
        saltus.planeLayout(result, choice, view, holder, palette, scales), saltus.plotConfig);
  };
  const [first, second] = saltus.axisPickers(result, choice, chosen);
  const element = saltus.element(
      "section", {class: "card phase"},
      saltus.element(
          "header", {}, saltus.element("h2", {title: "within the time shown above"}, "Phase plane"),
          saltus.element("span", {class: "controls"}, second, " over ", first), ...logs.map(({label}) => label),
          equal.label, field.label, saltus.element("span", {class: "controls grow"}),
          ...saltus.saveButtons(result, holder, "phase-plane")),
      holder, note);
  const start = () => {
    draw();
    holder.on("plotly_click", ({points}) => {
      if (points[0].customdata !== undefined) select(points[0].customdata);
    });
    holder.on("plotly_doubleclick", () => {
      resets += 1;
      draw();
    });
  };
  return {element, draw, start};
};
