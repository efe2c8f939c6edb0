// Light and dark. Every colour of the document's palette becomes a CSS variable with both values; charts, which are
// drawn on canvases, ask for the value in force and are told when it changes. Print is always light.

import {element} from './dom.js';

const setting_key = 'poise-theme';
const system_is_dark = matchMedia('(prefers-color-scheme: dark)');
const theme = {setting: 'auto', palette: {}, printing: false};

const is_name = /^[a-z0-9-]+$/;
const is_colour = /^#[0-9a-f]{3,8}$/i;

// Storage may be forbidden in a file: then the setting lasts as long as the page.
function stored(action) {
  try {
    return action(localStorage);
  } catch {
    return null;
  }
}

function isDark() {
  return theme.setting === 'dark' || (theme.setting === 'auto' && system_is_dark.matches);
}

function applyTheme() {
  document.documentElement.dataset.theme = isDark() ? 'dark' : 'light';
  tell('colours');
}

function tell(what) {
  for (const node of document.querySelectorAll('[data-told]')) node.dispatchEvent(new Event(what));
}

function variables(index) {
  return Object.entries(theme.palette)
    .map(([name, pair]) => `--c-${name}:${pair[index]};`)
    .join('');
}

/// Takes the colours of a document; what is not a name with two colours is left out.
export function usePalette(palette) {
  const valid = ([name, pair]) =>
    is_name.test(name) && Array.isArray(pair) && pair.length === 2 && pair.every((value) => is_colour.test(value));
  theme.palette = Object.fromEntries(Object.entries(palette ?? {}).filter(valid));
  document.getElementById('palette')?.remove();
  const rules = `:root{${variables(0)}}@media screen{:root[data-theme="dark"]{${variables(1)}}}`;
  document.head.append(element('style', {id: 'palette'}, rules));
  return theme.palette;
}

/// The value in force of a colour, for canvases.
export function colourNow(name) {
  const pair = Object.hasOwn(theme.palette, name)
    ? theme.palette[name]
    : (theme.palette.dark ?? ['#2b343c', '#dfe6eb']);
  return pair[isDark() && !theme.printing ? 1 : 0];
}

/// Has actions called while a node is part of the page: `colours` after colours have changed, `print` when printing
/// starts, with light colours in force, and `printed` when it is over. Nodes that leave the page need no farewell.
export function whenTold(node, actions) {
  node.dataset.told = '';
  for (const [what, action] of Object.entries(actions)) node.addEventListener(what, action);
}

export function startTheme() {
  const setting = stored((storage) => storage.getItem(setting_key));
  if (['light', 'dark'].includes(setting)) theme.setting = setting;
  system_is_dark.addEventListener('change', applyTheme);
  for (const [event, printing, what] of [
    ['beforeprint', true, 'print'],
    ['afterprint', false, 'printed'],
  ]) {
    addEventListener(event, () => {
      theme.printing = printing;
      tell(what);
    });
  }
  applyTheme();
}

/// The choice between light, dark and what the system says.
export function themeChoice() {
  const radio = (value, label) => {
    const input = element('input', {
      type: 'radio',
      name: 'theme',
      value,
      change: () => {
        theme.setting = value;
        stored((storage) => storage.setItem(setting_key, value));
        applyTheme();
      },
    });
    input.checked = theme.setting === value;
    return element('label', {}, input, element('span', {}, label));
  };
  return element(
    'fieldset',
    {class: 'choice'},
    element('legend', {class: 'unseen'}, 'Colours'),
    radio('light', 'Light'),
    radio('dark', 'Dark'),
    radio('auto', 'Auto')
  );
}
