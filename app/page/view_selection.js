// Several items that are chosen at once: they are copied, mirrored, repeated, moved and taken away together. A group is a
// part of the scene, whose items are chosen as one.

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
    Object.assign(this, {drawing, ask, changed, items: [], parts: [], copied: []});
    this.title = element('span', {class: 'selection-title'});
    this.group_menu = this.groupMenu();
    this.ungroup_button = button('Ungroup', () => this.ungroup(), {title: 'Its items become the scene’s own'});
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
      this.group_menu,
      this.ungroup_button,
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

  // A part of its own file that the chosen items become.
  groupMenu() {
    const field = element('input', {type: 'text', placeholder: 'part_1', size: 10});
    const make = () => {
      const request = {do: 'group', items: this.items};
      if (field.value.trim()) request.name = field.value.trim();
      field.value = '';
      box.open = false;
      this.ask(request);
    };
    field.addEventListener('keydown', (event) => event.key === 'Enter' && make());
    const box = menu(
      'Group',
      element('label', {class: 'selection-field'}, 'Name', field),
      button('Make a part', make, {title: 'Its items go into a file of its own, beside the scene’s'})
    );
    return box;
  }

  // The item of the list that has a name of the picture: "part lift" of "lift.rod" and "pin lift.B".
  listed(name) {
    return this.parts.find((part) => ` ${name}`.includes(` ${part.name}.`))?.item ?? name;
  }

  /// Chooses items; of a part it is the whole part.
  choose(names) {
    this.items = this.changed([...new Set(names.map((name) => this.listed(name)))]);
    const {items} = this;
    const part = this.parts.find(({item}) => items.includes(item));
    for (const one of this.element.querySelectorAll(':scope > button, :scope > .menu')) {
      const stays = one === this.ungroup_button || one.classList.contains('quiet');
      one[one.tagName === 'BUTTON' ? 'disabled' : 'inert'] = items.length === 0 || (part !== undefined && !stays);
    }
    const many = items.length > 0 ? `${items.length} items: ${items.join(', ')}` : 'Nothing is chosen';
    this.title.textContent = items.length === 1 ? items[0] : many;
    this.group_menu.hidden = part !== undefined;
    this.ungroup_button.hidden = part === undefined || items.length > 1;
    this.drawing.draw();
  }

  /// The bar is there as long as items can be chosen, so that the picture stays where it is.
  show(is_shown) {
    this.element.hidden = !is_shown;
  }

  /// From the list of all items.
  toggle(name) {
    if (this.element.hidden) this.drawing.choose('select');
    const item = this.listed(name);
    if (this.items.includes(item)) this.choose(this.items.filter((one) => one !== item));
    else this.choose([...this.items, item]);
  }

  /// Forgets what is not there any more, after a change of the items.
  keep(known) {
    const has = (name) => known.some(({item}) => item === name);
    this.parts = known.filter(({part}) => part);
    this.copied = this.copied.filter(has);
    if (!this.items.every(has)) this.choose(this.items.filter(has));
  }

  ungroup() {
    const {name} = this.parts.find(({item}) => this.items.includes(item));
    this.ask({do: 'ungroup', part: name});
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
      of_body.get(this.listed(name) === name ? bodyOf(name) : this.listed(name))?.push(motion(at));
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
