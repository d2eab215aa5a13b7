// The 3D view: what stands in the world, where it is, and hands to take hold of it.
// long file: what the page may ask of the scene, in one place; each part that does it has a file of its own.
//
// Frame    the world's: z up, metres. Positions in the view are CSS pixels from its upper left corner.
// Time     draws at most once per animation frame, and only when something has changed.
// Errors   damaged messages, unknown shapes and missing assets are passed over or drawn as checkered boxes, with one
//          warning on the console; without WebGL the host shows a sentence instead.
import * as THREE from 'three';
import {
  decodeBatteries,
  decodeContacts,
  decodeDeliveries,
  decodePoses,
  emptyBatteries,
  emptyContacts,
  emptyDeliveries,
  emptyPosesHeader,
  readPosesHeader,
} from '../binary';
import type { World } from '../protocol';
import { Assets } from './assets';
import { Backdrop, type Theme } from './backdrop';
import { Between } from './between';
import { Bodies, type Body } from './bodies';
import { CameraRig, type CameraMode, type Subject } from './camera';
import { Foresight } from './foresight';
import { Hands, type Aim, type Drag, type Grip, type Tool } from './hands';
import { Meter, type SceneStats } from './meter';
import { Outline } from './outline';
import { overviewOf, someLeave } from './overview';
import { BAR_PX, Batteries } from './overlays/batteries';
import { GoalFlag } from './overlays/goal_flag';
import { Labels } from './overlays/labels';
import { type Drawing, Layers } from './overlays/layers';
import { Links } from './overlays/links';
import { type CameraView, type Detection, Marks, teamColors, type RangeReading } from './overlays/marks';
import { PullLine } from './overlays/pull';
import { Scans, type Scan } from './overlays/scans';
import { Trails } from './overlays/trails';
import { invert, transform, yawOf } from './poses';
import { pickSlots } from './picking';
import { makeRenderer } from './renderer';
import { Terrain } from './terrain';

export type { Aim, CameraMode, Drag, Drawing, RangeReading, Scan, SceneStats, Theme, Tool };

export interface Picked {
  /** Name of the instance; null: the ground. */
  address: string | null;
  link: string;
  point: [number, number, number];
}

export const OVERLAYS = ['trails', 'names', 'frames', 'velocity', 'contacts', 'scans', 'ranges', 'frusta', 'objects', 'grid', 'shadows', 'collisions', 'teams', 'links', 'batteries'] as const;
export type Overlay = (typeof OVERLAYS)[number];

const MOST_PIXELS_PER_CSS_PIXEL = 2;
/** How often a view of all looks whether it still is one. */
const OVERVIEW_MS = 1000;

export class SceneView {
  onSelect: (address: string | null) => void = () => {};
  onDrag: (drag: Drag) => void = () => {};
  onAim: (aim: Aim) => void = () => {};

