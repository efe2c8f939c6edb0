// Drawing by hand: tools that add items to the scene. The page finds the place that is meant (a point, the grid, a line
// through the place before, typed numbers); what is written into the scene is decided by the program.

import {button, checkbox, element, menu, numberText, svgElement} from './dom.js';
import {Selection} from './view_selection.js';

// So near to a point, px of the screen, that point is meant.
const near_point = 12;
// So near to a horizontal or vertical through the place before, px of the screen, that line is meant.
const near_line = 6;
// A press that moves so far, px of the screen, drags a box.
const least_box = 4;
// Lines of the grid are so far apart at least, px of the screen.
const least_grid = 14;

// The largest of 1, 2 and 5 times a power of ten that is not above a number.
function stepBelow(most) {
  const power = 10 ** Math.floor(Math.log10(most));
  return [5, 2, 1].map((factor) => factor * power).find((step) => step <= most * (1 + 1e-9)) ?? power;
}

// Without digits that only rounding brings.
function tidy(value, grain) {
  const digits = Math.min(15, Math.max(0, Math.round(-Math.log10(grain))));
  return Number(value.toFixed(digits)) + 0;
}

/// Reads "30, 40" as a place, and "100 < 60" as a length and an angle from the place before, deg; null for others.
export function typedPlace(text, before, degrees) {
  const number = '([-+]?(?:\\d+\\.?\\d*|\\.\\d+)(?:e[-+]?\\d+)?)';
  const pair = text.trim().match(new RegExp(`^${number}\\s*[,;\\s]\\s*${number}$`, 'i'));
  if (pair) return pair.slice(1, 3).every((one) => Number.isFinite(Number(one))) ? pair.slice(1, 3).map(Number) : null;
  const polar = text.trim().match(new RegExp(`^${number}\\s*<\\s*${number}$`, 'i'));
  if (!polar || !before) return null;
  const angle = Number(polar[2]) * (degrees ? Math.PI / 180 : 1);
  if (![polar[1], polar[2]].every((text) => Number.isFinite(Number(text)))) return null;
  return [before[0] + Number(polar[1]) * Math.cos(angle), before[1] + Number(polar[1]) * Math.sin(angle)];
}

// Tools of the page itself.
const own_tools = {
  select: {name: 'select', title: 'Select', picks: 1, hint: 'Click an item, Shift+click more, or drag a box over them.'},
  move_point: {name: 'move_point', title: 'Shape', picks: 1, hint: 'Drag a point to where it is to be.'},
};

// Usual densities, kg/m^3; alloys and woods differ by some per cent.
const materials = {
  steel: 7850,
  'stainless steel': 7900,
  'cast iron': 7200,
  aluminium: 2700,
  brass: 8500,
  titanium: 4500,
  POM: 1410,
  PVC: 1400,
  acrylic: 1190,
  ABS: 1050,
  plywood: 680,
};

// What a plate is made of, for the tool that gives a link its mass.
class PlateFields {
  constructor() {
    const field = (label, value, attributes) => {
      const input = element('input', {type: 'text', ...attributes});
      input.value = value;
      return [element('label', {}, `${label} `, input), input];
    };
    const [thickness_label, thickness] = field('Thickness', '5', {size: 6, title: 'In the unit of the scene; a number or an expression'});
    const [density_label, density] = field('kg/m³', String(materials.steel), {size: 6});
    const [holes_label, holes] = field('Holes', '', {size: 10, placeholder: 'A 8, B 6', title: 'Points of the link with diameters'});
    const material = element(
      'select',
      {
        'aria-label': 'Material',
        change: () => {
          density.value = materials[material.value];
        },
      },
      ...Object.keys(materials).map((name) => element('option', {value: name}, name))
    );
    Object.assign(this, {thickness, density, holes});
    this.element = element(
      'span',
      {class: 'draw-plate', hidden: true},
      thickness_label,
      material,
      density_label,
      holes_label
    );
  }

  get values() {
    const number = (text) => (text.trim() !== '' && Number.isFinite(Number(text)) ? Number(text) : text.trim());
    const out = {thickness: number(this.thickness.value), density: number(this.density.value)};
    if (this.holes.value.trim()) out.holes = this.holes.value;
    return out;
  }
}

