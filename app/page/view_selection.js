// Several items that are chosen at once: they are copied, mirrored, repeated, moved and taken away together. Members of
// a group are chosen together, for as long as the page is open.

import {button, element, menu, numberText} from './dom.js';

function bodyOf(point) {
  return point.slice(0, point.lastIndexOf('.'));
}

// The reflection of a place about the line through two others.
function reflected([x, y], [ax, ay], [bx, by]) {
  const [ux, uy] = [bx - ax, by - ay];
  const along = (2 * ((x - ax) * ux + (y - ay) * uy)) / (ux * ux + uy * uy);
  return [2 * ax + along * ux - x, 2 * ay + along * uy - y];
}

function numberField(label, value, options = {}) {
  const field = element('input', {type: 'number', step: 'any', ...options});
  field.value = value;
  return {field, row: element('label', {class: 'selection-field'}, label, field)};
}

/// What is chosen. `drawing`: the tools by which places are picked; `changed(items)` is told, and returns those of them
/// that there are.
export class Selection {
  constructor(drawing, ask, changed) {
    Object.assign(this, {drawing, ask, changed, items: [], groups: [], copied: []});
    this.title = element('span', {class: 'selection-title'});
    const group = button('Group', () => this.group(), {title: 'From now on these are chosen together'});
    const ungroup = button('Ungroup', () => this.ungroup());
    Object.assign(this, {group_button: group, ungroup_button: ungroup});
    this.element = element(
      'div',
      {class: 'draw-selection', role: 'toolbar', 'aria-label': 'Chosen items', hidden: true},
      this.title,
      button('Copy', () => this.place('copy', this.items), {title: 'Ctrl+C, then Ctrl+V'}),
      button('Move items', () => this.place('move', this.items), {title: 'Takes the items themselves elsewhere'}),
      menu(
        'Mirror',
        button('About a line', () => this.mirror()),
        button('About a vertical line', () => this.mirror([0, 1])),
        button('About a horizontal line', () => this.mirror([1, 0]))
      ),
      this.arrayMenu(),
      group,
      ungroup,
      button('Delete', () => this.remove(), {title: 'Delete'}),
      button('None', () => this.choose([]), {class: 'quiet', title: 'Choose nothing'})
    );
    document.addEventListener('keydown', (event) => this.key(event));
  }

  get angle_unit() {
    return this.drawing.sheet?.angle ?? 'rad';
  }

  arrayMenu() {
    const count = numberField('Copies', 1, {min: 1, max: 1000, step: 1});
    const dx = numberField('Step in x', 0);
    const dy = numberField('Step in y', 0);
    const turn = numberField('Turn', 0);
    const about_x = numberField('About x', 0);
    const about_y = numberField('About y', 0);
    const value = ({field}) => Number(field.value);
    const make = button('Make', () => {
      const request = {do: 'copy', items: this.items, times: value(count), move: [value(dx), value(dy)]};
      if (value(turn) !== 0) Object.assign(request, {turn: value(turn), about: [value(about_x), value(about_y)]});
      box.open = false;
      this.ask(request);
    });
    const rows = [count, dx, dy, turn, about_x, about_y].map(({row}) => row);
    const box = menu('Array', ...rows, make);
    box.addEventListener('toggle', () => {
      const unit = this.drawing.sheet?.unit ?? '';
      for (const {row, title} of [
        {row: dx.row, title: `Step in x, ${unit} `},
        {row: dy.row, title: `Step in y, ${unit} `},
        {row: turn.row, title: `Turn, ${this.angle_unit} `},
        {row: about_x.row, title: `About x, ${unit} `},
        {row: about_y.row, title: `About y, ${unit} `},
      ])
        row.firstChild.textContent = title;
    });
    return box;
  }

  /// Chooses items, with all that are in a group with one of them.
  choose(names) {
    const whole = new Set(names);
    for (const group of this.groups) {
      if (group.some((name) => whole.has(name))) group.forEach((name) => whole.add(name));
    }
    this.items = this.changed([...whole]);
    const {items} = this;
    for (const one of this.element.querySelectorAll(':scope > button')) one.disabled = items.length === 0;
    for (const box of this.element.querySelectorAll('.menu')) box.inert = items.length === 0;
    const many = items.length > 0 ? `${items.length} items: ${items.join(', ')}` : 'Nothing is chosen';
    this.title.textContent = items.length === 1 ? items[0] : many;
    const is_group = this.groups.some((group) => group.every((name) => items.includes(name)));
    this.group_button.hidden = items.length < 2 || is_group;
    this.ungroup_button.hidden = !is_group;
    this.drawing.draw();
  }

  /// The bar is there as long as items can be chosen, so that the picture stays where it is.
  show(is_shown) {
    this.element.hidden = !is_shown;
  }

  /// From the list of all items.
  toggle(name) {
    if (this.element.hidden) this.drawing.choose('select');
    const group = this.groups.find((one) => one.includes(name)) ?? [name];
    if (this.items.includes(name)) this.choose(this.items.filter((one) => !group.includes(one)));
    else this.choose([...this.items, name]);
  }

