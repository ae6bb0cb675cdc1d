// Curves over the ascending times of the trajectory: searching, thinning to the pixels of the screen, gaps at jumps.
"use strict";

/** First index with values[index] >= x. */
saltus.lowerBound = (values, x) => {
  let low = 0;
  let high = values.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (values[middle] < x)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
};

/** Rows [begin, end) that a window of time needs: one more on each side, so that lines run to the border. */
saltus.rowsInWindow = (t, [from, to]) => {
  const begin = Math.max(0, saltus.lowerBound(t, from) - 1);
  let end = saltus.lowerBound(t, to);
  while (end < t.length && t[end] === to) end += 1;
  return [begin, Math.min(t.length, end + 1)];
};

saltus.nearestRow = (t, x) => {
  const i = saltus.lowerBound(t, x);
  if (i === 0) return 0;
  if (i === t.length) return t.length - 1;
  return x - t[i - 1] < t[i] - x ? i - 1 : i;
};

/** Rows that share their time with a neighbour: the two sides of an event. */
saltus.isPaired = (t, i) => t[i] === t[i - 1] || t[i] === t[i + 1];

/** First and last row of those that share their time with row i. */
saltus.rowsAtOneTime = (t, i) => {
  let [first, last] = [i, i];
  while (t[first - 1] === t[i]) first -= 1;
  while (t[last + 1] === t[i]) last += 1;
  return [first, last];
};

/** More pairs than this within the window: closer together than pixels, drawn through their extremes alone. */
saltus.maximumPairs = 2000;

/**
 * Rows of [begin, end) to draw: all if there are few, else per bucket of time (a pixel) the first, least, greatest
 * and last, for each of the columns, and both rows of every event.
 */
saltus.rowsToDraw = (t, columns, [begin, end], buckets) => {
  const all = end - begin;
  if (all <= 4 * buckets) return Array.from({length: all}, (_, i) => begin + i);
  let pairs = 0;
  for (let i = begin; i < end; i += 1) pairs += saltus.isPaired(t, i) ? 1 : 0;
  const keepPairs = pairs <= 2 * saltus.maximumPairs;
  const width = (t[end - 1] - t[begin]) / buckets;
  const rows = [];
  for (let i = begin; i < end;) {
    const limit = t[begin] + width * (Math.floor((t[i] - t[begin]) / width) + 1);
    const chosen = new Set([i]);
    const extremes = columns.map(() => ({least: i, greatest: i}));
    let k = i;
    for (; k < end && (k === i || t[k] < limit); k += 1) {
      if (keepPairs && saltus.isPaired(t, k)) chosen.add(k);
      columns.forEach((values, c) => {
        const value = values[k];
        const best = extremes[c];
        if (value === null)
          chosen.add(k);
        else if (values[best.least] === null || value < values[best.least])
          best.least = k;
        if (value !== null && (values[best.greatest] === null || value > values[best.greatest])) best.greatest = k;
      });
    }
    chosen.add(k - 1);
    for (const {least, greatest} of extremes) chosen.add(least).add(greatest);
    rows.push(...[...chosen].sort((a, b) => a - b));
    i = k;
  }
  return rows;
};

/**
 * Smallest difference across an event that counts as a jump: a hundredth of a pixel. Below it are the roundings of a
 * state that was put onto its surface.
 */
saltus.leastJump = (values) => {
  const [least, greatest] = saltus.range(values);
  return 1e-5 * (greatest - least);
};

/** Whether a curve jumps from row i to row k. */
saltus.jumpsBetween = (t, values, i, k, leastJump) =>
    t[i] === t[k] && values[i] !== null && values[k] !== null && Math.abs(values[k] - values[i]) > leastJump;

/**
 * Pixels of [begin, end) in which a curve jumps more than once, to and fro: lines would show something slower. Each with
 * its rows, its ends in time, the least and greatest value and the mean over time of whole periods, from a jump upwards
 * to another one: that of a part of a period would depend on where the pixel begins.
 */
