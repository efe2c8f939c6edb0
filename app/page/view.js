// The live view: the mechanism in the browser, which answers every change with its equilibrium. What is right is decided
// by the program alone; the page sends wishes and shows its answers.

import {button, copyButton, download, element, fileName, menu, numberText} from './dom.js';
import {themeChoice, whenTold} from './theme.js';
import {reportView, verdictView, warningsView} from './report.js';
import {arrangementsIn, arrangeTables, focusIn, refocus} from './tables.js';
import {Program} from './view_program.js';
import {MovingPicture} from './view_motion.js';
import {Handles} from './view_drag.js';
import {NumbersPanel, SwitchesPanel} from './view_numbers.js';
import {TextPanel} from './view_text.js';
import {OthersPanel} from './view_others.js';
import {DrawingTools, ItemsPanel} from './view_draw.js';
import {RunPanel} from './view_run.js';
import {TemplatesDialog} from './view_templates.js';
import {Exchange, notesAbove} from './view_exchange.js';

const times_kept = 1000;
// How long a note stays, ms, after what it tells of.
const note_stays = 5000;
// While the mechanism is dragged tables follow so often, ms: the picture comes first.
const tables_pause = 150;
// From so many ms on the page says that the program is computing.
const long_computing = 600;
// A handle that is so far from where it was, px, has moved.
const visible_move = 2;

// Requests that change items.
const edits = ['draw', 'place', 'remove', 'rename', 'keys', 'copy', 'move', 'group', 'ungroup', 'import'];

const notes_of_requests = {
  undo: 'Undone: back to what was before the last change.',
  redo: 'Done again.',
  go: 'Taken to the other equilibrium.',
  set: 'Followed from the value before to the new one.',
  switch: 'It rests elsewhere now.',
  text: 'Followed to the new text.',
  reload: 'Reloaded from the file.',
};

function median(values) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.floor(sorted.length / 2)];
}

// Calls back when the next frame has been painted: a message waits until then.
function whenPainted(then) {
  requestAnimationFrame(() => {
    const channel = new MessageChannel();
    channel.port1.onmessage = then;
    channel.port2.postMessage(null);
  });
}

// A list of tabs with their panels; the arrow keys go from one to the next.
class Tabs {
  constructor(label, tabs, opened) {
    this.opened = opened;
    this.tabs = tabs;
    for (const [i, tab] of tabs.entries()) {
      tab.button = button(tab.title, () => this.open(i), {
        role: 'tab',
        id: `tab-${tab.name}`,
        'aria-controls': `panel-${tab.name}`,
      });
      tab.panel = element(
        'div',
        {role: 'tabpanel', id: `panel-${tab.name}`, class: 'panel', 'aria-labelledby': `tab-${tab.name}`, tabindex: -1},
        element('h2', {class: 'unseen'}, tab.title),
        tab.content
      );
    }
    this.list = element('div', {role: 'tablist', 'aria-label': label, class: 'tabs'}, ...tabs.map((tab) => tab.button));
    this.list.addEventListener('keydown', (event) => this.key(event));
    this.element = element('section', {class: 'panels'}, this.list, ...tabs.map((tab) => tab.panel));
    this.open(0);
  }

  open(index) {
    this.at = index;
    this.tabs.forEach((tab, i) => {
      tab.button.setAttribute('aria-selected', i === index);
      tab.button.tabIndex = i === index ? 0 : -1;
      tab.panel.hidden = i !== index;
    });
    // The row of the tabs scrolls where it is too narrow for all.
    const {list} = this;
    const tab = this.tabs[index].button;
    const first = tab.offsetLeft - list.offsetLeft;
    list.scrollLeft = Math.min(Math.max(list.scrollLeft, first + tab.offsetWidth - list.clientWidth), first);
    this.opened(this.tabs[index].name);
  }

  openNamed(name) {
    this.open(this.tabs.findIndex((tab) => tab.name === name));
  }

  get name() {
    return this.tabs[this.at].name;
  }

  retitle(name, title) {
    const tab = this.tabs.find((one) => one.name === name);
    if (tab.button.textContent !== title) tab.button.textContent = title;
  }

