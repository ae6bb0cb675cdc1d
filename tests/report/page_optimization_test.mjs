// What the report's page computes for an optimisation (src/saltus/report/page).
import assert from "node:assert/strict";
import fs from "node:fs";
import test from "node:test";
import vm from "node:vm";

const page = new URL("../../src/saltus/report/page/", import.meta.url);
const source = [
  "format.js", "series.js", "panels.js", "kinds.js", "branches.js", "figure.js", "cards.js", "optimization.js", "overlays.js", "drawing_card.js",
  "homotopy.js", "constraints.js", "open_loop.js"
].map((file) => fs.readFileSync(new URL(file, page), "utf8")).join("\n");
const saltus = vm.runInThisContext(`(() => {${source}\nreturn saltus; })()`);

const palette = {curves: ["c1", "c2", "c3", "c4", "c5", "c6"], mark: "mark", quiet: "quiet", simulated: "simulated", text: "text"};
const step = (phase, iterations, more = {}) => ({
  phase,
  iterations,
  solver: "ipopt",
  sigma: 0.1,
  objective: 2,
  primal_infeasibility: 1e-9,
  complementarity_residual: 0,
  termination: "completed",
  seconds: 0.1,
  message: "",
  ...more,
});

/** q from 0 to 4 in two intervals with u = 1 and -1. */
const result = {
  states: ["q"],
  controls: ["u"],
  branches: [],
  events: [],
  elements: null,
  trajectory: {t: [0, 1, 2, 3, 4], x: [[0, 1, 2, 3, 4]], u: [[1, 1, 1, -1, -1]]},
  optimization: {
    grid: [0, 2, 4],
    u: [[1, -1]],
    h: [[1, 1], [0.5, 1.5]],
    bounds: {x: [[null, 5]], u: [[-1, 40]]},
    open_loop: {t: [0, 2, 2, 4], x: [[0, 9, 2.4, 4.4]]},
    homotopy: [step("relaxed", 10), step("relaxed", 5, {termination: "iteration_limit"}), step("lpcc", 0), step("branch", 3)],
  },
};
const state = {name: "q", sort: "state", index: 0, values: result.trajectory.x[0]};
const control = {name: "u", sort: "input", index: 0, values: result.trajectory.u[0]};
const view = {window: [0, 4], pixels: 100, palette, branch: null};

test("controls are steps over their intervals, whatever rows the trajectory has", () => {
  assert.deepEqual(saltus.controlSteps(result, control), {x: [0, 2, 4], y: [1, -1, -1], jumps: {x: [], y: []}});
  assert.equal(saltus.controlSteps(result, state), null);
  assert.equal(saltus.controlSteps({...result, optimization: null}, control), null);
});

test("bounds are drawn where they do not flatten the curve", () => {
  assert.deepEqual(saltus.boundsNear(result, state), [5]);
  assert.deepEqual(saltus.boundsNear(result, control), [-1]);
  assert.deepEqual(saltus.boundsNear({...result, optimization: null}, control), []);
  assert.deepEqual(saltus.boundsNear(result, {...state, index: 7}), []);
});

test("a state has its bounds under its curve and the simulation on it, a control no simulation", () => {
  const panel = {sort: "state", curves: [state], firstColour: 0};
  assert.deepEqual(saltus.curveTraces(result, panel, "y", view).map(({meta}) => meta), ["bound", undefined, "simulated"]);
  const inputs = saltus.curveTraces(result, {sort: "input", curves: [control], firstColour: 0}, "y", view);
  assert.deepEqual(inputs.map(({meta}) => meta), ["bound", undefined]);
  assert.equal(inputs[1].line.shape, "hv");
  const plain = {...result, optimization: null};
  assert.equal(saltus.curveTraces(plain, panel, "y", view).length, 1);
});

test("iterations are added up, residuals of 0 have a place, what failed is crossed out", () => {
  const {homotopy} = result.optimization;
  assert.deepEqual(saltus.iterationsCumulated(homotopy), [10, 15, 15, 18]);
  const traces = saltus.homotopyTraces(homotopy, palette);
  const complementarity = traces.find(({name}) => name === "complementarity");
  assert.deepEqual(complementarity.y, homotopy.map(() => saltus.leastResidual));
  assert.deepEqual(complementarity.customdata, ["0", "0", "0", "0"]);
  assert.deepEqual(complementarity.marker.symbol, ["circle", "x-thin", "diamond", "square"]);
  assert.deepEqual(traces.find(({name}) => name === "objective").y, [2, 2, 2, 2]);
  assert.ok(traces.some(({name}) => name === "not solved"));
  assert.ok(complementarity.text[1].endsWith("5 iterations, iteration limit"));
});

