// Thinning, gaps, intervals, groups and number formats of the report's page (src/saltus/report/page).
import assert from "node:assert/strict";
import fs from "node:fs";
import test from "node:test";
import vm from "node:vm";

const page = new URL("../../src/saltus/report/page/", import.meta.url);
const source =
    [
      "format.js", "numbers.js", "series.js", "panels.js", "kinds.js", "columns.js", "chooser.js", "marks.js", "figure.js", "events.js", "surfaces.js", "phase.js",
      "branches.js", "intersection.js", "multipliers.js", "sensitivities.js", "cards.js", "optimization.js", "overlays.js", "source.js", "ticks.js", "bodies/bodies.js", "bodies/player.js", "bodies/gif.js", "bodies/animation.js"
    ].map((file) => fs.readFileSync(new URL(file, page), "utf8"))
        .join("\n");
const saltus = vm.runInThisContext(`(() => {${source}\nreturn saltus; })()`);

test("every script of the page is one that a browser reads", () => {
  for (const file of fs.readdirSync(page, {recursive: true}).filter((name) => name.endsWith(".js"))) {
    assert.doesNotThrow(() => new vm.Script(fs.readFileSync(new URL(file, page), "utf8")), file);
  }
});

test("every name has one meaning", () => {
  const names = fs.readdirSync(page, {recursive: true}).filter((name) => name.endsWith(".js")).flatMap(
      (file) => [...fs.readFileSync(new URL(file, page), "utf8").matchAll(/^saltus\.(\w+) = /gm)].map((match) => match[1]));
  assert.deepEqual(names.filter((name, i) => names.indexOf(name) !== i), []);
});

test("rows of a window reach over both of its ends and take both rows of an event there", () => {
  const t = [0, 1, 2, 2, 3, 4];
  assert.deepEqual(saltus.rowsInWindow(t, [1.5, 2]), [1, 5]);
  assert.deepEqual(saltus.rowsInWindow(t, [0, 4]), [0, 6]);
  assert.deepEqual(saltus.rowsInWindow([], [0, 1]), [0, 0]);
});

test("thinning keeps extremes, missing values, ends and both rows of events", () => {
  const t = Array.from({length: 100000}, (_, i) => i);
  t[50001] = t[50000];
  const values = t.map((time) => Math.sin(time / 5000));
  values[777] = 9;
  values[88888] = -9;
  values[4242] = null;
  const rows = saltus.rowsToDraw(t, [values], [0, t.length], 500);
  assert.ok(rows.length <= 4 * 500 + 3, String(rows.length));
  for (const row of [0, 777, 4242, 50000, 50001, 88888, 99999]) assert.ok(rows.includes(row), String(row));
  assert.deepEqual(rows, [...new Set(rows)].sort((a, b) => a - b));
});

test("short curves are drawn whole", () => {
  assert.deepEqual(saltus.rowsToDraw([0, 1, 2], [[5, 6, 7]], [0, 3], 10), [0, 1, 2]);
});

test("a jump is a gap with its two sides, a continuous event and a rounding are none", () => {
  const t = [0, 1, 1, 2, 2, 3, 3, 4];
  const values = [0, 1, 5, 6, 6, 7, 7 + 1e-12, 8];
  const {x, y, jumps} = saltus.points(t, values, [0, 4], 100);
  assert.deepEqual(x, [0, 1, 1, 1, 2, 2, 3, 3, 4]);
  assert.deepEqual(y, [0, 1, null, 5, 6, 6, 7, 7 + 1e-12, 8]);
  assert.deepEqual(jumps, {x: [1, 1, null], y: [1, 5, null]});
});

test("a missing side of an event is a gap without a jump, and a value between two gaps is seen", () => {
  const t = [0, 1, 1, 2, 3, 3, 4];
  const {x, y, jumps} = saltus.points(t, [5, null, null, 7, null, 8, 8], [0, 4], 4);
  assert.deepEqual(jumps.x, []);
  assert.deepEqual(y, [5, 5, null, null, 7, 7, null, 8, 8]);
  assert.deepEqual(x, [-0.5, 0.5, 1, 1, 1.5, 2.5, 3, 3, 4]);
});

test("a discrete state is drawn as steps without gaps", () => {
  const t = [0, 1, 1, 2, 2, 3];
  const steps = [0, 0, 1, 1, 2, 2];
  assert.ok(saltus.isDiscrete(t, steps));
  assert.ok(!saltus.isDiscrete(t, [0, 0.5, 1, 1, 2, 2]));
  assert.ok(!saltus.isDiscrete(t, [1, 1, 1, 1, 1, 1]));
  const {y, jumps} = saltus.points(t, steps, [0, 3], 100, true);
  assert.deepEqual(y, steps);
  assert.deepEqual(jumps.x, []);
});

test("sliding intervals of several switching functions are merged", () => {
  const modes = [{edges: [0, 1, 2, 5], values: [-1, 0, 1]}, {edges: [0, 1.5, 3, 4, 5], values: [1, 0, 1, 0]}];
  assert.deepEqual(saltus.slidingIntervals(modes), [[1, 3], [4, 5]]);
});

test("the mode at an edge is the one behind it", () => {
  const mode = {edges: [0, 1, 2], values: [-1, 0]};
  assert.deepEqual([-1, 0, 0.5, 1, 1.5, 2, 3].map((t) => saltus.valueAt(mode, t)), [-1, -1, -1, 0, 0, 0, 0]);
  assert.equal(saltus.valueAt({edges: [], values: []}, 1), null);
});

test("modes by indicator have bands and weights of their own, behind the switching functions", () => {
  const bands = [{edges: [0, 1, 2], values: [1, 0]}, {edges: [0, 1, 2], values: [null, 0]}];
  const result = {
    states: ["x"],
    controls: [],
    output_names: [],
    switching_functions: [],
    regions: ["a", "b"],
    trajectory: {
      t: [0, 1, 1, 2],
      x: [[1, 0, 0, 0]],
      u: [],
      outputs: [],
      alpha: [],
      modes: [],
      theta: [[1, 1, 0.5, 0.5], [0, 0, 0.5, 0.5]],
      regions: bands
    },
  };
  assert.deepEqual(saltus.slidingIntervals(saltus.bandIntervals(result)), [[1, 2]]);
  const {panels} = saltus.stackPanels(result, 600);
  assert.deepEqual(panels.map((panel) => panel.sort ?? panel.kind), ["events", "modes", "state", "theta"]);
  assert.deepEqual(panels[3].curves.map((curve) => curve.name), ["a", "b"]);
});

test("of several groups an event tells those that change", () => {
  const event = {regions_before: [["a"], ["c", "d"]], regions_after: [["a", "b"], ["c", "d"]]};
  assert.equal(saltus.regionChange(event), "a → a + b");
  assert.equal(saltus.regionChange({...event, regions_before: null}), "a + b; c + d");
  assert.equal(saltus.regionChange({...event, regions_before: event.regions_after}), "same");
});

