/**
 * Simulated time for programs: clock, estimate of the simulation's speed, interval timers, sleepUntil. For node and browsers.
 *
 *     const timer = robot.clock.timer(0.1);
 *     for (;;) {
 *       await timer.wait();                      // every 100 ms of simulated time, however fast the run is
 *     }
 *
 * A twin of clients/python/sandlot_client/clock.py, which explains how: the same names, the same arithmetic in the same order.
 */

const windowsUsual = [5, 10, 20, 50];
const horizons = [1, 2, 4, 8, 16, 32, 64];
const keep = 1 / 256;  // weight of the latest error of a prediction, so that the last 256 or so count
const spansKept = 8;
const delaysKept = 32;
const judgedPerMessage = 8;
const leastPeriod_s = 1e-6;
const leastWall_s = 1e-9;
const shortestNap_s = 0.0005;
const longestNap_s = 0.02;

/** Number of the longest horizon that is not above so many steps. */
function classOf(steps) {
  let h = 0;
  while (h + 1 < horizons.length && horizons[h + 1] <= steps) ++h;
  return h;
}

/** Clock of simulated time, fed with step times. */
export class Clock {
  #stamp_s = 0;
  #step_s = 0;
  #steps = 1;  // of the latest message
  #spans = [];
  #server_s = 0;
  #delays = [];
  #anchor_s = 0;
  #shown_s = -Infinity;
  // Sums of simulated time, wall time and speed over the intervals known, oldest first.
  #simSums = [0];
  #wallSums = [0];
  #speedSums = [0];
  messages = 0;
  rewinds = 0;

  /** @param wall  the wall clock [s] that arrivals are measured with. @param wait  promise of a pause; may end early
   *  @param windows  numbers of steps to average over, of which the best is used */
  constructor({ wall = () => performance.now() / 1000, wait = (s) => new Promise((done) => setTimeout(done, 1000 * s)), windows = windowsUsual } = {}) {
    this.wall = wall;
    this.wait = wait;
    this.windows = [...windows];
    this.history = Math.max(...this.windows) + horizons.at(-1) + 1;
    this.errors = horizons.map(() => Array(2 * this.windows.length).fill(0));
    this.best = horizons.map(() => 0);
  }