  private readonly host: HTMLElement;
  private readonly message: HTMLElement;
  private readonly renderer: THREE.WebGLRenderer | null;
  private readonly scene = new THREE.Scene();
  private readonly root = new THREE.Group();
  private readonly assets: Assets;
  private readonly bodies: Bodies;
  private readonly backdrop: Backdrop;
  private readonly rig = new CameraRig();
  private readonly outline = new Outline();
  private readonly labels: Labels;
  private readonly marks: Marks;
  private readonly links: Links;
  private readonly batteries: Batteries;
  private readonly scans: Scans;
  private readonly trails: Trails;
  private readonly pull_line: PullLine;
  private readonly terrain: Terrain;
  private readonly layers: Layers;
  private readonly goal: GoalFlag;
  private readonly hands: Hands | null;
  private readonly foresight: Foresight;
  private readonly between = new Between();
  private glides = false;
  private readonly meter = new Meter();
  private readonly overlays: Record<Overlay, boolean> = {
    trails: false, names: false, frames: false, velocity: false, contacts: false, scans: true, ranges: true, frusta: false, objects: true, grid: true, shadows: true, collisions: false, teams: true, links: false, batteries: false,
  };
  private readonly header = emptyPosesHeader();
  private readonly contacts = emptyContacts();
  private readonly deliveries = emptyDeliveries();
  private readonly charges = emptyBatteries();
  private readonly raycaster = new THREE.Raycaster();
  private readonly pointer = new THREE.Vector2();
  private readonly subject: Subject = {
    position: new THREE.Vector3(), yaw_rad: 0, radius_m: 0.3, eye: new THREE.Vector3(), forward: new THREE.Vector3(), up: new THREE.Vector3(),
  };
  private readonly device_pose = new Float64Array(7);
  private readonly point = [0, 0, 0];
  private readonly middle = new Float64Array(3);
  private readonly observer: ResizeObserver;
  private world: World | null = null;
  private epoch = -1;
  private selected: Body | null = null;
  private selected_address: string | null = null;
  private hovered: Body | null = null;
  private follow_name: string | null = null;
  /** It shows all, and nobody has looked elsewhere: it does so too when the view has another size. */
  private is_overview = false;
  private overview_ms = 0;
  private overview_reach_m = 0;
  private scheduled = 0;
  private last_frame_ms = 0;
  private dirty = true;
  private lost = false;
  private disposed = false;
  private width_px = 1;
  private height_px = 1;
  private applied_ms = 0;
  private draw_calls = 0;
  private triangles = 0;

  constructor(host: HTMLElement, options: { assetBase: string }) {
    this.host = host;
    if (getComputedStyle(host).position === 'static') host.style.position = 'relative';
    this.message = document.createElement('div');
    this.message.style.cssText = 'position:absolute;inset:0;display:none;align-items:center;justify-content:center;padding:2rem;text-align:center;font:15px/1.5 system-ui,sans-serif;color:#8a94a3;';
    this.message.setAttribute('role', 'status');
    this.renderer = makeRenderer();
    this.assets = new Assets(options.assetBase, () => this.invalidate());
    this.bodies = new Bodies(this.root, this.assets, () => {
      // Meshes have come, and with them their sizes.
      if (this.is_overview) this.frameAll();
      this.touchShadows();
    });
    this.backdrop = new Backdrop(this.scene);
    this.foresight = new Foresight(this.bodies, (name, position, yaw_rad) => this.override(name, position, yaw_rad), () => this.touchShadows());
    this.scene.add(this.root);
    this.labels = new Labels(this.scene);
    this.marks = new Marks(this.scene);
    this.links = new Links(this.scene);
    this.batteries = new Batteries(this.scene);
    this.scans = new Scans(this.scene);
    this.trails = new Trails(this.scene);
    this.pull_line = new PullLine(this.scene);
    this.terrain = new Terrain(() => {
      this.layers.placeAll();
      this.invalidate();
    });
    this.layers = new Layers(this.scene, this.terrain);
    this.goal = new GoalFlag(this.scene);
    this.labels.visible = this.overlays.names;
    this.setTheme('light');
    this.observer = new ResizeObserver(() => this.resize());
    if (this.renderer === null) {
      this.hands = null;
      this.say('This browser gives no WebGL, so there is no 3D view. Everything else on this page works.');
    } else {
      const canvas = this.renderer.domElement;
      canvas.style.cssText = 'position:absolute;inset:0;width:100%;height:100%;display:block;touch-action:none;outline:none;';
      canvas.tabIndex = 0;
      canvas.setAttribute('aria-label', '3D view of the world');
      canvas.dataset.testid = 'scene';
      host.append(canvas);
      canvas.addEventListener('webglcontextlost', (event) => {
        event.preventDefault();
        this.lost = true;
        this.say('The graphics driver has let go of the 3D view. It comes back by itself.');
      });
      canvas.addEventListener('webglcontextrestored', () => {
        this.lost = false;
        this.say('');
        this.renderer!.shadowMap.needsUpdate = true;
        this.invalidate();
      });
      this.hands = new Hands(canvas, this.handsHost());
    }
    host.append(this.message);
    this.observer.observe(host);
    this.resize();
  }

