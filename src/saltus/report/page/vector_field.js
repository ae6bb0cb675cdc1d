// The vector field of a model with two states: arrows of one length in the phase plane, which say where solutions go.
"use strict";

/** Lengths of arrows and of their heads, as parts of the drawing. */
saltus.arrowLength = 0.026;
saltus.arrowHead = 0.3;

/** One arrow as a polyline with its head, in the measure of the box: [x, y] of its points. */
saltus.arrowPath = ([x, y], [dx, dy], [width, height]) => {
  const length = Math.hypot(dx / width, dy / height);
  if (!(length > 0)) return [];
  const [ux, uy] = [dx / width / length, dy / height / length];
  const at = (along, across) =>
      [x + width * saltus.arrowLength * (along * ux - across * uy),
       y + height * saltus.arrowLength * (along * uy + across * ux)];
  const head = 1 - saltus.arrowHead;
  return [at(0, 0), at(1, 0), at(head, saltus.arrowHead / 2), at(1, 0), at(head, -saltus.arrowHead / 2)];
};

/** The field as traces of a plane with these axes; none for a model without one, or other axes. */
saltus.fieldTraces = (result, choice, view, palette, logs) => {
  const field = result.vector_field;
  if (field === null || logs.includes(true)) return [];
  const [first, second] = choice;
  if (first === second || Math.max(first, second) > 1) return [];
  const box = view.box.map(([from, to]) => to - from);
  const inOrder = (a, b) => (first === 0 ? [a, b] : [b, a]);
  const trace = ({x, y, dx, dy}, name, style) => {
    const points = x.flatMap((_, i) => [...saltus.arrowPath(inOrder(x[i], y[i]), inOrder(dx[i], dy[i]), box), [null, null]]);
    return {
      type: "scatter",
      mode: "lines",
      x: points.map((point) => point[0]),
      y: points.map((point) => point[1]),
      name,
      hoverinfo: "skip",
      showlegend: false,
      line: {simplify: false, ...style},
    };
  };
  return [
    trace(field.free, "field", {color: palette.axis, width: 0.8}),
    trace(field.sides, "field on both sides", {color: palette.mark, width: 1.1}),
    trace(field.sliding, "sliding field", {color: palette.sliding, width: 2}),
  ];
};
