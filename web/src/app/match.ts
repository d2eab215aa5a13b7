// A match of robots as data: what a referee says and decides, read from messages with nothing taken for granted, and what the page works out
// itself: where the ball and the teams were, and who passed to whom.
import {secondsOf} from '../net/decoders';

export const stateType = 'sandlot_msgs/msg/RefereeState';
export const decisionType = 'sandlot_msgs/msg/RefereeDecision';
export const playerType = 'sandlot_msgs/msg/PlayerState';

export type Spot = readonly [number, number];

export interface TeamState {
  name: string;
  title: string;
  score: number;
  robots: number;
  yellow: number;
  red: number;
  possession_s: number;
}

export interface GameState {
  time_s: number;
  stage: string;
  phase: string;
  set_piece: string;
  team: string;
  in_play: boolean;
  clock_s: number;
  remaining_s: number;
  teams: TeamState[];
  last_touch: string;
}

export interface SeenPlayer {
  name: string;
  team: string;
  number: number;
  at: Spot;
  yaw: number;
}

export interface Decision {
  time_s: number;
  sequence: number;
  tick: number;
  stage: string;
  clock_s: number;
  rule: string;
  command: string;
  team: string;
  robot: string;
  reason: string;
  point: Spot;
  ball: Spot;
  score: number[];
  players: SeenPlayer[];
}

export interface PlayerReport {
  role: string;
  intention: string;
  ball_confidence: number;
  ball_engaged: boolean;
}

// --- reading. Numbers may be bigints (64 bits of CDR) or texts (64 bits of JSON); lists may be typed arrays.

type Bag = Record<string, unknown>;
const bag = (value: unknown): Bag => (typeof value === 'object' && value !== null ? (value as Bag) : {});
const text = (value: unknown): string => (typeof value === 'string' ? value : '');
const number = (value: unknown): number => {
  const n = typeof value === 'number' || typeof value === 'bigint' || (typeof value === 'string' && value !== '') ? Number(value) : Number.NaN;
  return Number.isFinite(n) ? n : 0;
};
const list = (value: unknown): unknown[] => (Array.isArray(value) ? value : ArrayBuffer.isView(value) ? Array.from(value as unknown as ArrayLike<unknown>) : []);
const spot = (value: unknown): Spot => [number(bag(value).x), number(bag(value).y)];
const stampOf = (message: Bag): number => {
  const time_s = secondsOf(bag(message.header).stamp);
  return Number.isFinite(time_s) ? time_s : 0;
};

export function gameOf(value: unknown): GameState {
  const m = bag(value);
  return {
    time_s: stampOf(m), stage: text(m.stage), phase: text(m.phase), set_piece: text(m.set_piece), team: text(m.team), in_play: m.in_play === true,
    clock_s: number(m.clock), remaining_s: number(m.remaining), last_touch: text(m.last_touch),
    teams: list(m.teams).map(bag).map((t) => ({
      name: text(t.name), title: text(t.title), score: number(t.score), robots: number(t.robots), yellow: number(t.yellow_cards), red: number(t.red_cards), possession_s: number(t.possession),
    })),
  };
}

export function decisionOf(value: unknown): Decision {
  const m = bag(value);
  return {
    time_s: stampOf(m), sequence: number(m.sequence), tick: number(m.tick), stage: text(m.stage), clock_s: number(m.clock), rule: text(m.rule), command: text(m.command),
    team: text(m.team), robot: text(m.robot), reason: text(m.reason), point: spot(m.point), ball: spot(m.ball), score: list(m.score).map(number),
    players: list(m.players).map(bag).map((p) => ({name: text(p.name), team: text(p.team), number: number(p.number), at: spot(p), yaw: number(p.yaw)})),
  };
}

export function playerOf(value: unknown): PlayerReport {
  const m = bag(value);
  return {role: text(m.role), intention: text(m.intention), ball_confidence: Math.max(0, Math.min(1, number(m.ball_confidence))), ball_engaged: m.ball_engaged === true};
}

// --- words

const words: Record<string, string> = {
  throw_in: 'throw-in', kickoff: 'kick-off', dropped_ball: 'dropped ball', second_yellow: 'second yellow card',
  overtime_first: 'overtime, first half', overtime_second: 'overtime, second half',
};

/** "throw_in" as people write it: "Throw-in". */
export function wordsOf(name: string): string {
  const plain = words[name] ?? name.replace(/_/g, ' ');
  return plain.charAt(0).toUpperCase() + plain.slice(1);
}