saltus.chatteringPixels = (t, values, [begin, end], buckets, leastJump) => {
  const pixels = [];
  const width = (t[end - 1] - t[begin]) / buckets;
  if (!(width > 0) || end - begin < 200) return pixels;
  let area = 0;
  let rise = null;
  for (let i = begin; i < end;) {
    const limit = t[begin] + width * (Math.floor((t[i] - t[begin]) / width) + 1);
    const pixel = {begin: i, from: t[i], low: Infinity, high: -Infinity};
    const start = {t: t[i], area};
    // The last jump upwards of the pixel before, if it was not long ago.
    let first = rise !== null && t[i] - rise.t < 2 * width ? rise : null;
    let [jumps, k] = [0, i];
    for (; k < end && (k === i || t[k] < limit); k += 1) {
      const value = values[k];
      if (value === null) continue;
      pixel.low = Math.min(pixel.low, value);
      pixel.high = Math.max(pixel.high, value);
      if (k > i && saltus.jumpsBetween(t, values, k - 1, k, leastJump)) {
        jumps += 1;
        if (value > values[k - 1]) rise = {t: t[k], area};
        if (value > values[k - 1]) first ??= rise;
      }
      if (k + 1 < end && values[k + 1] !== null) area += 0.5 * (value + values[k + 1]) * (t[k + 1] - t[k]);
    }
    const to = t[Math.min(k, end - 1)];
    if (jumps > 1 && to > pixel.from) {
      const [a, b] = first !== null && rise.t > first.t ? [first, rise] : [start, {t: to, area}];
      pixels.push({...pixel, end: k, to, mean: (b.area - a.area) / (b.t - a.t), jumps});
    }
    i = k;
  }
  return pixels;
};

/** The impulse of a contact is there at one instant: no line leads from it to the row behind. */
saltus.isImpulse = (result, {sort, name}) =>
    sort === "output" && (result.contacts ?? []).some((contact) => name === `impulse(${contact})`);

/** Upright lines from 0 where values are not 0, of those nearer than a pixel the longest. */
saltus.impulseLines = (t, values, [from, to], pixels) => {
  const x = [Math.max(from, t[0])];
  const y = [0];
  values.forEach((value, i) => {
    if (!value || t[i] < from || t[i] > to) return;
    const last = y.length - 2;
    if (last > 0 && t[i] - x[last] < (to - from) / pixels) {
      if (Math.abs(value) > Math.abs(y[last])) y[last] = value;
      return;
    }
    x.push(t[i], t[i], t[i]);
    y.push(0, value, 0);
  });
  x.push(Math.min(to, t[t.length - 1]));
  y.push(0);
  return {x, y, jumps: {x: [], y: []}};
};

/** The same points, of which one between two gaps is a short line: alone it would not be drawn. */
saltus.withoutLonePoints = (x, y, length) => {
  const isLone = (i) => (y[i] ?? null) !== null && (y[i - 1] ?? null) === null && (y[i + 1] ?? null) === null;
  if (!y.some((_, i) => isLone(i))) return {x, y};
  const twice = (list, ends) => list.flatMap((value, i) => (isLone(i) ? ends(value) : [value]));
  return {
    x: twice(x, (time) => [time - length / 2, time + length / 2]),
    y: twice(y, (value) => [value, value]),
  };
};

/**
 * Points of one curve; a jump (two values at one time) and a missing value are gaps. `jumps` has both sides of every
 * jump with a gap behind, `envelope` what is drawn instead where it chatters. A discrete curve has no gaps: its steps are
 * the curve.
 */
saltus.points = (t, values, window, buckets, discrete = false) => {
  const leastJump = saltus.leastJump(values);
  const x = [];
  const y = [];
  const jumps = {x: [], y: []};
  const [begin, end] = saltus.rowsInWindow(t, window);
  const chattering = saltus.chatteringPixels(t, values, [begin, end], buckets, leastJump);
  let previous = -1;
  const gap = (time) => {
    x.push(time);
    y.push(null);
    previous = -1;
  };
  const stretch = (from, to) => {
    if (from >= to) return;
    const part = Math.max(10, Math.ceil((buckets * (t[to - 1] - t[from])) / (t[end - 1] - t[begin])));
    for (const i of saltus.rowsToDraw(t, [values], [from, to], chattering.length === 0 ? buckets : part)) {
      if (previous >= 0 && saltus.jumpsBetween(t, values, previous, i, leastJump) && !discrete) {
        x.push(t[i]);
        y.push(null);
        jumps.x.push(t[i], t[i], null);
        jumps.y.push(values[previous], values[i], null);
      }
      x.push(t[i]);
      y.push(values[i]);
      previous = i;
    }
  };
  let from = begin;
  for (const pixel of chattering) {
    stretch(from, pixel.begin + 1);
    if (previous >= 0) gap(pixel.from);
    from = pixel.end;
  }
  stretch(from, end);
  const list = (key) => chattering.map((pixel) => pixel[key]);
  const envelope =
      {x: chattering.map((pixel) => [pixel.from, pixel.to]), low: list("low"), high: list("high"), mean: list("mean")};
  return {...saltus.withoutLonePoints(x, y, (t[end - 1] - t[begin]) / buckets), jumps, envelope};
};

