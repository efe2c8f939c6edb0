// "Plot this": what the reader clicks, in a table or in a drawing, is shown alone in the charts of the page that have it.

import {say} from './dom.js';

// The charts of the page, and the name whose curves are shown alone.
let charts = [];
let shown_alone = '';

/// Forgets the charts of the page before.
export function forgetCharts() {
  charts = [];
  shown_alone = '';
}

/// Takes more charts in which plotThis() looks; returns the view that they are of.
export function withPlots(view) {
  charts.push(...view.charts);
  return view;
}

// "2 * d(angle.crank)/dt" -> ".2.d.angle.crank.dt.", in which ".crank." stands between points.
function withPoints(text) {
  return `.${text.replace(/, | [-+*/] |[()/]+/g, '.')}.`;
}

// The curves of a chart that are of something so called; all of them where its axes are.
function curvesOf(chart, name) {
  const is_of = (text) => withPoints(text).includes(`.${name}.`);
  const {curves} = chart.panel;
  const found = [...curves.keys()].filter((i) => is_of(curves[i].name));
  return found.length > 0 || ![chart.labels.x.name, chart.labels.y.name].some(is_of) ? found : [...curves.keys()];
}

// In a drawing "spring holder" is called by its kind too.
function namesOf(item) {
  const words = item.split(' ');
  return words.map((_, i) => words.slice(i).join(' '));
}

function placesOf(item) {
  for (const name of namesOf(item)) {
    const places = charts.map((chart) => [chart, curvesOf(chart, name)]).filter(([, curves]) => curves.length > 0);
    if (places.length > 0) return places;
  }
  return [];
}

/// Whether the page has curves of something.
export function canPlot(item) {
  return item.trim() !== '' && placesOf(item).length > 0;
}

/// Shows the curves of something alone in the charts that have them; all curves when it is asked for again.
export function plotThis(item) {
  const again = item === shown_alone;
  const places = placesOf(item);
  if (places.length === 0) return;
  for (const chart of charts) chart.showCurves(null);
  shown_alone = again ? '' : item;
  if (!again) for (const [chart, curves] of places) chart.showCurves(curves);
  places[0][0].element.scrollIntoView({block: 'nearest'});
  say(again ? 'All curves are shown' : `Curves of ${item} in ${places.map(([chart]) => chart.title).join(', ')}`);
}
