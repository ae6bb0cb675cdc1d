// Draws the table of a sweep: values over one parameter, a map over two, events, status, values at events.
"use strict";
const data = JSON.parse(document.getElementById("sweep").textContent);
const columns = data.columns;
const swept = data.swept;
// Label and unit of a column; what is no column says itself.
const axisOfColumn = (name) => data.axes[Object.keys(columns).indexOf(name)] || name;
const isNumber = (name) => columns[name].every((value) => value === null || typeof value === "number");
const numeric = Object.keys(columns).filter(isNumber);
const rows = columns.run.length;
const make = (tag, attributes = {}, text = "") => {
  const space = ["svg", "g", "line", "rect", "circle", "path", "text", "title"].includes(tag) ? "http://www.w3.org/2000/svg" : null;
  const element = space ? document.createElementNS(space, tag) : document.createElement(tag);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (text !== "") element.textContent = text;
  return element;
};
const shown = (value) => (value === null ? "nan" : typeof value === "number" ? String(Number(value.toPrecision(6))) : value);
const palette = ["#1f5fa8", "#d95f02", "#1b9e77", "#7570b3", "#e7298a", "#66a61e", "#a6761d"];

// Events and trajectories have several rows for a run: the last one of a trajectory is its end.
const rowOf = new Map();
columns.run.forEach((run, row) => {
  if (!columns.kind || !rowOf.has(run)) rowOf.set(run, row);
});
const runRows = [...rowOf.values()];
const eventsOf = (row) => columns.events?.[row] ?? null;
// Other solutions are admissible (older tables do not say it).
const isAlarming = (row) => columns.unique?.[row] === 0;
// Where a run stopped early is no end of it.
const isDone = (row) => ["completed", "stopped_by_event"].includes(columns.status[row]);
const ofDone = (of) => (row) => (isDone(row) ? of(row) : null);
const doubtOf = (row) => isAlarming(row) ? "; the solution is not unique, --branch all follows the others (but those of contacts)" : columns.unique?.[row] < 0 ? "; uniqueness not decided" : "";
const noteOf = (row) => (isDone(row) ? doubtOf(row) : `; ${columns.status[row]}`);
// Those of kept events; a run without one has a row that names none.
const eventRows = columns.kind ? columns.run.map((_, row) => row).filter((row) => columns.kind[row]) : [];
const allEvents = eventRows.length === runRows.reduce((sum, row) => sum + eventsOf(row), 0);

function commandOf(row) {
  const settings = swept.map((name, k) => `--set ${data.names[k]}=${columns[name][row] === null ? "nan" : columns[name][row]}`);
  return [data.command || "The shares do not say their model and its other settings. What was changed:", ...settings].join(" ");
}
function choose(row) {
  const parts = swept.map((name) => `${name} = ${shown(columns[name][row])}`);
  document.getElementById("chosen").textContent =
    `run ${columns.run[row]}: ${parts.join(", ")}; ${columns.status[row]}, ${eventsOf(row)} event${eventsOf(row) === 1 ? "" : "s"}${doubtOf(row)}`;
  document.getElementById("command").textContent = commandOf(row);
}

// Words on an axis stand at 0, 1, 2, …
function axisOf(values) {
  const words = values.some((value) => typeof value === "string");
  const labels = words ? [...new Set(values)] : null;
  const at = words ? (value) => labels.indexOf(value) : (value) => value;
  const finite = values.map(at).filter((value) => value !== null && Number.isFinite(value));
  let low = Math.min(...finite.slice(0, 1)), high = low;
  for (const value of finite) { low = Math.min(low, value); high = Math.max(high, value); }
  if (!finite.length) { low = 0; high = 1; }
  // Values that differ by rounding only are one value.
  if (high - low <= 1e-9 * Math.max(Math.abs(low), Math.abs(high))) {
    const half = Math.max(0.5, 1e-3 * Math.abs(low));
    low -= half;
    high += half;
  }
  const ticks = labels ? labels.map((label, k) => [k, label]) : ticksOf(low, high);
  return { at, low, high, ticks, words };
}
function ticksOf(low, high) {
  const raw = (high - low) / 5, power = 10 ** Math.floor(Math.log10(raw));
  const step = [1, 2, 5, 10].map((m) => m * power).find((candidate) => candidate >= raw);
  const ticks = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; ++k) ticks.push([k * step, shown(k * step)]);
  return ticks;
}

