// The picture of a live view. Where the mechanism moved by itself, from one equilibrium to another, the way is played:
// the reader sees that it moved and where along, and is never shown one position instead of another without a word.

import {checkbox} from './dom.js';
import {drawingView, layerMenu} from './figure.js';

const usual_seconds = 0.6;
const slow_seconds = 3;
const wants_no_motion = matchMedia('(prefers-reduced-motion: reduce)');

/// The picture, which plays all frames of a drawing up to the last one. `shown(k)` is told of every frame.
export class MovingPicture {
  constructor(drawing, palette, shown) {
    this.view = drawingView(drawing, palette, undefined, true);
    this.picture = this.view.picture;
    this.shown = shown;
    this.slow = false;
    this.width = this.height = 0;
    this.layers = '';
    this.playing = null;
    this.view.tools.append(
      checkbox('Slow motion', false, (on) => {
        this.slow = on;
      })
    );
    this.followLayers(drawing);
  }

  get element() {
    return this.view.element;
  }

  get stage() {
    return this.view.stage;
  }

  /// Shows a drawing, and calls `done` when its last frame is shown, with whether its way was left out.
  show(drawing, done) {
    this.finish();
    this.followLayers(drawing);
    this.keepHeight(drawing);
    const last = drawing.frames.length - 1;
    const plays = last > 0 && !wants_no_motion.matches;
    this.showInPlace(drawing, plays ? 0 : last);
    if (!plays) {
      this.tell(last);
      done(last > 0);
      return;
    }
    const seconds = this.slow ? slow_seconds : usual_seconds;
    this.playing = {last, done, start: performance.now(), each: (1000 * seconds) / last, k: 0};
    this.stage.classList.add('moving');
    this.tell(0);
    this.next();
  }

  // The legend at the bottom comes and goes with what it explains: a picture that shrank with it would slip away below
  // the pointer.
  keepHeight(drawing) {
    if (drawing.width !== this.width) this.height = 0;
    this.width = drawing.width;
    this.height = drawing.height = Math.max(this.height, drawing.height);
  }

  // What has been zoomed into stays in view.
  showInPlace(drawing, k) {
    const {box, drawing: before} = this.picture;
    const zoomed = before.width === drawing.width && box.width < 0.999 * before.width;
    this.picture.show(drawing, k);
    if (zoomed && this.picture.box !== box) this.picture.look(box);
  }

  next() {
    requestAnimationFrame((now) => {
      const run = this.playing;
      if (!run) return;
      const k = Math.max(0, Math.floor((now - run.start) / run.each));
      if (k >= run.last) {
        this.finish();
        return;
      }
      if (k !== run.k) this.put(k);
      this.next();
    });
  }

  put(k) {
    this.playing.k = k;
    this.picture.frame(k);
    this.tell(k);
  }

  /// Goes to the end of what is played.
  finish() {
    const run = this.playing;
    if (!run) return;
    this.put(run.last);
    this.playing = null;
    this.stage.classList.remove('moving');
    run.done(false);
  }

  tell(k) {
    const {drawing} = this.picture;
    this.stage.classList.toggle('unconfirmed', !(drawing.confirmed?.[k] ?? true));
    this.shown(k, drawing);
  }

  // Arrows and stops come and go: the menu names what a drawing has had so far.
  followLayers(drawing) {
    const layers = [...new Set(drawing.slots.map(([layer]) => layer))];
    if (layers.every((layer) => this.layers.includes(`|${layer}|`))) return;
    const known = this.layers.split('|').filter((layer) => layer);
    const all = [...new Set([...known, ...layers])];
    this.layers = `|${all.join('||')}|`;
    this.view.tools.querySelector('.menu')?.replaceWith(
      layerMenu(this.picture, {slots: all.map((layer) => [layer, ''])})
    );
  }
}
