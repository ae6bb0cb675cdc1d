// What finite elements know: multipliers and selections at their ends and stages, and their lengths (Figs. 2 and 3 of
// Nurkanovic et al.).
"use strict";

/** More points than this in view: thinned curves. */
saltus.maximumStagePoints = 3000;
/** Marks at stages closer together than so many pixels on average would be a thick line. */
saltus.leastStageDistance = 4;

/** Elements [first, last) that a window of time touches. */
saltus.elementsInWindow = ({t, points}, [from, to]) => {
  const count = t.length / points;
  const ends = Array.from({length: count}, (_, e) => t[e * points + points - 1]);
  const begins = Array.from({length: count}, (_, e) => t[e * points]);
  return [saltus.lowerBound(ends, from), Math.max(saltus.lowerBound(begins, to), 0)];
};

/** The multipliers of one selection as curves: lambda_p and lambda_n, or lambda of a region. */
saltus.multiplierCurves = ({selections, lambda, selection}, i) => {
  const {name, form} = selections[i];
  const fraction = form === "step" ? "α" : "θ";
  const multipliers = form === "step" ?
      [
        {name: `λp(${name})`, values: lambda[i].map((psi) => Math.max(psi, 0)), dash: "solid"},
        {name: `λn(${name})`, values: lambda[i].map((psi) => Math.max(-psi, 0)), dash: "dash"}
      ] :
      [{name: `λ(${name})`, values: lambda[i], dash: "solid"}];
  return {multipliers, fraction: {name: `${fraction}(${name})`, values: selection[i], dash: "solid"}};
};

/**
 * A curve over the points of elements: continuous inside them; between two of them a jump is a gap, with both of its
 * sides in `jumps`.
 */
saltus.elementCurve = ({t, points}, values, [first, last]) => {
  const leastJump = saltus.leastJump(values);
  const curve = {x: [], y: [], jumps: {x: [], y: []}};
  for (let row = first * points; row < last * points; row += 1) {
    const begins = row % points === 0 && row > first * points;
    if (begins && Math.abs(values[row] - values[row - 1]) > leastJump) {
      curve.x.push(t[row]);
      curve.y.push(null);
      curve.jumps.x.push(t[row], t[row], null);
      curve.jumps.y.push(values[row - 1], values[row], null);
    }
    curve.x.push(t[row]);
    curve.y.push(values[row]);
  }
  return curve;
};

/** Values at the stages alone. */
saltus.stagePoints = ({t, points}, values, [first, last]) => {
  const x = [];
  const y = [];
  for (let e = first; e < last; e += 1) {
    for (let m = 1; m + 1 < points; m += 1) {
      x.push(t[e * points + m]);
      y.push(values[e * points + m]);
    }
  }
  return {x, y};
};

/** Lengths of elements as steps over time. */
saltus.lengthSteps = ({t, points}, [first, last]) => {
  const x = [];
  const y = [];
  for (let e = first; e < last; e += 1) {
    const [from, to] = [t[e * points], t[e * points + points - 1]];
    x.push(from, to);
    y.push(to - from, to - from);
  }
  return {x, y};
};

saltus.multiplierTraces = (elements, chosen, view, palette) => {
  const inView = saltus.elementsInWindow(elements, view.window);
  const inside = (inView[1] - inView[0]) * elements.points;
  const all = inside <= saltus.maximumStagePoints;
  const marks = inside * saltus.leastStageDistance <= view.pixels;
  const base = {type: "scatter", xaxis: "x", hoverinfo: "skip", connectgaps: false};
  const curve = ({name, values, dash}, yaxis, color, symbol) => {
    const line = {simplify: false, color, width: 1.6, dash};
    const label = {name: saltus.plain(saltus.shorten(name, 28)), legendgroup: name};
    if (!all) {
      const {x, y} = saltus.points(elements.t, values, view.window, view.pixels);
      return [{...base, ...label, yaxis, mode: "lines", x, y, line}];
    }
    const {x, y, jumps} = saltus.elementCurve(elements, values, inView);
    return [
      {...base, ...label, yaxis, mode: "lines", x, y, line},
      {...base, ...label, yaxis, mode: "lines", ...jumps, showlegend: false, line: {...line, width: 1, dash: "dot"}}, {
        ...base,
        ...label,
        ...saltus.stagePoints(elements, values, inView),
        yaxis,
        mode: "markers",
        showlegend: false,
        hoverinfo: "x+y+name",
        visible: marks,
        marker: {size: 5, color, symbol}
      }
    ];
  };
  const traces = chosen.flatMap((i, n) => {
    const {multipliers, fraction} = saltus.multiplierCurves(elements, i);
    const colour = palette.curves[n % palette.curves.length];
    return [
      ...multipliers.flatMap((one, k) => {
        const alone = chosen.length === 1 && k === 1 ? palette.curves[5] : colour;
        return curve(one, "y", alone, k === 0 ? "circle" : "circle-open");
      }),
      ...curve(fraction, "y2", chosen.length === 1 ? palette.sliding : colour, "diamond")
    ];
  });
  const lengths = {
    ...base,
    ...saltus.lengthSteps(elements, inView),
    yaxis: "y3",
    mode: "lines",
    name: "h",
    showlegend: false,
    line: {simplify: false, color: palette.text, width: 1.4}
  };
  return [...traces, lengths];
};

