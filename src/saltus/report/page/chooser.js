// Which columns are drawn over time, in which order, and which share an axis.
"use strict";

/** A choice with panel `from` moved to the place `to`. */
saltus.movePanel = (choice, from, to) => {
  if (to < 0 || to >= choice.panels.length) return choice;
  const panels = [...choice.panels];
  panels.splice(to, 0, ...panels.splice(from, 1));
  return {...choice, panels};
};

/** A choice with all curves of panel `from` on the axis of panel `onto`. */
saltus.joinPanels = (choice, from, onto) => {
  if (from === onto || choice.panels[onto] === undefined) return choice;
  const curves = [...new Set([...choice.panels[onto].curves, ...choice.panels[from].curves])];
  const panels = choice.panels.map((panel, i) => (i === onto ? {...panel, curves} : panel));
  return {...choice, panels: panels.filter((_, i) => i !== from)};
};

/** A choice with every curve of a panel in a panel of its own. */
saltus.splitPanel = (choice, place) => ({
  ...choice,
  panels: choice.panels.flatMap(
      (panel, i) => (i === place ? panel.curves.map((curve) => ({...panel, curves: [curve]})) : [panel])),
});

/** A choice with a column drawn (in a panel of its own, at the end) or not. */
saltus.showColumn = (choice, column, shown) => {
  const without = choice.panels.map((panel) => ({...panel, curves: panel.curves.filter((i) => i !== column)}))
                      .filter((panel) => panel.curves.length > 0);
  return {...choice, panels: shown ? [...without, {curves: [column], log: false}] : without};
};

saltus.showBand = (choice, band, shown) => {
  const others = choice.bands.filter((i) => i !== band);
  return {...choice, bands: shown ? [...others, band].sort((a, b) => a - b) : others};
};

/** One row of the list of panels: its curves and what can be done with it. */
saltus.panelRow = (result, choice, place, apply) => {
  const {curves, log} = choice.panels[place];
  const names = curves.map((i) => saltus.columnLabel(saltus.columns(result)[i])).join(", ");
  const button = (sign, title, next, possible = true) => saltus.element(
      "button", {
        title,
        "aria-label": `${title}: ${names}`,
        onclick: () => apply(next(), `${title}: ${names}`),
        ...(possible ? {} : {disabled: ""})
      },
      sign);
  const row = saltus.element(
      "li", {
        draggable: "true",
        title: "drag it between other rows to move it, or onto another row to share its axis",
        ondragstart: (event) => event.dataTransfer.setData("text/plain", String(place)),
        ondragover: (event) => event.preventDefault(),
        ondrop: (event) => {
          event.preventDefault();
          const from = Number(event.dataTransfer.getData("text/plain"));
          const {top, height} = row.getBoundingClientRect();
          const part = (event.clientY - top) / height;
          const moved = part < 0.25 || part > 0.75;
          const to = place + (part > 0.75 ? 1 : 0) - (from < place ? 1 : 0);
          apply(moved ? saltus.movePanel(choice, from, to) : saltus.joinPanels(choice, from, place), "");
        },
      },
      saltus.element("span", {class: "names"}, names),
      button("↑", "move up", () => saltus.movePanel(choice, place, place - 1), place > 0),
      button("↓", "move down", () => saltus.movePanel(choice, place, place + 1), place + 1 < choice.panels.length),
      button("⊕", "onto the axis above", () => saltus.joinPanels(choice, place, place - 1), place > 0),
      button("⊖", "an axis for each", () => saltus.splitPanel(choice, place), curves.length > 1),
      saltus.element(
          "label", {}, saltus.element("input", {
            type: "checkbox",
            "aria-label": `logarithmic axis: ${names}`,
            ...(log ? {checked: ""} : {}),
            onchange: (event) => apply(
                {
                  ...choice,
                  panels: choice.panels.map((panel, i) => (i === place ? {...panel, log: event.target.checked} : panel)),
                },
                `logarithmic axis: ${names}`),
          }),
          "log"));
  return row;
};

/** The list of all columns and bands whose name contains the text. */
saltus.columnList = (result, choice, text, apply) => {
  const shown = new Set(choice.panels.flatMap((panel) => panel.curves));
  const bands = new Set(choice.bands);
  const tick = (label, sort, checked, next) => saltus.element(
      "label", {}, saltus.element("input", {
        type: "checkbox",
        "aria-label": `${sort} ${label}`,
        ...(checked ? {checked: ""} : {}),
        onchange: (event) => apply(next(event.target.checked), `${sort} ${label}`),
      }),
      label, saltus.element("span", {class: "quiet"}, ` ${sort}`));
  const fits = (label) => label.toLowerCase().includes(text.toLowerCase());
  const words = {state: "state", output: "output", input: "input", alpha: "selection", theta: "weight"};
  const columns = saltus.columns(result).flatMap((column, i) => {
    const label = saltus.columnTitle(column);
    const about = column.caption?.label ? `, ${column.caption.label}` : "";
    const sort = `${words[column.sort]}${about}${saltus.isWide(column.range) ? "" : ", constant"}`;
    return fits(label) ? [tick(label, sort, shown.has(i), (on) => saltus.showColumn(choice, i, on))] : [];
  });
  const modes = saltus.bands(result).flatMap(
      (name, i) => fits(name) ? [tick(name, "mode", bands.has(i), (on) => saltus.showBand(choice, i, on))] : []);
  const most = 500;
  const all = [...columns, ...modes];
  return [
    ...all.slice(0, most), ...(all.length > most ? [saltus.element("span", {class: "quiet"}, "and more: search")] : []),
    ...(all.length === 0 ? [saltus.element("span", {class: "quiet"}, "none of this name")] : [])
  ];
};

/** A button, and the box that it opens. */
saltus.chooser = (result, timeline) => {
  let text = "";
  const panels = saltus.element("ol", {class: "panel-rows", "aria-label": "drawn, from top to bottom"});
  const columns = saltus.element("div", {class: "column-ticks", role: "group", "aria-label": "all columns"});
  const fill = (focus = "") => {
    const choice = timeline().choice();
    const apply = (next, label) => {
      timeline().choose(next);
      fill(label);
    };
    panels.replaceChildren(...choice.panels.map((_, place) => saltus.panelRow(result, choice, place, apply)));
    columns.replaceChildren(...saltus.columnList(result, choice, text, apply));
    // What had the focus has been made anew.
    if (focus !== "") element.querySelector(`[aria-label=${CSS.escape(focus)}]:not([disabled])`)?.focus();
  };
  const search = saltus.element("input", {
    type: "search",
    class: "column-search",
    placeholder: "search columns",
    "aria-label": "search columns",
    oninput: (event) => {
      text = event.target.value.trim();
      fill();
    },
  });
  const button = saltus.element(
      "button", {
        "aria-expanded": "false",
        title: "which columns are drawn, in which order, and which share an axis",
        onclick: () => {
          element.hidden = !element.hidden;
          button.setAttribute("aria-expanded", String(!element.hidden));
          if (!element.hidden) fill();
          timeline().draw();
        },
      },
      "columns");
  const first = saltus.element(
      "button", {
        title: "show the columns that change, as at first",
        onclick: () => {
          timeline().choose(saltus.firstPanels(result));
          fill();
        },
      },
      "as at first");
  const element = saltus.element(
      "div", {class: "chooser", hidden: ""}, saltus.element("div", {class: "chooser-side"}, panels, first),
      saltus.element("div", {class: "chooser-side"}, search, columns));
  return {button, element};
};
