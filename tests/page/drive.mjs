// Drives the pages of fixtures.py in Chromium and says what does not work:
//   python3 tests/page/fixtures.py PAGES && node tests/page/drive.mjs PAGES MODULES [CHROMIUM]
// MODULES: a folder in which `npm i playwright-core` was run. Screenshots and a print go to PAGES/shots.

import {mkdirSync, readFileSync} from 'node:fs';
import {createServer} from 'node:http';
import {basename, resolve} from 'node:path';

import {Expectations, packagesIn, startBrowser} from './browser.mjs';

const [pages, modules, program] = process.argv.slice(2);
const shots = resolve(pages, 'shots');
mkdirSync(shots, {recursive: true});
const browser = await startBrowser(packagesIn(modules), program);
const expectations = new Expectations();
const {expect} = expectations;

async function open(name, width = 1280, colorScheme = 'light') {
  const context = await browser.newContext({viewport: {width, height: 900}, colorScheme, hasTouch: width < 600});
  const page = await context.newPage();
  page.on('console', (message) => expect(`${name}: nothing is written to the console`, false, message.text()));
  page.on('pageerror', (error) => expect(`${name}: no errors`, false, error.stack));
  page.on('request', (request) =>
    expect(`${name}: no network`, /^(file|data|blob):/.test(request.url()), request.url())
  );
  await page.goto(`file://${resolve(pages, name)}.html`);
  await page.waitForTimeout(200);
  return page;
}

const texts = (page, selector) => page.$$eval(selector, (nodes) => nodes.map((node) => node.textContent));
const numberOf = (text) => Number(text.replace('−', '-'));

async function checkTables() {
  const page = await open('identify');
  const table = page.locator('.table', {hasText: 'Samples'});
  const column = async (i) => (await table.locator(`tbody tr > :nth-child(${i})`).allTextContents()).map(numberOf);
  expect('a long table is cut', (await column(1)).length === 25);
  const sort = table.getByRole('button', {name: 'residual (deg)'});
  await sort.focus();
  await page.keyboard.press('Enter');
  const up = await column(5);
  expect(
    'ascending',
    up.every((value, i) => i === 0 || value >= up[i - 1]),
    up.join()
  );
  expect('aria-sort', (await table.locator('th[aria-sort="ascending"]').count()) === 1);
  await page.keyboard.press('Enter');
  const down = await column(5);
  expect(
    'descending',
    down.every((value, i) => i === 0 || value <= down[i - 1]),
    down.join()
  );
  await page.keyboard.press('Enter');
  expect('the order of the document again', (await column(1))[1] === 2);
  await table.getByRole('button', {name: 'Show all 400 rows'}).click();
  expect('all rows', (await column(1)).length === 400);
  await table.getByRole('searchbox').fill('run 3');
  expect('filtered', (await column(1)).length === 57, (await column(1)).length);
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await table.getByRole('button', {name: 'Copy as CSV'}).click();
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  expect(
    'CSV',
    copied.startsWith('sample,run,time (s),') && copied.trim().split('\n').length === 58,
    copied.slice(0, 80)
  );
  await page.context().close();
}

