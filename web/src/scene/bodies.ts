// What stands in the world, as the scene keeps it: bodies by instance id, their links' poses, their slots in batches.
import * as THREE from 'three';
import type { PoseSlot } from '../binary';
import type { Device, Instance, Light, Model, Pose, World } from '../protocol';
import type { Assets } from './assets';
import { Batches, type Slot } from './batches';
import { Way } from './between';
import { Chain } from './kinematics';
import { composeMatrix, multiply, transform, yawOf } from './poses';
import { collisionParts, partsOfLink, type Part } from './shapes';

/** What a model's instances share. */
interface Kin {
  model: Model;
  /** Its model as text: the same id may mean another model after the program was started anew. */
  content: string;
  chain: Chain;
  parts: Part[];
  collisions: Part[] | undefined;
  /** Extent in the frame of the first link, joints at 0. */
  bounds: THREE.Box3;
  /** Extents of geometries by their keys: making one only to measure it is dear, and parts come one by one. */
  boxes: Map<string, THREE.Box3>;
}

export class Body implements PoseSlot {
  readonly motions: Uint8Array;
  readonly values: Float64Array;
  form = 0;
  /** Seven numbers per link. */
  readonly world: Float64Array;
  readonly slots: Slot[] = [];
  readonly collision_slots: Slot[] = [];
  /** Waits for its matrices to be written. */
  is_queued = false;
  /** Is in the list of those under way. */
  is_gliding = false;
  /** When a message told of it last, by the browser's clock. */
  told_ms = -Infinity;
  /** Simulated time of the pose before, and its position and heading: what velocities are taken from. */
  time_s = NaN;
  readonly velocity = new Float64Array(3);
  yaw_rate = 0;
  readonly way: Way;
  /** As `world`, where the latest message told it to be. */
  private readonly goal: Float64Array;
  private readonly before = new Float64Array(7);

  constructor(
    public instance: Instance,
    readonly kin: Kin,
  ) {
    this.motions = kin.chain.motions;
    this.values = new Float64Array(7 * kin.chain.links);
    this.world = new Float64Array(7 * kin.chain.links);
    this.goal = new Float64Array(7 * kin.chain.links);
    this.way = new Way(this.motions, this.values.length);
    kin.chain.placeAtRest(instance.pose, this.world);
    this.before.set(this.world.subarray(0, 7));
  }

  get is_static(): boolean {
    return this.kin.model.static;
  }

  get bounds(): THREE.Box3 {
    return this.kin.bounds;
  }

  /** Takes what a message told; false when that is not a pose. `glides`: it is on its way there until the next message. */
  take(time_s: number, scratch: Float64Array, glides = false): boolean {
    const goal = this.goal;
    if (!this.kin.chain.place(this, goal, scratch, this.instance.pose)) return false;
    const passed_s = time_s - this.time_s;
    if (passed_s > 0 && passed_s < 1) {
      for (let c = 0; c < 3; ++c) this.velocity[c] = (goal[c] - this.before[c]) / passed_s;
      const turned = yawOf(goal, 0) - yawOf(this.before, 0);
      this.yaw_rate = Math.atan2(Math.sin(turned), Math.cos(turned)) / passed_s;
    } else if (passed_s !== 0) {
      this.velocity.fill(0);
      this.yaw_rate = 0;
    }
    this.time_s = time_s;
    for (let c = 0; c < 7; ++c) this.before[c] = goal[c];
    if (!this.way.take(this, time_s, glides)) this.world.set(goal);
    return true;
  }

  /** Goes to a share of the way to where the latest message told it to be. */
  advance(share: number, scratch: Float64Array): void {
    this.way.advance(share);
    this.kin.chain.place(this.way.shown, this.world, scratch, this.instance.pose);
  }

  /** Moves the whole body so that its first link is at `pose`; the next message of it is stronger. */
  override(pose: ArrayLike<number>, scratch: Float64Array): void {
    // X_new * inverse(X_old) on every link, by way of each link in the first.
    const base = Float64Array.from(this.world.subarray(0, 7));
    const target = Float64Array.from(pose);
    const inverse = new Float64Array(7);
    const relative = new Float64Array(7);
    invertInto(base, inverse);
    for (let i = 0; i < this.world.length; i += 7) {
      multiply(inverse, 0, this.world, i, relative, 0);
      multiply(target, 0, relative, 0, scratch, i);
    }
    this.world.set(scratch.subarray(0, this.world.length));
    this.way.forget();
  }

