// Charts: uPlot makes axes and the box in which the mouse selects; curves and all else are drawn by a brush, in one way
// for all, because load paths fold back and their x is not sorted.

import {button, element, numberText, say} from './dom.js';
import {colourNow, whenTold} from './theme.js';
import {axisRange, axisTicks, labelParts} from './axes.js';
import {Brush, chart_font, chart_text_size, curveSample, has_points} from './brush.js';

// How far from a point, px, the mouse still finds it.
const reach = 40;
const most_table_rows = 200;
// Print: width of a chart that has the page to itself, px, and how much finer than the screen it is drawn.
const print_width = 700;
const print_scale = 3;

// Text is measured on one canvas for all.
const ruler = document.createElement('canvas').getContext('2d');

function widestLabel(ticks) {
  ruler.font = `${chart_text_size}px ${chart_font}`;
  return Math.max(0, ...ticks.map((tick) => ruler.measureText(tick.label).width));
}

// Colours repeat where there are more curves than colours: the later ones are marked as repeated.
function withRepeats(curves) {
  const names = new Map();
  return curves.map((curve) => {
    const look = `${curve.colour} ${curve.style}`;
    if (!names.has(look)) names.set(look, curve.name);
    return {...curve, repeated: names.get(look) !== curve.name};
  });
}

/// One panel. The panels of a column that share x also share the range of x and the room for labels at the left.
class Chart {
  constructor(panel, index, events) {
    Object.assign(this, {
      panel: {...panel, curves: withRepeats(panel.curves)},
      events,
      shown: panel.curves.map(() => true),
      point: null,
      frame_shown: null,
      plot: null,
      toggles: [],
    });
    this.labels = {x: labelParts(panel.x_label), y: labelParts(panel.y_label)};
    this.log = {x: panel.log_x, y: panel.log_y};
    this.title =
      panel.title || [this.labels.y.name, events.x.name].filter((name) => name).join(' over ') || `Chart ${index + 1}`;
    this.box = element('div', {
      class: 'plot',
      tabindex: 0,
      role: 'group',
      keydown: (event) => this.key(event),
      'aria-label': `${this.title}. The arrow keys go along the curves.`,
    });
    this.tip = element('div', {class: 'tip', hidden: true, 'aria-hidden': 'true'});
    this.ring = element('div', {class: 'ring', hidden: true});
    this.line = element('div', {class: 'cursor-line', hidden: true});
    this.dot = element('div', {class: 'cursor-dot', hidden: true});
    this.reset = button('Show all', () => events.reset(this), {class: 'quiet'});
    this.reset.hidden = true;
    this.print = element('div', {class: 'print-only'});
    this.element = element(
      'figure',
      {class: 'chart'},
      panel.title ? element('figcaption', {}, panel.title) : null,
      element('div', {class: 'chart-top'}, element('span', {class: 'axis-label'}, panel.y_label), this.reset),
      this.box,
      this.print,
      panel.x_label ? element('div', {class: 'axis-label x'}, panel.x_label) : null,
      element('div', {class: 'chart-foot'}, this.legend(), this.table())
    );
    this.fitY();
  }

  get height() {
    return (this.panel.tall ? 360 : this.events.alone ? 260 : 180) + (this.panel.x_label ? 22 : 8);
  }

  *values(axis) {
    const {panel} = this;
    for (const [i, curve] of panel.curves.entries()) {
      if (this.shown[i]) yield* curve[axis];
    }
    for (const mark of panel.marks ?? []) yield mark[axis];
    const at = axis === 'x' ? 0 : 1;
    for (const arrow of panel.arrows ?? []) yield* [arrow.from[at], arrow.to[at]];
    if (axis === 'x') return;
    for (const level of panel.levels ?? []) yield level.y;
    for (const band of panel.bands ?? []) yield* [band.low, band.high];
  }

