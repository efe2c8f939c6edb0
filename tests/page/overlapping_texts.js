// The body of a function that a test runs in a page: which texts overlap, and which labels go on beyond their picture.

// Boxes of texts have room above and below the letters, and rounding makes neighbours touch.
const room = 0.35;
const least_width = 2;
const beyond = 1.5;

// What of a box can be seen: ancestors that scroll or cut hide the rest.
function seenPart(node, box) {
  let {left, top, right, bottom} = box;
  for (let at = node.parentElement; at; at = at.parentElement) {
    if (at instanceof SVGElement && !(at instanceof SVGSVGElement)) continue;
    const {overflowX, overflowY, clipPath, position} = getComputedStyle(at);
    const edge = at.getBoundingClientRect();
    if (clipPath !== 'none') return null;
    if (overflowX !== 'visible') [left, right] = [Math.max(left, edge.left), Math.min(right, edge.right)];
    if (overflowY !== 'visible') [top, bottom] = [Math.max(top, edge.top), Math.min(bottom, edge.bottom)];
    if (position === 'fixed') return null; // messages that lie over the page on purpose
  }
  return right - left > 0.5 && bottom - top > 0.5 ? {left, top, right, bottom} : null;
}

function isShown(element) {
  return element.checkVisibility({opacityProperty: true, visibilityProperty: true, contentVisibilityAuto: true});
}

// Texts on a canvas have no boxes: charts are drawn in another width and then once more as they were, and boxes noted.
const drawn = new Map();
const context = CanvasRenderingContext2D.prototype;
const {clearRect, fillText} = context;
context.clearRect = function (...box) {
  drawn.set(this.canvas, []);
  return clearRect.apply(this, box);
};
context.fillText = function (words, x, y, ...more) {
  const {actualBoundingBoxLeft: left, actualBoundingBoxRight: right, actualBoundingBoxAscent: up, actualBoundingBoxDescent: down} =
    this.measureText(words);
  const corners = [[x - left, y - up], [x + right, y - up], [x - left, y + down], [x + right, y + down]];
  const places = corners.map(([px, py]) => new DOMPoint(px, py).matrixTransform(this.getTransform()));
  if (String(words).trim() !== '' && this.globalAlpha > 0) drawn.get(this.canvas)?.push({words: String(words), places});
  return fillText.call(this, words, x, y, ...more);
};
if (document.querySelector('canvas')) {
  for (const narrower of ['2px', '']) {
    document.documentElement.style.paddingRight = narrower;
    await new Promise((done) => setTimeout(done, 250));
  }
}
Object.assign(context, {clearRect, fillText});

const texts = [];
const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
for (let node = walker.nextNode(); node; node = walker.nextNode()) {
  const words = node.textContent.replace(/\s+/g, ' ').trim();
  const parent = node.parentElement;
  if (words === '' || ['SCRIPT', 'STYLE', 'OPTION', 'TITLE'].includes(parent.tagName) || !isShown(parent)) continue;
  // What floats over the page while the pointer is there.
  if (parent.closest('.tip, .handle, .menu:not([open]) > div')) continue;
  const range = document.createRange();
  range.selectNodeContents(node);
  for (const box of range.getClientRects()) {
    const seen = seenPart(node, box);
    if (seen) texts.push({words, node, box: seen, svg: parent.closest('svg'), whole: box});
  }
}

for (const [canvas, list] of drawn) {
  if (!canvas.isConnected || !isShown(canvas)) continue;
  const edge = canvas.getBoundingClientRect();
  const scale = edge.width / canvas.width;
  for (const {words, places} of list) {
    const [xs, ys] = [places.map(({x}) => edge.left + scale * x), places.map(({y}) => edge.top + scale * y)];
    const box = {left: Math.min(...xs), right: Math.max(...xs), top: Math.min(...ys), bottom: Math.max(...ys)};
    texts.push({words, node: {}, box, svg: canvas, whole: box});
  }
}

const found = [];
texts.sort((a, b) => a.box.top - b.box.top);
for (let i = 0; i < texts.length; ++i) {
  const a = texts[i];
  for (let j = i + 1; j < texts.length && texts[j].box.top < a.box.bottom; ++j) {
    const b = texts[j];
    if (a.node === b.node) continue;
    const across = Math.min(a.box.right, b.box.right) - Math.max(a.box.left, b.box.left);
    const down = Math.min(a.box.bottom, b.box.bottom) - Math.max(a.box.top, b.box.top);
    const lower = Math.min(a.box.bottom - a.box.top, b.box.bottom - b.box.top);
    if (across > least_width && down > room * lower) found.push(`"${a.words.slice(0, 60)}" lies over "${b.words.slice(0, 60)}"`);
  }
  if (a.svg === null) continue;
  const edge = a.svg.getBoundingClientRect();
  const out = Math.max(edge.left - a.whole.left, a.whole.right - edge.right, edge.top - a.whole.top, a.whole.bottom - edge.bottom);
  if (out > beyond) found.push(`"${a.words.slice(0, 60)}" goes on ${out.toFixed(0)} px beyond its picture`);
}
const edge = document.documentElement.clientWidth;
for (const {words, box} of texts) if (box.right > edge + beyond) found.push(`"${words.slice(0, 60)}" goes on beyond the window`);
return [...new Set(found)];
