// Drawings as files, and the page on paper.
"use strict";

/** Buttons that save what `holder` shows; files have the colours and the background of the page. */
saltus.saveButtons = (result, holder, what) => {
  const save = (format) => {
    const layout = {...holder.layout, paper_bgcolor: saltus.palette().panel};
    const name = `${result.model.name || "simulation"}-${what}`.replaceAll(/[^A-Za-z0-9._-]+/g, "-");
    const {clientWidth: width} = holder;
    const height = layout.height ?? holder.clientHeight;
    return Plotly.downloadImage(
        {data: holder.data, layout}, {format, width, height, scale: format === "png" ? 3 : 1, filename: name});
  };
  const button = (text, format) => saltus.element(
      "button",
      {class: "save", title: `save the drawing as ${text}, in the colours of the page`, onclick: () => save(format)},
      text);
  return [button("SVG", "svg"), button("PNG", "png")];
};

/** Width of the drawings on paper, in pixels of 1/96 inch: A4 upright without its margins. */
saltus.paperWidth = 720;

/** On paper: light, one column, the whole table of events with its states; as before afterwards. */
saltus.followPrinting = (theme, table, redraw) => {
  let before = null;
  window.addEventListener("beforeprint", () => {
    before = saltus.currentTheme();
    document.documentElement.classList.add("paper");
    table.print(true);
    theme.apply("light");
  });
  window.addEventListener("afterprint", () => {
    document.documentElement.classList.remove("paper");
    table.print(false);
    theme.apply(before ?? saltus.currentTheme());
    redraw();
  });
};
