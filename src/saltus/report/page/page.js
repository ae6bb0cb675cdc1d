// Puts the parts together.
"use strict";

saltus.legend = (result, holder, timeline, chooser) => {
  const swatch = (kind, text) => saltus.element("span", {class: "swatch"}, saltus.element("i", {class: kind}), text);
  const modes = result.switching_functions.length === 0 ? [] : [
    saltus.element("span", {class: "quiet"}, "mode"),
    ...[[-1, "mode mode-minus", "− ψ<0"], [0, "mode mode-sliding", "0 sliding"], [1, "mode mode-plus", "+ ψ>0"]]
        .filter(([mode]) => result.trajectory.modes.some(({values}) => values.includes(mode)))
        .map(([, kind, text]) => swatch(kind, text)),
    ...(saltus.chatters(result) ? [swatch("mode mode-chattering", "chattering")] : [])
  ];
  const regions = result.regions.length === 0 ? [] : [
    saltus.element("span", {class: "quiet"}, "regions"), swatch("mode mode-plus", "active"),
    swatch("mode mode-sliding", "active with others")
  ];
  return saltus.element(
      "div", {class: "toolbar"}, ...modes, ...regions,
      ...(result.events.some(saltus.isAlarming) ? [swatch("alarm-line", "not unique")] : []),
      ...saltus.optimizationSwatches(result, swatch),
      ...(result.branches.length > 0 ? [swatch("branch-line", "branches")] : []),
      saltus.element(
          "span", {class: "quiet help", title: "Keys, when the drawing has the focus: arrows, +, -, 0. A click on the line of an event shows the event."},
          "drag: zoom, with Shift: move, double click: all"),
      saltus.element("button", {onclick: () => timeline().reset()}, "whole time"), chooser.button,
      ...saltus.saveButtons(result, holder, "trajectory"),
      saltus.element(
          "button", {
            title: "save the rows of this page as CSV",
            onclick: () => saltus.saveText(saltus.fileName(result, ".csv"), saltus.toCsv(result), "text/csv")
          },
          "CSV"));
};

saltus.eventSection = (result, parts) => {
  if (result.events.length === 0) {
    return saltus.element(
        "aside", {class: "card event-list"}, saltus.element("h2", {}, "Events"),
        saltus.element("p", {class: "quiet"}, "No switch, jump or other event occurred."));
  }
  const wide = saltus.element(
      "button", {title: "all columns below the drawing, or beside it", onclick: parts.toggleWide}, "all columns");
  return saltus.element(
      "aside", {class: "card event-list"},
      saltus.element("header", {}, saltus.element("h2", {}, saltus.count(result.events.length, "event")), wide),
      saltus.eventFilter(result, parts.show), parts.table.element, parts.inspector.element);
};

saltus.start = () => {
  const result = saltus.result = saltus.readPage();
  const main = document.getElementById("report");
  const address = saltus.address();
  const holder = saltus.element("div", {class: "timeline"});
  const frame = saltus.element("div", {class: "timeline-frame"}, holder);
  let timeline = null;
  const phases = [];
  const drawPhases = () => phases.forEach((phase) => phase.draw());

  const select = (i) => {
    table.flag(i);
    inspector.show(i);
    table.flag(i);  // again: the inspector has changed the height of the table
    timeline.flag(i);
    drawPhases();
  };
  const table = saltus.eventTable(result, select, (i) => timeline.zoomTo(i));
  const inspector = saltus.inspector(result, {
    select,
    step: (i, step) => select(table.neighbour(i, step)),
    zoomTo: (i) => timeline.zoomTo(i),
  });
  const redraw = () => {
    timeline?.draw();
    drawPhases();
    table.render();
  };
  const layout = saltus.element("div", {class: "layout"});
  const chooser = saltus.chooser(result, () => timeline);
  const parts = {
    table,
    inspector,
    show: (indices) => {
      table.show(indices);
      timeline.show(indices);
      drawPhases();
    },
    toggleWide: (event) => {
      const wide = layout.classList.toggle("wide-events");
      event.target.textContent = wide ? "fewer columns" : "all columns";
      table.setWide(wide);
      redraw();
    },
  };
  const theme = saltus.followTheme(redraw, address);
  main.append(saltus.pageHeader(result, theme.toggle), ...saltus.banners(result, select));
  const comparison = saltus.comparisonCard(result);
  if (comparison !== null) main.append(comparison);
  if (result.overlays.length > 0) main.append(saltus.overlayCard(result, saltus.palette()));
  const orders = saltus.orderPictures(result);
  phases.push(...orders);
  if (orders.length > 0)
    main.append(saltus.element("div", {class: "cards two orders"}, ...orders.map((order) => order.element)));
  main.append(layout);
  const bodies = saltus.bodiesCard(result, () => timeline);
  const drawing = saltus.element(
      "section", {class: "card drawing"}, saltus.legend(result, holder, () => timeline, chooser), chooser.element, frame);
  // What moves is what one came for; phases of contacts alone stand below.
  const [above, below] = bodies === null ? [null, null] : bodies.isFirst ? [bodies.element, null] : [null, bodies.element];
  layout.append(
      saltus.element("div", {class: "column"}, above, drawing),
      saltus.eventSection(result, parts));
  timeline = saltus.timeline(result, holder, {
    windowChanged: drawPhases,
  }, address);
  saltus.cursor(result, frame, holder, timeline, select);
  const cards = saltus.element("div", {class: "cards"});
  const branches = saltus.branchCard(result, {
    select,
    chosen: () => timeline.branch(),
    choose: (i) => {
      timeline.chooseBranch(i);
      drawPhases();
    },
  });
  const families = saltus.familyCard(result);
  const sensitivities = saltus.sensitivityCard(result);
  const sections = [saltus.verdictCard(result), below, branches, families, cards, sensitivities];
  main.append(...sections.filter((section) => section !== null), saltus.notes(result));
  if (saltus.columns(result).length > 1 && result.states.length > 0 && result.trajectory.t.length > 0) {
    phases.push(saltus.phasePlane(result, timeline, select, address));
    if (result.states.length > 2) phases.push(saltus.phasePortrait(result, timeline, select, address));
  }
  const differences = saltus.differencePicture(result, timeline);
  if (differences !== null) phases.push(differences);
  const multipliers = saltus.multiplierPicture(result, timeline);
  if (multipliers !== null) phases.push(multipliers);
  phases.push(...saltus.optimizationPictures(result, timeline));
  const intersection = saltus.intersectionPicture(result, timeline, select);
  if (intersection !== null) phases.push(intersection);
  const inCards = phases.slice(orders.length);
  if (inCards.length > 0) {
    cards.classList.toggle("two", inCards.length > 1);
    cards.append(...inCards.map((phase) => phase.element));
  }
  cards.append(saltus.element("div", {class: "info"}, ...saltus.infoCards(result)));
  if (bodies !== null) phases.push(bodies);
  // Not before all stand at their places: a drawing takes its width from there.
  for (const phase of phases) phase.start();
  table.render();

  let pending = 0;
  window.addEventListener("resize", () => {
    clearTimeout(pending);
    pending = setTimeout(() => {
      redraw();
      saltus.reachCards();
    }, 120);
  });
  document.addEventListener("toggle", saltus.reachCards, true);  // of what is folded
  saltus.reachCards();
  saltus.followPrinting(theme, table, redraw);
  const asked = Number(address.get("event")) - 1;
  if (result.events[asked] !== undefined) select(asked);
};

saltus.start();
