import type { Clock } from "./clock.mjs";

export { Clock };

/** With the field names of ROS 2. */
// eslint-disable-next-line @typescript-eslint/no-explicit-any
export type Message = any;
export type Handler = (message: Message) => void;

/** What a class like the browser's WebSocket or that of the package ws makes. */
export interface WebSocketLike {
  onopen: ((event: never) => void) | null;
  onmessage: ((event: never) => void) | null;
  onerror: ((event: never) => void) | null;
  onclose: ((event: never) => void) | null;
  send(text: string): void;
  close(): void;
}

export interface ConnectOptions {
  /** tcp://HOST:PORT, ws://HOST:PORT, the address that a run prints; in node also unix:PATH. */
  url?: string;
  /** Longest wait for the connection and for answers; 10 if left out. */
  timeout_s?: number;
  /** In node: the class of the package ws, to connect by WebSocket. */
  WebSocket?: new (url: string) => WebSocketLike;
}
export interface DriveOptions extends ConnectOptions {
  token?: string;
  lockstep?: boolean;
  /** Longest wall time between a step and its end, at most that of the scenario; 1 if left out. */
  deadline_s?: number;
}

export class Refused extends Error {}
export class Disconnected extends Error {}
export class RunEnded extends Disconnected {}

export function dataOf(message: Message, key?: string): Uint8Array;
export function packet(data: Uint8Array | string, to?: string): { to: string; data: string };
export function numbers(values: Iterable<number | null>, missing?: number): Float64Array;

export class Reading {
  readonly topic: string;
  /** null until one has come. */
  message: Message;
  count: number;
  fresh(): boolean;
  value(path: string): Message;
}

export class Step {
  readonly program: string;
  readonly number: number;
  readonly time_ns: bigint;
  readonly time_s: number;
  readonly random: bigint;
  bits(index?: number): bigint;
  uniform(index?: number): number;
}

export class Connection {
  static connect(options?: ConnectOptions): Promise<Connection>;
  readonly url: string;
  statuses: Message[];
  readonly lost: Error | null;
  onStatus: Handler;
  close(): void;
  send(message: object): void;
  nextId(): string;
  ask(message: object, timeout_s?: number): Promise<Message>;
  subscribeTopic(topic: string, handler?: Handler, throttle_ms?: number): Reading;
  publish(topic: string, message: object): void;
  callService(service: string, args?: object, timeout_s?: number): Promise<Message>;
  call(service: string, args?: object, timeout_s?: number): Promise<Message>;
  topics(): Promise<Record<string, string>>;
  services(): Promise<string[]>;
}

/** Of robots and teams. */
interface Drives {
  readonly name: string;
  readonly lockstep: boolean;
  readonly period_s: number | null;
  readonly clock: Clock;
  steps(): AsyncGenerator<Step, void, void>;
  spin(seconds: number): Promise<boolean>;
}

/** The devices of a robot. */
interface Devices {
  readonly name: string;
  subscribe(device: string, handler?: Handler): Reading;
  latest(device: string): Message;
  value(path: string): Message;
  command(device: string, message: object): void;
  sample(device: string): void;
  call(service: string, args?: object, timeout_s?: number): Promise<Message>;
}

export interface Member extends Devices {}

export interface Robot extends Drives, Devices {}
export class Robot extends Connection {
  static connect(name: string, options?: DriveOptions): Promise<Robot>;
  static connect(options?: ConnectOptions): Promise<Connection>;
}

export interface Team extends Drives {}
export class Team extends Connection {
  static connect(name: string, options?: DriveOptions): Promise<Team>;
  static connect(options?: ConnectOptions): Promise<Connection>;
  readonly robots: Record<string, Member>;
  subscribe(robot: string, device: string, handler?: Handler): Reading;
  command(robot: string, device: string, message: object): void;
}
