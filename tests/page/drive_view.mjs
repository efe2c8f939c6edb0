// Drives the live view of a running `poise view` in Chromium and says what does not work:
//   node tests/page/drive_view.mjs ADDRESS FILE SHOTS MODULES [CHROMIUM]
// ADDRESS: what `poise view FILE` printed; FILE: the scene, a copy, because it is written; MODULES: a folder in which
// `npm i playwright-core axe-core` was run. The page is that of this folder's app/page/, with the program's document.

import {execFileSync} from 'node:child_process';
import {mkdirSync, readFileSync, writeFileSync} from 'node:fs';
import {basename, resolve} from 'node:path';
import {fileURLToPath} from 'node:url';
import {inflateSync} from 'node:zlib';

import {Expectations, packagesIn, startBrowser} from './browser.mjs';

const [address, file, shots, modules, program] = process.argv.slice(2);
const scene = basename(file, '.toml');
const original = readFileSync(file, 'utf8');
mkdirSync(shots, {recursive: true});
const need = packagesIn(modules);
const browser = await startBrowser(need, program);
const expectations = new Expectations(scene);
const {expect} = expectations;

async function assembled() {
  const served = await (await fetch(address)).text();
  const document = served.match(/<script type="text\/plain" id="document">(.*?)<\/script>/s)[1];
  const [source, target] = [resolve(shots, `${scene}.json`), resolve(shots, `${scene}.html`)];
  writeFileSync(source, inflateSync(Buffer.from(document, 'base64')));
  execFileSync('python3', [fileURLToPath(new URL('assemble.py', import.meta.url)), source, target]);
  return readFileSync(target, 'utf8');
}

async function open({width = 1280, colorScheme = 'light', reducedMotion = 'no-preference'} = {}) {
  const context = await browser.newContext({
    viewport: {width, height: width < 600 ? 800 : 900},
    colorScheme,
    reducedMotion,
    hasTouch: width < 600,
  });
  const page = await context.newPage();
  page.silent = true;
  page.on('console', (message) => page.silent && expect('nothing is written to the console', false, message.text()));
  page.on('pageerror', (error) => expect('no errors', false, error.stack));
  page.on('dialog', (dialog) => dialog.accept());
  const body = await assembled();
  await page.route(address, (route) => route.fulfill({body, contentType: 'text/html'}));
  await page.goto(address);
  // Requests are not slowed down by being looked at.
  await page.unroute(address);
  await page.waitForFunction(() => document.body.dataset.revision !== undefined, null, {timeout: 5000});
  await settled(page);
  return page;
}

const data = (page) => page.evaluate(() => ({...document.body.dataset}));
const post = (page, request) =>
  page.evaluate(async (body) => (await fetch('do', {method: 'POST', body: JSON.stringify(body)})).json(), request);
// As another window asks that shows the present state.
const ask = async (page, request) => post(page, {...request, revision: (await post(page, {do: 'look'})).revision});

const undoSteps = async (page) => (await ask(page, {do: 'look'})).undo;

// Until nothing is under way or played any more.
async function settled(page) {
  let last = '';
  for (let k = 0; k < 100; ++k) {
    await page.waitForTimeout(60);
    const now = await page.evaluate(
      () => document.body.dataset.revision + document.querySelectorAll('.stage.moving').length
    );
    if (now === last && now.endsWith('0')) return;
    last = now;
  }
}

async function middle(locator) {
  const box = await locator.boundingBox();
  return [box.x + box.width / 2, box.y + box.height / 2];
}

const handle = (page, kind, i = 0) => page.locator(`.handle-${kind}`).nth(i);
const middleOf = (values) => [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];

