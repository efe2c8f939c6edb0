// Commands of poise for the mechanism that is shown: a form of their options, and the result beside the drawing.

import {button, copyButton, download, element, fileName, say} from './dom.js';
import {lineView, resultViews} from './report_page.js';

const result_pause = 250;
// Of the command that a reader sees first.
const first_command = 'path';
// How far a drive is turned where nothing else is known, in the unit of the scene.
const first_turn = {deg: 30, rad: 0.5};

function short(value) {
  return String(Number(value.toPrecision(6)));
}

function bodiesOf(sheet) {
  return [...new Set(sheet.points.map(({name}) => name.slice(0, name.lastIndexOf('.'))))].filter((name) => name !== 'ground');
}

// Names of quantities that any scene has, and those of its springs and joints.
function quantitiesOf(state) {
  const called = (kind) =>
    state.items.filter(({item}) => item.startsWith(`${kind} `)).map(({item}) => item.slice(kind.length + 1));
  return [
    ...called('spring').map((name) => `force.${name}`),
    ...bodiesOf(state.sheet).map((name) => `angle.${name}`),
    ...[...called('pin'), ...called('slide')].map((name) => `reaction.${name}`),
    'energy',
  ];
}

function drivesOf(state) {
  const bodies = bodiesOf(state.sheet);
  return Object.entries(state.position).map(([name, value]) => {
    const way = bodies.includes(name) ? (first_turn[state.sheet.angle] ?? 0.5) : 0.1 * Math.abs(value);
    const from = Number(value.toPrecision(4));
    return `${name}=${short(from)}..${short(from + way)}`;
  });
}

// What a text may say, the likeliest first.
const suggestions = {
  '--vary': ({numbers}) => {
    const loads_first = [...numbers].sort((a, b) => (b.group === 'loads') - (a.group === 'loads'));
    return loads_first.map(({path, low, high}) => `${path}=${short(low)}..${short(high)}`);
  },
  '--drive': drivesOf,
  '--set': ({numbers}) => numbers.map(({path, value}) => `${path}=${short(value)}`),
  '--point': ({sheet}) => sheet.points.map(({name}) => name).filter((name) => !name.startsWith('ground.')),
  '--of': quantitiesOf,
  '--show': quantitiesOf,
  '--for': ({position, sheet}) =>
    bodiesOf(sheet)
      .filter((name) => name in position)
      .map((name) => `angle.${name} = ${short(position[name])}`),
};

// An option in a form. Its words are those of the command line.
class Field {
  constructor(command, option, state) {
    Object.assign(this, {option, inputs: [], filled: ''});
    const id = `run-${command.name}-${option.name.replace(/^-+/, '')}`;
    const shown = option.name.startsWith('-') ? option.name : option.name.toLowerCase();
    this.example = command.example.match(new RegExp(`${option.name} ("[^"]*"|\\S+)`))?.[1].replaceAll('"', '') ?? '';
    this.words = element('datalist', {id: `${id}-words`});
    this.box = element('div', {class: 'run-words'}, this.input(id));
    const label = element('label', {for: id}, element('code', {}, shown), option.value ? ` ${option.value}` : '');
    const help = element('p', {class: 'hint', id: `${id}-help`}, option.help.replaceAll('\n', ' '));
    this.inputs[0].setAttribute('aria-describedby', help.id);
    const more =
      option.kind === 'list' && option.choices.length === 0
        ? button('Another', () => this.another(), {class: 'quiet', 'aria-label': `Another ${shown}`})
        : null;
    this.element = element(
      'div',
      {class: option.kind === 'flag' ? 'run-field flag' : 'run-field', 'data-option': option.name},
      label,
      this.box,
      more,
      help,
      this.words
    );
    if (option.required) this.suggest(state);
  }

