// Lines of a width in pixels, with round ends: one instanced quad per stretch. A line has a rim that sets it off from any ground, and shines
// faintly through what stands before it.
import * as THREE from 'three';

const CORNERS = [0, -1, 0, 1, -1, 0, 0, 1, 0, 1, 1, 0];
const FACES = [0, 1, 2, 2, 1, 3];

export const view_px = { value: new THREE.Vector2(1, 1) };
export const rim_color = { value: new THREE.Color('#ffffff') };

const VERTEX = `attribute vec3 from; attribute vec3 to; attribute float half_px; uniform vec2 view_px; uniform float rim_px;
  varying vec2 local; varying float length_px; varying float radius;
  void main() {
    vec4 a = projectionMatrix * viewMatrix * vec4(from, 1.0);
    vec4 b = projectionMatrix * viewMatrix * vec4(to, 1.0);
    // What lies behind the eye is cut away.
    const float near = 0.02;
    if (a.w < near && b.w < near) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
    if (a.w < near) a = mix(a, b, (near - a.w) / (b.w - a.w));
    else if (b.w < near) b = mix(b, a, (near - b.w) / (a.w - b.w));
    vec2 pa = 0.5 * view_px * a.xy / a.w, pb = 0.5 * view_px * b.xy / b.w;
    vec2 along = pb - pa;
    length_px = length(along);
    vec2 dir = length_px > 1e-3 ? along / length_px : vec2(1.0, 0.0);
    radius = half_px + rim_px;
    float reach = radius + 1.0;
    vec2 p = mix(pa, pb, position.x) + dir * (2.0 * position.x - 1.0) * reach + vec2(-dir.y, dir.x) * position.y * reach;
    local = vec2(dot(p - pa, dir), position.y * reach);
    // Divided here: then everything runs evenly over the screen.
    gl_Position = vec4(p / (0.5 * view_px), mix(a.z / a.w, b.z / b.w, position.x), 1.0);
  }`;
const FRAGMENT = `varying vec2 local; varying float length_px; varying float radius; uniform vec3 color; uniform float strength;
  void main() {
    float alpha = strength * (1.0 - smoothstep(radius - 0.5, radius + 0.5, length(vec2(local.x - clamp(local.x, 0.0, length_px), local.y))));
    if (alpha < 0.02) discard;
    gl_FragColor = vec4(color, alpha);
    #include <colorspace_fragment>
  }`;

/** Marks each pixel once where a line would otherwise be twice as strong at its joints. Zones count their markers from 1. */
const STENCIL = 255;

function material(color: { value: THREE.Color }, strength: number, rim_px: number, hidden: boolean): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    transparent: true, depthWrite: false, depthFunc: hidden ? THREE.GreaterDepth : THREE.LessEqualDepth, side: THREE.DoubleSide,
    polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -8,
    stencilWrite: hidden, stencilRef: STENCIL, stencilFunc: hidden ? THREE.NotEqualStencilFunc : THREE.AlwaysStencilFunc, stencilZPass: THREE.ReplaceStencilOp,
    uniforms: { view_px, color, rim_px: { value: rim_px }, strength: { value: strength } }, vertexShader: VERTEX, fragmentShader: FRAGMENT,
  });
}

export class Ribbons {
  private readonly geometry = new THREE.InstancedBufferGeometry();
  private readonly meshes: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>[];
  private capacity = 0;
  private count = 0;

  constructor(private readonly parent: THREE.Object3D, color: { value: THREE.Color }, order: number) {
    this.geometry.setAttribute('position', new THREE.Float32BufferAttribute(CORNERS, 3));
    this.geometry.setIndex(FACES);
    this.meshes = [material(color, 0.3, 0, true), material(rim_color, 0.75, 1.5, false), material(color, 1, 0, false)].map(
      (m, i) => Object.assign(new THREE.Mesh(this.geometry, m), { frustumCulled: false, matrixAutoUpdate: false, renderOrder: order + i }));
    this.reserve(16);
    parent.add(...this.meshes);
  }

  begin(): void {
    this.count = 0;
  }

  add(x0: number, y0: number, z0: number, x1: number, y1: number, z1: number, width_px: number): void {
    if (this.count === this.capacity) this.reserve(2 * this.capacity);
    const { from, to, half_px } = this.geometry.attributes as Record<string, THREE.InstancedBufferAttribute>;
    from.setXYZ(this.count, x0, y0, z0);
    to.setXYZ(this.count, x1, y1, z1);
    half_px.setX(this.count, width_px / 2);
    ++this.count;
  }

  end(): void {
    this.geometry.instanceCount = this.count;
    for (const mesh of this.meshes) mesh.visible = this.count > 0;
    for (const name of ['from', 'to', 'half_px']) {
      const values = this.geometry.attributes[name] as THREE.InstancedBufferAttribute;
      values.clearUpdateRanges();
      values.addUpdateRange(0, values.itemSize * this.count);
      values.needsUpdate = true;
    }
  }

  dispose(): void {
    this.parent.remove(...this.meshes);
    for (const mesh of this.meshes) mesh.material.dispose();
    this.geometry.dispose();
  }

  private reserve(capacity: number): void {
    for (const [name, size] of [['from', 3], ['to', 3], ['half_px', 1]] as const) {
      const grown = new Float32Array(size * capacity);
      const before = this.geometry.attributes[name] as THREE.InstancedBufferAttribute | undefined;
      if (before) grown.set(before.array as Float32Array);
      this.geometry.setAttribute(name, new THREE.InstancedBufferAttribute(grown, size).setUsage(THREE.DynamicDrawUsage));
    }
    // Buffers of another size are new ones on the graphics card.
    if (this.capacity > 0) this.geometry.dispose();
    this.capacity = capacity;
  }
}
