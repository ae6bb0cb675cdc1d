// What was solved: the model's text, where it started, the call; and the data as a file.
"use strict";

saltus.saveText = (name, text, type) => saltus.saveBlob(name, new Blob([text], {type}));

saltus.saveBlob = (name, blob) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};

saltus.fileName = (result, ending) =>
    `${(result.model.name || "simulation").replaceAll(/[^A-Za-z0-9._-]+/g, "-")}${ending}`;

/** A field of a CSV file (RFC 4180). */
saltus.csvField = (value) => {
  const text = value === null || value === undefined ? "" : String(value);
  return /[",\r\n]/.test(text) ? `"${text.replaceAll("\"", "\"\"")}"` : text;
};

/** The rows of the page as CSV, with the columns of a result's own file. */
saltus.toCsv = (result) => {
  const {t, modes} = result.trajectory;
  const order = ["state", "input", "output", "alpha"];
  const columns = order.flatMap((sort) => saltus.columns(result).filter((column) => column.sort === sort));
  const named = ({name, sort}) => (sort === "alpha" ? `alpha(${name})` : name);
  const functions = result.switching_functions.slice(0, modes.length);
  const head = ["t", "side", ...columns.map(named), ...functions.map((name) => `mode(${name})`)];
  const modeOf = (band, row, side) => {
    // Before an event the mode is the one to the left of its edge.
    const at = saltus.lowerBound(band.edges, t[row]);
    const before = side === 0 && t[row + 1] === t[row];
    return band.values[Math.min(band.values.length - 1, Math.max(0, band.edges[at] === t[row] && !before ? at : at - 1))];
  };
  const rows = t.map((time, row) => {
    const side = row > 0 && t[row - 1] === time ? 1 : 0;
    return [
      time, side, ...columns.map(({values}) => values[row]), ...functions.map((_, i) => modeOf(modes[i], row, side))
    ];
  });
  return [head, ...rows].map((row) => row.map(saltus.csvField).join(",")).join("\r\n") + "\r\n";
};

saltus.textFold = (title, text) => saltus.element(
    "details", {}, saltus.element("summary", {}, title),
    saltus.element("pre", {class: "source", tabindex: "0", "aria-label": title}, text));

/** The equations as they were read; none where the result has none. */
saltus.equationTable = (result) => {
  const equations = result.model.equations ?? [];
  if (equations.length === 0) return [];
  const row = ([left, right, where]) => saltus.element(
      "tr", {}, saltus.element("th", {scope: "row"}, left), saltus.element("td", {}, `= ${right}`),
      saltus.element("td", {class: "quiet"}, where));
  return [saltus.element(
      "div", {class: "equations", tabindex: "0", role: "region", "aria-label": "equations"},
      saltus.element("table", {}, saltus.element("tbody", {}, ...equations.map(row))))];
};

/** The model file and the files it names; null where the result has none. */
saltus.modelCard = (result) => {
  const {text, file, files} = result.model;
  if (!text) return null;
  const name = (file || saltus.fileName(result, ".toml")).split("/").at(-1);
  const others = (files ?? []).map(
      (other) => other.text === null ?
          saltus.element("p", {class: "quiet"}, `${other.name}: not in the result, SHA-256 ${other.sha256}`) :
          saltus.textFold(other.name, other.text));
  return saltus.card(
      "Model", ...saltus.equationTable(result), saltus.textFold(/^<.*>$/.test(name) ? "the model as text" : name, text), ...others,
      saltus.element(
          "button", {title: "the model file as it was", onclick: () => saltus.saveText(name, text, "text/plain")},
          "save model"));
};

/** Where it started, and the call. */
saltus.startCard = (result) => {
  const {initial_state: initial = [], settings = []} = result.model;
  const call = result.command_line ?? "";
  if (initial.length === 0 && call === "") return null;
  const parts = [];
  if (initial.length > 0) parts.push(saltus.pairTable(initial.map(([name, value]) => saltus.captionedRow(result, name, value))));
  if (result.date) parts.push(saltus.element("p", {}, `Computed ${result.date.replace("T", " ").replace("Z", " UTC")}`));
  if (settings.length > 0) parts.push(saltus.element("p", {}, `Set: ${settings.join(", ")}`));
  if (call !== "") parts.push(saltus.element("pre", {class: "source", tabindex: "0", "aria-label": "command"}, call));
  return saltus.card("Start", ...parts);
};