  key(event) {
    const count = this.tabs.length;
    const moves = {ArrowRight: this.at + 1, ArrowLeft: this.at - 1, Home: 0, End: count - 1};
    if (!Object.hasOwn(moves, event.key)) return;
    event.preventDefault();
    this.open((moves[event.key] + count) % count);
    this.tabs[this.at].button.focus();
  }
}

// Messages over the page that wait for an answer of the reader. They lie above the rest, which stays where it is.
class Bars {
  constructor() {
    this.element = element('div', {class: 'bars'});
    this.known = new Map();
  }

  show(name, text, ...buttons) {
    this.hide(name);
    const bar = element('div', {class: 'bar-over', role: 'alert'}, element('p', {}, text), ...buttons);
    this.known.set(name, bar);
    this.element.append(bar);
  }

  hide(name) {
    this.known.get(name)?.remove();
    this.known.delete(name);
  }

  has(name) {
    return this.known.has(name);
  }
}

class LiveView {
  constructor(page, palette) {
    Object.assign(this, {page, palette, state: page.view, note: {text: '', timer: 0}, tables: {due: 0, timer: 0}});
    this.times = window.poiseTimes = [];
    // What the text was when it was the file's: the program writes the position into it in its own digits.
    this.file_text = page.view.saved || page.view.undo === 0 ? page.view.text : null;
    const ask = (request, options) => this.ask(request, options);
    this.program = new Program(this.state.revision, {
      answer: (answer, wish) => this.answer(answer, wish),
      poll: (answer) => this.polled(answer),
      gone: (is_gone) => this.gone(is_gone),
    });
    this.makeFinding();
    this.moving = new MovingPicture(this.state.drawing, palette, (k, drawing) => this.frameShown(k, drawing));
    this.handles = new Handles(this.moving, ask);
    this.numbers = new NumbersPanel(ask);
    this.switches = new SwitchesPanel(ask);
    this.items = new ItemsPanel(ask, (item) => this.drawing.selection.toggle(item));
    this.drawing = new DrawingTools(this.moving, page.view.tools, ask, (names) => this.selected(names));
    this.text = new TextPanel(ask, () => this.showSaved());
    this.others = new OthersPanel(this.moving.picture, palette, ask);
    const look = (request) => this.program.aside(request);
    this.run = new RunPanel(palette, {
      tell: (request) => this.program.aside(request, true),
      look,
      shown: () => this.state,
      prepare: () => this.applyText(),
    });
    this.templates = new TemplatesDialog(palette, look, (text) => this.takeTemplate(text));
    this.begin.append(button('Start from a template', () => this.templates.open()));
    this.exchange = new Exchange(page.view.exchange, this);
    this.exchange.takeDrops(this.moving.stage);
    this.forces = element('div', {class: 'forces'});
    this.bars = new Bars();
    this.footer = element('footer', {}, `Made by Poise ${page.poise ?? ''}`, (this.speed = element('span')));
    this.tabs = new Tabs(
      'Panels',
      [
        {name: 'numbers', title: 'Numbers', content: this.numbers.element},
        {name: 'switches', title: 'Switches', content: this.switches.element},
        {name: 'items', title: 'Items', content: this.items.element},
        {name: 'forces', title: 'Forces', content: this.forces},
        {name: 'others', title: 'Equilibria', content: this.others.element},
        {name: 'run', title: 'Run', content: this.run.element},
        {name: 'text', title: 'Text', content: this.text.element},
      ],
      (name) => this.opened(name)
    );
    document.addEventListener('keydown', (event) => this.key(event));
    addEventListener('beforeunload', (event) => {
      if (this.unsaved) event.preventDefault();
    });
  }

