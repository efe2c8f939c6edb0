// The page of a result: its verdict, its pictures and charts, its report; on a page of its own and in the live view.

import {copyButton, element} from './dom.js';
import {reportView, verdictView, warningsView} from './report.js';
import {drawingView} from './figure.js';
import {Player} from './player.js';
import {cardsView} from './cards.js';
import {switchView} from './switch.js';
import {isLong} from './tables.js';
import {chartsView} from './chart.js';
import {canPlot, forgetCharts, plotThis, withPlots} from './plot_this.js';

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
    case 'switched':
      return switchView(figure.drawing, palette);
    case 'charts':
      return withPlots(chartsView(figure.charts)).element;
    default:
      return playedView(figure, palette);
  }
}

const figure_names = {drawing: 'Drawing', cards: 'Positions', switched: 'Drawing', charts: 'Charts'};

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

// A line may break between words, not at the hyphens of an option.
function wordsOf(line) {
  return line.split(' ').flatMap((word, i) => [i > 0 ? ' ' : null, element('span', {}, word)]);
}

/// A command line, to be copied.
export function lineView(line) {
  return element(
    'div',
    {class: 'line'},
    element('code', {}, ...wordsOf(line)),
    copyButton('Copy', () => line)
  );
}

/// All that a document shows below its title. The page has the charts of one document at a time.
export function resultViews(page, palette) {
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
  const finding = element(
    'div',
    {class: 'finding'},
    page.verdict?.text ? verdictView(page.verdict) : null,
    page.warnings?.length > 0 ? warningsView(page.warnings) : null
  );
  return [
    finding,
    ...(beside
      ? [element('div', {class: 'pair'}, figure_views[0], report), ...figure_views.slice(1)]
      : parts.filter((view) => view !== null)),
  ];
}