async function checkDrag() {
  const page = await open();
  const count = await page.locator('.handle-point').count();
  const point = handle(page, 'point', Math.max(0, count - 2));
  const name = await point.getAttribute('data-name');
  const [x, y] = await middle(point);
  await page.mouse.move(x, y);
  await page.screenshot({path: `${shots}/${scene}-hover.png`});
  await page.mouse.down();
  let held = '';
  let confirmed = 0;
  const steps = 90;
  for (let k = 1; k <= steps; ++k) {
    const turn = (2 * Math.PI * k) / steps;
    await page.mouse.move(x - 60 + 60 * Math.cos(turn), y + 60 * Math.sin(turn));
    await page.waitForTimeout(12);
    const now = await page.evaluate(() => [document.querySelector('.hand').textContent, document.body.dataset.confirmed]);
    held = now[0] || held;
    confirmed += now[1] === 'true';
    if (k === 30) await page.screenshot({path: `${shots}/${scene}-held.png`});
  }
  expect('the hand is shown', held.startsWith(`held at ${name}`), held);
  await page.mouse.up();
  await settled(page);
  expect('the hand lets go', (await page.locator('.hand').textContent()) === '');
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.getByRole('button', {name: 'Copy as stops'}).click();
  const stops = await page.evaluate(() => navigator.clipboard.readText());
  expect('its stops are copied', stops.includes('[[stop]]') && stops.includes(name), stops);
  const after = await data(page);
  const status = await page.locator('.status').textContent();
  await page.screenshot({path: `${shots}/${scene}-released.png`});
  const times = await page.evaluate(() => window.poiseTimes);
  const [total, server] = [middleOf(times.map((t) => t.total)), middleOf(times.map((t) => t.server))];
  const worst = [...times.map((t) => t.total)].sort((a, b) => a - b)[Math.floor(times.length * 0.95)];
  console.log(
    `${scene}: drag ${name}: ${times.length} pictures, median ${total.toFixed(1)} ms (95 %: ${worst.toFixed(1)} ms), ` +
      `program ${server.toFixed(2)} ms; confirmed ${confirmed}/${steps}; ${after.kind}: "${status}"`
  );
  expect('within a frame', total <= 16, total);
  await page.context().close();
}

// The order of a table stays while answers come.
async function checkSorting() {
  const page = await open();
  await page.getByRole('tab', {name: 'Forces'}).click();
  const sort = page.locator('#panel-forces .sort').first();
  await sort.click();
  await sort.click();
  const order = () => page.locator('#panel-forces th[aria-sort="descending"]').count();
  expect('sorted', (await order()) === 1);
  await handle(page, 'point').focus();
  await page.keyboard.press('ArrowUp');
  await settled(page);
  await page.keyboard.press('Enter');
  await settled(page);
  await page.waitForTimeout(200);
  expect('still sorted', (await order()) === 1);
  await page.context().close();
}

async function checkKeys() {
  const page = await open();
  const count = await page.locator('.handle-point').count();
  const point = handle(page, 'point', Math.max(0, count - 1));
  await point.focus();
  for (const key of ['ArrowUp', 'ArrowLeft', 'Shift+ArrowUp', 'ArrowRight', 'ArrowUp']) {
    await page.keyboard.press(key);
    await page.waitForTimeout(60);
  }
  expect('keys move a point', (await page.locator('.hand').textContent()).startsWith('held at'));
  await page.screenshot({path: `${shots}/${scene}-keys.png`});
  await page.keyboard.press('Enter');
  await settled(page);
  expect('Enter lets go', (await page.locator('.hand').textContent()) === '');
  const load = handle(page, 'load');
  if ((await load.count()) > 0) {
    const undo = page.getByRole('button', {name: 'Undo'});
    const steps = await undoSteps(page);
    await load.focus();
    for (const key of ['ArrowUp', 'ArrowUp', 'ArrowRight']) {
      await page.keyboard.press(key);
      await page.waitForTimeout(60);
    }
    await page.keyboard.press('Escape');
    await settled(page);
    expect('a load was pulled', (await data(page)).revision && !(await undo.isDisabled()));
    await page.keyboard.press('Control+z');
    await settled(page);
    expect('one step back', (await undoSteps(page)) === steps);
    expect('undo is said', (await page.locator('.status').textContent()).startsWith('Undone'));
  }
  const ground = handle(page, 'ground');
  if ((await ground.count()) > 0) {
    await ground.focus();
    await page.keyboard.press('Shift+ArrowRight');
    await page.waitForTimeout(80);
    await page.keyboard.press('Enter');
    await settled(page);
    await page.keyboard.press('Control+z');
    await settled(page);
  }
  // By keys alone to the panels and through them.
  await page.locator('.skip-points').focus();
  await page.keyboard.press('Enter');
  expect('the points are skipped', (await page.evaluate(() => document.activeElement.id)) === 'tab-numbers');
  for (const name of ['switches', 'forces', 'others', 'text', 'numbers']) {
    await page.keyboard.press('ArrowRight');
    expect(`tab ${name}`, await page.locator(`#panel-${name}`).isVisible());
  }
  await page.context().close();
}

