// The table of events: filter by kind, only the visible rows exist, a click flags the event in the drawing.
"use strict";

saltus.rowHeight = 27;

/** Modes before and after; of many switching functions only the changed ones fit into the narrow table. */
saltus.modeChange = (event, which) => {
  const [before, after] = [event.mode_before, event.mode_after];
  const size = (before ?? after ?? []).length;
  const narrow = which === "changed" && size > 1 && before !== null && after !== null;
  const changed = narrow ? before.map((_, i) => i).filter((i) => before[i] !== after[i]).slice(0, 3) : null;
  const part = (mode) => saltus.modeBoxes(changed === null || mode === null ? mode : changed.map((i) => mode[i]));
  if (changed !== null && changed.length === 0) return saltus.element("span", {class: "quiet"}, "same");
  return saltus.element("span", {}, part(before), " → ", part(after));
};

saltus.eventColumns = (result) => {
  const time = saltus.timeColumn(result.events.map((event) => event.t));
  const alpha = (values) => (values === null ? "–" : values.map((v) => saltus.brief(v, 6)).join(", "));
  const x = (values) => values.map((v) => saltus.brief(v, 9)).join(", ");
  const unique = (event) => {
    if (event.unique === true) return saltus.element("span", {class: "quiet"}, "yes");
    if (event.unique === null) return saltus.element("span", {class: "undecided"}, "?");
    return saltus.element("span", {class: "alarm-badge"}, "no");
  };
  const narrow = [
    {title: "#", cell: (_, i) => String(i + 1), class: "right"},
    {title: "t", cell: (event) => time(event.t), class: "right digits"},
    {title: "kind", cell: (event) => saltus.kindLabel(event.kind)},
    {title: "unique", cell: unique},
    {
      title: "surfaces",
      cell: (event) => (event.name === null ? event.surfaces.join(", ") : `${event.name} ${event.surfaces.join(", ")}`),
      class: "fill"
    },
    {title: "mode", cell: (event) => saltus.modeChange(event, "changed")},
  ];
  const wide = [
    {title: "mode of all", cell: (event) => saltus.modeChange(event, "all")},
    {
      title: "α before → after",
      cell: (event) => `${alpha(event.alpha_before)} → ${alpha(event.alpha_after)}`,
      class: "digits"
    },
    {
      title: `x = (${result.states.join(", ")})`,
      class: "digits",
      cell: (event) => (String(event.x) === String(event.x_after) ? x(event.x) : `${x(event.x)} → ${x(event.x_after)}`)
    },
    {title: "reason", cell: (event) => event.reason},
  ];
  const several = result.switching_functions.length > 1;
  return {narrow, all: [...narrow, ...wide.filter((column) => several || column.title !== "mode of all")]};
};

saltus.kindFilter = (result, changed) => {
  const counts = new Map();
  for (const event of result.events) counts.set(event.kind, (counts.get(event.kind) ?? 0) + 1);
  const hidden = new Set();
  let onlyUncertain = false;
  const apply = () => changed(result.events.map((_, i) => i).filter((i) => {
    const event = result.events[i];
    return !hidden.has(event.kind) && (!onlyUncertain || event.unique !== true);
  }));
  const box = (text, checked, toggle, kind) => saltus.element(
      "label", {class: kind ?? "chip"},
      saltus.element(
          "input", {type: "checkbox", ...(checked ? {checked: ""} : {}), onchange: (e) => toggle(e.target.checked)}),
      text);
  const boxes =
      [...counts].map(([kind, n]) => box(`${saltus.kindSign(kind)} ${saltus.kindLabel(kind)} ${n}`, true, (on) => {
                        if (on)
                          hidden.delete(kind);
                        else
                          hidden.add(kind);
                        apply();
                      }));
  if (result.events.some((event) => event.unique !== true)) {
    boxes.push(box("only not unique", false, (on) => {
      onlyUncertain = on;
      apply();
    }, "chip alarm-chip"));
  }
  return saltus.element("div", {class: "chips"}, ...boxes);
};

saltus.eventTable = (result, select) => {
  const columns = saltus.eventColumns(result);
  const head = saltus.element("thead");
  const body = saltus.element("tbody");
  const table = saltus.element("table", {class: "events"}, head, body);
  const scroller = saltus.element("div", {class: "scroller", tabindex: "0"}, table);
  let shown = result.events.map((_, i) => i);
  let selected = null;
  let current = columns.narrow;

  /** The event `step` places further among the shown ones. */
  const neighbour = (i, step) => shown[Math.min(Math.max(shown.indexOf(i) + step, 0), shown.length - 1)] ?? null;
  const row = (i) => {
    const event = result.events[i];
    const cells = current.map((column) => {
      const content = column.cell(event, i);
      const title = typeof content === "string" ? content : null;
      return saltus.element("td", {class: column.class, title}, content);
    });
    const state = `${i === selected ? "selected " : ""}${saltus.isAlarming(event) ? "alarming" : ""}`;
    return saltus.element("tr", {class: state, onclick: () => select(i)}, ...cells);
  };
  const space = (rows) =>
      saltus.element("tr", {class: "space", style: `height:${rows * saltus.rowHeight}px`}, saltus.element("td"));

  const render = () => {
    const first = Math.max(0, Math.floor(scroller.scrollTop / saltus.rowHeight) - 20);
    const last = Math.min(shown.length, first + Math.ceil(scroller.clientHeight / saltus.rowHeight) + 40);
    const rows = shown.slice(first, last).map(row);
    body.replaceChildren(space(first), ...rows, space(shown.length - last));
  };
  const renderHead = () => head.replaceChildren(
      saltus.element("tr", {}, ...current.map((c) => saltus.element("th", {class: c.class}, c.title))));

  scroller.addEventListener("scroll", () => requestAnimationFrame(render));
  scroller.addEventListener("keydown", (event) => {
    const step = {ArrowDown: 1, ArrowUp: -1}[event.key];
    if (step === undefined || shown.length === 0) return;
    event.preventDefault();
    select(selected === null ? shown[0] : neighbour(selected, step));
  });
  renderHead();
  return {
    element: scroller,
    render,
    show: (indices) => {
      shown = indices;
      scroller.scrollTop = 0;
      render();
    },
    setWide: (on) => {
      current = on ? columns.all : columns.narrow;
      renderHead();
      render();
    },
    flag: (i) => {
      selected = i;
      const place = shown.indexOf(i);
      const top = place * saltus.rowHeight;
      const visible = scroller.clientHeight - 2 * saltus.rowHeight;
      if (place >= 0 && (top < scroller.scrollTop || top > scroller.scrollTop + visible)) {
        scroller.scrollTop = Math.max(0, top - visible / 2);
      }
      render();
    },
    neighbour,
  };
};