  start(place) {
    place.classList.add('live');
    place.replaceChildren(this.header(), this.main(), this.bars.element, this.footer);
    whenTold(this.forces, {print: () => this.fillForces()});
    Object.assign(document.body.dataset, {revision: this.state.revision, kind: this.state.transition.kind});
    this.moving.show(this.state.drawing, () => this.arrived(true));
    if (this.state.draft) {
      this.bars.show(
        'draft',
        'What is shown was not saved when the program ended.',
        button('Keep it', () => this.bars.hide('draft')),
        button('Back to the file', () => {
          this.bars.hide('draft');
          this.ask({do: 'undo'});
        })
      );
    }
    // The program tells of other equilibria only after a request of its first page.
    if (this.state.revision === 0) this.ask({do: 'look'}, {note: 'opening'});
    this.program.startPolling();
  }

  header() {
    const tool = (label, action, keys) => button(label, action, {title: keys});
    this.undo_button = tool('Undo', () => this.ask({do: 'undo'}), 'Ctrl+Z');
    this.redo_button = tool('Redo', () => this.ask({do: 'redo'}), 'Ctrl+Shift+Z');
    this.save_button = tool('Save', () => this.save(), 'Ctrl+S: into the scene’s file');
    this.unsaved_mark = element('span', {class: 'unsaved', hidden: true}, 'not saved');
    this.share_button = button('Share as one page', () => this.share());
    this.reload_button = button('Reload from disk', () => this.reload());
    for (const one of [this.save_button, this.reload_button]) one.hidden = !this.state.has_file;
    return element(
      'header',
      {class: 'page-header'},
      element(
        'div',
        {class: 'titles'},
        this.title,
        element('p', {class: 'source'}, element('span', {class: 'file'}, this.state.file ?? ''), this.unsaved_mark, this.source)
      ),
      element(
        'div',
        {class: 'page-buttons'},
        this.undo_button,
        this.redo_button,
        this.save_button,
        menu('File', button('Save as …', () => this.saveAs()), this.share_button, this.reload_button, ...this.exchange.buttons),
        button('Templates', () => this.templates.open()),
        themeChoice()
      )
    );
  }

  makeFinding() {
    this.verdict = element('div', {class: 'live-verdict'});
    this.hand = element('p', {class: 'hand'});
    this.hand_stops = '';
    this.copy_stops = copyButton('Copy as stops', () => this.hand_stops);
    this.copy_stops.title = 'Put behind the scene’s text, they hold the point where it was held last';
    this.copy_stops.hidden = true;
    this.status = element('p', {class: 'status', role: 'status', 'aria-live': 'polite'});
    this.computing = element('p', {class: 'hint', role: 'status', hidden: true}, 'The program is computing …');
    this.warnings = element('div');
    this.begin = element('p', {class: 'begin', hidden: true});
    this.title = element('h1');
    this.source = element('span');
  }

  showTitle() {
    const {title, source} = this.state;
    this.title.textContent = title || 'poise view';
    this.source.textContent = source ? `Source: ${source}` : '';
  }

  main() {
    const skip = button('Skip the points of the mechanism', () => this.tabs.tabs[this.tabs.at].button.focus(), {
      class: 'skip-points',
    });
    this.moving.stage.before(skip);
    const legend = element(
      'p',
      {class: 'hint signs'},
      element('span', {class: 'sign sign-point'}),
      'drag a point',
      element('span', {class: 'sign sign-ground'}),
      'move a fixed point',
      element('span', {class: 'sign sign-load'}),
      'pull a load'
    );
    this.moving.view.tools.append(legend);
    this.moving.view.caption.remove();
    return element(
      'main',
      {id: 'main', class: 'live-main', tabindex: -1},
      element(
        'div',
        {class: 'live-left'},
        element('section', {class: 'figure live-picture', 'aria-label': 'The mechanism'}, this.drawing.element, this.moving.element),
        element(
          'section',
          {class: 'live-finding', 'aria-label': 'Finding'},
          this.verdict,
          this.begin,
          element(
            'div',
            {class: 'live-lines'},
            element('div', {class: 'hand-line'}, this.hand, this.copy_stops),
            this.status,
            this.computing
          ),
          this.warnings,
          // Not below the picture, which stays in view on narrow windows and leaves little beside itself.
          this.moving.view.key
        )
      ),
      this.tabs.element
    );
  }

