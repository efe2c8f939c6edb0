// Draws curves, bands, levels, marks, arrows and cursors of a chart on the canvas of its uPlot.

import {svgElement} from './dom.js';
import {colourNow} from './theme.js';
import {minorPlaces} from './axes.js';
import {markLabels} from './mark_labels.js';

export const chart_font = "system-ui, -apple-system, 'Segoe UI', Helvetica, Arial, 'DejaVu Sans', sans-serif";
export const chart_text_size = 12;
export const has_points = ['points', 'crosses', 'marked'];
const dashes = new Map([
  ['dashed', [7, 5]],
  ['dotted', [1.5, 5]],
]);
const repeated_dash = [14, 4];

// Curves nearer to each other than this, px of the screen, are seen as one.
const coincident = 1.2;
// Where curves coincide their colours take turns, so many px each.
const turn_length = 9;

// The dash of a curve's line; empty where it is solid.
function dashOf({style, repeated}) {
  return dashes.get(style) ?? (repeated ? repeated_dash : []);
}

function hasLine({style}) {
  return !['points', 'crosses'].includes(style);
}

/// Draws in the plotting area of a uPlot. Places are px of the canvas; lengths times `unit` are px of the screen.
export class Brush {
  constructor(u, chart, scale) {
    this.unit = scale * uPlot.pxRatio;
    Object.assign(this, {
      ctx: u.ctx,
      area: u.bbox,
      chart,
      x: this.mapping(u, 'x', chart),
      y: this.mapping(u, 'y', chart),
    });
  }

  mapping(u, name, chart) {
    const {left, top, width, height} = u.bbox;
    const log = chart.log[name];
    const [low, high] = chart.range[name].map((value) => (log ? Math.log10(value) : value));
    const falls = name === 'x' ? chart.panel.x_falls : true;
    const [from, length] = name === 'x' ? [left, width] : [top, height];
    const slope = ((falls ? -1 : 1) * length) / (high - low);
    const base = (falls ? from + length : from) - slope * low;
    return log
      ? (value) => (value > 0 ? base + slope * Math.log10(value) : NaN)
      : (value) => (value === null ? NaN : base + slope * value);
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
      const curves = panel.curves.filter((_, i) => shown[i]);
      const lines = curves.filter(hasLine);
      const solid = lines.filter((curve) => dashOf(curve).length === 0);
      for (const curve of solid) this.path(curve);
      this.shareWays(solid);
      // What is dashed, and points, let what is below them be seen.
      for (const curve of lines) if (dashOf(curve).length > 0) this.path(curve);
      for (const curve of curves) if (has_points.includes(curve.style)) this.points(curve);
      for (const arrow of panel.arrows ?? []) this.arrow(arrow);
      if (with_cursor) this.cursor();
    });
    // uPlot remembers what it set on the canvas: all else is put back.
    this.ctx.save();
    this.marks();
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

  path(curve) {
    const {ctx} = this;
    const {x, y, style, colour} = curve;
    this.pen(colour, style === 'dotted' ? 2 : 1.7, dashOf(curve));
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

  // Without this the last of several curves on one way would hide the others.
  shareWays(curves) {
    const places = curves.map(({x, y}) => x.map((value, i) => [this.x(value), this.y(y[i])]));
    const near = ([x0, y0], [x1, y1]) => Math.hypot(x1 - x0, y1 - y0) < coincident * this.unit;
    curves.forEach((curve, c) => {
      // Those that go the same way from place i - 1 to place i: curves of a chart have their places at the same x.
      const company = places[c].map((place, i) =>
        i === 0
          ? []
          : places.flatMap((other, k) =>
              other.length > i && near(place, other[i]) && near(places[c][i - 1], other[i - 1]) ? [k] : []
            )
      );
      for (let i = 1, first = 1; i <= company.length; ++i) {
        if (i < company.length && sameNumbers(company[i], company[first])) continue;
        if (company[first]?.length > 1) this.turns(curve, places[c].slice(first - 1, i), company[first], c);
        first = i;
      }
    });
  }

  // A curve where it has a way in common with others: its turns among theirs.
  turns({colour}, places, company, own) {
    const {ctx} = this;
    this.pen(colour, 1.7, [turn_length, turn_length * (company.length - 1)]);
    ctx.lineDashOffset = -turn_length * this.unit * company.indexOf(own);
    ctx.lineCap = 'butt';
    ctx.beginPath();
    for (const place of places) ctx.lineTo(...place);
    ctx.stroke();
    ctx.lineCap = 'round';
    ctx.lineDashOffset = 0;
  }

  points({x, y, style, colour}) {
    const {ctx, unit} = this;
    this.pen(colour, 1.7, []);
    const r = (style === 'crosses' ? 4 : style === 'marked' ? 3 : x.length > 300 ? 1.5 : 2.5) * unit;
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
    for (const side of [-0.4, 0.4])
      ctx.lineTo(x1 - 9 * unit * Math.cos(turn + side), y1 - 9 * unit * Math.sin(turn + side));
    ctx.closePath();
    ctx.fill();
  }

  // Dots with their labels beside them.
  marks() {
    const {ctx, unit, area} = this;
    const graph = {left: area.left, right: area.left + area.width, top: area.top, bottom: area.top + area.height};
    const shown = (this.chart.panel.marks ?? [])
      .map(({x, y, label}) => ({x: this.x(x), y: this.y(y), label}))
      .filter(({x, y}) => x >= graph.left - 1 && x <= graph.right + 1 && y >= graph.top - 1 && y <= graph.bottom + 1);
    this.pen('dark', 1.4, []);
    for (const {x, y} of shown) {
      ctx.beginPath();
      ctx.arc(x, y, 3.4 * unit, 0, 2 * Math.PI);
      ctx.fill();
    }
    ctx.font = `bold ${chart_text_size * unit}px ${chart_font}`;
    ctx.textAlign = 'center';
    ctx.textBaseline = 'middle';
    ctx.strokeStyle = colourNow('paper');
    ctx.lineWidth = 3 * unit;
    ctx.lineJoin = 'round';
    const widthOf = (text) => ctx.measureText(text).width;
    for (const {label, box} of markLabels(shown, graph, widthOf, chart_text_size * unit, unit)) {
      const place = [(box.left + box.right) / 2, (box.top + box.bottom) / 2];
      ctx.strokeText(label, ...place);
      ctx.fillText(label, ...place);
    }
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

function sameNumbers(a, b) {
  return a.length === b.length && a.every((value, i) => value === b[i]);
}

/// The sign of a curve in a legend.
export function curveSample(curve) {
  const {style, colour} = curve;
  const name = /^[a-z0-9-]+$/.test(colour) ? `var(--c-${colour})` : 'currentColor';
  const sample = svgElement('svg', {class: 'sample', viewBox: '0 0 28 12', 'aria-hidden': 'true'});
  if (hasLine(curve)) {
    sample.append(
      svgElement('path', {
        d: 'M2 6h24',
        stroke: name,
        'stroke-width': 2.4,
        'stroke-linecap': 'round',
        'stroke-dasharray': dashOf(curve).join(' ') || 'none',
      })
    );
  }
  if (style === 'crosses')
    sample.append(svgElement('path', {d: 'M10 2l8 8M18 2l-8 8', stroke: name, 'stroke-width': 2}));
  else if (has_points.includes(style)) sample.append(svgElement('circle', {cx: 14, cy: 6, r: 3.2, fill: name}));
  return sample;
}
