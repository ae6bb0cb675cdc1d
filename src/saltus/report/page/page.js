// Puts the parts together.
"use strict";

saltus.legend = (result, timeline) => {
  const swatch = (kind, text) => saltus.element("span", {class: "swatch"}, saltus.element("i", {class: kind}), text);
  const modes = result.switching_functions.length === 0 ? [] : [
    saltus.element("span", {class: "quiet"}, "mode"), swatch("mode mode-minus", "− ψ<0"),
    swatch("mode mode-sliding", "0 sliding"), swatch("mode mode-plus", "+ ψ>0")
  ];
  return saltus.element(
      "div", {class: "toolbar"}, ...modes,
      ...(result.events.some(saltus.isAlarming) ? [swatch("alarm-line", "not unique")] : []),
      saltus.element(
          "span", {class: "quiet help", title: "A click on the line of an event shows the event."},
          "drag: zoom · double click: all"),
      saltus.element("button", {onclick: () => timeline().reset()}, "whole time"),
      saltus.element("button", {title: "save the drawing as PNG", onclick: () => timeline().save()}, "save"));
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
      saltus.kindFilter(result, parts.show), parts.table.element, parts.inspector.element);
};

saltus.start = () => {
  const result = JSON.parse(document.getElementById("result").textContent);
  const main = document.getElementById("report");
  const holder = saltus.element("div", {class: "timeline"});
  const frame = saltus.element("div", {class: "timeline-frame"}, holder);
  let timeline = null;
  let phase = null;

  const select = (i) => {
    table.flag(i);
    inspector.show(i);
    table.flag(i);  // again: the inspector has changed the height of the table
    timeline.flag(i);
  };
  const table = saltus.eventTable(result, select);
  const inspector = saltus.inspector(result, {
    select,
    step: (i, step) => select(table.neighbour(i, step)),
    zoomTo: (i) => timeline.zoomTo(i),
  });
  const redraw = () => {
    timeline?.draw();
    phase?.draw();
    table.render();
  };
  const layout = saltus.element("div", {class: "layout"});
  const parts = {
    table,
    inspector,
    show: (indices) => {
      table.show(indices);
      timeline.show(indices);
      phase?.draw();
    },
    toggleWide: (event) => {
      const wide = layout.classList.toggle("wide-events");
      event.target.textContent = wide ? "fewer columns" : "all columns";
      table.setWide(wide);
      redraw();
    },
  };
  const theme = saltus.followTheme(redraw);
  main.append(saltus.pageHeader(result, theme.toggle), ...saltus.banners(result, select), layout);
  layout.append(
      saltus.element("section", {class: "card drawing"}, saltus.legend(result, () => timeline), frame),
      saltus.eventSection(result, parts));
  timeline = saltus.timeline(result, holder, {
    windowChanged: () => phase?.draw(),
    // Beside the drawing the table is as tall as it, but never taller than the window.
    resized: (height) => layout.style.setProperty("--drawing-height", `${height + 92}px`),
  });
  saltus.cursor(result, frame, holder, timeline, select);
  const cards = saltus.element("div", {class: "cards"});
  main.append(cards, saltus.notes(result));
  if (result.states.length > 1 && result.trajectory.t.length > 0) {
    phase = saltus.phasePlane(result, timeline, select);
    cards.append(phase.element);
    phase.start();
  }
  cards.append(saltus.element("div", {class: "info"}, ...saltus.infoCards(result)));
  table.render();

  let pending = 0;
  window.addEventListener("resize", () => {
    clearTimeout(pending);
    pending = setTimeout(redraw, 120);
  });
  const asked = /event=(\d+)/.exec(window.location.hash);
  if (asked !== null && result.events[asked[1] - 1] !== undefined) select(asked[1] - 1);
};

saltus.start();
