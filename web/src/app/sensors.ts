// Brings scans and ranges of devices to the scene, for the overlays that are on: of all robots while they are few, else of the selected one.
import {secondsOf} from '../net/decoders';
import type {Client} from '../net/client';
import type {SceneView} from '../scene/scene';
import type {Store} from './store';

const devices_max = 24;

export class SensorOverlays {
  private readonly stops = new Map<string, () => void>();
  private wanted = {scans: false, ranges: false};

  constructor(private readonly client: Client, private readonly store: Store, private readonly scene: SceneView) {
    store.onWorld.on(() => this.update());
    store.onSelection.on(() => this.update());
    store.onEpoch.on(() => this.clear());
  }

  show(scans: boolean, ranges: boolean): void {
    this.wanted = {scans, ranges};
    this.update();
  }

  private clear(): void {
    for (const stop of this.stops.values()) stop();
    this.stops.clear();
  }

  private update(): void {
    const robots = (this.store.world?.instances ?? []).filter((i) => (i.devices ?? []).length > 0);
    const selected = this.store.selected()?.instance;
    // The selected robot's first, so that it is never the one left out.
    const ordered = selected ? [selected, ...robots.filter((r) => r !== selected)] : robots;
    const wanted = new Map<string, {topic: string; path: string; scan: boolean}>();
    for (const robot of ordered) {
      for (const device of robot.devices ?? []) {
        for (const topic of device.topics ?? []) {
          const scan = /LaserScan$/.test(topic.type);
          if (wanted.size < devices_max && ((scan && this.wanted.scans) || (/\/Range$/.test(topic.type) && this.wanted.ranges))) wanted.set(topic.name, {topic: topic.name, path: device.path, scan});
        }
      }
    }
    for (const [topic, stop] of this.stops) {
      if (wanted.has(topic)) continue;
      stop();
      this.stops.delete(topic);
    }
    for (const {topic, path, scan} of wanted.values()) {
      if (this.stops.has(topic)) continue;
      const stop = this.client.subscribe(topic, (message) => {
        const value = message.value() as Record<string, unknown> | undefined;
        const time_s = secondsOf((value?.header as {stamp?: unknown} | undefined)?.stamp ?? {});
        if (!value || Number.isNaN(time_s)) return;
        if (scan) this.scene.setScan(path, value as never, time_s);
        else this.scene.setRange(path, value as never);
      });
      this.stops.set(topic, () => {
        stop();
        if (scan) this.scene.setScan(path, null);
        else this.scene.setRange(path, null);
      });
    }
  }
}
