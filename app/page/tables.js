// Tables: sorted by a click on a title, filtered by words, cut to their first rows where they are long.

import {button, copyButton, element, say, toneClass} from './dom.js';
import {whenTold} from './theme.js';
import {canPlot, plotThis} from './plot_this.js';

const most_rows = 25;
// On narrow windows longer texts go on in a second line.
const most_letters = 30;

function columnTitle(column) {
  return column.unit ? `${column.title} (${column.unit})`.trim() : column.title;
}

// As a person types it and other programs read it.
function plainSigns(text) {
  return text.replaceAll('\u2212', '-').replaceAll('\u00b1', '+-');
}

// By number where the column has numbers, by text otherwise; what has no value comes last in both directions.
function compareRows(column, sign) {
  const text = new Intl.Collator(undefined, {numeric: true});
  return (a, b) => {
    if (!column.values) return sign * text.compare(column.cells[a], column.cells[b]);
    const x = column.values[a],
      y = column.values[b];
    if (x === null || y === null) return (x === null) - (y === null);
    return sign * (x - y);
  };
}

function rowCount(item) {
  return item.columns.length === 0 ? 0 : item.columns[0].cells.length;
}

/// Whether an item of a report is a table that is cut to its first rows.
export function isLong(item) {
  return item?.kind === 'table' && rowCount(item) > most_rows;
}

// In texts a row of signs is the bar of a histogram.
function isBar(text) {
  return /^#+$/.test(text);
}

function barView(text) {
  const bar = element('span', {class: 'count-bar', role: 'img', 'aria-label': `bar of ${text.length}`});
  bar.style.setProperty('--count', text.length);
  return bar;
}

function plotButton(text) {
  return button(text, () => plotThis(text), {class: 'plot-this', title: 'Show its curves alone'});
}

// What scrolls must be reached by keys too; what does not would only be in the way of Tab.
function reachWhileScrolling(box) {
  new ResizeObserver(() => {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
    else box.removeAttribute('tabindex');
  }).observe(box);
  return box;
}