saltus.multiplierLayout = (elements, chosen, view, holder, palette) => {
  const axis = (text, domain, more = {}) => ({
    title: {text, standoff: 4},
    domain,
    gridcolor: palette.grid,
    zerolinecolor: palette.axis,
    exponentformat: "power",
    minexponent: 4,
    automargin: true,
    tickfont: {size: 11},
    ...more,
  });
  const steps = chosen.some((i) => elements.selections[i].form === "step");
  const [first, last] = saltus.elementsInWindow(elements, view.window);
  // The ends of elements, where there is room for them.
  const ends = last - first > 120 ? [] : Array.from({length: last - first + 1}, (_, k) => {
    const row = k === 0 ? first * elements.points : (first + k) * elements.points - 1;
    const x = elements.t[row];
    return {
      type: "line",
      x0: x,
      x1: x,
      yref: "paper",
      y0: 0,
      y1: 1,
      line: {color: palette.grid, width: 1},
      layer: "below"
    };
  });
  return {
    width: holder.clientWidth,
    height: holder.clientHeight,
    margin: {l: 56, r: 12, t: 30, b: 40},
    separators: ".",
    hovermode: "closest",
    dragmode: "zoom",
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: palette.panel,
    font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
    xaxis: {
      range: view.window,
      anchor: "y3",
      showgrid: false,
      zeroline: false,
      title: {text: "t", standoff: 4},
      exponentformat: "power",
      tickfont: {size: 11}
    },
    yaxis: axis("λ", [0.58, 1]),
    yaxis2: axis(steps ? "α" : "θ", [0.25, 0.53], {range: [-0.06, 1.06], tickvals: [0, 0.5, 1]}),
    yaxis3: axis("h", [0, 0.19], {rangemode: "tozero", nticks: 4}),
    legend: {orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: {size: 11}},
    shapes: ends,
  };
};

/** The selection to begin with: the first that is between its bounds somewhere, else that changes. */
saltus.firstSelection = ({selection}) => {
  const slides = selection.findIndex((values) => values.some((value) => value > 1e-9 && value < 1 - 1e-9));
  if (slides >= 0) return slides;
  return Math.max(0, selection.findIndex((values) => values.some((value) => value !== values[0])));
};

/** As many selections are drawn together; of more, one is chosen. */
saltus.selectionsTogether = 4;

/** The card; null for a result without elements. */
saltus.multiplierPicture = (result, timeline) => {
  const {elements} = result;
  if (elements === null || elements.t.length === 0) return null;
  const count = elements.selections.length;
  const together = count <= saltus.selectionsTogether;
  let chosen = together ? elements.selections.map((_, i) => i) : [saltus.firstSelection(elements)];
  const holder = saltus.element("div", {class: "phase-plot multipliers"});
  const draw = () => {
    const palette = saltus.palette();
    const view = {window: timeline.window(), pixels: Math.max(200, holder.clientWidth)};
    return Plotly.react(
        holder, saltus.multiplierTraces(elements, chosen, view, palette),
        saltus.multiplierLayout(elements, chosen, view, holder, palette), saltus.plotConfig);
  };
  const option = (text, value, selected) =>
      saltus.element("option", {value: String(value), ...(selected ? {selected: ""} : {})}, saltus.shorten(text, 40));
  const picker = count === 1 ?
      null :
      saltus.element(
          "select", {
            "aria-label": "selection",
            onchange: (e) => {
              const i = Number(e.target.value);
              chosen = i < 0 ? elements.selections.map((_, k) => k) : [i];
              draw();
            }
          },
          ...(together ? [option("all", -1, true)] : []),
          ...elements.selections.map(({name}, i) => option(name, i, !together && i === chosen[0])));
  const stages = elements.points - 2;
  const element = saltus.element(
      "section", {class: "card phase"},
      saltus.element(
          "header", {}, saltus.element("h2", {}, "Multipliers and elements"),
          saltus.element("span", {class: "controls grow"}, picker),
          ...saltus.saveButtons(result, holder, "multipliers")),
      holder,
      saltus.element(
          "p", {class: "quiet note"}, `Marks: ${saltus.count(stages, "stage")} of each element. Grey lines: ends of elements. `,
          "h: lengths of elements. The picture shows the same time as the drawing above."));
  const start = () => {
    draw();
    holder.on("plotly_relayout", (change) => {
      const [from, to] = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
      if (from !== undefined && to !== undefined && to > from) timeline.setWindow([from, to]);
    });
    holder.on("plotly_doubleclick", () => timeline.reset());
  };
  return {element, draw, start};
};