test("many curves share panels if their scales go together", () => {
  const curve = (size) => ({values: [0, size]});
  const sizes = (groups) => groups.map((group) => group.length);
  assert.deepEqual(sizes(saltus.groupCurves([1, 1, 1].map(curve))), [1, 1, 1]);
  assert.deepEqual(sizes(saltus.groupCurves([1, 1, 1, 1, 1, 100, 100, 120].map(curve))), [4, 1, 3]);
});

test("too many events in one view become one per bin, the uncertain ones stay", () => {
  const events = Array.from({length: 5000}, (_, i) => ({t: i, unique: i !== 1234}));
  const marks = saltus.visibleMarks({events}, events.map((_, i) => i), [0, 5000]);
  assert.ok(marks.length <= saltus.maximumMarks);
  assert.ok(marks.includes(1234));
  assert.deepEqual(saltus.visibleMarks({events}, [10, 20, 30], [15, 25]), [20]);
});

test("the phase plane is cut at jumps and where sliding begins", () => {
  const result = {trajectory: {t: [0, 1, 1, 2, 2, 3]}};
  const x = [0, 1, 1, 2, 7, 8];
  const parts = saltus.phaseParts(result, [x, x], [0, 1, 2, 3, 4, 5], [[1, 2]]);
  assert.deepEqual(parts.free[0], [0, 1, null, 7, 8]);
  assert.deepEqual(parts.sliding[1], [1, 2, null]);
  assert.deepEqual(parts.jumps[0], [2, 7, null]);
});

test("numbers keep all digits", () => {
  for (const value of [0.1 + 0.2, 1e-300, -2.5e-5, 123456789.123, 0]) assert.equal(Number(saltus.exact(value)), value);
  assert.equal(saltus.exact(null), "not a number");
  assert.equal(saltus.selection(null), "not determined");
  assert.equal(saltus.selection(0.25), "0.25");
  assert.equal(saltus.timeColumn([0, 39.123456789012345])(0.24468880178), "0.2446888018");
});

const affine = (states, gradient, constant, rate = 0) => ({
  name: "psi",
  role: "switching",
  states,
  depends_on_time: rate !== 0,
  affine: {gradient, rate, constant},
  curves: [],
});
const curved = (states, curves, depends_on_time = false) => ({
  name: "psi",
  role: "switching",
  states,
  depends_on_time,
  affine: null,
  curves: curves.map((coordinates, i) => ({t: depends_on_time ? i : null, coordinates})),
});
const box = {
  x: [-1, 3],
  y: [0, 100]
};
const near = (actual, expected) => actual.flat(2).forEach((value, i) => {
  assert.ok(Math.abs(value - expected.flat(2)[i]) < 1e-9, `${actual} is not ${expected}`);
});

test("a line is cut by the box in which it is drawn", () => {
  near(saltus.clipLine([1, 0, -2], box).sort(), [[2, 0], [2, 100]]);
  near(saltus.clipLine([0, 1e-8, -5e-7], box).sort((p, q) => p[0] - q[0]), [[-1, 50], [3, 50]]);
  near(saltus.clipLine([25, -1, 25], box).sort((p, q) => p[0] - q[0]), [[-1, 0], [3, 100]]);
  assert.equal(saltus.clipLine([1, 0, -4], box), null);
  assert.equal(saltus.clipLine([0, 0, 1], box), null);
});

test("a surface of the pair is exact in the plane, one that depends on more is a cut at given values", () => {
  const at = {t: 2, x: [10, 20, 30]};
  const own = saltus.surfaceInPlane(affine([1], [1], -0.2), [0, 1], at);
  assert.deepEqual(own, {kind: "exact", lines: [[0, 1, -0.2]], curves: []});
  const swapped = saltus.surfaceInPlane(affine([0, 1], [3, 4], 5), [1, 0], at);
  assert.deepEqual(swapped, {kind: "exact", lines: [[4, 3, 5]], curves: []});
  const cut = saltus.surfaceInPlane(affine([0, 2], [3, 4], 5, 7), [0, 1], at);
  assert.deepEqual(cut, {kind: "cut", lines: [[3, 0, 5 + 7 * 2 + 4 * 30]], curves: []});
  assert.equal(saltus.surfaceInPlane(affine([2], [1], 0), [0, 1], at), null);
});

test("curves are turned with the axes, and absent where they would not be curves", () => {
  const at = {t: 0, x: [0, 0, 0]};
  const surface = curved([0, 2], [[[1, 2], [3, 4]]]);
  assert.deepEqual(saltus.surfaceInPlane(surface, [0, 2], at).curves, [{x: [1, 2], y: [3, 4]}]);
  assert.deepEqual(saltus.surfaceInPlane(surface, [2, 0], at).curves, [{x: [3, 4], y: [1, 2]}]);
  assert.equal(saltus.surfaceInPlane(surface, [0, 1], at), null);
  assert.deepEqual(saltus.surfaceInPlane(curved([1], [[[5]]]), [0, 1], at).lines, [[0, 1, -5]]);
  assert.equal(saltus.surfaceInPlane(curved([0], [], true), [0, 1], at), null);
  const surfaces = [surface, affine([0, 2], [1, 1], 0), curved([0], [[[1]]], true)];
  assert.deepEqual(saltus.surfacesNotDrawn({surfaces}, [0, 1]), [surfaces[0]]);
});

test("a surface that moves is drawn at its times within the window", () => {
  const surface = curved([0, 1], [[[0], [0]], [[1], [1]], [[2], [2]]], true);
  const parts = saltus.surfaceInPlane(surface, [0, 1], {t: 0, x: [0, 0]}, [0.5, 2]);
  assert.deepEqual(parts, {kind: "moving", lines: [], curves: [{x: [1], y: [1]}, {x: [2], y: [2]}]});
  assert.equal(saltus.surfaceInPlane(surface, [0, 1], {t: 0, x: [0, 0]}, [3, 4]), null);
  assert.match(saltus.surfaceNote({moving: [surface]}, {t: 0}), /drawn at t = 0, 1, 2: psi/);
});

test("of two hundred surfaces some are drawn, those with events first, and the others counted", () => {
  const drawn = Array.from({length: 200}, (_, i) => ({surface: {name: `s${i}`}}));
  const result = {events: [{t: 1, surfaces: ["s150"]}, {t: 2, surfaces: ["s7", "s199"]}, {t: 3, surfaces: ["s8"]}]};
  const view = {events: [0], window: [0, 2]};  // the mark of the second one is hidden
  const some = saltus.surfacesToDraw(result, view, drawn).map(({surface}) => surface.name);
  assert.equal(some.length, saltus.mostSurfaces);
  assert.deepEqual(some.slice(0, 4), ["s7", "s150", "s199", "s0"]);
  assert.equal(saltus.surfacesToDraw(result, view, drawn.slice(0, 9)).length, 9);
  assert.match(saltus.surfaceNote({leftOut: 160}, {t: 0}), /^160 more surfaces not drawn/);
});

