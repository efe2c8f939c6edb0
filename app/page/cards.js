// Cards: every frame of a drawing in a grid, with its caption; enlarged in a dialog, where they are played one after the
// other.

import {button, element} from './dom.js';
import {drawingView, Picture, showCaption} from './figure.js';
import {Player} from './player.js';

// How long each card is shown while they are played, s.
const seconds_of_card = 0.8;

class EnlargedCards {
  constructor(drawing, palette) {
    const view = drawingView(drawing, palette);
    const values = drawing.frames.map((_, k) => k + 1);
    this.stage = view.stage;
    this.dialog = element(
      'dialog',
      {class: 'enlarged', 'aria-label': 'Enlarged cards'},
      element('div', {class: 'dialog-top'}, button('Close', () => this.dialog.close())),
      view.element
    );
    this.player = new Player(
      view,
      {label: '', unit: `of ${values.length}`, values, seconds: seconds_of_card * values.length},
      () => {}
    );
    this.player.listenIn(this.dialog);
    this.dialog.addEventListener('close', () => this.player.setPlaying(false));
    this.dialog.addEventListener('click', (event) => {
      if (event.target === this.dialog) this.dialog.close();
    });
    document.body.append(this.dialog);
  }

  open(k, playing) {
    this.player.step(k);
    this.dialog.showModal();
    this.stage.focus();
    this.player.setPlaying(playing);
  }
}

/// All frames of a drawing as cards.
export function cardsView(drawing, palette) {
  let enlarged = null;
  const open = (k, playing = false) => {
    enlarged ??= new EnlargedCards(drawing, palette);
    enlarged.open(k, playing);
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
  return element(
    'div',
    {},
    element(
      'p',
      {class: 'card-tools'},
      button('One after the other', () => open(0, true))
    ),
    element('ul', {class: 'cards'}, ...drawing.frames.map(card))
  );
}
