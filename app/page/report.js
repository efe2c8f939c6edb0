// The report: facts, notes, lists, tables and sections, in the order in which text shows them. What only verbose text
// shows is in a closed box at the end of its section.

import {element, toneBadge, toneClass, toneIcon} from './dom.js';
import {tableView} from './tables.js';

function headingView(title, level) {
  return element(`h${Math.min(level, 6)}`, {class: title ? null : 'empty'}, title);
}

// Facts in a row share one list, so that their texts are aligned.
function factList(facts) {
  const pair = (fact) => [
    element('dt', {}, fact.label),
    element('dd', {class: toneClass(fact.tone)}, toneIcon(fact.tone), fact.text),
  ];
  return element('dl', {class: 'facts'}, ...facts.flatMap(pair));
}

function itemView(item, level) {
  switch (item.kind) {
    case 'note':
      return element('p', {class: `note ${toneClass(item.tone)}`}, toneIcon(item.tone), item.text);
    case 'list':
      return element(
        'section',
        {class: 'list'},
        item.title ? headingView(item.title, level) : null,
        element('ul', {}, ...item.items.map((text) => element('li', {}, text)))
      );
    case 'table':
      return element('section', {}, tableView(item, headingView(item.title, level)));
    case 'section':
      return element(
        'section',
        {class: 'part'},
        item.title ? headingView(item.title, level) : null,
        ...itemViews(item.items, item.title ? level + 1 : level)
      );
    default:
      return null;
  }
}

function plainViews(items, level) {
  const views = [];
  let facts = [];
  const flush = () => {
    if (facts.length > 0) views.push(factList(facts));
    facts = [];
  };
  for (const item of items) {
    if (item.kind === 'fact') {
      facts.push(item);
    } else {
      flush();
      views.push(itemView(item, level));
    }
  }
  flush();
  return views;
}

function itemViews(items, level) {
  const verbose = items.filter((item) => item.level === 'verbose');
  const views = plainViews(
    items.filter((item) => item.level !== 'verbose'),
    level
  );
  if (verbose.length > 0) {
    views.push(
      element('details', {class: 'details'}, element('summary', {}, 'Details'), ...plainViews(verbose, level))
    );
  }
  return views;
}

/// All items of a report below headings of a level.
export function reportView(items, level) {
  return element('div', {class: 'items'}, ...itemViews(items, level));
}

/// The sentence that says what was found.
export function verdictView(verdict) {
  return element(
    'p',
    {class: `verdict ${toneClass(verdict.tone)}`},
    toneBadge(verdict.tone),
    element('span', {}, verdict.text)
  );
}

/// Sentences that a reader must not miss.
export function warningsView(warnings) {
  const line = (warning) =>
    element(
      'li',
      {class: toneClass(warning.tone)},
      toneBadge(warning.tone, 'Warning') ?? element('span', {class: 'badge'}, 'Warning'),
      element('span', {}, warning.text)
    );
  return element('div', {role: 'alert'}, element('ul', {class: 'warnings'}, ...warnings.map(line)));
}