  get cameraMode(): CameraMode {
    return this.rig.mode;
  }

  get tool(): Tool {
    return this.hands?.tool ?? 'orbit';
  }

  setTool(tool: Tool): void {
    if (!this.hands) return;
    if (tool !== 'goal') this.hands.giveUp();
    this.hands.tool = tool;
  }

  setWorld(world: World): void {
    const fresh = world.epoch !== this.epoch;
    const is_first = this.world === null || this.world.name !== world.name;
    this.world = world;
    this.epoch = world.epoch;
    const selected_id = this.selected?.instance.id;
    this.bodies.setWorld(world);
    this.backdrop.setWorld(world, this.bodies, this.assets);
    this.backdrop.setShadows(this.overlays.shadows);
    this.terrain.setWorld(world, this.assets);
    const teams = teamColors(world.instances.map((i) => i.team));
    this.marks.setTeams(teams);
    this.links.setMedia(world.media ?? []);
    const robots = this.bodies.list.filter((b) => b.instance.robot);
    this.trails.setBodies(robots, (body, i) => teams.get(body.instance.team) ?? new THREE.Color().setHSL((0.58 + i * 0.381966) % 1, 0.7, 0.5), fresh);
    if (fresh) {
      this.scans.clear();
      this.marks.clear();
      this.goal.hide();
    }
    // Their bodies may be others now.
    this.links.clear();
    this.scans.keepOnly((path) => this.bodies.devices.has(path));
    // What was selected may be another object now, or gone.
    this.hovered = null;
    this.selected = this.bodyOf(this.selected_address);
    if (selected_id !== undefined && this.selected === null) {
      this.selected_address = null;
      this.onSelect(null);
    }
    if (is_first) {
      this.frameAll();
      this.rig.settle();
    }
    this.touchShadows();
  }

  /** Forgets the world and all assets: for a server that was started anew, whose ids mean other things. */
  reset(): void {
    this.bodies.clear();
    this.assets.forget();
    this.scans.clear();
    this.marks.clear();
    this.links.clear();
    this.batteries.clear();
    this.layers.clear();
    this.terrain.clear();
    this.goal.hide();
    this.trails.setBodies([], () => TRAIL, true);
    this.world = null;
    this.epoch = -1;
    this.hovered = this.selected = null;
    this.selected_address = null;
    this.touchShadows();
  }

  applyPoses(bytes: ArrayBuffer | Uint8Array): void {
    const begin_ms = performance.now();
    const view = bytes instanceof ArrayBuffer ? new DataView(bytes) : new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    if (this.world === null || !readPosesHeader(view, this.header)) return;
    if (this.header.epoch !== (this.world.epoch & 0xffff)) return;
    this.applied_ms = begin_ms;
    this.bodies.glide(this.between.share(begin_ms));
    this.glides = this.between.message(begin_ms);
    this.bodies.restart();
    // A record of a body that is not told yet ends the message; what came before it counts.
    decodePoses(bytes, this.header, this.slot_of, this.on_moved);
    this.trails.advance(this.header.time_s);
    this.dirty = true;
    this.touchShadows();
    this.meter.addScript(performance.now() - begin_ms);
  }

  /**
   * Whether the run plays: only then is there something between two messages.
   * @param step_ms  wall time that a step takes at the present speed
   */
  setPace(playing: boolean, step_ms: number): void {
    this.between.pace(playing, step_ms);
    if (!playing) this.touchShadows();
  }

  select(address: string | null): void {
    this.selected_address = address;
    this.selected = this.bodyOf(address);
    this.invalidate();
  }

  setCamera(mode: CameraMode, target?: string): void {
    if (target !== undefined) this.follow_name = target.split('/')[0];
    else if (this.selected && !this.selected.is_static) this.follow_name = this.selected.instance.name;
    this.rig.setMode(mode, this.subjectNow());
    this.is_overview = false;
    this.invalidate();
  }

