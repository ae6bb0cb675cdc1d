// The cursor: one line through all panels, a dot on every curve, all values at that time beside it.
"use strict";

/** How near, in pixels, the pointer must be to an event for the cursor to stand on it. */
saltus.catchPixels = 6;
/** More values than this beside the pointer would cover the drawing. */
saltus.readoutRows = 36;

saltus.nearestShownEvent = (result, shown, t) => {
  const times = shown.map((i) => result.events[i].t);
  return shown.length === 0 ? null : shown[saltus.nearestRow(times, t)];
};

/** Names and values at a row; at the two rows of an event both, if they differ. */
saltus.readoutValues = (result, row, stack, pixel) => {
  const {trajectory} = result;
  const [first, last] = saltus.rowsAtOneTime(trajectory.t, row);
  const values = [];
  const change = (column) => {
    const [before, after] = [saltus.brief(column[first], 8), saltus.brief(column[last], 8)];
    return before === after ? after : `${before} → ${after}`;
  };
  // What is drawn; a selection stands with its mode.
  for (const curve of stack.panels.flatMap((panel) => panel.curves ?? [])) {
    if (!saltus.isFraction(curve.sort)) values.push([curve.name, change(curve.values)]);
  }
  const bands = new Set(stack.panels.flatMap((panel) => panel.bands ?? []));
  result.switching_functions.forEach((name, i) => {
    if (!bands.has(i)) return 0;
    const mode = saltus.valueAt(trajectory.modes[i], trajectory.t[row]);
    const changes = saltus.changesNear(trajectory.modes[i], trajectory.t[row], pixel);
    if (changes > 2) return values.push([name, `chattering, ${changes} per pixel`]);
    const alpha = mode === 0 ? `, α = ${saltus.brief(trajectory.alpha[i][last], 6)}` : "";
    return values.push([name, `${saltus.modeWord(mode)}${alpha}`]);
  });
  result.regions.forEach((name, i) => {
    if (!bands.has(result.switching_functions.length + i)) return;
    const active = saltus.valueAt(trajectory.regions[i], trajectory.t[row]);
    const word = active === null ? "not active" :
        active === 1             ? "active" :
                                   `θ = ${saltus.brief(trajectory.theta[i][last], 6)}`;
    values.push([name, word]);
  });
  return values;
};

saltus.readoutEvent = (result, index) => {
  const event = result.events[index];
  const modes = saltus.modeChange(event, "changed");
  const uncertain = {true: null, false: "solution not unique", null: "uniqueness not decided"}[String(event.unique)];
  return saltus.element(
      "div", {class: "readout-event"}, saltus.element("strong", {}, `${index + 1}. ${saltus.kindLabel(event.kind)}`),
      ` ${saltus.eventPlace(event)} `, modes, uncertain && saltus.element("div", {class: "alarm-text"}, uncertain),
      event.reason === "" ? null : saltus.element("div", {class: "quiet"}, event.reason));
};

saltus.cursor = (result, frame, holder, timeline, select) => {
  const overlay = saltus.svgElement("svg", {class: "cursor"});
  const readout = saltus.element("div", {class: "readout", hidden: ""});
  frame.append(overlay, readout);
  const {t} = result.trajectory;

  const place = (clientX) => {
    const {l, w} = holder._fullLayout._size;
    const pixel = clientX - holder.getBoundingClientRect().left - l;
    if (pixel < 0 || pixel > w || t.length === 0) return null;
    const axis = holder._fullLayout.xaxis;
    const time = axis.p2d(pixel);
    const index = saltus.nearestShownEvent(result, timeline.shown(), time);
    const caught = index !== null && Math.abs(axis.d2p(result.events[index].t) - pixel) <= saltus.catchPixels;
    const row = saltus.nearestRow(t, caught ? result.events[index].t : time);
    return {row, event: caught ? index : null};
  };

  const drawOverlay = (row) => {
    const size = holder._fullLayout._size;
    const x = size.l + holder._fullLayout.xaxis.d2p(t[row]);
    overlay.replaceChildren(
        saltus.svgElement("line", {x1: x, x2: x, y1: size.t, y2: size.t + size.h, class: "cursor-line"}));
    timeline.panels().panels.forEach((panel, i) => {
      if (panel.kind !== "curves") return;
      const axis = holder._fullLayout[saltus.axisKey(i)];
      panel.curves.forEach((curve, k) => {
        const value = curve.values[row];
        const y = value === null ? NaN : axis.d2p(value);
        if (!(y >= 0 && y <= axis._length)) return;
        const fill = saltus.curveColour(panel, k, saltus.palette());
        overlay.append(saltus.svgElement("circle", {cx: x, cy: axis._offset + y, r: 3.5, fill, class: "cursor-dot"}));
      });
    });
    return x;
  };

  const drawReadout = (x, found, clientY) => {
    const [from, to] = timeline.window();
    const pixel = (to - from) / holder._fullLayout._size.w;
    const values = saltus.readoutValues(result, found.row, timeline.panels(), pixel);
    const cells = values.slice(0, saltus.readoutRows)
                      .flatMap(
                          ([name, value]) =>
                              [saltus.element("span", {class: "name"}, saltus.shorten(name, 18)),
                               saltus.element("span", {class: "value"}, value)]);
    const left = values.length - saltus.readoutRows;
    readout.replaceChildren(
        saltus.element("div", {class: "readout-time"}, `t = ${saltus.exact(t[found.row])}`),
        saltus.element("div", {class: values.length > 12 ? "readout-grid wide" : "readout-grid"}, ...cells),
        ...(left > 0 ? [saltus.element("div", {class: "quiet"}, `and ${left} more`)] : []),
        ...(found.event === null ? [] : [saltus.readoutEvent(result, found.event)]));
    readout.hidden = false;
    const box = readout.getBoundingClientRect();
    const width = holder.clientWidth;
    const toRight = x + 14 + box.width < width;
    readout.style.left = `${toRight ? x + 14 : Math.max(0, x - 14 - box.width)}px`;
    const top = clientY - frame.getBoundingClientRect().top + 12;
    readout.style.top = `${Math.max(0, Math.min(top, frame.clientHeight - box.height - 4))}px`;
  };

  const hide = () => {
    overlay.replaceChildren();
    readout.hidden = true;
  };

  const move = (event) => {
    const found = event.buttons === 0 ? place(event.clientX) : null;
    if (found === null) return hide();
    return drawReadout(drawOverlay(found.row), found, event.clientY);
  };

  let pressed = null;
  frame.addEventListener("pointermove", move, true);
  frame.addEventListener("pointerleave", hide);
  frame.addEventListener("pointerdown", (event) => (pressed = [event.clientX, event.clientY]), true);
  window.addEventListener("pointerup", (event) => {
    const still = pressed !== null && Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) < 3;
    pressed = null;
    const found = still ? place(event.clientX) : null;
    if (found !== null && found.event !== null) select(found.event);
  }, true);
};