  /** Pose of a device in the world, into out[0..6]. */
  devicePose(device: Device, out: Float64Array): void {
    const link = Math.min(Math.max(0, device.link), this.kin.chain.links - 1);
    multiply(this.world, 7 * link, device.pose, 0, out, 0);
  }

  /** As devicePose(), at a time near that of the latest message: as the body moved on between the last two. */
  devicePoseAt(device: Device, time_s: number, out: Float64Array): void {
    this.devicePose(device, out);
    const dt_s = time_s - this.way.shown_s;
    if (!(Math.abs(dt_s) < 0.5)) return;
    const half = (this.yaw_rate * dt_s) / 2;
    const c = Math.cos(2 * half), s = Math.sin(2 * half);
    const x = out[0] - this.world[0], y = out[1] - this.world[1];
    out[0] = this.world[0] + c * x - s * y + this.velocity[0] * dt_s;
    out[1] = this.world[1] + s * x + c * y + this.velocity[1] * dt_s;
    out[2] += this.velocity[2] * dt_s;
    const qc = Math.cos(half), qs = Math.sin(half);
    const [w, qx, qy, qz] = out.subarray(3, 7);
    out[3] = qc * w - qs * qz;
    out[4] = qc * qx - qs * qy;
    out[5] = qc * qy + qs * qx;
    out[6] = qc * qz + qs * w;
  }

  /** Middle of the bounds in the world, into out[0..2]. */
  middle(out: Float64Array): void {
    const b = this.bounds;
    transform(this.world, 0, (b.min.x + b.max.x) / 2, (b.min.y + b.max.y) / 2, (b.min.z + b.max.z) / 2, out);
  }

  /** Radius of a ball about the middle that holds the body. */
  get radius_m(): number {
    const b = this.bounds;
    return Math.max(0.05, Math.hypot(b.max.x - b.min.x, b.max.y - b.min.y, b.max.z - b.min.z) / 2);
  }
}

function invertInto(pose: Float64Array, out: Float64Array): void {
  out[3] = pose[3];
  out[4] = -pose[4];
  out[5] = -pose[5];
  out[6] = -pose[6];
  out[0] = out[1] = out[2] = 0;
  const p = new Float64Array(3);
  transform(out, 0, -pose[0], -pose[1], -pose[2], p);
  out.set(p);
}

export interface PlaneOf {
  body: Body;
  link: number;
  pose: Pose;
  normal: [number, number, number];
  color: [number, number, number, number];
  texture: string;
}

export interface LightOf {
  body: Body;
  link: number;
  light: Light;
}

export class Bodies {
  readonly by_id = new Map<number, Body>();
  readonly by_name = new Map<string, Body>();
  readonly devices = new Map<string, { body: Body; device: Device }>();
  /** In the order of the world's list. */
  list: Body[] = [];
  planes: PlaneOf[] = [];
  lights: LightOf[] = [];
  readonly batches: Batches;
  shows_collisions = false;
  private readonly kins = new Map<string, Kin>();
  private moved: Body[] = [];
  private gliding: Body[] = [];
  private epoch = -1;
  /** As long as the longest model's poses. */
  scratch = new Float64Array(7 * 16);
  private readonly collision_root = new THREE.Group();

  constructor(
    root: THREE.Object3D,
    private readonly assets: Assets,
    private readonly changed: () => void,
  ) {
    this.batches = new Batches(root, assets);
    root.add(this.collision_root);
  }

  setWorld(world: World): void {
    const models = new Map(world.models.map((m) => [m.id, m]));
    const fresh = world.epoch !== this.epoch;
    this.epoch = world.epoch;
    const kept = new Set<number>();
    const changed = this.dropChanged(models);
    for (const instance of world.instances) {
      const model = models.get(instance.model);
      if (model === undefined || model.links.length === 0) continue;
      kept.add(instance.id);
      let body = this.by_id.get(instance.id);
      const changed_model = body !== undefined && (body.instance.model !== instance.model || changed.has(instance.model));
      if (body !== undefined && (fresh || changed_model)) {
        this.remove(body);
        body = undefined;
      }
      if (body === undefined) this.insert(instance, model);
      else body.instance = instance;
    }
    for (const body of [...this.by_id.values()]) if (!kept.has(body.instance.id)) this.remove(body);
    this.batches.sweep();
    this.index(world);
  }

