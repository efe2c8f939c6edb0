// The other equilibria of a live view: as ghosts under the mechanism and as cards.

import {button, checkbox, element, svgElement, toneClass, toneIcon} from './dom.js';
import {Picture} from './figure.js';

// A ghost shows the parts of the mechanism; what is the same everywhere, or words, is left to the picture above it.
const layers_of_ghosts = ['bodies', 'springs-and-dampers', 'joints'];

// The part of a drawing that some of its shapes take up, with a rim.
function usedBox(drawing, shapes) {
  const [xs, ys] = [[], []];
  for (const index of shapes) {
    const shape = drawing.shapes[index];
    if (!shape || shape[0] === 'text') continue;
    const numbers = Array.isArray(shape[2]) ? shape[2] : shape.slice(2, shape[0] === 'line' ? 6 : 4);
    numbers.forEach((value, i) => (i % 2 === 0 ? xs : ys).push(value));
  }
  if (xs.length === 0) return {x: 0, y: 0, width: drawing.width, height: drawing.height};
  const [left, right] = [Math.min(...xs), Math.max(...xs)];
  const [top, bottom] = [Math.min(...ys), Math.max(...ys)];
  const rim = 14 + 0.04 * Math.max(right - left, bottom - top);
  const [wide, high] = [right - left + 2 * rim, bottom - top + 2 * rim];
  // Neither a thin strip nor a tower.
  const [width, height] = [Math.max(wide, high), Math.max(high, 0.6 * wide)];
  return {x: (left + right - width) / 2, y: (top + bottom - height) / 2, width, height};
}

// So many are shown at once, unless more are asked for.
const most_ghosts = 3;

/// The panel with the other equilibria, and their ghosts in a picture. `ask(request, options)` sends requests.
export class OthersPanel {
  constructor(picture, palette, ask) {
    Object.assign(this, {picture, palette, ask, others: null, ghosts: [], suspended: false});
    Object.assign(this, {is_open: false, has_cards: false, is_whole: false, chosen: []});
    this.group = svgElement('g', {class: 'ghosts', 'aria-hidden': 'true'});
    this.picture.svg.prepend(this.group);
    this.statement = element('p', {class: 'statement', role: 'status'});
    this.cards = element('ul', {class: 'cards'});
    this.toggle = checkbox('Show them under the mechanism', true, (on) => {
      this.group.setAttribute('display', on ? 'inline' : 'none');
    });
    this.many_words = element('p', {class: 'hint'});
    this.whole_words = element('span');
    const whole = checkbox(this.whole_words, false, (on) => {
      this.is_whole = on;
      this.group.classList.toggle('whole', on);
      if (on) this.makeGhosts();
    });
    this.many = element('div', {hidden: true}, this.many_words, whole);
    this.element = element('div', {class: 'others'}, this.statement, this.toggle, this.many, this.cards);
    this.forget();
  }

  /// The equilibria are not those of the scene any more.
  forget() {
    this.others = null;
    this.group.replaceChildren();
    this.cards.replaceChildren();
    this.toggle.hidden = this.many.hidden = true;
    this.statement.textContent = 'Being looked for …';
  }

  /// They are what they were, but the program looks for them again: until then it cannot go to one of them.
  suspend() {
    if (this.suspended) return;
    this.suspended = true;
    this.disableCards();
  }

  disableCards() {
    for (const one of this.cards.querySelectorAll('button')) one.disabled = true;
  }

  /// Cards of dozens of equilibria take long to make, and whoever moves the mechanism would wait: they are made where
  /// they are seen.
  setOpen(is_open) {
    this.is_open = is_open;
    if (is_open && this.others && !this.has_cards) this.makeCards();
  }

  makeCards() {
    const {drawing, equilibria} = this.others;
    this.has_cards = true;
    this.cards.replaceChildren(...equilibria.map((one, k) => this.card(drawing, one, k)));
    if (this.suspended) this.disableCards();
  }

  show(others) {
    this.others = others;
    this.suspended = this.has_cards = false;
    this.statement.textContent = others.statement;
    this.toggle.hidden = others.equilibria.length < 2;
    const elsewhere = others.equilibria.filter((one) => !one.here);
    // The mechanism stays in stable ones.
    this.chosen = [...elsewhere].sort((a, b) => b.stable - a.stable).slice(0, most_ghosts);
    this.ghosts = others.equilibria.map(() => null);
    this.group.replaceChildren();
    this.makeGhosts();
    this.many.hidden = elsewhere.length <= most_ghosts;
    this.many_words.textContent = `${most_ghosts} of ${elsewhere.length} are shown, stable ones first, and the one whose card you point at.`;
    this.whole_words.textContent = `Show all ${elsewhere.length}`;
    this.cards.replaceChildren();
    if (this.is_open) this.makeCards();
  }

  // The ghosts that are shown though nobody points at their cards.
  makeGhosts() {
    this.others?.equilibria.forEach((one, k) => {
      if (!one.here && (this.is_whole || this.chosen.includes(one))) this.ghost(k);
    });
  }

  get count() {
    return this.others?.equilibria.filter((one) => !one.here).length ?? 0;
  }

  // Its ghost, drawn when it is first needed.
  ghost(k) {
    if (this.ghosts[k]) return this.ghosts[k];
    const {drawing, equilibria} = this.others;
    const picture = new Picture(element('div'), this.palette);
    picture.show(drawing, k);
    for (const [layer] of drawing.slots) {
      if (!layers_of_ghosts.includes(layer)) picture.hideLayer(layer, true);
    }
    picture.shapes.setAttribute('class', this.chosen.includes(equilibria[k]) ? 'ghost' : 'ghost one-of-many');
    this.group.append(picture.shapes);
    this.ghosts[k] = picture.shapes;
    return picture.shapes;
  }

  card(drawing, one, k) {
    const stage = element('div', {class: 'stage'});
    const picture = new Picture(stage, this.palette);
    picture.show(drawing, k);
    const box = usedBox(drawing, picture.state);
    picture.look(box);
    picture.svg.style.aspectRatio = `${box.width} / ${box.height}`;
    const caption = element('p', {class: `caption ${toneClass(one.tone)}`}, toneIcon(one.tone), one.caption);
    const go = one.here
      ? element('p', {class: 'hint'}, 'The mechanism is here.')
      : button('Go there', () => this.ask({do: 'go', number: k}), {'aria-label': `Go there: ${one.caption}`});
    const point = (is_meant) => () => {
      if (!one.here) this.ghost(k).classList.toggle('meant', is_meant);
    };
    return element(
      'li',
      {class: 'card', pointerenter: point(true), pointerleave: point(false), focusin: point(true), focusout: point(false)},
      stage,
      caption,
      go
    );
  }
}