/** How often a mode changes within a pixel around a time. */
saltus.changesNear = ({edges}, time, pixel) =>
    saltus.lowerBound(edges, time + pixel / 2) - saltus.lowerBound(edges, time - pixel / 2);

/** Whether any mode changes so often that the whole time in one drawing shows chattering. */
saltus.chatters = (result) => result.trajectory.modes.some(
    ({edges}) => edges.some((time, i) => i + 2 < edges.length && edges[i + 2] - time < (edges.at(-1) - edges[0]) / 1000));

/**
 * Rectangles of the band of a mode: {from, to, share: {minus, sliding, plus}, count}. Intervals of a pixel or more are
 * rectangles of their own; shorter ones in one pixel become one, with the part of its time that each mode has.
 */
saltus.modeCells = ({edges, values}, [from, to], pixels) => {
  const step = (to - from) / pixels;
  const names = {"-1": "minus", 0: "sliding", 1: "plus"};
  const cells = [];
  let i = Math.max(0, saltus.lowerBound(edges, from) - 1);
  while (i < values.length && edges[i] <= to) {
    const cell = {from: edges[i], to: edges[i], share: {minus: 0, sliding: 0, plus: 0}, count: 0};
    let k = i;
    do {
      const name = names[values[k]];
      if (name !== undefined) cell.share[name] += edges[k + 1] - edges[k];
      cell.count += 1;
      k += 1;
    } while (k < values.length && edges[k + 1] < edges[i] + step);
    cell.to = edges[k];
    for (const name of Object.values(names)) cell.share[name] /= cell.to - cell.from;
    // Rounding: a mode that has all of the time has exactly all of it.
    if (cell.count === 1 && names[values[i]] !== undefined) cell.share[names[values[i]]] = 1;
    cells.push(cell);
    i = k;
  }
  return cells;
};

/** Whether a column changes only at jumps, as discrete states do (one that never changes needs no steps). */
saltus.isDiscrete = (t, values) => {
  let changes = 0;
  for (let i = 1; i < values.length; i += 1) {
    if (values[i] === values[i - 1]) continue;
    if (t[i] !== t[i - 1]) return false;
    changes += 1;
  }
  return changes > 0;
};

/** Whether a column looks piecewise constant: far fewer changes than rows. */
saltus.isStepwise = (values) => {
  let changes = 0;
  for (let i = 1; i < values.length; i += 1) changes += values[i] !== values[i - 1] ? 1 : 0;
  return values.length > 8 && changes * 4 < values.length;
};

/** Intervals in which any switching function slides, merged: [[from, to], …]. */
saltus.slidingIntervals = (modes) => {
  const all = [];
  for (const {edges, values} of modes) {
    values.forEach((mode, i) => {
      if (mode === 0) all.push([edges[i], edges[i + 1]]);
    });
  }
  all.sort((a, b) => a[0] - b[0]);
  const merged = [];
  for (const [from, to] of all) {
    const last = merged[merged.length - 1];
    if (last !== undefined && from <= last[1])
      last[1] = Math.max(last[1], to);
    else
      merged.push([from, to]);
  }
  return merged;
};

/** Value of piecewise constant `values` at time x; at an edge the one to the right. */
saltus.valueAt = ({edges, values}, x) => {
  if (values.length === 0) return null;
  let i = saltus.lowerBound(edges, x);
  if (edges[i] !== x) i -= 1;
  return values[Math.min(Math.max(i, 0), values.length - 1)];
};