  frameAll(keep_heading = false): void {
    const { points, steepness } = overviewOf(this.bodies.list);
    const reach_m = this.rig.frameAll(points, steepness, keep_heading);
    if (!keep_heading) this.overview_reach_m = reach_m;
    this.is_overview = true;
    this.invalidate();
  }

  frame(address: string): void {
    const body = this.bodyOf(address);
    if (body === null) return;
    body.middle(this.middle);
    this.is_overview = false;
    this.rig.frame(new THREE.Vector3().fromArray(this.middle), Math.max(0.15, 1.6 * Math.min(body.radius_m, 60)));
    this.invalidate();
  }

  setOverlays(wanted: Partial<Record<string, boolean>>): void {
    for (const name of OVERLAYS) {
      const show = wanted[name];
      if (show === undefined || show === this.overlays[name]) continue;
      this.overlays[name] = show;
      this.marks.show(name, show);
      if (name === 'names') this.labels.visible = show;
      if (name === 'trails') this.trails.visible = show;
      if (name === 'scans') this.scans.visible = show;
      if (name === 'links') this.links.visible = show;
      if (name === 'batteries') this.batteries.visible = show;
      if (name === 'grid') this.backdrop.setGrid(show);
      if (name === 'shadows') this.backdrop.setShadows(show);
      if (name === 'collisions') this.bodies.setCollisions(show);
      if (name === 'contacts' && show) this.marks.setContacts(this.contacts);
    }
    this.touchShadows();
  }

  /** @param time_s  when it was measured; poses are told at other times, and a beam of 10 m shows a tenth of a radian as a metre */
  setScan(path: string, scan: Scan | null, time_s = NaN): void {
    const found = this.bodies.devices.get(path);
    if (found === undefined) return;
    const begin_ms = performance.now();
    found.body.devicePoseAt(found.device, time_s, this.device_pose);
    this.scans.set(path, scan, this.device_pose);
    this.meter.addScript(performance.now() - begin_ms);
    this.invalidate();
  }

  setRange(path: string, range: RangeReading | null): void {
    this.marks.setRange(path, range);
    this.invalidate();
  }

  /** @param places  in the frame of the device at `path` when it looked; null path: in the world */
  setDetections(topic: string, path: string | null, detections: Detection[] | null, time_s = NaN): void {
    if (path !== null && detections !== null) {
      const found = this.bodies.devices.get(path);
      if (found === undefined) return;
      found.body.devicePoseAt(found.device, time_s, this.device_pose);
      for (const each of detections) transform(this.device_pose, 0, each.place[0], each.place[1], each.place[2], each.place);
    }
    this.marks.setDetections(topic, detections);
    this.invalidate();
  }

  setView(topic: string, path: string, view: CameraView | null): void {
    this.marks.setView(topic, path, view);
    this.invalidate();
  }

  setContacts(bytes: ArrayBuffer | Uint8Array): void {
    if (!decodeContacts(bytes, this.contacts)) return;
    this.marks.setContacts(this.contacts);
    if (this.overlays.contacts) this.invalidate();
  }

  /** Bytes of /sandlot/deliveries. */
  setDeliveries(bytes: ArrayBuffer | Uint8Array): void {
    if (!decodeDeliveries(bytes, this.deliveries) || !this.overlays.links) return;
    this.links.set(this.deliveries, this.bodies.by_id, performance.now());
    this.invalidate();
  }

  /** Bytes of /sandlot/batteries. */
  setBatteries(bytes: ArrayBuffer | Uint8Array): void {
    if (!decodeBatteries(bytes, this.charges)) return;
    this.batteries.set(this.charges);
    if (this.overlays.batteries) this.invalidate();
  }

  /** Draws a layer, or takes it away. @param frame  pose of its frame in the world */
  setLayer(id: string, drawing: Drawing | null, frame: Float64Array, color_index: number): void {
    this.layers.set(id, drawing, frame, color_index);
    this.invalidate();
  }

