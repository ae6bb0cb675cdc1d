// The run that was chosen by a click, with the command that runs it alone.
"use strict";

saltus.runCard = (table, data) => {
  const title = saltus.element("h2", {});
  const said = saltus.element("p", {id: "chosen"});
  const values = saltus.element("div", {});
  const command = saltus.element("pre", {class: "source", id: "command", tabindex: "0", "aria-label": "command of this run"});
  const element = saltus.element(
      "aside", {class: "card run-card", "aria-live": "polite"}, title, said, values,
      saltus.element("p", {class: "quiet"}, "Computed alone, with its page:"), command);
  const own = table.values.filter((name) => table.columns.kind === undefined && !table.swept.includes(name));
  const show = (row) => {
    title.textContent = `Run ${table.columns.run[row]}`;
    said.textContent = saltus.runText(table, row);
    values.replaceChildren(saltus.element(
        "table", {class: "plain"},
        saltus.element("tbody", {}, ...own.slice(0, 30).map((name) => saltus.element(
            "tr", {}, saltus.element("td", {}, name), saltus.element("td", {class: "digits"}, saltus.sweepNumber(table.at(name, row))))))));
    command.textContent = saltus.runCommand(table, data, row);
  };
  return {element, show};
};