  input(id) {
    const {option} = this;
    let input;
    if (option.kind === 'flag') {
      input = element('input', {type: 'checkbox', id});
    } else if (option.choices.length > 0) {
      const words = option.required ? option.choices : ['', ...option.choices];
      input = element('select', {id}, ...words.map((word) => element('option', {value: word}, word || 'not given')));
    } else {
      input = element('input', {
        type: 'text',
        id,
        list: this.words.id,
        placeholder: this.example,
        spellcheck: 'false',
        autocomplete: 'off',
        required: option.required,
      });
    }
    this.inputs.push(input);
    return input;
  }

  another() {
    const input = this.input(`${this.inputs[0].id}-${this.inputs.length}`);
    input.required = false;
    input.setAttribute('aria-label', `${this.option.name}, once more`);
    this.box.append(input);
    input.focus();
  }

  // What is needed is filled in; what the reader has written stays.
  suggest(state) {
    const {option, inputs} = this;
    const words = suggestions[option.name]?.(state) ?? [];
    this.words.replaceChildren(...words.map((word) => element('option', {value: word})));
    const [input] = inputs;
    if (!option.required || input.type !== 'text' || input.value !== this.filled || words.includes(input.value)) return;
    input.value = this.filled = words[0] ?? (option.kind.endsWith('number') ? this.example : '');
  }

  get given() {
    const {name, kind} = this.option;
    if (kind === 'flag') return this.inputs[0].checked ? [[name]] : [];
    return this.inputs.map(({value}) => value.trim()).filter((word) => word !== '').map((word) => [name, word]);
  }
}

// The options of a command: what it needs, and all others in a closed box.
class Form {
  constructor(command, state, submit) {
    const possible = command.options.filter(({is_file, choices}) => !is_file || choices.length > 0);
    this.fields = possible.map((option) => new Field(command, option, state));
    const [needed, others] = [true, false].map((is) => this.fields.filter(({option}) => option.required === is));
    this.element = element(
      'form',
      {
        novalidate: true,
        submit: (event) => {
          event.preventDefault();
          submit();
        },
      },
      element('p', {class: 'run-help'}, command.help),
      ...needed.map((field) => field.element),
      others.length > 0
        ? element('details', {class: 'run-options'}, element('summary', {}, 'Options'), ...others.map((field) => field.element))
        : null,
      // Enter in a field runs the command.
      element('button', {type: 'submit', hidden: true})
    );
  }

  suggest(state) {
    for (const field of this.fields) field.suggest(state);
  }

  get given() {
    return this.fields.flatMap((field) => field.given);
  }
}

/// The panel with the commands. `tell(request)` sends one to the program behind what was asked before, `look(request)` at
/// once; both return the answer. `shown()` is the state of the page, `prepare()` false where its text cannot be used.
export class RunPanel {
  constructor(palette, {tell, look, shown, prepare}) {
    Object.assign(this, {palette, tell, look, shown, prepare, commands: null, forms: new Map(), run: null, timer: 0});
    this.choice = element('select', {id: 'run-command', change: () => this.choose()});
    this.form = element('div');
    this.start_button = button('Run', () => this.start(), {class: 'run-start'});
    this.stop_button = button('Stop', () => this.stop(), {hidden: true});
    this.status = element('p', {class: 'run-status', role: 'status'});
    this.error = element('p', {class: 'text-error', role: 'alert', hidden: true});
    this.stale = element(
      'div',
      {class: 'run-stale', role: 'status', hidden: true},
      element('p', {}, 'The mechanism was changed since: this is of an earlier state.'),
      button('Run again', () => this.again())
    );
    this.result = element('section', {class: 'run-result', 'aria-label': 'Result'});
    this.element = element(
      'div',
      {class: 'run'},
      element('div', {class: 'run-field'}, element('label', {for: 'run-command'}, 'Command'), this.choice),
      this.form,
      element('div', {class: 'run-buttons'}, this.start_button, this.stop_button, this.status),
      this.error,
      this.stale,
      this.result
    );
  }