  /** Forgets models that are gone or other than they were; tells the latter's ids. */
  private dropChanged(models: Map<string, Model>): Set<string> {
    const changed = new Set<string>();
    for (const [id, kin] of this.kins) {
      const model = models.get(id);
      if (model !== undefined && JSON.stringify(model) === kin.content) continue;
      this.kins.delete(id);
      if (model !== undefined) changed.add(id);
    }
    return changed;
  }

  /** A body that a message told of; its way begins where it is shown. */
  take(body: Body, time_s: number, glides: boolean): boolean {
    if (!body.take(time_s, this.scratch, glides)) return false;
    if (body.way.active && !body.is_gliding) {
      body.is_gliding = true;
      this.gliding.push(body);
    }
    this.noteMoved(body);
    return true;
  }

  /** A message has come: those under way go on from where they are. */
  restart(): void {
    for (const body of this.gliding) body.way.restart();
  }

  /** Those under way go to a share of it. True while some are. */
  glide(share: number): boolean {
    const gliding = this.gliding;
    let kept = 0;
    for (let n = 0; n < gliding.length; ++n) {
      const body = gliding[n];
      if (body.way.active) {
        body.advance(share, this.scratch);
        this.noteMoved(body);
      }
      body.is_gliding = body.way.active;
      if (body.is_gliding) gliding[kept++] = body;
    }
    gliding.length = kept;
    return kept > 0;
  }

  /** Notes that a body is not where its slots are. */
  noteMoved(body: Body): void {
    // Once, however many messages come while nothing is drawn (a hidden tab).
    if (body.is_queued) return;
    body.is_queued = true;
    this.moved.push(body);
  }

  /** Writes the matrices of what has moved. True when anything has. */
  update(): boolean {
    if (this.moved.length === 0) return false;
    for (let n = 0; n < this.moved.length; ++n) {
      const body = this.moved[n];
      body.is_queued = false;
      place(body.slots, body.world);
      if (this.shows_collisions) place(body.collision_slots, body.world);
    }
    this.moved.length = 0;
    this.batches.flush();
    return true;
  }

  setCollisions(show: boolean): void {
    this.shows_collisions = show;
    this.collision_root.visible = show;
    if (!show) return;
    for (const body of this.list) {
      this.addCollisions(body);
      this.noteMoved(body);
    }
  }

  /** Forgets the world; another may come. */
  clear(): void {
    this.batches.dispose();
    this.kins.clear();
    this.by_id.clear();
    this.by_name.clear();
    this.devices.clear();
    this.list = [];
    this.planes = [];
    this.lights = [];
    this.moved = [];
    this.gliding = [];
    this.epoch = -1;
  }

  private insert(instance: Instance, model: Model): void {
    const kin = this.kinOf(model);
    const body = new Body(instance, kin);
    this.by_id.set(instance.id, body);
    for (const part of kin.parts) body.slots.push(this.batches.add(part, body));
    if (this.shows_collisions) this.addCollisions(body);
    this.noteMoved(body);
  }

  private remove(body: Body): void {
    for (const slot of body.slots) slot.batch.remove(slot);
    for (const slot of body.collision_slots) slot.batch.remove(slot);
    body.slots.length = body.collision_slots.length = 0;
    body.way.active = false;
    this.by_id.delete(body.instance.id);
  }

  private kinOf(model: Model): Kin {
    const known = this.kins.get(model.id);
    if (known) return known;
    const kin: Kin = { model, content: JSON.stringify(model), chain: new Chain(model), parts: [], collisions: undefined, bounds: new THREE.Box3(), boxes: new Map() };
    this.kins.set(model.id, kin);
    if (this.scratch.length < 7 * model.links.length) this.scratch = new Float64Array(14 * model.links.length);
    model.links.forEach((link, i) => {
      const later = (parts: Part[]): void => {
        if (this.kins.get(model.id) !== kin) return;
        this.join(kin, parts, false);
      };
      kin.parts.push(...partsOfLink(link, i, this.assets, later));
    });
    boundsOf(kin);
    return kin;
  }

