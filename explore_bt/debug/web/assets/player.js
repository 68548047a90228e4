// Which moment is shown: sought, played, or followed while the run goes on.

import { RunState } from "./run_state.js";

const AHEAD_S = 2;

/** Holds the state shown; `onChange()` after each change of it. */
export class Player {
  time = 0;
  begin = 0;
  end = 0;
  rate = 1;
  playing = false;
  following = false;
  live = false;

  #link;
  #names;
  #onChange;
  #sought = null;
  #busy = false;
  #buffer = [];
  #fetched = 0;
  #fetching = false;
  #generation = 0;
  #last = 0;

  constructor(link, names, onChange) {
    this.#link = link;
    this.#names = names;
    this.#onChange = onChange;
    this.state = new RunState(names);
  }

  /** The run reaches further now, or the debugger's state is another. */
  extend(end) {
    this.end = end;
    this.#catchUp();
    this.#onChange();
  }

  /** Shows a moment; of several asked for in a row, the last. */
  seek(time) {
    this.following = false;
    return this.#seek(time);
  }

  /** Back to now. */
  toNow() {
    this.playing = false;
    if (!this.live) return this.#seek(this.end);
    this.following = true;
    return this.#seek(this.end);
  }

  play(on) {
    this.playing = on && !this.following;
    if (this.playing && this.time >= this.end && !this.live) this.#seek(this.begin);
    this.#last = performance.now();
    if (this.playing) requestAnimationFrame((now) => this.#frame(now));
    this.#onChange();
  }

  #seek(time) {
    this.#sought = Math.min(Math.max(time, this.begin), this.end);
    return this.#catchUp();
  }

  /** One question at a time: what was sought last, then, if now is followed, what came since. */
  async #catchUp() {
    if (this.#busy) return;
    this.#busy = true;
    try {
      while (this.#sought !== null || (this.following && this.time < this.end)) {
        const at_s = this.#sought;
        this.#sought = null;
        const answer = await (at_s === null
          ? this.#link.ask("follow", { after_s: this.time, until_s: this.end })
          : this.#link.ask("state", { at_s }));
        if (at_s !== null || (this.following && this.#sought === null)) this.#show(answer);
      }
    } catch { /* the link says so itself */ } finally { this.#busy = false; }
  }

  #show(answer) {
    if (answer.fresh) this.state = new RunState(this.#names);
    for (const message of answer.messages) this.state.take(message);
    this.time = answer.at_s;
    this.#forgetBuffer();
    this.#onChange();
  }

  #forgetBuffer() {
    this.#generation += 1;
    this.#buffer = [];
    this.#fetched = this.time;
  }

  #frame(now) {
    if (!this.playing) return;
    const wanted = this.time + (now - this.#last) / 1000 * this.rate;
    this.#last = now;
    if (!this.#busy) {
      this.#fetch();
      this.#advance(Math.min(wanted, this.#fetched, this.end));
    }
    requestAnimationFrame((next) => this.#frame(next));
  }

  #advance(time) {
    let count = 0;
    while (count < this.#buffer.length && this.#buffer[count][1] <= time) this.state.take(this.#buffer[count++]);
    this.#buffer.splice(0, count);
    const moved = time !== this.time;
    this.time = time;
    if (time >= this.end) { this.playing = false; if (this.live) this.following = true; }
    if (moved || !this.playing) this.#onChange();
  }

  async #fetch() {
    if (this.#fetching || this.#fetched >= this.end || this.#fetched - this.time > AHEAD_S * this.rate / 2) return;
    this.#fetching = true;
    const generation = this.#generation, until_s = Math.min(this.#fetched + Math.min(AHEAD_S * this.rate, 20), this.end);
    try {
      const answer = await this.#link.ask("follow", { after_s: this.#fetched, until_s });
      if (generation === this.#generation) {
        this.#buffer.push(...answer.messages);
        this.#fetched = answer.at_s;
      }
    } catch { this.playing = false; } finally { this.#fetching = false; }
  }
}
