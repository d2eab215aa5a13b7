// What programs publish about places: maps, plans, particles, and poses with how sure they are.
//
// Frame    drawings are in frames of their own; where those lie in the world comes with them. What has the height 0 lies on the ground,
//          over hills too; other heights are kept.
// Cost     a drawing is placed when it, its frame or the terrain has changed; nothing is done per frame.
import * as THREE from 'three';
import { groundEllipse } from '../ellipse';
import { multiply, transform, yawOf } from '../poses';
import type { Terrain } from '../terrain';
import { Darts } from './darts';
import { MapSheet } from './map_sheet';
import { Ribbons, rim_color, view_px } from './ribbons';

export type Drawing =
  | { kind: 'map'; width: number; height: number; resolution_m: number; origin: Float64Array; cells: Uint8Array }
  /** Seven numbers per pose, as a Pose. */
  | { kind: 'path' | 'particles'; poses: Float64Array }
  /** Nine numbers of the position's covariance; null: not known. */
  | { kind: 'pose'; pose: Float64Array; covariance: Float64Array | null; heading_rad: number };

/** Colours of layers that have one, for a light and a dark page: told apart next to each other, and on grey, earth and grass. */
export const LAYER_COLORS: readonly [light: string, dark: string][] = [
  ['#1767d8', '#5aa7ff'], ['#d24a00', '#ff9640'], ['#8e35c9', '#c58bff'], ['#c2136f', '#ff74bd'], ['#007a83', '#35d6de'], ['#8a6200', '#f2c832'], ['#c01f2e', '#ff7a72'], ['#3d4ed1', '#93a0ff'], ['#00804a', '#48d597'], ['#5b616c', '#b9c1cd'],
];

const PLAN_PX = 3.5;
const OUTLINE_PX = 2;
/** Plans of so few poses show each of them. */
const DOTS = 200;
const DOT_PX = 8;
/** A plan follows the terrain in stretches of this length. */
const STRETCH_M = 0.25;
const MOST_STRETCHES = 40_000;
const PLAN_ABOVE_M = 0.04;
const POSE_ABOVE_M = 0.03;
const ELLIPSE_STEPS = 72;
const FAN_STEPS = 16;
const FAN_M = 1.1;
const POSE_M = 0.5;
const POSE_PX = 24;
const POSE_SHRINK = 0.82;
const PARTICLE_M = 0.16;
const PARTICLE_PX = 6;
const MOST_PARTICLES = 5_000;

interface Shown {
  drawing: Drawing;
  frame: Float64Array;
  color: { value: THREE.Color };
  color_index: number;
  order: number;
  ribbons?: Ribbons;
  darts?: Darts;
  sheet?: MapSheet;
  fill?: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
  fan?: THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
}

export class Layers {
  private readonly group = new THREE.Group();
  private readonly shown = new Map<string, Shown>();
  private readonly dark = { value: 0 };
  private readonly disc = new THREE.CircleGeometry(1, ELLIPSE_STEPS);
  private readonly at = new Float64Array(7);
  private readonly p = [0, 0, 0];
  private readonly q = [0, 0, 0];
  /** How often something was placed, for tests. */
  placed = 0;

  constructor(private readonly parent: THREE.Object3D, private readonly terrain: Terrain) {
    this.group.name = 'layers';
    parent.add(this.group);
  }

  /** @param frame  pose of the drawing's frame in the world */
  set(id: string, drawing: Drawing | null, frame: Float64Array, color_index: number): void {
    const before = this.shown.get(id);
    if (before && (drawing === null || drawing.kind !== before.drawing.kind || color_index !== before.color_index)) this.remove(id);
    if (drawing === null) return;
    let shown = this.shown.get(id);
    if (shown) {
      Object.assign(shown, { drawing, frame });
    } else {
      const [light, dark] = LAYER_COLORS[color_index % LAYER_COLORS.length];
      shown = { drawing, frame, color_index, color: { value: new THREE.Color(this.dark.value ? dark : light) }, order: this.orderOf(drawing.kind) };
      this.shown.set(id, shown);
    }
    this.place(shown);
  }

  clear(): void {
    for (const id of [...this.shown.keys()]) this.remove(id);
  }

  /** After heights have come. */
  placeAll(): void {
    for (const shown of this.shown.values()) this.place(shown);
  }

