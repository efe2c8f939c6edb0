// Makes elements, icons and buttons. Text of the document becomes text nodes and attribute values only, so that no name
// in a user's file can become markup.

const svg_namespace = 'http://www.w3.org/2000/svg';

function furnish(node, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value === null || value === undefined || value === false) continue;
    if (typeof value === 'function') node.addEventListener(name, value);
    else node.setAttribute(name, value === true ? '' : value);
  }
  node.append(...children.filter((child) => child !== null && child !== undefined));
  return node;
}

/// An HTML element. An attribute that is a function listens to the event of that name; null and false are left out.
export function element(tag, attributes = {}, ...children) {
  return furnish(document.createElement(tag), attributes, children);
}

export function svgElement(tag, attributes = {}, ...children) {
  return furnish(document.createElementNS(svg_namespace, tag), attributes, children);
}

const icon_paths = {
  play: 'M4 2v12l10-6z',
  pause: 'M3 2h4v12H3zM9 2h4v12H9z',
  first: 'M2 2h2v12H2zM14 2v12L5 8z',
  last: 'M12 2h2v12h-2zM2 2v12l9-6z',
  back: 'M11 2v12L3 8z',
  forth: 'M5 2v12l8-6z',
  good: 'M8 0a8 8 0 1 0 0 16A8 8 0 0 0 8 0zM6.9 11.9 3.4 8.4l1.5-1.5 2 2 4.3-4.6 1.5 1.4z',
  bad:
    'M8 0a8 8 0 1 0 0 16A8 8 0 0 0 8 0zm3.6 10.1-1.5 1.5L8 9.5l-2.1 2.1-1.5-1.5L6.5 8 4.4 5.9l1.5-1.5L8 6.5' +
    'l2.1-2.1 1.5 1.5L9.5 8z',
  doubtful: 'M8 1 .5 15h15zM7 6h2l-.3 4.5H7.3zM8 11.4a1.1 1.1 0 1 1 0 2.2 1.1 1.1 0 0 1 0-2.2z',
};

export function icon(name) {
  const path = svgElement('path', {d: icon_paths[name], 'fill-rule': 'evenodd'});
  return svgElement('svg', {class: 'icon', viewBox: '0 0 16 16', 'aria-hidden': 'true'}, path);
}

export function button(label, action, attributes = {}) {
  return element('button', {type: 'button', click: action, ...attributes}, label);
}

export function iconButton(name, label, action) {
  return button(icon(name), action, {class: 'icon-button', 'aria-label': label, title: label});
}

/// A button that opens and closes a box of settings below it.
export function menu(label, ...children) {
  const box = element('details', {class: 'menu'}, element('summary', {}, label), element('div', {}, ...children));
  box.addEventListener('keydown', (event) => {
    if (event.key !== 'Escape' || !box.open) return;
    event.stopPropagation();
    box.open = false;
    box.querySelector('summary').focus();
  });
  return box;
}

/// Has every open menu closed by a press elsewhere.
export function closeMenusOutside() {
  document.addEventListener('pointerdown', (event) => {
    for (const box of document.querySelectorAll('.menu[open]')) {
      if (!box.contains(event.target)) box.open = false;
    }
  });
}

export function checkbox(label, checked, change) {
  const input = element('input', {type: 'checkbox', change: () => change(input.checked)});
  input.checked = checked;
  return element('label', {class: 'check'}, input, label);
}

/// The words that stand for a tone, because colour alone must not carry it; empty for tones without a judgement.
const tone_words = {good: 'OK', bad: 'Not OK', doubtful: 'Doubtful'};

export function toneClass(tone) {
  return ['strong', 'good', 'bad', 'doubtful', 'faint'].includes(tone) ? `tone-${tone}` : 'tone-plain';
}

/// The icon of a tone with its words for screen readers; null for tones without a judgement.
export function toneIcon(tone) {
  if (!Object.hasOwn(tone_words, tone)) return null;
  return element('span', {class: 'tone-icon'}, icon(tone), element('span', {class: 'unseen'}, `${tone_words[tone]}: `));
}

/// The icon of a tone with its words for everybody.
export function toneBadge(tone, words = tone_words[tone]) {
  if (!Object.hasOwn(tone_words, tone)) return null;
  return element('span', {class: `badge ${toneClass(tone)}`}, icon(tone), words);
}

/// Has a screen reader read a text out.
export function say(text) {
  let region = document.getElementById('spoken');
  if (!region) {
    region = element('div', {id: 'spoken', class: 'unseen', 'aria-live': 'polite'});
    document.body.append(region);
  }
  region.textContent = text;
}

async function writeClipboard(text) {
  // In a frame of another page the browser may refuse one way and allow the other.
  const written = await navigator.clipboard?.writeText(text).then(
    () => true,
    () => false
  );
  if (written) return undefined;
  const area = element('textarea', {class: 'unseen'});
  area.value = text;
  document.body.append(area);
  area.select();
  const done = document.execCommand('copy');
  area.remove();
  return done ? undefined : Promise.reject(new Error('not copied'));
}

/// A button that copies the text which `text()` returns.
export function copyButton(label, text) {
  const copy = button(
    label,
    async () => {
      const done = await writeClipboard(text()).then(
        () => 'Copied',
        () => 'Not copied: the browser refused'
      );
      copy.textContent = done;
      say(done);
      setTimeout(() => {
        copy.textContent = label;
      }, 1600);
    },
    {class: 'quiet'}
  );
  return copy;
}

/// A file's name made of any words, with an ending: "My four-bar" and "json" give "My-four-bar.json".
export function fileName(words, ending) {
  const stem = words
    .replace(/[^\p{L}\p{N}_]+/gu, '-')
    .replace(/^-+|-+$/g, '')
    .slice(0, 60);
  return `${stem || 'poise'}.${ending}`;
}

export function download(name, type, text) {
  const address = URL.createObjectURL(new Blob([text], {type}));
  element('a', {href: address, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/// A number for reading, with a true minus sign and a power of ten where it is very large or small.
export function numberText(value, digits = 6) {
  if (value === null || !Number.isFinite(value)) return '–';
  const short = Number(value.toPrecision(digits));
  const size = Math.abs(short);
  const plain = size === 0 || (size >= 1e-4 && size < 1e7);
  const [mantissa, exponent] = (plain ? String(short) : short.toExponential()).split('e');
  return mantissa.replace('-', '−') + (exponent ? `·10${superscript(Number(exponent))}` : '');
}

export function superscript(exponent) {
  const digits = [...String(Math.abs(exponent))].map((digit) => '⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(digit)]).join('');
  return (exponent < 0 ? '⁻' : '') + digits;
}
