// Plays the frames of a drawing: play, pause, steps, slider, events, snaps in slow motion, and traces of points.

import {button, checkbox, element, icon, iconButton, menu, numberText, say, svgElement} from './dom.js';

const speeds = [0.1, 0.25, 0.5, 1, 2, 4];
// How long one frame of a snap is shown, s.
const seconds_of_snap_frame = 0.08;
const trace_colours = 7;
// From so many points on, the reader can search for one.
const many_points = 12;
// Of labels on the slider, as parts of its length: the gap between them, and half of a letter.
const least_gap = 0.015;
const half_letter = 0.015;
// Half the width of the slider's thumb, px: its middle is never nearer to the ends.
const thumb = 8;

/// When every frame begins, s, and when the last one is over. All frames take the same time, except those of snaps.
export function frameTimes(count, seconds, snaps) {
  const in_snap = (k) => snaps.some((snap) => k >= snap.first && k <= snap.last);
  const ordinary = [...Array(count).keys()].filter((k) => !in_snap(k)).length;
  const each = ordinary > 0 ? seconds / ordinary : 0;
  const times = [0];
  for (let k = 0; k < count; ++k) times.push(times[k] + (in_snap(k) ? seconds_of_snap_frame : each));
  return times;
}

// The path of a point: faint as a whole, strong up to the frame shown, which a dash as long as that part draws.
class Trace {
  constructor(point, colour, group) {
    const places = [];
    for (let i = 0; i + 1 < point.at.length; i += 2) places.push([point.at[i], point.at[i + 1]]);
    const known = ([x, y]) => Number.isFinite(x) && Number.isFinite(y);
    this.places = places.map((place, k) =>
      known(place) ? place : (places.slice(0, k).findLast(known) ?? places.find(known))
    );
    if (!this.places[0]) this.places = [];
    this.lengths = [0];
    for (let k = 1; k < this.places.length; ++k) {
      const [a, b] = [this.places[k - 1], this.places[k]];
      this.lengths.push(this.lengths[k - 1] + Math.hypot(b[0] - a[0], b[1] - a[1]));
    }
    const line = (width, opacity) =>
      svgElement('polyline', {
        points: this.places.map((place) => place.join(',')).join(' '),
        fill: 'none',
        stroke: colour,
        'stroke-width': width,
        opacity,
        'stroke-linejoin': 'round',
        'pointer-events': 'none',
      });
    this.strong = line(2.2, 1);
    this.dot = svgElement('circle', {r: 4, fill: colour, stroke: 'var(--c-paper)', 'pointer-events': 'none'});
    this.group = group.appendChild(svgElement('g', {}, line(1.2, 0.45), this.strong, this.dot));
  }

  frame(k) {
    if (this.places.length === 0) return;
    const at = Math.min(k, this.places.length - 1);
    this.strong.setAttribute('stroke-dasharray', `${this.lengths[at].toFixed(2)} 1e6`);
    this.dot.setAttribute('cx', this.places[at][0]);
    this.dot.setAttribute('cy', this.places[at][1]);
  }
}

// The list in which the reader chooses the points that are traced.
class Traces {
  constructor(points, picture) {
    Object.assign(this, {points, picture, chosen: new Map(), frame_shown: 0});
    const rows = points.map((point, i) => this.row(point, i));
    const search = element('input', {
      type: 'search',
      placeholder: 'Search points',
      'aria-label': 'Search points',
      input: () => {
        const words = search.value.toLowerCase();
        points.forEach((point, i) => {
          rows[i].hidden = !point.name.toLowerCase().includes(words);
        });
      },
    });
    this.menu = menu(
      'Traces',
      points.length > many_points ? search : null,
      element('div', {class: 'choices'}, ...rows)
    );
  }

  row(point, i) {
    const swatch = element('span', {class: 'swatch'});
    const row = checkbox(point.name, point.traced, (chosen) => this.choose(i, chosen, swatch));
    row.append(swatch);
    if (point.traced) this.choose(i, true, swatch);
    return row;
  }

