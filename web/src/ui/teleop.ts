// Drives the robot that is armed: keyboard, stick on the screen, gamepad; 20 commands a second or more while a hand moves, one zero when it lets go.
import type {Context} from '../app/context';
import {remember, remembered} from '../app/settings';
import type {Instance} from '../protocol';
import {Signal} from '../net/signal';

const usual_period_ms = 50;
/** Where a controller commands the drive too: a hand is heard alone for half a second of simulated time behind each command, and a run may be
 * many times as fast as real time. */
const contested_period_ms = 15;

export interface Drive {
  topic: string;
  type: string;
}

/** The command of the robot's drive at its active level; null: it has none that takes a twist. */
export function driveOf(instance: Instance): Drive | null {
  let other: Drive | null = null;
  for (const device of instance.devices ?? []) {
    for (const command of device.commands ?? []) {
      if (!/geometry_msgs\/(msg\/)?Twist(Stamped)?$/.test(command.type)) continue;
      const drive = {topic: command.name, type: command.type};
      if (command.level === '' || (device.active ?? []).includes(command.level)) return drive;
      other ??= drive;
    }
  }
  return other;
}

/** Where hands hold the controls, each -1 to 1: forward, to the left, turning to the left. */
export interface Hands {
  forward: number;
  left: number;
  turn: number;
}

const keyHands: Record<string, Partial<Hands>> = {
  w: {forward: 1}, arrowup: {forward: 1}, s: {forward: -1}, arrowdown: {forward: -1}, a: {turn: 1}, arrowleft: {turn: 1}, d: {turn: -1}, arrowright: {turn: -1},
  q: {left: 1}, e: {left: -1},
};

export function handsOfKeys(keys: Iterable<string>): Hands {
  const sum: Hands = {forward: 0, left: 0, turn: 0};
  for (const key of keys) {
    const one = keyHands[key];
    if (!one) continue;
    sum.forward += one.forward ?? 0;
    sum.left += one.left ?? 0;
    sum.turn += one.turn ?? 0;
  }
  const clamp = (v: number): number => Math.max(-1, Math.min(1, v));
  return {forward: clamp(sum.forward), left: clamp(sum.left), turn: clamp(sum.turn)};
}

/** A twist as the drive's topic takes it. A stick that is pulled back turns the other way, as a car in reverse does not: the robot turns as said. */
export function twistMessage(type: string, hands: Hands, linear_mps: number, angular_radps: number, time_s: number): unknown {
  const twist = {
    linear: {x: hands.forward * linear_mps, y: hands.left * linear_mps, z: 0}, angular: {x: 0, y: 0, z: hands.turn * angular_radps},
  };
  if (!type.endsWith('Stamped')) return twist;
  const sec = Math.floor(time_s);
  return {header: {stamp: {sec, nanosec: Math.round((time_s - sec) * 1e9)}, frame_id: ''}, twist};
}

export class Teleop {
  armed: string | null = null;
  linear_mps = remembered('teleop.linear', 0.5);
  angular_radps = remembered('teleop.angular', 1.2);
  gamepad = '';
  readonly onChange = new Signal();
  readonly stick: Hands = {forward: 0, left: 0, turn: 0};
  private readonly keys = new Set<string>();
  private publisher: {publish: (value: unknown) => boolean; close: () => void} | null = null;
  private drive: Drive | null = null;
  private timer: ReturnType<typeof setInterval> | undefined;
  private moving = false;
  private period_ms = usual_period_ms;

  constructor(private readonly context: Context) {
    addEventListener('blur', () => this.keys.clear());
    context.store.onRole.on(() => {
      if (this.armed !== null && context.store.whyNotSteer() !== null) this.disarm();
    });
    context.store.onWorld.on(() => {
      if (this.armed === null) return;
      const instance = context.store.instance(this.armed);
      const drive = instance ? driveOf(instance) : null;
      if (!drive) this.disarm();
      else if (drive.topic !== this.drive?.topic) this.arm(this.armed);
    });
  }

  arm(name: string): void {
    const instance = this.context.store.instance(name);
    const drive = instance ? driveOf(instance) : null;
    const reason = this.context.store.whyNotSteer();
    if (!drive || reason !== null) {
      this.context.toast(reason ?? `${name} has no drive that takes a twist`, 'warning');
      return;
    }
    this.disarm();
    this.armed = name;
    this.drive = drive;
    this.publisher = this.context.client.publisher(drive.topic, drive.type);
    this.period_ms = (instance?.controllers ?? []).some((c) => !c.inactive) ? contested_period_ms : usual_period_ms;
    this.timer = setInterval(() => this.tick(), this.period_ms);
    this.onChange.emit();
  }

  disarm(): void {
    if (this.armed === null) return;
    if (this.moving) this.send({forward: 0, left: 0, turn: 0});
    clearInterval(this.timer);
    this.publisher?.close();
    this.publisher = null;
    this.armed = null;
    this.moving = false;
    this.keys.clear();
    Object.assign(this.stick, {forward: 0, left: 0, turn: 0});
    this.onChange.emit();
  }

  setLimits(linear_mps: number, angular_radps: number): void {
    this.linear_mps = linear_mps;
    this.angular_radps = angular_radps;
    remember('teleop.linear', linear_mps);
    remember('teleop.angular', angular_radps);
  }

  /** True when the key is one of the armed robot's. */
  key(key: string, down: boolean): boolean {
    if (this.armed === null || !(key in keyHands)) return false;
    if (down) this.keys.add(key);
    else this.keys.delete(key);
    this.tick();
    return true;
  }

  private hands(): Hands {
    const keys = handsOfKeys(this.keys);
    const pad = this.readGamepad();
    const pick = (...values: number[]): number => values.find((v) => v !== 0) ?? 0;
    return {
      forward: pick(keys.forward, this.stick.forward, pad.forward), left: pick(keys.left, this.stick.left, pad.left), turn: pick(keys.turn, this.stick.turn, pad.turn),
    };
  }

  private readGamepad(): Hands {
    const pad = navigator.getGamepads?.().find((p) => p?.connected);
    const name = pad?.id ?? '';
    if (name !== this.gamepad) {
      this.gamepad = name;
      this.onChange.emit();
    }
    const axis = (at: number): number => {
      const v = pad?.axes[at] ?? 0;
      const dead = 0.12;
      return Math.abs(v) < dead ? 0 : -Math.sign(v) * (Math.abs(v) - dead) / (1 - dead);
    };
    return {forward: axis(1), left: axis(0), turn: axis(2)};
  }

  private lastTick_ms = 0;

  private tick(): void {
    const hands = this.hands();
    const active = hands.forward !== 0 || hands.left !== 0 || hands.turn !== 0;
    const now_ms = performance.now();
    if (active) {
      // A key press sends at once, but never more often than the rate.
      if (now_ms - this.lastTick_ms < this.period_ms * 0.8 && this.moving) return;
      this.lastTick_ms = now_ms;
      this.send(hands);
    } else if (this.moving) {
      this.send(hands);
    }
    if (active !== this.moving) {
      this.moving = active;
      this.onChange.emit();
    }
  }

  get active(): boolean {
    return this.moving;
  }

  private send(hands: Hands): void {
    if (this.drive) this.publisher?.publish(twistMessage(this.drive.type, hands, this.linear_mps, this.angular_radps, this.context.store.time_s));
  }
}