  get marked() {
    return (this.panel.marks ?? []).length > 0 || this.panel.curves.some((curve) => has_points.includes(curve.style));
  }

  fitY() {
    this.range = {x: this.range?.x ?? [0, 1], y: axisRange(this.values('y'), this.log.y, 0.06)};
    this.zoomed_y = false;
  }

  ticks(axis, width = this.width) {
    const most =
      axis === 'x'
        ? Math.max(2, Math.min(9, Math.floor(width / 85)))
        : Math.max(2, Math.floor(this.height / (this.log.y ? 32 : 38)));
    return axisTicks(this.range[axis], this.log[axis], most, axis === 'x' && this.events.isCounted());
  }

  get leftRoom() {
    return Math.ceil(widestLabel(this.ticks('y'))) + 12;
  }

  // The last label may stand at the very end of the axis.
  rightRoom(width) {
    return this.panel.x_label ? Math.max(14, Math.ceil(widestLabel(this.ticks('x', width)) / 2) + 4) : 14;
  }

  /// Draws into a box; `widthNow()` is its width at any time. `scale`: how much finer than usual, for print.
  makePlot(container, widthNow, scale = 1) {
    const axis = (name, side) => {
      const bare = name === 'x' && !this.panel.x_label;
      const stroke = () => colourNow('faint');
      return {
        scale: name,
        side,
        font: `${Math.round(chart_text_size * scale)}px ${chart_font}`,
        stroke: () => colourNow('dark'),
        gap: 4 * scale,
        size: () => scale * (name === 'y' ? this.events.leftRoom() : bare ? 6 : 24),
        // uPlot draws an axis only where it finds an increment of its own: this one fits every range.
        incrs: (u, i, low, high) => [Math.max(5, high - low)],
        splits: () => this.ticks(name, widthNow()).map((tick) => tick.at),
        filter: (_, splits) => splits,
        values: () => this.ticks(name, widthNow()).map((tick) => (bare ? '' : tick.label)),
        grid: {stroke: () => colourNow('grid'), width: scale},
        ticks: {stroke, width: scale, size: 4 * scale},
        border: {show: true, stroke, width: scale},
      };
    };
    const range = (name) => ({
      time: false,
      distr: this.log[name] ? 3 : 1,
      dir: name === 'x' && this.panel.x_falls ? -1 : 1,
      range: () => this.range[name],
    });
    // One series without points of its own stands for everything that is drawn.
    return new uPlot(
      {
        mode: 2,
        width: widthNow() * scale,
        height: this.height * scale,
        padding: [8 * scale, () => this.events.rightRoom(widthNow()) * scale, 2, 0],
        legend: {show: false},
        cursor: {
          x: false,
          y: false,
          points: {show: false},
          dataIdx: () => null,
          drag: {x: true, y: true, uni: 24, dist: 6, setScale: false},
          bind: {dblclick: () => () => this.events.reset(this)},
        },
        scales: {x: range('x'), y: range('y')},
        axes: [axis('x', 2), axis('y', 3)],
        series: [
          null,
          {
            facets: [
              {scale: 'x', auto: false},
              {scale: 'y', auto: false},
            ],
            paths: () => null,
          },
        ],
        hooks: {
          drawAxes: [(u) => new Brush(u, this, scale).background()],
          draw: [(u) => new Brush(u, this, scale).foreground(scale > 1)],
          setSelect: [(u) => this.select(u)],
          setScale: [() => this.placeCursor()],
        },
      },
      [null, [[0], [0]]],
      container
    );
  }

  /// Draws for the first time, or again in another width.
  layOut() {
    const width = Math.floor(this.box.clientWidth);
    if (width < 50) return;
    this.width = width;
    if (this.plot) {
      this.plot.batch(() => this.plot.setSize({width, height: this.height}));
      this.hide();
    } else {
      this.plot = this.makePlot(this.box, () => this.width);
      this.plot.over.append(this.line, this.dot, this.ring);
      this.box.append(this.tip);
      this.plot.over.addEventListener('mousemove', (event) => this.hover(event));
      this.plot.over.addEventListener('mouseleave', () => this.point || this.hide());
      this.plot.over.addEventListener('click', (event) => this.pick(event));
    }
    this.placeCursor();
  }