  setTheme(theme: 'light' | 'dark'): void {
    this.dark.value = theme === 'dark' ? 1 : 0;
    rim_color.value.set(theme === 'dark' ? '#0b0e14' : '#ffffff');
    for (const { color, color_index, fill, fan } of this.shown.values()) {
      color.value.set(LAYER_COLORS[color_index % LAYER_COLORS.length][this.dark.value]);
      fill?.material.color.copy(color.value);
      fan?.material.color.copy(color.value);
    }
  }

  update(width_px: number, height_px: number): void {
    view_px.value.set(width_px, height_px);
  }

  dispose(): void {
    this.clear();
    this.disc.dispose();
    this.parent.remove(this.group);
  }

  private orderOf(kind: Drawing['kind']): number {
    // Maps below plans below particles below poses; within a kind as they come, each in a place of its own.
    let order = { map: 1, path: 20, particles: 60, pose: 70 }[kind];
    const taken = new Set([...this.shown.values()].map((s) => s.order));
    while (taken.has(order)) order += 4;
    return order;
  }

  private remove(id: string): void {
    const shown = this.shown.get(id);
    this.shown.delete(id);
    shown?.ribbons?.dispose();
    shown?.darts?.dispose();
    shown?.sheet?.dispose();
    for (const mesh of [shown?.fill, shown?.fan]) {
      if (!mesh) continue;
      this.group.remove(mesh);
      mesh.material.dispose();
      if (mesh.geometry !== this.disc) mesh.geometry.dispose();
    }
  }

  /** A point of the frame in the world. What has no height lies on the ground, `above_m` over it. */
  private point(frame: Float64Array, x: number, y: number, z: number, above_m: number, out: number[]): void {
    transform(frame, 0, x, y, z, out);
    if (z === 0) out[2] = this.terrain.heightAt(out[0], out[1]) + above_m;
  }

  private place(shown: Shown): void {
    ++this.placed;
    const { drawing } = shown;
    if (drawing.kind === 'map') this.placeMap(shown, drawing);
    else if (drawing.kind === 'pose') this.placePose(shown, drawing);
    else if (drawing.kind === 'path') this.placePath(shown, drawing.poses);
    else this.placeParticles(shown, drawing.poses);
  }

  private placeMap(shown: Shown, map: Extract<Drawing, { kind: 'map' }>): void {
    shown.sheet ??= new MapSheet(this.group, this.dark, shown.order);
    multiply(shown.frame, 0, map.origin, 0, this.at, 0);
    const flat = map.origin[2] === 0;
    const above_m = 0.004 + 0.001 * (shown.order - 1);
    shown.sheet.set(map.width, map.height, map.resolution_m, map.cells, (x, y, out) => {
      transform(this.at, 0, x, y, 0, out);
      // Hills are between the sheet's corners, too: higher above them than a plane.
      if (flat) out[2] = this.terrain.heightAt(out[0], out[1]) + (this.terrain.is_there ? 0.03 : above_m);
    }, flat && this.terrain.is_there);
  }

  private placePath(shown: Shown, poses: Float64Array): void {
    const ribbons = (shown.ribbons ??= new Ribbons(this.group, shown.color, shown.order));
    const count = poses.length / 7;
    const { p, q } = this;
    ribbons.begin();
    let budget = MOST_STRETCHES - count;
    for (let i = 0; i + 1 < count; ++i) {
      const a = 7 * i, b = 7 * (i + 1);
      const [x0, y0, z0, x1, y1, z1] = [poses[a], poses[a + 1], poses[a + 2], poses[b], poses[b + 1], poses[b + 2]];
      const follows = this.terrain.is_there && z0 === 0 && z1 === 0;
      const steps = follows ? Math.max(1, Math.min(budget, Math.ceil(Math.hypot(x1 - x0, y1 - y0) / STRETCH_M))) : 1;
      budget -= steps - 1;
      this.point(shown.frame, x0, y0, z0, PLAN_ABOVE_M, p);
      for (let s = 1; s <= steps; ++s) {
        const t = s / steps;
        this.point(shown.frame, x0 + t * (x1 - x0), y0 + t * (y1 - y0), s === steps ? z1 : z0 + t * (z1 - z0), PLAN_ABOVE_M, q);
        ribbons.add(p[0], p[1], p[2], q[0], q[1], q[2], PLAN_PX);
        [p[0], p[1], p[2]] = q;
      }
    }
    if (count <= DOTS) {
      for (let i = 0; i < count; ++i) {
        this.point(shown.frame, poses[7 * i], poses[7 * i + 1], poses[7 * i + 2], PLAN_ABOVE_M, p);
        ribbons.add(p[0], p[1], p[2], p[0], p[1], p[2], DOT_PX);
      }
    }
    ribbons.end();
  }

