// Frames between messages: in slow motion, and wherever a step takes longer than a frame of the screen, bodies glide from what
// one message told to what the next one tells, instead of jumping.
//
// What glides is what messages tell (the first link's pose, and joints), so that wheels stay on their axles. What is shown
// lags by one message: when one arrives, the bodies are on their way to it for as long as messages take to come. A run that
// stands still is shown as it is, at once.
import { Motion, type PoseSlot } from '../binary';

/** Messages that come faster are shown as they come: the screen hardly shows more. */
const FAST_MS = 40;
/** Nothing glides for longer. */
const SLOW_MS = 4000;
/** A body that would have to move faster was put there. */
const MOST_MPS = 50;
/** How fast the mean of intervals follows. */
const GAIN = 0.3;

/** a to b by the shorter way round, at share f. */
export function mixAngle(a: number, b: number, f: number): number {
  const turn = b - a;
  return a + f * Math.atan2(Math.sin(turn), Math.cos(turn));
}

/** Orientations at a[i ...], b[i ...] (w x y z) by the shorter way, at a constant rate, into out[i ...]. */
export function mixTurn(a: Float64Array, b: Float64Array, i: number, f: number, out: Float64Array): void {
  let dot = a[i] * b[i] + a[i + 1] * b[i + 1] + a[i + 2] * b[i + 2] + a[i + 3] * b[i + 3];
  const sign = dot < 0 ? -1 : 1;
  dot *= sign;
  let from = 1 - f, to = f;
  if (dot < 0.9995) {
    const angle = Math.acos(dot), s = Math.sin(angle);
    from = Math.sin((1 - f) * angle) / s;
    to = Math.sin(f * angle) / s;
  }
  to *= sign;
  let length = 0;
  for (let c = i; c < i + 4; ++c) {
    out[c] = from * a[c] + to * b[c];
    length += out[c] * out[c];
  }
  length = Math.sqrt(length) || 1;
  for (let c = i; c < i + 4; ++c) out[c] /= length;
}

/** What a message would tell at share f of the way from `a` to `b`; both are of one form. */
export function mixRecords(motions: Uint8Array, form: number, a: Float64Array, b: Float64Array, f: number, out: Float64Array): void {
  for (let link = 0; link < motions.length; ++link) {
    const at = 7 * link;
    const motion = link === 0 || form === 1 ? Motion.Free : motions[link];
    switch (motion) {
      case Motion.Free:
        for (let c = at; c < at + 3; ++c) out[c] = a[c] + f * (b[c] - a[c]);
        mixTurn(a, b, at + 3, f, out);
        break;
      case Motion.Angle:
        out[at] = mixAngle(a[at], b[at], f);
        break;
      case Motion.Slide:
      case Motion.Screw:
        out[at] = a[at] + f * (b[at] - a[at]);
        break;
      case Motion.Turn:
        mixTurn(a, b, at + 3, f, out);
        break;
    }
  }
}

function same(a: Float64Array, b: Float64Array): boolean {
  for (let i = 0; i < a.length; ++i) if (a[i] !== b[i]) return false;
  return true;
}

/** The way of one body between two records. */
export class Way {
  readonly shown: PoseSlot;
  private readonly from: Float64Array;
  private readonly to: Float64Array;
  private from_s = 0;
  private to_s = NaN;
  /** Simulated time of what is shown. */
  shown_s = NaN;
  active = false;

  constructor(readonly motions: Uint8Array, size: number) {
    this.shown = { motions, values: new Float64Array(size), form: -1 };
    this.from = new Float64Array(size);
    this.to = new Float64Array(size);
  }

  /** A record has come: false when it is shown at once, because it is the first, or too far from what is shown. */
  take(record: PoseSlot, time_s: number, glides: boolean): boolean {
    const before = this.shown.values, now = record.values;
    const passed_s = time_s - (Number.isNaN(this.to_s) ? time_s : this.to_s);
    const way_m = Math.hypot(now[0] - before[0], now[1] - before[1], now[2] - before[2]);
    // What is shown is up to one interval older than the record before.
    const near = way_m <= MOST_MPS * 2 * passed_s;
    this.active = glides && this.shown.form === record.form && passed_s > 0 && near && !same(before, now);
    this.to_s = time_s;
    if (!this.active) {
      this.shown.values.set(now);
      this.shown.form = record.form;
      this.shown_s = time_s;
      return false;
    }
    this.from.set(before);
    this.to.set(now);
    this.from_s = this.shown_s;
    return true;
  }

  /** From what is shown now: a message has come, and shares count from it. */
  restart(): void {
    if (!this.active) return;
    this.from.set(this.shown.values);
    this.from_s = this.shown_s;
  }

  /** The body is elsewhere than messages said: the next one is shown at once. */
  forget(): void {
    this.active = false;
    this.shown.form = -1;
  }

  /** Moves what is shown to a share of the way. */
  advance(f: number): void {
    if (!this.active) return;
    mixRecords(this.motions, this.shown.form, this.from, this.to, f, this.shown.values);
    this.shown_s = this.from_s + f * (this.to_s - this.from_s);
    if (f >= 1) this.active = false;
  }
}

/** The clock of all ways: how long messages take to come, and what share of the way has passed. */
export class Between {
  /** The run plays; else everything is shown at once. */
  private playing = false;
  /** Wall time of a step. Messages that come much later follow a rest in which nothing moved. */
  private step_ms = SLOW_MS;
  private message_ms = NaN;
  private interval_ms = NaN;

  /** @param step_ms  wall time that a step takes at the present speed */
  pace(playing: boolean, step_ms: number): void {
    this.playing = playing;
    this.step_ms = step_ms;
  }

  /** A message has come. @returns whether bodies glide to it */
  message(now_ms: number): boolean {
    const passed_ms = now_ms - this.message_ms;
    this.message_ms = this.playing ? now_ms : NaN;
    if (!this.playing || !(passed_ms < Math.min(SLOW_MS, 3 * Math.max(FAST_MS, this.step_ms)))) {
      this.interval_ms = NaN;
      return false;
    }
    // Another speed is another interval, at once: a mean would take several messages.
    const other = !(passed_ms < 2 * this.interval_ms && passed_ms > 0.5 * this.interval_ms);
    this.interval_ms = other ? passed_ms : this.interval_ms + GAIN * (passed_ms - this.interval_ms);
    return this.interval_ms > FAST_MS;
  }

  share(now_ms: number): number {
    return this.playing && this.interval_ms > 0 ? Math.min(1, Math.max(0, (now_ms - this.message_ms) / this.interval_ms)) : 1;
  }
}