  redraw() {
    if (!this.plot) return;
    this.plot.batch(() => {
      const [[x0, x1], [y0, y1]] = [this.range.x, this.range.y];
      this.plot.setScale('x', {min: x0, max: x1});
      this.plot.setScale('y', {min: y0, max: y1});
      this.plot.redraw(false, true);
    });
    this.reset.hidden = !this.zoomed_y && !this.events.zoomedX();
    this.hide();
    this.placeCursor();
  }

  /// The place of a point of the chart in px of the plotting area.
  toPixels(x, y) {
    return [this.plot.valToPos(x, 'x'), this.plot.valToPos(y, 'y')];
  }

  select(u) {
    const {left, top, width, height} = u.select;
    if (width === 0 && height === 0) return;
    const sorted = (a, b) => (a < b ? [a, b] : [b, a]);
    const x = width >= u.over.clientWidth ? null : sorted(u.posToVal(left, 'x'), u.posToVal(left + width, 'x'));
    const y = height >= u.over.clientHeight ? null : sorted(u.posToVal(top + height, 'y'), u.posToVal(top, 'y'));
    u.setSelect({left: 0, top: 0, width: 0, height: 0}, false);
    if (y) {
      this.range.y = y;
      this.zoomed_y = true;
    }
    this.events.zoom(this, x);
  }

  curveIsDrawable(curve, i) {
    const [x, y] = [curve.x[i], curve.y[i]];
    return x !== null && y !== null && !(this.log.x && x <= 0) && !(this.log.y && y <= 0);
  }

  nearest(left, top) {
    let best = null,
      least = reach;
    this.panel.curves.forEach((curve, c) => {
      if (!this.shown[c]) return;
      for (let i = 0; i < curve.x.length; ++i) {
        if (!this.curveIsDrawable(curve, i)) continue;
        const [x, y] = this.toPixels(curve.x[i], curve.y[i]);
        const distance = Math.hypot(x - left, y - top);
        if (distance < least) {
          least = distance;
          best = {curve: c, i};
        }
      }
    });
    return best;
  }

  hover(event) {
    if (event.buttons !== 0) return;
    const area = this.plot.over.getBoundingClientRect();
    this.point = null;
    const found = this.nearest(event.clientX - area.left, event.clientY - area.top);
    if (found) this.readOut(found);
    else this.hide();
  }

  hide() {
    this.tip.hidden = this.ring.hidden = true;
  }

  pointText({curve, i}) {
    const {x, y, name} = this.panel.curves[curve];
    const value = (axis, number) => {
      const {name: label, unit} = axis === 'x' ? this.events.x : this.labels.y;
      return `${label ? `${label} ` : ''}${numberText(number)}${unit ? ` ${unit}` : ''}`;
    };
    return [name, value('x', x[i]), value('y', y[i])].filter((text) => text);
  }

  readOut(point) {
    const curve = this.panel.curves[point.curve];
    const [left, top] = this.toPixels(curve.x[point.i], curve.y[point.i]);
    const {offsetLeft, offsetTop, clientWidth, clientHeight} = this.plot.over;
    this.ring.hidden = left < -1 || top < -1 || left > clientWidth + 1 || top > clientHeight + 1;
    this.ring.style.transform = `translate(${left}px, ${top}px)`;
    this.tip.replaceChildren(...this.pointText(point).map((text) => element('div', {}, text)));
    this.tip.hidden = false;
    const x = left + offsetLeft;
    const {offsetWidth, offsetHeight} = this.tip;
    const beside = x + 14 + offsetWidth < this.width ? x + 14 : Math.max(0, x - 14 - offsetWidth);
    this.tip.style.left = `${beside}px`;
    const level = Math.min(top + offsetTop - offsetHeight / 2, clientHeight - offsetHeight + offsetTop);
    this.tip.style.top = `${Math.max(0, level)}px`;
  }