  /** Time that was spent for the next frame outside of the scene, such as on reading messages. */
  addScript(ms: number): void {
    this.meter.addScript(ms);
  }

  /** How often layers were placed: nothing is when nothing has changed. */
  get layers_placed(): number {
    return this.layers.placed;
  }

  /** Cells that a side of a map may have. */
  get map_side_max(): number {
    return this.renderer?.capabilities.maxTextureSize ?? 4096;
  }

  /** Pose of a frame that is a link or a device, "rover/base_link" or "rover/laser", as it is known now; null: there is none such. */
  framePose(frame: string): Float64Array | null {
    const out = new Float64Array(7);
    const device = this.bodies.devices.get(frame);
    if (device) {
      device.body.devicePose(device.device, out);
      return out;
    }
    const cut = frame.indexOf('/');
    const body = cut < 0 ? undefined : this.bodies.by_name.get(frame.slice(0, cut));
    const link = body?.kin.model.links.findIndex((l) => l.name === frame.slice(cut + 1)) ?? -1;
    if (body === undefined || link < 0) return null;
    out.set(body.world.subarray(7 * link, 7 * link + 7));
    return out;
  }

  /** The flag of the latest goal. */
  showGoal(at: readonly number[] | null, yaw_rad = 0, pointer: readonly number[] | null = null): void {
    if (at) this.goal.show(at, yaw_rad, pointer);
    else this.goal.hide();
    this.invalidate();
  }

  setTheme(theme: Theme): void {
    this.layers.setTheme(theme);
    this.goal.setTheme(theme);
    this.batteries.setTheme(theme);
    this.links.setTheme(theme);
    this.backdrop.setTheme(theme);
    this.labels.setTheme(theme);
    this.outline.setColors(theme === 'light' ? '#0a6cff' : '#5aa9ff', theme === 'light' ? '#ffffff' : '#dbe6f5');
    this.invalidate();
  }

  /** What is at a place of the view, the ground included; null: the sky. */
  pick(x: number, y: number): Picked | null {
    const ray = this.ray(x, y);
    const hit = pickSlots(ray, this.bodies.batches.all);
    const ground = this.groundPoint(ray);
    if (hit && (ground === null || hit.distance_m <= ground.distanceTo(ray.origin) + 1e-3)) {
      const body = hit.slot.owner as Body;
      return { address: body.instance.name, link: body.kin.model.links[hit.slot.link]?.name ?? '', point: hit.point.toArray() };
    }
    return ground ? { address: null, link: '', point: ground.toArray() } : null;
  }

  captureStream(fps: number): MediaStream {
    if (this.renderer === null) throw new Error('there is no 3D view to record');
    this.invalidate();
    return this.renderer.domElement.captureStream(fps);
  }

  screenshot(): Promise<Blob> {
    return new Promise((resolve, reject) => {
      if (this.renderer === null) {
        reject(new Error('there is no 3D view to take a picture of'));
        return;
      }
      // The drawing buffer is gone after this task: draw, then read.
      this.draw(performance.now());
      this.renderer.domElement.toBlob((blob) => (blob ? resolve(blob) : reject(new Error('the picture could not be made'))), 'image/png');
    });
  }

  stats(): SceneStats {
    let instances = 0;
    for (const batch of this.bodies.batches.all) instances += batch.slots.length;
    return { ...this.meter.read(performance.now()), draw_calls: this.draw_calls, triangles: this.triangles, instances };
  }

  /** Latest known pose of an instance's first link; quaternion as w x y z. */
  pose(name: string): { position: [number, number, number]; quaternion: [number, number, number, number] } | null {
    const w = this.bodies.by_name.get(name)?.world;
    return w ? { position: [w[0], w[1], w[2]], quaternion: [w[3], w[4], w[5], w[6]] } : null;
  }