async function checkNumbers() {
  const page = await open();
  const row = page.locator('.number').first();
  const path = await row.getAttribute('data-number');
  const slider = row.locator('input[type="range"]');
  const field = row.locator('input[type="number"]');
  const value = await field.inputValue();
  await slider.focus();
  await page.keyboard.press('ArrowRight');
  await settled(page);
  expect('a slider moves the number', (await field.inputValue()) !== value, `${path} ${await field.inputValue()}`);
  const high = Number(await slider.getAttribute('max'));
  await field.fill(String(high * 1.5 || 10));
  await field.press('Enter');
  await settled(page);
  expect('the range grows', Number(await slider.getAttribute('max')) > high);
  await page.getByRole('button', {name: 'Undo'}).click();
  await settled(page);
  await page.getByRole('button', {name: 'Undo'}).click();
  await settled(page);
  expect('undone', (await field.inputValue()) === value, await field.inputValue());
  await page.getByRole('button', {name: 'Redo'}).click();
  await settled(page);
  await page.getByRole('button', {name: 'Undo'}).click();
  await settled(page);
  const positive = page.locator('[data-number$="stiffness"], [data-number$="mass"]').first();
  if ((await positive.count()) > 0) {
    const number = positive.locator('input[type="number"]');
    const good = await number.inputValue();
    await number.fill('-3');
    await number.press('Enter');
    await page.waitForTimeout(200);
    expect('an error at the number', await positive.locator('.number-error').isVisible());
    expect('the value goes back', (await number.inputValue()) === good, await number.inputValue());
    await page.screenshot({path: `${shots}/${scene}-number-error.png`});
  }
  const search = page.getByRole('searchbox', {name: 'Search numbers'});
  if (await search.isVisible()) {
    await search.fill('zzz');
    expect('nothing found', await page.getByText('No number has this').isVisible());
    await search.fill('');
  }
  await page.context().close();
}

async function checkText() {
  const page = await open();
  await page.getByRole('tab', {name: 'Text'}).click();
  const area = page.getByRole('textbox', {name: 'Scene text'});
  const text = await area.inputValue();
  const before = await data(page);
  await area.fill(`${text}\n[[sprin]]\nname = "x"\n`);
  await page.waitForTimeout(700);
  expect('an error in words', /\.toml:\d+/.test(await page.locator('.text-error').textContent()));
  expect('a mark at the line', (await page.locator('.gutter .wrong').count()) === 1);
  expect('the mechanism stays', (await data(page)).revision === before.revision);
  expect('marked as not saved', (await page.title()).startsWith('•'));
  await page.getByRole('button', {name: /Go to line/}).click();
  await page.screenshot({path: `${shots}/${scene}-bad-text.png`});
  await page.getByRole('button', {name: 'Discard these edits'}).click();
  expect('edits are gone', (await area.inputValue()) === text);
  const commented = `# a remark\n${text}`;
  await area.fill(commented);
  await page.waitForTimeout(700);
  await settled(page);
  expect('applied', (await area.inputValue()).startsWith('# a remark') && (await page.locator('.text-error').isHidden()));
  const [saved] = await Promise.all([
    page.waitForEvent('download'),
    page.getByText('File', {exact: true}).click().then(() => page.getByRole('button', {name: 'Save as'}).click()),
  ]);
  expect('saved as', readFileSync(await saved.path(), 'utf8').startsWith('# a remark'), saved.suggestedFilename());
  const [shared] = await Promise.all([
    page.waitForEvent('download'),
    page.getByRole('button', {name: 'Share as one page'}).click(),
  ]);
  expect('shared', readFileSync(await shared.path(), 'utf8').startsWith('<!DOCTYPE html>'), shared.suggestedFilename());
  await page.keyboard.press('Escape');
  await page.keyboard.press('Control+s');
  await settled(page);
  expect('written', readFileSync(file, 'utf8').startsWith('# a remark'));
  expect('saved', !(await page.title()).startsWith('•'), await page.title());
  // Edits on disk: shown at once, unless there are changes here.
  writeFileSync(file, `# from outside\n${original}`);
  await page.waitForTimeout(2300);
  expect('the file is followed', (await area.inputValue()).startsWith('# from outside'));
  expect('as a note', (await page.locator('.status').textContent()).includes('changed on disk'));
  await area.fill(`# mine\n${await area.inputValue()}`);
  await page.waitForTimeout(700);
  writeFileSync(file, `# again\n${original}`);
  await page.waitForTimeout(2300);
  expect('asked', await page.getByRole('button', {name: 'Keep what is here'}).isVisible());
  await page.screenshot({path: `${shots}/${scene}-changed.png`});
  await page.getByRole('button', {name: 'Keep what is here'}).click();
  expect('kept', (await area.inputValue()).startsWith('# mine'));
  await page.getByRole('button', {name: 'Save', exact: true}).click();
  await page.waitForTimeout(300);
  expect('not overwritten', await page.getByRole('button', {name: 'Save all the same'}).isVisible());
  await page.getByRole('button', {name: 'Show the file instead'}).click();
  await settled(page);
  expect('the file', (await area.inputValue()).startsWith('# again'));
  writeFileSync(file, original);
  await page.waitForTimeout(2300);
  await page.context().close();
}