  /// Arrow keys go along a curve and to the next one; Enter moves the player to the frame there.
  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || !this.plot) return;
    const along = {ArrowLeft: -1, ArrowRight: 1, PageUp: -20, PageDown: 20, Home: -Infinity, End: Infinity};
    const across = {ArrowUp: -1, ArrowDown: 1};
    if (Object.hasOwn(along, event.key)) this.movePoint(along[event.key]);
    else if (Object.hasOwn(across, event.key)) this.moveAcross(across[event.key]);
    else if (event.key === 'Enter' && this.point) this.pickAt(...this.pointPixels());
    else if (event.key === '0') this.events.reset(this);
    else if (event.key === 'Escape') this.point = this.hide() ?? null;
    else return;
    event.preventDefault();
  }

  pointPixels() {
    const curve = this.panel.curves[this.point.curve];
    return this.toPixels(curve.x[this.point.i], curve.y[this.point.i]);
  }

  movePoint(step) {
    const first = this.shown.indexOf(true);
    if (first < 0) return;
    const c = this.point?.curve ?? first;
    const curve = this.panel.curves[c];
    const places = [...curve.x.keys()].filter((i) => this.curveIsDrawable(curve, i));
    if (places.length === 0) return;
    const at = this.point ? places.indexOf(this.point.i) + step : step > 0 ? 0 : places.length - 1;
    this.settle({curve: c, i: places[Math.max(0, Math.min(places.length - 1, at))]});
  }

  // To the point of the next curve that is nearest to the present one.
  moveAcross(step) {
    const visible = this.panel.curves.map((_, c) => c).filter((c) => this.shown[c]);
    if (visible.length === 0) return;
    if (!this.point) return this.movePoint(1);
    const next = visible[(visible.indexOf(this.point.curve) + step + visible.length) % visible.length];
    const [left, top] = this.pointPixels();
    const curve = this.panel.curves[next];
    let best = -1,
      least = Infinity;
    for (let i = 0; i < curve.x.length; ++i) {
      if (!this.curveIsDrawable(curve, i)) continue;
      const [x, y] = this.toPixels(curve.x[i], curve.y[i]);
      const distance = Math.hypot(x - left, 0.01 * (y - top));
      if (distance < least) [best, least] = [i, distance];
    }
    if (best >= 0) this.settle({curve: next, i: best});
  }

  settle(point) {
    this.point = point;
    this.readOut(point);
    say(this.pointText(point).join(', '));
  }

  pick(event) {
    const area = this.plot.over.getBoundingClientRect();
    this.pickAt(event.clientX - area.left, event.clientY - area.top);
  }

  // The frame whose cursor is nearest.
  pickAt(left, top) {
    const {cursor} = this.panel;
    if (!cursor) return;
    const upright = cursor.y.length === 0;
    let best = -1,
      least = Infinity;
    cursor.x.forEach((value, k) => {
      if (value === null || (!upright && cursor.y[k] === null)) return;
      const [x, y] = this.toPixels(value, upright ? this.range.y[0] : cursor.y[k]);
      const distance = upright ? Math.abs(x - left) : Math.hypot(x - left, y - top);
      if (distance < least) [best, least] = [k, distance];
    });
    if (best >= 0) this.events.onPick(best);
  }

  frame(k) {
    this.frame_shown = k;
    this.placeCursor();
  }

  /// The cursor's place in the chart: null without one.
  cursorPlace() {
    const {cursor} = this.panel;
    const x = cursor?.x[this.frame_shown ?? -1] ?? null;
    if (x === null) return null;
    if (cursor.y.length === 0) return {x, y: null};
    const y = cursor.y[this.frame_shown] ?? null;
    return y === null ? null : {x, y};
  }

  placeCursor() {
    if (!this.plot) return;
    const place = this.cursorPlace();
    const {clientWidth, clientHeight} = this.plot.over;
    const [left, top] = place ? this.toPixels(place.x, place.y ?? this.range.y[0]) : [-1, -1];
    const inside = place !== null && left >= -1 && left <= clientWidth + 1;
    this.line.hidden = !inside;
    this.dot.hidden = !inside || place.y === null || top < -1 || top > clientHeight + 1;
    this.line.classList.toggle('light', place?.y !== null);
    this.line.style.transform = `translateX(${left}px)`;
    this.dot.style.transform = `translate(${left}px, ${top}px)`;
  }

  legend() {
    const entry = (curve, i) => {
      const toggle = button(
        curveSample(curve),
        () => {
          this.shown[i] = !this.shown[i];
          toggle.setAttribute('aria-pressed', String(this.shown[i]));
          this.point = null;
          this.events.toggled(this);
        },
        {class: 'entry', 'aria-pressed': 'true', title: 'Hide or show this curve'}
      );
      toggle.append(curve.name);
      this.toggles[i] = toggle;
      return toggle;
    };
    const rest = [
      ...(this.panel.levels ?? []).map((level) => [level.name, 'level-sample']),
      ...(this.panel.bands ?? []).map((band) => [band.name, 'band-sample']),
    ];
    const entries = this.panel.curves.map((curve, i) => (curve.name ? entry(curve, i) : null));
    const others = rest.map(([name, sample]) =>
      name ? element('span', {class: 'entry'}, element('span', {class: sample}), name) : null
    );
    const all = [...entries, ...others].filter((one) => one !== null);
    return all.length > 0 ? element('div', {class: 'legend'}, ...all) : null;
  }

  /// Shows these curves alone, and marks the chart; null: all curves.
  showCurves(places) {
    const shown = this.shown.map((_, i) => places === null || places.includes(i));
    this.element.classList.toggle('asked-for', places !== null);
    if (shown.every((is, i) => is === this.shown[i])) return;
    this.shown = shown;
    shown.forEach((is, i) => this.toggles[i]?.setAttribute('aria-pressed', String(is)));
    this.point = null;
    this.events.toggled(this);
  }

  table() {
    const box = element('details', {class: 'chart-table'}, element('summary', {}, 'Show as table'));
    box.addEventListener('toggle', () => {
      if (box.open && box.childElementCount === 1) box.append(...this.tables());
    });
    return box;
  }

  // Curves with the same x share a table.
  tables() {
    const groups = [];
    for (const curve of this.panel.curves) {
      const same = groups.find(
        ([first]) => first.x.length === curve.x.length && first.x.every((x, i) => x === curve.x[i])
      );
      if (same) same.push(curve);
      else groups.push([curve]);
    }
    return groups.map((curves) => curveTable(curves, this.events.x_label, this.panel.y_label || this.title));
  }

  beforePrint(columns) {
    const width = Math.floor(print_width / columns);
    this.fine = this.makePlot(element('div'), () => width, print_scale / Math.max(1, uPlot.pxRatio));
    this.fine.batch(() => {});
    this.print.replaceChildren(this.fine.ctx.canvas);
  }

  afterPrint() {
    this.fine?.destroy();
    this.fine = null;
    this.print.replaceChildren();
  }
}