test("drawings begin with the states of the first surface", () => {
  const moving = [0, 1, 2, 1.5, 0.5], stepping = [1, 1, 1, 2, 2];
  const choice = (surfaces, size, x = [moving, moving, moving, moving, moving]) =>
      saltus.firstChoice({states: x.map((_, i) => `x${i}`), surfaces, trajectory: {t: [0, 1, 2, 2, 3], x}}, size);
  assert.deepEqual(choice([], 2), [0, 1]);
  assert.deepEqual(choice([affine([3], [1], 0)], 2), [0, 3]);
  assert.deepEqual(choice([affine([1, 2, 4], [1, 1, 1], 0)], 2), [1, 2]);
  assert.deepEqual(choice([affine([3], [1], 0)], 3), [0, 1, 3]);
  // What only jumps comes last, and so do the conditions on it.
  const phase = affine([0], [1], -1), line = affine([1, 2], [1, 1], 0);
  assert.deepEqual(choice([phase, line], 2, [stepping, moving, moving]), [1, 2]);
  assert.deepEqual(choice([phase], 2, [stepping, moving]), [0, 1]);
});

test("a plane cuts a cube in a triangle to a hexagon", () => {
  const corners = (g, c) => saltus.planeInBox(g, c).length;
  assert.equal(corners([1, 0, 0], -0.5), 4);
  assert.equal(corners([1, 1, 1], -0.5), 3);
  assert.equal(corners([1, 1, 1], -1.5), 6);
  assert.equal(corners([1, 1, 1], 1), 0);
  for (const p of saltus.planeInBox([1, 2, -1], -0.7)) assert.ok(Math.abs(p[0] + 2 * p[1] - p[2] - 0.7) < 1e-12);
});

test("in space a curve is drawn out along the state it does not depend on", () => {
  const cube = [[0, 1], [0, 1], [-2, 2]];
  const sheet = saltus.surfaceInSpace(curved([0, 1], [[[0, 0.5, 1], [1, 0.5, 0]]]), [0, 1, 2], {t: 0, x: []}, cube);
  assert.deepEqual(sheet.x, [0, 0, 0.5, 0.5, 1, 1]);
  assert.deepEqual(sheet.z, [-2, 2, -2, 2, -2, 2]);
  assert.equal(sheet.i.length, 4);
  const plane = saltus.surfaceInSpace(affine([2], [2], -2), [0, 1, 2], {t: 0, x: []}, cube);
  assert.deepEqual([...new Set(plane.z)], [1]);
  assert.equal(saltus.surfaceInSpace(curved([0, 3], [[[0], [0]]]), [0, 1, 2], {t: 0, x: []}, cube), null);
});

test("the search finds numbers, kinds, names, surfaces and reasons, all words together", () => {
  const event = (kind, name, surfaces, reason) => ({kind, name, surfaces, reason});
  const events = [
    event("enter_sliding", null, ["slip"], "both fields point to the surface"),
    event("jump", "Impact", ["Impact"], "height fell below 0"),
    ...Array.from({length: 10}, () => event("crossing", null, ["x-y"], "")),
  ];
  assert.deepEqual(saltus.matchingEvents(events, ""), events.map((_, i) => i));
  assert.deepEqual(saltus.matchingEvents(events, "impact"), [1]);
  assert.deepEqual(saltus.matchingEvents(events, "SLIDING surface"), [0]);
  assert.deepEqual(saltus.matchingEvents(events, "#1"), [0]);
  assert.deepEqual(saltus.matchingEvents(events, "crossing #12"), [11]);
  assert.deepEqual(saltus.matchingEvents(events, "slip crossing"), []);
});

test("a jump of a hysteresis says what it turned to", () => {
  const event = {kind: "jump", name: "heats", turned: "on", surfaces: ["heats"], reason: ""};
  assert.equal(saltus.eventPlace(event), "heats on");
  assert.equal(saltus.eventPlace({...event, turned: null}), "heats");
  assert.equal(saltus.eventPlace({...event, name: null, turned: null, surfaces: ["a", "b"]}), "a, b");
  assert.deepEqual(saltus.matchingEvents([event, {...event, turned: "off"}], "heats on"), [0]);
});

const meetingOf = (velocities, before = [0, 0]) =>
    ({surfaces: ["a", "b"], velocities, alpha_before: before, alpha_after: [0.5, 0.5]});

test("where a normal component is zero is a line or both branches of a hyperbola inside the square", () => {
  for (const [a] of [saltus.zeroCurve([1, -1, 1, -1])[0]]) {
    assert.ok(a.length > 100);
    for (const value of a) assert.ok(Math.abs(value - 0.5) < 1e-12, String(value));
  }
  // (a - 1/2)(b - 1/2) = 1/16 has a branch on either side of its pole.
  const velocity = (a, b) => (a - 0.5) * (b - 0.5) - 1 / 16;
  const corners = [[0, 0], [1, 0], [0, 1], [1, 1]].map(([a, b]) => velocity(a, b));
  const pieces = saltus.zeroCurve(corners);
  const sides = new Set();
  for (const [a, b] of pieces) {
    a.forEach((value, k) => assert.ok(Math.abs(velocity(value, b[k])) < 1e-12));
    assert.equal(new Set(a.map((value) => value > 0.5)).size, 1);
    sides.add(a[0] > 0.5);
  }
  assert.equal(sides.size, 2);
  assert.deepEqual(saltus.zeroCurve([1, 1, 1, 1]), []);
});

test("hidden dynamics rests at a stable root, leaves the square, or turns", () => {
  const end = ([x, y]) => [x.at(-1), y.at(-1)];
  const rest = end(saltus.hiddenPath(meetingOf([[3, -1, 3, -1], [1, 1, -4, -4]]), [0, 0]));
  assert.ok(Math.hypot(rest[0] - 0.75, rest[1] - 0.2) < 5e-3, String(rest));
  // The weights change the way, not where it rests.
  const slow = end(saltus.hiddenPath(meetingOf([[3, -1, 3, -1], [1, 1, -4, -4]]), [0, 0], [1, 0.1]));
  assert.ok(Math.hypot(slow[0] - 0.75, slow[1] - 0.2) < 5e-3, String(slow));
  const [, up] = end(saltus.hiddenPath(meetingOf([[3, -1, 3, -1], [1, 1, 1, 1]]), [0.75, 0]));
  assert.ok(up > 1.25 && up < 1.26, String(up));
  // g1 = 1 - 2 b, g2 = 2 a - 1 turns around the middle.
  const turning = meetingOf([[1, 1, -1, -1], [-1, 1, -1, 1]]);
  const [x, y] = saltus.hiddenPath(turning, [0.75, 0.5]);
  x.forEach((value, k) => assert.ok(Math.abs(Math.hypot(value - 0.5, y[k] - 0.5) - 0.25) < 1e-6));
});