/** Of a part of the game: "3:07". */
export function clockText(time_s: number): string {
  const whole = Math.max(0, Math.floor(time_s + 1e-6));
  return `${Math.floor(whole / 60)}:${String(whole % 60).padStart(2, '0')}`;
}

const short: Record<string, string> = {first_half: '1st', second_half: '2nd', half_time: 'break', overtime_first: 'OT 1', overtime_second: 'OT 2', penalties: 'pen.', ended: 'end'};
export const shortStage = (stage: string): string => short[stage] ?? stage;

export type Weight = 'goal' | 'card' | 'stage' | 'call' | 'minor';

/** How much a decision matters to who looks at many. */
export function weightOf(decision: Decision): Weight {
  if (decision.rule === 'goal' || decision.rule === 'own_goal') return 'goal';
  if (/card|yellow/.test(decision.rule)) return 'card';
  if (['begin', 'half_time', 'end'].includes(decision.rule)) return 'stage';
  return ['start', 'in_play', 'back', 'refused', 'cleared'].includes(decision.rule) ? 'minor' : 'call';
}

/** "Goal: magenta (1 : 2)". */
export function titleOf(decision: Decision): string {
  const score = weightOf(decision) === 'goal' && decision.score.length === 2 ? ` (${decision.score[0]} : ${decision.score[1]})` : '';
  return `${wordsOf(decision.rule)}${decision.team === '' ? '' : `: ${decision.team}`}${score}`;
}

/** The reason, behind the robot that it is about where it does not name it. */
export function reasonOf({robot, reason}: Decision): string {
  return robot === '' || reason.includes(robot) ? reason : `${robot}: ${reason}`;
}

// --- the log

/** All decisions of a course of the run, by their numbers. */
export class DecisionBook {
  private entries: Decision[] = [];

  get list(): readonly Decision[] {
    return this.entries;
  }

  set(decisions: Decision[]): void {
    this.entries = [...decisions].sort((a, b) => a.sequence - b.sequence);
  }

  /** One that comes again is known; one in place of another ends the course that the other was of. @return whether it is new */
  add(decision: Decision): boolean {
    const at = this.entries.findIndex((e) => e.sequence >= decision.sequence);
    const known = at < 0 ? undefined : this.entries[at];
    if (known && known.sequence === decision.sequence && known.tick === decision.tick && known.rule === decision.rule && known.robot === decision.robot) return false;
    this.entries = [...(at < 0 ? this.entries : this.entries.slice(0, at)), decision];
    return true;
  }

  /** Those of a stretch of time. */
  between(begin_s: number, end_s: number): Decision[] {
    return this.entries.filter((d) => d.time_s >= begin_s - 1e-9 && d.time_s <= end_s + 1e-9);
  }
}

// --- the field

export interface Dimensions {
  length: number;
  width: number;
  penalty_area: [number, number];  // depth, width
  goal_area: [number, number];
  corner_radius: number;
  circle_radius: number;
  penalty_mark: number;
  restart_y: number;
  goal: [number, number];
}

/** src/soccer/field.h */
const fields: Dimensions[] = [
  {length: 22, width: 14, penalty_area: [2.25, 6.9], goal_area: [0.75, 3.9], corner_radius: 0.75, circle_radius: 2, penalty_mark: 3.6, restart_y: 3.5, goal: [0.6, 2.4]},
  {length: 18, width: 12, penalty_area: [2.25, 6.5], goal_area: [0.75, 3.5], corner_radius: 0.75, circle_radius: 2, penalty_mark: 3, restart_y: 3, goal: [0.6, 2]},
  {length: 12, width: 8, penalty_area: [1.5, 4.3], goal_area: [0.5, 3], corner_radius: 0.5, circle_radius: 1.35, penalty_mark: 2, restart_y: 2, goal: [0.6, 2]},
];

/** Of a field by its length, which goals tell; one that the league does not know is the largest, larger or smaller. */
export function dimensionsOf(length_m: number): Dimensions {
  const largest = fields[0] as Dimensions;
  if (!(length_m > 1)) return largest;
  const known = fields.find((f) => Math.abs(f.length - length_m) < 1.5);
  if (known) return known;
  const k = length_m / largest.length;
  const two = ([a, b]: [number, number]): [number, number] => [a * k, b * k];
  return {
    length: length_m, width: largest.width * k, penalty_area: two(largest.penalty_area), goal_area: two(largest.goal_area), corner_radius: largest.corner_radius * k,
    circle_radius: largest.circle_radius * k, penalty_mark: largest.penalty_mark * k, restart_y: largest.restart_y * k, goal: two(largest.goal),
  };
}

