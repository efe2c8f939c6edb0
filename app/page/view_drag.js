// Handles on the picture of a live view: points of bodies, points of the ground and tips of loads, each moved by the
// pointer or by the arrow keys.

import {element, svgElement} from './dom.js';

// What is nearer than this to another handle, px of the drawing, is the same place: bodies joined there.
const same_place = 0.05;
// A press that moves less is no drag, px of the screen.
const least_move = 2;
// From so many px of the drawing on, a line shows that the mechanism does not follow the pointer.
const far_off = 3;
const key_moves = new Map([
  ['ArrowLeft', [-1, 0]],
  ['ArrowRight', [1, 0]],
  ['ArrowUp', [0, -1]],
  ['ArrowDown', [0, 1]],
]);
// Where the browser tells of the pointer as it moves, and not first when it begins the next frame, the answer is in that
// frame.
const follows_at_once = 'onpointerrawupdate' in window;
const handle_words = {point: 'Point', ground: 'Fixed point', load: 'Tip of load'};

function requestOf({kind, name}, px) {
  if (kind === 'point') return {do: 'drag', point: name, px};
  if (kind === 'ground') return {do: 'ground', point: name, px, goes_on: true};
  return {do: 'load', name, px, goes_on: true};
}

// Points of several bodies at a place become one handle. A point of the ground comes first, since what is joined to it
// cannot be dragged along.
function mergedHandles(items) {
  const rank = {ground: 0, point: 1, load: 2};
  const merged = [];
  for (const item of [...items].sort((a, b) => rank[a.kind] - rank[b.kind])) {
    const twin = merged.find(
      (other) =>
        item.kind !== 'load' &&
        other.kind !== 'load' &&
        !(item.kind === 'ground') &&
        Math.hypot(item.px[0] - other.px[0], item.px[1] - other.px[1]) < same_place
    );
    if (twin) twin.also.push(item.name);
    else merged.push({...item, also: []});
  }
  return merged;
}

/// The handles. `ask(request, options)` sends requests.
export class Handles {
  constructor(moving, ask) {
    Object.assign(this, {moving, ask, picture: moving.picture, stage: moving.stage});
    Object.assign(this, {known: new Map(), held: null, enabled: true, size: {width: 0, height: 0}});
    this.line = svgElement('line', {class: 'reach', display: 'none'});
    this.picture.overlay.append(this.line);
    this.layer = element('div', {class: 'handles', role: 'group', 'aria-label': 'Points that can be moved'});
    this.stage.append(this.layer);
    new ResizeObserver(() => {
      const {clientWidth: width, clientHeight: height} = this.picture.svg;
      this.size = {width, height};
      this.locate();
    }).observe(this.picture.svg);
    // Zooming changes the view box only.
    new MutationObserver(() => this.locate()).observe(this.picture.svg, {attributeFilter: ['viewBox']});
  }

  /// Takes over where the handles are.
  place(items) {
    // Which handles share a place is not asked while one is held: those that pass each other stay apart.
    const wanted = this.held ? this.updated(items) : mergedHandles(items);
    const keys = new Set(wanted.map((item) => this.keyOf(item)));
    for (const [key, handle] of this.known) {
      if (keys.has(key)) continue;
      handle.button.remove();
      this.known.delete(key);
    }
    for (const item of wanted) {
      const key = this.keyOf(item);
      const handle = this.known.get(key) ?? this.made(key, item);
      this.describe(handle, item);
    }
    this.locate();
  }

  keyOf({kind, name}) {
    return `${kind} ${name}`;
  }

  // A handle that the program leaves out, because another is at its place just now, stays where it was: the pointer
  // holds it.
  updated(items) {
    const now = new Map(items.map((item) => [this.keyOf(item), item]));
    return [...this.known].map(([key, {item}]) => ({...item, ...now.get(key)}));
  }

  describe(handle, item) {
    handle.item = item;
    const label = `${handle_words[item.kind]} ${[item.name, ...item.also].join(', ')}`;
    if (handle.label === label) return;
    handle.label = label;
    handle.name.textContent = item.name;
    handle.button.setAttribute('aria-label', `${label}. Arrow keys move it, Enter lets go.`);
  }

  made(key, item) {
    const name = element('span', {class: 'handle-name'});
    const attributes = {class: `handle handle-${item.kind}`, 'data-handle': item.kind, 'data-name': item.name};
    const button = element('button', {type: 'button', ...attributes}, name);
    const handle = {button, name, item, label: ''};
    button.addEventListener('pointerdown', (event) => this.down(event, handle));
    button.addEventListener(follows_at_once ? 'pointerrawupdate' : 'pointermove', (event) => this.move(event, handle));
    // What moves a handle does not move the picture below it.
    if (follows_at_once) button.addEventListener('pointermove', (event) => this.held && event.stopPropagation());
    for (const end of ['pointerup', 'pointercancel', 'lostpointercapture']) {
      button.addEventListener(end, () => this.up(handle, 'pointer'));
    }
    button.addEventListener('keydown', (event) => this.key(event, handle));
    button.addEventListener('blur', () => this.up(handle, 'keys'));
    button.disabled = !this.enabled;
    this.known.set(key, handle);
    this.layer.append(button);
    return handle;
  }

