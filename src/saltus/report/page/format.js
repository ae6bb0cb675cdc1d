// Text and elements. Everything that comes from the result enters the page as text, never as HTML.
"use strict";
const saltus = {};

/** An element with attributes (listeners as on…) and children; strings become text nodes. */
saltus.element = (tag, attributes = {}, ...children) => {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on"))
      element.addEventListener(name.slice(2), value);
    else if (value !== null && value !== undefined)
      element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
};

/** An element of a picture, with attributes and children. */
saltus.svgElement = (tag, attributes, ...children) => {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
};

/** All digits: reading the text gives the same double. */
saltus.exact = (value) => {
  if (value === undefined) return "–";
  if (value === null) return "not a number";
  return typeof value === "number" && value !== 0 && Math.abs(value) < 1e-3 ? value.toExponential() : String(value);
};

/** A selection or a weight: none where every one keeps the motion (sliding of higher order). */
saltus.selection = (value) => (value === null ? "not determined" : saltus.exact(value));

/** A number to look at, at most `digits` significant digits, without a tail of zeros. */
saltus.brief = (value, digits = 6) => {
  if (typeof value !== "number") return "–";
  if (Object.is(value, -0)) return "0";
  return saltus.exact(Number(value.toPrecision(digits)));
};

/** Times as a column: the same number of decimals for all, 12 significant digits for the largest. */
saltus.timeColumn = (times) => {
  const largest = times.reduce((most, t) => Math.max(most, Math.abs(t)), 0);
  const before = largest >= 1 ? Math.floor(Math.log10(largest)) + 1 : 1;
  const decimals = Math.max(3, 12 - before);
  return (t) => (largest < 1e9 && (largest > 1e-4 || largest === 0) ? t.toFixed(decimals) : saltus.exact(t));
};

saltus.modeSign = (mode) => ({"-1": "−", 0: "0", 1: "+"})[mode] ?? "·";
saltus.modeWord = (mode) => ({"-1": "ψ < 0", 0: "sliding", 1: "ψ > 0"})[mode] ?? "undetermined";
saltus.modeClass = (mode) => ({"-1": "mode-minus", 0: "mode-sliding", 1: "mode-plus"})[mode] ?? "mode-none";

/** Mode signs as small coloured boxes. */
saltus.modeBoxes = (mode) => {
  if (mode === null) return saltus.element("span", {class: "quiet"}, "none");
  const boxes = mode.map((k) => saltus.element("i", {class: `mode ${saltus.modeClass(k)}`}, saltus.modeSign(k)));
  return saltus.element("span", {class: "modes"}, ...boxes);
};

/** Words, the marker of plotly and a character that looks like it; a colour of its own for what is no switch. */
saltus.kinds = {
  start: {label: "start", symbol: "circle", sign: "●"},
  crossing: {label: "crossing", symbol: "line-ns-open", sign: "│"},
  enter_sliding: {label: "enter sliding", symbol: "triangle-down", sign: "▼"},
  leave_sliding: {label: "leave sliding", symbol: "triangle-up", sign: "▲"},
  change_sliding: {label: "change sliding", symbol: "diamond", sign: "◆"},
  accumulation: {label: "accumulation", symbol: "hourglass", sign: "⋈", look: "accumulation", planeSymbol: "hourglass"},
  jump: {label: "jump", symbol: "star", sign: "★", look: "jump", planeSymbol: "star"},
  user: {label: "user event", symbol: "square", sign: "■"},
  impact: {label: "impact", symbol: "star", sign: "✶", look: "jump", planeSymbol: "star"},
  contact: {label: "contact", symbol: "triangle-down", sign: "▽"},
  lift_off: {label: "lift-off", symbol: "triangle-up", sign: "△"},
  stick: {label: "stick", symbol: "square", sign: "■"},
  slip: {label: "slip", symbol: "diamond", sign: "◇"},
};
saltus.kindSign = (kind) => saltus.kinds[kind]?.sign ?? "";
saltus.kindLabel = (kind) => saltus.kinds[kind]?.label ?? kind;

saltus.shorten = (text, length) => (text.length <= length ? text : `${text.slice(0, length - 1)}…`);
saltus.count = (n, one, many = `${one}s`) => `${n.toLocaleString("en-US")} ${n === 1 ? one : many}`;

/** Text for plotly, which reads some tags and entities. */
saltus.plain = (text) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;").replaceAll(">", "&gt;");
