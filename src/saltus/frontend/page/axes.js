// Axes of pictures of a sweep: numbers, words at 0, 1, 2, …, and cells around values.
"use strict";

/** Least and greatest of what is finite; null of nothing. */
saltus.finiteRange = (values) => {
  let [low, high] = [Infinity, -Infinity];
  for (const value of values) {
    if (value === null || !Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? [low, high] : null;
};

saltus.axisTicks = (low, high) => saltus.roundTicks([low, high], 5).map((tick) => [tick, saltus.sweepNumber(tick)]);

/** An axis of some values: `at(value)` is the place of one, `ticks` those between `low` and `high`. */
saltus.valueAxis = (values) => {
  const words = values.some((value) => typeof value === "string");
  const labels = words ? [...new Set(values)] : null;
  const at = words ? (value) => labels.indexOf(value) : (value) => value;
  let [low, high] = saltus.finiteRange(values.map(at)) ?? [0, 1];
  // Values that differ by rounding only are one value.
  if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) {
    const half = Math.max(0.5, 1e-3 * Math.abs(low));
    [low, high] = [low - half, high + half];
  } else {
    // Marks at the border are whole.
    const room = 0.02 * (high - low);
    [low, high] = [low - room, high + room];
  }
  const within = (from, to) => (words ? labels.map((label, k) => [k, label]).filter(([k]) => k >= from && k <= to) :
                                        saltus.axisTicks(from, to));
  return {at, low, high, words, ticks: within};
};

/** Cells around values: each reaches half-way to its neighbours. */
saltus.cellAxis = (values) => {
  const axis = saltus.valueAxis(values);
  const places = [...new Set(values.map(axis.at))].filter((place) => place !== null).sort((a, b) => a - b);
  const last = places.length - 1;
  const edges = places.slice(1).map((place, k) => (place + places[k]) / 2);
  edges.unshift(places[0] - ((edges[0] ?? places[0] + 0.5) - places[0]));
  edges.push(places[last] + (places[last] - edges[last]));
  const [low, high] = [edges[0], edges[last + 1]];
  const ticks = (from, to) => {
    if (axis.words) return axis.ticks(from, to);
    const seen = places.filter((place) => place >= from && place <= to);
    const apart = seen.slice(1).every((place, k) => place - seen[k] > (to - from) / 8);
    return apart && seen.length > 0 ? seen.map((place) => [place, saltus.sweepNumber(place)]) : saltus.axisTicks(from, to);
  };
  return {...axis, low, high, ticks, edgesOf: (value) => edges.slice(places.indexOf(axis.at(value))).slice(0, 2)};
};

/** A part of an axis. */
saltus.partOfAxis = (axis, range) => (range === undefined || range === null ? axis : {...axis, low: range[0], high: range[1]});