  choose(i, chosen, swatch) {
    if (chosen) {
      const colour = `var(--c-curve-${this.freeColour()})`;
      this.chosen.set(i, {trace: new Trace(this.points[i], colour, this.picture.traces), colour});
      this.chosen.get(i).trace.frame(this.frame_shown);
      swatch.style.background = colour;
    } else {
      this.chosen.get(i)?.trace.group.remove();
      this.chosen.delete(i);
      swatch.style.background = 'none';
    }
  }

  freeColour() {
    const used = [...this.chosen.values()].map(({colour}) => colour);
    for (let c = 1; c <= trace_colours; ++c) {
      if (!used.includes(`var(--c-curve-${c})`)) return c;
    }
    return (this.chosen.size % trace_colours) + 1;
  }

  frame(k) {
    this.frame_shown = k;
    for (const {trace} of this.chosen.values()) trace.frame(k);
  }
}

/// Plays a drawing of several frames. `onFrame` is told of every frame shown.
export class Player {
  constructor(view, play, onFrame) {
    Object.assign(this, {
      view,
      play,
      onFrame,
      frame_shown: -1,
      clock: 0,
      last: 0,
      playing: false,
      speed: 1,
      loop: false,
    });
    this.count = view.picture.drawing.frames.length;
    this.times = frameTimes(this.count, play.seconds, play.snaps ?? []);
    this.traces = play.points?.length > 0 ? new Traces(play.points, view.picture) : null;
    view.caption.after(element('div', {class: 'player'}, this.bar(), this.snapLine()));
    view.tools.append(...[this.traces?.menu, ...this.settings()].filter((part) => part));
    const events = this.eventList();
    if (events) view.element.append(events);
    this.go(play.rest ?? 0);
  }

  bar() {
    this.toggle = iconButton('play', 'Play', () => this.startOrStop());
    this.slider = element('input', {
      type: 'range',
      min: 0,
      max: this.count - 1,
      step: 1,
      value: 0,
      'aria-label': this.play.label || 'Frame',
      input: () => this.step(Number(this.slider.value)),
    });
    this.value = element('span', {class: 'value'});
    return element(
      'div',
      {class: 'bar'},
      element(
        'div',
        {class: 'buttons'},
        iconButton('first', 'First frame', () => this.step(0)),
        iconButton('back', 'One frame back', () => this.step(this.frame_shown - 1)),
        this.toggle,
        iconButton('forth', 'One frame on', () => this.step(this.frame_shown + 1)),
        iconButton('last', 'Last frame', () => this.step(this.count - 1))
      ),
      element('div', {class: 'track'}, this.slider, this.markLine()),
      this.value
    );
  }

  settings() {
    const speed = element(
      'select',
      {
        change: () => {
          this.speed = Number(speed.value);
        },
      },
      ...speeds.map((factor) => element('option', {value: factor, selected: factor === 1}, `${factor} ×`))
    );
    return [
      element('label', {class: 'check'}, 'Speed', speed),
      checkbox('Repeat', false, (on) => {
        this.loop = on;
      }),
    ];
  }

  // Where a frame is along the slider.
  along(frame) {
    const part = this.count > 1 ? frame / (this.count - 1) : 0;
    return `calc(${thumb}px + (100% - ${2 * thumb}px) * ${part.toFixed(5)})`;
  }

  markLine() {
    const line = element('div', {class: 'marks', 'aria-hidden': 'true'});
    for (const snap of this.play.snaps ?? []) {
      const strip = element('span', {class: 'snap', title: `${snap.caption} (slow motion)`});
      strip.style.left = this.along(snap.first);
      strip.style.right = `calc(100% - ${this.along(snap.last)})`;
      line.append(strip);
    }
    let last = {frame: -Infinity, label: ''};
    for (const mark of this.play.marks ?? []) {
      // Labels that would overlap are left out; the list of events has them all.
      const letters = mark.label.length + last.label.length;
      const crowded = mark.frame - last.frame < (least_gap + half_letter * letters) * this.count;
      if (!crowded) last = mark;
      const sign = button(crowded ? '' : mark.label, () => this.step(mark.frame), {
        class: 'mark',
        tabindex: -1,
        title: mark.caption,
      });
      sign.style.left = this.along(mark.frame);
      line.append(sign);
    }
    return line;
  }