  /// Asks the program for something. Whatever is played is over then.
  ask(request, options = {}) {
    if (!options.gesture) this.moving.finish();
    // An edit that cannot be applied must not be lost to a change elsewhere.
    if (this.text?.has_edits && this.text.error && edits.includes(request.do)) {
      this.say('Not done: mend the scene text first, or discard its edits.');
      this.drawing.refuse('Mend the scene text first, or discard its edits.');
      this.tabs.openNamed('text');
      return;
    }
    // Numbers in the text must not be lost to a change elsewhere.
    if (this.text?.has_edits && !this.text.error && !['text', 'drag', 'release', 'look'].includes(request.do))
      this.text.apply();
    this.program.ask(request, options);
    clearTimeout(this.patience);
    this.patience = setTimeout(() => {
      this.computing.hidden = this.program.current === null;
    }, long_computing);
  }

  answer(answer, wish) {
    clearTimeout(this.patience);
    this.computing.hidden = true;
    if (answer.error) {
      if (answer.revision > this.state.revision) this.askAboutOthers();
      this.failed(answer.error, wish);
      return;
    }
    const before = this.state;
    const refitted = this.isRefitted(before, answer, wish);
    const moved = this.hasMoved(before, answer);
    this.state = {...before, ...answer};
    const whole = answer.text !== undefined;
    Object.assign(document.body.dataset, {revision: answer.revision, kind: answer.transition.kind});
    this.keepOthers(wish, refitted, whole);
    this.numbers.follow(answer.changed ?? []);
    this.say(this.noteOf(answer, wish, moved, refitted));
    let played = false;
    this.moving.show(answer.drawing, (left_out) => {
      if (left_out) this.say(`${this.note.text} Its motion is not shown, as your system asks for less motion.`.trim());
      this.arrived(whole, wish);
      if (played) this.program.resume();
      if (answer.transition.unfinished && !this.program.busy) this.handles.goOn();
    });
    if (this.moving.playing) {
      played = true;
      this.program.pause();
    }
    if (wish.time !== null) whenPainted(() => this.addTime(performance.now() - wish.time, answer.server_ms));
  }

  // One position must not take the place of another without a word.
  noteOf({transition, drawing}, wish, moved, refitted) {
    const parts = [];
    if (transition.passed.length > 0) parts.push(`On the way: ${transition.passed.join(', ')}.`);
    if (transition.why) parts.push(`${transition.why[0].toUpperCase()}${transition.why.slice(1)}.`.replace(/\.\.$/, '.'));
    const name = wish.request.do;
    if (name === 'undo' || name === 'redo') parts.unshift(notes_of_requests[name]);
    else if (parts.length === 0 && moved && drawing.frames.length === 1 && !wish.gesture && !wish.note)
      parts.push(notes_of_requests[name] ?? '');
    if (name === 'save') parts.push(`Saved as ${this.state.file}.`);
    if (name === 'import') parts.unshift(notesAbove(this.state.text));
    if (wish.note === 'disk') parts.unshift('The file was changed on disk, and is shown as it is now.');
    if (refitted && wish.note !== 'opening') parts.push('The picture shows another part of the plane now.');
    return parts.join(' ');
  }

  // Where the ground is elsewhere on the picture, and was not moved, the picture was fitted anew.
  isRefitted(before, answer, wish) {
    if (before.drawing.width !== answer.drawing.width) return true;
    const moving = ['ground', 'set', 'text', 'import', 'undo', 'redo', 'reload', 'draw', 'place', 'remove', 'copy', 'move'];
    if (moving.includes(wish.request.do)) return false;
    return differ(before.handles, answer.handles, (one) => one.kind === 'ground', 0.5);
  }

  hasMoved(before, answer) {
    return differ(before.handles, answer.handles, (one) => one.kind !== 'load', visible_move);
  }

  // What the hand does, and going to another equilibrium, leave the equilibria what they are, and what its stops hold.
  keepOthers({request, note}, refitted, whole) {
    const same = ['drag', 'release', 'go', 'save'].includes(request.do) || (request.do === 'look' && note !== 'gesture');
    if (!same) this.hand_stops = '';
    if (!same || refitted) this.others.forget();
    else if (whole || request.do === 'drag') this.others.suspend();
    this.countOthers();
  }

