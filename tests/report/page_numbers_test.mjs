// What the page inflates and puts together again (src/saltus/report/page/numbers.js).
import assert from "node:assert/strict";
import fs from "node:fs";
import test from "node:test";
import vm from "node:vm";
import zlib from "node:zlib";

const page = new URL("../../src/saltus/report/page/", import.meta.url);
const source = ["format.js", "numbers.js"].map((file) => fs.readFileSync(new URL(file, page), "utf8")).join("\n");
const saltus = vm.runInThisContext(`(() => {${source}\nreturn saltus; })()`);

/** The same digits in every run. */
const noise = (count) => {
  let state = 12345;
  return Uint8Array.from({length: count}, () => {
    state = (Math.imul(state, 1103515245) + 12345) >>> 0;
    return state >>> 24;
  });
};

test("stored, fixed and dynamic blocks are inflated", () => {
  const texts = ["", "a", "abc".repeat(5000), JSON.stringify(Array.from({length: 9000}, (_, i) => Math.sin(i)))];
  const inputs = [...texts.map((text) => Buffer.from(text)), Buffer.from(noise(200000)), Buffer.alloc(70000)];
  for (const input of inputs) {
    for (const options of [{level: 0}, {level: 1}, {level: 9}, {strategy: zlib.constants.Z_FIXED}]) {
      const output = saltus.inflate(new Uint8Array(zlib.deflateRawSync(input, options)));
      assert.ok(Buffer.from(output).equals(input), `${input.length} bytes, ${JSON.stringify(options)}`);
    }
  }
});

test("deflated bytes that are cut off are refused", () => {
  const whole = zlib.deflateRawSync(Buffer.from("0123456789 ".repeat(4000).split("").sort().join("") + "xyz".repeat(999)));
  assert.throws(() => saltus.inflate(new Uint8Array(whole.subarray(0, whole.length / 2))), /cut off/);
});

test("numbers come back bit by bit from their shuffled bytes", () => {
  const numbers = new Float64Array([1, -0.1, 1e308, 5e-324, NaN, 40.00000000000001]);
  const bytes = new Uint8Array(numbers.buffer);
  const shuffled = new Uint8Array(bytes.length);
  for (let i = 0; i < numbers.length; i += 1) {
    for (let k = 0; k < 8; k += 1) shuffled[k * numbers.length + i] = bytes[8 * i + k];
  }
  assert.deepEqual(saltus.numbersOf(shuffled), numbers);
});

test("a result is put together from its skeleton and its numbers", () => {
  const numbers = new Float64Array([1, NaN, 3, 0, 1, 1, 10, 11, 20, 21, 30, 31]);
  const packed = {
    t: {$n: [0, 3]},
    name: "a",
    nothing: null,
    events: {
      $rows: 3,
      columns: {
        t: {$n: [0, 3]},
        kind: {$codes: {$n: [3, 3]}, of: ["jump", ["start"]]},
        x: {$table: 2, of: {$n: [6, 6]}},
        note: ["p", "q", {deep: 1}],
      },
    },
  };
  assert.deepEqual(saltus.unpack(packed, numbers), {
    t: [1, null, 3],
    name: "a",
    nothing: null,
    events: [
      {t: 1, kind: "jump", x: [10, 11], note: "p"}, {t: null, kind: ["start"], x: [20, 21], note: "q"},
      {t: 3, kind: ["start"], x: [30, 31], note: {deep: 1}}
    ],
  });
});