// Of a map: cells reach half-way to their neighbours, wherever the values lie and in whatever order they were given.
function cellsOf(values) {
  const axis = axisOf(values), places = [...new Set(values.map(axis.at))].filter(Number.isFinite).sort((a, b) => a - b);
  if (places.length < 2) return { ...axis, edgesOf: () => [axis.low, axis.high] };
  const edges = places.slice(1).map((place, k) => (place + places[k]) / 2), last = places.length - 1;
  edges.unshift(places[0] - (edges[0] - places[0]));
  edges.push(places[last] + (places[last] - edges[last]));
  const [low, high] = [edges[0], edges[last + 1]];
  const apart = places.slice(1).every((place, k) => place - places[k] > (high - low) / 8);
  const ticks = axis.words ? axis.ticks : apart ? places.map((place) => [place, shown(place)]) : ticksOf(low, high);
  return { ...axis, low, high, ticks, edgesOf: (value) => edges.slice(places.indexOf(axis.at(value))).slice(0, 2) };
}

const size = { width: 720, height: 320, left: 70, right: 20, top: 12, bottom: 46 };
function frame(title, xName, yName, xAxis, yAxis) {
  // Words need more room than numbers.
  size.left = Math.max(70, ...yAxis.ticks.map(([, label]) => 14 + 7.5 * String(label).length));
  const picture = make("svg", { viewBox: `0 0 ${size.width} ${size.height}`, role: "img", "aria-label": title });
  const x = (value) => size.left + ((xAxis.at(value) - xAxis.low) / (xAxis.high - xAxis.low)) * (size.width - size.left - size.right);
  const y = (value) => size.height - size.bottom - ((yAxis.at(value) - yAxis.low) / (yAxis.high - yAxis.low)) * (size.height - size.top - size.bottom);
  const bottom = size.height - size.bottom;
  picture.append(make("rect", { x: size.left, y: size.top, width: size.width - size.left - size.right, height: bottom - size.top, class: "frame" }));
  const place = (axis, value) => (axis.ticks === xAxis.ticks ? size.left + ((value - axis.low) / (axis.high - axis.low)) * (size.width - size.left - size.right)
    : bottom - ((value - axis.low) / (axis.high - axis.low)) * (bottom - size.top));
  for (const [value, label] of xAxis.ticks) picture.append(make("text", { x: place(xAxis, value), y: bottom + 16, "text-anchor": "middle" }, label));
  for (const [value, label] of yAxis.ticks) picture.append(make("text", { x: size.left - 6, y: place(yAxis, value) + 4, "text-anchor": "end" }, label));
  const name = make("text", { x: (size.left + size.width - size.right) / 2, y: size.height - 10, "text-anchor": "middle" }, axisOfColumn(xName));
  picture.append(name);
  // Words say themselves what they are.
  if (!yAxis.words) picture.append(make("text", { x: 14, y: size.height / 2, transform: `rotate(-90 14 ${size.height / 2})`, "text-anchor": "middle" }, axisOfColumn(yName)));
  return { picture, name, x, y };
}
function cross(picture, row, x, y) {
  if (isAlarming(row)) picture.append(make("path", { d: `M${x - 5} ${y - 5}l10 10m0 -10l-10 10`, class: "alarm" }));
}
// Of a run that stopped early, without a value.
function stopped(picture, row, x, y, label) {
  const sign = make("path", { d: `M${x - 4} ${y - 4}l8 8m0 -8l-8 8`, class: "run stopped", "data-run": columns.run[row] });
  sign.append(make("title", {}, label + noteOf(row)));
  sign.addEventListener("click", () => choose(row));
  picture.append(sign);
}
function mark(picture, row, x, y, colour, radius, label) {
  const dot = make("circle", { cx: x, cy: y, r: radius, fill: colour, class: "run", "data-run": columns.run[row] });
  dot.append(make("title", {}, label + noteOf(row)));
  dot.addEventListener("click", () => choose(row));
  picture.append(dot);
}

