// Points and lines of a sweep over one parameter.
"use strict";

/** Faint lines through the runs of every group, with gaps where a run has no value: what lies between runs is not known. */
saltus.sweepLines = (table, frame, {x, rows, yOf, groupOf, colourOf}) => {
  const groups = Map.groupBy === undefined ? new Map() : Map.groupBy(rows, groupOf);
  if (Map.groupBy === undefined) rows.forEach((row) => groups.set(groupOf(row), [...(groups.get(groupOf(row)) ?? []), row]));
  return [...groups.values()].map((members) => {
    const along = [...members].sort((a, b) => table.at(x, a) - table.at(x, b));
    const path = along.map((row, k) => yOf(row) === null ?
            "" :
            `${k > 0 && yOf(along[k - 1]) !== null ? "L" : "M"}${frame.x(table.at(x, row))} ${frame.y(yOf(row))}`).join("");
    return saltus.svgElement("path", {d: path, fill: "none", stroke: colourOf(members[0]), "stroke-width": 1, "stroke-opacity": 0.4});
  });
};

/**
 * A picture of points.
 * @param plot  x: column, rows, yOf(row), colourOf(row), joined, groupOf(row); stopped: rows of runs that have no end;
 *              ends: [row, value] of runs that are drawn by their end
 */
saltus.pointsPicture = (table, title, width, plot, zoom, yName) => {
  const {x, rows, yOf, colourOf, joined, stopped = [], ends = []} = plot;
  const plain = rows.filter((row) => yOf(row) !== null);
  const across = saltus.partOfAxis(saltus.valueAxis(table.runRows.map((row) => table.at(x, row))), zoom?.[0]);
  const up = saltus.partOfAxis(saltus.valueAxis([...plain.map(yOf), ...ends.map(([, value]) => value)]), zoom?.[1]);
  const frame = saltus.pictureFrame(title, width, [table.axisOf(x), yName], [across, up]);
  const place = (row) => frame.x(table.at(x, row));
  if (joined) frame.inside.append(...saltus.sweepLines(table, frame, plot));
  const first = new Map(plain.map((row) => [table.columns.run[row], row]).reverse());
  const titled = plain.length <= saltus.mostTitles;
  for (const row of plain) {
    const label = titled ? `${saltus.sweepNumber(table.at(x, row))}: ${saltus.sweepNumber(yOf(row))}` : null;
    frame.inside.append(saltus.runMark(
        table, row, "circle", {cx: place(row), cy: frame.y(yOf(row)), r: joined ? 3 : 2.2, fill: colourOf(row), class: "run"}, label));
  }
  const {panel} = saltus.palette();
  for (const [row, value] of ends) {
    const [px, py] = [place(row), frame.y(value)];
    const look = {d: `M${px} ${py - 4}l4 4l-4 4l-4 -4z`, fill: panel, stroke: colourOf(row), "stroke-width": 1.4};
    const label = `${saltus.sweepNumber(table.at(x, row))}: ${saltus.sweepNumber(value)} at the end, without such events before it`;
    frame.inside.append(saltus.runMark(table, row, "path", {...look, class: "run end"}, label));
  }
  for (const row of first.values()) {
    if (table.isAlarming(row)) frame.inside.append(saltus.alarmMark(place(row), frame.y(yOf(row))));
  }
  const foot = frame.area.y + frame.area.height - 7;
  for (const row of stopped) frame.inside.append(saltus.stoppedMark(table, row, place(row), foot, saltus.sweepNumber(table.at(x, row))));
  return frame;
};
