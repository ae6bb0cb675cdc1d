// Plays a run: play and pause, a slider, the speed, again and again.
"use strict";

/** Seconds that playing all of a run should take. */
saltus.playSeconds = [3, 20];

/** The round number (1, 2, 5, 10, …) next to a positive one, on a logarithmic scale. */
saltus.roundNumber = (value) => {
  const power = 10 ** Math.floor(Math.log10(value));
  const steps = [1, 2, 5, 10].map((step) => step * power);
  const distance = (step) => Math.abs(Math.log(step / value));
  return Number(steps.reduce((best, step) => (distance(step) < distance(best) ? step : best)).toPrecision(1));
};

/** Units of time per second that one can choose, and the first one: 1, unless the run would be too short or too long. */
saltus.playSpeeds = (length) => {
  const [least, most] = saltus.playSeconds;
  const first = !(length > 0) || (length >= least && length <= most) ?
      1 :
      saltus.roundNumber(length < least ? length / least : length / most);
  const around = [0.1, 0.2, 0.5, 1, 2, 5, 10].map((factor) => saltus.roundNumber(first * factor));
  return {first, all: [...new Set([...around, 1])].sort((a, b) => a - b)};
};

saltus.speedPicker = ({first, all}, changed) => {
  const options = all.map((speed) => saltus.element(
      "option", {value: String(speed), ...(speed === first ? {selected: ""} : {})}, `${saltus.exact(speed)} ×`));
  const select = saltus.element(
      "select", {
        "aria-label": "speed",
        title: "units of the model's time per second",
        onchange: (event) => changed(Number(event.target.value)),
      },
      ...options);
  return saltus.element("label", {}, "speed ", select);
};

saltus.switchBox = (text, title, checked, changed) => saltus.element(
    "label", {class: "switch", title}, saltus.element("input", {
      type: "checkbox",
      onchange: (event) => changed(event.target.checked),
      ...(checked ? {checked: ""} : {}),
    }),
    text);

/** Time that goes on with the clock: from `time()` on, `speed()` units per second, to the end, or round and round. */
saltus.clock = ([from, to], time, set, stopped) => {
  const state = {speed: 1, loop: false};
  let frame = null;
  let last = 0;
  const step = (now) => {
    const next = time() + (Math.max(0, now - last) / 1000) * state.speed;
    last = now;
    const ended = next >= to;
    set(ended ? (state.loop ? from : to) : next);
    if (ended && !state.loop) return stop();
    frame = requestAnimationFrame(step);
    return frame;
  };
  const stop = () => {
    cancelAnimationFrame(frame);
    frame = null;
    stopped();
  };
  const start = () => {
    if (time() >= to) set(from);
    last = performance.now();
    frame = requestAnimationFrame(step);
  };
  return {state, start, stop, runs: () => frame !== null};
};

/**
 * Play and pause, the slider and its time, speed and loop.
 * @param show     called with the time after every change of it
 * @param playing  called with true and false where it begins and ends to play
 */
saltus.player = (trajectory, show, playing) => {
  const range = [trajectory.t[0], trajectory.t.at(-1)];
  const [from, to] = range;
  const steps = 1000;
  let time = from;
  const reading = saltus.element("span", {class: "digits slider-time"});
  const slider = saltus.element(
      "input", {type: "range", min: "0", max: String(steps), value: "0", class: "grow", "aria-label": "time",
                oninput: (event) => set(from + ((to - from) * Number(event.target.value)) / steps)});
  const set = (next) => {
    time = next;
    slider.value = String(Math.round((steps * (time - from)) / (to - from || 1)));
    reading.textContent = `t = ${saltus.brief(time, 5)}`;
    slider.setAttribute("aria-valuetext", reading.textContent);
    show(time);
  };
  const clock = saltus.clock(range, () => time, set, () => {
    button.textContent = "play";
    playing(false);
  });
  const play = () => {
    button.textContent = "pause";
    playing(true);
    clock.start();
  };
  const speeds = saltus.playSpeeds(to - from);
  clock.state.speed = speeds.first;
  const button = saltus.element("button", {onclick: () => (clock.runs() ? clock.stop() : play())}, "play");
  const element = saltus.element(
      "div", {class: "slider controls"}, button, slider, reading,
      saltus.speedPicker(speeds, (speed) => (clock.state.speed = speed)),
      saltus.switchBox("loop", "begin again at the end", false, (on) => (clock.state.loop = on)));
  return {element, set, time: () => time, speed: () => clock.state.speed, stop: () => clock.runs() && clock.stop()};
};
