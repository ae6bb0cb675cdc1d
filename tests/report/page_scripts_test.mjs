// Thinning, gaps, intervals, groups and number formats of the report's page (src/saltus/report/page).
import assert from "node:assert/strict";
import fs from "node:fs";
import test from "node:test";
import vm from "node:vm";

const page = new URL("../../src/saltus/report/page/", import.meta.url);
const source = ["format.js", "series.js", "panels.js", "marks.js", "phase.js"]
                   .map((file) => fs.readFileSync(new URL(file, page), "utf8"))
                   .join("\n");
const saltus = vm.runInThisContext(`(() => {${source}\nreturn saltus; })()`);

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

test("a jump is a gap, a continuous event is none", () => {
  const t = [0, 1, 1, 2, 2, 3];
  const {x, y} = saltus.points(t, [0, 1, 5, 6, 6, 7], [0, 3], 100);
  assert.deepEqual(x, [0, 1, 1, 1, 2, 2, 3]);
  assert.deepEqual(y, [0, 1, null, 5, 6, 6, 7]);
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
  assert.deepEqual(parts.free.x, [0, 1, null, 7, 8]);
  assert.deepEqual(parts.sliding.x, [1, 2, null]);
});

test("numbers keep all digits", () => {
  for (const value of [0.1 + 0.2, 1e-300, -2.5e-5, 123456789.123, 0]) assert.equal(Number(saltus.exact(value)), value);
  assert.equal(saltus.exact(null), "not a number");
  assert.equal(saltus.timeColumn([0, 39.123456789012345])(0.24468880178), "0.2446888018");
});
