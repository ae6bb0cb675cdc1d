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

/** One compressed block. The state of the reader is held in variables: this loop is most of the time of opening. */
saltus.inflateBlock = (input, reader, sink, [literals, distances]) => {
  let {at, held, count} = reader;
  let {bytes, size} = sink;
  const {base, bits} = saltus.inflateLengths;
  const far = saltus.inflateDistances;
  const fill = (wanted) => {
    while (count < wanted) {
      held |= (at < input.length ? input[at] : 0) << count;
      at += 1;
      count += 8;
    }
  };
  const take = (wanted) => {
    fill(wanted);
    const value = held & ((1 << wanted) - 1);
    held >>>= wanted;
    count -= wanted;
    return value;
  };
  for (;;) {
    if (count < 15) fill(15);
    const entry = literals.table[held & literals.mask];
    held >>>= entry & 15;
    count -= entry & 15;
    const symbol = entry >> 4;
    if (symbol === 256) break;
    if (size + 258 > bytes.length) {
      if (at > input.length + 4) throw new Error("the deflated numbers of this page are cut off");
      sink.size = size;
      sink.reserve(258);
      bytes = sink.bytes;
    }
    if (symbol < 256) {
      bytes[size] = symbol;
      size += 1;
      continue;
    }
    const length = base[symbol - 257] + take(bits[symbol - 257]);
    fill(15);
    const step = distances.table[held & distances.mask];
    held >>>= step & 15;
    count -= step & 15;
    const from = size - far.base[step >> 4] - take(far.bits[step >> 4]);
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

saltus.unpack = (packed, numbers) => {
  if (packed === null || typeof packed !== "object") return packed;
  if (packed.$n !== undefined) {
    const [first, count] = packed.$n;
    const list = new Array(count);
    for (let i = 0; i < count; i += 1) list[i] = Number.isFinite(numbers[first + i]) ? numbers[first + i] : null;
    return list;
  }
  if (packed.$rows !== undefined) {
    const rows = Array.from({length: packed.$rows}, () => ({}));
    for (const [key, column] of Object.entries(packed.columns)) {
      const values = saltus.unpackColumn(column, numbers);
      for (let i = 0; i < rows.length; i += 1) rows[i][key] = values[i];
    }
    return rows;
  }
  if (Array.isArray(packed)) return packed.map((part) => saltus.unpack(part, numbers));
  return Object.fromEntries(Object.entries(packed).map(([key, part]) => [key, saltus.unpack(part, numbers)]));
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