function points(title, xName, yName, chosen, yOf, joined, colourOf = () => palette[0]) {
  const plain = chosen.filter((row) => yOf(row) !== null);
  const drawn = frame(title, xName, yName, axisOf(runRows.map((row) => columns[xName][row])), axisOf(plain.map(yOf)));
  if (joined) {
    const along = [...chosen].sort((a, b) => columns[xName][a] - columns[xName][b]);
    const path = along.map((row, k) => yOf(row) === null ? "" :
      `${k && yOf(along[k - 1]) !== null ? "L" : "M"}${drawn.x(columns[xName][row])} ${drawn.y(yOf(row))}`).join("");
    drawn.picture.append(make("path", { d: path, fill: "none", stroke: palette[0] }));
  }
  const first = new Map(plain.map((row) => [columns.run[row], row]).reverse());
  for (const row of first.values()) cross(drawn.picture, row, drawn.x(columns[xName][row]), drawn.y(yOf(row)));
  for (const row of plain) mark(drawn.picture, row, drawn.x(columns[xName][row]), drawn.y(yOf(row)), colourOf(row), joined ? 3 : 2, `${shown(columns[xName][row])}: ${shown(yOf(row))}`);
  const foot = size.height - size.bottom - 7;
  for (const row of chosen) if (yOf(row) === null && !isDone(row)) stopped(drawn.picture, row, drawn.x(columns[xName][row]), foot, shown(columns[xName][row]));
  return drawn.picture;
}
const colourAt = (share) => `hsl(${240 - 200 * share} 60% ${30 + 40 * share}%)`;
const colourOfWord = (words, word) => palette[words.indexOf(word) % palette.length];
function legend(picture, words) {
  let x = size.width - size.right;
  for (const word of [...words].reverse()) {
    picture.append(make("text", { x, y: size.height - 10, "text-anchor": "end" }, word));
    x -= 8 + 6.5 * word.length;
    picture.append(make("rect", { x: x - 10, y: size.height - 19, width: 10, height: 10, fill: colourOfWord(words, word) }));
    x -= 24;
  }
}
function scaleBar(picture, low, high) {
  const bar = { x: size.width - size.right - 150, y: size.height - 18, width: 80, steps: 20 };
  for (let k = 0; k < bar.steps; ++k) {
    picture.append(make("rect", { x: bar.x + (k * bar.width) / bar.steps, y: bar.y, width: bar.width / bar.steps + 0.3, height: 8, fill: colourAt(k / (bar.steps - 1)) }));
  }
  picture.append(make("text", { x: bar.x - 4, y: bar.y + 8, "text-anchor": "end" }, shown(low)));
  picture.append(make("text", { x: bar.x + bar.width + 4, y: bar.y + 8 }, shown(high)));
}
// A cell for every run, of numbers or of `words`.
function map(title, xName, yName, valueOf, words = null) {
  const xs = [...new Set(runRows.map((row) => columns[xName][row]))], ys = [...new Set(runRows.map((row) => columns[yName][row]))];
  const [across, up] = [cellsOf(xs), cellsOf(ys)], drawn = frame(title, xName, yName, across, up);
  const share = (axis, place) => (place - axis.low) / (axis.high - axis.low);
  const values = runRows.map(valueOf).filter((value) => value !== null);
  const scale = axisOf(values);
  const width = size.width - size.left - size.right, height = size.height - size.top - size.bottom;
  let low = NaN, high = NaN;
  for (const row of runRows) {
    const value = valueOf(row), colour = words ? colourOfWord(words, value) : value === null ? "#999" : colourAt(share(scale, value));
    const [left, right] = across.edgesOf(columns[xName][row]).map((place) => size.left + width * share(across, place));
    const [bottom, top] = up.edgesOf(columns[yName][row]).map((place) => size.top + height * (1 - share(up, place)));
    const cell = make("rect", { x: left, y: top, width: right - left + 0.3, height: bottom - top + 0.3, fill: colour, class: "run", "data-run": columns.run[row] });
    low = value !== null && !(value >= low) ? value : low;
    high = value !== null && !(value <= high) ? value : high;
    cell.append(make("title", {}, `${xName} ${shown(columns[xName][row])}, ${yName} ${shown(columns[yName][row])}: ${shown(value)}${noteOf(row)}`));
    cell.addEventListener("click", () => choose(row));
    drawn.picture.append(cell);
    if (value === null && !isDone(row)) stopped(drawn.picture, row, (left + right) / 2, (bottom + top) / 2, "");
    cross(drawn.picture, row, (left + right) / 2, (bottom + top) / 2);
  }
  // On narrow screens the legend takes the middle.
  if (size.width < 500 || words) drawn.name.setAttribute("x", size.left);
  if (words) legend(drawn.picture, words);
  else scaleBar(drawn.picture, low, high);
  return drawn.picture;
}

function selector(label, options, value, onChange) {
  const box = make("label", {}, `${label} `), select = make("select");
  options.forEach((option) => select.append(make("option", { value: option }, option)));
  select.value = value;
  select.addEventListener("change", () => { onChange(select.value); draw(); });
  box.append(select);
  return box;
}

