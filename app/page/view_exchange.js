// Files of other programs: what the File menu has for them, and files that are dropped onto the drawing. The program
// reads and writes them; the page hands over texts.

import {button, copyButton, download, element, fileName} from './dom.js';

// More than the program takes in one request.
const most_bytes = 900000;
// Of the notes so many are told; all stand above the text.
const notes_told = 3;

const short_names = {dxf: 'DXF', pmks: 'PMKS+', urdf: 'URDF', mjcf: 'MJCF'};

function inWords(notes) {
  const more = notes.length - notes_told;
  return [...notes.slice(0, notes_told), ...(more > 0 ? [`${more} more ${more === 1 ? 'note' : 'notes'}.`] : [])].join(' ');
}

// The button of the menu keeps the focus.
function closeMenu(event) {
  const box = event.target.closest('details');
  box.open = false;
  box.querySelector('summary').focus();
}

/// What was decided or left out when a file was imported: the comments above its scene.
export function notesAbove(text) {
  const lines = text.split('\n');
  const end = lines.findIndex((line) => !line.startsWith('# '));
  const notes = lines.slice(0, end).map((line) => line.slice(2));
  return `Imported. ${inWords(notes)}`;
}

/// `formats`: of the program's page. `view`: the live view.
export class Exchange {
  constructor(formats, view) {
    Object.assign(this, {formats, view});
    this.input = element('input', {
      type: 'file',
      class: 'import-file',
      accept: formats.read.map((ending) => `.${ending}`).join(','),
      hidden: true,
      change: () => this.take(this.input.files),
    });
    this.buttons = [
      button('Import …', (event) => {
        closeMenu(event);
        this.input.click();
      }),
      this.input,
      ...formats.write.map((format) =>
        button(
          `Export as ${short_names[format.name] ?? format.name}`,
          (event) => {
            closeMenu(event);
            this.write(format);
          },
          {title: format.what, 'data-format': format.name}
        )
      ),
    ];
  }

  /// Takes files that are dropped onto an element.
  takeDrops(place) {
    const hasFiles = (event) => [...(event.dataTransfer?.types ?? [])].includes('Files');
    place.addEventListener('dragover', (event) => {
      if (hasFiles(event)) event.preventDefault();
    });
    place.addEventListener('drop', (event) => {
      if (!hasFiles(event)) return;
      event.preventDefault();
      this.take(event.dataTransfer.files);
    });
  }

  async take(files) {
    const [file] = files;
    if (!file) return;
    if (files.length > 1) this.view.say('Not imported: expected one file; give one after the other.');
    else if (file.size > most_bytes) this.view.say(`Not imported: ${file.name} has more than 900 kB; use poise import.`);
    else this.view.ask({do: 'import', name: file.name, text: await file.text()});
    // The same file may be given again.
    this.input.value = '';
  }

  async write(format) {
    const answer = await this.view.program.fetched({do: 'export', format: format.name});
    if (answer.error) {
      this.view.say(`Not exported: ${this.view.shortened(answer.error.text)}`);
      return;
    }
    const {text, notes} = answer.exported;
    if (format.name === 'pmks') {
      const close = button('Close', () => this.view.bars.hide('address'));
      this.view.bars.show('address', 'The mechanism is an address of PMKS+.', copyButton('Copy it', () => text), close);
    } else {
      const stem = (this.view.state.file || 'mechanism').replace(/\.toml$/, '');
      download(fileName(stem, format.ending), 'text/plain', text);
    }
    this.view.say(inWords(notes));
  }
}
