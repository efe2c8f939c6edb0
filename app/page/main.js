// The page: made from the document that it contains.

import {button, closeMenusOutside, copyButton, download, element, fileName} from './dom.js';
import {startTheme, themeChoice, usePalette, whenTold} from './theme.js';
import {reportView, verdictView, warningsView} from './report.js';
import {drawingView} from './figure.js';
import {Player} from './player.js';
import {cardsView} from './cards.js';
import {isLong} from './tables.js';
import {chartsView} from './chart.js';
import {canPlot, forgetCharts, plotThis, withPlots} from './plot_this.js';
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

// A line may break between words, not at the hyphens of an option.
function wordsOf(line) {
  return line.split(' ').flatMap((word, i) => [i > 0 ? ' ' : null, element('span', {}, word)]);
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
    page.line
      ? element(
          'div',
          {class: 'line'},
          element('code', {}, ...wordsOf(page.line)),
          copyButton('Copy', () => page.line)
        )
      : null
  );
}

// A press that moves the drawing is no click.
function plotOnClick({stage, picture}) {
  let pressed = null;
  stage.addEventListener('pointerdown', ({clientX, clientY}) => {
    pressed = [clientX, clientY];
  });
  stage.addEventListener('click', ({clientX, clientY, target}) => {
    const moved = pressed === null || Math.hypot(clientX - pressed[0], clientY - pressed[1]) > 4;
    if (!moved && !target.closest('button')) plotThis(picture.nameAt(clientX, clientY));
  });
}

function playedView(figure, palette) {
  const view = drawingView(figure.drawing, palette, (name) => (canPlot(name) ? `${name}: click for its curves` : name));
  const box = element('div', {class: 'played'}, view.element);
  let player = null;
  const charts = figure.charts ? withPlots(chartsView(figure.charts, (k) => player?.step(k))) : null;
  if (charts) box.append(charts.element);
  plotOnClick(view);
  box.classList.toggle('with-charts', charts !== null);
  if (figure.play && figure.drawing.frames.length > 1) {
    player = new Player(view, figure.play, (k) => charts?.frame(k));
    player.listenIn(box);
  } else {
    charts?.frame(0);
  }
  return box;
}

function figureBody(figure, palette) {
  switch (figure.kind) {
    case 'cards':
      return cardsView(figure.drawing, palette);
    case 'charts':
      return withPlots(chartsView(figure.charts)).element;
    default:
      return playedView(figure, palette);
  }
}

const figure_names = {drawing: 'Drawing', cards: 'Positions', charts: 'Charts'};

function figureView(figure, palette) {
  const heading = element(
    'h2',
    {class: figure.title ? null : 'unseen'},
    figure.title || figure_names[figure.kind] || ''
  );
  return element('section', {class: `figure kind-${figure.kind}`}, heading, figureBody(figure, palette));
}

// A still drawing without charts leaves room for the report beside it.
function isStill(figure) {
  return figure?.kind === 'drawing' && !figure.charts && !figure.play;
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
  forgetCharts();
  const figures = page.figures ?? [];
  const figure_views = figures.map((figure) => figureView(figure, palette));
  const report =
    page.report?.length > 0
      ? element('section', {class: 'report'}, element('h2', {}, 'Report'), reportView(page.report, 3))
      : null;
  const beside = isStill(figures[0]) && report !== null;
  // Charts explain the numbers of a report; a mechanism introduces them, and so do charts where all points come first.
  const report_first = figures.every((figure) => figure.kind === 'charts') && !isLong(page.report?.[0]);
  const parts = report_first ? [report, ...figure_views] : [...figure_views, report];
  const main = element(
    'main',
    {id: 'main', class: beside ? 'beside' : null, tabindex: -1},
    element(
      'div',
      {class: 'finding'},
      page.verdict?.text ? verdictView(page.verdict) : null,
      page.warnings?.length > 0 ? warningsView(page.warnings) : null
    ),
    ...(beside
      ? [element('div', {class: 'pair'}, figure_views[0], report), ...figure_views.slice(1)]
      : parts.filter((view) => view !== null))
  );
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