const values = numeric.filter((name) => !["run", "event", "events", "unique", ...swept].includes(name));
const kindOf = (row) => columns.name[row] || (columns.surfaces[row] ? `${columns.kind[row]} ${columns.surfaces[row]}` : columns.kind[row]);
// What the model calls an event comes first: at a switching surface its own value is a threshold.
const kinds = [...new Set([...eventRows.filter((row) => columns.name[row]), ...eventRows].map(kindOf))];
const rangeOf = (name, of) => {
  let low = Infinity, high = -Infinity;
  for (const row of of) {
    const value = columns[name][row];
    if (value === null) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return { span: Math.max(0, high - low), most: high < low ? 0 : Math.max(Math.abs(low), Math.abs(high)) };
};
// At a surface a value is its threshold in every run: the first one that varies nearly as much as any, for its size.
function variedValue() {
  const of = kinds.length ? eventRows.filter((row) => kindOf(row) === kinds[0]) : runRows;
  const names = values.filter((name) => name !== "t"), ranges = names.map((name) => rangeOf(name, of));
  // What is that small is rounding.
  const least = 1e-12 * ranges.reduce((most, range) => Math.max(most, range.most), 0);
  const scores = ranges.map(({ span, most }) => (most > least ? span / most : 0));
  const best = scores.reduce((most, score) => Math.max(most, score), 0);
  return names[scores.findIndex((score) => score >= best / 4)] || values[0];
}
const state = { value: variedValue(), x: swept[0], y: swept[1], kind: kinds[0], behind: -Infinity };

function section(title, picture) {
  const box = make("section"), save = make("button", { type: "button" }, "save as SVG");
  save.addEventListener("click", () => {
    const copy = picture.cloneNode(true), link = make("a");
    copy.setAttribute("xmlns", "http://www.w3.org/2000/svg");
    copy.prepend(make("style", {}, document.querySelector("style").textContent));
    link.href = URL.createObjectURL(new Blob([copy.outerHTML], { type: "image/svg+xml" }));
    link.download = `${title.replace(/[^\w-]+/g, "-")}.svg`;
    link.click();
  });
  box.append(make("h2", {}, title), picture, save);
  document.getElementById("pictures").append(box);
}
const roomFor = (pictures) => Math.max(340, Math.min(720, pictures.clientWidth));
function stops() {
  const count = runRows.filter((row) => !isDone(row)).length, runs = `${count} of ${runRows.length} runs`;
  if (count) document.getElementById("pictures").append(make("p", { role: "alert" }, `${runs} stopped early and ${count === 1 ? "has no end" : "have no ends"}: lines have gaps and crosses there.`));
}
function doubts() {
  const runs = runRows.filter(isAlarming);
  if (!runs.length) return;
  const box = make("p", { role: "alert" }, `The solution is not unique in ${runs.length} of ${runRows.length} runs, marked by a cross: `);
  for (const row of runs.slice(0, 8)) {
    const button = make("button", { type: "button" }, `run ${columns.run[row]}`);
    button.addEventListener("click", () => choose(row));
    box.append(button, " ");
  }
  if (runs.length > 8) box.append(`and ${runs.length - 8} more`);
  document.getElementById("pictures").append(box);
}
function draw() {
  const pictures = document.getElementById("pictures");
  // Letters keep their size on narrow screens.
  size.width = roomFor(pictures);
  pictures.replaceChildren();
  if (!rows || !swept.length) return;
  stops();
  doubts();
  const grid = swept.length === 2 && data.grid;
  // Random samples are no line.
  const joined = data.grid && swept.length === 1 && isNumber(state.x);
  const over = (name, of) => (grid ? map(name, state.x, state.y, ofDone(of)) : points(name, state.x, name, runRows, ofDone(of), joined));
  if (kinds.length) {
    const chosen = eventRows.filter((row) => kindOf(row) === state.kind && columns.t[row] > state.behind);
    const behind = state.behind > -Infinity ? ` behind t = ${shown(state.behind)}` : "";
    section(`${state.value} at every event "${state.kind}"${behind}`, points("bifurcation", state.x, state.value, chosen, (row) => columns[state.value][row], false));
    const counts = new Map();
    for (const row of chosen) counts.set(columns.run[row], (counts.get(columns.run[row]) ?? 0) + 1);
    if (allEvents) section(`number of events "${state.kind}"${behind}`, over("number", (row) => counts.get(columns.run[row]) ?? 0));
  } else if (!columns.kind) section(state.value, over(state.value, (row) => columns[state.value][row]));
  section("number of events", over("number", eventsOf));
  const statuses = [...new Set(columns.status)];
  const statusOf = (row) => columns.status[row];
  section("status", grid ? map("status", state.x, state.y, statusOf, statuses)
    : points("status", state.x, "status", runRows, statusOf, false, (row) => colourOfWord(statuses, statusOf(row))));
}
const controls = document.getElementById("controls");
if (values.length) controls.append(selector("value", values, state.value, (value) => (state.value = value)));
if (swept.length > 1) controls.append(selector("over", swept, state.x, (value) => { if (value === state.y) state.y = state.x; state.x = value; }));
if (kinds.length) controls.append(selector("event", kinds, state.kind, (value) => (state.kind = value)));
if (kinds.length) {
  const box = make("label", {}, "behind t "), input = make("input", { type: "number", step: "any", size: 6 });
  input.addEventListener("change", () => { state.behind = input.value === "" ? -Infinity : Number(input.value); draw(); });
  box.append(input);
  controls.append(box);
}
draw();
addEventListener("resize", () => { if (roomFor(document.getElementById("pictures")) !== size.width) draw(); });
if (rows) choose(0);