  /// The panel is looked at. The files that may be named may be others than before.
  async open() {
    const answer = await this.tell({do: 'commands'});
    if (answer.error) {
      this.complain(answer.error.text);
      return;
    }
    if (JSON.stringify(answer.commands) === JSON.stringify(this.commands)) return;
    const chosen = this.commands === null ? (answer.run?.command ?? first_command) : this.choice.value;
    this.commands = answer.commands;
    this.forms.clear();
    this.choice.replaceChildren(...this.commands.map(({name}) => element('option', {value: name}, name)));
    this.choice.value = this.commands.some(({name}) => name === chosen) ? chosen : first_command;
    this.choose();
    this.follow(answer);
  }

  choose() {
    const command = this.commands.find(({name}) => name === this.choice.value);
    if (this.forms.has(command.name)) this.forms.get(command.name).suggest(this.shown());
    else this.forms.set(command.name, new Form(command, this.shown(), () => this.start()));
    this.form.replaceChildren(this.forms.get(command.name).element);
  }

  start() {
    this.send(this.choice.value, this.forms.get(this.choice.value).given);
  }

  again() {
    this.send(this.run.command, this.run.options);
  }

  async send(command, options) {
    if (this.run?.state === 'running') return;
    if (!this.prepare()) {
      this.complain('Mend the scene text first, or discard its edits.');
      return;
    }
    this.complain('');
    this.start_button.disabled = true;
    const answer = await this.tell({do: 'run', command, options});
    this.start_button.disabled = false;
    if (answer.error) this.complain(answer.error.text);
    else this.follow(answer);
  }

  async stop() {
    this.stop_button.disabled = true;
    this.follow(await this.look({do: 'stop'}));
  }

  // Shows how far the program is, and asks again as long as it works.
  follow({run, error}) {
    clearTimeout(this.timer);
    if (error) {
      this.complain(error.text);
      this.stop_button.hidden = true;
      return;
    }
    if (!run) return;
    this.run = run;
    const runs = run.state === 'running';
    this.start_button.hidden = runs;
    this.stop_button.hidden = !runs;
    if (!runs) this.stop_button.disabled = false;
    this.element.classList.toggle('running', runs);
    this.element.dataset.state = run.state;
    this.status.textContent = runs ? `${run.stopped ? 'Stopping' : 'Running'} … ${run.doing}` : '';
    if (runs) {
      this.timer = setTimeout(async () => this.follow(await this.look({do: 'result'})), result_pause);
      this.stale.hidden = true;
      return;
    }
    if (run.state === 'failed') {
      this.result.replaceChildren();
      this.complain(run.error);
    } else {
      this.show(run);
    }
    this.update(this.shown());
  }

  show(run) {
    const save = async () => {
      const {html, error} = await this.look({do: 'result', html: true});
      if (error) this.complain(error.text);
      else download(fileName(`${run.page.title || 'poise'} ${run.command}`, 'html'), 'text/html', html);
    };
    this.result.dataset.revision = run.of;
    this.result.replaceChildren(
      element('h3', {}, `Result of ${run.command}`),
      lineView(run.line),
      run.saved ? '' : element('p', {class: 'hint'}, 'The line reads the file: save the scene before you use it.'),
      ...resultViews(run.page, this.palette),
      element(
        'div',
        {class: 'run-buttons'},
        button('Save as one page', save),
        copyButton('Copy the numbers (JSON)', () => JSON.stringify(run.page.result, null, 2)),
        element('span', {class: 'hint'}, `Of state ${run.of} of the mechanism`)
      )
    );
    say(run.page.verdict?.text ?? '');
  }

  /// The mechanism is another than it was, perhaps.
  update(state) {
    const {run} = this;
    if (this.commands) this.forms.get(this.choice.value).suggest(state);
    if (!run || run.state === 'running') return;
    this.stale.hidden = run.state !== 'done' || run.text === state.text;
    this.result.classList.toggle('earlier', !this.stale.hidden);
  }

  complain(text) {
    this.error.hidden = text === '';
    this.error.textContent = text;
  }
}
