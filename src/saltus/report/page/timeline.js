// The drawing over time as a thing with a state: the window of time, the flagged event, the shown kinds.
"use strict";

/**
 * @param listeners  windowChanged(window) after every change of the window
 * @return           what other parts of the page may do with the drawing
 */
saltus.timeline = (result, holder, listeners, address) => {
  const full = saltus.fullWindow(result);
  // Of many switching functions some slide nearly always: shading would say nothing, the bands say it.
  const sliding = saltus.bands(result).length <= 4 ? saltus.slidingIntervals(saltus.bandIntervals(result)) : [];
  let shown = result.events.map((_, i) => i);
  let selected = null;
  let branch = null;
  let window_ = saltus.windowFromText(address.get("t")) ?? full;
  let choice = saltus.panelsFromText(result, address.get("c")) ?? saltus.firstPanels(result);
  let ranges = {};
  let stack = null;

  // Copies of the window are given away: plotly writes into ranges.
  const view = () => {
    const marks = saltus.visibleMarks(result, shown, window_);
    const pixels = Math.max(200, holder.clientWidth);
    return {window: [...window_], ranges, selected, branch, sliding, marks, pixels, palette: saltus.palette()};
  };

  const draw = () => {
    // As tall as the first screen allows, below head and warnings, above axis and border; below bodies as tall as a screen.
    const top = Math.min(holder.getBoundingClientRect().top + window.scrollY, 0.3 * window.innerHeight);
    stack = saltus.stackPanels(result, Math.max(360, window.innerHeight - top - 64), choice);
    const current = view();
    const layout = {...saltus.figureLayout(result, stack, current), width: holder.clientWidth};
    return Plotly.react(holder, saltus.figureTraces(result, stack, current), layout, saltus.plotConfig);
  };

  const windowMoved = () => {
    address.set("t", window_[0] === full[0] && window_[1] === full[1] ? null : window_.map((t) => saltus.brief(t, 9)).join(","));
    draw();
    listeners.windowChanged(window_);
  };

  const setWindow = (next) => {
    window_ = next;
    ranges = {};
    windowMoved();
  };

  const relayout = (change) => {
    for (const [key, value] of Object.entries(change)) {
      const match = /^yaxis(\d*)\.range\[([01])\]$/.exec(key);
      if (match === null) continue;
      const panel = match[1] === "" ? 0 : Number(match[1]) - 1;
      ranges[panel] ??= {range: [0, 0]};
      ranges[panel].range[Number(match[2])] = value;
    }
    const [from, to] = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
    if (from !== undefined && to !== undefined && to > from) window_ = [from, to];
    windowMoved();
  };

  /** A window around an event, as wide as its distance to the second neighbour on either side. */
  const windowAround = (i) => {
    const at = (k) => result.events[Math.min(Math.max(k, 0), result.events.length - 1)].t;
    const {t} = result.events[i];
    const reach = Math.max(t - at(i - 2), at(i + 2) - t) || (full[1] - full[0]) / 20;
    return [t - 1.1 * reach, t + 1.1 * reach];
  };

  const flag = (i) => {
    selected = i;
    address.set("event", i === null ? null : String(i + 1));
    if (i !== null) {
      const {t} = result.events[i];
      const half = (window_[1] - window_[0]) / 2;
      // Out of sight: the window moves there with its width.
      if (t < window_[0] || t > window_[1]) return setWindow([t - half, t + half]);
    }
    return draw();
  };

  /** The window shifted by and scaled with its width; within the whole time. */
  const moved = (shift, scale) => {
    const middle = (window_[0] + window_[1]) / 2 + shift * (window_[1] - window_[0]);
    const half = (scale * (window_[1] - window_[0])) / 2;
    const next = [Math.max(full[0], middle - half), Math.min(full[1], middle + half)];
    if (next[1] - next[0] > 1e-12 * (full[1] - full[0])) setWindow(next);
  };
  const keys = {
    ArrowLeft: () => moved(-0.2, 1),
    ArrowRight: () => moved(0.2, 1),
    "+": () => moved(0, 0.5),
    "-": () => moved(0, 2),
    0: () => setWindow(full),
  };
  holder.tabIndex = 0;
  holder.setAttribute("role", "application");
  holder.setAttribute("aria-label", "drawing over time; arrow keys move, plus and minus zoom, 0 shows the whole time");
  holder.addEventListener("keydown", (event) => {
    if (keys[event.key] === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    keys[event.key]();
  });

  draw();
  holder.on("plotly_relayout", relayout);
  holder.on("plotly_doubleclick", () => setWindow(full));
  return {
    draw,
    flag,
    setWindow,
    reset: () => setWindow(full),
    zoomTo: (i) => setWindow(windowAround(i)),
    show: (indices) => {
      shown = indices;
      draw();
    },
    chooseBranch: (i) => {
      branch = i;
      draw();
    },
    branch: () => branch,
    choice: () => choice,
    choose: (next) => {
      choice = next;
      ranges = {};
      address.set("c", saltus.panelsText(choice));
      draw();
    },
    window: () => [...window_],
    shown: () => shown,
    selected: () => selected,
    panels: () => stack,
  };
};
