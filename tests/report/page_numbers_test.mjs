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

test("columns are unpacked when they are asked for, those kept by points on the lines between them", () => {
  const numbers = new Float64Array([0, 1, 2, 2, 3, 5, 6, NaN, 7, 8, 0, 2, 3, 4, 10, 14, -1, -2]);
  const {t, x} = saltus.unpack(
      {x: [{$n: [5, 5]}, {$points: [{$n: [10, 4]}, {$n: [14, 4]}], size: 5}, {$points: [[0, 4], [1, null]], size: 5}], t: {$n: [0, 5]}},
      numbers);
  assert.equal(typeof Object.getOwnPropertyDescriptor(x, 1).get, "function");
  assert.deepEqual(x[0], [5, 6, null, 7, 8]);
  assert.deepEqual(t, [0, 1, 2, 2, 3]);
  assert.deepEqual(x[1], [10, 12, 14, -1, -2]);
  assert.equal(Object.getOwnPropertyDescriptor(x, 1).get, undefined);
  assert.deepEqual(x[2], [1, null, null, null, null]);
  assert.deepEqual([...saltus.packedOf.get(x)[1].values], [10, 14, -1, -2]);
});

test("of very many rows members are unpacked column by column", () => {
  const count = 1500;
  const numbers = new Float64Array(Array.from({length: count}, (_, i) => i));
  const rows = saltus.unpack({$rows: count, columns: {t: {$n: [0, count]}, kind: {$codes: {$n: [0, count]}, of: numbers}}}, numbers);
  assert.equal(rows.length, count);
  assert.deepEqual(rows.map(({t}) => t), [...numbers]);
  assert.equal(rows[1499].kind, 1499);
});
