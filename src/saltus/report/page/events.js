// The table of events: filter by kind, only the visible rows exist, a click flags the event in the drawing.
"use strict";

saltus.rowHeight = 27;

/** Modes before and after; of many switching functions only the changed ones fit into the narrow table. */
saltus.modeChange = (event, which) => {
  const [before, after] = [event.mode_before, event.mode_after];
  const size = (before ?? after ?? []).length;
  if (size === 0) return "";
  const narrow = which === "changed" && size > 1 && before !== null && after !== null;
  const changed = narrow ? before.map((_, i) => i).filter((i) => before[i] !== after[i]).slice(0, 3) : null;
  const part = (mode) => saltus.modeBoxes(changed === null || mode === null ? mode : changed.map((i) => mode[i]));
  if (changed !== null && changed.length === 0)
    return saltus.element("span", {class: "quiet"}, event.surfaces.length > 0 && event.kind !== "jump" ? "…" : "same");
  return saltus.element("span", {}, part(before), " → ", part(after));
};

/** "a + b", of several groups "a + b; c"; before and after only the groups that change. */
saltus.regionsText = (regions) => regions.map((active) => active.join(" + ")).join("; ");
saltus.regionChange = (event) => {
  const [before, after] = [event.regions_before, event.regions_after];
  if (after === null) return before === null ? "" : saltus.regionsText(before);
  if (before === null) return saltus.regionsText(after);
  const changed = after.map((_, g) => g).filter((g) => String(before[g]) !== String(after[g]));
  if (changed.length === 0) return "same";
  const part = (regions) => saltus.regionsText(changed.map((g) => regions[g]));
  return `${part(before)} → ${part(after)}`;
};

/** The name, of a hysteresis with what it turned to. */
saltus.eventName = ({name, turned}) => [name, turned].filter((word) => word).join(" ");

/** Name and surfaces; a jump is its own surface. */
saltus.eventPlace = (event) => {
  const others = event.surfaces.filter((surface) => surface !== event.name).join(", ");
  return `${saltus.eventName(event)} ${others}`.trim();
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
    ...(result.optimization ? [] : [{title: "unique", cell: unique}]),
    {title: "surfaces", cell: saltus.eventPlace, class: "fill"},
    ...(result.switching_functions.length > 0 ?
            [{title: "mode", cell: (event) => saltus.modeChange(event, "changed"), class: "mode-change"}] :
            []),
    ...(result.regions.length > 0 ?
            [
              {title: "regions", cell: (event) => saltus.regionsText(event.regions_after ?? event.regions_before ?? [])}
            ] :
            []),
  ];
  const wide = [
    {title: "mode of all", cell: (event) => saltus.modeChange(event, "all")},
    ...(result.regions.length > 0 ? [{title: "regions before → after", cell: saltus.regionChange}] : []),
    ...(result.switching_functions.length === 0 ? [] : [{
      title: "α before → after",
      cell: (event) => `${alpha(event.alpha_before)} → ${alpha(event.alpha_after)}`,
      class: "digits"
    }]),
    {
      title: `x = (${result.states.join(", ")})`,
      class: "digits",
      cell: (event) => (String(event.x) === String(event.x_after) ? x(event.x) : `${x(event.x)} → ${x(event.x_after)}`)
    },
    {title: "reason", cell: (event) => event.reason},
  ];
  const several = result.switching_functions.length > 1;
  // On paper there is no room for more.
  const few = result.states.length <= saltus.printedStates;
  const printed = [...narrow, ...wide.filter((column) => few && column.title.startsWith("x ="))];
  return {narrow, printed, all: [...narrow, ...wide.filter((column) => several || column.title !== "mode of all")]};
};

/** What a search looks through: number, kind, name, surfaces, reason. */
saltus.eventText = (event, i) => [`#${i + 1}`, saltus.kindLabel(event.kind), saltus.eventName(event), ...event.surfaces,
                                  event.reason, ...(event.regions_after ?? []).flat()]
                                     .join("\n")
                                     .toLowerCase();