async function checkPlayer() {
  const page = await open('path');
  const value = () => page.locator('.value').textContent();
  const frame = () => page.locator('.track input').inputValue();
  expect('the frame of rest', (await frame()) === '20');
  await page.locator('.stage').first().focus();
  for (const [key, result] of [
    ['ArrowRight', '21'],
    ['ArrowLeft', '20'],
    ['Home', '0'],
    ['End', '199'],
    ['PageUp', '189'],
  ]) {
    await page.keyboard.press(key);
    expect(`key ${key}`, (await frame()) === result, await frame());
  }
  expect('captions are read out', (await page.locator('#spoken').textContent()).includes('load.P'));
  await page.keyboard.press('Home');
  await page.keyboard.press(' ');
  await page.waitForTimeout(1500);
  const at = Number(await frame());
  expect('plays in time', at > 20 && at < 50, at);
  await page.keyboard.press(' ');
  await page.waitForTimeout(100);
  const stopped = await frame();
  await page.waitForTimeout(300);
  expect('pauses', (await frame()) === stopped);
  await page.getByRole('button', {name: 'fold at'}).first().click();
  expect('an event is shown', (await frame()) === '60');
  await page.getByRole('button', {name: 'One frame on'}).click();
  expect('snap in slow motion', (await page.locator('.snap-line').textContent()).includes('snaps to crank'));
  await page.locator('.track input').fill('155');
  expect('not confirmed in words', await page.getByText('not confirmed', {exact: true}).isVisible());
  expect('not confirmed as hatching', (await page.locator('.stage.unconfirmed').count()) === 1);
  await page.screenshot({path: `${shots}/unconfirmed.png`});
  const chart = page.locator('.chart').first().locator('.u-over');
  const box = await chart.boundingBox();
  const before = await value();
  await page.mouse.click(box.x + box.width * 0.97, box.y + box.height * 0.45);
  expect('a click in a chart moves the player', (await value()) !== before);
  expect('to the nearest frame', Math.abs(Number(await frame()) - 109) < 4, await frame());
  await page.getByText('Traces').click();
  await page.getByRole('searchbox', {name: 'Search points'}).fill('crank');
  await page.getByRole('checkbox', {name: 'crank.B'}).check();
  expect('two traces', (await page.locator('.picture > g:nth-of-type(2) > g').count()) === 2);
  await page.screenshot({path: `${shots}/traces.png`});
  await page.keyboard.press('Escape');
  await page.getByText('Layers').click();
  await page.getByRole('checkbox', {name: 'loads'}).uncheck();
  expect('a layer is hidden', (await page.locator('.picture > g:first-child > g[display="none"]').count()) === 3);
  await page.context().close();
}

async function checkZoom() {
  const page = await open('solve');
  const width = async () => Number((await page.locator('.picture').first().getAttribute('viewBox')).split(' ')[2]);
  const stage = await page.locator('.stage').first().boundingBox();
  const scrolled = () => page.evaluate(() => scrollY);
  await page.mouse.move(stage.x + 100, stage.y + 100);
  await page.mouse.wheel(0, 60);
  await page.waitForTimeout(150);
  expect('the wheel scrolls at first', (await width()) === 900 && (await scrolled()) > 0);
  await page.evaluate(() => scrollTo(0, 0));
  await page.locator('.stage').first().click();
  await page.mouse.wheel(0, -300);
  const near = await width();
  expect('the wheel zooms after a click', near < 600, near);
  const left = async () => Number((await page.locator('.picture').first().getAttribute('viewBox')).split(' ')[0]);
  const start = await left();
  await page.mouse.down();
  await page.mouse.move(stage.x + 40, stage.y + 60, {steps: 4});
  await page.mouse.up();
  expect('dragging pans', (await left()) > start, `${start} ${await left()}`);
  await page.screenshot({path: `${shots}/zoomed.png`});
  await page.getByRole('button', {name: 'Show the whole'}).click();
  expect('the whole again', (await width()) === 900);
  await page.locator('.stage').first().focus();
  await page.keyboard.press('+');
  expect('key +', (await width()) < 900);
  await page.keyboard.press('0');
  expect('key 0', (await width()) === 900);
  const crank = await page.evaluate(() => {
    const box = [...document.querySelectorAll('.picture line')]
      .find((line) => line.getAttribute('stroke-width') === '8.6')
      .getBoundingClientRect();
    return [box.x + box.width / 2, box.y + box.height / 2];
  });
  await page.mouse.move(...crank);
  expect(
    'names',
    (await page.locator('.stage .tip').textContent()) === 'crank',
    await page.locator('.stage .tip').textContent()
  );
  await page.context().close();
}

