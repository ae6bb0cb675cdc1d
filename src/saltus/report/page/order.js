// The cards of `order`: errors over step sizes, and the fitted slopes.
"use strict";

saltus.orderName = (series) => `${series.scheme} ${series.stages}, ${series.method}${
    series.reformulation === "" ? "" : `, ${series.reformulation}`}`;

/** One colour for every scheme, whatever the method; the method is the line: full with switch detection. */
saltus.orderStyle = (order, series, palette) => {
  const schemes = [...new Set(order.series.map((one) => `${one.scheme} ${one.stages}`))];
  const place = schemes.indexOf(`${series.scheme} ${series.stages}`);
  return {
    color: palette.curves[place % palette.curves.length],
    dash: series.method === "fesd" ? "solid" : "dot",
    symbol: series.reformulation === "stewart" ? "square" : "circle",
  };
};

/** Points that a logarithm has: an error of exactly 0 is drawn at rounding. */
saltus.orderPoints = (points, error) => {
  const there = points.filter((point) => point[error] !== null);
  return {x: there.map((point) => point.mean_step), y: there.map((point) => Math.max(point[error], 1e-17))};
};

saltus.orderTraces = (order, {error, slope, floor}, palette) => {
  const curves = order.series.map((series) => {
    const {color, dash, symbol} = saltus.orderStyle(order, series, palette);
    const {x, y} = saltus.orderPoints(series.points, error);
    const fitted = series[slope] === null ? "no slope" : `slope ${series[slope].toFixed(2)}`;
    return {
      type: "scatter",
      mode: "lines+markers",
      x,
      y,
      name: `${saltus.plain(saltus.orderName(series))}: ${fitted}`,
      line: {simplify: false, color, dash, width: 1.8},
      // Hollow: at the floor, not in the slope.
      marker: {size: 7, color, symbol: y.map((value) => (value > order[floor] ? symbol : `${symbol}-open`))},
      hovertemplate: "step %{x:.4g}<br>error %{y:.2e}<extra>%{fullData.name}</extra>",
    };
  });
  return curves.filter((curve) => curve.x.length > 0);
};

saltus.orderLayout = (title, floor, holder, palette) => {
  const axis = (text) => ({
    type: "log",
    title: {text, standoff: 6},
    gridcolor: palette.grid,
    exponentformat: "power",
    automargin: true,
    tickfont: {size: 11},
  });
  const line = {color: palette.mark, width: 1, dash: "dash"};
  return {
    width: holder.clientWidth,
    height: holder.clientHeight,
    margin: {l: 60, r: 12, t: 8, b: 44},
    hovermode: "closest",
    paper_bgcolor: "rgba(0,0,0,0)",
    plot_bgcolor: palette.panel,
    font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
    xaxis: axis("mean length of a finite element"),
    yaxis: axis(title),
    legend: {font: {size: 11}, bgcolor: "rgba(0,0,0,0)", y: -0.16, yanchor: "top", orientation: "h"},
    shapes: floor > 0 ? [{type: "line", xref: "paper", x0: 0, x1: 1, y0: floor, y1: floor, line}] : [],
  };
};

saltus.orderPicture = (result, sort) => {
  const {order} = result;
  const holder = saltus.element("div", {class: "phase-plot order"});
  const draw = () => {
    const palette = saltus.palette();
    return Plotly.react(
        holder, saltus.orderTraces(order, sort, palette),
        saltus.orderLayout(sort.title, order[sort.floor], holder, palette), saltus.plotConfig);
  };
  const element = saltus.element(
      "section", {class: "card phase"},
      saltus.element(
          "header", {}, saltus.element("h2", {class: "grow"}, sort.heading),
          ...saltus.saveButtons(result, holder, sort.error)),
      holder);
  return {element, draw, start: draw};
};

/** The pictures: of end states, and of switching times where there are any. */
saltus.orderPictures = (result) => {
  const {order} = result;
  if (order === null) return [];
  const sorts = [
    {
      error: "error",
      slope: "slope",
      floor: "floor",
      title: "error of the end state",
      heading: `Order: end state against ${order.reference}`
    },
    {
      error: "switch_time_error",
      slope: "switch_time_slope",
      floor: "time_floor",
      title: "error of the switching times",
      heading: "Order: switching times"
    }
  ];
  const measured = (sort) => order.series.some(
      (series) => series.points.some((point) => point[sort.error] !== null) && result.events.length > 0);
  return sorts.filter((sort) => sort.error === "error" || measured(sort)).map((sort) => saltus.orderPicture(result, sort));
};
