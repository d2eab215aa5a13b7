// Marks at bodies and devices: frames, team rings, velocities, contacts, camera pyramids, cones and beams of ranges.
import * as THREE from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import type { Contacts } from '../../binary';
import type { Bodies, Body } from '../bodies';
import { composeMatrix, yawOf } from '../poses';
import { Beams } from './beams';
import { alongMatrix, arrowGeometry, axesGeometry, Stamps } from './stamps';

export interface RangeReading {
  range: number;
  min_range: number;
  max_range: number;
  field_of_view: number;
}

/** What a detector tells of one thing, its place in the world. */
export interface Detection {
  place: [number, number, number];
  color: { r: number; g: number; b: number };
}

/** What a camera says of its lens (sensor_msgs/CameraInfo). */
export interface CameraView {
  width: number;
  height: number;
  fx: number;
  fy: number;
  /** Of the right one of a pair: its place, to the left. */
  left_m: number;
  /** A lens that sees all round, or wider than a pyramid can show. */
  round: boolean;
}

/** Colours that stay apart for most colour-blind eyes and on both themes. */
const TEAM_COLORS = ['#e5484d', '#3e7bfa', '#f5a524', '#30a46c', '#8e4ec6', '#12a5c9', '#e93d82', '#978365'];

/** One colour per team, by the order of the names, so that all viewers see the same. */
export function teamColors(names: Iterable<string>): Map<string, THREE.Color> {
  const sorted = [...new Set(names)].filter((n) => n !== '').sort();
  return new Map(sorted.map((name, i) => [name, new THREE.Color(NAMED[name.toLowerCase()] ?? TEAM_COLORS[i % TEAM_COLORS.length])]));
}

/** A team that is called by a colour has it. */
const NAMED: Record<string, string> = {
  red: TEAM_COLORS[0], blue: TEAM_COLORS[1], yellow: '#f2c40f', orange: TEAM_COLORS[2], green: TEAM_COLORS[3], purple: TEAM_COLORS[4], pink: TEAM_COLORS[6],
  cyan: TEAM_COLORS[5], magenta: '#d6189b', white: '#e8e8e8', black: '#202428',
};

/** Above so many link frames the picture would be all arrows. */
const MOST_FRAMES = 2000;
const MOST_DETECTIONS = 5000;
const FLAT = 0.7;

export class Marks {
  private readonly frames: Stamps;
  private readonly rings: Stamps;
  private readonly velocities: Stamps;
  private readonly contacts: Stamps;
  private readonly pyramids: Stamps;
  private readonly circles: Stamps;
  private readonly diamonds: Stamps;
  private readonly cones: Stamps;
  private readonly beams: Beams;
  private readonly all: Record<string, Stamps>;
  private readonly ranges = new Map<string, RangeReading>();
  private readonly detections = new Map<string, Detection[]>();
  private readonly views = new Map<string, {path: string; view: CameraView}>();
  private readonly shown: Record<string, boolean> = { teams: true, ranges: true, objects: true };
  private teams = new Map<string, THREE.Color>();
  private readonly paint = new THREE.Color();
  private readonly pose = new Float64Array(7);
  private readonly local = Float64Array.of(1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0);

  constructor(root: THREE.Object3D) {
    const flat = (color: string, opacity: number, more: THREE.MeshBasicMaterialParameters = {}): THREE.MeshBasicMaterial =>
      new THREE.MeshBasicMaterial({ color, transparent: true, opacity, depthWrite: false, toneMapped: false, fog: false, ...more });
    this.frames = new Stamps(root, axesGeometry(), new THREE.MeshBasicMaterial({ vertexColors: true, toneMapped: false, depthTest: false, transparent: true, opacity: 0.95 }));
    this.rings = new Stamps(root, new THREE.RingGeometry(0.93, 1, 64), flat('#ffffff', 0.8, { side: THREE.DoubleSide }), true);
    this.velocities = new Stamps(root, arrowGeometry(0.05, 0.13, 0.28), flat('#18a058', 0.95, { depthTest: false }));
    this.contacts = new Stamps(root, arrowGeometry(0.06, 0.16, 0.36), flat('#f5a524', 0.95, { depthTest: false }));
    this.pyramids = new Stamps(root, pyramidGeometry(), flat('#6aa5ff', 0.5, { side: THREE.DoubleSide }));
    this.diamonds = new Stamps(root, new THREE.OctahedronGeometry(0.09), flat('#ffffff', 0.75, { depthTest: false }), true);
    this.circles = new Stamps(root, new THREE.TorusGeometry(1, 0.006, 6, 72), flat('#6aa5ff', 0.5));
    this.cones = new Stamps(root, coneGeometry(), flat('#37c2d6', 0.15, { side: THREE.DoubleSide }));
    this.beams = new Beams(root);
    this.all = { frames: this.frames, teams: this.rings, velocity: this.velocities, contacts: this.contacts, frusta: this.pyramids, circles: this.circles, objects: this.diamonds, ranges: this.cones };
    for (const [name, stamps] of Object.entries(this.all)) {
      stamps.visible = this.shown[name] ?? false;
      stamps.mesh.renderOrder = name === 'frames' || name === 'contacts' ? 12 : 4;
    }
  }

