// All numbers of a scene, each with a slider and a field, and its items that can be switched off.

import {checkbox, element} from './dom.js';

// A slider has about so many steps.
const slider_steps = 400;
const group_titles = {
  loads: 'Loads',
  gravity: 'Gravity',
  springs: 'Springs',
  dampers: 'Dampers',
  stops: 'Stops',
  couplings: 'Couplings',
  dimensions: 'Dimensions',
  masses: 'Masses',
  others: 'Others',
};

// 1, 2 or 5 times a power of ten, not above.
function niceStep(length) {
  if (!(length > 0)) return 1;
  const power = 10 ** Math.floor(Math.log10(length));
  const factor = [5, 2, 1].find((candidate) => candidate * power <= length * 1.0001) ?? 1;
  return factor * power;
}

// Without the digits that only conversion of units brings.
function fieldText(value) {
  return String(Number(value.toPrecision(12)));
}

function sliderText(value, step) {
  const digits = Math.max(0, Math.min(12, -Math.floor(Math.log10(step) + 1e-9)));
  return String(Number(value.toFixed(digits)));
}

class NumberRow {
  constructor(panel, number) {
    this.panel = panel;
    this.moving = false;
    this.low = number.low;
    this.high = number.high;
    this.slider = element('input', {
      type: 'range',
      'aria-label': `${number.group}: ${number.name}`,
      input: (event) => this.slide(event),
      change: () => this.letGo(),
    });
    this.field = element('input', {
      type: 'number',
      step: 'any',
      'aria-label': `${number.group}: ${number.name}${number.unit ? ` in ${number.unit}` : ''}`,
      change: () => this.typed(),
      keydown: (event) => {
        if (event.key !== 'Escape') return;
        this.field.value = fieldText(this.number.value);
        this.complain('');
      },
    });
    this.error = element('p', {class: 'number-error', role: 'alert', hidden: true});
    this.element = element(
      'div',
      {class: 'number', 'data-number': number.path},
      element('span', {class: 'number-name'}, number.name),
      this.slider,
      element('span', {class: 'number-field'}, this.field, element('span', {class: 'unit'}, number.unit)),
      this.error
    );
    this.update(number);
  }

  update(number) {
    this.number = number;
    if (this.moving) return;
    this.reach(number.value);
    this.slider.value = number.value;
    this.slider.setAttribute('aria-valuetext', `${fieldText(number.value)} ${number.unit}`.trim());
    if (document.activeElement !== this.field || !this.panel.isTyping(this.field)) {
      this.field.value = fieldText(number.value);
      this.panel.shown.set(this.field, this.field.value);
    }
  }

  // The range stays what it was at first, so that a slider does not run away from the pointer; it grows where a number
  // is outside.
  reach(value) {
    const room = 0.25 * Math.max(this.high - this.low, Math.abs(value));
    if (value < this.low) this.low = value - (value >= 0 ? Math.min(room, value) : room);
    if (value > this.high) this.high = value + room;
    const step = this.number.whole ? 1 : niceStep((this.high - this.low) / slider_steps);
    this.step = step;
    this.slider.min = sliderText(Math.floor(this.low / step) * step, step);
    this.slider.max = sliderText(Math.ceil(this.high / step) * step, step);
    this.slider.step = step;
  }

  slide(event) {
    this.moving = true;
    const value = Number(sliderText(Number(this.slider.value), this.step));
    this.field.value = String(value);
    this.panel.shown.set(this.field, this.field.value);
    this.slider.setAttribute('aria-valuetext', `${value} ${this.number.unit}`.trim());
    this.complain('');
    this.send(value, true, event.timeStamp);
  }

  letGo() {
    if (!this.moving) return;
    this.moving = false;
    // Ends the gesture, and brings all numbers.
    this.panel.ask({do: 'look'}, {note: 'gesture'});
  }

  typed() {
    if (this.field.value === this.panel.shown.get(this.field)) return;
    const value = this.field.valueAsNumber;
    if (!Number.isFinite(value)) {
      this.refuse('A number is expected.');
      return;
    }
    this.panel.shown.set(this.field, this.field.value);
    this.complain('');
    this.send(value, false, null);
  }

  send(value, goes_on, time) {
    const {path} = this.number;
    const request = {do: 'set', path, value};
    if (goes_on) request.goes_on = true;
    this.panel.ask(request, {gesture: goes_on ? `set ${path}` : '', time});
  }

  /// Says why a value cannot be, and shows the one that is.
  refuse(text) {
    this.complain(text);
    this.slider.value = this.number.value;
    this.field.value = fieldText(this.number.value);
    this.panel.shown.set(this.field, this.field.value);
  }