  countOthers() {
    const {count} = this.others;
    this.tabs.retitle('others', count > 0 ? `Equilibria (${count})` : 'Equilibria');
  }

  // The mechanism is where the state says.
  arrived(whole, wish) {
    const {state} = this;
    this.handles.place(state.handles);
    const hand = state.hand?.text ?? '';
    if (this.hand.textContent !== hand) this.hand.textContent = hand;
    // Whoever holds a point has no hand free: its stops are offered until another is held.
    if (state.hand) this.hand_stops = state.hand.stops;
    this.copy_stops.hidden = this.hand_stops === '';
    this.undo_button.disabled = this.program.gone || !state.undo;
    this.redo_button.disabled = this.program.gone || !state.redo;
    if (whole) {
      this.numbers.update(state.numbers);
      this.switches.update(state.switches);
      const made = this.items.update(state.items);
      this.begin.hidden = state.items.length > 0;
      this.showTitle();
      this.run.update(state);
      this.drawing.update(state.sheet);
      this.drawing.selection.keep(state.items);
      if (wish?.request.do === 'copy') this.drawing.selection.choose(made);
      // Joints without a name of their own are called as the points of the part, and so are new too.
      if (wish?.request.do === 'group') this.drawing.selection.choose(made.filter((name) => name.startsWith('part ')));
      // The next poll may already tell of another change.
      if (['save', 'reload'].includes(wish?.request.do)) this.file_state = 'same';
      if (!state.draft) this.bars.hide('draft');
      if (state.saved || ['save', 'reload'].includes(wish?.request.do)) this.file_text = state.text;
      this.text.update(state.text, wish?.request.do === 'text');
      this.showSaved();
    }
    this.tablesSoon(whole);
  }

  frameShown(k, drawing) {
    const last = drawing.frames.length - 1;
    const confirmed = drawing.confirmed?.[k] ?? true;
    document.body.dataset.confirmed = confirmed;
    const shown = k === last ? this.state.verdict : {text: drawing.captions[k], tone: drawing.tones[k]};
    const key = `${shown.tone} ${confirmed} ${shown.text}`;
    if (this.verdict.dataset.key === key) return;
    this.verdict.dataset.key = key;
    const view = verdictView(shown);
    if (!confirmed) view.lastChild.append(element('span', {class: 'unconfirmed-word'}, 'not confirmed'));
    this.verdict.replaceChildren(view);
  }

  tablesSoon(at_once) {
    clearTimeout(this.tables.timer);
    const pause = at_once ? 0 : Math.max(0, this.tables.due - performance.now());
    const fill = () => {
      this.tables.due = performance.now() + tables_pause;
      this.showWarnings();
      if (this.tabs.name === 'forces') this.fillForces();
      this.showSpeed();
    };
    this.tables.timer = setTimeout(() => requestAnimationFrame(fill), pause);
  }

  showWarnings() {
    const key = JSON.stringify(this.state.warnings);
    if (this.warnings.dataset.key === key) return;
    this.warnings.dataset.key = key;
    this.warnings.replaceChildren(...(this.state.warnings.length > 0 ? [warningsView(this.state.warnings)] : []));
  }

  fillForces() {
    const {report} = this.state;
    if (this.report_shown === report) return;
    this.report_shown = report;
    const open = [...this.forces.querySelectorAll('details.details')].map((box) => box.open);
    const scrolled = [...this.forces.querySelectorAll('.scroll')].map((box) => box.scrollLeft);
    const arrangements = arrangementsIn(this.forces);
    const focus = focusIn(this.forces);
    this.forces.replaceChildren(reportView(report, 3));
    arrangeTables(this.forces, arrangements);
    this.forces.querySelectorAll('details.details').forEach((box, i) => {
      box.open = open[i] ?? false;
    });
    this.forces.querySelectorAll('.scroll').forEach((box, i) => {
      box.scrollLeft = scrolled[i] ?? 0;
    });
    refocus(this.forces, focus);
  }