  private addCollisions(body: Body): void {
    const kin = body.kin;
    if (kin.collisions === undefined) {
      const known: Part[] = (kin.collisions = []);
      kin.model.links.forEach((link, i) => {
        known.push(...collisionParts(link, i, this.assets, (parts) => this.join(kin, parts, true)));
      });
    }
    if (body.collision_slots.length > 0) return;
    for (const part of kin.collisions) body.collision_slots.push(this.batches.add(part, body, this.collision_root));
  }

  /** Parts whose asset has come: every body of the model gets them. */
  private join(kin: Kin, parts: Part[], collisions: boolean): void {
    if (collisions) kin.collisions?.push(...parts);
    else kin.parts.push(...parts);
    boundsOf(kin);
    for (const body of this.by_id.values()) {
      if (body.kin !== kin) continue;
      for (const part of parts) {
        if (collisions) body.collision_slots.push(this.batches.add(part, body, this.collision_root));
        else body.slots.push(this.batches.add(part, body));
      }
      this.noteMoved(body);
    }
    this.changed();
  }

  private index(world: World): void {
    this.by_name.clear();
    this.devices.clear();
    this.list = [];
    this.planes = [];
    this.lights = [];
    for (const instance of world.instances) {
      const body = this.by_id.get(instance.id);
      if (body === undefined) continue;
      this.list.push(body);
      this.by_name.set(instance.name, body);
      for (const device of instance.devices) this.devices.set(device.path, { body, device });
      body.kin.model.links.forEach((link, i) => {
        for (const visual of link.visuals) {
          if (visual.shape.type !== 'plane') continue;
          const material = visual.material ?? { diffuse: [0.7, 0.7, 0.72, 1] };
          this.planes.push({ body, link: i, pose: visual.pose, normal: visual.shape.normal, color: material.diffuse, texture: material.texture ?? '' });
        }
        for (const light of link.lights ?? []) this.lights.push({ body, link: i, light });
      });
    }
  }
}

function place(slots: Slot[], world: Float64Array): void {
  for (let s = 0; s < slots.length; ++s) {
    const slot = slots[s];
    composeMatrix(world, 7 * slot.link, slot.local, slot.batch.matrices, 16 * slot.at);
    slot.batch.touch(slot.at);
  }
}

const corner = new THREE.Vector3();
const matrix = new THREE.Matrix4();

function boundsOf(kin: Kin): void {
  const rest = new Float64Array(7 * kin.chain.links);
  kin.chain.placeAtRest([0, 0, 0, 1, 0, 0, 0], rest);
  const base = new Float64Array(7);
  invertInto(rest.subarray(0, 7) as Float64Array, base);
  const in_base = new Float64Array(7);
  const m = new Float32Array(16);
  kin.bounds.makeEmpty();
  for (const part of kin.parts) {
    const box = boxOf(part, kin.boxes);
    multiply(base, 0, rest, 7 * part.link, in_base, 0);
    composeMatrix(in_base, 0, part.local, m, 0);
    matrix.fromArray(m);
    for (let i = 0; i < 8; ++i) {
      corner.set(i & 1 ? box.max.x : box.min.x, i & 2 ? box.max.y : box.min.y, i & 4 ? box.max.z : box.min.z).applyMatrix4(matrix);
      kin.bounds.expandByPoint(corner);
    }
  }
  if (kin.bounds.isEmpty()) kin.bounds.set(new THREE.Vector3(-0.1, -0.1, 0), new THREE.Vector3(0.1, 0.1, 0.2));
}

function boxOf(part: Part, known: Map<string, THREE.Box3>): THREE.Box3 {
  let box = known.get(part.geometry_key);
  if (box === undefined) {
    const geometry = part.geometry();
    geometry.computeBoundingBox();
    known.set(part.geometry_key, (box = geometry.boundingBox ?? new THREE.Box3()));
    geometry.dispose();
  }
  return box;
}