function curveTable(curves, x_label, y_label) {
  const {x} = curves[0];
  const step = Math.max(1, Math.ceil(x.length / most_table_rows));
  const places = [...x.keys()].filter((i) => i % step === 0);
  const heads = [x_label || 'x', ...curves.map((curve) => curve.name || y_label)];
  const rows = places.map((i) =>
    element(
      'tr',
      {},
      element('td', {class: 'right'}, numberText(x[i])),
      ...curves.map((curve) => element('td', {class: 'right'}, numberText(curve.y[i])))
    )
  );
  return element(
    'div',
    {class: 'scroll', tabindex: 0, role: 'group', 'aria-label': `Data of ${y_label}`},
    element(
      'table',
      {},
      step > 1 ? element('caption', {}, `${places.length} of ${x.length} points`) : null,
      element(
        'thead',
        {},
        element('tr', {}, ...heads.map((head) => element('th', {scope: 'col', class: 'right'}, head)))
      ),
      element('tbody', {}, ...rows)
    )
  );
}

// The panel whose label stands for the x axis of a panel: the first at or below it in its column that has one.
function labelledPanel(panels, i, columns) {
  let at = i;
  while (!panels[at].x_label && at + columns < panels.length) at += columns;
  return at;
}

/// The charts of a figure. `onPick(k)` is called when the reader asks for frame k; frame(k) moves the cursors.
export function chartsView(data, onPick = () => {}) {
  const columns = Math.max(1, data.columns ?? 1);
  const groups = new Map();
  const charts = data.panels.map((panel, i) => {
    const {x_label} = data.panels[labelledPanel(data.panels, i, columns)];
    const key = JSON.stringify([i % columns, panel.log_x, panel.x_falls, x_label]);
    if (!groups.has(key)) groups.set(key, new XGroup(x_label, onPick, data.panels.length === 1));
    return groups.get(key).add(panel, i);
  });
  for (const group of groups.values()) group.fitX();
  const grid = element('div', {class: 'charts'}, ...charts.map((chart) => chart.element));
  grid.style.setProperty('--columns', columns);
  new ResizeObserver(() => charts.forEach((chart) => chart.layOut())).observe(grid);
  whenTold(grid, {
    colours: () => charts.forEach((chart) => chart.plot?.redraw(false)),
    print: () => charts.forEach((chart) => chart.beforePrint(columns)),
    printed: () => charts.forEach((chart) => chart.afterPrint()),
  });
  return {element: grid, charts, frame: (k) => charts.forEach((chart) => chart.frame(k))};
}