  private placeParticles(shown: Shown, poses: Float64Array): void {
    shown.darts ??= new Darts(this.group, MOST_PARTICLES, shown.color, shown.order, PARTICLE_M, PARTICLE_PX);
    const values = new Float32Array((4 * poses.length) / 7);
    for (let i = 0; 7 * i < poses.length; ++i) {
      multiply(shown.frame, 0, poses, 7 * i, this.at, 0);
      this.point(shown.frame, poses[7 * i], poses[7 * i + 1], poses[7 * i + 2], POSE_ABOVE_M, this.p);
      values.set([this.p[0], this.p[1], this.p[2], yawOf(this.at, 0)], 4 * i);
    }
    shown.darts.set(values);
  }

  private placePose(shown: Shown, { pose, covariance, heading_rad }: Extract<Drawing, { kind: 'pose' }>): void {
    // Estimates that agree lie on each other: those on top are smaller.
    const size = POSE_SHRINK ** Math.min(6, (shown.order - 70) / 4);
    const darts = (shown.darts ??= new Darts(this.group, 1, shown.color, shown.order + 2, POSE_M * size, POSE_PX * size));
    multiply(shown.frame, 0, pose, 0, this.at, 0);
    const yaw = yawOf(this.at, 0);
    this.point(shown.frame, pose[0], pose[1], pose[2], POSE_ABOVE_M, this.p);
    const [x, y, z] = this.p;
    darts.set([x, y, z, yaw]);
    const ribbons = (shown.ribbons ??= new Ribbons(this.group, shown.color, shown.order));
    ribbons.begin();
    const ellipse = covariance && groundEllipse(covariance, shown.frame);
    if (ellipse) {
      const [c, s] = [Math.cos(ellipse.turn_rad), Math.sin(ellipse.turn_rad)];
      // One that is nearly a line, or a point, is still seen.
      const a = Math.max(ellipse.major_m, 0.01), b = Math.max(ellipse.minor_m, 0.01);
      const edge = (i: number): [number, number] => {
        const [u, v] = [a * Math.cos((2 * Math.PI * i) / ELLIPSE_STEPS), b * Math.sin((2 * Math.PI * i) / ELLIPSE_STEPS)];
        return [x + c * u - s * v, y + s * u + c * v];
      };
      for (let i = 0; i < ELLIPSE_STEPS; ++i) ribbons.add(...edge(i), z, ...edge(i + 1), z, OUTLINE_PX);
      shown.fill ??= this.addFill(this.disc, shown, 0.2);
      shown.fill.matrix.set(c * a, -s * b, 0, x, s * a, c * b, 0, y, 0, 0, 1, z, 0, 0, 0, 1);
      shown.fill.matrixWorldNeedsUpdate = true;
    }
    if (shown.fill) shown.fill.visible = ellipse !== null;
    ribbons.end();
    if (heading_rad > 0) {
      if (!shown.fan) {
        const geometry = new THREE.BufferGeometry();
        geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * (FAN_STEPS + 2)), 3).setUsage(THREE.DynamicDrawUsage));
        geometry.setIndex(Array.from({ length: FAN_STEPS }, (_, i) => [0, i + 1, i + 2]).flat());
        shown.fan = this.addFill(geometry, shown, 0.35);
      }
      const position = shown.fan.geometry.getAttribute('position') as THREE.BufferAttribute;
      position.setXYZ(0, x, y, z);
      for (let i = 0; i <= FAN_STEPS; ++i) {
        const angle = yaw + heading_rad * ((2 * i) / FAN_STEPS - 1);
        position.setXYZ(i + 1, x + FAN_M * Math.cos(angle), y + FAN_M * Math.sin(angle), z);
      }
      position.needsUpdate = true;
    }
    if (shown.fan) shown.fan.visible = heading_rad > 0;
  }

  private addFill(geometry: THREE.BufferGeometry, shown: Shown, opacity: number): THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial> {
    const mesh = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({
      color: shown.color.value, transparent: true, opacity, depthWrite: false, side: THREE.DoubleSide, toneMapped: false, fog: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -8,
    }));
    mesh.matrixAutoUpdate = false;
    mesh.frustumCulled = false;
    mesh.renderOrder = shown.order - 1;
    this.group.add(mesh);
    return mesh;
  }
}
