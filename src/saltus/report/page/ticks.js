// Round numbers along an axis.
"use strict";

/** Round numbers within a range, at most `most` of them. */
saltus.roundTicks = ([from, to], most) => {
  const rough = (to - from) / Math.max(1, most);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * ([1, 2, 5, 10].find((factor) => factor * power >= rough) ?? 10);
  const ticks = [];
  // So close that numbers do not tell neighbours apart there are none.
  for (let k = Math.ceil(from / step - 1e-9); k * step <= to + 1e-9 * step && k + 1 > k; k += 1) ticks.push(k * step);
  return ticks.map((tick) => Number(tick.toPrecision(12)));
};

/** Whether a part of an axis is wide enough to be drawn: its ends are more than roundings apart. */
saltus.isDrawable = ([low, high]) => high - low > 1e-12 * Math.max(Math.abs(low), Math.abs(high));