test("where nothing comes before, hidden dynamics starts from the corners", () => {
  assert.equal(saltus.hiddenStarts(meetingOf([[0, 0, 0, 0], [0, 0, 0, 0]], null)).length, 4);
  assert.deepEqual(saltus.hiddenStarts(meetingOf([[0, 0, 0, 0], [0, 0, 0, 0]], [0.25, 1])), [[0.25, 1]]);
});

test("of a surface that was slid on there is a path which it dominates, as in a case where that decides", () => {
  // Sliding on the first surface from below the second one: stays with a dominant first surface, else leaves (E10).
  const meeting = meetingOf([[0.5223, -1.7734, -0.194, 1.011], [0.609, -0.9416, 0.3146, 0.115]], [0.2275123056, 0]);
  const [equal, dominated] = saltus.hiddenWeights(meeting).map(
      ({weights}) => saltus.hiddenPath(meeting, meeting.alpha_before, weights).map((column) => column.at(-1)));
  assert.ok(Math.max(...equal) > 1.25, String(equal));
  assert.ok(Math.hypot(dominated[0] - 0.596326917, dominated[1] - 0.617451608) < 5e-3, String(dominated));
  assert.equal(saltus.hiddenWeights(meetingOf(meeting.velocities, [0, 1])).length, 1);
});

test("the hidden dynamics of a start ends in one of the modes, exactly on either side of a separatrix", () => {
  // Leaf C9-4 (the model part-ways) in lambda = 2 alpha - 1: (l2 + l1 l2/2, -l1/2 + l2 + l1 l2/5).
  const g = (k, l) => [l + (k * l) / 2, -k / 2 + l + (k * l) / 5];
  const corners = [[-1, -1], [1, -1], [-1, 1], [1, 1]];
  const meeting = meetingOf([0, 1].map((j) => corners.map(([k, l]) => g(k, l)[j])), [0.5, 0.5]);
  const {axis, modes, parts} = saltus.basins(meeting, 40);
  assert.deepEqual(modes.map(String).sort(), ["-1,-1", "1,1"]);
  // The borders are the two solutions that slide along x2 = 0 away from the square: through (0, 3/16) and (1, 17/24);
  // backwards in time they wind around the root.
  const size = [0, 1].map((j) => Math.max(...corners.map(([k, l]) => Math.abs(g(k, l)[j]))));
  const slope = (u) => g(2 * u[0] - 1, 2 * u[1] - 1).map((value, j) => -value / size[j]);
  for (const [start, below] of [[[0, 3 / 16], "-1,-1"], [[1, 17 / 24], "-1,-1"]]) {
    let u = start;
    for (let n = 0; n < 1500; n += 1) {
      if (n % 150 === 100) {
        // Across the border, to the side that is below it at its end.
        const [v, w] = slope(u).map((value) => value / Math.hypot(...slope(u)));
        const sign = start[0] === 0 ? 1 : -1;
        // Its arms get closer in proportion.
        const step = 0.01 * sign * Math.hypot(u[0] - 0.5, u[1] - 0.5);
        const near = (s) => saltus.hiddenOutcome(meeting, [u[0] + s * w, u[1] - s * v]);
        assert.equal(String(near(step)), below, `${u}`);
        assert.equal(String(near(-step)), "1,1", `${u}`);
      }
      const k1 = slope(u);
      const k2 = slope(u.map((value, j) => value + 0.005 * k1[j]));
      u = u.map((value, j) => value + 0.01 * k2[j]);
    }
  }
  // Both sizes: every point belongs to one of them, and the root to neither.
  const share = parts.flat().filter((part) => String(modes[part]) === "1,1").length / parts.flat().length;
  assert.ok(share > 0.3 && share < 0.7, String(share));
  assert.equal(axis.length, 40);
  assert.equal(String(saltus.hiddenOutcome(meeting, [0.5, 0.5])), "0,0");
});

test("outcomes along an edge and at a stable root are told", () => {
  assert.deepEqual(saltus.hiddenOutcome(meetingOf([[3, -1, 3, -1], [1, 1, -4, -4]]), [0, 0]), [0, 0]);
  assert.deepEqual(saltus.hiddenOutcome(meetingOf([[3, -1, 3, -1], [1, 1, 1, 1]]), [0.2, 0]), [0, 1]);
  assert.equal(saltus.basins(meetingOf([[3, -1, 3, -1], [1, 1, 1, 1]]), 10), null);
});

test("the border of two regions ends where a third one is nearer", () => {
  // Distances from (-1, 0), (1, 0), (0, 2): x = 0 below the centre of the circle around them, (0, 3/4).
  const border = {
    ...affine([0, 1], [4, 0], 0),
    role: "region",
    name: "left | right",
    within: [{gradient: [2, -4], rate: 0, constant: 3}]
  };
  const parts = saltus.surfaceInPlane(border, [0, 1], {t: 0, x: [0, 0]});
  const path = saltus.surfacePath(parts, {x: [-2, 2], y: [-2, 2]});
  near(path.y.slice(0, 2).sort((p, q) => p - q), [-2, 0.75]);
  near(path.x.slice(0, 2), [0, 0]);
  assert.equal(saltus.surfaceLabel(border), "left | right");
  assert.deepEqual(saltus.surfacePath(parts, {x: [-2, 2], y: [1, 2]}).x, []);
  const sheet = saltus.surfaceInSpace(border, [0, 1, 2], {t: 0, x: [0, 0, 0]}, [[-2, 2], [-2, 2], [0, 1]]);
  assert.ok(Math.abs(Math.max(...sheet.y) - 0.75) < 1e-12 && Math.min(...sheet.y) === -2);
});

test("branches are one path with a gap behind each, without those outside the window", () => {
  const branch = (t, x) => ({trajectory: {t, x: [x]}});
  const branches = [branch([1, 2, 3], [5, 6, 7]), branch([8, 9], [0, 1]), branch([2, 4], [8, 9])];
  const path = saltus.branchPath(branches, ({trajectory}) => [trajectory.t, trajectory.x[0]], [0, 5], 100);
  assert.deepEqual(path, [[1, 2, 3, null, 2, 4, null], [5, 6, 7, null, 8, 9, null]]);
  assert.deepEqual(saltus.branchPath([], () => [], [0, 5], 100), []);
});

/** Two elements of two stages: sliding ends at t = 1, where alpha jumps and lambda does not. */
const elements = {
  points: 4,
  t: [0, 0.25, 1, 1, 1, 1.5, 3, 3],
  selections: [{name: "a", form: "step"}],
  lambda: [[0, 0, 0, 0, 0, 0.5, 2, 2]],
  selection: [[0.5, 0.6, 0.9, 0.9, 1, 1, 1, 1]],
};

test("elements of a window are those that it touches", () => {
  assert.deepEqual(saltus.elementsInWindow(elements, [0, 3]), [0, 2]);
  assert.deepEqual(saltus.elementsInWindow(elements, [1.2, 2]), [1, 2]);
  assert.deepEqual(saltus.elementsInWindow(elements, [0.1, 0.2]), [0, 1]);
});

