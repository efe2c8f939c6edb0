// Cards: every frame of a drawing in a grid, with its caption; one of them enlarged in a dialog.

import {button, element} from './dom.js';
import {drawingView, Picture, showCaption} from './figure.js';

class EnlargedCard {
  constructor(drawing, palette) {
    this.drawing = drawing;
    this.view = drawingView(drawing, palette);
    this.place = element('span', {class: 'place'});
    const close = button('Close', () => this.dialog.close());
    this.dialog = element(
      'dialog',
      {class: 'enlarged', 'aria-label': 'Enlarged card', keydown: (event) => this.key(event)},
      element(
        'div',
        {class: 'dialog-top'},
        button('Previous', () => this.show(this.k - 1)),
        this.place,
        button('Next', () => this.show(this.k + 1)),
        close
      ),
      this.view.element
    );
    this.dialog.addEventListener('click', (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
    document.body.append(this.dialog);
  }

  open(k) {
    this.show(k);
    this.dialog.showModal();
    this.view.stage.focus();
  }

  show(k) {
    const count = this.drawing.frames.length;
    this.k = (k + count) % count;
    this.view.frame(this.k);
    this.place.textContent = `${this.k + 1} of ${count}`;
  }

  key(event) {
    if (event.target.closest('.menu')) return;
    if (event.key === 'ArrowLeft') this.show(this.k - 1);
    else if (event.key === 'ArrowRight') this.show(this.k + 1);
    else return;
    event.preventDefault();
  }
}

/// All frames of a drawing as cards.
export function cardsView(drawing, palette) {
  let enlarged = null;
  const open = (k) => {
    enlarged ??= new EnlargedCard(drawing, palette);
    enlarged.open(k);
  };
  const card = (_, k) => {
    const stage = element('div', {class: 'stage'});
    new Picture(stage, palette).show(drawing, k);
    const caption = element('span', {class: 'caption'});
    showCaption(caption, stage, drawing, k);
    const face = button(stage, () => open(k), {class: 'card', title: 'Enlarge'});
    face.append(caption);
    return element('li', {}, face);
  };
  return element('ul', {class: 'cards'}, ...drawing.frames.map(card));
}
