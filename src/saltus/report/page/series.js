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

/**
 * Points of one curve; a jump (two values at one time) and a missing value are gaps. `jumps` has both sides of every
 * jump with a gap behind. A discrete curve has no gaps: its steps are the curve.
 */
saltus.points = (t, values, window, buckets, discrete = false) => {
  const leastJump = saltus.leastJump(values);
  const x = [];
  const y = [];
  const jumps = {x: [], y: []};
  let previous = -1;
  for (const i of saltus.rowsToDraw(t, [values], saltus.rowsInWindow(t, window), buckets)) {
    if (previous >= 0 && t[previous] === t[i] && Math.abs(values[previous] - values[i]) > leastJump && !discrete) {
      x.push(t[i]);
      y.push(null);
      jumps.x.push(t[i], t[i], null);
      jumps.y.push(values[previous], values[i], null);
    }
    x.push(t[i]);
    y.push(values[i]);
    previous = i;
  }
  return {x, y, jumps};
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