// The panels of one column that share x: they zoom together, and their plotting areas begin at the same place.
class XGroup {
  constructor(x_label, onPick, alone) {
    Object.assign(this, {x_label, onPick, alone, x: labelParts(x_label), charts: [], zoomed: false});
  }

  add(panel, i) {
    const chart = new Chart(panel, i, this);
    this.charts.push(chart);
    return chart;
  }

  leftRoom() {
    return Math.max(...this.charts.map((chart) => chart.leftRoom));
  }

  rightRoom(width) {
    return Math.max(...this.charts.map((chart) => chart.rightRoom(width)));
  }

  zoomedX() {
    return this.zoomed;
  }

  /// Whether x counts something, such as lags or iterations: every x of all curves is a whole number.
  isCounted() {
    this.counted ??= this.charts.every(({panel}) =>
      panel.curves.every(({x}) => x.every((value) => value === null || Number.isInteger(value)))
    );
    return this.counted;
  }

  fitX() {
    const marked = this.charts.some((chart) => chart.marked);
    const values = this.charts.flatMap((chart) => [...chart.values('x')]);
    const range = axisRange(values, this.charts[0].log.x, marked ? 0.03 : 0);
    for (const chart of this.charts) chart.range.x = range;
    this.zoomed = false;
  }

  zoom(chart, x) {
    if (x) {
      for (const other of this.charts) other.range.x = x;
      this.zoomed = true;
    }
    this.redraw();
  }

  reset(chart) {
    this.fitX();
    chart.fitY();
    this.redraw();
  }

  toggled(chart) {
    if (!this.zoomed) this.fitX();
    if (!chart.zoomed_y) chart.fitY();
    this.redraw();
  }

  redraw() {
    for (const chart of this.charts) chart.redraw();
  }
}
