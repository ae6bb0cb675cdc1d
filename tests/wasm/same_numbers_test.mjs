// The engine as WebAssembly and the native tool say the same of models of every kind: end, events, and errors word by word.
import assert from "node:assert/strict";
import {execFileSync, spawnSync} from "node:child_process";
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from "node:fs";
import {createRequire} from "node:module";
import {tmpdir} from "node:os";
import {join} from "node:path";
import {test} from "node:test";

const {SALTUS_TOOL, SALTUS_ENGINE, SALTUS_SOURCE} = process.env;
const engine = await createRequire(import.meta.url)(SALTUS_ENGINE)();
const model = (name) => readFileSync(`${SALTUS_SOURCE}/models/${name}.toml`, "utf8");

const simulate = (text, settings = []) =>
  JSON.parse(engine.ccall("saltus_simulate", "string", ["string", "string", "number"], [text, settings.join("\n"), 0]));

const natively = (name, settings = []) => JSON.parse(execFileSync(
    SALTUS_TOOL,
    ["simulate", name, "--quiet", "--out", "-", ...["simulate.native=off", ...settings].flatMap((each) => ["--set", each])],
    {maxBuffer: 1 << 28, env: {...process.env, SALTUS_MODELS: `${SALTUS_SOURCE}/models`}}));

// Relative to 1, or to the number where it is larger: exp and sin of two libraries differ in their last digits.
const near = (found, expected, what) => {
  assert.ok(Math.abs(found - expected) <= 1e-9 * Math.max(1, Math.abs(expected)), `${what}: ${found} instead of ${expected}`);
};

const MODELS = ["stick-slip", "bouncing-ball", "relay-oscillator", "thermostat", "sliding-mode-pendulum", "buck-converter", "two-genes",
                "falling-rod", "super-twisting", "gear-backlash"];

for (const name of MODELS) {
  test(name, () => {
    const told = simulate(model(name));
    assert.equal(told.error, undefined);
    const found = JSON.parse(told.result);
    const expected = natively(name);
    assert.equal(found.status.termination, expected.status.termination);
    const what = (result) => result.events.map(({kind, mode_after}) => [kind, mode_after]);
    assert.deepEqual(what(found), what(expected));
    expected.events.forEach(({t}, i) => near(found.events[i].t, t, `time of event ${i}`));
    assert.equal(found.final.x.length, expected.final.x.length);
    expected.final.x.forEach((value, i) => near(found.final.x[i], value, `${expected.states[i]} at the end`));
  });
}

test("a setting counts", () => {
  const changed = JSON.parse(simulate(model("stick-slip"), ["simulate.until=1.5"]).result);
  assert.equal(changed.status.time_reached, 1.5);
});

test("a mistake has the place and the words of the tool", () => {
  const text = model("stick-slip").replace("[dynamics]", "[dynamixs]");
  const told = simulate(text);
  const folder = mkdtempSync(join(tmpdir(), "saltus-wasm-"));
  writeFileSync(join(folder, "model.toml"), text);
  const native = spawnSync(SALTUS_TOOL, ["simulate", "model.toml"], {cwd: folder, encoding: "utf8"}).stderr;
  rmSync(folder, {recursive: true});
  assert.ok(told.line > 1);
  assert.ok(told.error.includes("dynamixs"));
  // The tool shows the line in question between them.
  for (const line of told.error.trim().split("\n")) assert.ok(native.includes(line), `${native} has no '${line}'`);
});

test("the page of a result is whole", () => {
  const told = JSON.parse(engine.ccall("saltus_simulate", "string", ["string", "string", "number"], [model("stick-slip"), "", 1]));
  assert.match(told.page, /^<!DOCTYPE html>/);
  assert.match(told.page, /<\/html>\n$/);
  assert.match(told.table, /stick-slip/);
});
