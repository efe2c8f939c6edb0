// Requests to the program that serves a live view: one at a time and in order. Of the wishes of one gesture only the
// newest waits, so that a slow answer never leaves the picture behind the pointer.

// So many ms lie between two requests at least: a mouse may report more often than a screen shows.
const least_pause = 4;
const poll_pause = 1000;
const longest_silence = 3000;

// fetch() would hand over the head of an answer first and its body some ms later, which a dragged point would lag.
function posted(address, body) {
  return new Promise((done, fail) => {
    const request = new XMLHttpRequest();
    request.open('POST', address);
    request.setRequestHeader('Content-Type', 'application/json');
    request.addEventListener('load', () => done({status: request.status, text: request.responseText}));
    request.addEventListener('error', () => fail(new Error('no answer')));
    request.addEventListener('abort', () => fail(new Error('no answer')));
    request.send(body);
  });
}

/// Sends requests, and tells of what comes back: `told` has answer(answer, wish), poll(answer), gone(is_gone). Each carries
/// the revision of the state that the page shows, so that nothing changes what another window has changed meanwhile.
export class Program {
  constructor(revision, told) {
    this.revision = revision;
    Object.assign(this, {told, waiting: [], current: null, paused: false, gone: false});
    Object.assign(this, {sent: 0, timer: 0, silent_since: null, others_had: 0});
  }

  /// Whether a request is under way or waits.
  get busy() {
    return this.current !== null || this.waiting.length > 0;
  }

  /// Asks for something. `gesture`: a later wish of the same gesture takes its place while it waits. `time`: when the
  /// event happened that it comes from.
  ask(request, {gesture = '', time = null, note = ''} = {}) {
    if (this.gone) return;
    if (gesture && this.waiting.at(-1)?.gesture === gesture) this.waiting.pop();
    this.waiting.push({request, gesture, time, note});
    this.pump();
  }

  /// Holds requests back while what the last answer brought is played.
  pause() {
    this.paused = true;
  }

  resume() {
    this.paused = false;
    this.pump();
  }

  pump() {
    if (this.current || this.paused || this.gone || this.waiting.length === 0) return;
    clearTimeout(this.timer);
    const pause = this.sent + least_pause - performance.now();
    if (pause > 0) this.timer = setTimeout(() => this.pump(), pause);
    else this.send(this.waiting.shift());
  }

  async send(wish) {
    this.current = wish;
    this.sent = performance.now();
    const answer = await this.fetched({...wish.request, revision: this.revision});
    this.current = null;
    if (!answer.error) this.revision = answer.revision;
    this.told.answer(answer, wish);
    this.pump();
  }

  async fetched(request) {
    const failure = (text) => ({error: {text, of: request.do, line: null}});
    try {
      const {status, text} = await posted('do', JSON.stringify(request));
      if (status === 200) return JSON.parse(text);
      if (status === 413) return failure('The scene is too long for the program: 1 MB is the most.');
      return failure(`The program refused the request (${status}).`);
    } catch {
      // What waits was meant for a state that is not known any more.
      this.waiting = [];
      return failure('The program did not answer.');
    }
  }

  /// Asks for something that leaves the mechanism as it is, and returns the answer: at once, or after what was asked
  /// before.
  async aside(request, after = false) {
    while (after && this.busy) await new Promise((done) => setTimeout(done, least_pause));
    return this.fetched({...request, revision: this.revision});
  }

  /// The present state as one page, for others.
  async shared() {
    const response = await fetch('page');
    if (!response.ok) throw new Error(String(response.status));
    return response.text();
  }

  /// Asks once a second whether the program is there, and what it found meanwhile.
  async startPolling() {
    for (;;) {
      // The program answers one request after the other: while it computes, a poll would only wait.
      if (!this.current) await this.poll();
      await new Promise((done) => setTimeout(done, poll_pause));
    }
  }

  async poll() {
    const begin = performance.now();
    const control = new AbortController();
    const timer = setTimeout(() => control.abort(), longest_silence);
    try {
      const response = await fetch(`poll?revision=${this.others_had}`, {signal: control.signal});
      const answer = response.ok ? await response.json() : null;
      this.silent_since = null;
      this.setGone(false);
      if (answer) this.told.poll(answer);
    } catch {
      if (this.current) return;
      this.silent_since ??= begin;
      // A pause of this loop is no silence of the program.
      if (performance.now() - this.silent_since >= longest_silence - poll_pause / 10) this.setGone(true);
    } finally {
      clearTimeout(timer);
    }
  }

  setGone(is_gone) {
    if (is_gone === this.gone) return;
    this.gone = is_gone;
    if (is_gone) this.waiting = [];
    this.told.gone(is_gone);
  }
}
