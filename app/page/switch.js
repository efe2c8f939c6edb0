// One frame of a drawing at a time, large, chosen by a button with its caption.

import {button, element} from './dom.js';
import {drawingView} from './figure.js';

/// A drawing with a button for each of its frames.
export function switchView(drawing, palette) {
  const view = drawingView(drawing, palette);
  const choose = (k) => {
    view.frame(k);
    buttons.forEach((one, i) => one.setAttribute('aria-pressed', String(i === k)));
  };
  const buttons = drawing.captions.map((caption, k) => button(caption, () => choose(k)));
  choose(0);
  return element('div', {class: 'switched'}, element('p', {class: 'card-tools'}, ...buttons), view.element);
}