test("problems after the last relaxed one are shaded", () => {
  const [shape] = saltus.crossoverShape(result.optimization.homotopy, {slidingShade: "shade"});
  assert.deepEqual([shape.x0, shape.x1], [15, 18]);
  assert.deepEqual(saltus.crossoverShape([step("relaxed", 4)], {}), []);
  assert.deepEqual(saltus.crossoverShape([], {}), []);
});

test("tries of other branches are named so, and the path does not run through them", () => {
  const end = (message, termination, objective) => ({...step("branch", 5), message, termination, objective});
  const homotopy = [
    step("relaxed", 4), end("refused: the relaxed objective is 1", "completed", 3), end("", "completed", 3),
    end("another mode sequence: insertion", "iteration_limit", 7), end("", "completed", 4)
  ];
  assert.equal(saltus.solutionPlace(homotopy, 3), 2);
  assert.deepEqual(saltus.problemRoles(homotopy, 3), ["path", "path", "taken", "other", "other"]);
  assert.deepEqual(saltus.problemRoles([step("relaxed", 4), end("", "iteration_limit", 7)], 9), ["path", "failed"]);
  const priced = {...step("relaxed", 4), message: "modes with a price of 10"};
  assert.deepEqual(saltus.problemRoles([priced, end("", "completed", 3)], 3), ["path", "taken"]);
  const traces = saltus.homotopyTraces(homotopy, palette, 3);
  assert.ok(!traces.some(({name}) => name === "not solved"));
  assert.ok(traces.some(({name}) => name === "another branch, tried"));
  assert.deepEqual(traces.find(({name}) => name === "objective").x, [4, 9, 14]);
  const tried = traces.find(({name}) => name === "objective, tried");
  assert.deepEqual([tried.x, tried.marker.symbol], [[19, 24], "square-open"]);
  assert.match(tried.text[0], /tried, no solution \(iteration limit\)/);
});

test("constraints are grouped by name, those that matter most first", () => {
  const entry = (name, time, value) => ({name, time, value});
  const groups = saltus.constraintGroups([entry("a", 0, 0), entry("b", 1, -3), entry("a", 1, 2), entry("c", 1, null)]);
  assert.deepEqual(groups.map(({name}) => name), ["b", "a", "c"]);
  assert.deepEqual(saltus.stems(groups[1]), {x: [0, 0, null, 1, 1, null], y: [0, 0, null, 0, 2, null]});
  const [, marks] = saltus.stemTraces([groups[1]], palette);
  assert.deepEqual(marks.marker.symbol, ["circle-open", "circle"]);
});

test("limits of multipliers that are not unique are marks of their own", () => {
  const open = (range) => ({name: "v == 0", time: 2, value: null, range});
  const [group] = saltus.constraintGroups([open([0.4, null]), open([1, 2]), open([null, null])]);
  assert.deepEqual(group.ranges.map(({range}) => saltus.rangeText(range)), ["at least 0.4", "1 to 2", "not determined"]);
  assert.deepEqual(saltus.rangePoints(group).y, [0.4, null, 1, 2, null, 0, null]);
  const traces = saltus.stemTraces([group], {curves: ["red"]});
  assert.equal(traces.length, 3);
  assert.equal(saltus.stemTraces(saltus.constraintGroups([{name: "a", time: 0, value: 1}]), {curves: ["red"]}).length, 2);
});

test("simulation and solution are compared where both have rows, after a jump", () => {
  const {trajectory, optimization: {open_loop: simulated}} = result;
  assert.deepEqual(saltus.commonRows(trajectory.t, simulated.t, 1e-9), [[0, 0], [2, 2], [4, 3]]);
  const {x, y} = saltus.openLoopDifference(trajectory, simulated, 0);
  assert.deepEqual(x, [0, 2, 4]);
  y.forEach((value, i) => assert.ok(Math.abs(value - [0, 0.1, 0.1][i]) < 1e-15));
});

test("with too few rows in common the simulation is interpolated, and ends where it ended", () => {
  const {y} = saltus.openLoopDifference(result.trajectory, {t: [0, 3], x: [[0, 4.5]]}, 0);
  assert.deepEqual(y, [0, 0.125, 0.25, 0.375, null]);
});

test("no difference is a gap, no difference at all a line at rounding", () => {
  assert.deepEqual(saltus.logarithmic([0, 1e-9, null]), [null, 1e-9, null]);
  assert.deepEqual(saltus.logarithmic([0, 0, null]), [saltus.leastResidual, saltus.leastResidual, null]);
});

test("elements fill their interval", () => {
  const {grid, h} = result.optimization;
  assert.deepEqual(saltus.intervalSteps(grid, h), {x: [0, 1, 1, 2, 2, 2.5, 2.5, 4], y: [1, 1, 1, 1, 0.5, 0.5, 1.5, 1.5]});
  // With time that runs twice as fast lengths are those of the integration, places those of the clock.
  assert.deepEqual(saltus.intervalSteps([0, 1], [[1, 1]]).x, [0, 0.5, 0.5, 1]);
});