  complain(text) {
    this.error.hidden = text === '';
    this.error.textContent = text;
    this.field.setAttribute('aria-invalid', text !== '');
  }
}

/// The panel with all numbers. `ask(request, options)` sends requests.
export class NumbersPanel {
  constructor(ask) {
    Object.assign(this, {ask, rows: new Map(), groups: [], shown: new WeakMap(), words: ''});
    this.search = element('input', {
      type: 'search',
      placeholder: 'Search numbers',
      'aria-label': 'Search numbers',
      input: () => {
        this.words = this.search.value.toLowerCase().trim();
        this.filter();
      },
    });
    this.none = element('p', {class: 'hint', hidden: true}, 'No number has this in its name.');
    this.list = element('div', {class: 'numbers'});
    this.element = element('div', {}, this.search, this.list, this.none);
  }

  isTyping(field) {
    return field.value !== this.shown.get(field);
  }

  update(numbers) {
    const same = numbers.length === this.rows.size && numbers.every((number) => this.rowOf(this.rows, number));
    if (same) numbers.forEach((number) => this.rows.get(number.path).update(number));
    else this.build(numbers);
  }

  /// Shows the values of numbers that a gesture has changed elsewhere: that of a point which is dragged, say.
  follow(changed) {
    for (const {path, value} of changed) {
      const row = this.rows.get(path);
      if (row && !row.moving) row.update({...row.number, value});
    }
  }

  // In another unit a number is another one, with a range of its own.
  rowOf(rows, {path, unit}) {
    const row = rows.get(path);
    return row?.number.unit === unit ? row : undefined;
  }

  build(numbers) {
    const old = this.rows;
    this.rows = new Map();
    for (const number of numbers) {
      const row = this.rowOf(old, number) ?? new NumberRow(this, number);
      row.update(number);
      this.rows.set(number.path, row);
    }
    const names = [...new Set(numbers.map(({group}) => group))];
    this.groups = names.map((name) => {
      const rows = numbers.filter(({group}) => group === name).map(({path}) => this.rows.get(path));
      const box = element(
        'section',
        {class: 'number-group'},
        element('h3', {}, group_titles[name] ?? name),
        ...rows.map((row) => row.element)
      );
      return {box, rows};
    });
    this.list.replaceChildren(...this.groups.map(({box}) => box));
    this.search.hidden = numbers.length < 8;
    this.filter();
  }

  filter() {
    let any = false;
    for (const {box, rows} of this.groups) {
      for (const row of rows)
        row.element.hidden = this.words !== '' && !row.number.path.toLowerCase().includes(this.words);
      box.hidden = rows.every((row) => row.element.hidden);
      any ||= !box.hidden;
    }
    this.none.hidden = any || this.words === '';
  }

  /// Says at a number why its value cannot be. False where there is no such number.
  refuse(path, text) {
    const row = this.rows.get(path);
    row?.refuse(text);
    return row !== undefined;
  }
}

/// The panel with all items that can be switched off.
export class SwitchesPanel {
  constructor(ask) {
    Object.assign(this, {ask, switches: []});
    this.list = element('div', {class: 'switches'});
    this.element = element(
      'div',
      {},
      element('p', {class: 'hint'}, 'What is switched off stays in the scene’s text as a comment.'),
      this.list
    );
  }

  update(switches) {
    const key = (list) => JSON.stringify(list);
    if (key(switches) === key(this.switches) && this.list.firstChild) return;
    const focused = document.activeElement?.dataset?.item;
    this.switches = switches;
    const groups = [...new Set(switches.map(({group}) => group))];
    this.list.replaceChildren(
      ...groups.map((group) =>
        element(
          'section',
          {},
          element('h3', {}, group_titles[group] ?? group),
          ...switches.filter((one) => one.group === group).map((one) => this.row(one))
        )
      )
    );
    if (switches.length === 0) this.list.append(element('p', {}, 'The scene has no spring, stop or load.'));
    if (focused) this.list.querySelector(`[data-item="${CSS.escape(focused)}"]`)?.focus();
  }

  row(one) {
    const row = checkbox(one.name, one.on, (on) => this.ask({do: 'switch', item: one.item, on}));
    row.classList.add('switch');
    const input = row.querySelector('input');
    input.setAttribute('role', 'switch');
    input.dataset.item = one.item;
    return element('div', {}, row, element('p', {class: 'number-error', role: 'alert', hidden: true}));
  }

  /// Says at an item why it cannot be switched.
  refuse(item, text) {
    const input = this.list.querySelector(`[data-item="${CSS.escape(item)}"]`);
    if (!input) return false;
    input.checked = this.switches.find((one) => one.item === item)?.on ?? input.checked;
    const error = input.closest('div').querySelector('.number-error');
    error.hidden = false;
    error.textContent = text;
    return true;
  }
}