function csvField(text) {
  return /[",\n\r]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text;
}

function csvText(columns, rows) {
  const cell = (column, row) => (column.values ? String(column.values[row] ?? '') : plainSigns(column.cells[row]));
  const lines = [columns.map(columnTitle), ...rows.map((row) => columns.map((column) => cell(column, row)))];
  return lines.map((line) => line.map(csvField).join(',')).join('\n') + '\n';
}

const views = new WeakMap();

class TableView {
  constructor(item, heading) {
    this.item = item;
    this.columns = item.columns;
    this.size = rowCount(item);
    this.sorted = {column: null, sign: 1};
    this.words = '';
    this.whole = this.size <= most_rows;
    this.body = element('tbody');
    this.heads = this.columns.map((column, i) => this.head(column, i));
    const table = element(
      'table',
      {'aria-label': item.title || 'Table'},
      element('thead', {}, element('tr', {}, ...this.heads)),
      this.body
    );
    this.more = button('', () => this.showAll(), {class: 'quiet'});
    this.element = element(
      'div',
      {class: this.whole ? 'table short' : 'table'},
      this.top(heading),
      reachWhileScrolling(element('div', {class: 'scroll', role: 'group', 'aria-label': item.title || 'Table'}, table)),
      ...(item.footnotes ?? []).map((note) => element('p', {class: 'footnote'}, note)),
      element(
        'div',
        {class: 'table-foot'},
        this.more,
        copyButton('Copy as CSV', () => csvText(this.columns, this.rows()))
      )
    );
    views.set(this.element, this);
    whenTold(this.element, {print: () => this.fill(true), printed: () => this.fill()});
    this.fill();
  }

  get arrangement() {
    const {sorted, words, whole} = this;
    return {sorted, words, whole};
  }

  arrange({sorted, words, whole}) {
    Object.assign(this, {sorted: sorted.column < this.columns.length ? sorted : this.sorted, words, whole});
    if (this.filter) this.filter.value = words;
    this.showOrder();
    this.fill();
  }

  top(heading) {
    this.filter = element('input', {
      type: 'search',
      placeholder: 'Filter rows',
      'aria-label': 'Filter rows',
      input: () => {
        this.words = this.filter.value.toLowerCase();
        this.fill();
      },
    });
    return element('div', {class: 'table-top'}, heading, this.size > most_rows ? this.filter : null);
  }

  head(column, i) {
    const title = columnTitle(column);
    const attributes = {scope: 'col', class: column.align === 'right' ? 'right' : null};
    if (!title) return element('td');
    if (this.size < 2) return element('th', attributes, title);
    return element(
      'th',
      {...attributes, 'aria-sort': 'none'},
      button(title, () => this.sort(i), {class: 'sort'})
    );
  }

  // One click: ascending; two: descending; three: the order of the document.
  sort(i) {
    const {column, sign} = this.sorted;
    this.sorted = column !== i ? {column: i, sign: 1} : sign > 0 ? {column: i, sign: -1} : {column: null, sign: 1};
    const word = this.showOrder();
    say(word === 'none' ? 'in the order of the report' : `sorted by ${columnTitle(this.columns[i])}, ${word}`);
    this.fill();
  }

  // Marks the column by which rows are sorted, and returns the word for the order.
  showOrder() {
    const {column, sign} = this.sorted;
    const word = column === null ? 'none' : sign > 0 ? 'ascending' : 'descending';
    this.heads.forEach((head, k) => {
      if (head.hasAttribute('aria-sort')) head.setAttribute('aria-sort', k === column ? word : 'none');
    });
    return word;
  }

  showAll() {
    this.whole = !this.whole;
    this.fill();
  }

  /// The rows that pass the filter, or everything, in order.
  rows(everything = false) {
    const rows = [...Array(this.size).keys()].filter(
      (row) =>
        everything || !this.words || this.columns.some((column) => plainSigns(column.cells[row]).toLowerCase().includes(plainSigns(this.words)))
    );
    if (this.sorted.column !== null) rows.sort(compareRows(this.columns[this.sorted.column], this.sorted.sign));
    return rows;
  }

  fill(everything = false) {
    const rows = this.rows(everything);
    const shown = this.whole || everything ? rows : rows.slice(0, most_rows);
    this.body.replaceChildren(...shown.map((row) => this.row(row)));
    if (rows.length === 0)
      this.body.append(element('tr', {}, element('td', {colspan: this.columns.length}, 'No rows.')));
    this.more.hidden = rows.length <= most_rows;
    this.more.textContent = this.whole ? `Show the first ${most_rows} rows` : `Show all ${rows.length} rows`;
  }

  row(row) {
    const cells = this.columns.map((column, i) => {
      const tone = column.tones?.[row] ?? 'plain';
      const text = column.cells[row];
      const is_long = column.align !== 'right' && text.length > most_letters && !isBar(text);
      const classes = [
        column.align === 'right' ? 'right' : '',
        tone === 'plain' ? '' : toneClass(tone),
        is_long ? 'long' : '',
      ];
      const is_name = i === 0 && column.align !== 'right';
      return element(
        is_name ? 'th' : 'td',
        {scope: is_name ? 'row' : null, class: classes.filter((name) => name).join(' ') || null},
        isBar(text) ? barView(text) : is_name && canPlot(text) ? plotButton(text) : text
      );
    });
    return element('tr', {}, ...cells);
  }
}

function viewsIn(place) {
  return [...place.querySelectorAll('.table')].map((table) => views.get(table));
}

/// How the reader has sorted, filtered and opened the tables in a place, by their titles.
export function arrangementsIn(place) {
  return new Map(viewsIn(place).map((view) => [view.item.title, view.arrangement]));
}

/// Arranges the tables in a place as those that were there before.
export function arrangeTables(place, arrangements) {
  for (const view of viewsIn(place)) {
    if (arrangements.has(view.item.title)) view.arrange(arrangements.get(view.item.title));
  }
}

const reached = 'button, input, summary, .scroll';

// What names a control in a report, whose tables may come and go.
function nameOf(control) {
  const table = control.closest('.table')?.querySelector('table').getAttribute('aria-label') ?? '';
  const place = control.closest('th')?.cellIndex ?? [...control.parentNode.children].indexOf(control);
  return `${table} ${control.tagName} ${control.className} ${place}`;
}

/// What in a place has the focus, for refocus() after the place was filled anew; null where the focus is elsewhere.
export function focusIn(place) {
  const control = document.activeElement;
  if (!place.contains(control) || !control.matches(reached)) return null;
  const name = nameOf(control);
  const alike = [...place.querySelectorAll(reached)].filter((one) => nameOf(one) === name);
  return {name, which: alike.indexOf(control), caret: control.selectionStart ?? null};
}

/// Gives the focus to what is named like the control that had it.
export function refocus(place, focus) {
  if (focus === null) return;
  const alike = [...place.querySelectorAll(reached)].filter((one) => nameOf(one) === focus.name);
  const control = alike[focus.which] ?? alike[0];
  if (!control) return;
  if (control.matches('.scroll')) control.tabIndex = 0;
  control.focus({preventScroll: true});
  if (focus.caret !== null) control.setSelectionRange(focus.caret, focus.caret);
}

/// A table item of the report below its heading.
export function tableView(item, heading) {
  return new TableView(item, heading).element;
}