  /// Forgets what is not there any more, after a change of the items.
  keep(known) {
    const has = (name) => known.some(({item}) => item === name);
    this.groups = this.groups.map((group) => group.filter(has)).filter((group) => group.length > 1);
    this.copied = this.copied.filter(has);
    if (!this.items.every(has)) this.choose(this.items.filter(has));
  }

  group() {
    const members = [...this.items];
    this.groups = [...this.groups.filter((group) => !group.some((name) => members.includes(name))), members];
    this.choose(members);
  }

  ungroup() {
    this.groups = this.groups.filter((group) => !group.every((name) => this.items.includes(name)));
    this.choose(this.items);
  }

  remove() {
    if (this.items.length === 0) return;
    this.ask({do: 'remove', items: this.items});
    this.choose([]);
  }

  /// The links and points of the ground that a box of the plane holds as a whole.
  inBox([ax, ay], [bx, by]) {
    const is_in = ([x, y]) =>
      x >= Math.min(ax, bx) && x <= Math.max(ax, bx) && y >= Math.min(ay, by) && y <= Math.max(ay, by);
    const {points} = this.drawing.sheet;
    const bodies = [...new Set(points.map(({name}) => bodyOf(name)))].filter((body) => body !== 'ground');
    const whole = bodies.filter((body) => points.every(({name, at}) => bodyOf(name) !== body || is_in(at)));
    const fixed = points.filter(({name, at}) => bodyOf(name) === 'ground' && is_in(at)).map(({name}) => name);
    return [...whole, ...fixed];
  }

  // Lines through the points of the chosen links, where a motion takes them.
  outlines(items, motion) {
    const of_body = new Map(items.map((name) => [name, []]));
    for (const {name, at} of this.drawing.sheet.points) {
      of_body.get(bodyOf(name))?.push(motion(at));
      if (of_body.has(name)) of_body.get(name).push(motion(at));
    }
    return [...of_body.values()].filter((places) => places.length > 0);
  }

  // The points that the items begin with: it comes where the copy is placed.
  handleOf(items) {
    const {points} = this.drawing.sheet;
    return points.find(({name}) => items.includes(bodyOf(name))) ?? points.find(({name}) => items.includes(name));
  }

  place(what, items) {
    const handle = this.handleOf(items);
    if (!handle) {
      this.drawing.refuse('Choose a link or a point of the ground as well.');
      return;
    }
    const chosen = [...items];
    const title = what === 'copy' ? 'Copy' : 'Move items';
    this.drawing.use(
      {
        name: `${what}_items`,
        title,
        picks: 2,
        hint: `Click where ${handle.name} comes, or type the place; or length < angle from where it is.`,
        request: ([from, to]) => ({do: what, items: chosen, move: [to[0] - from[0], to[1] - from[1]]}),
        ghosts: ([from, to]) =>
          to ? this.outlines(chosen, ([x, y]) => [x + to[0] - from[0], y + to[1] - from[1]]) : [],
      },
      [handle.at]
    );
  }

  mirror(direction = null) {
    const chosen = [...this.items];
    const lineOf = ([a, b]) => [a, direction ? [a[0] + direction[0], a[1] + direction[1]] : b];
    const along = direction && direction[0] === 0 ? 'vertical' : 'horizontal';
    this.drawing.use(
      {
        name: 'mirror_items',
        title: 'Mirror',
        picks: direction ? 1 : 2,
        hint: direction ? `Click a point of the ${along} line, or type it.` : 'Click two points of the line, or type them.',
        request: (places) => ({do: 'copy', items: chosen, mirror: lineOf(places)}),
        ghosts: (places) => {
          const [a, b] = lineOf(places);
          const is_line = a && b && Math.hypot(b[0] - a[0], b[1] - a[1]) > 0;
          return is_line ? this.outlines(chosen, (at) => reflected(at, a, b)) : [];
        },
      },
      []
    );
  }

  key(event) {
    if (!(event.ctrlKey || event.metaKey) || event.altKey || event.shiftKey) return;
    const key = event.key.toLowerCase();
    if (!['c', 'v'].includes(key) || event.target.closest('textarea, select, input:not([type="checkbox"])')) return;
    if (key === 'c' && this.items.length > 0 && String(getSelection()) === '') {
      event.preventDefault();
      this.copied = [...this.items];
      this.drawing.hint.textContent = `Copied: Ctrl+V places ${this.copied.length === 1 ? this.copied[0] : 'them'}.`;
    } else if (key === 'v' && this.copied.length > 0) {
      event.preventDefault();
      this.place('copy', this.copied);
    }
  }

  /// What the sheet shows of it: the outlines of what is chosen.
  get marks() {
    return this.outlines(this.items, (at) => at);
  }

  /// How many there are, in words, for the line below the tools.
  get words() {
    return this.items.length === 1 ? this.items[0] : `${numberText(this.items.length)} items`;
  }
}
