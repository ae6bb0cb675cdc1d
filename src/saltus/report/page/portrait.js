// The phase portrait of three states; needs WebGL, and says so where there is none.
"use strict";

saltus.hasWebGL = () => {
  const canvas = document.createElement("canvas");
  return (canvas.getContext("webgl2") ?? canvas.getContext("webgl")) !== null;
};

saltus.portraitTraces = (result, choice, view, palette) => {
  const {rows, columns, parts, events, selected} = view;
  const line = ([x, y, z], name, style) => ({
    type: "scatter3d",
    mode: "lines",
    x,
    y,
    z,
    name,
    hoverinfo: "skip",
    showlegend: x.length > 0,
    connectgaps: false,
    line: style,
  });
  const points = (list, name, marker, more = {}) => ({
    type: "scatter3d",
    mode: "markers",
    name,
    x: list.map((p) => p[0]),
    y: list.map((p) => p[1]),
    z: list.map((p) => p[2]),
    showlegend: list.length > 0,
    marker,
    ...more,
  });
  const place = (i) => choice.map((axis) => saltus.eventCoordinate(result, i, axis));
  const row = (i) => columns.map((column) => column[i]);
  const alarming = (i) => saltus.isAlarming(result.events[i]);
  return [
    ...saltus.branchOrbits(result, choice, view, palette, "scatter3d"),
    ...saltus.simulatedOrbit(result, choice, view, palette, "scatter3d"),
    ...saltus.overlayOrbits(result, choice, view, palette, "scatter3d"),
    line(parts.free, saltus.freeName(result), {color: palette.curves[0], width: 3}),
    line(parts.sliding, "sliding", {color: palette.sliding, width: 6}),
    line(parts.jumps, "jump", {color: palette.jump, width: 3, dash: "dot"}),
    points(
        events.map(place), "event", {
          size: events.map((i) => (alarming(i) ? 6 : 3)),
          color: events.map((i) => (alarming(i) ? palette.alarm : palette.mark))
        },
        {
          customdata: events,
          text: events.map((i) => saltus.plain(`${i + 1}. ${saltus.kindLabel(result.events[i].kind)}`)),
          hovertemplate: "%{text}<extra></extra>",
        }),
    points([row(rows[0])], "begin", {size: 5, symbol: "circle-open", color: palette.text}),
    points([row(rows[rows.length - 1])], "end", {size: 5, symbol: "square", color: palette.text}),
    ...(selected === null ? [] : [points(
                                     [place(selected)], `event ${selected + 1}`,
                                     {size: 9, symbol: "circle-open", color: palette.select, line: {width: 3}})]),
  ];
};

saltus.portraitSurfaces = (result, choice, view, palette) => {
  const all = result.surfaces
                  .map((surface, index) => ({surface, index, sheet: saltus.surfaceInSpace(surface, choice, view.at, view.box)}))
                  .filter(({sheet}) => sheet !== null);
  const drawn = saltus.surfacesToDraw(result, view, all);
  const cuts = drawn.map(({surface}) => surface).filter((surface) => !saltus.isExact(surface, choice, view.at.timeAxis));
  const seen = new Map();
  const traces = drawn.map(({surface, index, sheet}) => {
    const label = saltus.surfaceLabel(surface);
    const isFirst = !seen.has(label);
    if (isFirst) seen.set(label, saltus.surfaceStyle(index, surface, palette).color);
    return {
      type: "mesh3d",
      ...sheet,
      name: saltus.plain(label),
      legendgroup: label,
      showlegend: isFirst && seen.size <= saltus.maximumLegendSurfaces,
      hoverinfo: "skip",
      opacity: 0.22,
      flatshading: true,
      lighting: {ambient: 1, diffuse: 0, specular: 0},
      color: seen.get(label),
    };
  });
  return {traces, cuts, leftOut: all.length - drawn.length};
};

