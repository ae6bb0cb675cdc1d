// Runs models beside the page, which stays alive and can end it. The engine's script stands in front of this one.
"use strict";

let engine = null;

const prepare = async (plotly) => {
  engine = await createSaltus({print: () => {}, printErr: () => {}});
  engine.FS.writeFile("/plotly.min.js", plotly);
  postMessage({ready: true});
};

const run = (model) => {
  const begin = performance.now();
  let told;
  try {
    told = JSON.parse(engine.ccall("saltus_simulate", "string", ["string", "string", "number"], [model, "", 1]));
  } catch (broken) {
    // Memory that ran out, for example: the engine is of no more use.
    told = {broken: String(broken)};
  }
  postMessage({told, seconds: (performance.now() - begin) / 1000});
};

onmessage = ({data}) => ("plotly" in data ? prepare(data.plotly) : run(data.model));
