// Communication links: who hears whom, as bowed lines that fade, with a pulse that runs from the sender to the receiver.
//
// One draw call for all. A line bows to the left of its direction, so that two robots that talk to each other have two. Lines live by the
// clock of the browser: a run at any speed shows them equally long.
import * as THREE from 'three';
import type { Deliveries } from '../../binary';
import type { Part } from '../../protocol';
import type { Body } from '../bodies';

const MOST = 300;
const SEGMENTS = 20;
const LIFE_MS = 900;
const PULSE_MS = 450;
/** Numbers per record of a message. */
const WIDTH = 6;

/** Colours by kind of medium; further media of the world get the others. */
const COLORS: Record<string, string> = { radio: '#2aa8ff', infrared: '#ff3f7f', shout: '#f59f0a' };
const OTHERS = ['#8e4ec6', '#12a594', '#d6409f'];

interface Link {
  sender: Body;
  receiver: Body;
  color: THREE.Color;
  heard_ms: number;
  pulse_ms: number;
}

export class Links {
  private readonly mesh: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>;
  private readonly from = attribute(3);
  private readonly to = attribute(3);
  private readonly tint = attribute(3);
  /** Strength of the line, 0 to 1, and place of the pulse, 0 to 1 and beyond. */
  private readonly phase = attribute(2);
  private readonly live = new Map<string, Link>();
  private colors: THREE.Color[] = [];

  constructor(private readonly parent: THREE.Object3D) {
    const geometry = new THREE.InstancedBufferGeometry();
    const corners: number[] = [];
    const faces: number[] = [];
    for (let i = 0; i <= SEGMENTS; ++i) {
      corners.push(i / SEGMENTS, -1, 0, i / SEGMENTS, 1, 0);
      if (i < SEGMENTS) faces.push(2 * i, 2 * i + 1, 2 * i + 2, 2 * i + 2, 2 * i + 1, 2 * i + 3);
    }
    geometry.setAttribute('position', new THREE.Float32BufferAttribute(corners, 3));
    geometry.setIndex(faces);
    for (const [name, values] of Object.entries({ from: this.from, to: this.to, tint: this.tint, phase: this.phase })) geometry.setAttribute(name, values);
    geometry.instanceCount = 0;
    this.mesh = new THREE.Mesh(
      geometry,
      new THREE.ShaderMaterial({
        transparent: true,
        depthTest: false,
        depthWrite: false,
        side: THREE.DoubleSide,
        // On a light floor lines are darker, and a pulse is not white.
        uniforms: { view_px: { value: new THREE.Vector2(1, 1) }, shade: { value: 1 }, glow: { value: 0.45 } },
        vertexShader: `attribute vec3 from; attribute vec3 to; attribute vec3 tint; attribute vec2 phase; uniform vec2 view_px;
          varying float along; varying float across; varying vec3 color; varying vec2 life;
          vec4 place(float t) {
            vec3 way = to - from;
            float bow = 4.0 * t * (1.0 - t);
            vec3 left = vec3(-way.y, way.x, 0.0);
            vec3 at = mix(from, to, t) + 0.08 * bow * left + vec3(0.0, 0.0, 0.05 * bow * length(way));
            return projectionMatrix * modelViewMatrix * vec4(at, 1.0);
          }
          vec2 on_screen(vec4 p) { return p.xy / max(p.w, 1e-3) * view_px; }
          void main() {
            vec4 p = place(position.x);
            vec2 way = on_screen(place(position.x + 0.02)) - on_screen(place(position.x - 0.02));
            float length_px = length(way);
            vec2 normal = length_px > 1e-3 ? vec2(-way.y, way.x) / length_px : vec2(0.0, 1.0);
            // Twice the half width, since view_px spans two units; with a margin for the soft edge.
            p.xy += normal * position.y * 2.0 * 3.5 / view_px * p.w;
            along = position.x;
            across = position.y * 3.5;
            color = tint;
            life = phase;
            gl_Position = p;
          }`,
        fragmentShader: `varying float along; varying float across; varying vec3 color; varying vec2 life; uniform float shade; uniform float glow;
          void main() {
            float behind = life.y - along;
            float pulse = behind > 0.0 ? exp(-7.0 * behind) : exp(-900.0 * behind * behind);
            float half_px = 0.8 + 1.4 * pulse;
            float edge = 1.0 - smoothstep(half_px - 0.5, half_px + 0.75, abs(across));
            float ends = smoothstep(0.0, 0.06, along) * smoothstep(0.0, 0.06, 1.0 - along);
            float alpha = life.x * edge * mix(0.35, 1.0, ends) * (0.62 + 0.38 * pulse);
            if (alpha < 0.01) discard;
            gl_FragColor = vec4(mix(shade * color, vec3(1.0), glow * pulse), alpha);
            #include <colorspace_fragment>
          }`,
      }),
    );
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 15;
    this.mesh.visible = false;
    parent.add(this.mesh);
  }

