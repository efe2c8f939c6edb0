// Charts: uPlot makes axes and the box in which the mouse selects; curves and all else are drawn here, in one way for
// all, because load paths fold back and their x is not sorted.

import { button, element, numberText, say, svgElement } from './dom.js';
import { colourNow, whenTold } from './theme.js';
import { axisRange, axisTicks, labelParts, minorPlaces } from './axes.js';

const font = "system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, 'DejaVu Sans', sans-serif";
const text_size = 12;
// How far from a point, px, the mouse still finds it.
const reach = 40;
const most_table_rows = 200;
// Print: width of a chart that has the page to itself, px, and how much finer than the screen it is drawn.
const print_width = 700;
const print_scale = 3;
const dashes = new Map([['dashed', [7, 5]], ['dotted', [1.5, 5]]]);
const has_points = ['points', 'crosses', 'marked'];

// Text is measured on one canvas for all.
const ruler = document.createElement('canvas').getContext('2d');

function widestLabel(ticks) {
  ruler.font = `${text_size}px ${font}`;
  return Math.max(0, ...ticks.map((tick) => ruler.measureText(tick.label).width));
}

/// One panel. The panels of a column that share x also share the range of x and the room for labels at the left.
class Chart {
  constructor(panel, index, events) {
    Object.assign(this, {panel, events, shown: panel.curves.map(() => true), point: null, frame_shown: null, plot: null});
    this.labels = {x: labelParts(panel.x_label), y: labelParts(panel.y_label)};
    this.log = {x: panel.log_x, y: panel.log_y};
    this.title = panel.title || [this.labels.y.name, events.x.name].filter((name) => name).join(' over ') ||
      `Chart ${index + 1}`;
    this.box = element('div', {class: 'plot', tabindex: 0, role: 'group', keydown: (event) => this.key(event),
      'aria-label': `${this.title}. The arrow keys go along the curves.`});
    this.tip = element('div', {class: 'tip', hidden: true, 'aria-hidden': 'true'});
    this.ring = element('div', {class: 'ring', hidden: true});
    this.line = element('div', {class: 'cursor-line', hidden: true});
    this.dot = element('div', {class: 'cursor-dot', hidden: true});
    this.reset = button('Show all', () => events.reset(this), {class: 'quiet'});
    this.reset.hidden = true;
    this.print = element('div', {class: 'print-only'});
    this.element = element('figure', {class: 'chart'},
      panel.title ? element('figcaption', {}, panel.title) : null,
      element('div', {class: 'chart-top'}, element('span', {class: 'axis-label'}, panel.y_label), this.reset),
      this.box, this.print, panel.x_label ? element('div', {class: 'axis-label x'}, panel.x_label) : null,
      element('div', {class: 'chart-foot'}, this.legend(), this.table()));
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
    const most = axis === 'x' ? Math.max(2, Math.min(9, Math.floor(width / 85))) :
      Math.max(2, Math.floor(this.height / 42));
    return axisTicks(this.range[axis], this.log[axis], most);
  }

  get leftRoom() {
    return Math.ceil(widestLabel(this.ticks('y'))) + 12;
  }

  /// Draws into a box of a width. `scale`: how much finer than usual, for print.
  makePlot(container, width, scale = 1) {
    const axis = (name, side) => {
      const bare = name === 'x' && !this.panel.x_label;
      const stroke = () => colourNow('faint');
      return {
        scale: name, side, font: `${Math.round(text_size * scale)}px ${font}`, stroke: () => colourNow('dark'), gap: 4 * scale,
        size: () => scale * (name === 'y' ? this.events.leftRoom() : bare ? 6 : 24),
        splits: () => this.ticks(name, width).map((tick) => tick.at),
        filter: (_, splits) => splits,
        values: () => this.ticks(name, width).map((tick) => bare ? '' : tick.label),
        grid: {stroke: () => colourNow('grid'), width: scale}, ticks: {stroke, width: scale, size: 4 * scale},
        border: {show: true, stroke, width: scale},
      };
    };
    const range = (name) => ({time: false, distr: this.log[name] ? 3 : 1, dir: name === 'x' && this.panel.x_falls ? -1 : 1,
      range: () => this.range[name]});
    // One series without points of its own stands for everything that is drawn.
    return new uPlot({
      mode: 2, width: width * scale, height: this.height * scale, padding: [8 * scale, 14 * scale, 2, 0],
      legend: {show: false},
      cursor: {x: false, y: false, points: {show: false}, dataIdx: () => null,
        drag: {x: true, y: true, uni: 24, dist: 6, setScale: false}, bind: {dblclick: () => () => this.events.reset(this)}},
      scales: {x: range('x'), y: range('y')},
      axes: [axis('x', 2), axis('y', 3)],
      series: [null, {facets: [{scale: 'x', auto: false}, {scale: 'y', auto: false}], paths: () => null}],
      hooks: {
        drawAxes: [(u) => new Brush(u, this, scale).background()],
        draw: [(u) => new Brush(u, this, scale).foreground(scale > 1)],
        setSelect: [(u) => this.select(u)],
        setScale: [() => this.placeCursor()],
      },
    }, [null, [[0], [0]]], container);
  }

