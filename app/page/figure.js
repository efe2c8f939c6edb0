// Drawings: a display list becomes an SVG in which only what changes from frame to frame is touched.

import {button, checkbox, element, menu, svgElement, toneClass, toneIcon} from './dom.js';
import {recordingTools} from './recording.js';

const largest_zoom = 40;
// How far from a thin shape, px, the mouse still finds its name.
const near = 4;
// Where a drawing is shown smaller than it was made, its small texts are enlarged until they have this size, px.
const least_text = 9;
const usual_text = 11;
const most_text_scale = 1.9;
// Their places are laid out as one block: enlarged texts would overlap.
const fixed_text_layers = ['heading', 'legend'];
// A legend shown smaller than this, as a part of its usual size, cannot be read.
const least_legend_scale = 0.75;
const legend_margin = 2;
// Texts enlarged by less than this have room at their places.
const least_crowding = 1.15;
// Enlarged texts may overlap by so much, as a part of their height: their boxes have room above and below the letters.
const text_overlap = 0.3;
const frames_between_keys = 32;

function pointsText(numbers) {
  const parts = [];
  for (let i = 0; i + 1 < numbers.length; i += 2) parts.push(`${numbers[i]},${numbers[i + 1]}`);
  return parts.join(' ');
}

// As quarter circles, because one SVG arc cannot describe a full turn.
function arcPath([cx, cy, r, from, to]) {
  const pieces = Math.max(1, Math.ceil(Math.abs(to - from) / (Math.PI / 2)));
  const place = (angle) => `${(cx + r * Math.cos(angle)).toFixed(3)} ${(cy - r * Math.sin(angle)).toFixed(3)}`;
  const sweep = to > from ? 0 : 1;
  let path = `M${place(from)}`;
  for (let i = 1; i <= pieces; ++i) path += `A${r} ${r} 0 0 ${sweep} ${place(from + ((to - from) * i) / pieces)}`;
  return path;
}

// For every type of shape: the SVG element, and what its numbers set there.
const shape_kinds = {
  line: {
    tag: 'line',
    place: (node, shape) => ['x1', 'y1', 'x2', 'y2'].forEach((a, i) => node.setAttribute(a, shape[i + 2])),
  },
  polyline: {tag: 'polyline', place: (node, shape) => node.setAttribute('points', pointsText(shape[2]))},
  polygon: {tag: 'polygon', place: (node, shape) => node.setAttribute('points', pointsText(shape[2]))},
  circle: {
    tag: 'circle',
    place: (node, shape) => ['cx', 'cy', 'r'].forEach((a, i) => node.setAttribute(a, shape[i + 2])),
  },
  arc: {tag: 'path', place: (node, shape) => node.setAttribute('d', arcPath(shape.slice(2)))},
  text: {
    tag: 'text',
    place: (node, shape) => {
      node.setAttribute('x', shape[2]);
      node.setAttribute('y', shape[3]);
      node.textContent = shape[4];
    },
  },
};

function sameValues(a, b) {
  if (a === b) return true;
  if (!Array.isArray(a) || !Array.isArray(b) || a.length !== b.length) return false;
  return a.every((value, i) => sameValues(value, b[i]));
}

function sameGeometry(a, b) {
  return a[0] === b[0] && a.length === b.length && a.every((value, i) => i === 1 || sameValues(value, b[i]));
}

function overlap(a, b) {
  const apart = (from, size, room) => a[from] + a[size] < b[from] + room || b[from] + b[size] < a[from] + room;
  return !apart('x', 'width', 0) && !apart('y', 'height', text_overlap * Math.min(a.height, b.height));
}

// Across, of what a legend has as its ground and rule.
function widthOf(shape) {
  const xs = shape[0] === 'line' ? [shape[2], shape[4]] : shape[0] === 'polygon' ? shape[2].filter((_, i) => i % 2 === 0) : [0];
  return Math.max(...xs) - Math.min(...xs);
}

function isText(slot) {
  return slot.shape?.[0] === 'text';
}

// Copies of shapes, at the size that they have in the drawing.
function sampleView(nodes) {
  const boxes = nodes.map((node) => node.getBBox());
  const edge = (of, value) => of(...boxes.map(value));
  const x = edge(Math.min, (box) => box.x) - legend_margin;
  const y = edge(Math.min, (box) => box.y) - legend_margin;
  const width = edge(Math.max, (box) => box.x + box.width) + legend_margin - x;
  const height = edge(Math.max, (box) => box.y + box.height) + legend_margin - y;
  return svgElement(
    'svg',
    {class: 'key-sample', viewBox: `${x} ${y} ${width} ${height}`, width, height, 'aria-hidden': 'true'},
    ...nodes.map((node) => node.cloneNode(true))
  );
}