  /** Shows an instance elsewhere until the next message tells its pose: what a drag asks for, before it is answered. */
  override(name: string, position: readonly number[], yaw_rad?: number): void {
    const body = this.bodies.by_name.get(name);
    if (body === undefined || !position.every(Number.isFinite)) return;
    const pose = [position[0], position[1], position[2], body.world[3], body.world[4], body.world[5], body.world[6]];
    if (yaw_rad !== undefined && Number.isFinite(yaw_rad)) {
      const turn = new THREE.Quaternion().setFromAxisAngle(new THREE.Vector3(0, 0, 1), yaw_rad - yawOf(body.world, 0));
      const q = turn.multiply(new THREE.Quaternion(body.world[4], body.world[5], body.world[6], body.world[3]));
      pose.splice(3, 4, q.w, q.x, q.y, q.z);
    }
    body.override(pose, this.bodies.scratch);
    this.bodies.noteMoved(body);
    this.touchShadows();
  }

  dispose(): void {
    this.disposed = true;
    cancelAnimationFrame(this.scheduled);
    this.observer.disconnect();
    this.hands?.dispose();
    this.bodies.clear();
    for (const part of [this.foresight, this.assets, this.backdrop, this.outline, this.labels, this.marks, this.links, this.batteries, this.scans, this.trails, this.pull_line, this.layers, this.goal]) part.dispose();
    this.renderer?.dispose();
    this.renderer?.domElement.remove();
    this.message.remove();
  }

  private readonly slot_of = (id: number): Body | undefined => this.bodies.by_id.get(id);

  private readonly on_moved = (_id: number, slot: unknown): void => {
    const body = slot as Body;
    if (this.bodies.take(body, this.header.time_s, this.glides)) body.told_ms = this.applied_ms;
  };

  private bodyOf(address: string | null): Body | null {
    if (address === null) return null;
    return this.bodies.by_name.get(address) ?? this.bodies.devices.get(address)?.body ?? this.bodies.by_name.get(address.split('/')[0]) ?? null;
  }

  private say(text: string): void {
    this.message.textContent = text;
    this.message.style.display = text === '' ? 'none' : 'flex';
  }

  private touchShadows(): void {
    if (this.renderer) this.renderer.shadowMap.needsUpdate = true;
    this.invalidate();
  }

  private invalidate(): void {
    this.dirty = true;
    if (this.scheduled !== 0 || this.disposed || this.renderer === null) return;
    this.scheduled = requestAnimationFrame(this.on_frame);
  }

  private readonly on_frame = (now_ms: number): void => {
    this.scheduled = 0;
    if (this.lost || this.disposed || !this.dirty) return;
    this.draw(now_ms);
  };

  private draw(now_ms: number): void {
    const renderer = this.renderer;
    if (renderer === null) return;
    const begin_ms = performance.now();
    // After a rest the first step is a usual one, not the whole rest.
    const dt_s = Math.min(0.1, Math.max(0.001, (now_ms - this.last_frame_ms) / 1000));
    this.last_frame_ms = now_ms;
    this.dirty = false;
    const gliding = this.bodies.glide(this.between.share(begin_ms));
    if (this.bodies.update()) this.backdrop.placeLamps();
    if (this.is_overview && now_ms > this.overview_ms + OVERVIEW_MS) {
      this.overview_ms = now_ms;
      // Not after what falls out of the world.
      const may_grow = this.rig.reach_m < 3 * this.overview_reach_m;
      if (may_grow && someLeave(this.bodies.list, this.rig.camera)) this.frameAll(true);
    }
    const changes = this.rig.update(dt_s, this.subjectNow(), this.is_hidden);
    const camera = this.rig.camera;
    camera.updateMatrixWorld();
    camera.matrixWorldInverse.copy(camera.matrixWorld).invert();
    if (this.backdrop.follow(camera, this.rig.focus, this.rig.reach_m, this.width_px < 700 ? 1024 : 2048)) renderer.shadowMap.needsUpdate = true;
    this.marks.update(this.bodies, this.selected);
    this.labels.update(this.labelled(), camera, this.width_px, this.height_px, this.selected, this.lift_px);
    this.batteries.update(this.bodies.by_id, this.width_px, this.height_px);
    this.layers.update(this.width_px, this.height_px);
    const fading = this.links.update(performance.now(), this.width_px, this.height_px);
    this.drawPull();
    const scripted_ms = performance.now();
    renderer.info.reset();
    renderer.render(this.scene, camera);
    this.draw_calls = renderer.info.render.calls;
    this.triangles = renderer.info.render.triangles;
    this.outline.render(renderer, camera, this.selected, this.hands?.isDragging ? null : this.hovered, 1.6 * renderer.getPixelRatio());
    const done_ms = performance.now();
    this.meter.frame(done_ms, scripted_ms - begin_ms, done_ms - scripted_ms);
    if (gliding) this.touchShadows();
    else if (changes || fading) this.invalidate();
  }

