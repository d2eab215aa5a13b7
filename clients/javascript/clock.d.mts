export class Clock {
  constructor(options?: { wall?: () => number; wait?: (seconds: number) => Promise<unknown>; windows?: number[] });
  readonly messages: number;
  readonly rewinds: number;
  take(stamp_s: number, step_s: number, wall_s_list: ArrayLike<number> & Iterable<number>, arrival_s?: number, restarted?: boolean): void;
  speed(interval_s?: number): number;
  nowS(): number;
  wallSUntil(time_s: number): number;
  sleepUntil(time_s: number, timeout_s?: number): Promise<boolean>;
  timer(period_s: number): IntervalTimer;
}

export class IntervalTimer {
  constructor(clock: Clock, period_s: number);
  readonly period_s: number;
  readonly nextS: number;
  wallSLeft(): number;
  poll(): number;
  wait(timeout_s?: number): Promise<number>;
}