  set visible(show: boolean) {
    this.mesh.visible = show;
    if (!show) this.clear();
  }

  get visible(): boolean {
    return this.mesh.visible;
  }

  /** So many are drawn. */
  get count(): number {
    return this.mesh.geometry.instanceCount;
  }

  setTheme(theme: 'light' | 'dark'): void {
    const { shade, glow } = this.mesh.material.uniforms;
    shade.value = theme === 'light' ? 0.55 : 1;
    glow.value = theme === 'light' ? 0 : 0.45;
  }

  setMedia(media: Part[]): void {
    this.colors = media.map((medium, i) => new THREE.Color(COLORS[medium.kind] ?? OTHERS[i % OTHERS.length]));
  }

  /** Takes a message; of too many links every n-th. */
  set(deliveries: Deliveries, by_id: ReadonlyMap<number, Body>, now_ms: number): void {
    if (!this.visible) return;
    const every = Math.max(1, Math.ceil(deliveries.count / MOST));
    for (let i = 0; i < deliveries.count; i += every) {
      const [sender_id, receiver_id, medium] = deliveries.values.subarray(WIDTH * i, WIDTH * i + 3);
      const sender = by_id.get(sender_id), receiver = by_id.get(receiver_id);
      if (sender === undefined || receiver === undefined || sender === receiver) continue;
      const key = `${sender_id} ${receiver_id} ${medium}`;
      let link = this.live.get(key);
      if (link === undefined) {
        if (this.live.size >= MOST) continue;
        link = { sender, receiver, color: this.colors[medium] ?? WHITE, heard_ms: now_ms, pulse_ms: now_ms };
        this.live.set(key, link);
      }
      link.sender = sender;
      link.receiver = receiver;
      link.heard_ms = now_ms;
      // The pulse on its way arrives before the next one starts.
      if (now_ms > link.pulse_ms + PULSE_MS) link.pulse_ms = now_ms;
    }
  }

  /** Places the lines. @return whether some will have changed by the next frame */
  update(now_ms: number, width_px: number, height_px: number): boolean {
    let count = 0;
    for (const [key, link] of this.live) {
      const age = Math.max(0, now_ms - link.heard_ms) / LIFE_MS;
      if (age >= 1) {
        this.live.delete(key);
        continue;
      }
      put(this.from, count, link.sender);
      put(this.to, count, link.receiver);
      this.tint.setXYZ(count, link.color.r, link.color.g, link.color.b);
      this.phase.setXY(count, 1 - age * age, Math.max(0, now_ms - link.pulse_ms) / PULSE_MS);
      ++count;
    }
    if (count > 0 || this.mesh.geometry.instanceCount > 0) {
      this.mesh.geometry.instanceCount = count;
      this.mesh.material.uniforms.view_px.value.set(width_px, height_px);
      for (const values of [this.from, this.to, this.tint, this.phase]) {
        values.clearUpdateRanges();
        values.addUpdateRange(0, values.itemSize * count);
        values.needsUpdate = true;
      }
    }
    return count > 0;
  }

  clear(): void {
    this.live.clear();
    this.mesh.geometry.instanceCount = 0;
  }

  dispose(): void {
    this.parent.remove(this.mesh);
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
  }
}

const WHITE = new THREE.Color('#ffffff');

function attribute(size: number): THREE.InstancedBufferAttribute {
  return new THREE.InstancedBufferAttribute(new Float32Array(size * MOST), size).setUsage(THREE.DynamicDrawUsage);
}

/** Lines begin and end at the upper part of a body. */
function put(values: THREE.InstancedBufferAttribute, i: number, body: Body): void {
  const b = body.bounds;
  values.setXYZ(i, body.world[0], body.world[1], body.world[2] + b.min.z + 0.8 * (b.max.z - b.min.z));
}