  private readonly labelled_list: Body[] = [];
  private labelled(): Body[] {
    const list = this.labelled_list;
    list.length = 0;
    if (!this.labels.visible) return list;
    for (const body of this.bodies.list) if (body.instance.robot || body === this.selected) list.push(body);
    return list;
  }

  private readonly lift_px = (body: Body): number => (this.batteries.has(body.instance.id) ? BAR_PX : 0);

  private drawPull(): void {
    const pull = this.hands?.pull ?? null;
    const body = pull ? this.bodies.by_name.get(pull.name) : undefined;
    if (!pull || !body) {
      this.pull_line.hide();
      return;
    }
    const link = Math.max(0, body.kin.model.links.findIndex((l) => l.name === pull.link));
    transform(body.world, 7 * link, ...pull.in_link, this.point);
    this.pull_line.show(this.point, pull.target, this.rig.reach_m);
  }

  /** The robot that cameras keep to: the one asked for, else the selected, else the first. */
  private subjectNow(): Subject | null {
    let body = this.follow_name === null ? undefined : this.bodies.by_name.get(this.follow_name);
    body ??= this.selected && !this.selected.is_static ? this.selected : this.bodies.list.find((b) => b.instance.robot);
    if (body === undefined) return null;
    const s = this.subject;
    body.middle(this.middle);
    s.position.fromArray(this.middle);
    s.yaw_rad = yawOf(body.world, 0);
    s.radius_m = body.radius_m;
    if (this.rig.mode === 'robot') {
      const camera = body.instance.devices.find((d) => d.kind.startsWith('camera'));
      let pose: Float64Array = body.world;
      if (camera) body.devicePose(camera, (pose = this.device_pose));
      // Without a camera: from the front of the base, two thirds up.
      const b = body.bounds;
      if (camera) transform(pose, 0, 0.01, 0, 0, this.point);
      else transform(pose, 0, b.max.x + 0.02, (b.min.y + b.max.y) / 2, b.min.z + 0.7 * (b.max.z - b.min.z), this.point);
      s.eye.fromArray(this.point);
      TURN.set(pose[4], pose[5], pose[6], pose[3]);
      s.forward.set(1, 0, 0).applyQuaternion(TURN);
      s.up.set(0, 0, 1).applyQuaternion(TURN);
    }
    return s;
  }

  private readonly is_hidden = (from: THREE.Vector3, to: THREE.Vector3): boolean => {
    const ray = new THREE.Ray(from, to.clone().sub(from).normalize());
    const hit = pickSlots(ray, this.bodies.batches.all);
    return hit !== null && hit.distance_m < from.distanceTo(to) - 1.5 * this.subject.radius_m;
  };

  private ray(x: number, y: number): THREE.Ray {
    this.pointer.set((x / this.width_px) * 2 - 1, 1 - (y / this.height_px) * 2);
    this.raycaster.setFromCamera(this.pointer, this.rig.camera);
    return this.raycaster.ray;
  }

  private groundPoint(ray: THREE.Ray): THREE.Vector3 | null {
    const point = ray.intersectPlane(GROUND, new THREE.Vector3());
    return point && point.distanceTo(ray.origin) < 2000 ? point : null;
  }