  /// Draws for the first time, or again in another width.
  layOut() {
    const width = Math.floor(this.box.clientWidth);
    if (width < 50) return;
    this.width = width;
    if (this.plot) {
      this.plot.setSize({width, height: this.height});
    } else {
      this.plot = this.makePlot(this.box, width);
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
    const sorted = (a, b) => a < b ? [a, b] : [b, a];
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
    let best = null, least = reach;
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
    this.tip.style.top = `${Math.max(0, Math.min(top + offsetTop - offsetHeight / 2, clientHeight - offsetHeight + offsetTop))}px`;
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
    let best = -1, least = Infinity;
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
    let best = -1, least = Infinity;
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
      const toggle = button(curveSample(curve), () => {
        this.shown[i] = !this.shown[i];
        toggle.setAttribute('aria-pressed', String(this.shown[i]));
        this.point = null;
        this.events.toggled(this);
      }, {class: 'entry', 'aria-pressed': 'true', title: 'Hide or show this curve'});
      toggle.append(curve.name);
      return toggle;
    };
    const rest = [...(this.panel.levels ?? []).map((level) => [level.name, 'level-sample']),
      ...(this.panel.bands ?? []).map((band) => [band.name, 'band-sample'])];
    const entries = this.panel.curves.map((curve, i) => curve.name ? entry(curve, i) : null);
    const others = rest.map(([name, sample]) =>
      name ? element('span', {class: 'entry'}, element('span', {class: sample}), name) : null);
    const all = [...entries, ...others].filter((one) => one !== null);
    return all.length > 0 ? element('div', {class: 'legend'}, ...all) : null;
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
      const same = groups.find(([first]) => first.x.length === curve.x.length && first.x.every((x, i) => x === curve.x[i]));
      if (same) same.push(curve);
      else groups.push([curve]);
    }
    return groups.map((curves) => curveTable(curves, this.events.x_label, this.panel.y_label || this.title));
  }

  beforePrint(columns) {
    const width = Math.floor(print_width / columns);
    this.fine = this.makePlot(element('div'), width, print_scale / Math.max(1, uPlot.pxRatio));
    this.fine.batch(() => {});
    this.print.replaceChildren(this.fine.ctx.canvas);
  }

  afterPrint() {
    this.fine?.destroy();
    this.fine = null;
    this.print.replaceChildren();
  }
}

// Draws in the plotting area of a uPlot.
class Brush {
  constructor(u, chart, scale) {
    this.unit = scale * uPlot.pxRatio;
    Object.assign(this, {ctx: u.ctx, area: u.bbox, chart, x: this.mapping(u, 'x', chart), y: this.mapping(u, 'y', chart)});
  }

  mapping(u, name, chart) {
    const {left, top, width, height} = u.bbox;
    const log = chart.log[name];
    const [low, high] = chart.range[name].map((value) => log ? Math.log10(value) : value);
    const falls = name === 'x' ? chart.panel.x_falls : true;
    const [from, length] = name === 'x' ? [left, width] : [top, height];
    const slope = (falls ? -1 : 1) * length / (high - low);
    const base = (falls ? from + length : from) - slope * low;
    return log ? (value) => value > 0 ? base + slope * Math.log10(value) : NaN :
      (value) => value === null ? NaN : base + slope * value;
  }

