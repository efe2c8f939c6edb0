// What the drivers of pages share: a browser without traffic of its own, and the count of what does not work.

import {createRequire} from 'node:module';
import {resolve} from 'node:path';

const flags = [
  '--no-sandbox',
  '--disable-gpu',
  '--disable-quic',
  '--no-first-run',
  '--disable-background-networking',
  '--disable-component-update',
  '--disable-sync',
];

/// What asks for packages in the folder MODULES, in which `npm i` was run.
export function packagesIn(modules) {
  return createRequire(resolve(modules, 'package.json'));
}

/// A Chromium. `need`: of packagesIn().
export function startBrowser(need, program = '/usr/bin/chromium') {
  return need('playwright-core').chromium.launch({executablePath: program, args: flags});
}

/// Says what does not work; `subject` is put before it.
export class Expectations {
  constructor(subject = '') {
    this.prefix = subject ? `${subject}: ` : '';
    this.failed = 0;
    this.expect = this.expect.bind(this);
  }

  expect(what, holds, found = '') {
    if (holds) return;
    ++this.failed;
    console.log(`FAILED: ${this.prefix}${what} ${found}`);
  }

  /// Runs checks, of which ONLY=NAME,NAME in the environment chooses some.
  async run(checks) {
    const wanted = process.env.ONLY?.split(',');
    for (const check of checks) {
      if (wanted && !wanted.includes(check.name)) continue;
      await check().catch((error) => this.expect(check.name, false, error.message));
    }
  }

  /// The last word, and the exit code.
  conclude() {
    console.log(`${this.prefix}${this.failed === 0 ? 'all passed' : `${this.failed} failed`}`);
    process.exitCode = this.failed === 0 ? 0 : 1;
  }
}