test("a selection jumps between elements, a multiplier is continuous", () => {
  const alpha = saltus.elementCurve(elements, elements.selection[0], [0, 2]);
  assert.deepEqual(alpha.jumps, {x: [1, 1, null], y: [0.9, 1, null]});
  assert.deepEqual(alpha.y.filter((value) => value === null).length, 1);
  const lambda = saltus.elementCurve(elements, elements.lambda[0], [0, 2]);
  assert.deepEqual(lambda.jumps.x, []);
  assert.deepEqual(lambda.x, elements.t);
});

test("psi is the difference of the two multipliers of a step function", () => {
  const psi = {...elements, lambda: [[-1, -0.5, 0, 0, 0, 0.5, 2, 2]]};
  const {multipliers: [p, n], fraction} = saltus.multiplierCurves(psi, 0);
  assert.deepEqual(p.values, [0, 0, 0, 0, 0, 0.5, 2, 2]);
  assert.deepEqual(n.values.map(Math.abs), [1, 0.5, 0, 0, 0, 0, 0, 0]);
  assert.equal(fraction.name, "α(a)");
  const stewart = saltus.multiplierCurves({...elements, selections: [{name: "a > 0", form: "stewart"}]}, 0);
  assert.equal(stewart.multipliers.length, 1);
  assert.equal(stewart.fraction.name, "θ(a > 0)");
});

test("stages and lengths of elements", () => {
  assert.deepEqual(saltus.stagePoints(elements, elements.selection[0], [1, 2]), {x: [1.5, 3], y: [1, 1]});
  assert.deepEqual(saltus.lengthSteps(elements, [0, 2]), {x: [0, 1, 1, 3], y: [1, 1, 2, 2]});
});

test("the selection that slides is shown first", () => {
  assert.equal(saltus.firstSelection({selection: [[0, 0], [0, 1], [0, 0.5]]}), 2);
  assert.equal(saltus.firstSelection({selection: [[0, 0], [0, 1]]}), 1);
  assert.equal(saltus.firstSelection({selection: [[0, 0]]}), 0);
});

test("entries of a matrix are shaded by logarithm", () => {
  assert.equal(saltus.heat(-100, 100), 1);
  assert.equal(saltus.heat(1, 100), 0.5);
  assert.equal(saltus.heat(1e-9, 100), 0);
  assert.equal(saltus.heat(0, 100), 0);
  assert.equal(saltus.heat(null, 100), 0);
  assert.equal(saltus.heat(0, 0), 0);
});

test("options of other methods are told from those of the one that ran", () => {
  for (const name of ["simulate.rtol", "simulate.event.integrator", "simulate.initial_mode.fesd.x"])
    assert.ok(!saltus.isOfOtherMethod(name, "event"), name);
  for (const name of ["simulate.event.integrator", "simulate.timestepping.steps", "simulate.smoothed.epsilon"])
    assert.ok(saltus.isOfOtherMethod(name, "fesd"), name);
});

/** A result with states that rest, move and jump, an output and a switching function. */
const mixed = () => {
  const t = [0, 1, 2, 2, 3];
  const x = [[1, 1, 1, 1, 1], [0, 0, 0, 1, 1], [0, 1, 2, 2, 3]];
  return {
    states: ["rest", "count", "move"],
    output_names: ["power"],
    controls: [],
    switching_functions: ["s"],
    regions: [],
    surfaces: [],
    branches: [],
    events: [{t: 2, kind: "jump", x: [1, 0, 2], x_after: [1, 1, 2], unique: true}],
    trajectory: {
      t,
      x,
      u: [],
      outputs: [[5, 6, 7, 7, 8]],
      alpha: [[0, 0, 0, 1, 1]],
      theta: [],
      modes: [{edges: [0, 2, 3], values: [-1, 1]}],
      regions: [],
    },
  };
};

test("at first what moves is drawn, discrete states last, and what rests waits", () => {
  const result = mixed();
  const names = saltus.stackPanels(result, 600).panels.filter(({kind}) => kind === "curves")
                    .map(({curves}) => curves.map(({name}) => name));
  assert.deepEqual(names, [["move"], ["power"], ["s"], ["count"]]);
  assert.deepEqual(saltus.firstChoice(result, 2), [0, 2]);
  assert.deepEqual(saltus.axes(result).map(saltus.columnLabel), ["rest", "count", "move", "power", "α(s)", "t"]);
});

test("of very many selections those that change are drawn, the last one too", () => {
  const result = mixed();
  result.switching_functions = Array.from({length: 60}, (_, i) => `s${i}`);
  result.trajectory.alpha = result.switching_functions.map((_, i) => (i < 50 ? [0, 0, 0, 0, 0] : [0, 0, 0, 1, 1]));
  const {panels} = saltus.firstPanels(result);
  const drawn = panels.flatMap(({curves}) => curves).map((i) => saltus.columns(result)[i])
                    .filter(({sort}) => sort === "alpha").map(({name}) => name);
  assert.deepEqual(drawn, result.switching_functions.slice(50));
});

test("what moves by a rounding of its neighbours only is not drawn at first", () => {
  const result = mixed();
  result.trajectory.x[0] = [0, 2e-17, -1e-17, 0, 1e-17];
  const first = saltus.firstPanels(result).panels.flatMap(({curves}) => curves);
  assert.ok(!first.includes(0) && first.includes(2), `${first}`);
  const small = mixed();  // beside nothing larger it moves
  small.trajectory.x = [[0, 2e-17, -1e-17, 0, 1e-17], [0, 0, 0, 0, 0], [0, 0, 0, 0, 0]];
  assert.ok(saltus.firstPanels(small).panels.flatMap(({curves}) => curves).includes(0));
});

test("an impulse is a stem and no slope to the next row", () => {
  const result = {...mixed(), output_names: ["impulse(floor)"], contacts: ["floor"]};
  result.trajectory.outputs = [[0, 0, 0, 3, 0]];
  const stack = saltus.stackPanels(result, 600);
  const panel = stack.panels.find(({curves}) => curves?.[0].name === "impulse(floor)");
  const view = {window: [0, 3], pixels: 600, palette: {curves: ["black", "red"]}, overlays: []};
  const [line] = saltus.curveTraces({...result, overlays: []}, panel, "y2", view).filter(({mode}) => mode === "lines");
  assert.deepEqual([line.x, line.y], [[0, 2, 2, 2, 3], [0, 0, 3, 0, 0]]);
});