// The entries of a legend: a text ends each, and shapes before it are its sample.
function keyEntries(slots) {
  const entries = [];
  let sample = [];
  for (const slot of slots) {
    if (isText(slot)) {
      entries.push(element('li', {}, sample.length > 0 ? sampleView(sample) : null, slot.shape[4]));
      sample = [];
    } else {
      sample.push(slot.node);
    }
  }
  return entries;
}

/// A drawing on the page. `overlay` is a group above all shapes in which others draw; `traces` is one just below it.
/// Told, where given: `thinned(is_thinned)`, whether texts are left out, because they would overlap; `key(entries)`,
/// the entries of a legend that is left out because it would be too small, none where it is in the picture.
export class Picture {
  constructor(container, palette, {thinned = () => {}, key = null} = {}) {
    this.palette = palette;
    this.thinned = thinned;
    this.is_thinned = false;
    this.key = key;
    this.key_texts = '';
    this.is_small = false;
    this.text_scale = 1;
    this.was_enlarged = false;
    this.hidden = new Set();
    this.slots = [];
    this.shapes = svgElement('g');
    this.traces = svgElement('g');
    this.overlay = svgElement('g');
    this.svg = svgElement('svg', {class: 'picture', role: 'img'}, this.shapes, this.traces, this.overlay);
    container.append(this.svg);
    new ResizeObserver(() => this.scaleText()).observe(this.svg);
  }

  /// Shows another drawing. Elements whose shape and style are what they were are left alone.
  show(drawing, k = 0) {
    const resized = drawing.width !== this.drawing?.width || drawing.height !== this.drawing?.height;
    this.drawing = drawing;
    this.svg.setAttribute('aria-label', drawing.description || 'Drawing');
    this.svg.style.aspectRatio = `${drawing.width} / ${drawing.height}`;
    this.styles = drawing.styles.map((style) => this.compiledStyle(style));
    this.fitSlots(drawing.slots);
    this.keys = [];
    this.state = null;
    // First the frame: until then the texts are those of the drawing before, in styles of this one.
    this.frame(k);
    if (resized) this.look({x: 0, y: 0, width: drawing.width, height: drawing.height});
  }

  /// Shows frame k.
  frame(k) {
    const state = this.stateOf(k);
    for (let i = 0; i < state.length; ++i) {
      if (this.state === null || this.state[i] !== state[i]) this.put(this.slots[i], state[i]);
    }
    this.state = state;
    this.thinText();
    this.tellKey();
  }

  /// Changes the part of the drawing that is seen.
  look(box) {
    this.box = box;
    this.svg.setAttribute('viewBox', `${box.x} ${box.y} ${box.width} ${box.height}`);
    this.scaleText();
  }

  /// A place of the window in px of the drawing.
  toPage(client_x, client_y) {
    const matrix = this.svg.getScreenCTM();
    if (!matrix) return {x: 0, y: 0};
    const {x, y} = new DOMPoint(client_x, client_y).matrixTransform(matrix.inverse());
    return {x, y};
  }

  hideLayer(layer, hidden) {
    if (hidden) this.hidden.add(layer);
    else this.hidden.delete(layer);
    for (const slot of this.slots) this.display(slot);
    this.thinText();
    this.tellKey();
  }

  /// The name of the item whose shape is at a place of the window or near it; empty for none.
  nameAt(client_x, client_y) {
    for (const dx of [0, near, -near]) {
      for (const dy of [0, near, -near]) {
        const group = document.elementFromPoint(client_x + dx, client_y + dy)?.parentNode;
        const slot = this.slots.find((candidate) => candidate.group === group);
        if (slot?.name) return slot.name;
      }
    }
    return '';
  }

  colour(name) {
    if (name === 'none') return 'none';
    return Object.hasOwn(this.palette, name) ? `var(--c-${name})` : 'currentColor';
  }

  compiledStyle(style) {
    const attributes =
      style.size === undefined
        ? {
            fill: this.colour(style.fill),
            stroke: this.colour(style.stroke),
            'stroke-width': style.width,
            'stroke-dasharray': style.dash || 'none',
            opacity: style.opacity ?? 1,
          }
        : {
            fill: this.colour(style.colour),
            'text-anchor': style.align,
            'font-weight': style.bold ? 'bold' : 'normal',
            'font-style': style.italic ? 'italic' : 'normal',
            class: style.halo ? 'halo' : '',
          };
    const {size, colour} = style;
    return {attributes: Object.entries(attributes), size, is_remark: colour === 'faint', key: JSON.stringify(style)};
  }

