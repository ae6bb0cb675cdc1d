// Writes animated GIF: one palette for all frames, and of every frame what differs from the one before.
"use strict";

/** Red, green and blue with five bits each. */
saltus.coarseColour = (data, at) => ((data[at] >> 3) << 10) | ((data[at + 1] >> 3) << 5) | (data[at + 2] >> 3);

/** The most frequent colours of some pictures (RGBA), at most 255: number 255 is left for what does not change. */
saltus.gifPalette = (pictures) => {
  const sums = new Map();
  for (const data of pictures) {
    for (let at = 0; at < data.length; at += 4) {
      const key = saltus.coarseColour(data, at);
      let sum = sums.get(key);
      if (sum === undefined) sums.set(key, (sum = [0, 0, 0, 0]));
      for (let k = 0; k < 3; k += 1) sum[k] += data[at + k];
      sum[3] += 1;
    }
  }
  const frequent = [...sums.values()].sort((a, b) => b[3] - a[3]).slice(0, 255);
  return frequent.map((sum) => [0, 1, 2].map((k) => Math.round(sum[k] / sum[3])));
};

/** Numbers in the palette of the pixels of a picture; `known` keeps what was looked up. */
saltus.gifIndices = (data, palette, known) => {
  const nearest = (at) => {
    let [best, least] = [0, Infinity];
    palette.forEach((colour, i) => {
      const distance = [0, 1, 2].reduce((sum, k) => sum + (colour[k] - data[at + k]) ** 2, 0);
      if (distance < least) [best, least] = [i, distance];
    });
    return best;
  };
  const indices = new Uint8Array(data.length / 4);
  for (let i = 0; i < indices.length; i += 1) {
    const key = saltus.coarseColour(data, 4 * i);
    if (known[key] < 0) known[key] = nearest(4 * i);
    indices[i] = known[key];
  }
  return indices;
};

/** The rectangle in which two pictures differ, its pixels, 255 where they are equal. One pixel if they are. */
saltus.gifDifference = (before, after, width, height) => {
  let [left, right, top, bottom] = [width, -1, height, -1];
  for (let i = 0; i < after.length; i += 1) {
    if (before !== null && before[i] === after[i]) continue;
    const [x, y] = [i % width, Math.floor(i / width)];
    left = Math.min(left, x);
    right = Math.max(right, x);
    top = Math.min(top, y);
    bottom = Math.max(bottom, y);
  }
  if (right < 0) return {left: 0, top: 0, width: 1, height: 1, pixels: Uint8Array.of(255)};
  const box = {left, top, width: right - left + 1, height: bottom - top + 1};
  const pixels = new Uint8Array(box.width * box.height);
  for (let k = 0; k < pixels.length; k += 1) {
    const i = (top + Math.floor(k / box.width)) * width + left + (k % box.width);
    pixels[k] = before !== null && before[i] === after[i] ? 255 : after[i];
  }
  return {...box, pixels};
};

/** Codes of different lengths, packed into bytes from the lowest bit on. */
saltus.bitWriter = () => {
  const bytes = [];
  let [held, count] = [0, 0];
  const put = (code, bits) => {
    held |= code << count;
    count += bits;
    for (; count >= 8; count -= 8, held >>>= 8) bytes.push(held & 255);
  };
  return {put, finish: () => (count > 0 ? [...bytes, held & 255] : bytes)};
};

/** Pixels of eight bits in the compression of GIF: Lempel, Ziv and Welch with codes of up to twelve bits. */
saltus.gifCompressed = (pixels) => {
  const [clear, end, longest] = [256, 257, 12];
  const writer = saltus.bitWriter();
  // Of a string that ends with one pixel more: its code, 0 if it has none.
  const codes = new Uint16Array(4096 * 256);
  let used = [];
  let next = end + 1;
  let bits = 9;
  const forget = () => {
    for (const place of used) codes[place] = 0;
    used = [];
    next = end + 1;
    bits = 9;
  };
  writer.put(clear, bits);
  let string = pixels[0];
  for (let i = 1; i < pixels.length; i += 1) {
    const place = string * 256 + pixels[i];
    if (codes[place] !== 0) {
      string = codes[place];
      continue;
    }
    writer.put(string, bits);
    string = pixels[i];
    if (next < 1 << longest) {
      if (next === 1 << bits) bits += 1;
      codes[place] = next;
      used.push(place);
      next += 1;
    } else {
      writer.put(clear, bits);
      forget();
    }
  }
  writer.put(string, bits);
  // The reader has one string more by now, and may read a longer code.
  if (next === 1 << bits && bits < longest) bits += 1;
  writer.put(end, bits);
  return writer.finish();
};

/** An animation: `add(data)` for every frame (RGBA), then `file()`. It begins again at its end. */
saltus.gifFile = (width, height, palette, hundredths) => {
  const word = (value) => [value & 255, value >> 8];
  const colours = Array.from({length: 256}, (_, i) => palette[i] ?? [0, 0, 0]).flat();
  const text = (letters) => [...letters].map((letter) => letter.charCodeAt(0));
  const parts = [Uint8Array.from([
    ...text("GIF89a"), ...word(width), ...word(height), 0xf7, 0, 0, ...colours,
    0x21, 0xff, 11, ...text("NETSCAPE2.0"), 3, 1, 0, 0, 0,
  ])];
  const known = new Int16Array(1 << 15).fill(-1);
  let before = null;
  const add = (data) => {
    const after = saltus.gifIndices(data, palette, known);
    const {left, top, width: wide, height: tall, pixels} = saltus.gifDifference(before, after, width, height);
    before = after;
    // What a frame does not cover stays.
    const control = [0x21, 0xf9, 4, 0x05, ...word(hundredths), 255, 0];
    parts.push(Uint8Array.from([...control, 0x2c, ...[left, top, wide, tall].flatMap(word), 0, 8]));
    const bytes = Uint8Array.from(saltus.gifCompressed(pixels));
    for (let at = 0; at < bytes.length; at += 255) {
      const block = bytes.subarray(at, at + 255);
      parts.push(Uint8Array.of(block.length), block);
    }
    parts.push(Uint8Array.of(0));
  };
  return {add, file: () => new Blob([...parts, Uint8Array.of(0x3b)], {type: "image/gif"})};
};
