// Batteries: a bar over each robot that has one, in the colour of its charge. One draw call for all; bars face the eye and are as wide as the
// robot, within limits.
import * as THREE from 'three';
import type { Batteries as Charges } from '../../binary';
import type { Body } from '../bodies';

const FIRST_CAPACITY = 64;
/** Of the bar over the top of its robot. */
const ABOVE_PX = 3;
/** So much room a name leaves for the bar below it. */
export const BAR_PX = 9;

export class Batteries {
  private readonly mesh: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>;
  private place = new THREE.InstancedBufferAttribute(new Float32Array(0), 3);
  /** Charge, and the robot's width. */
  private state = new THREE.InstancedBufferAttribute(new Float32Array(0), 2);
  private readonly charges = new Map<number, number>();

  constructor(private readonly parent: THREE.Object3D) {
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0], 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    geometry.instanceCount = 0;
    this.mesh = new THREE.Mesh(
      geometry,
      new THREE.ShaderMaterial({
        transparent: true,
        depthTest: false,
        depthWrite: false,
        uniforms: { view_px: { value: new THREE.Vector2(1, 1) }, frame: { value: new THREE.Color() }, hollow: { value: new THREE.Color() } },
        vertexShader: `attribute vec3 place; attribute vec2 state; uniform vec2 view_px; varying vec2 at_px; varying vec2 size_px; varying float charge;
          void main() {
            vec4 p = projectionMatrix * modelViewMatrix * vec4(place, 1.0);
            float px_per_m = projectionMatrix[1][1] * view_px.y / (2.0 * max(p.w, 1e-3));
            float width = floor(clamp(1.3 * px_per_m * state.y, 12.0, 40.0));
            size_px = vec2(width, width < 18.0 ? 5.0 : width < 32.0 ? 7.0 : 9.0);
            charge = state.x;
            at_px = position.xy * size_px;
            vec2 corner = floor((p.xy / p.w * 0.5 + 0.5) * view_px) + vec2(-floor(0.5 * width), ${ABOVE_PX.toFixed(1)});
            p.xy = ((corner + at_px) / view_px * 2.0 - 1.0) * p.w;
            gl_Position = p;
          }`,
        // A frame one pixel wide with a knob at its right, and the charge within. Nothing left: red, and striped.
        fragmentShader: `varying vec2 at_px; varying vec2 size_px; varying float charge; uniform vec3 frame; uniform vec3 hollow;
          void main() {
            float knob = size_px.y < 6.0 ? 1.0 : 2.0;
            float body = size_px.x - knob;
            if (at_px.x > body) {
              if (abs(at_px.y - 0.5 * size_px.y) > 0.25 * size_px.y) discard;
              gl_FragColor = vec4(charge > 0.0 ? frame : vec3(0.80, 0.06, 0.06), 0.9);
            } else {
              vec2 inset = min(at_px, vec2(body, size_px.y) - at_px);
              if (inset.x < 1.0 && inset.y < 1.0) discard;
              vec3 full = charge > 0.5 ? vec3(0.05, 0.47, 0.17) : charge > 0.2 ? vec3(0.95, 0.42, 0.02) : vec3(0.80, 0.06, 0.06);
              bool is_frame = min(inset.x, inset.y) < 1.0;
              if (charge <= 0.0) {
                bool stripe = mod(at_px.x + at_px.y, 6.0) < 2.0;
                gl_FragColor = vec4(is_frame || stripe ? vec3(0.80, 0.06, 0.06) : hollow, is_frame || stripe ? 1.0 : 0.9);
              } else {
                // The last bit of charge is still to be seen.
                bool is_full = at_px.x - 1.0 <= max(charge * (body - 2.0), 1.0);
                gl_FragColor = is_frame ? vec4(frame, 0.9) : vec4(is_full ? full : hollow, is_full ? 1.0 : 0.9);
              }
            }
            #include <colorspace_fragment>
          }`,
      }),
    );
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 19;
    this.mesh.visible = false;
    this.reserve(FIRST_CAPACITY);
    parent.add(this.mesh);
  }

  set visible(show: boolean) {
    this.mesh.visible = show;
  }

  /** So many are drawn. */
  get count(): number {
    return this.mesh.geometry.instanceCount;
  }

  setTheme(theme: 'light' | 'dark'): void {
    const { frame, hollow } = this.mesh.material.uniforms;
    frame.value.set(theme === 'light' ? '#2a3240' : '#e9eef6');
    hollow.value.set(theme === 'light' ? '#ffffff' : '#141a22');
  }

  has(id: number): boolean {
    return this.mesh.visible && this.charges.has(id);
  }

  /** Takes a message, which has all of them. */
  set(batteries: Charges): void {
    this.charges.clear();
    for (let i = 0; i < batteries.count; ++i) this.charges.set(batteries.ids[i], Math.min(1, batteries.charges[i]));
  }

  clear(): void {
    this.charges.clear();
  }

  update(by_id: ReadonlyMap<number, Body>, width_px: number, height_px: number): void {
    if (!this.mesh.visible) return;
    this.reserve(this.charges.size);
    let count = 0;
    for (const [id, charge] of this.charges) {
      const body = by_id.get(id);
      if (body === undefined) continue;
      const { min, max } = body.bounds;
      this.place.setXYZ(count, body.world[0], body.world[1], body.world[2] + max.z);
      this.state.setXY(count, charge, Math.max(max.x - min.x, max.y - min.y));
      ++count;
    }
    this.mesh.geometry.instanceCount = count;
    this.mesh.material.uniforms.view_px.value.set(width_px, height_px);
    if (count > 0) this.place.needsUpdate = this.state.needsUpdate = true;
  }

  dispose(): void {
    this.parent.remove(this.mesh);
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }

  private reserve(count: number): void {
    if (count <= this.place.count) return;
    const capacity = Math.max(count, 2 * this.place.count);
    const make = (size: number): THREE.InstancedBufferAttribute => new THREE.InstancedBufferAttribute(new Float32Array(size * capacity), size).setUsage(THREE.DynamicDrawUsage);
    this.place = make(3);
    this.state = make(2);
    this.mesh.geometry.setAttribute('place', this.place);
    this.mesh.geometry.setAttribute('state', this.state);
  }
}