  fitSlots(slots) {
    while (this.slots.length > slots.length) this.slots.pop().group.remove();
    while (this.slots.length < slots.length) {
      const slot = {group: svgElement('g'), layer: '', name: '', node: null, shape: null, style: ''};
      this.slots.push(slot);
      this.shapes.append(slot.group);
    }
    slots.forEach(([layer, name], i) => {
      if (this.slots[i].layer !== layer) {
        this.slots[i].style = '';
        this.slots[i].group.setAttribute('class', layer === 'legend' ? 'in-legend' : '');
      }
      Object.assign(this.slots[i], {layer, name});
      this.display(this.slots[i]);
    });
  }

  display(slot) {
    const shown = !this.hidden.has(slot.layer);
    if (shown === slot.displayed) return;
    slot.displayed = shown;
    slot.group.setAttribute('display', shown ? 'inline' : 'none');
  }

  // Whether the legend can be read depends on the drawing's size, not on what of it is seen.
  tellKey() {
    if (!this.key) return;
    const is_entry = (slot) =>
      slot.layer === 'legend' && slot.displayed && slot.shape !== null && widthOf(slot.shape) < this.drawing.width / 2;
    const slots = this.is_small ? this.slots.filter(is_entry) : [];
    const texts = JSON.stringify(slots.filter(isText).map((slot) => slot.shape[4]));
    this.svg.classList.toggle('without-legend', slots.length > 0);
    if (texts === this.key_texts) return;
    this.key_texts = texts;
    this.key(keyEntries(slots));
  }

  // The shape of every slot in frame k. Some states are kept, so that jumps back need not begin at frame 0.
  stateOf(k) {
    const {frames} = this.drawing;
    const whole = Math.floor(k / frames_between_keys);
    for (let key = this.keys.length; key <= whole; ++key) {
      this.keys.push(
        key === 0
          ? Int32Array.from(frames[0])
          : this.advanced(this.keys[key - 1], (key - 1) * frames_between_keys, key * frames_between_keys)
      );
    }
    return this.advanced(this.keys[whole], whole * frames_between_keys, k);
  }

  advanced(state, from, to) {
    const next = state.slice();
    for (let frame = from + 1; frame <= to; ++frame) {
      const changes = this.drawing.frames[frame];
      for (let i = 0; i + 1 < changes.length; i += 2) next[changes[i]] = changes[i + 1];
    }
    return next;
  }

  put(slot, index) {
    const shape = index < 0 ? undefined : this.drawing.shapes[index];
    const kind = shape && Object.hasOwn(shape_kinds, shape[0]) ? shape_kinds[shape[0]] : null;
    if (!kind) {
      slot.node?.remove();
      slot.node = slot.shape = null;
      return;
    }
    const style = this.styles[shape[1]];
    if (slot.shape?.[0] !== shape[0]) {
      slot.node?.remove();
      slot.node = slot.group.appendChild(svgElement(kind.tag));
      slot.shape = null;
      slot.style = '';
    }
    if (slot.style !== style.key) this.dress(slot, style);
    if (slot.shape === null || !sameGeometry(slot.shape, shape)) kind.place(slot.node, shape);
    slot.shape = shape;
  }

  dress(slot, style) {
    for (const [name, value] of style.attributes) slot.node.setAttribute(name, value);
    if (style.size !== undefined) {
      const scaled = style.size < 14 && !fixed_text_layers.includes(slot.layer);
      slot.node.style.fontSize = scaled
        ? `calc(${Number(style.size)}px * var(--text-scale, 1))`
        : `${Number(style.size)}px`;
    }
    slot.style = style.key;
  }

  scaleText() {
    const {clientWidth, clientHeight} = this.svg;
    if (!clientWidth || !this.box) return;
    const {drawing} = this;
    this.is_small = Math.min(clientWidth / drawing.width, clientHeight / drawing.height) < least_legend_scale;
    const shrunk = usual_text * Math.min(clientWidth / this.box.width, clientHeight / this.box.height);
    this.text_scale = Math.min(most_text_scale, Math.max(1, least_text / shrunk));
    this.svg.style.setProperty('--text-scale', this.text_scale.toFixed(2));
    this.thinText();
    this.tellKey();
  }