  /** Takes a message of step times. @param arrival_s  when it came, by the wall clock; left out: now */
  take(stamp_s, step_s, wall_s_list, arrival_s, restarted = false) {
    arrival_s ??= this.wall();
    const steps = wall_s_list.length + (restarted ? 1 : 0);
    const span_s = steps * step_s;
    let follows = this.messages > 0 && !restarted;
    if (this.messages > 0 && stamp_s < this.#stamp_s) {
      ++this.rewinds;
      this.#shown_s = -Infinity;
      follows = false;
    } else if (Math.abs(stamp_s - this.#stamp_s - span_s) > 0.5 * step_s) {
      follows = false;  // messages were lost
    }
    const count = wall_s_list.length, stride = Math.floor(count / judgedPerMessage) + 1;
    for (let i = Math.max(0, count - this.history); i < count; ++i) {
      this.#add(step_s, Math.max(wall_s_list[i], leastWall_s));
      if ((count - 1 - i) % stride === 0) this.#judge(classOf(steps));
    }
    for (const wall_s of wall_s_list) this.#server_s += wall_s;
    if (!follows) {
      this.#server_s = 0;
      this.#delays = [];
    }
    this.#delays = [...this.#delays.slice(-(delaysKept - 1)), arrival_s - this.#server_s];
    this.#spans = [...this.#spans.slice(-(spansKept - 1)), span_s];
    this.#anchor_s = this.#server_s + Math.min(...this.#delays);
    this.#stamp_s = stamp_s;
    this.#step_s = step_s;
    this.#steps = Math.max(steps, 1);
    ++this.messages;
  }

  #add(step_s, wall_s) {
    this.#simSums.push(this.#simSums.at(-1) + step_s);
    this.#wallSums.push(this.#wallSums.at(-1) + wall_s);
    this.#speedSums.push(this.#speedSums.at(-1) + step_s / wall_s);
    if (this.#simSums.length <= 4 * this.history) return;
    for (const sums of [this.#simSums, this.#wallSums, this.#speedSums]) sums.splice(0, sums.length - this.history);
  }

  /** Compares what each estimate predicted for the latest steps with what they took. @param ofMessage  horizon of the steps between two
   *  messages: what lasts no longer is planned no more, and a clock that is ahead waits there as long as one that is behind lags */
  #judge(ofMessage) {
    const last = this.#simSums.length - 1;
    for (let h = 0; h < horizons.length; ++h) {
      const then = last - horizons[h];
      if (then < 1) break;
      const sim_s = this.#simSums[last] - this.#simSums[then], took_s = this.#wallSums[last] - this.#wallSums[then];
      let best = 0;
      const errors = this.errors[h];
      for (let i = 0; i < errors.length; ++i) {
        const ratio = sim_s / this.#estimate(i, then) / took_s;
        const error = h > ofMessage || ratio < 1 ? Math.abs(ratio - 1) : 1 - 1 / ratio;
        errors[i] += keep * (error - errors[i]);
        if (errors[i] < errors[best]) best = i;
      }
      this.best[h] = best;
    }
  }

  /** Speed by the intervals up to `last`, as many as the window holds or as there are. Even numbers: simulated time over wall time; odd
   *  ones: mean of the speeds of the steps. */
  #estimate(number, last) {
    const first = Math.max(0, last - this.windows[Math.floor(number / 2)]);
    if (number % 2 === 1) return (this.#speedSums[last] - this.#speedSums[first]) / (last - first);
    return (this.#simSums[last] - this.#simSums[first]) / (this.#wallSums[last] - this.#wallSums[first]);
  }

  /** Simulated seconds per second of the wall clock, as they will be over the next interval of simulated time. */
  speed(interval_s = 0) {
    const last = this.#simSums.length - 1;
    if (last === 0) return 1;
    const steps = Math.max(this.#steps, this.#step_s > 0 ? interval_s / this.#step_s : 0);
    return this.#estimate(this.best[classOf(steps)], last);
  }

  /** Simulated time now; 0 before the first message. */
  nowS() {
    if (this.messages === 0) return 0;
    const passed_s = (this.wall() - this.#anchor_s) * this.speed();
    const now_s = this.#stamp_s + Math.min(Math.max(passed_s, 0), Math.max(...this.#spans));
    this.#shown_s = Math.max(this.#shown_s, now_s);
    return this.#shown_s;
  }

  /** Wall time until a simulated time is reached, as far as can be foreseen now; 0: it is there. */
  wallSUntil(time_s) {
    if (time_s <= this.nowS()) return 0;
    const ahead_s = time_s - this.#stamp_s;
    return Math.max(0, this.#anchor_s + ahead_s / this.speed(ahead_s) - this.wall());
  }

  /** Waits until a simulated time is reached. @return false: it was not reached within the timeout, of wall time; or the run was rewound */
  async sleepUntil(time_s, timeout_s) {
    const begin_s = this.wall(), rewinds = this.rewinds;
    while (this.nowS() < time_s - 1e-9 && this.rewinds === rewinds) {
      let left_s = Math.min(Math.max(this.wallSUntil(time_s), shortestNap_s), longestNap_s);
      if (timeout_s !== undefined) {
        const still_s = begin_s + timeout_s - this.wall();
        if (still_s <= 0) return false;
        left_s = Math.min(left_s, still_s);
      }
      await this.wait(left_s);
    }
    return this.rewinds === rewinds;
  }

  /** A timer that fires every so many simulated seconds, from now on. */
  timer(period_s) { return new IntervalTimer(this, period_s); }
}

/** Timer of simulated time, at begin + k * period. After a rewind it begins again there. */
export class IntervalTimer {
  #clock;
  #rewinds;
  #begun;
  #begin_s;
  #count;

  constructor(clock, period_s) {
    if (!(period_s >= leastPeriod_s && period_s < Infinity)) throw new RangeError(`a period is a number of seconds, at least a millionth, not ${period_s}`);
    this.#clock = clock;
    this.period_s = period_s;
    this.#restart();
  }

  #restart() {
    this.#rewinds = this.#clock.rewinds;
    this.#begun = this.#clock.messages > 0;
    this.#begin_s = this.#clock.nowS();
    this.#count = 1;
  }

  /** Simulated time of the next firing. */
  get nextS() { return this.#begin_s + this.#count * this.period_s; }

  /** Wall time until the next firing, as planned now. */
  wallSLeft() { return this.#clock.wallSUntil(this.nextS); }

  /** How many periods have ended since the call before; does not wait. */
  poll() {
    if (this.#rewinds !== this.#clock.rewinds || (!this.#begun && this.#clock.messages > 0)) this.#restart();
    const now_s = this.#clock.nowS() + 1e-9;
    if (now_s < this.nextS) return 0;
    const ended = Math.max(Math.trunc((now_s - this.#begin_s) / this.period_s) - this.#count + 1, 1);
    this.#count += ended;
    return ended;
  }

  /** Waits for the next firing. @return 0: it did not come within the timeout; above 1: so many have passed meanwhile */
  async wait(timeout_s) {
    const begin_s = this.#clock.wall();
    for (;;) {
      const ended = this.poll();
      if (ended > 0) return ended;
      const still_s = timeout_s === undefined ? undefined : begin_s + timeout_s - this.#clock.wall();
      if (still_s !== undefined && still_s <= 0) return 0;
      await this.#clock.sleepUntil(this.nextS, still_s);
    }
  }
}