test("jumps of a result that lies over another are not joined, over time and in a plane", () => {
  const result = mixed();
  const [rest, count] = result.trajectory.x;
  result.overlays = [{label: "b.json", trajectory: {...result.trajectory, x: [rest, count, [0, 1, 2, 7, 8]]}}];
  const palette = {simulated: "#aa0000"};
  const view = {window: [0, 3], pixels: 600, palette};
  const [line, jumps] = saltus.overlayCurves(result, saltus.columns(result)[2], "y", view);
  assert.deepEqual([line.meta, line.y], ["overlay", [0, 1, 2, null, 7, 8]]);
  assert.deepEqual([jumps.line.dash, jumps.y], ["dot", [2, 7, null]]);
  const time = saltus.axes(result).length - 1;
  const [free, dotted] = saltus.overlayOrbits(result, [2, time], view, palette, "scatter");
  assert.deepEqual([free.x, free.y], [[0, 1, 2, null, 7, 8], [0, 1, 2, null, 2, 3]]);
  assert.deepEqual([dotted.line.dash, dotted.x, dotted.showlegend], ["dot", [2, 7, null], false]);
});

test("in space the time stands on the third axis where only two states move and do not step", () => {
  const result = mixed();
  result.trajectory.x[0] = [0, 1, 2, 2, 5];
  assert.deepEqual(saltus.firstChoice(result, 3).map((i) => saltus.axes(result)[i].name), ["rest", "move", "t"]);
});

test("units and labels stand in tables, beside panels and on axes", () => {
  const result = {
    ...mixed(),
    captions: {move: {unit: "m", label: "position <b>"}, power: {unit: "wibble/fortnight", label: ""}},
  };
  assert.deepEqual(saltus.captionedRow(result, "move", 2), ["move", "2 m", "position <b>"]);
  assert.deepEqual(saltus.captionedRow(result, "rest", 2), ["rest", "2", ""]);
  const [, , move, power] = saltus.columns(result);
  assert.deepEqual(saltus.columnLines(move), ["move [m]", "position <b>"]);
  assert.deepEqual(saltus.columnLines(move, false), ["move [m]"]);
  assert.deepEqual(saltus.columnLines(power), ["power", "[wibble/fortnight]"]);
  assert.equal(saltus.axisLabel(result, 2), "position <b> move [m]");
  const stack = saltus.stackPanels(result, 600);
  const palette = {curves: ["black"], quiet: "grey", text: "black"};
  const texts = stack.panels.flatMap((panel) => saltus.panelLabels(panel, stack, palette, result)).map(({text}) => text);
  assert.ok(texts.includes("move [m]<br>position &lt;b&gt;"), texts.join());
  assert.ok(texts.includes("power<br>[wibble/fortnight]"), texts.join());
  // Room for the longest line.
  assert.ok(saltus.labelWidth(result) >= 18 * 7);
});

test("lines of jumps are not dotted as the jumps of curves are", () => {
  const palette = {jump: "teal", mark: "grey"};
  const [shape] = saltus.markShapes(mixed(), [0], null, palette);
  assert.equal(shape.line.dash, undefined);
});

test("of very many states those that move most are drawn, the last one too", () => {
  const t = [0, 1, 2];
  const x = Array.from({length: 300}, (_, i) => (i < 200 ? [i, i, i] : [0, i, 0]));
  const states = x.map((_, i) => `x${i}`);
  const result = {states, output_names: [], controls: [], switching_functions: [], regions: [], trajectory: {t, x}};
  const drawn = saltus.firstPanels({...result, trajectory: {...result.trajectory, modes: [], regions: []}});
  const curves = drawn.panels.flatMap((panel) => panel.curves);
  assert.equal(curves.length, saltus.firstCurves(states));
  assert.ok(curves.includes(299));
  assert.ok(curves.every((i) => i >= 200));
});

test("panels are moved, joined, split, hidden and shown", () => {
  const choice = {panels: [0, 1, 2].map((i) => ({curves: [i], log: false})), bands: [0]};
  const curves = ({panels}) => panels.map((panel) => panel.curves);
  assert.deepEqual(curves(saltus.movePanel(choice, 2, 0)), [[2], [0], [1]]);
  assert.deepEqual(saltus.movePanel(choice, 0, 3), choice);
  const joined = saltus.joinPanels(choice, 2, 0);
  assert.deepEqual(curves(joined), [[0, 2], [1]]);
  assert.deepEqual(curves(saltus.splitPanel(joined, 0)), [[0], [2], [1]]);
  assert.deepEqual(curves(saltus.showColumn(joined, 1, false)), [[0, 2]]);
  assert.deepEqual(curves(saltus.showColumn(joined, 7, true)), [[0, 2], [1], [7]]);
  assert.deepEqual(saltus.showBand(choice, 0, false).bands, []);
});

test("a choice in the address is read again, and one that does not fit is not", () => {
  const result = mixed();
  const choice = {panels: [{curves: [0, 3], log: false}, {curves: [2], log: true}], bands: [0]};
  const text = saltus.panelsText(choice);
  assert.equal(text, "0+3,l2;0");
  assert.deepEqual(saltus.panelsFromText(result, text), choice);
  assert.deepEqual(saltus.panelsFromText(result, ";"), {panels: [], bands: []});
  for (const wrong of [null, "", "99;", "0;7", "x;", "0+;"]) {
    assert.equal(saltus.panelsFromText(result, wrong), null, String(wrong));
  }
  assert.deepEqual(saltus.axesFromText(result, "5,3"), [5, 3]);
  for (const wrong of [null, "1", "1,6", "1,a"]) assert.equal(saltus.axesFromText(result, wrong), null);
});

test("an event stands on the axes of time, outputs and states", () => {
  const result = mixed();
  assert.deepEqual([5, 3, 1].map((axis) => saltus.eventCoordinate(result, 0, axis)), [2, 7, 1]);
});

test("over time a surface that moves is a line of its own", () => {
  const surface = {...affine([0], [1], -1), depends_on_time: true};
  surface.affine.rate = 2;
  const parts = saltus.surfaceInPlane(surface, [5, 0], {t: 3, x: [0], timeAxis: 5});
  // x + 2 t - 1 = 0, over (t, x).
  assert.deepEqual(parts, {kind: "exact", lines: [[2, 1, -1]], curves: []});
});

/** A value that jumps between -1 and 2 a thousand times from t = 0 to 1, a third of the time above, then rests. */
const chattering = () => {
  const [t, values] = [[], []];
  for (let i = 0; i < 1000; i += 1) {
    t.push(i / 1000, (i + 1 / 3) / 1000, (i + 1 / 3) / 1000, (i + 1) / 1000);
    values.push(2, 2, -1, -1);
  }
  t.push(10);
  values.push(-1);
  return {t, values};
};

test("where a curve chatters its envelope and its mean are drawn instead of lines", () => {
  const {t, values} = chattering();
  const {x, y, jumps, envelope} = saltus.points(t, values, [0, 10], 100);
  assert.ok(envelope.x.length >= 10 && envelope.x.length <= 11, String(envelope.x.length));
  assert.ok(envelope.low.every((value) => value === -1) && envelope.high.every((value) => value === 2));
  for (const mean of envelope.mean.slice(0, 10)) assert.ok(Math.abs(mean) < 0.02, String(mean));
  assert.ok(jumps.x.length < 30);
  assert.deepEqual([x.at(-1), y.at(-1)], [10, -1]);
  // Near enough every jump is a line of its own again.
  const near = saltus.points(t, values, [0, 0.01], 400);
  assert.equal(near.envelope.x.length, 0);
  assert.ok(near.jumps.x.length >= 3 * 19);
});

