// Brings scans, ranges, camera views and detected objects of devices to the scene, for the overlays that are on: of all robots while they are few, else of the selected one.
import {secondsOf} from '../net/decoders';
import type {Client} from '../net/client';
import type {CameraView, Detection} from '../scene/overlays/marks';
import type {SceneView} from '../scene/scene';
import type {Store} from './store';

const devices_max = 24;

type What = 'scans' | 'ranges' | 'views' | 'objects' | 'places';

function whatOf(type: string): What | null {
  return /LaserScan$/.test(type) ? 'scans' : /\/Range$/.test(type) ? 'ranges' : /\/CameraInfo$/.test(type) ? 'views'
    : /\/ObjectArray$/.test(type) ? 'objects' : /\/ObjectPoseArray$/.test(type) ? 'places' : null;
}

interface Detected {
  position?: {x: number; y: number; z: number};
  pose?: {position: {x: number; y: number; z: number}};
  color?: {r: number; g: number; b: number};
}

function detectionsOf(message: Record<string, unknown>): Detection[] {
  return ((message.objects ?? []) as Detected[]).map((o) => {
    const at = o.position ?? o.pose?.position ?? {x: Number.NaN, y: 0, z: 0};
    return {place: [at.x, at.y, at.z], color: o.color ?? {r: 1, g: 1, b: 1}};
  });
}

/** Null for what no lens can be. */
function viewOf(info: Record<string, unknown>): CameraView | null {
  const k = info.k as ArrayLike<number> | undefined;
  const p = info.p as ArrayLike<number> | undefined;
  const width = Number(info.width);
  const height = Number(info.height);
  const fx = k?.[0] ?? 0;
  const fy = k?.[4] ?? 0;
  const model = String(info.distortion_model ?? '');
  const round = !['', 'plumb_bob', 'rational_polynomial'].includes(model);
  if (!(width > 0 && height > 0) || (!round && !(fx > 0 && fy > 0))) return null;
  // P's Tx is -fx times the baseline.
  return {width, height, fx, fy, left_m: fx > 0 ? (p?.[3] ?? 0) / fx : 0, round};
}

export class SensorOverlays {
  private readonly stops = new Map<string, () => void>();
  private wanted: Record<What, boolean> = {scans: false, ranges: false, views: false, objects: false, places: false};

  constructor(private readonly client: Client, private readonly store: Store, private readonly scene: SceneView) {
    store.onWorld.on(() => this.update());
    store.onSelection.on(() => this.update());
    store.onEpoch.on(() => this.clear());
  }

  show(wanted: {scans: boolean; ranges: boolean; views: boolean; objects: boolean}): void {
    this.wanted = {...wanted, places: wanted.objects};
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
    const wanted = new Map<string, {topic: string; path: string; what: What}>();
    for (const robot of ordered) {
      for (const device of robot.devices ?? []) {
        for (const topic of device.topics ?? []) {
          const what = whatOf(topic.type);
          if (what !== null && this.wanted[what] && wanted.size < devices_max) wanted.set(topic.name, {topic: topic.name, path: device.path, what});
        }
      }
    }
    for (const [topic, stop] of this.stops) {
      if (wanted.has(topic)) continue;
      stop();
      this.stops.delete(topic);
    }
    for (const {topic, path, what} of wanted.values()) {
      if (this.stops.has(topic)) continue;
      const stop = this.client.subscribe(topic, (message) => {
        const value = message.value() as Record<string, unknown> | undefined;
        const time_s = secondsOf((value?.header as {stamp?: unknown} | undefined)?.stamp ?? {});
        if (!value || Number.isNaN(time_s)) return;
        if (what === 'scans') this.scene.setScan(path, value as never, time_s);
        else if (what === 'ranges') this.scene.setRange(path, value as never);
        else if (what === 'views') this.scene.setView(topic, path, viewOf(value));
        else this.scene.setDetections(topic, what === 'objects' ? path : null, detectionsOf(value), time_s);
      });
      this.stops.set(topic, () => {
        stop();
        if (what === 'scans') this.scene.setScan(path, null);
        else if (what === 'ranges') this.scene.setRange(path, null);
        else if (what === 'views') this.scene.setView(topic, path, null);
        else this.scene.setDetections(topic, null, null);
      });
    }
  }
}