/** Distance between the goals of a world; 0: it has not two. */
export function lengthOfField(instances: {name: string; pose: readonly number[]}[]): number {
  const x = instances.filter((i) => /^goal(_|$)/i.test(i.name)).map((i) => i.pose[0] ?? 0);
  return x.length < 2 ? 0 : Math.max(...x) - Math.min(...x);
}

// --- what the page works out

export interface Pass {
  time_s: number;
  team: string;
  from: string;
  to: string;
  begin: Spot;
  end: Spot;
}

interface Frame {
  time_s: number;
  weight_s: number;
  spots: Map<string, Spot[]>;  // by 'ball' and the names of teams
}

export const cell_m = 0.5;
const most_frames = 40_000, at_ball_m = 0.8, shortest_pass_m = 0.5;

/** Time spent in each cell, smoothed over the neighbours; row 0 is at the largest y. */
export class HeatGrid {
  readonly columns: number;
  readonly rows: number;
  readonly values: Float32Array;

  constructor(private readonly dimensions: Dimensions) {
    this.columns = Math.ceil(dimensions.length / cell_m) + 2;
    this.rows = Math.ceil(dimensions.width / cell_m) + 2;
    this.values = new Float32Array(this.columns * this.rows);
  }

  add([x, y]: Spot, weight: number): void {
    const column = Math.floor((x + this.dimensions.length / 2) / cell_m) + 1, row = Math.floor((this.dimensions.width / 2 - y) / cell_m) + 1;
    for (let dr = -1; dr <= 1; dr++) {
      for (let dc = -1; dc <= 1; dc++) {
        const c = column + dc, r = row + dr;
        if (c < 0 || r < 0 || c >= this.columns || r >= this.rows) continue;
        const at = r * this.columns + c;
        this.values[at] = (this.values[at] as number) + (weight * (2 - Math.abs(dr)) * (2 - Math.abs(dc))) / 16;
      }
    }
  }
}

/** Where the ball and the teams were, and passes: touches of two robots of a team one after the other. */
export class Tally {
  private frames: Frame[] = [];
  passes: Pass[] = [];
  private grids = new Map<string, HeatGrid>();
  private toucher: {robot: string; team: string; at: Spot | null} | null = null;
  private last_ball: Spot | null = null;

  constructor(private dimensions: Dimensions) {}

  setDimensions(dimensions: Dimensions): void {
    if (dimensions === this.dimensions) return;
    this.dimensions = dimensions;
    this.grids.clear();
  }

  clear(): void {
    this.frames = [];
    this.passes = [];
    this.grids.clear();
    this.toucher = this.last_ball = null;
  }

  /** Time of the latest places; minus infinity: there are none. */
  get latest_s(): number {
    return this.frames[this.frames.length - 1]?.time_s ?? Number.NEGATIVE_INFINITY;
  }

  get seconds(): number {
    return this.frames.reduce((sum, f) => sum + f.weight_s, 0);
  }

  /** The run has gone back: what came later has not been. */
  forgetAfter(time_s: number): void {
    const last = this.frames[this.frames.length - 1];
    if (!last || last.time_s <= time_s) return;
    this.frames = this.frames.filter((f) => f.time_s <= time_s);
    this.passes = this.passes.filter((p) => p.time_s <= time_s);
    this.grids.clear();
    this.toucher = this.last_ball = null;
  }

  /** Places at a time, in a game that goes on. Longer gaps than a second count as one. */
  sample(time_s: number, ball: Spot | null, robots: {name: string; team: string; at: Spot}[]): void {
    this.forgetAfter(time_s);
    const last = this.frames[this.frames.length - 1];
    const weight_s = last ? Math.min(1, time_s - last.time_s) : 0;
    if (last && weight_s <= 0) return;
    const spots = new Map<string, Spot[]>();
    if (ball) spots.set('ball', [ball]);
    for (const {team, at} of robots) {
      const own = spots.get(team);
      if (own) own.push(at);
      else spots.set(team, [at]);
    }
    const frame = {time_s, weight_s, spots};
    this.frames.push(frame);
    if (this.frames.length > most_frames) {
      this.frames.splice(0, most_frames / 10);
      this.grids.clear();
    } else {
      for (const [key, grid] of this.grids) for (const at of spots.get(key) ?? []) grid.add(at, weight_s);
    }
    this.last_ball = ball;
    const holder = this.toucher && robots.find((r) => r.name === this.toucher?.robot);
    if (this.toucher && holder && ball && Math.hypot(holder.at[0] - ball[0], holder.at[1] - ball[1]) < at_ball_m) this.toucher.at = ball;
  }