  selected(names) {
    const chosen = this.items.mark(names);
    // The panel shows what was clicked on the sheet.
    if (chosen.length === 1 && this.tabs && this.tabs.name !== 'items') this.tabs.openNamed('items');
    this.items.reveal();
    return chosen;
  }

  opened(name) {
    this.others.setOpen(name === 'others');
    if (name === 'forces') this.fillForces();
    if (name === 'run') this.run.open();
    if (name === 'text') requestAnimationFrame(() => this.text.scrolled());
  }

  addTime(total, server) {
    this.times.push({total, server});
    if (this.times.length > times_kept) this.times.shift();
  }

  showSpeed() {
    if (this.times.length === 0) return;
    const total = numberText(median(this.times.map((time) => time.total)), 2);
    const server = numberText(median(this.times.map((time) => time.server)), 2);
    this.speed.textContent = ` · From the pointer to the picture: median ${total} ms, program ${server} ms`;
  }

  /// Says something below the picture. What was said before stays for a while where there is nothing new.
  say(text) {
    clearTimeout(this.note.timer);
    if (text && this.note.text !== text) {
      this.note.text = text;
      this.status.textContent = text;
    }
    this.note.timer = setTimeout(() => {
      this.note.text = this.status.textContent = '';
    }, note_stays);
  }

  failed(error, wish) {
    const {request} = wish;
    const is_seen = request.do === 'text' && this.tabs.name === 'text';
    if (!is_seen) this.say(this.shortened(error.text));
    if (edits.includes(request.do)) this.drawing.refuse(this.shortened(error.text));
    if (request.do === 'set') {
      this.numbers.refuse(request.path, error.text);
    } else if (request.do === 'switch') {
      this.switches.refuse(request.item, error.text);
    } else if (request.do === 'rename') {
      this.items.refuse();
      this.items.update(this.state.items);
    } else if (request.do === 'text') {
      this.text.refuse(this.shortened(error.text), error.line);
    } else if (request.do === 'save' && error.text.startsWith('changed on disk')) {
      this.bars.show(
        'file',
        'The file was changed on disk since it was read. Saving would overwrite that.',
        button('Save all the same', () => this.saveAnyway()),
        button('Show the file instead', () => this.reload())
      );
    } else if (wish.note === 'disk') {
      this.askAboutFile(`The file was changed on disk, but cannot be shown: ${this.shortened(error.text)}`);
    } else if (request.do === 'go') {
      this.others.forget();
    }
  }

  // The file's name without its folders.
  shortened(text) {
    const {file} = this.state;
    return file ? text.replace(/\S*[/\\](?=[^/\\\s]+:\d+)/, '') : text;
  }

  get unsaved() {
    const changed = !this.state.saved && this.state.text !== this.file_text;
    return changed || this.text.has_edits;
  }

  showSaved() {
    if (!this.unsaved_mark) return;
    const {unsaved} = this;
    this.unsaved_mark.hidden = !unsaved;
    const title = this.state.title || 'poise view';
    document.title = unsaved ? `• ${title}` : title;
  }

  save() {
    if (!this.state.has_file) {
      this.saveAs();
      return;
    }
    // Edits come first; what cannot be read is not written.
    if (this.text.error) {
      this.say('Not saved: the scene text has an error.');
      this.tabs.openNamed('text');
      return;
    }
    this.ask({do: 'save'});
  }

  /// Sends edits of the text to the program; false where it cannot be read.
  applyText() {
    if (this.text.error) return false;
    this.text.apply();
    return true;
  }

  takeTemplate(text) {
    this.text.revert();
    this.ask({do: 'text', text, fit: true});
  }

  saveAnyway() {
    this.bars.hide('file');
    this.ask({do: 'save', anyway: true});
  }

  saveAs() {
    download(this.state.file || 'scene.toml', 'application/toml', this.text.value);
  }

  async share() {
    try {
      const page = await this.program.shared();
      download(fileName((this.state.file || 'mechanism').replace(/\.toml$/, ''), 'html'), 'text/html', page);
    } catch {
      this.say('The page was not made: the program did not answer.');
    }
  }