  // Within the plotting area and `rim` px around it, so that points at its edge are seen whole.
  clipped(rim, action) {
    const {ctx, area} = this;
    const more = rim * this.unit;
    ctx.save();
    ctx.beginPath();
    ctx.rect(area.left - more, area.top - more, area.width + 2 * more, area.height + 2 * more);
    ctx.clip();
    ctx.lineCap = ctx.lineJoin = 'round';
    action();
    ctx.restore();
  }

  background() {
    const {ctx, area, chart} = this;
    this.clipped(0, () => {
      ctx.fillStyle = colourNow('band');
      for (const band of chart.panel.bands ?? []) {
        const [low, high] = [this.y(band.low), this.y(band.high)];
        const top = Number.isNaN(high) ? area.top : high;
        const bottom = Number.isNaN(low) ? area.top + area.height : low;
        ctx.fillRect(area.left, top, area.width, bottom - top);
      }
      this.pen('grid', 0.6, []);
      if (chart.log.x) for (const x of minorPlaces(chart.range.x)) this.upright(this.x(x));
      if (chart.log.y) for (const y of minorPlaces(chart.range.y)) this.level(this.y(y));
      this.pen('faint', 0.8, []);
      if (!chart.log.y && chart.range.y[0] < 0 && chart.range.y[1] > 0) this.level(this.y(0));
    });
  }

  foreground(with_cursor) {
    this.clipped(3, () => {
      const {panel, shown} = this.chart;
      this.pen('dark', 1, [6, 4]);
      for (const level of panel.levels ?? []) this.level(this.y(level.y));
      panel.curves.forEach((curve, i) => shown[i] && this.curve(curve));
      for (const arrow of panel.arrows ?? []) this.arrow(arrow);
      if (with_cursor) this.cursor();
    });
    // uPlot remembers what it set on the canvas: all else is put back.
    this.ctx.save();
    for (const mark of this.chart.panel.marks ?? []) this.mark(mark);
    this.ctx.restore();
  }

  pen(colour, width, dash) {
    this.ctx.strokeStyle = this.ctx.fillStyle = colourNow(colour);
    this.ctx.lineWidth = width * this.unit;
    this.ctx.setLineDash(dash.map((length) => length * this.unit));
  }

  segment(x0, y0, x1, y1) {
    this.ctx.beginPath();
    this.ctx.moveTo(x0, y0);
    this.ctx.lineTo(x1, y1);
    this.ctx.stroke();
  }

  level(y) {
    this.segment(this.area.left, y, this.area.left + this.area.width, y);
  }

  upright(x) {
    this.segment(x, this.area.top, x, this.area.top + this.area.height);
  }

  curve(curve) {
    const {style} = curve;
    this.pen(curve.colour, style === 'dotted' ? 2 : 1.7, dashes.get(style) ?? []);
    if (!['points', 'crosses'].includes(style)) this.path(curve);
    if (has_points.includes(style)) this.points(curve, style);
  }

  path({x, y}) {
    const {ctx} = this;
    ctx.beginPath();
    let open = false;
    for (let i = 0; i < x.length; ++i) {
      const [px, py] = [this.x(x[i]), this.y(y[i])];
      const known = px === px && py === py;
      if (known && !open) ctx.moveTo(px, py);
      // Also where a line begins: the round ends show a point between two gaps.
      if (known) ctx.lineTo(px, py);
      open = known;
    }
    ctx.stroke();
  }

  points({x, y}, style) {
    const {ctx, unit} = this;
    const r = (style === 'crosses' ? 4 : style === 'marked' ? 3 : x.length > 300 ? 1.5 : 2.5) * unit;
    ctx.setLineDash([]);
    ctx.beginPath();
    for (let i = 0; i < x.length; ++i) {
      const [px, py] = [this.x(x[i]), this.y(y[i])];
      if (px !== px || py !== py) continue;
      if (style === 'crosses') {
        ctx.moveTo(px - r, py - r);
        ctx.lineTo(px + r, py + r);
        ctx.moveTo(px - r, py + r);
        ctx.lineTo(px + r, py - r);
      } else {
        ctx.moveTo(px + r, py);
        ctx.arc(px, py, r, 0, 2 * Math.PI);
      }
    }
    if (style === 'crosses') ctx.stroke();
    else ctx.fill();
  }

