#!/usr/bin/env bash
# Makes .venv/plotly: plotly.js with the kinds of drawing that reports use (scatter, scatter3d, mesh3d, heatmap), a third
# of the whole library, and the licences of all that is in it. Needs npm and its registry; where they are not there,
# reports carry the whole library of PyPI's wheel.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

plotly=4.1.1
esbuild=0.28.2
day=2026-11-20  # packages that these need are taken as they were on this day

target=$PWD/.venv/plotly
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work"
echo '{"private": true}' > package.json
npm install --silent --ignore-scripts --no-audit --no-fund --before "$day" "plotly.js@$plotly" "esbuild@$esbuild"

cat > entry.js <<'JS'
const Plotly = require("plotly.js/lib/core");
Plotly.register([require("plotly.js/lib/scatter3d"), require("plotly.js/lib/mesh3d"), require("plotly.js/lib/heatmap")]);
module.exports = Plotly;
JS
banner="/* plotly.js v$plotly, scatter, scatter3d, mesh3d and heatmap only. Copyright Plotly, Inc. MIT licence; NOTICES.txt has all of them. */"
node_modules/.bin/esbuild entry.js --bundle --minify --format=iife --global-name=Plotly --target=es2018 --define:global=window \
  --legal-comments=none --banner:js="$banner" --outfile=plotly.min.js --metafile=meta.json --log-level=warning

# The licences of all packages of which something is in the bundle.
node - > NOTICES.txt <<'JS'
const fs = require("fs");
const [output] = Object.entries(JSON.parse(fs.readFileSync("meta.json")).outputs).find(([name]) => name.endsWith(".js")).slice(1);
const names = Object.entries(output.inputs).filter(([file, part]) => file.startsWith("node_modules/") && part.bytesInOutput > 0)
  .map(([file]) => /^node_modules\/((?:@[^/]+\/)?[^/]+)/.exec(file)[1]);
for (const name of [...new Set(names)].sort()) {
  const folder = `node_modules/${name}`;
  const {version, license} = JSON.parse(fs.readFileSync(`${folder}/package.json`));
  const file = fs.readdirSync(folder).find((entry) => /^licen[cs]e/i.test(entry));
  console.log(`== ${name} ${version} (${license})\n`);
  if (file !== undefined) console.log(`${fs.readFileSync(`${folder}/${file}`, "utf8").trim()}\n`);
}
JS
mkdir -p "$target"
cp NOTICES.txt plotly.min.js "$target"
