// Mechanisms to begin with: a gallery, of which one takes the place of the scene's text.

import {button, element} from './dom.js';
import {Picture} from './figure.js';

/// The gallery. `look(request)` asks the program and returns its answer; `take(text)` shows a scene.
export class TemplatesDialog {
  constructor(palette, look, take) {
    Object.assign(this, {palette, look, take, texts: new Map(), filled: false});
    this.list = element('ul', {class: 'cards'});
    this.hint = element('p', {class: 'hint', role: 'status'}, 'The one that you choose takes the place of what is shown; undo brings that back.');
    this.dialog = element(
      'dialog',
      {class: 'enlarged templates', 'aria-label': 'Templates'},
      element('div', {class: 'dialog-top'}, element('h2', {}, 'Templates'), button('Close', () => this.dialog.close())),
      this.hint,
      this.list
    );
    this.dialog.addEventListener('click', (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
    document.body.append(this.dialog);
  }

  async open() {
    this.dialog.showModal();
    if (this.filled) return;
    const {templates, error} = await this.look({do: 'templates'});
    if (error) {
      this.hint.textContent = error.text;
      return;
    }
    this.filled = true;
    const stages = new Map(templates.map(({name}) => [name, element('div', {class: 'stage'})]));
    this.list.replaceChildren(
      ...templates.map(({name, title}) => {
        const face = button(stages.get(name), () => this.choose(name), {class: 'card', 'data-template': name});
        face.append(element('span', {class: 'caption'}, title));
        return element('li', {}, face);
      })
    );
    // One after the other, so that the mechanism is answered between them.
    for (const {name} of templates) await this.fill(name, stages.get(name));
  }

  async fill(name, stage) {
    const {text, drawing} = await this.look({do: 'templates', name});
    if (text === undefined) return;
    this.texts.set(name, text);
    new Picture(stage, this.palette).show(drawing, 0);
  }

  async choose(name) {
    const text = this.texts.get(name) ?? (await this.look({do: 'templates', name})).text;
    if (text === undefined) return;
    this.dialog.close();
    this.take(text);
  }
}
