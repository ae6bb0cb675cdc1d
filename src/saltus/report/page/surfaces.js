// Where switching functions are zero: lines and curves in a plane of two states, planes and sheets in a space of three.
"use strict";

/**
 * Part of a x + b y + c = 0 inside the box {x: [from, to], y: [from, to]}: its two ends, or null.
 * Computed in units of the box, so that states of very different size are treated alike.
 */
saltus.clipLine = ([a, b, c], box) => {
  const [w, h] = [box.x[1] - box.x[0], box.y[1] - box.y[0]];
  const [p, q, r] = [a * w, b * h, c + a * box.x[0] + b * box.y[0]];
  const square = p * p + q * q;
  if (!(square > 0)) return null;
  // Point of the line next to the origin of the box, and its direction.
  const [u, v, du, dv] = [(-p * r) / square, (-q * r) / square, -q, p];
  let [from, to] = [-Infinity, Infinity];
  for (const [start, step] of [[u, du], [v, dv]]) {
    if (step === 0) {
      if (start < 0 || start > 1) return null;
      continue;
    }
    const ends = [-start / step, (1 - start) / step].sort((s, t) => s - t);
    from = Math.max(from, ends[0]);
    to = Math.min(to, ends[1]);
  }
  if (!(from < to)) return null;
  const point = (s) => [box.x[0] + w * (u + s * du), box.y[0] + h * (v + s * dv)];
  return [point(from), point(to)];
};

/** What a surface is called in a legend. */
saltus.surfaceLabel = ({name, role}) => `${saltus.shorten(name, 22)}${{jump: " (jump)", region: ""}[role] ?? " = 0"}`;

/** The part of the segment between two points where all values a x + b y + … + c of `within` are >= 0, or null. */
saltus.clipSegment = ([p, q], within) => {
  let [from, to] = [0, 1];
  for (const coefficients of within) {
    const value = (point) => point.reduce((sum, x, i) => sum + coefficients[i] * x, coefficients.at(-1));
    const [v, w] = [value(p), value(q)];
    if (v < 0 && w < 0) return null;
    if (v < 0) from = Math.max(from, v / (v - w));
    if (w < 0) to = Math.min(to, v / (v - w));
  }
  if (!(from < to)) return null;
  return [from, to].map((s) => p.map((x, i) => x + s * (q[i] - x)));
};

/** The part of a convex polygon where all values a x + b y + c z + d of `within` are >= 0. */
saltus.clipPolygon = (polygon, within) => within.reduce((points, coefficients) => {
  const value = (point) => point.reduce((sum, x, i) => sum + coefficients[i] * x, coefficients.at(-1));
  return points.flatMap((p, n) => {
    const q = points[(n + 1) % points.length];
    const [v, w] = [value(p), value(q)];
    const crossing = (v < 0) === (w < 0) ? [] : [p.map((x, i) => x + (v / (v - w)) * (q[i] - x))];
    return v < 0 ? crossing : [p, ...crossing];
  });
}, polygon);

/** An affine form over `states` as one over those of `axes`, the others and the time put in from `at`. */
saltus.formOver = (form, states, axes, at) => {
  const coefficients = axes.map(() => 0);
  let constant = form.constant + form.rate * at.t;
  // The axis behind those of the columns is the time.
  const time = axes.indexOf(at.timeAxis);
  if (time >= 0) {
    coefficients[time] = form.rate;
    constant -= form.rate * at.t;
  }
  states.forEach((state, i) => {
    const axis = axes.indexOf(state);
    if (axis >= 0)
      coefficients[axis] = form.gradient[i];
    else
      constant += form.gradient[i] * at.x[state];
  });
  return {coefficients, constant};
};

