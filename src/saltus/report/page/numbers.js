// Deflated bytes, and the numbers of the result that are in them (packing_internal.hpp says how they lie there).
"use strict";

/** Base and number of further bits of the lengths 257 … 285 and of the distances 0 … 29 (RFC 1951, 3.2.5). */
saltus.inflateSteps = (count, perStep, first, last) => {
  const bits = Array.from({length: count}, (_, i) => Math.max(0, Math.floor(i / perStep) - 1));
  const base = [first];
  bits.slice(0, -1).forEach((more) => base.push(base.at(-1) + 2 ** more));
  if (last !== undefined) [base[count - 1], bits[count - 1]] = [last, 0];
  return {base, bits};
};
saltus.inflateLengths = saltus.inflateSteps(29, 4, 3, 258);
saltus.inflateDistances = saltus.inflateSteps(30, 2, 1);

/** Codes from their lengths, as a table over the next `most` bits: symbol * 16 + length. */
saltus.huffmanTable = (lengths) => {
  const most = lengths.reduce((a, b) => Math.max(a, b), 1);
  const table = new Uint16Array(1 << most);
  let code = 0;
  for (let length = 1; length <= most; length += 1) {
    for (let symbol = 0; symbol < lengths.length; symbol += 1) {
      if (lengths[symbol] !== length) continue;
      let reversed = 0;
      for (let bit = 0; bit < length; bit += 1) reversed |= ((code >> bit) & 1) << (length - 1 - bit);
      for (let at = reversed; at < table.length; at += 1 << length) table[at] = symbol * 16 + length;
      code += 1;
    }
    code <<= 1;
  }
  return {table, mask: table.length - 1};
};

saltus.fixedTables = () => {
  const lengths = Array.from({length: 288}, (_, i) => (i < 144 ? 8 : i < 256 ? 9 : i < 280 ? 7 : 8));
  return [saltus.huffmanTable(lengths), saltus.huffmanTable(Array(30).fill(5))];
};

/** Bits of `input`, lowest first. */
saltus.bitReader = (input) => {
  const reader = {at: 0, held: 0, count: 0};
  reader.fill = (wanted) => {
    while (reader.count < wanted) {
      reader.held |= (input[reader.at] ?? 0) << reader.count;
      reader.at += 1;
      reader.count += 8;
    }
  };
  reader.take = (wanted) => {
    if (wanted === 0) return 0;
    reader.fill(wanted);
    const value = reader.held & ((1 << wanted) - 1);
    reader.held >>>= wanted;
    reader.count -= wanted;
    return value;
  };
  reader.symbol = ({table, mask}) => {
    reader.fill(15);
    const entry = table[reader.held & mask];
    reader.held >>>= entry & 15;
    reader.count -= entry & 15;
    return entry >> 4;
  };
  /** To the next whole byte of the input. */
  reader.align = () => {
    reader.at -= reader.count >> 3;
    reader.held = reader.count = 0;
  };
  return reader;
};

saltus.dynamicTables = (reader) => {
  const [literals, distances, count] = [reader.take(5) + 257, reader.take(5) + 1, reader.take(4) + 4];
  const order = [16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15];
  const ofCodes = Array(19).fill(0);
  for (let i = 0; i < count; i += 1) ofCodes[order[i]] = reader.take(3);
  const table = saltus.huffmanTable(ofCodes);
  const lengths = [];
  while (lengths.length < literals + distances) {
    const symbol = reader.symbol(table);
    if (symbol < 16) {
      lengths.push(symbol);
      continue;
    }
    const [value, least, bits] = {16: [lengths.at(-1), 3, 2], 17: [0, 3, 3], 18: [0, 11, 7]}[symbol];
    for (let left = least + reader.take(bits); left > 0; left -= 1) lengths.push(value);
  }
  return [saltus.huffmanTable(lengths.slice(0, literals)), saltus.huffmanTable(lengths.slice(literals))];
};

/** Bytes that grow. */
saltus.byteSink = (room) => {
  const sink = {bytes: new Uint8Array(room), size: 0};
  sink.reserve = (more) => {
    if (sink.size + more <= sink.bytes.length) return;
    const larger = new Uint8Array(2 * (sink.size + more));
    larger.set(sink.bytes.subarray(0, sink.size));
    sink.bytes = larger;
  };
  return sink;
};