  show(name: string, show: boolean): void {
    this.shown[name] = show;
    const stamps = this.all[name];
    if (stamps) stamps.visible = show;
    if (name === 'frusta') this.circles.visible = show;
    if (name === 'ranges') this.beams.visible = show;
  }

  /** @param topic  that told of the view; `path`: of its device */
  setView(topic: string, path: string, view: CameraView | null): void {
    if (view) this.views.set(topic, {path, view});
    else this.views.delete(topic);
  }

  setTeams(teams: Map<string, THREE.Color>): void {
    this.teams = teams;
  }

  setRange(path: string, range: RangeReading | null): void {
    if (range) this.ranges.set(path, range);
    else this.ranges.delete(path);
  }

  /** @param source  the topic that told of them */
  setDetections(source: string, detections: Detection[] | null): void {
    if (detections) this.detections.set(source, detections);
    else this.detections.delete(source);
    this.diamonds.begin();
    for (const { place, color } of [...this.detections.values()].flat().slice(0, MOST_DETECTIONS)) {
      if (!Number.isFinite(place[0] + place[1] + place[2])) continue;
      const o = this.diamonds.next();
      this.diamonds.color(this.paint.setRGB(color.r, color.g, color.b, THREE.SRGBColorSpace));
      this.setScale(1, 1, 1);
      this.pose.set([...place, 1, 0, 0, 0]);
      composeMatrix(this.pose, 0, this.local, this.diamonds.matrices, o);
    }
    this.diamonds.end();
  }

  setContacts(contacts: Contacts): void {
    if (!this.shown.contacts) return;
    this.contacts.begin();
    const v = contacts.values;
    for (let i = 0; i < Math.min(contacts.count, 5000); ++i) {
      const o = 7 * i;
      if (!Number.isFinite(v[o] + v[o + 1] + v[o + 2] + v[o + 3] + v[o + 4] + v[o + 5] + v[o + 6])) continue;
      // A millimetre deep is usual; a deeper contact is longer, in reason.
      const length_m = Math.min(0.4, 0.1 + 20 * Math.max(0, v[o + 6]));
      alongMatrix(this.contacts.matrices, this.contacts.next(), v[o], v[o + 1], v[o + 2], v[o + 3], v[o + 4], v[o + 5], length_m, 0.1);
    }
    this.contacts.end();
  }

  clear(): void {
    this.ranges.clear();
    this.views.clear();
    this.detections.clear();
    this.diamonds.begin();
    this.diamonds.end();
    this.contacts.begin();
    this.contacts.end();
  }

  /** Writes what follows bodies; `selected` limits frames in a crowd. */
  update(bodies: Bodies, selected: Body | null): void {
    if (this.shown.teams) this.writeRings(bodies);
    if (this.shown.velocity) this.writeVelocities(bodies);
    if (this.shown.frames) this.writeFrames(bodies, selected);
    if (this.shown.frusta) this.writePyramids(bodies);
    if (this.shown.ranges) this.writeCones(bodies);
  }

  dispose(): void {
    for (const stamps of Object.values(this.all)) stamps.dispose();
    this.beams.dispose();
  }

  private writeRings(bodies: Bodies): void {
    this.rings.begin();
    for (let n = 0; n < bodies.list.length; ++n) {
      const body = bodies.list[n];
      const color = this.teams.get(body.instance.team);
      if (color === undefined) continue;
      const o = this.rings.next();
      this.rings.color(color);
      const b = body.bounds;
      const radius_m = 0.62 * Math.max(Math.hypot(b.max.x - b.min.x, b.max.y - b.min.y), 0.1);
      const yaw = yawOf(body.world, 0);
      const cx = (b.min.x + b.max.x) / 2, cy = (b.min.y + b.max.y) / 2;
      const c = Math.cos(yaw), s = Math.sin(yaw);
      const m = this.rings.matrices;
      m.fill(0, o, o + 16);
      m[o] = m[o + 5] = m[o + 10] = radius_m;
      m[o + 12] = body.world[0] + c * cx - s * cy;
      m[o + 13] = body.world[1] + s * cx + c * cy;
      m[o + 14] = body.world[2] + b.min.z + 0.006;
      m[o + 15] = 1;
    }
    this.rings.end();
  }