/** An affine surface over `axes`; one that no axis changes asks for no state. */
saltus.affineOver = (surface, axes, at) => {
  const {gradient, rate} = surface.affine;
  const changes = surface.states.some((state, i) => gradient[i] !== 0 && axes.includes(state)) ||
                  (rate !== 0 && axes.includes(at.timeAxis));
  return changes ? saltus.formOver(surface.affine, surface.states, axes, at) :
                   {coefficients: axes.map(() => 0), constant: Number.NaN};
};

/** Where an affine surface ends: [a, b, …, c] over the states of `axes`. */
saltus.endsOver = (surface, axes, at) => (surface.within ?? []).map((form) => {
  const {coefficients, constant} = saltus.formOver(form, surface.states, axes, at);
  return [...coefficients, constant];
});

/** Whether the surface is the same whatever the time and the states outside of `axes` are. */
saltus.isExact = (surface, axes, timeAxis) => (!surface.depends_on_time || axes.includes(timeAxis)) &&
    surface.states.every((state) => axes.includes(state));

/**
 * What of a surface a plane shows: {kind, lines: [[a, b, c]], curves: [{x, y}], within} (lines end where one of
 * `within` is < 0). The kind is exact, cut (at the time
 * and the other states of `at`), or moving (at the recorded times within the window `between`). Null if it does not
 * belong into this plane: nothing of it would be a line here.
 */
saltus.surfaceInPlane = (surface, pair, at, between = [-Infinity, Infinity]) => {
  if (!surface.states.some((state) => pair.includes(state))) return null;
  if (surface.affine !== null) {
    const {coefficients, constant} = saltus.affineOver(surface, pair, at);
    if (coefficients[0] === 0 && coefficients[1] === 0) return null;
    const kind = saltus.isExact(surface, pair, at.timeAxis) ? "exact" : "cut";
    const within = saltus.endsOver(surface, pair, at);
    return {kind, lines: [[...coefficients, constant]], curves: [], ...(within.length > 0 ? {within} : {})};
  }
  const pieces = surface.curves.filter(({t}) => t === null || (t >= between[0] && t <= between[1]));
  if (!surface.states.every((state) => pair.includes(state)) || pieces.length === 0) return null;
  const kind = surface.depends_on_time ? "moving" : "exact";
  const [horizontal, vertical] = pair.map((state) => surface.states.indexOf(state));
  if (surface.states.length === 1) {
    const line = ({coordinates: [[value]]}) => (horizontal === 0 ? [1, 0, -value] : [0, 1, -value]);
    return {kind, lines: pieces.map(line), curves: []};
  }
  const curves = pieces.map(({coordinates}) => ({x: coordinates[horizontal], y: coordinates[vertical]}));
  return {kind, lines: [], curves};
};

/** The pieces of a surface in a box, as one path with gaps; a line of several `pieces` bends on logarithmic axes. */
saltus.surfacePath = (parts, box, pieces = 1) => {
  const path = {x: [], y: []};
  const add = (x, y) => {
    path.x.push(...x, null);
    path.y.push(...y, null);
  };
  for (const line of parts.lines) {
    const whole = saltus.clipLine(line, box);
    const ends = whole === null ? null : saltus.clipSegment(whole, parts.within ?? []);
    if (ends === null) continue;
    const [from, to] = ends;
    const inside = Array.from({length: pieces - 1}, (_, k) => (k + 1) / pieces);
    const along = (axis) => [from[axis], ...inside.map((s) => from[axis] + s * (to[axis] - from[axis])), to[axis]];
    add(along(0), along(1));
  }
  for (const {x, y} of parts.curves) add(x, y);
  return path;
};

/** Surfaces that a plane cannot show although they depend on one of its states: those of further states. */
saltus.surfacesNotDrawn = (result, pair) => result.surfaces.filter(
    (surface) => surface.affine === null && surface.states.some((state) => pair.includes(state)) &&
        !surface.states.every((state) => pair.includes(state)));