async function checkSwitchesAndOthers() {
  const page = await open();
  await page.getByRole('tab', {name: 'Switches'}).click();
  await page.screenshot({path: `${shots}/${scene}-switches.png`});
  const one = page.getByRole('switch').first();
  if ((await one.count()) > 0) {
    await one.click();
    await settled(page);
    const off = !(await page.getByRole('switch').first().isChecked());
    const refused = await page.locator('.switches .number-error:visible').allTextContents();
    console.log(`${scene}: switched off: ${off} ${refused.join()} "${await page.locator('.status').textContent()}"`);
    await page.screenshot({path: `${shots}/${scene}-switched.png`});
    if (off) {
      await page.getByRole('switch').first().click();
      await settled(page);
      expect('on again', await page.getByRole('switch').first().isChecked());
    }
  }
  await page.getByRole('tab', {name: 'Equilibria'}).click();
  await page.waitForFunction(() => document.querySelector('.statement').textContent !== 'Being looked for …', null, {
    timeout: 15000,
  });
  await page.waitForTimeout(200);
  await page.screenshot({path: `${shots}/${scene}-others.png`});
  const go = page.getByRole('button', {name: 'Go there'}).first();
  const statement = await page.locator('.statement').textContent();
  const cards = await page.locator('.others .card').count();
  console.log(`${scene}: ${cards} cards, "${statement}"`);
  if ((await go.count()) > 0) {
    await go.click();
    await settled(page);
    expect('taken there', (await page.locator('.status').textContent()).length > 0);
    await page.waitForTimeout(3000);
    await page.screenshot({path: `${shots}/${scene}-went.png`});
  }
  await page.getByRole('tab', {name: 'Forces'}).click();
  await page.waitForTimeout(150);
  await page.screenshot({path: `${shots}/${scene}-forces.png`});
  await ask(page, {do: 'reload'});
  await page.context().close();
}

// The toggle clamp opens at P = 37.09 N.
async function checkSnap() {
  for (const reducedMotion of ['no-preference', 'reduce']) {
    const page = await open({reducedMotion});
    const steps = await undoSteps(page);
    await page.evaluate(() => {
      window.captions = [];
      new MutationObserver(() => window.captions.push(document.querySelector('.live-verdict').textContent)).observe(
        document.querySelector('.live-verdict'),
        {subtree: true, childList: true}
      );
    });
    const slider = page.locator('[data-number="load.P"] input[type="range"]');
    const box = await slider.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.mouse.down();
    const begin = Date.now();
    for (let k = 0; k <= 40; ++k) {
      await page.mouse.move(box.x + box.width * (0.5 + 0.012 * k), box.y + box.height / 2);
      await page.waitForTimeout(20);
      const moving = await page.locator('.stage.moving').count();
      if (moving) {
        await page.waitForTimeout(250);
        await page.screenshot({path: `${shots}/${scene}-snap-${reducedMotion}.png`});
        break;
      }
    }
    await page.mouse.move(box.x + box.width * 0.98, box.y + box.height / 2);
    await page.waitForTimeout(900);
    await page.mouse.up();
    await settled(page);
    const captions = await page.evaluate(() => window.captions);
    const played = captions.filter((text) => text.includes('moving:')).length;
    const status = await page.locator('.status').textContent();
    console.log(`${scene}: snap (${reducedMotion}): ${played} captions, "${status}", ${Date.now() - begin} ms`);
    expect('the snap is played', reducedMotion === 'reduce' ? played === 0 : played > 0);
    if (reducedMotion === 'reduce') expect('a note instead', status.includes('less motion'), status);
    const times = await page.evaluate(() => window.poiseTimes);
    const total = middleOf(times.map((time) => time.total));
    console.log(`${scene}: slider: ${times.length} pictures, median ${total.toFixed(1)} ms`);
    await page.screenshot({path: `${shots}/${scene}-snapped-${reducedMotion}.png`});
    await page.getByRole('button', {name: 'Undo'}).click();
    await settled(page);
    expect('the gesture is one step', (await undoSteps(page)) === steps);
    await ask(page, {do: 'reload'});
    await page.context().close();
  }
}

