// The page of a sweep: values over one parameter, maps over two, values at events, number of events, status.
"use strict";

/** Head of the page: how many runs, how they ended. */
saltus.sweepHeader = (table, data, toggleTheme) => {
  const {columns, runRows} = table;
  const counts = new Map();
  for (const row of runRows) counts.set(columns.status[row], (counts.get(columns.status[row]) ?? 0) + 1);
  const badges = [...counts].map(([status, count]) => {
    const kind = status === "completed" ? "good" : table.isDone(runRows.find((row) => columns.status[row] === status)) ? "notice" : "bad";
    return saltus.element("span", {class: `badge ${kind}`}, `${count.toLocaleString("en-US")} ${status.replaceAll("_", " ")}`);
  });
  return saltus.element(
      "header", {class: "head"},
      saltus.element(
          "div", {class: "title"}, saltus.element("h1", {}, data.title || "Sweep"), ...badges,
          saltus.element("span", {class: "description"}, `${saltus.count(runRows.length, "run")} over ${table.swept.join(", ")}`)),
      saltus.element(
          "div", {class: "aside"},
          saltus.element("button", {class: "theme", title: "light or dark", "aria-label": "light or dark", onclick: toggleTheme}, "◐")));
};

saltus.sweepBanners = (table, data, choose) => {
  const {runRows} = table;
  const banner = (kind, rows, ...said) => {
    if (rows.length === 0) return [];
    const buttons = rows.slice(0, 8).map(
        (row) => saltus.element("button", {onclick: () => choose(row)}, `run ${table.columns.run[row]}`));
    return [saltus.element(
        "div", {class: `banner ${kind}`, role: kind === "bad" ? "alert" : "status"}, ...said, " ", ...buttons,
        rows.length > buttons.length ? ` and ${rows.length - buttons.length} more` : null)];
  };
  const stopped = runRows.filter((row) => !table.isDone(row));
  const doubtful = runRows.filter(table.isAlarming);
  return [
    ...banner("bad", stopped, saltus.element("strong", {}, `${stopped.length} of ${runRows.length} runs stopped early`),
        ` and ${stopped.length === 1 ? "has no end" : "have no ends"}: a black cross marks them.`),
    ...banner("notice", doubtful, saltus.element("strong", {}, `The solution is not unique in ${doubtful.length} of ${runRows.length} runs`),
        ", marked by a red cross:"),
    ...(data.left_out ? [saltus.element("div", {class: "banner notice", role: "status"}, data.left_out)] : []),
  ];
};

saltus.saveSvg = (title, svg) => {
  const copy = svg.cloneNode(true);
  copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
  copy.setAttribute("style", `background: ${saltus.palette().panel}`);
  saltus.saveText(`${title.replace(/[^\w-]+/g, "-")}.svg`, copy.outerHTML, "image/svg+xml");
};

saltus.startSweep = () => {
  const data = JSON.parse(document.getElementById("sweep").textContent);
  const table = saltus.sweepTable(data);
  const address = saltus.address();
  const page = {data, table, zooms: new Map(), state: saltus.sweepState(table, data)};
  const theme = saltus.followTheme(() => draw(), address);
  const run = saltus.runCard(table, data);
  const pictures = saltus.element("div", {id: "pictures", class: "column"});
  const choose = (row) => {
    run.show(row);
    for (const note of pictures.querySelectorAll(".chosen-run")) note.textContent = saltus.runText(table, row);
  };
  const section = ({title, legend, make}) => {
    const holder = saltus.element("div", {});
    const render = () => {
      const frame = make(Math.max(300, holder.clientWidth), page.zooms.get(title) ?? null);
      saltus.zooms(frame, (ranges) => {
        page.zooms.set(title, ranges);
        render();
        holder.firstChild.focus({preventScroll: true});
      }, choose);
      holder.replaceChildren(frame.svg);
    };
    const element = saltus.element(
        "section", {class: "card picture"},
        saltus.element(
            "header", {}, saltus.element("h2", {}, title), ...legend, saltus.element("span", {class: "grow"}),
            saltus.element("button", {class: "save", title: "save the picture as SVG", onclick: () => saltus.saveSvg(title, holder.firstChild)}, "SVG")),
        holder, saltus.element("p", {class: "quiet note chosen-run"}));
    pictures.append(element);
    render();
  };
  const draw = () => {
    pictures.replaceChildren();
    saltus.sweepPictures(page).forEach(section);
  };
  const changed = () => {
    page.zooms.clear();
    draw();
  };
  const controls = saltus.element("div", {class: "card toolbar", id: "controls"}, ...saltus.sweepControls(page, changed));
  const left = saltus.element("div", {class: "column"}, controls, pictures);
  document.getElementById("report").append(
      saltus.sweepHeader(table, data, theme.toggle), ...saltus.sweepBanners(table, data, choose),
      saltus.element("div", {class: "layout sweep"}, left, run.element),
      saltus.element("footer", {}, saltus.element("p", {}, `Saltus ${data.saltus}, command sweep.`)));
  if (table.runRows.length > 0) {
    draw();
    run.show(table.runRows[0]);
  }
  let pending = 0;
  window.addEventListener("resize", () => {
    clearTimeout(pending);
    pending = setTimeout(draw, 120);
  });
  saltus.followPrinting(theme, {print: () => {}}, draw);
};

saltus.startSweep();
