// What the page knows of the run. Panels listen here; none of them asks the connection for the world itself.
import type {Device, Instance, Part, Status, World} from '../protocol';
import {Signal} from '../net/signal';

export interface Selected {
  address: string;
  /** Null: a part of the world itself, such as a rule. */
  instance: Instance | null;
  device: Device | null;
  part: Part | null;
}

/** What belongs to no robot: media, rules, programs of teams. */
export function worldParts(world: World): {title: string; kinds: string; parts: Part[]}[] {
  return [
    {title: 'Media', kinds: 'media/', parts: world.media ?? []},
    {title: 'Rules', kinds: 'rules/', parts: world.rules ?? []},
    {title: 'Teams', kinds: '', parts: (world.teams ?? []).flatMap((team) => team.programs)},
  ];
}

export class Store {
  world: World | null = null;
  status: Status | null = null;
  role = '';
  selection: string | null = null;
  /** Simulated time of the newest message, by any of the channels that tell it. */
  time_s = 0;
  epoch = -1;

  readonly onWorld = new Signal<World>();
  readonly onStatus = new Signal<Status>();
  readonly onSelection = new Signal<string | null>();
  readonly onRole = new Signal<string>();
  /** Time began anew (reset, jump, another file): what was kept by time is of another past. */
  readonly onEpoch = new Signal<number>();

  private readonly byName = new Map<string, Instance>();
  private readonly devices = new Map<string, {instance: Instance; device: Device}>();
  private readonly parts = new Map<string, {instance: Instance | null; part: Part}>();

  /** Another run of the server: nothing that was known of the last one holds. */
  forget(): void {
    this.select(null);
    this.world = this.status = null;
    this.byName.clear();
    this.devices.clear();
    this.parts.clear();
    this.epoch = -1;
    this.onEpoch.emit(-1);
  }

  setWorld(world: World): void {
    if (!Array.isArray(world.instances) || !Array.isArray(world.models)) throw new Error('a world without instances or models');
    world.kinds ??= {};
    this.world = world;
    this.byName.clear();
    this.devices.clear();
    this.parts.clear();
    for (const instance of world.instances) {
      this.byName.set(instance.name, instance);
      for (const device of instance.devices ?? []) this.devices.set(device.path, {instance, device});
      for (const part of instance.controllers ?? []) this.parts.set(part.path, {instance, part});
    }
    for (const {parts} of worldParts(world)) for (const part of parts) this.parts.set(part.path, {instance: null, part});
    this.setEpoch(world.epoch);
    this.onWorld.emit(world);
    if (this.selection !== null && !this.find(this.selection)) this.select(null);
  }

  setStatus(status: Status): void {
    status.history_s ??= [];
    this.status = status;
    this.time_s = status.time_s;
    this.setEpoch(status.epoch);
    this.onStatus.emit(status);
  }

  private setEpoch(epoch: number): void {
    if (typeof epoch !== 'number' || epoch === this.epoch) return;
    const first = this.epoch < 0;
    this.epoch = epoch;
    if (!first) this.onEpoch.emit(epoch);
  }

  setRole(role: string): void {
    if (role === this.role) return;
    this.role = role;
    this.onRole.emit(role);
  }

  select(address: string | null): void {
    if (address !== null && !this.find(address)) address = null;
    if (address === this.selection) return;
    this.selection = address;
    this.onSelection.emit(address);
  }

  instance(name: string): Instance | undefined {
    return this.byName.get(name);
  }

  /** "rover", "rover/laser", "rover/controller", "red/coach", "media/air" or "rules/goals". */
  find(address: string): Selected | null {
    const instance = this.byName.get(address);
    if (instance) return {address, instance, device: null, part: null};
    const device = this.devices.get(address);
    if (device) return {address, instance: device.instance, device: device.device, part: null};
    const part = this.parts.get(address);
    return part ? {address, instance: part.instance, device: null, part: part.part} : null;
  }

  selected(): Selected | null {
    return this.selection === null ? null : this.find(this.selection);
  }

  /** Null when this page may play, pause and jump, else why not, in words for a tooltip. A recording can be played, but not steered. */
  whyNotPlay(): string | null {
    if (this.role === '') return 'Not connected';
    return this.role === 'admin' ? null : 'You are watching: only an administrator can steer';
  }

  /** As above, for jumps in time. */
  whyNotJump(): string | null {
    const {status} = this;
    return this.whyNotPlay() ?? (status && !status.may_rewind ? status.why_not || 'This run keeps no snapshots to go back to' : null);
  }

  /** As above, for what changes the run. */
  whyNotSteer(): string | null {
    const reason = this.whyNotPlay();
    if (reason !== null) return reason;
    if (this.status && !this.status.may_steer) return this.status.why_not || 'This run cannot be steered';
    return null;
  }
}
