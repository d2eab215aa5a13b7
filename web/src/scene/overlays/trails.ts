// The way each robot went: the last 600 places, all in one line object.
//
// Places are kept by time, not by robot: what one moment adds lies side by side and is one small upload, whatever the
// number of robots. The ring's oldest moment is written over.
import * as THREE from 'three';
import type { Body } from '../bodies';

const MOMENTS = 600;
const EVERY_S = 0.1;
/** A longer jump is none that was driven: no line is drawn. */
const JUMP_M = 3;

export class Trails {
  private lines: THREE.LineSegments<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;
  private bodies: Body[] = [];
  private last = new Float32Array(0);
  private moment = 0;
  private next_s = -Infinity;
  private shown = false;
  private readonly material: THREE.ShaderMaterial;

  constructor(private readonly parent: THREE.Object3D) {
    this.material = new THREE.ShaderMaterial({
      transparent: true,
      depthWrite: false,
      uniforms: { now: { value: 0 } },
      vertexShader: `attribute float moment; attribute vec3 tint; uniform float now; varying vec4 shade;
        void main() {
          float age = (now - moment) / ${MOMENTS.toFixed(1)};
          shade = vec4(tint, moment < 0.0 || age > 1.0 ? 0.0 : 0.9 * (1.0 - age));
          gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
        }`,
      fragmentShader: `varying vec4 shade;
        void main() { if (shade.a < 0.01) discard; gl_FragColor = shade;
          #include <colorspace_fragment>
        }`,
    });
  }

  setBodies(bodies: Body[], colorOf: (body: Body, index: number) => THREE.Color, fresh: boolean): void {
    if (!fresh && bodies.length === this.bodies.length && bodies.every((b, i) => b === this.bodies[i])) return;
    this.bodies = bodies;
    this.free();
    this.moment = 0;
    this.next_s = -Infinity;
    this.last = new Float32Array(3 * bodies.length).fill(NaN);
    if (bodies.length === 0) return;
    const count = 2 * MOMENTS * bodies.length;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * count), 3).setUsage(THREE.DynamicDrawUsage));
    geometry.setAttribute('moment', new THREE.BufferAttribute(new Float32Array(count).fill(-1), 1).setUsage(THREE.DynamicDrawUsage));
    const tints = new Uint8Array(3 * count);
    bodies.forEach((body, b) => {
      const color = colorOf(body, b);
      const rgb = [color.r * 255, color.g * 255, color.b * 255];
      for (let m = 0; m < MOMENTS; ++m) {
        tints.set(rgb, 6 * (m * bodies.length + b));
        tints.set(rgb, 6 * (m * bodies.length + b) + 3);
      }
    });
    geometry.setAttribute('tint', new THREE.BufferAttribute(tints, 3, true));
    this.lines = new THREE.LineSegments(geometry, this.material);
    this.lines.frustumCulled = false;
    this.lines.matrixAutoUpdate = false;
    this.lines.renderOrder = 3;
    this.lines.visible = this.shown;
    this.parent.add(this.lines);
  }

  set visible(show: boolean) {
    this.shown = show;
    if (this.lines) this.lines.visible = show;
  }

  /** Called with each message; adds a moment ten times a simulated second. */
  advance(time_s: number): void {
    if (this.lines === null || (time_s < this.next_s && time_s > this.next_s - 1)) return;
    this.next_s = time_s + EVERY_S;
    const count = this.bodies.length;
    const position = this.lines.geometry.getAttribute('position') as THREE.BufferAttribute;
    const moment = this.lines.geometry.getAttribute('moment') as THREE.BufferAttribute;
    const row = this.moment % MOMENTS;
    const points = position.array as Float32Array;
    const moments = moment.array as Float32Array;
    for (let b = 0; b < count; ++b) {
      const world = this.bodies[b].world;
      const x = world[0], y = world[1], z = world[2] + 0.015;
      const lx = this.last[3 * b], ly = this.last[3 * b + 1], lz = this.last[3 * b + 2];
      const moved = Math.abs(x - lx) + Math.abs(y - ly) + Math.abs(z - lz);
      const at = 6 * (row * count + b);
      const valid = moved > 1e-4 && moved < JUMP_M;
      points[at] = valid ? lx : x;
      points[at + 1] = valid ? ly : y;
      points[at + 2] = valid ? lz : z;
      points[at + 3] = x;
      points[at + 4] = y;
      points[at + 5] = z;
      moments[at / 3] = this.moment - 1;
      moments[at / 3 + 1] = this.moment;
      this.last[3 * b] = x;
      this.last[3 * b + 1] = y;
      this.last[3 * b + 2] = z;
    }
    // Ranges add up until the next upload, which may be long if nothing is drawn: then the whole ring goes.
    if (position.updateRanges.length >= MOMENTS / 4) {
      position.clearUpdateRanges();
      moment.clearUpdateRanges();
      position.addUpdateRange(0, points.length);
      moment.addUpdateRange(0, moments.length);
    } else {
      position.addUpdateRange(6 * row * count, 6 * count);
      moment.addUpdateRange(2 * row * count, 2 * count);
    }
    position.needsUpdate = moment.needsUpdate = true;
    this.material.uniforms.now.value = this.moment;
    ++this.moment;
  }

  dispose(): void {
    this.free();
    this.material.dispose();
  }

  private free(): void {
    if (this.lines === null) return;
    this.parent.remove(this.lines);
    this.lines.geometry.dispose();
    this.lines = null;
  }
}