  arrow({from, to}) {
    const {ctx, unit} = this;
    const [x0, y0, x1, y1] = [this.x(from[0]), this.y(from[1]), this.x(to[0]), this.y(to[1])];
    const turn = Math.atan2(y1 - y0, x1 - x0);
    this.pen('dark', 1.2, [4, 4]);
    this.segment(x0, y0, x1, y1);
    ctx.setLineDash([]);
    ctx.beginPath();
    ctx.moveTo(x1, y1);
    for (const side of [-0.4, 0.4]) ctx.lineTo(x1 - 9 * unit * Math.cos(turn + side), y1 - 9 * unit * Math.sin(turn + side));
    ctx.closePath();
    ctx.fill();
  }

  // A dot with its label above; at the right end of the chart the label is to its left.
  mark({x, y, label}) {
    const {ctx, unit, area} = this;
    const [px, py] = [this.x(x), this.y(y)];
    const inside = px >= area.left - 1 && px <= area.left + area.width + 1 && py >= area.top - 1 &&
      py <= area.top + area.height + 1;
    if (!inside) return;
    this.pen('dark', 1.4, []);
    ctx.beginPath();
    ctx.arc(px, py, 3.4 * unit, 0, 2 * Math.PI);
    ctx.fill();
    ctx.font = `bold ${text_size * unit}px ${font}`;
    ctx.textAlign = px > area.left + area.width - 20 * unit ? 'right' : 'left';
    ctx.textBaseline = py < area.top + 20 * unit ? 'top' : 'bottom';
    const place = [px + (ctx.textAlign === 'left' ? 5 : -5) * unit, py + (ctx.textBaseline === 'top' ? 4 : -3) * unit];
    ctx.strokeStyle = colourNow('paper');
    ctx.lineWidth = 3 * unit;
    ctx.lineJoin = 'round';
    ctx.strokeText(label, ...place);
    ctx.fillText(label, ...place);
  }

  cursor() {
    const place = this.chart.cursorPlace();
    if (!place) return;
    this.pen('dark', 1, []);
    this.upright(this.x(place.x));
    if (place.y === null) return;
    this.ctx.beginPath();
    this.ctx.arc(this.x(place.x), this.y(place.y), 5 * this.unit, 0, 2 * Math.PI);
    this.ctx.fill();
  }
}

function curveSample({style, colour}) {
  const name = /^[a-z0-9-]+$/.test(colour) ? `var(--c-${colour})` : 'currentColor';
  const sample = svgElement('svg', {class: 'sample', viewBox: '0 0 28 12', 'aria-hidden': 'true'});
  if (!['points', 'crosses'].includes(style)) {
    sample.append(svgElement('path', {d: 'M2 6h24', stroke: name, 'stroke-width': 2.4, 'stroke-linecap': 'round',
      'stroke-dasharray': dashes.get(style)?.join(' ') ?? 'none'}));
  }
  if (style === 'crosses') sample.append(svgElement('path', {d: 'M10 2l8 8M18 2l-8 8', stroke: name, 'stroke-width': 2}));
  else if (has_points.includes(style)) sample.append(svgElement('circle', {cx: 14, cy: 6, r: 3.2, fill: name}));
  return sample;
}

function curveTable(curves, x_label, y_label) {
  const {x} = curves[0];
  const step = Math.max(1, Math.ceil(x.length / most_table_rows));
  const places = [...x.keys()].filter((i) => i % step === 0);
  const heads = [x_label || 'x', ...curves.map((curve) => curve.name || y_label)];
  const rows = places.map((i) => element('tr', {}, element('td', {class: 'right'}, numberText(x[i])),
    ...curves.map((curve) => element('td', {class: 'right'}, numberText(curve.y[i])))));
  return element('div', {class: 'scroll'},
    element('table', {'aria-label': y_label},
      step > 1 ? element('caption', {}, `${places.length} of ${x.length} points`) : null,
      element('thead', {}, element('tr', {}, ...heads.map((head) => element('th', {scope: 'col', class: 'right'}, head)))),
      element('tbody', {}, ...rows)));
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

  zoomedX() {
    return this.zoomed;
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