  snapLine() {
    this.snap = element('p', {class: 'snap-line'});
    this.snap.hidden = (this.play.snaps ?? []).length === 0;
    return this.snap;
  }

  eventList() {
    const marks = this.play.marks ?? [];
    if (marks.length === 0) return null;
    this.events = marks.map((mark) =>
      button(element('span', {class: 'event-label'}, mark.label), () => this.step(mark.frame), {class: 'event'})
    );
    this.events.forEach((event, i) => event.append(marks[i].caption));
    return element(
      'div',
      {class: 'events'},
      element('h3', {}, 'Events'),
      element('ol', {}, ...this.events.map((event) => element('li', {}, event)))
    );
  }

  valueText(k) {
    const {label, unit, values} = this.play;
    return `${label ? `${label} = ` : ''}${numberText(values?.[k] ?? k, 5)}${unit ? ` ${unit}` : ''}`;
  }

  /// Shows a frame.
  go(frame) {
    const k = Math.max(0, Math.min(this.count - 1, Math.round(frame)));
    if (k === this.frame_shown) return;
    this.frame_shown = k;
    this.view.frame(k);
    this.traces?.frame(k);
    this.slider.value = k;
    this.value.textContent = this.valueText(k);
    this.slider.setAttribute('aria-valuetext', this.value.textContent);
    const snap = (this.play.snaps ?? []).find(({first, last}) => k >= first && k <= last);
    this.snap.textContent = snap ? `Slow motion: ${snap.caption}` : '';
    this.events?.forEach((event, i) =>
      event.setAttribute('aria-current', this.play.marks[i].frame === k ? 'true' : 'false')
    );
    this.onFrame(k);
  }

  /// Shows a frame that the reader asked for: playing stops, and its caption is read out.
  step(frame) {
    this.setPlaying(false);
    this.go(frame);
    say([this.valueText(this.frame_shown), this.view.caption.textContent].filter((text) => text).join(': '));
  }

  startOrStop() {
    if (this.playing) this.step(this.frame_shown);
    else this.setPlaying(true);
  }

  setPlaying(playing) {
    if (playing === this.playing) return;
    this.playing = playing;
    this.toggle.replaceChildren(icon(playing ? 'pause' : 'play'));
    for (const name of ['aria-label', 'title']) this.toggle.setAttribute(name, playing ? 'Pause' : 'Play');
    if (!playing) return;
    if (this.frame_shown >= this.count - 1) this.go(0);
    this.clock = this.times[this.frame_shown];
    this.last = performance.now();
    requestAnimationFrame((now) => this.tick(now));
  }

  tick(now) {
    if (!this.playing) return;
    // A page in the background gets no frames: it goes on where it was.
    this.clock += this.speed * Math.max(0, Math.min(0.25, (now - this.last) / 1000));
    this.last = now;
    const total = this.times[this.count];
    if (this.clock >= total && this.loop && total > 0) this.clock %= total;
    this.go(this.frameAt(this.clock));
    if (this.clock >= total) this.setPlaying(false);
    else requestAnimationFrame((next) => this.tick(next));
  }

  frameAt(time) {
    let low = 0,
      high = this.count - 1;
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  /// Has keys pressed anywhere in a box move the player, except where a control there uses them itself.
  listenIn(box) {
    const moves = {ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10};
    box.addEventListener('keydown', (event) => {
      if (event.defaultPrevented || event.ctrlKey || event.metaKey || event.altKey) return;
      const at = event.target;
      if (at.closest('select, input:not([type="range"]), .menu, table, .chart')) return;
      if (event.key === ' ' && !at.closest('button, summary, a')) this.startOrStop();
      else if (Object.hasOwn(moves, event.key)) this.step(this.frame_shown + moves[event.key]);
      else if (event.key === 'Home') this.step(0);
      else if (event.key === 'End') this.step(this.count - 1);
      else return;
      event.preventDefault();
    });
  }
}