/// The toolbar and the sheet over the picture. `ask(request, options)` sends requests; `selected(names)` is told of the
/// items that are chosen, and returns those of them that there are.
export class DrawingTools {
  constructor(moving, tools, ask, selected) {
    Object.assign(this, {moving, ask, picture: moving.picture, tools, tool: null, picked: [], at: null, sheet: null});
    this.snaps = true;
    this.marks = svgElement('g', {class: 'draw-marks'});
    this.picture.overlay.append(this.marks);
    this.cover = element('div', {
      class: 'draw-cover',
      hidden: true,
      pointermove: (event) => this.move(event),
      pointerdown: (event) => this.down(event),
      pointerup: (event) => this.up(event),
      pointercancel: () => this.drop(),
      pointerleave: () => this.leave(),
      dblclick: () => this.end(),
    });
    moving.stage.append(this.cover);
    this.hint = element('span', {class: 'hint draw-hint', role: 'status', 'aria-live': 'polite'});
    this.typed = element('input', {
      type: 'text',
      class: 'draw-typed',
      'aria-label': 'Place: x, y; or length < angle',
      placeholder: 'x, y or length < angle',
      keydown: (event) => this.typedKey(event),
    });
    this.typed_line = element('label', {class: 'draw-exact', hidden: true}, 'Exactly ', this.typed);
    this.buttons = new Map();
    const make = (name, title, hint) => {
      const choose = (event) => {
        this.choose(name);
        // Whoever has no pointer goes on typing.
        if (event.detail === 0 && !this.typed_line.hidden) this.typed.focus();
      };
      const one = button(title, choose, {title: hint, 'data-tool': name, 'aria-pressed': 'false'});
      this.buttons.set(name, one);
      return one;
    };
    const groups = [...new Set(tools.map((tool) => tool.group))];
    this.element = element(
      'div',
      {class: 'draw-tools', role: 'toolbar', 'aria-label': 'Drawing tools'},
      make('', 'Move', 'Drag points, the ground and loads (Escape)'),
      make('select', 'Select', 'Click an item to rename or delete it'),
      make('move_point', 'Shape', 'Drag a point: the links there change their shape'),
      ...groups.map((group) =>
        menu(group, ...tools.filter((tool) => tool.group === group).map((tool) => make(tool.name, tool.title, tool.hint)))
      ),
      checkbox('Grid', true, (on) => {
        this.snaps = on;
      }),
      this.typed_line,
      (this.plate = new PlateFields()).element,
      (this.selection = new Selection(this, ask, selected)).element,
      this.hint
    );
    document.addEventListener('keydown', (event) => this.key(event));
    this.choose('');
  }

  /// Takes over where the plane and its points are.
  update(sheet) {
    this.sheet = sheet;
    this.draw();
  }

  choose(name) {
    // What has all its places is drawn: a tool is often left without a word.
    if (this.tool && this.picked.length >= this.tool.picks) this.end();
    this.drop();
    this.tool = own_tools[name] ?? this.tools.find((tool) => tool.name === name) ?? null;
    if (name !== 'select') this.selection.choose([]);
    this.show(name);
  }

  /// A tool that is none of the toolbar, with its first places; the tool to select follows it.
  use(tool, places) {
    this.drop();
    this.tool = tool;
    this.show(tool.name);
    this.picked = places;
    this.pressed = [...places];
    for (const box of this.selection.element.querySelectorAll('.menu')) box.open = false;
    this.draw();
  }

  show(name) {
    this.moving.stage.classList.toggle('selecting', name === 'select');
    this.picked = [];
    this.pressed = [];
    this.typed_places = [];
    for (const [known, one] of this.buttons) one.setAttribute('aria-pressed', known === name);
    for (const box of this.element.querySelectorAll('.menu')) {
      box.open = false;
      box.classList.toggle('chosen', box.querySelector('[aria-pressed="true"]') !== null);
    }
    this.cover.hidden = this.tool === null;
    this.typed_line.hidden = this.tool === null || Object.hasOwn(own_tools, name);
    this.plate.element.hidden = name !== 'plate';
    // Its keys are those of the page again.
    if (this.typed_line.hidden) this.typed.blur();
    this.at = null;
    this.selection.show(name === 'select' || this.tool?.request !== undefined);
    this.tell();
    this.draw();
  }

  key(event) {
    if (this.tool === null || event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.key === 'Escape') {
      event.preventDefault();
      if (this.held) this.giveUp();
      else if (this.tool.request) this.choose('select');
      else if (this.picked.length > 0) this.forget();
      else if (this.selection.items.length > 0) this.selection.choose([]);
      else this.choose('');
    } else if (['Delete', 'Backspace'].includes(event.key) && !event.target.closest('input, textarea')) {
      event.preventDefault();
      this.selection.remove();
    } else if (event.key === 'Enter' && event.target !== this.typed && this.picked.length > 0) {
      event.preventDefault();
      this.end();
    }
  }