  /** Who touched the ball last, as the referee has it. `teamOf` gives the team of a robot. */
  touch(time_s: number, robot: string, in_play: boolean, teamOf: (robot: string) => string): void {
    if (!in_play || robot === '') {
      this.toucher = null;
      return;
    }
    const before = this.toucher;
    if (before?.robot === robot) return;
    const team = teamOf(robot);
    this.toucher = {robot, team, at: this.last_ball};
    if (!before || team === '' || before.team !== team || !before.at || !this.last_ball) return;
    if (Math.hypot(before.at[0] - this.last_ball[0], before.at[1] - this.last_ball[1]) < shortest_pass_m) return;
    this.passes.push({time_s, team, from: before.robot, to: robot, begin: before.at, end: this.last_ball});
  }

  /** All of a match so far, in place of what was counted until now. */
  load(track: Track): void {
    this.clear();
    const teamOf = (robot: string): string => track.teams.get(robot) ?? '';
    let next = 0;
    const touchBefore = (time_s: number): void => {
      for (let touch = track.touches[next]; touch && touch.time_s < time_s; touch = track.touches[++next]) this.touch(touch.time_s, touch.robot, touch.robot !== '', teamOf);
    };
    track.times.forEach((time_s, i) => {
      const {ball, robots} = track.places[i] as Track['places'][number];
      touchBefore(time_s);
      this.sample(time_s, ball, robots);
    });
    touchBefore(Number.POSITIVE_INFINITY);
  }

  /** @param key  'ball', or the name of a team */
  heat(key: string): HeatGrid {
    let grid = this.grids.get(key);
    if (!grid) {
      grid = new HeatGrid(this.dimensions);
      for (const frame of this.frames) for (const at of frame.spots.get(key) ?? []) grid.add(at, frame.weight_s);
      this.grids.set(key, grid);
    }
    return grid;
  }
}

const absent_mm = -2147483648;

export interface Track {
  times: number[];
  places: {ball: Spot | null; robots: {name: string; team: string; at: Spot}[]}[];
  touches: {time_s: number; robot: string}[];
  teams: Map<string, string>;
}

/** What the server has kept of a match (`/sandlot/match_track`): lists of one length each, or as much of them as fits together. */
export function trackOf(value: unknown): Track {
  const m = bag(value);
  const robots = list(m.robots).map(text), teams = list(m.teams).map(text), mm = list(m.places).map(number);
  const width = 2 + 2 * robots.length;
  const times = list(m.times).map(number).slice(0, Math.floor(mm.length / width));
  const spotAt = (at: number): Spot | null => (mm[at] === absent_mm ? null : [(mm[at] as number) / 1000, (mm[at + 1] as number) / 1000]);
  const places = times.map((_, i) => ({
    ball: spotAt(i * width),
    robots: robots.flatMap((name, r) => {
      const at = spotAt(i * width + 2 + 2 * r);
      return at ? [{name, team: teams[r] ?? '', at}] : [];
    }),
  }));
  const who = list(m.touches).map(text);
  const touches = list(m.touch_times).map(number).slice(0, who.length).map((time_s, i) => ({time_s, robot: who[i] as string}));
  return {times, places, touches, teams: new Map(robots.map((name, r) => [name, teams[r] ?? '']))};
}

// --- marks on the time line

export interface TimeMark {
  time_s: number;
  color: string;
  weight: Weight;
  title: string;
}

/** The mark next to a time within so much of it; heavier ones win over nearer ones. */
export function markNear(marks: readonly TimeMark[], time_s: number, within_s: number): TimeMark | null {
  const order: Weight[] = ['goal', 'card', 'stage', 'call', 'minor'];
  let best: TimeMark | null = null;
  const cost = (m: TimeMark): number => order.indexOf(m.weight) * 2 * within_s + Math.abs(m.time_s - time_s);
  for (const mark of marks) {
    if (Math.abs(mark.time_s - time_s) > within_s) continue;
    if (!best || cost(mark) < cost(best)) best = mark;
  }
  return best;
}
