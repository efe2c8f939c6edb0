// The scene as text: applied while it is typed, with what is wrong marked at its line.

import {button, element} from './dom.js';

const pause_before_applying = 400;

// Where a place in one text is in another that differs in other lines only; null where its own line differs.
function samePlace(before, after, at) {
  const head = before.slice(0, at).split('\n');
  const row = head.length - 1;
  const line = before.split('\n')[row];
  const lines = after.split('\n');
  if (lines[row] !== line) return null;
  return lines.slice(0, row).reduce((sum, text) => sum + text.length + 1, 0) + head[row].length;
}

/// The panel with the text. `ask(request, options)` sends requests; `edited()` is told when unapplied edits come or go.
export class TextPanel {
  constructor(ask, edited) {
    Object.assign(this, {ask, edited, program_text: '', base: '', sent: null, timer: 0, line: null, error: null, count: 0});
    this.gutter = element('div', {class: 'gutter', 'aria-hidden': 'true'});
    this.strip = element('div', {class: 'error-strip', hidden: true});
    this.area = element('textarea', {
      'aria-label': 'Scene text (TOML)',
      'aria-describedby': 'text-error',
      spellcheck: 'false',
      autocomplete: 'off',
      autocapitalize: 'off',
      wrap: 'off',
      input: () => this.typed(),
      scroll: () => this.scrolled(),
      blur: () => this.takeOver(),
    });
    this.message = element('p', {id: 'text-error', class: 'text-error', role: 'alert', hidden: true});
    this.applied = element('span', {class: 'hint', role: 'status'});
    this.apply_button = button('Apply', () => this.apply());
    this.revert_button = button('Discard these edits', () => this.discard(), {class: 'quiet'});
    this.element = element(
      'div',
      {class: 'text-panel'},
      element('div', {class: 'editor'}, this.gutter, element('div', {class: 'sheet'}, this.strip, this.area)),
      this.message,
      element('div', {class: 'text-tools'}, this.apply_button, this.revert_button, this.applied)
    );
    this.state();
  }

  /// Whether the text has edits that the program has not taken over.
  get has_edits() {
    return this.area.value !== this.base;
  }

  /// The text as the reader sees it, or will once the caret has left.
  get value() {
    return this.has_edits ? this.area.value : this.program_text;
  }

  /// Takes over the text of the program, unless there are edits. `applied`: it is the answer to what was sent.
  update(text, applied) {
    this.program_text = text;
    if (applied && this.sent !== null) {
      this.base = this.sent;
      this.sent = null;
      this.complain(null);
    }
    if (!this.has_edits) this.takeOver();
    this.state();
  }

  // The caret stays where it is; where its own line would change below it, the text waits until the reader has left.
  takeOver() {
    const {area} = this;
    if (this.has_edits || area.value === this.program_text) return;
    const focused = document.activeElement === area;
    const places = [area.selectionStart, area.selectionEnd].map((at) => samePlace(area.value, this.program_text, at));
    if (focused && places.includes(null)) return;
    const {scrollTop, scrollLeft} = area;
    area.value = this.base = this.program_text;
    if (focused) area.setSelectionRange(...places);
    Object.assign(area, {scrollTop, scrollLeft});
    this.complain(null);
  }

  typed() {
    this.number();
    this.complain(null);
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.apply(), pause_before_applying);
    this.state();
  }

  /// Sends edits to the program.
  apply() {
    clearTimeout(this.timer);
    if (!this.has_edits) return;
    this.sent = this.area.value;
    this.ask({do: 'text', text: this.sent});
    this.state();
  }

  discard() {
    this.revert();
    // The button is not there any more.
    this.area.focus();
  }

  revert() {
    clearTimeout(this.timer);
    this.area.value = this.base = this.program_text;
    this.complain(null);
    this.state();
  }

  /// Says what is wrong with the text that was sent.
  refuse(text, line) {
    this.sent = null;
    this.complain({text, line});
    this.state();
  }

  complain(error) {
    this.line = error?.line ?? null;
    this.error = error;
    this.message.hidden = error === null;
    this.message.replaceChildren();
    if (error) {
      this.message.append(error.text);
      if (this.line) this.message.append(' ', button(`Go to line ${this.line}`, () => this.goToLine(), {class: 'quiet'}));
    }
    this.area.setAttribute('aria-invalid', error !== null);
    this.number();
    this.scrolled();
  }

  goToLine() {
    const lines = this.area.value.split('\n');
    const begin = lines.slice(0, this.line - 1).reduce((sum, text) => sum + text.length + 1, 0);
    this.area.focus();
    this.area.setSelectionRange(begin, begin + (lines[this.line - 1]?.length ?? 0));
    this.area.scrollTop = Math.max(0, (this.line - 6) * this.lineHeight());
  }

  lineHeight() {
    return parseFloat(getComputedStyle(this.area).lineHeight);
  }

  number() {
    const count = this.area.value.split('\n').length;
    if (count !== this.count) {
      this.count = count;
      this.gutter.replaceChildren(...Array.from({length: count}, (_, i) => element('span', {}, String(i + 1))));
    }
    this.gutter.querySelector('.wrong')?.classList.remove('wrong');
    if (this.line) this.gutter.children[this.line - 1]?.classList.add('wrong');
  }

  scrolled() {
    this.gutter.scrollTop = this.area.scrollTop;
    this.strip.hidden = this.line === null;
    if (this.line === null) return;
    const padding = parseFloat(getComputedStyle(this.area).paddingTop) || 0;
    this.strip.style.top = `${padding + (this.line - 1) * this.lineHeight() - this.area.scrollTop}px`;
  }

  state() {
    const edits = this.has_edits;
    this.apply_button.disabled = !edits;
    this.revert_button.hidden = !edits;
    this.applied.textContent = this.error ? 'The mechanism stays as it was.' : edits ? 'Not applied yet.' : '';
    this.edited();
  }
}