test("the mean of chattering is one of whole periods, wherever pixels begin", () => {
  // 2.5 periods a pixel, and 0.3 of every period above.
  const [t, values] = [[], []];
  for (let i = 0; i < 1000; i += 1) {
    t.push(i, i + 0.3, i + 0.3, i + 1);
    values.push(1, 1, 0, 0);
  }
  const {envelope} = saltus.points(t, values, [0, 1000], 400);
  assert.ok(envelope.mean.length > 390, String(envelope.mean.length));
  for (const mean of envelope.mean) assert.ok(Math.abs(mean - 0.3) < 1e-9, String(mean));
});

test("intervals of modes below a pixel keep their parts of the time", () => {
  const edges = [0];
  const values = [];
  for (let i = 0; i < 1000; i += 1) {
    edges.push((i + 0.25) / 1000, (i + 1) / 1000);
    values.push(1, -1);
  }
  edges.push(10);
  values.push(0);
  const cells = saltus.modeCells({edges, values}, [0, 10], 100);
  assert.ok(cells.length >= 10 && cells.length <= 13, String(cells.length));
  const {share, count} = cells[3];
  assert.ok(Math.abs(share.plus - 0.25) < 0.02 && Math.abs(share.minus - 0.75) < 0.02);
  assert.equal(count > 100, true);
  assert.deepEqual(cells.at(-1), {from: 1, to: 10, share: {minus: 0, sliding: 1, plus: 0}, count: 1});
});

test("differences to another result are taken at the times of both, on both sides of jumps, where both are", () => {
  const first = {t: [0, 1, 2, 2, 3], x: [[0, 1, 2, 5, 6]]};
  const other = {t: [0, 2, 2.5], x: [[1, 3, 3]]};
  const {x, y, largest} = saltus.differenceOf(first, other, {sort: "state", index: 0});
  assert.deepEqual(x, [0, 1, 2, 2, 2.5, 3]);
  assert.deepEqual(y, [1, 1, 1, -2, -2.5, null]);
  assert.equal(largest, 2.5);
  assert.equal(saltus.differenceOf(first, {t: [0], x: [[]]}, {sort: "state", index: 0}).largest, null);
  // The other jumps where the first has no row.
  const jumping = {t: [0, 1.5, 1.5, 3], x: [[0, 1.5, 9, 9]]};
  const between = saltus.differenceOf({t: [0, 3], x: [[0, 3]]}, jumping, {sort: "state", index: 0});
  assert.deepEqual([between.x, between.y], [[0, 1.5, 1.5, 3], [0, 0, 7.5, 6]]);
  // One point where nothing jumps.
  const bent = {t: [0, 1, 1, 2], x: [[0, 1, 1, 0]]};
  assert.deepEqual(saltus.differenceOf(bent, other, {sort: "state", index: 0}).y, [1, 1, 3, null]);
});

test("the rows of a page are a table with both sides of events", () => {
  const lines = saltus.toCsv({...mixed(), controls: ["a,b"], trajectory: {...mixed().trajectory, u: [[1, 1, 1, null, 1]]}})
                    .trimEnd().split("\r\n");
  assert.equal(lines[0], "t,side,rest,count,move,\"a,b\",power,alpha(s),mode(s)");
  assert.equal(lines[3], "2,0,1,0,2,1,7,0,-1");
  assert.equal(lines[4], "2,1,1,1,2,,7,1,1");
  assert.equal(lines.length, 6);
});

test("bodies lie where their numbers say, linearly between rows and behind a jump", () => {
  const shapes = [{kind: "line", points: 2}, {kind: "disc", points: 1}];
  const trajectory = {t: [0, 1, 1, 3], drawing: [[0, 2, 5, 7], [0, 0, 0, 0], [1, 3, 6, 8], [0, 0, 0, 0], [0, 4, 4, 4], [1, 1, 1, 1], [0.5, 0.5, 0.5, 0.5]]};
  assert.deepEqual(saltus.placedShapes(shapes, saltus.bodiesAt(trajectory, 0.5)), [
    {index: 0, kind: "line", points: [[1, 0], [2, 0]], radius: 0},
    {index: 1, kind: "disc", points: [[2, 1]], radius: 0.5},
  ]);
  assert.equal(saltus.bodiesAt(trajectory, 1)[0], 5);
  assert.equal(saltus.bodiesAt(trajectory, 2)[0], 6);
  assert.equal(saltus.bodiesAt(trajectory, 3)[0], 7);
  assert.equal(saltus.bodiesAt(trajectory, -1)[0], 0);
});

test("a shape with a missing number is left out, the others stay where they are", () => {
  const shapes = [{kind: "line", points: 2}, {kind: "disc", points: 1}];
  const placed = saltus.placedShapes(shapes, [null, 0, 1, 0, 4, 1, 0.5]);
  assert.deepEqual(placed, [{index: 1, kind: "disc", points: [[4, 1]], radius: 0.5}]);
});

test("the box of bodies holds discs with their radii, and has one scale on both axes", () => {
  const shapes = [{kind: "disc", points: 1}];
  const box = saltus.bodiesBox(shapes, {t: [0, 1], drawing: [[0, 10], [1, 1], [1, 1]]});
  assert.deepEqual(box.map((range) => range.map((value) => Number(value.toFixed(9)))), [[-1.48, 11.48], [-0.48, 2.48]]);
  const picture = saltus.bodiesPicture(box, 1296, 420);
  assert.ok(Math.abs(picture.scale - 100) < 1e-9);
  assert.ok(Math.abs(picture.height - 296) < 1e-9);
  assert.ok(Math.abs(picture.y(-0.48) - picture.height) < 1e-9);
  assert.deepEqual(saltus.bodiesBox([], {t: [0], drawing: []}), [[0, 1], [0, 1]]);
});

test("what is made of numbers stands still", () => {
  const shapes = [{kind: "line", points: 2}, {kind: "disc", points: 1}];
  const trajectory = {t: [0, 1], drawing: [[0, 0], [0, 0], [1, 1], [0, 0], [0, 4], [1, 1], [2, 2]]};
  assert.ok(saltus.standsStill(shapes, trajectory, 0));
  assert.ok(!saltus.standsStill(shapes, trajectory, 1));
});

test("frames of a strobe and ticks are round and within their ranges", () => {
  assert.deepEqual(saltus.strobeTimes({t: [1, 2, 3]}, 3), [1, 2, 3]);
  assert.deepEqual(saltus.strobeTimes({t: [1]}), [1]);
  assert.deepEqual(saltus.roundTicks([-0.1, 1.05], 5), [0, 0.5, 1]);
  assert.deepEqual(saltus.roundTicks([0.13, 0.31], 4), [0.15, 0.2, 0.25, 0.3]);
  assert.ok(saltus.roundTicks([0.24999999999999997, 0.25], 5).length < 10);  // ends
  assert.ok(saltus.isDrawable([0.2, 0.25]) && !saltus.isDrawable([0.24999999999999997, 0.25]));
});

