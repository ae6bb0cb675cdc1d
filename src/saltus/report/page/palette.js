// Colours: the style sheet owns them (light and dark), plotly gets copies.
"use strict";

saltus.palette = () => {
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  return {
    text: colour("text"),
    quiet: colour("quiet"),
    panel: colour("panel"),
    grid: colour("grid"),
    axis: colour("axis"),
    mark: colour("mark"),
    alarm: colour("alarm"),
    select: colour("select"),
    sliding: colour("sliding"),
    slidingShade: colour("sliding-shade"),
    minus: colour("minus"),
    plus: colour("plus"),
    simulated: colour("simulated"),
    jump: colour("jump"),
    accumulation: colour("accumulation"),
    surfaces: [1, 2, 3, 4, 5].map((i) => colour(`surface-${i}`)),
    curves: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map((i) => colour(`curve-${i}`)),
  };
};

saltus.currentTheme = () => document.documentElement.dataset.theme;

/** #dark or #light in the address, else what the system prefers. `changed` is called after every change. */
saltus.followTheme = (changed, address) => {
  const system = window.matchMedia("(prefers-color-scheme: dark)");
  const asked = /[#&](dark|light)\b/.exec(window.location.hash);
  const apply = (theme) => {
    document.documentElement.dataset.theme = theme;
    changed();
  };
  document.documentElement.dataset.theme = asked ? asked[1] : system.matches ? "dark" : "light";
  system.addEventListener("change", () => apply(system.matches ? "dark" : "light"));
  const toggle = () => {
    const [before, after] = saltus.currentTheme() === "dark" ? ["dark", "light"] : ["light", "dark"];
    address.set(before, null);
    address.set(after, "");
    apply(after);
  };
  return {apply, toggle};
};