/**
 * One compressed block. The state of the reader is held in variables that no function shares, and bits are filled up to
 * 24 at once: this loop is most of the time of opening.
 */
saltus.inflateBlock = (input, reader, sink, [literals, distances]) => {
  let {at, held, count} = reader;
  let {bytes, size} = sink;
  const {base, bits} = saltus.inflateLengths;
  const far = saltus.inflateDistances;
  const {table, mask} = literals;
  for (;;) {
    for (; count < 24; at += 1, count += 8) held |= input[at] << count;  // behind the end: undefined, which is 0
    const entry = table[held & mask];
    held >>>= entry & 15;
    count -= entry & 15;
    const symbol = entry >> 4;
    if (symbol === 256) break;
    if (size + 258 > bytes.length) {
      if (at > input.length + 8) throw new Error("the deflated numbers of this page are cut off");
      sink.size = size;
      sink.reserve(258);
      bytes = sink.bytes;
    }
    if (symbol < 256) {
      bytes[size] = symbol;
      size += 1;
      continue;
    }
    const more = bits[symbol - 257];
    const length = base[symbol - 257] + (held & ((1 << more) - 1));
    held >>>= more;
    count -= more;
    for (; count < 24; at += 1, count += 8) held |= input[at] << count;
    const step = distances.table[held & distances.mask];
    held >>>= step & 15;
    count -= step & 15;
    for (; count < 16; at += 1, count += 8) held |= input[at] << count;
    const wide = far.bits[step >> 4];
    const from = size - far.base[step >> 4] - (held & ((1 << wide) - 1));
    held >>>= wide;
    count -= wide;
    for (let k = 0; k < length; k += 1) bytes[size + k] = bytes[from + k];
    size += length;
  }
  Object.assign(reader, {at, held, count});
  sink.size = size;
};

/** Raw deflate (RFC 1951). Written here because DecompressionStream is missing in browsers before 2023. */
saltus.inflate = (input) => {
  const reader = saltus.bitReader(input);
  const sink = saltus.byteSink(Math.max(1024, 3 * input.length));
  for (let last = 0; last === 0;) {
    if (reader.at > input.length + 4) throw new Error("the deflated numbers of this page are cut off");
    last = reader.take(1);
    const kind = reader.take(2);
    if (kind !== 0) {
      saltus.inflateBlock(input, reader, sink, kind === 1 ? saltus.fixedTables() : saltus.dynamicTables(reader));
      continue;
    }
    reader.align();
    const length = input[reader.at] | (input[reader.at + 1] << 8);
    sink.reserve(length);
    sink.bytes.set(input.subarray(reader.at + 4, reader.at + 4 + length), sink.size);
    reader.at += 4 + length;
    sink.size += length;
  }
  return sink.bytes.subarray(0, sink.size);
};

/** The bytes of an element that holds them deflated, in base64. */
saltus.bytesOf = (text) => {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; i += 1) bytes[i] = letters.charCodeAt(i);
  return saltus.inflate(bytes);
};

saltus.numbersOf = (bytes) => {
  const count = bytes.length / 8;
  const together = new Uint8Array(bytes.length);
  for (let k = 0; k < 8; k += 1) {
    for (let i = 0; i < count; i += 1) together[8 * i + k] = bytes[k * count + i];
  }
  return new Float64Array(together.buffer);
};

/** The values of one column of `rows` objects. */
saltus.unpackColumn = (packed, numbers) => {
  if (packed.$codes !== undefined) return saltus.unpack(packed.$codes, numbers).map((code) => packed.of[code]);
  if (packed.$table !== undefined) {
    const all = saltus.unpack(packed.of, numbers);
    const width = packed.$table;
    return Array.from({length: width === 0 ? 0 : all.length / width}, (_, i) => all.slice(i * width, (i + 1) * width));
  }
  return saltus.unpack(packed, numbers);
};

/** A property that is computed when it is asked for first. */
saltus.lazily = (owner, key, compute) => Object.defineProperty(owner, key, {
  configurable: true,
  enumerable: true,
  get: () => {
    const value = compute();
    Object.defineProperty(owner, key, {value, writable: true, configurable: true, enumerable: true});
    return value;
  },
});