  private gripAt(x: number, y: number): Grip | null {
    const hit = pickSlots(this.ray(x, y), this.bodies.batches.all);
    if (hit === null) return null;
    const body = hit.slot.owner as Body;
    if (body.is_static) return null;
    const inverse = new Float64Array(7);
    invert(body.world, 7 * hit.slot.link, inverse, 0);
    transform(inverse, 0, hit.point.x, hit.point.y, hit.point.z, this.point);
    return {
      name: body.instance.name,
      link: body.kin.model.links[hit.slot.link]?.name ?? '',
      at: hit.point,
      in_link: [this.point[0], this.point[1], this.point[2]],
      base: new THREE.Vector3(body.world[0], body.world[1], body.world[2]),
      yaw_rad: yawOf(body.world, 0),
    };
  }

  private handsHost(): ConstructorParameters<typeof Hands>[1] {
    const canvas = this.renderer!.domElement;
    return {
      ray: (x, y) => this.ray(x, y),
      grip: (x, y) => this.gripAt(x, y),
      isSelected: (name) => this.selected?.instance.name === name,
      selectAt: (x, y) => {
        const address = this.pick(x, y)?.address ?? null;
        this.select(address);
        this.onSelect(address);
      },
      frameAt: (x, y) => {
        const address = this.pick(x, y)?.address;
        if (address) this.frame(address);
      },
      hoverAt: (x, y) => {
        const address = this.pick(x, y)?.address ?? null;
        const body = this.bodyOf(address);
        canvas.style.cursor = this.tool === 'goal' ? 'crosshair' : body === null ? 'default' : body.is_static || this.tool === 'orbit' ? 'pointer' : 'grab';
        if (body === this.hovered) return;
        this.hovered = body;
        this.invalidate();
      },
      leave: () => {
        this.hovered = null;
        this.invalidate();
      },
      orbit: (dx, dy) => {
        this.is_overview = false;
        this.rig.orbit(dx, dy);
        this.invalidate();
      },
      pan: (dx, dy) => {
        this.is_overview = false;
        this.rig.pan(dx, dy, this.height_px);
        this.invalidate();
      },
      zoom: (factor, x, y) => {
        this.is_overview = false;
        this.rig.zoom(factor, this.rig.mode === 'follow' ? null : this.zoomPoint(x, y));
        this.invalidate();
      },
      drag: (drag) => {
        this.foresight.drag(drag);
        this.onDrag(drag);
        this.invalidate();
      },
      groundAt: (x, y) => {
        const point = this.pick(x, y)?.point;
        return point ? new THREE.Vector3(...point) : null;
      },
      aim: (aim) => this.onAim(aim),
      viewDirection: () => this.rig.camera.getWorldDirection(new THREE.Vector3()),
    };
  }

  /** What is under the cursor, or the middle of the view where that is far away. */
  private zoomPoint(x: number, y: number): THREE.Vector3 | null {
    const picked = this.pick(x, y);
    if (picked === null) return null;
    const point = new THREE.Vector3(...picked.point);
    return point.distanceTo(this.rig.focus) < 4 * this.rig.reach_m ? point : null;
  }

  private resize(): void {
    const width = Math.max(1, this.host.clientWidth);
    const height = Math.max(1, this.host.clientHeight);
    this.width_px = width;
    this.height_px = height;
    const ratio = Math.min(MOST_PIXELS_PER_CSS_PIXEL, window.devicePixelRatio || 1);
    this.renderer?.setPixelRatio(ratio);
    this.renderer?.setSize(width, height, false);
    this.scans.setPointSize(4.5 * ratio);
    this.rig.setAspect(width / height);
    if (this.is_overview) this.frameAll();
    // Drawn at once: a canvas that has been resized is empty until then, which flickers.
    if (this.renderer && !this.lost && this.world) this.draw(performance.now());
    this.invalidate();
  }
}

const GROUND = new THREE.Plane(new THREE.Vector3(0, 0, 1), 0);
const TURN = new THREE.Quaternion();
const TRAIL = new THREE.Color();