  // The places of a drawing's texts are made for their usual size: of enlarged ones that overlap the first is shown.
  // Remarks, such as names of bodies, come last. One that would go on beyond an edge is moved inwards.
  thinText() {
    const enlarged = this.text_scale > least_crowding;
    if (!enlarged && !this.was_enlarged) return;
    this.was_enlarged = enlarged;
    const texts = this.slots.filter((slot) => isText(slot) && !fixed_text_layers.includes(slot.layer));
    const is_remark = (slot) => Number(this.styles[slot.shape[1]].is_remark);
    const shown = [];
    let left_out = false;
    if (enlarged) texts.sort((a, b) => is_remark(a) - is_remark(b));
    const boxes = texts.map((slot) => (enlarged && slot.displayed ? slot.node.getBBox() : null));
    for (const [i, slot] of texts.entries()) {
      const box = boxes[i];
      const shift = box === null ? 0 : Math.max(0, -box.x) - Math.max(0, box.x + box.width - this.drawing.width);
      slot.node.style.setProperty('--shift', `${shift}px`);
      if (box !== null) box.x += shift;
      const hides = box !== null && shown.some((other) => overlap(box, other));
      slot.node.classList.toggle('left-out', hides);
      if (box !== null && !hides) shown.push(box);
      left_out ||= hides;
    }
    // Said as long as texts are enlarged: what comes and goes from frame to frame would move what is below.
    const is_thinned = enlarged && (left_out || this.is_thinned);
    if (is_thinned !== this.is_thinned) this.thinned(is_thinned);
    this.is_thinned = is_thinned;
  }
}

// The part of a drawing seen after zooming by a factor about a place; never more than the whole.
function zoomedBox(box, whole, factor, at) {
  const width = Math.min(whole.width, Math.max(whole.width / largest_zoom, box.width / factor));
  const height = (width * whole.height) / whole.width;
  const x = at.x - ((at.x - box.x) * width) / box.width;
  const y = at.y - ((at.y - box.y) * height) / box.height;
  return clampedBox({x, y, width, height}, whole);
}

function clampedBox(box, whole) {
  return {
    ...box,
    x: Math.min(Math.max(0, box.x), whole.width - box.width),
    y: Math.min(Math.max(0, box.y), whole.height - box.height),
  };
}

// Zoom by wheel, pinch, buttons and keys; pan by dragging. The wheel alone scrolls the page until the drawing has been
// clicked; with Ctrl, which a pinch on a touch pad sends too, it always zooms.
class Zoom {
  constructor(picture, stage, changed) {
    Object.assign(this, {picture, stage, changed, pointers: new Map()});
    stage.addEventListener('wheel', (event) => this.wheel(event), {passive: false});
    stage.addEventListener('pointerdown', (event) => this.down(event));
    stage.addEventListener('pointermove', (event) => this.move(event));
    for (const end of ['pointerup', 'pointercancel']) {
      stage.addEventListener(end, (event) => this.pointers.delete(event.pointerId));
    }
    stage.addEventListener('keydown', (event) => this.key(event));
  }

  get active() {
    return this.picture.box.width < this.picture.drawing.width * 0.999;
  }

  set(box) {
    this.picture.look(box);
    this.stage.classList.toggle('zoomed', this.active);
    this.changed();
  }

  by(factor, at = null) {
    const {box, drawing} = this.picture;
    this.set(zoomedBox(box, drawing, factor, at ?? {x: box.x + box.width / 2, y: box.y + box.height / 2}));
  }

  reset() {
    const {width, height} = this.picture.drawing;
    this.set({x: 0, y: 0, width, height});
  }

  wheel(event) {
    const wanted = event.ctrlKey || this.stage.contains(document.activeElement);
    if (!wanted || (event.deltaY > 0 && !this.active && !event.ctrlKey)) return;
    event.preventDefault();
    this.by(
      Math.exp(-event.deltaY * (event.ctrlKey ? 0.01 : 0.002)),
      this.picture.toPage(event.clientX, event.clientY)
    );
  }

  down(event) {
    if (event.button !== 0 || event.target.closest('button')) return;
    this.pointers.set(event.pointerId, {x: event.clientX, y: event.clientY});
  }

  move(event) {
    // A mouse button may have been released outside the window.
    if (event.buttons === 0) this.pointers.delete(event.pointerId);
    const last = this.pointers.get(event.pointerId);
    if (!last) return;
    if (this.active) this.stage.setPointerCapture(event.pointerId);
    const now = {x: event.clientX, y: event.clientY};
    const other = [...this.pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) this.pinch(last, now, other);
    else if (this.active) this.pan(last, now);
    this.pointers.set(event.pointerId, now);
  }

