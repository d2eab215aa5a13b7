// Flat arrows on the ground: poses and particles. They are so many metres long, but not smaller than so many pixels.
import * as THREE from 'three';
import { rim_color, view_px } from './ribbons';

/** A dart about its pose, of length 1, and the same with a rim. */
const DART = [0.62, 0, -0.38, 0.36, -0.2, 0, -0.38, -0.36];
const RIMMED = [0.78, 0, -0.5, 0.5, -0.27, 0, -0.5, -0.5];

const VERTEX = `attribute vec3 at; attribute float yaw; uniform vec2 view_px; uniform float length_m; uniform float length_px;
  void main() {
    float w = (projectionMatrix * viewMatrix * vec4(at, 1.0)).w;
    float px_per_m = 0.5 * projectionMatrix[1][1] * view_px.y / max(w, 1e-3);
    float size_m = max(length_m, length_px / px_per_m);
    mat2 turn = mat2(cos(yaw), sin(yaw), -sin(yaw), cos(yaw));
    gl_Position = projectionMatrix * viewMatrix * vec4(at + vec3(turn * position.xy * size_m, 0.0), 1.0);
  }`;
const FRAGMENT = `uniform vec3 color; uniform float strength;
  void main() { gl_FragColor = vec4(color, strength);
    #include <colorspace_fragment>
  }`;

function dart(corners: number[], source?: THREE.InstancedBufferGeometry): THREE.InstancedBufferGeometry {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(corners.flatMap((v, i) => (i % 2 === 0 ? [v] : [v, 0])), 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  if (source) for (const name of ['at', 'yaw']) geometry.setAttribute(name, source.getAttribute(name));
  return geometry;
}

export class Darts {
  private readonly meshes: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>[];
  private readonly at: THREE.InstancedBufferAttribute;
  private readonly yaw: THREE.InstancedBufferAttribute;

  /** @param most  so many can be shown. One alone has a rim, and shines through what stands before it. */
  constructor(private readonly parent: THREE.Object3D, private readonly most: number, color: { value: THREE.Color }, order: number, length_m: number, length_px: number) {
    this.at = new THREE.InstancedBufferAttribute(new Float32Array(3 * most), 3).setUsage(THREE.DynamicDrawUsage);
    this.yaw = new THREE.InstancedBufferAttribute(new Float32Array(most), 1).setUsage(THREE.DynamicDrawUsage);
    const inner = dart(DART);
    inner.setAttribute('at', this.at);
    inner.setAttribute('yaw', this.yaw);
    const layer = (geometry: THREE.InstancedBufferGeometry, of: { value: THREE.Color }, strength: number, hidden: boolean): THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial> => new THREE.Mesh(geometry, new THREE.ShaderMaterial({
      transparent: true, depthWrite: false, side: THREE.DoubleSide, depthFunc: hidden ? THREE.GreaterDepth : THREE.LessEqualDepth,
      polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -8,
      uniforms: { view_px, color: of, strength: { value: strength }, length_m: { value: length_m }, length_px: { value: length_px } }, vertexShader: VERTEX, fragmentShader: FRAGMENT,
    }));
    this.meshes = most > 1 ? [layer(inner, color, 0.7, false)] : [layer(inner, color, 0.45, true), layer(dart(RIMMED, inner), rim_color, 0.9, false), layer(inner, color, 1, false)];
    this.meshes.forEach((mesh, i) => Object.assign(mesh, { frustumCulled: false, matrixAutoUpdate: false, renderOrder: order + i }));
    parent.add(...this.meshes);
  }

  /** @param values  x, y, z and heading, one after the other */
  set(values: ArrayLike<number>): void {
    const count = Math.min(this.most, Math.floor(values.length / 4));
    for (let i = 0; i < count; ++i) {
      this.at.setXYZ(i, values[4 * i], values[4 * i + 1], values[4 * i + 2]);
      this.yaw.setX(i, values[4 * i + 3]);
    }
    for (const attribute of [this.at, this.yaw]) {
      attribute.clearUpdateRanges();
      attribute.addUpdateRange(0, attribute.itemSize * count);
      attribute.needsUpdate = true;
    }
    for (const mesh of this.meshes) {
      mesh.geometry.instanceCount = count;
      mesh.visible = count > 0;
    }
  }

  dispose(): void {
    this.parent.remove(...this.meshes);
    for (const mesh of this.meshes) {
      mesh.material.dispose();
      mesh.geometry.dispose();
    }
  }
}