  reload(note = '') {
    this.bars.hide('file');
    this.text.revert();
    this.text.area.blur();
    this.ask({do: 'reload'}, {note});
  }

  polled({revision, others, file, company}) {
    if (company !== this.company) this.setCompany(company);
    if (this.program.busy || this.moving.playing) return;
    if (revision > this.state.revision && !this.handles.held) this.askAboutOthers();
    if (others) {
      this.program.others_had = others.revision;
      if (others.revision === this.state.revision) {
        this.others.show(others);
        this.countOthers();
      }
    }
    this.followFile(file);
  }

  // Of programs that show one file each may save over what the other has saved.
  setCompany(company) {
    this.company = company;
    if (company) {
      this.bars.show(
        'company',
        'Another poise view shows this file too.',
        button('Close', () => this.bars.hide('company'))
      );
    } else {
      this.bars.hide('company');
    }
  }

  askAboutOthers() {
    if (this.bars.has('elsewhere')) return;
    this.bars.show(
      'elsewhere',
      'The mechanism was changed in another window.',
      button('Show it', () => {
        this.bars.hide('elsewhere');
        this.ask({do: 'look'});
      })
    );
  }

  followFile(file) {
    const before = this.file_state;
    this.file_state = file;
    if (file === before) return;
    if (file === 'same') {
      this.bars.hide('file');
    } else if (file === 'gone') {
      this.bars.show(
        'file',
        'The scene’s file is not there any more.',
        button('Write it again', () => this.saveAnyway()),
        button('Close', () => this.bars.hide('file'))
      );
    } else if (this.unsaved) {
      this.askAboutFile('The file was changed on disk, and you have changes that are not saved.');
    } else {
      this.reload('disk');
    }
  }

  askAboutFile(text) {
    this.file_state = 'changed';
    this.bars.show(
      'file',
      text,
      button('Show the file', () => this.reload()),
      button('Keep what is here', () => this.bars.hide('file'))
    );
  }

  gone(is_gone) {
    document.body.classList.toggle('program-gone', is_gone);
    this.handles.setEnabled(!is_gone);
    for (const one of [this.save_button, this.share_button, this.reload_button, ...this.exchange.buttons]) one.disabled = is_gone;
    for (const box of [this.numbers, this.switches]) {
      for (const input of box.element.querySelectorAll('.numbers input, .switches input')) input.disabled = is_gone;
    }
    if (is_gone) this.others.suspend();
    if (is_gone) {
      this.bars.show(
        'gone',
        'The program has ended: the mechanism cannot be moved any more. The text can still be saved.',
        button('Save the text as …', () => this.saveAs())
      );
    } else {
      this.bars.hide('gone');
      this.ask({do: 'look'});
    }
    this.arrived(false);
  }

  key(event) {
    if (!(event.ctrlKey || event.metaKey) || event.altKey) return;
    const key = event.key.toLowerCase();
    if (key === 's' && !event.shiftKey) {
      event.preventDefault();
      if (!this.program.gone) this.save();
      return;
    }
    const types = event.target.closest('textarea, input[type="number"], input[type="search"], input[type="text"]');
    // In an empty field for places there is nothing else to take back.
    const is_empty = types?.classList.contains('draw-typed') && types.value === '';
    if ((types && !is_empty) || !['z', 'y'].includes(key)) return;
    event.preventDefault();
    const what = key === 'y' || event.shiftKey ? 'redo' : 'undo';
    if (this.state[what]) this.ask({do: what});
  }
}

// Whether some handle of a kind is elsewhere than before by more than a distance, px.
function differ(before, after, which, distance) {
  const places = new Map(before.filter(which).map((one) => [`${one.kind} ${one.name}`, one.px]));
  return after.filter(which).some((one) => {
    const px = places.get(`${one.kind} ${one.name}`);
    return px !== undefined && Math.hypot(px[0] - one.px[0], px[1] - one.px[1]) > distance;
  });
}

/// Shows a document with a live view in a place of the page.
export function showLiveView(page, palette, place) {
  new LiveView(page, palette).start(place);
}