  private writeVelocities(bodies: Bodies): void {
    this.velocities.begin();
    for (const body of bodies.list) {
      const [x, y, z] = body.velocity;
      const speed = Math.hypot(x, y, z);
      if (body.is_static || speed < 0.01) continue;
      const length_m = Math.min(4, speed);
      const lift = (body.bounds.min.z + body.bounds.max.z) / 2;
      alongMatrix(this.velocities.matrices, this.velocities.next(), body.world[0], body.world[1], body.world[2] + lift, x, y, z, length_m, Math.min(0.5, 0.25 + 0.2 * length_m));
    }
    this.velocities.end();
  }

  private writeFrames(bodies: Bodies, selected: Body | null): void {
    this.frames.begin();
    const crowd = bodies.list.length > 200;
    let count = 0;
    for (const body of bodies.list) {
      if (body.is_static || (crowd && body !== selected)) continue;
      const size = Math.min(0.6, Math.max(0.06, 0.45 * body.radius_m));
      for (let link = 0; link < body.kin.chain.links && count < MOST_FRAMES; ++link, ++count) {
        this.setScale(size, size, size);
        composeMatrix(body.world, 7 * link, this.local, this.frames.matrices, this.frames.next());
      }
      for (const device of body.instance.devices) {
        if (count++ >= MOST_FRAMES) break;
        body.devicePose(device, this.pose);
        this.setScale(size * FLAT, size * FLAT, size * FLAT);
        composeMatrix(this.pose, 0, this.local, this.frames.matrices, this.frames.next());
      }
    }
    this.frames.end();
  }

  private writePyramids(bodies: Bodies): void {
    this.pyramids.begin();
    this.circles.begin();
    for (const { path, view } of this.views.values()) {
      const found = bodies.devices.get(path);
      if (found === undefined) continue;
      found.body.devicePose(found.device, this.pose);
      this.local[10] = view.left_m;
      if (view.round) {
        this.setScale(0.6, 0.6, 0.6);
        composeMatrix(this.pose, 0, this.local, this.circles.matrices, this.circles.next());
      } else {
        // A metre deep.
        this.setScale(1, view.width / view.fx, view.height / view.fy);
        composeMatrix(this.pose, 0, this.local, this.pyramids.matrices, this.pyramids.next());
      }
      this.local[10] = 0;
    }
    this.pyramids.end();
    this.circles.end();
  }

  private writeCones(bodies: Bodies): void {
    this.cones.begin();
    const drawn = new Set<string>();
    for (const [path, reading] of this.ranges) {
      const found = bodies.devices.get(path);
      if (found === undefined) continue;
      const reach_m = Number.isFinite(reading.range) ? Math.max(0, reading.range) : reading.range === Infinity ? reading.max_range : 0;
      if (!(reach_m > 0) || !Number.isFinite(reach_m)) continue;
      found.body.devicePose(found.device, this.pose);
      this.beams.set(path, this.pose, reach_m, reading.range);
      drawn.add(path);
      const half = Math.tan(Math.min(1.4, Math.max(0.01, reading.field_of_view / 2 || 0.05)));
      this.setScale(reach_m, reach_m * half, reach_m * half);
      composeMatrix(this.pose, 0, this.local, this.cones.matrices, this.cones.next());
    }
    this.cones.end();
    this.beams.keepOnly((path) => drawn.has(path));
  }

  private setScale(x: number, y: number, z: number): void {
    this.local[0] = x;
    this.local[4] = y;
    this.local[8] = z;
  }
}

/** Apex at the origin, looking along x; 1 deep, wide and high: thin bars along the edges, and a faint far side. */
function pyramidGeometry(): THREE.BufferGeometry {
  const corners = [[1, -0.5, -0.5], [1, 0.5, -0.5], [1, 0.5, 0.5], [1, -0.5, 0.5]].map((p) => new THREE.Vector3(...p));
  const apex = new THREE.Vector3();
  const bars: THREE.BufferGeometry[] = [];
  const bar = (a: THREE.Vector3, b: THREE.Vector3): void => {
    const length = a.distanceTo(b);
    const geometry = new THREE.CylinderGeometry(0.006, 0.006, length, 6).translate(0, length / 2, 0);
    geometry.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), b.clone().sub(a).normalize()));
    bars.push(geometry.translate(a.x, a.y, a.z));
  };
  corners.forEach((corner, i) => {
    bar(apex, corner);
    bar(corner, corners[(i + 1) % 4]);
  });
  return mergeGeometries(bars) ?? bars[0];
}

/** Apex at the origin, along x, radius 1 at 1. */
function coneGeometry(): THREE.BufferGeometry {
  return new THREE.ConeGeometry(1, 1, 28, 1, false).translate(0, -0.5, 0).rotateZ(Math.PI / 2);
}