/** Events that have all words of the search in their text. */
saltus.matchingEvents = (events, search) => {
  const words = search.toLowerCase().split(/\s+/).filter((word) => word !== "");
  return events.map((_, i) => i).filter((i) => {
    const text = saltus.eventText(events[i], i);
    // A number of an event is all of it: #1 is not #12.
    return words.every((word) => (/^#\d+$/.test(word) ? word === `#${i + 1}` : text.includes(word)));
  });
};

saltus.eventFilter = (result, changed) => {
  const counts = new Map();
  for (const event of result.events) counts.set(event.kind, (counts.get(event.kind) ?? 0) + 1);
  const hidden = new Set();
  let onlyUncertain = false;
  const found = saltus.element("span", {class: "quiet", "aria-live": "polite"});
  const search = saltus.element("input", {
    type: "search",
    class: "search",
    placeholder: "search: name, surface, reason, #12",
    "aria-label": "search events",
  });
  const apply = () => {
    const shown = saltus.matchingEvents(result.events, search.value).filter((i) => {
      const event = result.events[i];
      return !hidden.has(event.kind) && (!onlyUncertain || event.unique !== true);
    });
    found.textContent = shown.length === result.events.length ? "" : `${shown.length} shown`;
    changed(shown);
  };
  let pending = 0;
  search.addEventListener("input", () => {
    clearTimeout(pending);
    pending = setTimeout(apply, 150);
  });
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
  if (!result.optimization && result.events.some((event) => event.unique !== true)) {
    boxes.push(box("only not unique", false, (on) => {
      onlyUncertain = on;
      apply();
    }, "chip alarm-chip"));
  }
  return saltus.element("div", {class: "chips"}, ...boxes, search, found);
};

/** Rows of the table on paper, and states and modes beside each other in them. */
saltus.printedRows = 400;
saltus.printedStates = 12;

saltus.eventTable = (result, select, zoomTo) => {
  const columns = saltus.eventColumns(result);
  const head = saltus.element("thead");
  const body = saltus.element("tbody");
  const many = result.switching_functions.length > saltus.printedStates;
  const table = saltus.element("table", {class: many ? "events many" : "events"}, head, body);
  const scroller = saltus.element(
      "div", {
        class: "scroller",
        tabindex: "0",
        role: "region",
        "aria-label":
            "events; arrow keys, Home and End choose one, Enter zooms to it, Escape deselects it"
      },
      table);
  let shown = result.events.map((_, i) => i);
  let selected = null;
  let current = columns.narrow;
  let printing = false;

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
    const attributes = {class: state, "aria-selected": String(i === selected), onclick: () => select(i)};
    return saltus.element("tr", attributes, ...cells);
  };
  const space = (rows) =>
      saltus.element("tr", {class: "space", style: `height:${rows * saltus.rowHeight}px`}, saltus.element("td"));

  const remark = (left) => left === 0 ?
      "" :
      saltus.element(
          "tr", {}, saltus.element("td", {colspan: String(current.length)}, `and ${left} more in the result file`));

  const render = () => {
    const first = printing ? 0 : Math.max(0, Math.floor(scroller.scrollTop / saltus.rowHeight) - 20);
    const onScreen = printing ? saltus.printedRows : Math.ceil(scroller.clientHeight / saltus.rowHeight) + 40;
    const last = Math.min(shown.length, first + onScreen);
    const rows = shown.slice(first, last).map(row);
    const left = shown.length - last;
    body.replaceChildren(space(first), ...rows, printing ? remark(left) : space(left));
  };
  const renderHead = () => head.replaceChildren(
      saltus.element("tr", {}, ...current.map((c) => saltus.element("th", {class: c.class}, c.title))));

  scroller.addEventListener("scroll", () => requestAnimationFrame(render));
  scroller.addEventListener("keydown", (event) => {
    const page = Math.max(1, Math.floor(scroller.clientHeight / saltus.rowHeight) - 2);
    const all = shown.length;
    const step = {ArrowDown: 1, ArrowUp: -1, PageDown: page, PageUp: -page, Home: -all, End: all}[event.key];
    if (event.key === "Enter" && selected !== null) return zoomTo(selected);
    if (event.key === "Escape") return select(null);
    if (step === undefined || all === 0) return undefined;
    event.preventDefault();
    if (selected !== null) return select(neighbour(selected, step));
    return select(event.key === "End" ? shown[all - 1] : shown[0]);
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
    print: (on) => {
      printing = on;
      current = on ? columns.printed : columns.narrow;
      renderHead();
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
