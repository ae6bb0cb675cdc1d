// A sweep over two parameters as a map: a cell for every run.
"use strict";

/** @param plot  x, y: columns; valueOf(row): a number, a word, or null; colourOf(value) */
saltus.mapPicture = (table, title, width, {x, y, valueOf, colourOf, rows}, zoom) => {
  const across = saltus.partOfAxis(saltus.cellAxis(rows.map((row) => table.at(x, row))), zoom?.[0]);
  const up = saltus.partOfAxis(saltus.cellAxis(rows.map((row) => table.at(y, row))), zoom?.[1]);
  const frame = saltus.pictureFrame(title, width, [table.axisOf(x), table.axisOf(y)], [across, up]);
  const titled = rows.length <= saltus.mostTitles;
  const over = [];
  for (const row of rows) {
    const value = valueOf(row);
    const [left, right] = across.edgesOf(table.at(x, row)).map(frame.placeX);
    const [bottom, top] = up.edgesOf(table.at(y, row)).map(frame.placeY);
    const label = `${x} ${saltus.sweepNumber(table.at(x, row))}, ${y} ${saltus.sweepNumber(table.at(y, row))}: ${saltus.sweepNumber(value)}`;
    frame.inside.append(saltus.runMark(
        table, row, "rect",
        {x: left, y: top, width: right - left + 0.3, height: bottom - top + 0.3, fill: value === null ? "#999" : colourOf(value), class: "run", "shape-rendering": "crispEdges"},
        titled ? label : null));
    const middle = [(left + right) / 2, (bottom + top) / 2];
    if (!table.isDone(row)) over.push(saltus.stoppedMark(table, row, ...middle, label));
    if (table.isAlarming(row)) over.push(saltus.alarmMark(...middle));
  }
  frame.inside.append(...over);
  return frame;
};
