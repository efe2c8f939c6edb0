// Where the texts beside the marks of a chart stand: none over another, nor over a mark, where there is room.

const same_mark = 4;
const mark_radius = 3;
const beside_mark = 5;

const sharedLength = (from, to, other_from, other_to) =>
  Math.max(0, Math.min(to, other_to) - Math.max(from, other_from));
const boxOverlap = (a, b) => sharedLength(a.left, a.right, b.left, b.right) * sharedLength(a.top, a.bottom, b.top, b.bottom);
const areaOutside = (box, graph) => (box.right - box.left) * (box.bottom - box.top) - boxOverlap(box, graph);

// Marks in the same place have one text.
function joinedMarks(marks, unit) {
  const out = [];
  for (const mark of marks) {
    const there = out.find((other) => Math.hypot(mark.x - other.x, mark.y - other.y) < same_mark * unit);
    if (there) there.label += `, ${mark.label}`;
    else out.push({...mark});
  }
  return out;
}

// The best first: up, then down, at both sides; above and below; farther away.
function placesBeside({x, y}, width, height, unit) {
  const out = [];
  for (const rows of [0, 1, 2]) {
    const away = beside_mark * unit + rows * height;
    const middles = [
      [away + width / 2, -height / 2],
      [-away - width / 2, -height / 2],
      [away + width / 2, height / 2],
      [-away - width / 2, height / 2],
      [0, -away - height / 2],
      [0, away + height / 2],
      [away + width / 2, -away - height / 2],
      [-away - width / 2, away + height / 2],
    ];
    for (const [dx, dy] of middles) {
      out.push({
        left: x + dx - width / 2,
        right: x + dx + width / 2,
        top: y + dy - height / 2,
        bottom: y + dy + height / 2,
      });
    }
  }
  return out;
}

/// Texts with their boxes, of marks in px of a canvas on which `unit` px are one of the screen.
export function markLabels(marks, graph, widthOf, height, unit) {
  const own = joinedMarks(marks, unit);
  const around = mark_radius * unit;
  const taken = own.map(({x, y}) => ({left: x - around, right: x + around, top: y - around, bottom: y + around}));
  return own.map((mark) => {
    const cost = (box) => taken.reduce((sum, other) => sum + boxOverlap(box, other), areaOutside(box, graph));
    const places = placesBeside(mark, widthOf(mark.label), height, unit);
    const costs = places.map(cost);
    const least = Math.min(...costs);
    const box = places[costs.findIndex((value) => value <= least + 1e-9)];
    taken.push(box);
    return {label: mark.label, box};
  });
}
