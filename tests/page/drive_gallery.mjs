// Presses play in every report of the gallery and says in which of them nothing moves:
//   python3 docs/site/gallery.py BUILD PAGES && node tests/page/drive_gallery.mjs PAGES/gallery MODULES [CHROMIUM]
// MODULES: a folder in which `npm i playwright-core` was run. Of the reports of one page one has to move.

import {readdirSync} from 'node:fs';
import {dirname, resolve} from 'node:path';

import {Expectations, packagesIn, startBrowser} from './browser.mjs';

const [gallery, modules, program] = process.argv.slice(2);
const browser = await startBrowser(packagesIn(modules), program);
const expectations = new Expectations('gallery');
const {expect} = expectations;
const page = await browser.newPage({viewport: {width: 1280, height: 900}});
let place = '';
page.on('pageerror', (error) => expect(`${place}: no errors`, false, error.stack));
page.on('console', (message) => expect(`${place}: nothing is written to the console`, false, message.text()));

// What is seen of the mechanism: its shapes, without texts.
const shapes = (box) =>
  box
    .locator('svg.picture')
    .first()
    .evaluate((svg) => [...svg.querySelectorAll('line, polyline, polygon, circle, path')].map((node) => node.outerHTML).join());

/// Whether the shapes change while the first player of the page plays; false without one.
async function plays() {
  const cards = page.getByRole('button', {name: 'One after the other'});
  const play = page.getByRole('button', {name: 'Play', exact: true});
  if ((await play.count()) === 0 && (await cards.count()) === 0) return false;
  if ((await play.count()) === 0) {
    await cards.first().click();
    await page.keyboard.press('Home');
    const before = await shapes(page.locator('dialog'));
    await page.keyboard.press(' ');
    return changes(page.locator('dialog'), before);
  }
  const box = page.locator('.played:has(.player)').first();
  await box.getByRole('button', {name: 'First frame'}).click();
  const before = await shapes(box);
  await box.getByRole('button', {name: 'Play', exact: true}).click();
  return changes(box, before);
}

async function changes(box, before) {
  for (let wait = 0; wait < 60; ++wait) {
    await page.waitForTimeout(50);
    if ((await shapes(box)) !== before) return true;
  }
  return false;
}

const moving = new Map();
for (const file of readdirSync(gallery, {recursive: true}).filter((name) => /report\d*\.html$/.test(name))) {
  place = file;
  await page.goto(`file://${resolve(gallery, file)}`);
  const moves = await plays().catch((error) => {
    expect(`${place}: plays`, false, error.message);
    return false;
  });
  moving.set(dirname(file), (moving.get(dirname(file)) ?? false) || moves);
}
for (const [folder, moves] of moving) expect(`${folder}: something moves`, moves);
console.log(`${moving.size} folders of reports`);
await browser.close();
expectations.conclude();