async function checkCharts() {
  const page = await open('identify');
  const chart = page.locator('.chart').first();
  const area = await chart.locator('.u-over').boundingBox();
  await page.mouse.move(area.x + area.width * 0.3, area.y + area.height * 0.62);
  await page.waitForTimeout(50);
  const tip = await chart.locator('.tip').textContent();
  expect('readout', /(measured|model)time [\d.]+ sangle 1 −?[\d.]+ deg/.test(tip), tip);
  await page.screenshot({path: `${shots}/readout.png`});
  await page.mouse.move(area.x + 300, area.y + 20);
  await page.mouse.down();
  await page.mouse.move(area.x + 600, area.y + 120, {steps: 5});
  await page.screenshot({path: `${shots}/dragging.png`});
  await page.mouse.up();
  expect(
    'zoomed',
    (await page.getByRole('button', {name: 'Show all', exact: true}).count()) === 8,
    await page.getByRole('button', {name: 'Show all', exact: true}).count()
  );
  await page.screenshot({path: `${shots}/charts-zoomed.png`});
  await page.mouse.dblclick(area.x + 300, area.y + 50);
  expect('double click shows all', (await page.getByRole('button', {name: 'Show all', exact: true}).count()) === 0);
  const entry = chart.getByRole('button', {name: 'measured'});
  await entry.click();
  expect('toggled', (await entry.getAttribute('aria-pressed')) === 'false');
  await chart.locator('.plot').focus();
  for (const key of ['ArrowRight', 'ArrowRight', 'PageDown']) await page.keyboard.press(key);
  const spoken = await page.locator('#spoken').textContent();
  expect('keys go along a curve', spoken.startsWith('model, time 0.084 s, angle 1 '), spoken);
  await page.screenshot({path: `${shots}/toggled.png`});
  await chart.locator('summary').click();
  await page.setViewportSize({width: 500, height: 900});
  await page.waitForTimeout(200);
  const sizes = await chart.evaluate((node) => [
    node.querySelector('canvas').clientWidth,
    node.querySelector('.plot').clientWidth,
  ]);
  expect('a chart follows the width', Math.abs(sizes[0] - sizes[1]) < 2 && sizes[0] < 500, sizes.join());
  await page.screenshot({path: `${shots}/narrowed.png`});
  expect('a table of the data', (await chart.locator('.chart-table tbody tr').count()) === 200);
  await page.context().close();
}

async function checkCards() {
  const page = await open('cards');
  const place = () => page.locator('dialog .value').textContent();
  await page.locator('.card').nth(7).focus();
  await page.keyboard.press('Enter');
  expect('enlarged', (await place()) === '8 of 12', await place());
  await page.waitForTimeout(100);
  await page.screenshot({path: `${shots}/enlarged.png`});
  await page.keyboard.press('ArrowRight');
  expect('the next one', (await place()) === '9 of 12', await place());
  await page.keyboard.press('Escape');
  expect('closed', !(await page.locator('dialog').isVisible()));
  expect('focus returns', (await page.evaluate(() => document.activeElement.className)) === 'card');
  await page.getByRole('button', {name: 'One after the other'}).click();
  expect('from the first one on', (await place()) === '1 of 12', await place());
  await page.waitForTimeout(2000);
  expect('one after the other', ['2 of 12', '3 of 12'].includes(await place()), await place());
  await page.keyboard.press('Escape');
  await page.context().close();
}

async function checkHeader() {
  const page = await open('solve', 1280, 'dark');
  const theme = () => page.evaluate(() => document.documentElement.dataset.theme);
  expect('dark as the system', (await theme()) === 'dark');
  await page.getByText('Light', {exact: true}).click();
  expect('light as chosen', (await theme()) === 'light');
  const [saved] = await Promise.all([page.waitForEvent('download'), page.getByText('Save the data').click()]);
  expect('saved', saved.suggestedFilename() === 'My-four-bar.json', saved.suggestedFilename());
  const data = readFileSync(await saved.path(), 'utf8');
  expect(
    'saved as written',
    data.includes('"seed": 18446744073709551615') && JSON.parse(data).title === 'My four-bar',
    data
  );
  await page.context().close();
  const broken = await open('broken');
  expect('a document that cannot be read', (await texts(broken, '#page')).join().includes('cannot be read'));
  await broken.context().close();
}

