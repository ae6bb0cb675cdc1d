// A card with a drawing of its own: frame, axes, layout.
"use strict";

/** A card with a drawing; `figure(palette, holder)` gives its data and layout. */
saltus.drawingCard = (result, {title, note, file, controls = []}, figure, started = () => {}) => {
  const holder = saltus.element("div", {class: "phase-plot"});
  const draw = () => {
    const {data, layout} = figure(saltus.palette(), holder);
    return Plotly.react(holder, data, layout, saltus.plotConfig);
  };
  const element = saltus.element(
      "section", {class: "card phase"},
      saltus.element(
          "header", {}, saltus.element("h2", {}, title), saltus.element("span", {class: "controls grow"}, ...controls),
          ...saltus.saveButtons(result, holder, file)),
      holder, saltus.element("p", {class: "quiet note"}, note));
  const start = () => {
    draw();
    started(holder);
  };
  return {element, draw, start};
};

saltus.cardAxis = (palette, text, more = {}) => ({
  title: {text, standoff: 4},
  gridcolor: palette.grid,
  zerolinecolor: palette.axis,
  exponentformat: "power",
  minexponent: 4,
  automargin: true,
  tickfont: {size: 11},
  ...more,
});

saltus.cardLayout = (palette, holder, axes) => ({
  width: holder.clientWidth,
  height: holder.clientHeight,
  margin: {l: 60, r: 14, t: 34, b: 42},
  separators: ".",
  hovermode: "closest",
  paper_bgcolor: "rgba(0,0,0,0)",
  plot_bgcolor: palette.panel,
  font: {family: "system-ui, sans-serif", size: 12, color: palette.text},
  legend: {orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: {size: 11}},
  ...axes,
});

/** Zooming in a drawing over time moves the window of all of them. */
saltus.followsTime = (timeline) => (holder) => {
  holder.on("plotly_relayout", (change) => {
    const [from, to] = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
    if (from !== undefined && to !== undefined && to > from) timeline.setWindow([from, to]);
  });
  holder.on("plotly_doubleclick", () => timeline.reset());
};
