// What is shown, in the address behind its #, so that a link shows the same: t=0,40&c=0,1+2&plane=1,0&event=3&dark
"use strict";

/** The parts of the address; `set` writes one of them, null takes it away. */
saltus.address = () => {
  const parts = new Map(
      decodeURIComponent(window.location.hash.slice(1))
          .split("&")
          .filter((part) => part !== "")
          .map((part) => [part.split("=")[0], part.includes("=") ? part.slice(part.indexOf("=") + 1) : ""]));
  let pending = 0;
  const write = () => {
    const text = [...parts].map(([name, value]) => (value === "" ? name : `${name}=${value}`)).join("&");
    // Browsers refuse a page inside of another one, and too many changes at once; the drawing does not depend on it.
    try {
      window.history.replaceState(null, "", `#${text}`);
    } catch {
      parts.clear();
    }
  };
  return {
    get: (name) => parts.get(name) ?? null,
    set: (name, value) => {
      if (value === null)
        parts.delete(name);
      else
        parts.set(name, value);
      clearTimeout(pending);
      pending = setTimeout(write, 150);
    },
  };
};

/** A window of time from the address; null if it is none. */
saltus.windowFromText = (text) => {
  const window_ = (text ?? "").split(",").map(Number);
  return window_.length === 2 && window_[0] < window_[1] ? window_ : null;
};