  typedKey(event) {
    if (event.key !== 'Enter') return;
    event.preventDefault();
    event.stopPropagation();
    if (this.typed.value.trim() === '') {
      this.end();
      return;
    }
    const place = typedPlace(this.typed.value, this.picked.at(-1), this.sheet.angle === 'deg');
    this.typed.setAttribute('aria-invalid', place === null);
    if (place === null) {
      this.refuse('Expected a place, "120, 45", or a length and an angle from the place before, "100 < 60".');
      return;
    }
    this.typed.value = '';
    this.tell();
    this.typed_places.push(this.picked.length);
    this.pick(place);
  }

  // What the tool asks for.
  tell() {
    this.hint.classList.remove('refused');
    this.hint.textContent = this.tool ? `${this.tool.title}: ${this.tool.hint}` : '';
  }

  /// Says why something was not drawn, where the hand is.
  refuse(text) {
    this.hint.classList.add('refused');
    this.hint.textContent = text;
  }

  // px of the screen for a unit of length.
  get density() {
    const box = this.picture.svg.getBoundingClientRect();
    return this.sheet.scale * Math.min(box.width / this.picture.box.width, box.height / this.picture.box.height);
  }

  get grain() {
    return 10 ** Math.floor(Math.log10(1 / this.density) - 0.5);
  }

  get grid() {
    return stepBelow((2.5 * least_grid) / this.density);
  }

  toPlane({x, y}) {
    const [left, top] = this.sheet.origin;
    return [(x - left) / this.sheet.scale, (top - y) / this.sheet.scale];
  }

  toPage([x, y]) {
    const [left, top] = this.sheet.origin;
    return [left + this.sheet.scale * x, top - this.sheet.scale * y];
  }

  // The place that is meant, and why.
  meant(event) {
    const place = this.toPlane(this.picture.toPage(event.clientX, event.clientY));
    const {density} = this;
    const far = ([x, y]) => density * Math.hypot(x - place[0], y - place[1]);
    const points = [...this.sheet.points, ...this.picked.map((at) => ({at, name: ''}))];
    const nearest = points.reduce((best, one) => (best && far(best.at) <= far(one.at) ? best : one), null);
    if (nearest && far(nearest.at) <= near_point) return {at: nearest.at, pressed: nearest.at, name: nearest.name};
    const {grid} = this;
    const step = this.snaps ? grid : this.grain;
    const at = place.map((value) => tidy(Math.round(value / step) * step, this.grain));
    const before = this.picked.at(-1);
    if (before && this.snaps) {
      if (density * Math.abs(place[1] - before[1]) < near_line) at[1] = before[1];
      else if (density * Math.abs(place[0] - before[0]) < near_line) at[0] = before[0];
    }
    return {at, pressed: place, name: ''};
  }

  move(event) {
    if (!this.tool || !this.sheet) return;
    this.at = this.meant(event);
    if (this.box) {
      const [x, y] = this.box.client;
      this.box.to = this.at.pressed;
      this.box.is_drawn = this.box.is_drawn || Math.hypot(event.clientX - x, event.clientY - y) > least_box;
    }
    if (this.held) {
      this.held.moved = true;
      this.placeHeld(true);
    }
    this.draw();
  }

  leave() {
    if (this.held) return;
    this.at = null;
    this.draw();
  }

  down(event) {
    if (!this.tool || event.button !== 0) return;
    event.preventDefault();
    event.stopPropagation();
    this.moving.finish();
    this.at = this.meant(event);
    if (this.tool.name === 'select') {
      const place = this.toPlane(this.picture.toPage(event.clientX, event.clientY));
      this.cover.setPointerCapture(event.pointerId);
      this.box = {from: place, to: place, client: [event.clientX, event.clientY], is_drawn: false};
    } else if (this.tool.name !== 'move_point') {
      this.pick(this.at.at, this.at.pressed);
    } else if (this.at.name) {
      this.cover.setPointerCapture(event.pointerId);
      this.held = {point: this.at.name, moved: false};
    }
  }

  // The sheet lies over the picture.
  itemAt(event) {
    this.cover.style.pointerEvents = 'none';
    const name = this.picture.nameAt(event.clientX, event.clientY);
    this.cover.style.pointerEvents = '';
    // The picture says of some how they stand: "crank: at 60 deg".
    return name.split(': ')[0];
  }