async function checkAccess() {
  const page = await open();
  await page.addScriptTag({content: readFileSync(need.resolve('axe-core/axe.min.js'), 'utf8')}).catch(() => {});
  for (const name of ['Numbers', 'Switches', 'Forces', 'Equilibria', 'Text']) {
    await page.getByRole('tab', {name}).click();
    await page.waitForTimeout(200);
    const found = await page.evaluate(async () => {
      const {violations} = await axe.run();
      return violations.map((one) => `${one.id}: ${one.nodes.length}: ${one.nodes[0].html.slice(0, 140)}`);
    });
    expect(`axe: ${name}`, found.length === 0, found.join('\n  '));
  }
  await page.context().close();
}

async function takeShots() {
  for (const width of [1280, 400]) {
    for (const colorScheme of ['light', 'dark']) {
      const page = await open({width, colorScheme});
      await page.waitForTimeout(1300);
      const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
      expect(`${width} px: no scrolling sideways`, over <= 0, over);
      await page.screenshot({path: `${shots}/${scene}-${width}-${colorScheme}.png`});
      if (width === 400) {
        await page.touchscreen.tap(...(await middle(page.locator('.handle-point').first())));
        await page.evaluate(() => scrollTo(0, 500));
        await page.waitForTimeout(200);
        await page.screenshot({path: `${shots}/${scene}-${width}-${colorScheme}-below.png`});
      }
      await page.context().close();
    }
  }
}

// A finger, at the width of a telephone.
async function checkTouch() {
  const page = await open({width: 400});
  const point = handle(page, 'point');
  await point.scrollIntoViewIfNeeded();
  const [x, y] = await middle(point);
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) => session.send('Input.dispatchTouchEvent', {type, touchPoints: points});
  const scrolled = await page.evaluate(() => scrollY);
  await touch('touchStart', [{x, y}]);
  for (let k = 1; k <= 20; ++k) {
    await touch('touchMove', [{x: x + k, y: y - 2 * k}]);
    await page.waitForTimeout(16);
  }
  expect('a finger holds a point', (await page.locator('.hand').textContent()).startsWith('held at'));
  expect('the page stays', (await page.evaluate(() => scrollY)) === scrolled);
  await page.screenshot({path: `${shots}/${scene}-touch.png`});
  await touch('touchEnd', []);
  await settled(page);
  expect('it lets go', (await page.locator('.hand').textContent()) === '');
  await page.context().close();
}

// PROGRAM is the process of the program, which this ends.
async function checkGone() {
  const page = await open();
  page.silent = false;
  await page.getByRole('tab', {name: 'Text'}).click();
  process.kill(Number(process.env.PROGRAM), 'SIGINT');
  await page.getByText('The program has ended').waitFor({timeout: 9000});
  await page.screenshot({path: `${shots}/${scene}-gone.png`});
  expect('no handles', (await page.locator('.handle:visible').count()) === 0);
  const [saved] = await Promise.all([page.waitForEvent('download'), page.getByText('Save the text as').click()]);
  expect('the text is saved', readFileSync(await saved.path(), 'utf8').includes('[ground]'));
  await page.context().close();
}

const checks = [
  checkDrag,
  checkSorting,
  checkKeys,
  checkNumbers,
  checkText,
  checkSwitchesAndOthers,
  checkAccess,
  checkTouch,
  takeShots,
];
if (process.env.PROGRAM) checks.push(checkGone);
if (scene.includes('toggle_clamp')) checks.unshift(checkSnap);
await expectations.run(checks);
await browser.close();
writeFileSync(file, original);
expectations.conclude();
