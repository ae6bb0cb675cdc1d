// The editor, the examples and what is told of a run.
"use strict";

const part = (id) => document.getElementById(id);
const text = (id) => part(id).textContent.replaceAll("<\\/script", "</script");
const models = JSON.parse(part("models").textContent);

let worker = null;
let shown = null;  // the address of the page of the last result
let result = null;  // its text
let begun = false;  // the first example runs by itself, what was stopped does not

const tell = (words, kind = "") => {
  part("status").textContent = words;
  part("status").className = kind;
};

/** Table or error below the editor. */
const say = (words) => {
  part("told").textContent = words;
  part("told").hidden = words === "";
};

const set_running = (running) => {
  part("run").disabled = running;
  part("stop").hidden = !running;
};

/** Puts the cursor where an error is. */
const go_to = (line, column) => {
  const lines = part("model").value.split("\n");
  if (!(line >= 1 && line <= lines.length)) return;
  const start = lines.slice(0, line - 1).reduce((sum, each) => sum + each.length + 1, 0);
  part("model").focus();
  part("model").setSelectionRange(start + Math.max(0, column - 1), start + lines[line - 1].length);
  part("model").scrollTop = (line - 4) * parseFloat(getComputedStyle(part("model")).lineHeight);
};

const show = (page) => {
  if (shown !== null) URL.revokeObjectURL(shown);
  result = page;
  shown = URL.createObjectURL(new Blob([page], {type: "text/html"}));
  part("page").src = shown;
  part("keep-page").disabled = false;
};

const take = ({ready, told, seconds}) => {
  set_running(false);
  if (ready) {
    tell("ready");
    if (begun) return;
    begun = true;
    return run();
  }
  if (told.broken !== undefined) {
    tell(`The run broke off: ${told.broken}`, "bad");
    return start();
  }
  if (told.error !== undefined) {
    tell("The model has a mistake.", "bad");
    say(told.error);
    return go_to(told.line, told.column);
  }
  tell(`done in ${seconds.toFixed(2)} s`, "good");
  say([...told.warnings.map((warning) => `warning: ${warning}`), told.table].join("\n"));
  show(told.page);
};

/** A worker with the engine. */
const start = () => {
  worker = new Worker(URL.createObjectURL(new Blob([text("engine"), "\n", text("worker")], {type: "text/javascript"})));
  worker.onmessage = ({data}) => take(data);
  worker.onerror = (event) => tell(`The engine did not start: ${event.message}`, "bad");
  worker.postMessage({plotly: text("plotly")});
};

const run = () => {
  if (part("run").disabled) return;
  set_running(true);
  tell("running…");
  worker.postMessage({model: part("model").value});
};

const stop = () => {
  worker.terminate();
  tell("stopped; the engine starts again", "bad");
  worker = null;
  set_running(false);
  part("run").disabled = true;
  start();
};

const save = (content, name, type) => {
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([content], {type}));
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
};

for (const {name} of models) part("examples").append(new Option(name));
const choose = () => { part("model").value = models[part("examples").selectedIndex].text; };
part("examples").onchange = () => {
  choose();
  run();
};
part("run").onclick = run;
part("stop").onclick = stop;
part("keep-model").onclick = () => save(part("model").value, `${part("examples").value}.toml`, "text/plain");
part("keep-page").onclick = () => save(result, `${part("examples").value}.html`, "text/html");
part("model").onkeydown = (event) => {
  if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) run();
};
choose();
start();
