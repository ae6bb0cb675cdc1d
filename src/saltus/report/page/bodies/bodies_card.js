// The card of bodies and contacts: the bodies at a time that a player sets, their ghosts, phases of contacts.
"use strict";

/** What is not deeper than this is a rounding. */
saltus.roundingDepth = 1e-12;

saltus.bodiesNote = ({shapes, penetration}) => [
  ...(shapes.length > 0 ?
          ["Both axes have one scale. Ghosts: the bodies at equal distances in time, later ones darker; while it plays, those up to now."] :
          []),
  ...(penetration > saltus.roundingDepth ? [`Bodies are at most ${saltus.brief(penetration, 2)} deep in each other.`] : []),
].join(" ");

/** The card of a mechanical system; null if nothing is drawn and nothing touches. */
saltus.bodiesCard = (result, timeline) => {
  const {shapes, contacts, trajectory} = result;
  if (trajectory.t.length === 0 || (shapes.length === 0 && contacts.length === 0)) return null;
  const settings = {ghosts: true, trail: false, follow: false};
  const scene = shapes.length > 0 ? saltus.bodiesScene(result, settings) : null;
  const parts = [...(scene === null ? [] : [scene]), ...(contacts.length > 0 ? [saltus.contactStrip(result)] : [])];
  const holder = saltus.element("div", {class: "bodies-holder"}, ...parts.map((part) => part.element));
  const show = (time) => parts.forEach((part) => part.show(time));
  const redraw = () => parts.forEach((part) => part.draw(player.time(), Math.max(200, holder.clientWidth)));
  const trail = (on) => {
    settings.trail = on;
    show(player.time());
  };
  const player = saltus.player(trajectory, show, trail);
  const set = (name) => (on) => {
    settings[name] = on;
    redraw();
  };
  const switches = scene === null ? [] : [
    saltus.switchBox("ghosts", "the bodies at other times", true, set("ghosts")),
    ...(scene.follows ? [saltus.switchBox("follow", "the picture goes with what moves", false, set("follow"))] : []),
  ];
  const files = scene === null ? [] : saltus.exportButtons(result, {
    pictures: parts.map((part) => part.element),
    range: [trajectory.t[0], trajectory.t.at(-1)],
    speed: player.speed,
    show,
    begin: () => {
      player.stop();
      trail(true);
    },
    end: () => trail(false),
  });
  const element = saltus.element(
      "section", {class: "card bodies-card"},
      saltus.element(
          "header", {}, saltus.element("h2", {}, scene === null ? "Contacts" : "Bodies"), ...saltus.contactLegend(result),
          saltus.element("span", {class: "controls switches grow"}, ...switches), ...files),
      holder, player.element, saltus.element("p", {class: "quiet note"}, saltus.bodiesNote(result)));
  let flagged = null;
  const draw = () => {
    redraw();
    const selected = timeline().selected();
    if (selected !== null && selected !== flagged) player.set(result.events[selected].t);
    flagged = selected;
  };
  const start = () => {
    draw();
    player.set(player.time());
  };
  return {element, draw, start, isFirst: scene !== null};
};