  setEnabled(enabled) {
    this.enabled = enabled;
    if (!enabled) this.drop();
    for (const {button} of this.known.values()) button.disabled = !enabled;
  }

  // Where the drawing is in the stage, by the rule of SVG: as large as fits, in the middle.
  locate() {
    const {box} = this.picture;
    const {width, height} = this.size;
    if (!box || !width || !height) return;
    const scale = Math.min(width / box.width, height / box.height);
    const left = (width - scale * box.width) / 2 - scale * box.x;
    const top = (height - scale * box.height) / 2 - scale * box.y;
    for (const {button, item} of this.known.values()) {
      // The others are hidden while one is held.
      if (this.held?.moved && this.held.handle.button !== button) continue;
      const [x, y] = [left + scale * item.px[0], top + scale * item.px[1]];
      button.hidden = !(x >= 0 && y >= 0 && x <= width && y <= height) && this.held?.handle.button !== button;
      button.style.transform = `translate(${x.toFixed(2)}px,${y.toFixed(2)}px)`;
      button.classList.toggle('leftwards', x > 0.75 * width);
    }
    this.drawReach();
  }

  drawReach() {
    const {held} = this;
    const from = held?.handle.item.px;
    const to = held?.wanted;
    const shown = from && to && held.by === 'pointer' && Math.hypot(from[0] - to[0], from[1] - to[1]) > far_off;
    this.line.setAttribute('display', shown ? 'inline' : 'none');
    if (!shown) return;
    ['x1', 'y1', 'x2', 'y2'].forEach((name, i) => this.line.setAttribute(name, [...from, ...to][i]));
  }

  // Where handles overlap, the one whose middle is nearest is meant.
  nearestTo(event, pressed) {
    const distance = ({button}) => {
      const box = button.getBoundingClientRect();
      return Math.hypot(box.x + box.width / 2 - event.clientX, box.y + box.height / 2 - event.clientY);
    };
    const seen = [...this.known.values()].filter(({button}) => !button.hidden);
    return seen.reduce((best, one) => (distance(one) < distance(best) - 0.5 ? one : best), pressed);
  }

  down(event, pressed) {
    event.stopPropagation();
    const handle = this.nearestTo(event, pressed);
    if (event.button !== 0 || this.held?.by === 'pointer') return;
    // What is under way would move the handle away from the pointer.
    this.moving.finish();
    if (this.held) this.up(this.held.handle, 'keys');
    event.preventDefault();
    handle.button.focus({preventScroll: true});
    handle.button.setPointerCapture(event.pointerId);
    const at = this.picture.toPage(event.clientX, event.clientY);
    const {px} = handle.item;
    this.held = {
      handle,
      by: 'pointer',
      pointer: event.pointerId,
      off: [px[0] - at.x, px[1] - at.y],
      start: [event.clientX, event.clientY],
      moved: false,
      wanted: null,
    };
  }

  move(event, handle) {
    const {held} = this;
    if (held?.handle !== handle || held.by !== 'pointer' || event.pointerId !== held.pointer) return;
    event.stopPropagation();
    const way = Math.hypot(event.clientX - held.start[0], event.clientY - held.start[1]);
    if (!held.moved && way < least_move) return;
    const at = this.picture.toPage(event.clientX, event.clientY);
    this.goTo([at.x + held.off[0], at.y + held.off[1]], event.timeStamp);
  }

  goTo(px, time) {
    const {held} = this;
    held.moved = true;
    held.wanted = px;
    held.handle.button.classList.add('held');
    this.stage.classList.add('holding');
    const request = requestOf(held.handle.item, px);
    this.ask(request, {gesture: `${request.do} ${held.handle.item.name}`, time});
  }

  /// A point that the program has moved as far as one answer takes goes on to where it is wanted.
  goOn() {
    if (this.held?.moved) this.goTo(this.held.wanted, null);
  }

  up(handle, by) {
    const {held} = this;
    if (!held || held.handle !== handle || held.by !== by) return;
    this.drop();
    // A look ends the gesture of a load or of the ground, and brings the numbers.
    if (held.moved) this.ask({do: handle.item.kind === 'point' ? 'release' : 'look'}, {note: 'gesture'});
  }

  drop() {
    this.held?.handle.button.classList.remove('held');
    this.stage.classList.remove('holding');
    this.held = null;
    this.locate();
  }

  key(event, handle) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const way = key_moves.get(event.key);
    if (way && this.enabled && this.held?.by !== 'pointer') {
      event.preventDefault();
      event.stopPropagation();
      this.moving.finish();
      this.held ??= {handle, by: 'keys', moved: false, wanted: null};
      const step = event.shiftKey ? 1 : 5;
      this.goTo([handle.item.px[0] + step * way[0], handle.item.px[1] + step * way[1]], event.timeStamp);
    } else if (['Enter', 'Escape', ' '].includes(event.key)) {
      event.preventDefault();
      if (this.held?.by === 'keys') this.up(handle, 'keys');
    }
  }
}