  pinch(last, now, other) {
    const distance = (p) => Math.hypot(p.x - other.x, p.y - other.y);
    if (distance(last) > 0)
      this.by(distance(now) / distance(last), this.picture.toPage((now.x + other.x) / 2, (now.y + other.y) / 2));
  }

  pan(last, now) {
    const a = this.picture.toPage(last.x, last.y);
    const b = this.picture.toPage(now.x, now.y);
    const {box, drawing} = this.picture;
    this.set(clampedBox({...box, x: box.x + a.x - b.x, y: box.y + a.y - b.y}, drawing));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === '+' || event.key === '=') this.by(1.25);
    else if (event.key === '-') this.by(0.8);
    else if (event.key === '0') this.reset();
    else return;
    event.preventDefault();
  }
}

function followWithName(picture, stage, said) {
  const tip = element('div', {class: 'tip', hidden: true, 'aria-hidden': 'true'});
  stage.append(tip);
  stage.addEventListener('pointerleave', () => {
    tip.hidden = true;
  });
  stage.addEventListener('pointermove', (event) => {
    tip.textContent = said(picture.nameAt(event.clientX, event.clientY));
    tip.hidden = tip.textContent === '';
    if (tip.hidden) return;
    const box = stage.getBoundingClientRect();
    const left = event.clientX - box.left + 14;
    tip.style.left = `${Math.max(0, Math.min(left, box.width - tip.offsetWidth - 4))}px`;
    tip.style.top = `${event.clientY - box.top + 16}px`;
  });
}

/// A menu in which the reader chooses the layers of a drawing that are shown.
export function layerMenu(picture, drawing) {
  const layers = [...new Set(drawing.slots.map(([layer]) => layer))];
  return menu(
    'Layers',
    ...layers.map((layer) =>
      checkbox(layer.replaceAll('-', ' '), !picture.hidden.has(layer), (shown) => picture.hideLayer(layer, !shown))
    )
  );
}

/// A caption with its tone, and a mark on what is not confirmed.
export function showCaption(caption, stage, drawing, k) {
  const tone = drawing.tones?.[k] ?? 'plain';
  const confirmed = drawing.confirmed?.[k] ?? true;
  stage.classList.toggle('unconfirmed', !confirmed);
  const text = drawing.captions?.[k] ?? '';
  caption.className = `caption ${toneClass(tone)}`;
  caption.replaceChildren(...[toneIcon(tone), text].filter((part) => part));
  if (!confirmed) caption.append(element('span', {class: 'unconfirmed-word'}, 'not confirmed'));
}

/// A drawing with its caption, zoom, names and layers. Returns its parts; frame(k) shows another frame. `said(name)`:
/// what is said beside an item of that name; `moves`: there is something to film.
export function drawingView(drawing, palette, said = (name) => name, moves = drawing.frames.length > 1) {
  const stage = element('div', {
    class: 'stage',
    tabindex: 0,
    role: 'group',
    'aria-label': 'Drawing. Plus and minus zoom, 0 shows the whole.',
  });
  const thinned = element('p', {class: 'hint', hidden: true}, 'Texts that would overlap are left out: zoom to see them.');
  const key = element('ul', {class: 'key', hidden: true, 'aria-label': 'Legend'});
  const picture = new Picture(stage, palette, {
    thinned: (is_thinned) => {
      thinned.hidden = !is_thinned;
    },
    key: (entries) => {
      key.hidden = entries.length === 0;
      key.replaceChildren(...entries);
    },
  });
  const reset = button('Show the whole', () => zoom.reset(), {class: 'quiet'});
  const zoom = new Zoom(picture, stage, () => {
    reset.hidden = !zoom.active;
  });
  reset.hidden = true;
  const tools = element(
    'div',
    {class: 'tools'},
    button('+', () => zoom.by(1.25), {
      class: 'icon-button',
      'aria-label': 'Zoom in',
      title: 'Zoom in (Ctrl + wheel; drag to move)',
    }),
    button('−', () => zoom.by(0.8), {class: 'icon-button', 'aria-label': 'Zoom out', title: 'Zoom out (Ctrl + wheel)'}),
    reset,
    layerMenu(picture, drawing),
    ...recordingTools(picture, moves)
  );
  const caption = element('p', {class: 'caption'});
  followWithName(picture, stage, said);
  picture.show(drawing);
  const frame = (k) => {
    picture.frame(k);
    showCaption(caption, stage, drawing, k);
  };
  frame(0);
  const whole = element('div', {class: 'drawing'}, stage, key, thinned, caption, tools);
  return {element: whole, stage, picture, caption, key, tools, frame};
}