  // Shift keeps what is chosen already.
  select(event, {from, to, is_drawn}) {
    const {selection} = this;
    if (is_drawn) {
      const found = selection.inBox(from, to);
      selection.choose(event.shiftKey ? [...selection.items, ...found] : found);
    } else {
      const name = this.itemAt(event) || this.at.name;
      if (event.shiftKey && name) selection.toggle(name);
      else if (!event.shiftKey) selection.choose(name ? [name] : []);
    }
    this.hint.textContent =
      selection.items.length > 0 ? `${selection.words}: Delete takes away.` : `Select: ${own_tools.select.hint}`;
  }

  up(event) {
    if (this.box) {
      const {box} = this;
      this.box = null;
      this.select(event, box);
    }
    if (!this.held) return;
    if (this.held.moved) this.placeHeld(false);
    this.held = null;
  }

  drop() {
    this.held = this.box = null;
  }

  // The point goes back to where it was.
  giveUp() {
    const {moved} = this.held;
    if (moved) this.placeHeld(false);
    this.held = null;
    if (moved) this.ask({do: 'undo'});
  }

  placeHeld(goes_on) {
    const {point} = this.held;
    const request = {do: 'place', point, at: this.at.at, grain: this.grain};
    if (goes_on) request.goes_on = true;
    this.ask(request, {gesture: goes_on ? `place ${point}` : undefined});
  }

  // A place, and where the hand was, by which points and links are meant.
  pick(at, pressed = at) {
    const before = this.picked.at(-1);
    const again = before && Math.hypot(before[0] - at[0], before[1] - at[1]) < this.grain;
    // A second click on the last place ends what may go on; a double click is one.
    if (again) {
      this.end();
      return;
    }
    this.picked.push(at);
    this.pressed.push(pressed);
    if (this.picked.length >= this.tool.picks && !this.tool.more) this.end();
    else this.draw();
  }

  end() {
    if (!this.tool || this.picked.length < this.tool.picks) return;
    const [at, pressed, typed] = [this.picked, this.pressed, this.typed_places];
    const own_request = this.tool.request;
    this.forget();
    if (own_request) {
      this.choose('select');
      this.ask(own_request(at));
      return;
    }
    this.tell();
    const request = {do: 'draw', tool: this.tool.name, at, pressed, typed, within: near_point / this.density, grain: this.grain};
    if (this.tool.name === 'plate') request.values = this.plate.values;
    this.ask(request);
  }

  forget() {
    this.picked = [];
    this.pressed = [];
    this.typed_places = [];
    this.draw();
  }

  // Lines through the multiples of the grid's step that are in view.
  gridLines() {
    const {box} = this.picture;
    const [left, top] = this.sheet.origin;
    const step = this.grid * this.sheet.scale;
    const lines = [];
    for (let x = left + Math.ceil((box.x - left) / step) * step; x < box.x + box.width; x += step)
      lines.push(`M${x.toFixed(2)},${box.y}v${box.height}`);
    for (let y = top + Math.ceil((box.y - top) / step) * step; y < box.y + box.height; y += step)
      lines.push(`M${box.x},${y.toFixed(2)}h${box.width}`);
    return lines.join('');
  }

  // Sets the name of a point beside it where it covers no other text; where there is no such place it is left out.
  nameLoose(x, y, name) {
    const text = svgElement('text', {class: 'draw-reading'}, name);
    const others = [...this.picture.svg.querySelectorAll('text')].map((one) => one.getBoundingClientRect());
    this.marks.append(text);
    for (const [dx, dy, anchor] of [[6, -5, 'start'], [6, 13, 'start'], [-6, -5, 'end'], [-6, 13, 'end']]) {
      for (const [key, value] of Object.entries({x: x + dx, y: y + dy, 'text-anchor': anchor})) text.setAttribute(key, value);
      const box = text.getBoundingClientRect();
      const covers = ({left, right, top, bottom}) =>
        left < box.right && right > box.left && top < box.bottom && bottom > box.top;
      if (!others.some(covers)) return;
    }
    text.remove();
  }

