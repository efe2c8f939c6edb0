// The page: made from the document that it contains.

import {button, closeMenusOutside, download, element, fileName} from './dom.js';
import {startTheme, themeChoice, usePalette, whenTold} from './theme.js';
import {lineView, resultViews} from './report_page.js';
import {showLiveView} from './view.js';

// The text of a member of a JSON object, as it was written: numbers of 64 bits would lose digits in JSON.parse.
function memberText(text, key) {
  const tokens = /"[^"\\]*(?:\\.[^"\\]*)*"|[{}[\],]/g;
  let depth = 0,
    begin = -1,
    last = '';
  for (const {0: token, index} of text.matchAll(tokens)) {
    if (depth === 1 && begin >= 0 && ',}'.includes(token)) return text.slice(begin, index).trim();
    if (depth === 1 && '{,'.includes(last) && token === `"${key}"`) begin = text.indexOf(':', index + token.length) + 1;
    depth += '{['.includes(token) - '}]'.includes(token);
    last = token;
  }
  return 'null';
}

function headerView(page, text) {
  const name = page.title || `poise ${page.command}`;
  const save = () => download(fileName(name, 'json'), 'application/json', `${memberText(text, 'result')}\n`);
  return element(
    'header',
    {class: 'page-header'},
    element(
      'div',
      {class: 'titles'},
      element('h1', {}, name),
      page.source ? element('p', {class: 'source'}, `Source: ${page.source}`) : null
    ),
    element(
      'div',
      {class: 'page-buttons'},
      themeChoice(),
      page.result === null || page.result === undefined ? null : button('Save the data (JSON)', save),
      button('Print', () => print())
    ),
    page.line ? lineView(page.line) : null
  );
}

function openWhilePrinting(place) {
  let opened = [];
  whenTold(place, {
    print: () => {
      opened = [...place.querySelectorAll('details.details:not([open])')];
      opened.forEach((box) => {
        box.open = true;
      });
    },
    printed: () =>
      opened.forEach((box) => {
        box.open = false;
      }),
  });
}

/// Shows a document, given as text, in place of what the page shows.
export function showPage(text) {
  const page = JSON.parse(text);
  const palette = usePalette(page.palette);
  if (page.command === 'view' && page.view) {
    showLiveView(page, palette, document.getElementById('page'));
    return;
  }
  const main = element('main', {id: 'main', tabindex: -1}, ...resultViews(page, palette));
  const footer = element('footer', {}, `Made by Poise ${page.poise ?? ''}`);
  document.getElementById('page').replaceChildren(headerView(page, text), main, footer);
}

// The document's text, which the page contains as base64 of what zlib compressed.
async function documentText() {
  const packed = Uint8Array.from(atob(document.getElementById('document').textContent), (c) => c.charCodeAt(0));
  return new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'))).text();
}

async function startPage() {
  const place = document.getElementById('page');
  startTheme();
  closeMenusOutside();
  openWhilePrinting(place);
  try {
    showPage(await documentText());
  } catch {
    const text = 'This page cannot be shown, because the data in it cannot be read; browsers since 2023 can.';
    place.replaceChildren(
      element('main', {id: 'main'}, element('div', {role: 'alert'}, element('h1', {class: 'unreadable'}, text)))
    );
  }
}

startPage();