// What a live view does: another drawing with a pool of its own, of which little differs.
async function checkAnotherDrawing() {
  const folder = new URL('../../app/page/', import.meta.url);
  const server = createServer((request, response) => {
    const name = basename(request.url);
    const known = name.endsWith('.js');
    response.setHeader('Content-Type', known ? 'text/javascript' : 'text/html');
    response.end(known ? readFileSync(new URL(name, folder)) : '<!DOCTYPE html><body></body>');
  }).listen(0, '127.0.0.1');
  const page = await browser.newPage();
  await page.goto(`http://127.0.0.1:${server.address().port}/empty.html`);
  const {
    palette,
    figures: [{drawing}],
  } = JSON.parse(readFileSync(resolve(pages, 'large.json'), 'utf8'));
  const still = {...drawing, frames: [drawing.frames[0]]};
  const found = await page.evaluate(
    async ({first, colours}) => {
      const {Picture} = await import('/figure.js');
      const box = document.body.appendChild(document.createElement('div'));
      box.style.width = '450px';
      const picture = new Picture(box, colours);
      picture.show(first);
      const second = structuredClone(first);
      second.shapes.unshift(['circle', 0, 1, 1, 1]);
      second.frames = [second.frames[0].map((shape) => shape + 1)];
      second.shapes[5][2][0] += 3;
      let changes = 0;
      const observer = new MutationObserver((records) => {
        changes += records.length;
      });
      observer.observe(picture.shapes, {subtree: true, childList: true, attributes: true});
      const start = performance.now();
      picture.show(second);
      const took = performance.now() - start;
      await new Promise(requestAnimationFrame);
      const area = picture.svg.getBoundingClientRect();
      return {changes, took, place: picture.toPage(area.left + 225, area.top + 140), overlay: picture.overlay.tagName};
    },
    {first: still, colours: palette}
  );
  expect('only the shape that differs is touched', found.changes === 1, found.changes);
  expect('toPage', Math.abs(found.place.x - 450) < 1 && Math.abs(found.place.y - 280) < 1, JSON.stringify(found.place));
  expect('overlay', found.overlay === 'g');
  console.log(`another drawing of 300 shapes: ${found.took.toFixed(2)} ms`);
  await page.close();
  server.close();
}

async function checkSpeed() {
  const page = await open('large');
  const took = await page.evaluate(async () => {
    const slider = document.querySelector('.track input');
    const times = [];
    for (let k = 1; k < 60; ++k) {
      slider.value = k;
      const start = performance.now();
      slider.dispatchEvent(new Event('input'));
      times.push(performance.now() - start);
      await new Promise(requestAnimationFrame);
    }
    return times.sort((a, b) => a - b)[30];
  });
  console.log(`a frame of 300 changed shapes: ${took.toFixed(2)} ms`);
  await page.context().close();
}

async function printAll() {
  for (const name of ['solve', 'path', 'cards', 'identify']) {
    const page = await open(name, 1280, 'dark');
    await page.pdf({
      path: `${shots}/${name}.pdf`,
      format: 'A4',
      margin: {top: '12mm', bottom: '12mm', left: '12mm', right: '12mm'},
      printBackground: false,
    });
    expect(
      `${name}: screen colours again`,
      (await page.evaluate(() => document.documentElement.dataset.theme)) === 'dark'
    );
    expect(`${name}: cut again`, (await page.locator('.print-only canvas').count()) === 0);
    await page.context().close();
  }
}

async function takeShots() {
  for (const name of ['solve', 'path', 'cards', 'identify', 'hostile', 'edges', 'bare', 'not_confirmed', 'broken']) {
    for (const width of [1280, 400]) {
      for (const scheme of ['light', 'dark']) {
        const page = await open(name, width, scheme);
        const over = await page.evaluate(() => document.documentElement.scrollWidth - innerWidth);
        expect(`${name} at ${width} px does not scroll sideways`, over <= 0, over);
        await page.screenshot({path: `${shots}/${name}-${width}-${scheme}.png`, fullPage: true});
        await page.context().close();
      }
    }
  }
}

await expectations.run([
  checkTables,
  checkPlayer,
  checkZoom,
  checkCharts,
  checkCards,
  checkHeader,
  checkAnotherDrawing,
  checkSpeed,
  printAll,
  takeShots,
]);
await browser.close();
expectations.conclude();
