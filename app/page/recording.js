// Pictures and films of a drawing, as the reader sees it: what is shown is copied with its colours, since a file has no
// style sheet of the page.

import {button, download, element, fileName, menu} from './dom.js';

// Pixels of a picture for one of the screen.
const pixels = 2;
const frames_per_second = 30;
// How often the encoder hands over what it has.
const part_milliseconds = 100;
const copied_styles = [
  'fill',
  'fill-opacity',
  'stroke',
  'stroke-width',
  'stroke-opacity',
  'stroke-dasharray',
  'stroke-linecap',
  'stroke-linejoin',
  'opacity',
  'display',
  'visibility',
  'paint-order',
  'font-family',
  'font-size',
  'font-weight',
  'font-style',
  'text-anchor',
  'dominant-baseline',
];

function dressCopy(copy, shown) {
  const style = getComputedStyle(shown);
  for (const name of ['class', 'style', 'fill', 'stroke']) copy.removeAttribute(name);
  for (const name of copied_styles) copy.style.setProperty(name, style.getPropertyValue(name));
  [...shown.children].forEach((child, i) => dressCopy(copy.children[i], child));
}

/// The SVG file of what a picture shows, at the size that it has on the screen.
export function pictureText({svg, box}) {
  const copy = svg.cloneNode(true);
  dressCopy(copy, svg);
  const {clientWidth: width, clientHeight: height} = svg;
  const paper = document.createElementNS('http://www.w3.org/2000/svg', 'rect');
  for (const [name, value] of Object.entries({x: box.x, y: box.y, width: box.width, height: box.height}))
    paper.setAttribute(name, value);
  paper.setAttribute('fill', getComputedStyle(svg.parentElement).getPropertyValue('--paper').trim() || 'white');
  copy.prepend(paper);
  copy.setAttribute('xmlns', 'http://www.w3.org/2000/svg');
  copy.setAttribute('width', width);
  copy.setAttribute('height', height);
  return new XMLSerializer().serializeToString(copy);
}

// Draws what a picture shows; its size is that of the canvas.
async function paint(picture, canvas) {
  const image = new Image();
  image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(pictureText(picture))}`;
  await image.decode();
  canvas.getContext('2d').drawImage(image, 0, 0, canvas.width, canvas.height);
}

// Even numbers of pixels: some encoders take no others.
function canvasFor({svg}) {
  const even = (length) => 2 * Math.ceil((pixels * length) / 2);
  return element('canvas', {width: even(svg.clientWidth), height: even(svg.clientHeight)});
}

// What is played is painted as often as the film has frames, until it is stopped and the encoder has handed over a part:
// on a busy machine a short film would end before its first frame is encoded, as an empty file.
class Recorder {
  constructor(picture) {
    Object.assign(this, {picture, canvas: canvasFor(picture), parts: [], running: true});
    const types = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'];
    this.film = new MediaRecorder(this.canvas.captureStream(frames_per_second), {
      mimeType: types.find((type) => MediaRecorder.isTypeSupported(type)),
    });
    this.film.addEventListener('dataavailable', ({data}) => {
      if (data.size > 0) this.parts.push(data);
    });
  }

  async start() {
    await paint(this.picture, this.canvas);
    this.film.start(part_milliseconds);
    this.painted = this.paintOn();
  }

  async paintOn() {
    while (this.running || (this.parts.length === 0 && this.film.state === 'recording')) {
      await new Promise((go_on) => {
        setTimeout(go_on, 1000 / frames_per_second);
      });
      await paint(this.picture, this.canvas);
    }
  }

  async stop() {
    this.running = false;
    await this.painted;
    const ended = new Promise((end) => {
      this.film.addEventListener('stop', end);
    });
    this.film.stop();
    await ended;
    for (const track of this.film.stream.getTracks()) track.stop();
    return new Blob(this.parts, {type: 'video/webm'});
  }
}

/// What makes a file of what a picture shows: a menu for pictures and, where something moves, a button for a film of it
/// until it is stopped.
export function recordingTools(picture, moves) {
  const name = (ending) => fileName(document.title.replace(/^• /, ''), ending);
  let recorder = null;
  const png = async () => {
    const canvas = canvasFor(picture);
    await paint(picture, canvas);
    canvas.toBlob((blob) => download(name('png'), 'image/png', blob), 'image/png');
  };
  const record = button('Record', async () => {
    record.disabled = true;
    if (recorder) {
      const film = await recorder.stop();
      recorder = null;
      download(name('webm'), 'video/webm', film);
    } else {
      recorder = new Recorder(picture);
      await recorder.start();
    }
    record.disabled = false;
    record.classList.toggle('recording', recorder !== null);
    record.textContent = recorder ? 'Stop recording' : 'Record';
    record.setAttribute('aria-pressed', recorder !== null);
  });
  record.title = 'A film (WebM) of what moves until it is stopped';
  record.setAttribute('data-recording', 'webm');
  const can_record = moves && typeof MediaRecorder !== 'undefined' && HTMLCanvasElement.prototype.captureStream !== undefined;
  return [
    menu(
      'Picture',
      button('Picture (PNG)', png, {'data-recording': 'png'}),
      button('Picture (SVG)', () => download(name('svg'), 'image/svg+xml', pictureText(picture)), {
        'data-recording': 'svg',
      })
    ),
    ...(can_record ? [record] : []),
  ];
}