test("small columns beside large ones move; what is below the tolerance is rounding", () => {
  const moving = (options) => {
    const trajectory = {t: [0, 1, 2], x: [[1e7, 2e7, 3e7], [1e-9, 0, -1e-9], [0, 1e-17, 0]], alpha: [], outputs: []};
    const result = {states: ["p", "z", "rest"], controls: [], switching_functions: [], trajectory, options};
    return saltus.movingOf(saltus.columns(result)).map(({name}) => name);
  };
  assert.deepEqual(moving([["simulate.atol", 1e-14]]), ["p", "z"]);
  assert.deepEqual(moving([["simulate.atol", 1e-8]]), ["p"]);
});

test("speeds of a player are round, and a run takes some seconds with the first one", () => {
  assert.deepEqual(saltus.playSpeeds(10), {first: 1, all: [0.1, 0.2, 0.5, 1, 2, 5, 10]});
  assert.equal(saltus.playSpeeds(2).first, 0.5);
  assert.equal(saltus.playSpeeds(1e-3).first, 5e-4);
  assert.equal(saltus.playSpeeds(3600).first, 200);
  assert.ok(saltus.playSpeeds(3600).all.includes(1));
  assert.equal(saltus.playSpeeds(0).first, 1);
});

test("a GIF plays a run with its speed, in at most 500 frames", () => {
  const {times, hundredths} = saltus.gifTimes([0, 4], 2);
  assert.equal(hundredths, 4);
  assert.deepEqual([times[0], times[50], times.length], [0, 4, 51 + 15]);
  const long = saltus.gifTimes([0, 100], 1);
  assert.equal(long.hundredths, 20);
  assert.equal(long.times.filter((t) => t < 100).length, 500);
});

test("frames of a GIF are what differs, and equal frames one pixel that changes nothing", () => {
  const before = Uint8Array.from([1, 1, 1, 1, 1, 1]);
  const after = Uint8Array.from([1, 1, 1, 1, 2, 1]);
  assert.deepEqual(saltus.gifDifference(before, after, 3, 2), {left: 1, top: 1, width: 1, height: 1, pixels: Uint8Array.of(2)});
  assert.deepEqual(saltus.gifDifference(after, after, 3, 2).pixels, Uint8Array.of(255));
  assert.equal(saltus.gifDifference(null, after, 3, 2).pixels.length, 6);
});

test("a picture follows what moves where the scene is much larger", () => {
  const shapes = [{kind: "disc", points: 1}];
  const run = {t: [0, 1], drawing: [[0, 10], [0, 0], [0.5, 0.5]]};
  const all = saltus.bodiesBox(shapes, run);
  const follow = saltus.followBox(shapes, run, [false], all);
  const [[from, to]] = follow(saltus.placedShapes(shapes, [5, 0, 0.5]));
  assert.ok(Math.abs((from + to) / 2 - 5) < 1e-12);
  assert.ok(to - from < (all[0][1] - all[0][0]) / 2);
  const near = {t: [0, 1], drawing: [[0, 0.1], [0, 0], [0.5, 0.5]]};
  assert.equal(saltus.followBox(shapes, near, [false], saltus.bodiesBox(shapes, near)), null);
});

const mechanical = () => {
  const t = [0, 1, 1, 2];
  return {
    ...mixed(),
    states: ["x", "z", "vx", "vz"],
    contacts: ["floor"],
    model: {equations: [["x'", "vx", ""], ["z'", "vz", ""], ["force on vz", "-9.81", ""]]},
    output_names: ["gap(left)", "force(left)", "gap(right)", "force(right)", "energy"],
    events: [{t: 1, kind: "impact", x: [1, 0, 2, -1], x_after: [1, 0, 2, 1], unique: true}],
    switching_functions: [],
    trajectory: {
      t,
      x: [[0, 1, 1, 2], [1, 0, 0, 1], [1, 2, 2, 3], [-1, -1, 1, 1]],
      outputs: [[1, 0, 0, 1], [0, 0, 5, 5], [2, 1, 1, 2], [0, 0, 4, 4], [3, 3, 2, 2]],
      u: [], alpha: [], theta: [], modes: [], regions: [],
    },
  };
};

test("positions, velocities, gaps and forces have panels of their own, whose axes say so", () => {
  const result = mechanical();
  const curves = saltus.stackPanels(result, 600).panels.filter(({kind}) => kind === "curves");
  assert.deepEqual(curves.map(({title, curves: own}) => [title, own.map(({name}) => name)]), [
    ["position", ["x", "z"]], ["velocity", ["vx", "vz"]], ["gap", ["gap(left)", "gap(right)"]],
    ["force", ["force(left)", "force(right)"]], ["energy", ["energy"]]
  ]);
  // A colour comes back after all others.
  const palette = {curves: Array.from({length: 10}, (_, i) => `c${i}`)};
  const colours = curves.flatMap((panel) => panel.curves.map((_, i) => saltus.curveColour(panel, i, palette)));
  assert.equal(new Set(colours).size, colours.length);
});

test("a system with contacts begins with the coordinate whose velocity jumps, and its curve is the trajectory", () => {
  const result = mechanical();
  assert.deepEqual(saltus.firstChoice(result, 2), [1, 3]);
  assert.equal(saltus.freeName(result), "trajectory");
  assert.equal(saltus.freeName(mixed()), "not sliding");
  result.trajectory.x[1] = [0, 0, 0, 0];
  saltus.columnsOf.delete(result);
  assert.deepEqual(saltus.firstChoice(result, 2), [0, 2]);
});

test("curves of one kind with different units do not share an axis", () => {
  const result = mixed();
  result.states = Array.from({length: 8}, (_, i) => `s${i}`);
  result.trajectory.x = result.states.map(() => [0, 1, 1, 1, 2]);
  result.captions = Object.fromEntries(result.states.map((name, i) => [name, {unit: i < 4 ? "V" : "A", label: ""}]));
  const panels = saltus.stackPanels(result, 600).panels.filter(({kind, sort}) => kind === "curves" && sort === "state");
  assert.deepEqual(panels.map(({title}) => title).slice(0, 4), ["s0 [V]", "s1 [V]", "s2 [V]", "s3 [V]"]);
  result.states.forEach((name, i) => (result.captions[name].unit = i < 7 ? "V" : "A"));
  saltus.columnsOf.delete(result);
  const joined = saltus.stackPanels(result, 600).panels.filter(({kind, sort}) => kind === "curves" && sort === "state");
  assert.deepEqual(joined.map(({title, curves}) => [title, curves.length]), [["states [V]", 4], ["states [V]", 3], ["s7 [A]", 1]]);
});
