// Buttons that save the bodies: the picture as it is, and what they do as an animation.
"use strict";

/**
 * @param scene   its pictures, the range of time, `speed()`, `begin()` and `end()` around an export, `show(time)`
 * @return        buttons, and what says how far an animation is
 */
saltus.exportButtons = (result, scene) => {
  const progress = saltus.element("span", {class: "quiet", "aria-live": "polite"});
  let cancelled = false;
  const cancel = saltus.element("button", {hidden: "", onclick: () => (cancelled = true)}, "cancel");
  const still = saltus.element(
      "button", {
        class: "save",
        title: "save the picture as SVG",
        onclick: () => {
          const text = new XMLSerializer().serializeToString(scene.pictures[0]);
          saltus.saveText(saltus.fileName(result, "-bodies.svg"), text, "image/svg+xml");
        },
      },
      "SVG");
  const animation = (word, ending, title, make) => {
    const button = saltus.element("button", {class: "save", title, onclick: () => save()}, word);
    const save = async () => {
      const said = (share) => {
        progress.textContent = `${word}: ${Math.round(100 * share)} %`;
        return !cancelled;
      };
      cancelled = false;
      cancel.hidden = false;
      buttons.forEach((other) => (other.disabled = true));
      scene.begin();
      try {
        const file = await make(scene.pictures, scene.range, scene.speed(), scene.show, said);
        if (file !== null) saltus.saveBlob(saltus.fileName(result, ending), file);
        progress.textContent = "";
      } catch (error) {
        progress.textContent = `${word} could not be made: ${error.message}`;
      }
      scene.end();
      buttons.forEach((other) => (other.disabled = false));
      cancel.hidden = true;
    };
    return button;
  };
  const buttons = [
    animation("GIF", ".gif", "save the animation as GIF, with the speed that is chosen", saltus.gifOf),
    ...(saltus.videoType() === null ? [] : [animation(
        "WebM", ".webm", "record the animation as a video; it plays once while it is recorded", saltus.videoOf)]),
  ];
  return [progress, cancel, still, ...buttons];
};