/** Intersection of g.x + c = 0 with a box: corners of the polygon in order, at most six; in units of the box. */
saltus.planeInBox = (g, c) => {
  const corner = (k) => [k & 1, (k >> 1) & 1, (k >> 2) & 1];
  const value = (p) => g[0] * p[0] + g[1] * p[1] + g[2] * p[2] + c;
  const points = [];
  for (let k = 0; k < 8; k += 1) {
    for (const bit of [1, 2, 4]) {
      if (k & bit) continue;
      const [p, q] = [corner(k), corner(k | bit)];
      const [v, w] = [value(p), value(q)];
      if ((v < 0) === (w < 0)) continue;
      const s = v / (v - w);
      points.push(p.map((coordinate, i) => coordinate + s * (q[i] - coordinate)));
    }
  }
  if (points.length < 3) return [];
  // By angle around their centre, in the two axes along which the plane extends most.
  const normal = [0, 1, 2].sort((i, k) => Math.abs(g[k]) - Math.abs(g[i]))[0];
  const [i, k] = [0, 1, 2].filter((axis) => axis !== normal);
  const centre = [i, k].map((axis) => points.reduce((sum, p) => sum + p[axis], 0) / points.length);
  const angle = (p) => Math.atan2(p[k] - centre[1], p[i] - centre[0]);
  return points.sort((p, q) => angle(p) - angle(q));
};

/** Triangles {x, y, z, i, j, k} of a surface in the box of three states, or null. */
saltus.surfaceInSpace = (surface, axes, at, box) => {
  const sheet = {points: [], triangles: []};
  const widths = box.map(([from, to]) => to - from);
  if (surface.affine !== null) {
    const {coefficients, constant} = saltus.affineOver(surface, axes, at);
    if (coefficients.every((value) => value === 0)) return null;
    const offset = coefficients.reduce((sum, value, axis) => sum + value * box[axis][0], constant);
    const corners = saltus.planeInBox(coefficients.map((value, axis) => value * widths[axis]), offset);
    const polygon = corners.map((p) => p.map((coordinate, axis) => box[axis][0] + coordinate * widths[axis]));
    sheet.points = saltus.clipPolygon(polygon, saltus.endsOver(surface, axes, at));
    for (let n = 2; n < sheet.points.length; n += 1) sheet.triangles.push([0, n - 1, n]);
  } else {
    if (!saltus.isExact(surface, axes)) return null;
    const places = surface.states.map((state) => axes.indexOf(state));
    const free = [0, 1, 2].filter((axis) => !places.includes(axis));
    for (const {coordinates: curve} of surface.curves) {
      const step = Math.max(1, Math.ceil(curve[0].length / 200));
      const count = curve[0].length;
      const chosen = Array.from({length: Math.ceil((count - 1) / step) + 1}, (_, n) => Math.min(n * step, count - 1));
      // A line of points is drawn out along the free axis; a single value along both of them.
      const at_ = (n, s, t) => [0, 1, 2].map((axis) => {
        if (places.includes(axis)) return curve[places.indexOf(axis)][n];
        return box[axis][axis === free[0] ? s : t];
      });
      const first = sheet.points.length;
      if (free.length === 2) {
        sheet.points.push(at_(0, 0, 0), at_(0, 1, 0), at_(0, 1, 1), at_(0, 0, 1));
        sheet.triangles.push([first, first + 1, first + 2], [first, first + 2, first + 3]);
        continue;
      }
      chosen.forEach((n, place) => {
        sheet.points.push(at_(n, 0, 0), at_(n, 1, 0));
        const k = first + 2 * place;
        if (place > 0) sheet.triangles.push([k - 2, k - 1, k], [k - 1, k, k + 1]);
      });
    }
  }
  if (sheet.triangles.length === 0) return null;
  const column = (rows, axis) => rows.map((row) => row[axis]);
  const [x, y, z] = [0, 1, 2].map((axis) => column(sheet.points, axis));
  const [i, j, k] = [0, 1, 2].map((place) => column(sheet.triangles, place));
  return {x, y, z, i, j, k};
};
