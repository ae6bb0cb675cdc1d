// Where the bodies of a mechanical system are: shapes of a row, between rows, the box around all of them, frames of a
// strobe.
"use strict";

/** Numbers that a shape has in a row: x and y of every point, and the radius of a disc. */
saltus.shapeNumbers = ({kind, points}) => 2 * points + (kind === "disc" ? 1 : 0);

/** The shapes of a list of numbers: {kind, points: [[x, y], …], radius}; those with a missing number are left out. */
saltus.placedShapes = (shapes, numbers) => {
  const placed = [];
  let at = 0;
  shapes.forEach((shape, index) => {
    const own = numbers.slice(at, at + saltus.shapeNumbers(shape));
    at += own.length;
    if (own.some((value) => value === null || value === undefined)) return;
    const points = Array.from({length: shape.points}, (_, k) => [own[2 * k], own[2 * k + 1]]);
    placed.push({index, kind: shape.kind, points, radius: shape.kind === "disc" ? own[2 * shape.points] : 0});
  });
  return placed;
};

/** Numbers of all shapes at a time, linearly between rows; where two rows have one time, after it. */
saltus.bodiesAt = ({t, drawing}, time) => {
  if (time >= t[t.length - 1]) return drawing.map((column) => column[t.length - 1]);
  const right = Math.max(1, saltus.upperBound(t, time));
  const share = Math.max(0, (time - t[right - 1]) / (t[right] - t[right - 1]));
  const between = (a, b) => (a === null || b === null ? null : a + share * (b - a));
  return drawing.map((column) => between(column[right - 1], column[right]));
};

/** Number of entries of an ascending list that are not above `value`. */
saltus.upperBound = (list, value) => {
  let [low, high] = [0, list.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (list[middle] <= value)
      low = middle + 1;
    else
      high = middle;
  }
  return low;
};

/** The box around all shapes of all rows: [[x from, to], [y from, to]], with a little room. */
saltus.bodiesBox = (shapes, {t, drawing}) => {
  const box = [[Infinity, -Infinity], [Infinity, -Infinity]];
  for (let row = 0; row < t.length; row += 1) {
    for (const {points, radius} of saltus.placedShapes(shapes, drawing.map((column) => column[row]))) {
      for (const point of points) {
        box.forEach((range, axis) => {
          range[0] = Math.min(range[0], point[axis] - radius);
          range[1] = Math.max(range[1], point[axis] + radius);
        });
      }
    }
  }
  if (!(box[0][0] <= box[0][1])) return [[0, 1], [0, 1]];
  const largest = Math.max(box[0][1] - box[0][0], box[1][1] - box[1][0]) || 1;
  return box.map(([from, to]) => [from - 0.04 * largest, to + 0.04 * largest]);
};

/** The scene must be so many times as wide as what moves before following it shows more. */
saltus.followFactor = 2;

/**
 * A box that goes with what moves: a function of the placed moving shapes. Null where all of the scene is little larger.
 */
saltus.followBox = (shapes, {t, drawing}, still, all) => {
  const boundsOf = (placed) => [0, 1].map((axis) => placed.reduce(
      ([least, most], {points, radius}) => points.reduce(
          ([a, b], point) => [Math.min(a, point[axis] - radius), Math.max(b, point[axis] + radius)], [least, most]),
      [Infinity, -Infinity]));
  const moving = (row) => saltus.placedShapes(shapes, drawing.map((column) => column[row]))
                              .filter(({index}) => !still[index]);
  const size = [0, 0];
  const step = Math.max(1, Math.floor(t.length / 200));
  for (let row = 0; row < t.length; row += step) {
    boundsOf(moving(row)).forEach(([least, most], axis) => (size[axis] = Math.max(size[axis], most - least)));
  }
  const side = 1.6 * Math.max(...size);
  const whole = all.map(([from, to]) => to - from);
  if (!(side > 0) || Math.max(...whole) < saltus.followFactor * side) return null;
  const wide = whole.map((length) => Math.min(length, Math.max(side, length / saltus.followFactor / 2)));
  return (placed) => {
    const bounds = boundsOf(placed);
    return all.map(([from, to], axis) => {
      const [least, most] = bounds[axis];
      const middle = least <= most ? (least + most) / 2 : (from + to) / 2;
      const start = Math.min(Math.max(middle - wide[axis] / 2, from), to - wide[axis]);
      return [start, start + wide[axis]];
    });
  };
};

/** Whether shape number `index` stands still. */
saltus.standsStill = (shapes, {drawing}, index) => {
  const first = shapes.slice(0, index).reduce((sum, shape) => sum + saltus.shapeNumbers(shape), 0);
  const own = drawing.slice(first, first + saltus.shapeNumbers(shapes[index]));
  return own.every((column) => column.every((value) => value === column[0]));
};

/** Frames of the strobe. */
saltus.strobeFrames = 14;
/** Times of equal distance from the first to the last one. */
saltus.strobeTimes = ({t}, count = saltus.strobeFrames) => {
  const [from, to] = [t[0], t[t.length - 1]];
  return to > from ? Array.from({length: count}, (_, i) => from + ((to - from) * i) / (count - 1)) : [from];
};

/** Largest width and height of the picture in pixels; the scale is that of both axes. */
saltus.bodiesPicture = (box, widest, tallest) => {
  const [width, height] = box.map(([from, to]) => to - from);
  const scale = Math.min(widest / width, tallest / height);
  return {
    scale,
    width: Math.max(1, scale * width),
    height: Math.max(1, scale * height),
    x: (value) => scale * (value - box[0][0]),
    y: (value) => scale * (box[1][1] - value),
  };
};

/** The mode of a contact in words, at a time. */
saltus.contactWord = (mode) => ({open: "open", closed: "closed", stick: "sticks", slip: "slips"})[mode] ?? "";