  draw() {
    this.marks.replaceChildren();
    if (!this.sheet) return;
    const draw = (tag, attributes, ...children) => this.marks.append(svgElement(tag, attributes, ...children));
    // The picture shows those points of the ground alone that hold something.
    for (const {name, at, loose} of this.sheet.points) {
      if (!loose) continue;
      const [x, y] = this.toPage(at);
      draw('path', {class: 'draw-loose', d: `M${x - 4},${y}h8M${x},${y - 4}v8`});
      this.nameLoose(x, y, name.slice(name.lastIndexOf('.') + 1));
    }
    const outline = (style, places) => {
      const points = places.map((at) => this.toPage(at).join(',')).join(' ');
      draw(places.length > 2 ? 'polygon' : 'polyline', {class: style, points});
    };
    for (const places of this.selection.marks) outline('draw-chosen', places);
    if (!this.tool) return;
    if (this.box?.is_drawn) {
      const [[ax, ay], [bx, by]] = [this.toPage(this.box.from), this.toPage(this.box.to)];
      const [width, height] = [Math.abs(bx - ax), Math.abs(by - ay)];
      draw('rect', {class: 'draw-box', x: Math.min(ax, bx), y: Math.min(ay, by), width, height});
    }
    const meant = [...this.picked, ...(this.at ? [this.at.at] : [])];
    if (this.tool.ghosts && meant.length > 0)
      for (const places of this.tool.ghosts(meant)) outline('draw-ghost', places);
    if (this.snaps && this.tool.name !== 'select') draw('path', {class: 'draw-grid', d: this.gridLines()});
    const places = this.tool.name === 'select' ? [] : meant.map((at) => this.toPage(at));
    if (places.length > 1)
      draw('polyline', {class: 'draw-line', points: places.map((place) => place.join(',')).join(' ')});
    for (const [x, y] of places) draw('circle', {class: 'draw-place', cx: x, cy: y, r: 4});
    if (!this.at || this.box?.is_drawn) return;
    const [x, y] = this.at.at;
    const parts = [`${numberText(x, 6)}, ${numberText(y, 6)} ${this.sheet.unit}`];
    if (this.at.name) parts.unshift(this.at.name);
    const before = this.picked.at(-1);
    if (before) {
      const [dx, dy] = [x - before[0], y - before[1]];
      const length = Math.hypot(dx, dy);
      const angle = (Math.atan2(dy, dx) * 180) / Math.PI;
      parts.push(`${numberText(length, 5)} ${this.sheet.unit} < ${numberText(angle, 4)}°`);
    }
    const [px, py] = this.toPage(this.at.at);
    const text = svgElement('text', {class: 'draw-reading', x: px + 10, y: py - 10}, parts.join(' · '));
    this.marks.append(text);
  }
}

/// The panel with all items, which can be renamed and taken away.
/// `choose(item)`: an item is chosen, or not any more.
export class ItemsPanel {
  constructor(ask, choose) {
    Object.assign(this, {ask, choose, key: '', chosen: []});
    this.list = element('div', {class: 'items-list'});
    this.none = element('p', {class: 'hint'}, 'Nothing is drawn yet: choose a tool above the sheet.');
    this.element = element('div', {}, this.none, this.list);
  }

  /// Shows the items, and returns those that are new; points of links go with these.
  update(items) {
    const key = JSON.stringify(items);
    if (key === this.key) return [];
    const known = [...this.list.children].map((row) => row.dataset.item);
    this.key = key;
    const {chosen} = this;
    this.none.hidden = items.length > 0;
    this.list.replaceChildren(
      ...items.map(({item, name, point, part}) => {
        const field = element('input', {
          type: 'text',
          'aria-label': `Name of ${item}`,
          change: () => {
            if (field.value !== name) this.ask({do: 'rename', item, name: field.value});
          },
        });
        field.value = name;
        field.readOnly = part;
        const kind = item.endsWith(` ${name}`) ? item.slice(0, -name.length - 1) : 'link';
        const box = element('input', {type: 'checkbox', 'aria-label': `Choose ${item}`, change: () => this.choose(item)});
        return element(
          'div',
          {class: 'item-row', 'data-item': item},
          box,
          element('span', {class: 'item-kind'}, point ? `point of ${item.slice(0, -name.length - 1)}` : kind),
          field,
          part
            ? button('Ungroup', () => this.ask({do: 'ungroup', part: name}), {class: 'quiet', 'aria-label': `Ungroup ${item}`})
            : button('Delete', () => this.ask({do: 'remove', items: [item]}), {
                class: 'quiet',
                'aria-label': `Delete ${item}`,
              })
        );
      })
    );
    this.mark(chosen);
    return items.filter(({item, point}) => !known.includes(item) && !(point && !item.startsWith('ground.'))).map(({item}) => item);
  }

  /// Marks items, and returns those of them that there are.
  mark(names) {
    this.chosen = [];
    for (const row of this.list.children) {
      const is_chosen = names.includes(row.dataset.item);
      row.classList.toggle('marked', is_chosen);
      row.querySelector('[type="checkbox"]').checked = is_chosen;
      if (is_chosen) this.chosen.push(row.dataset.item);
    }
    return this.chosen;
  }

  /// Brings the first that is marked into view.
  reveal() {
    this.list.querySelector('.marked')?.scrollIntoView({block: 'nearest'});
  }

  /// Shows the names again as they are where another was refused.
  refuse() {
    this.key = '';
  }
}