saltus.portraitLayout = (result, choice, view, holder, palette) => {
  // In space plotly reads no entities, and long titles leave the picture.
  const title = (i) => {
    const [long, short] = [saltus.axisLabel(result, i), saltus.columnTitle(saltus.axes(result)[i])];
    return saltus.shorten(long.length > 24 ? short : long, 24).replaceAll("<", "‹").replaceAll(">", "›");
  };
  const axis = (i) => ({
    title: {text: title(choice[i])},
    range: view.box[i],
    gridcolor: palette.axis,
    zerolinecolor: palette.axis,
    linecolor: palette.axis,
    showbackground: false,
    exponentformat: "power",
    minexponent: 5,
    tickfont: {size: 10},
  });
  return {
    width: holder.clientWidth,
    height: holder.clientHeight,
    margin: {l: 0, r: 0, t: 30, b: 0},
    separators: ".",
    uirevision: JSON.stringify(choice),
    paper_bgcolor: "rgba(0,0,0,0)",
    font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
    scene: {
      xaxis: axis(0),
      yaxis: axis(1),
      zaxis: axis(2),
      aspectmode: "cube",
      dragmode: "orbit",
      camera: {eye: {x: 1.4, y: -1.5, z: 0.85}, center: {x: 0, y: 0, z: -0.1}},
    },
    legend: {orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: {size: 11}},
  };
};

saltus.phasePortrait = (result, timeline, select, address) => {
  const holder = saltus.element("div", {class: "phase-plot"});
  const note = saltus.element("p", {class: "quiet note"});
  const choice = saltus.axesFromText(result, address.get("space"), 3) ?? saltus.firstChoice(result, 3);
  const sliding = saltus.slidingIntervals(saltus.bandIntervals(result));
  const possible = saltus.hasWebGL();
  let visible = false;
  const draw = () => {
    // A picture of three dimensions takes the graphics card most of a second: not before somebody looks.
    if (!possible || !visible) return null;
    const palette = saltus.palette();
    const view = saltus.phaseView(result, timeline, choice, sliding, 1500);
    note.textContent = "";  // of what was drawn before
    if (view === null) return Plotly.purge(holder);
    const surfaces = saltus.portraitSurfaces(result, choice, view, palette);
    const absent = result.surfaces.filter((surface) => surface.affine === null && !saltus.isExact(surface, choice));
    note.textContent = saltus.surfaceNote({...surfaces, absent}, view.at);
    return Plotly.react(
        holder, [...saltus.portraitTraces(result, choice, view, palette), ...surfaces.traces],
        saltus.portraitLayout(result, choice, view, holder, palette), saltus.plotConfig);
  };
  const [first, second, third] = saltus.axisPickers(result, choice, () => {
    address.set("space", choice.join(","));
    draw();
  });
  const element = saltus.element(
      "section", {class: "card phase undrawn"},
      saltus.element(
          "header", {}, saltus.element("h2", {}, "Phase portrait"),
          saltus.element("span", {class: "controls"}, third, " over ", first, " and ", second),
          saltus.element("span", {class: "controls quiet grow"}, possible ? "drag: turn, wheel: zoom" : ""),
          ...(possible ? saltus.saveButtons(result, holder, "phase-portrait") : [])),
      holder, note);
  const begin = () => {
    visible = true;
    element.classList.remove("undrawn");
    draw();
    holder.on("plotly_click", ({points}) => {
      if (points[0].customdata !== undefined) select(points[0].customdata);
    });
  };
  const start = () => {
    if (!possible) {
      holder.classList.add("absent");
      holder.textContent =
          "This browser shows no three-dimensional drawings (it has no WebGL). The phase plane beside shows any two states.";
      return;
    }
    const watch = new IntersectionObserver((entries) => {
      if (visible || !entries.some((entry) => entry.isIntersecting)) return;
      watch.disconnect();
      begin();
    }, {rootMargin: "200px"});
    watch.observe(holder);
  };
  return {element, draw, start};
};