/** Objects whose members lie in columns; of many, each column is unpacked when a member of it is asked for first. */
saltus.unpackRows = ({$rows: count, columns}, numbers) => {
  const few = 1000;
  if (count <= few) {
    const rows = Array.from({length: count}, () => ({}));
    for (const [key, column] of Object.entries(columns)) {
      const values = saltus.unpackColumn(column, numbers);
      for (let i = 0; i < count; i += 1) rows[i][key] = values[i];
    }
    return rows;
  }
  const lists = {};
  const shape = {};
  for (const [key, column] of Object.entries(columns)) {
    saltus.lazily(lists, key, () => saltus.unpackColumn(column, numbers));
    Object.defineProperty(shape, key, {
      enumerable: true,
      get() {
        return lists[key][this.$row];
      },
    });
  }
  return Array.from({length: count}, (_, i) => {
    const row = Object.create(shape);
    row.$row = i;
    return row;
  });
};

/** What is known of a column without all of its values: the points that it is kept by, or the values themselves. */
saltus.packedColumn = (packed, numbers) => {
  // Short lists stay in the skeleton, where what is missing is null.
  const list = (part) => part.$n === undefined ? Float64Array.from(part, (value) => value ?? NaN) :
                                                 numbers.subarray(part.$n[0], part.$n[0] + part.$n[1]);
  if (packed.$points === undefined) return {places: null, values: list(packed)};
  const [places, values] = packed.$points.map(list);
  return {places, values, size: packed.size};
};

/** All values of a column that is kept by points: on the lines between them. */
saltus.onLines = ({places, values, size}, t) => {
  const all = new Array(size);
  const number = (value) => (Number.isFinite(value) ? value : null);
  for (let k = 0; k < places.length; k += 1) {
    const [from, to] = [places[k], places[k + 1] ?? places[k]];
    all[from] = number(values[k]);
    const slope = (values[k + 1] - values[k]) / (t[to] - t[from]);
    for (let i = from + 1; i < to; i += 1) {
      all[i] = t[i] === t[from] || values[k] === values[k + 1] ? all[from] : number(values[k] + slope * (t[i] - t[from]));
    }
  }
  return all;
};

/** Columns that are unpacked one by one, when they are asked for; until then `saltus.packedOf` knows them. */
saltus.packedOf = new WeakMap();
saltus.lazyColumns = (parts, numbers, times) => {
  const columns = new Array(parts.length);
  saltus.packedOf.set(columns, parts.map((part) => saltus.packedColumn(part, numbers)));
  parts.forEach((part, i) => saltus.lazily(columns, i, () => {
    const kept = saltus.packedOf.get(columns)[i];
    return kept.places === null ? saltus.unpack(part, numbers) : saltus.onLines(kept, times());
  }));
  return columns;
};

saltus.isPackedColumn = (part) => part !== null && typeof part === "object" &&
    (part.$n !== undefined || part.$points !== undefined);

/** @param times  of the rows, for columns that are kept by points */
saltus.unpack = (packed, numbers, times = () => null) => {
  if (packed === null || typeof packed !== "object") return packed;
  if (packed.$n !== undefined) {
    const [first, count] = packed.$n;
    const list = new Array(count);
    for (let i = 0; i < count; i += 1) list[i] = Number.isFinite(numbers[first + i]) ? numbers[first + i] : null;
    return list;
  }
  if (packed.$rows !== undefined) return saltus.unpackRows(packed, numbers);
  if (Array.isArray(packed)) {
    if (packed.length > 0 && packed.every(saltus.isPackedColumn)) return saltus.lazyColumns(packed, numbers, times);
    return packed.map((part) => saltus.unpack(part, numbers, times));
  }
  const unpacked = {};
  for (const [key, part] of Object.entries(packed)) unpacked[key] = saltus.unpack(part, numbers, () => unpacked.t);
  return unpacked;
};

/** The result of the page, and plotly brought to life: both lie deflated in it. */
saltus.readPage = () => {
  const text = (id) => document.getElementById(id).textContent;
  const {nonce} = document.currentScript;
  const script = document.createElement("script");
  script.nonce = nonce;
  script.textContent = new TextDecoder().decode(saltus.bytesOf(text("plotly")));
  document.head.append(script);
  return saltus.unpack(JSON.parse(text("result")), saltus.numbersOf(saltus.bytesOf(text("numbers"))));
};
