// Instanced meshes: one per geometry and surface, whoever's it is. A slot is one instance's place in one.
import * as THREE from 'three';
import type { Assets } from './assets';
import { checker } from './assets';
import { surfaceKey, type Part, type Surface } from './shapes';

/** Who a slot belongs to; the slot moves when another is freed. */
export interface Slot {
  batch: Batch;
  at: number;
  /** What a ray that hits it has found. */
  owner: object;
  link: number;
  local: Float64Array;
}

export class Batch {
  mesh: THREE.InstancedMesh;
  readonly slots: Slot[] = [];
  readonly sphere: THREE.Sphere;
  matrices: Float32Array;
  private from = Infinity;
  private to = -1;

  constructor(
    private readonly parent: THREE.Object3D,
    readonly geometry: THREE.BufferGeometry,
    readonly material: THREE.Material,
    readonly pickable: boolean,
    private readonly colored: boolean,
    private readonly shadows: boolean,
  ) {
    geometry.computeBoundingSphere();
    this.sphere = geometry.boundingSphere ?? new THREE.Sphere();
    this.mesh = this.make(4);
    this.matrices = this.mesh.instanceMatrix.array as Float32Array;
  }

  add(owner: object, link: number, local: Float64Array, color: THREE.Color): Slot {
    const at = this.slots.length;
    if (at === this.mesh.instanceMatrix.count) this.grow();
    const slot: Slot = { batch: this, at, owner, link, local };
    this.slots.push(slot);
    // Nowhere to be seen until its first pose.
    this.matrices.fill(0, 16 * at, 16 * at + 16);
    if (this.colored) {
      this.mesh.setColorAt(at, color);
      if (this.mesh.instanceColor) this.mesh.instanceColor.needsUpdate = true;
    }
    this.mesh.count = this.slots.length;
    this.touch(at);
    return slot;
  }

  remove(slot: Slot): void {
    const last = this.slots.length - 1;
    const moved = this.slots[last];
    if (moved !== slot) {
      this.matrices.copyWithin(16 * slot.at, 16 * last, 16 * last + 16);
      const colors = this.mesh.instanceColor;
      if (colors) {
        (colors.array as Float32Array).copyWithin(3 * slot.at, 3 * last, 3 * last + 3);
        colors.needsUpdate = true;
      }
      moved.at = slot.at;
      this.slots[slot.at] = moved;
      this.touch(slot.at);
    }
    this.slots.pop();
    this.mesh.count = this.slots.length;
  }

  touch(at: number): void {
    if (at < this.from) this.from = at;
    if (at > this.to) this.to = at;
  }

  /** Hands what has changed since the last time to the renderer. */
  flush(): void {
    this.mesh.visible = this.slots.length > 0;
    if (this.to < this.from) return;
    const attribute = this.mesh.instanceMatrix;
    attribute.clearUpdateRanges();
    attribute.addUpdateRange(16 * this.from, 16 * (this.to - this.from + 1));
    attribute.needsUpdate = true;
    this.from = Infinity;
    this.to = -1;
  }

  dispose(): void {
    this.parent.remove(this.mesh);
    this.mesh.dispose();
    this.geometry.dispose();
  }

  private make(capacity: number): THREE.InstancedMesh {
    const mesh = new THREE.InstancedMesh(this.geometry, this.material, capacity);
    mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
    mesh.frustumCulled = false;
    mesh.matrixAutoUpdate = false;
    mesh.castShadow = this.shadows;
    mesh.receiveShadow = !(this.material as THREE.MeshStandardMaterial).wireframe;
    mesh.count = 0;
    this.parent.add(mesh);
    return mesh;
  }

  private grow(): void {
    const old = this.mesh;
    this.mesh = this.make(4 * old.instanceMatrix.count);
    this.matrices = this.mesh.instanceMatrix.array as Float32Array;
    this.matrices.set(old.instanceMatrix.array);
    if (old.instanceColor) {
      this.mesh.setColorAt(0, new THREE.Color());
      (this.mesh.instanceColor?.array as Float32Array).set(old.instanceColor.array);
    }
    this.mesh.count = old.count;
    this.touch(0);
    this.touch(this.slots.length);
    this.parent.remove(old);
    old.dispose();
  }
}

export class Batches {
  private readonly batches = new Map<string, Batch>();
  private readonly materials = new Map<string, THREE.MeshStandardMaterial>();
  private readonly color = new THREE.Color();
  private checker_texture: THREE.Texture | undefined;

  constructor(
    private readonly parent: THREE.Object3D,
    private readonly assets: Assets,
  ) {}

  get all(): IterableIterator<Batch> {
    return this.batches.values();
  }

  add(part: Part, owner: object, parent: THREE.Object3D = this.parent): Slot {
    const key = `${part.geometry_key}|${surfaceKey(part.surface)}|${+part.cast_shadows}`;
    let batch = this.batches.get(key);
    if (batch === undefined) {
      const see_through = part.surface.opacity < 1;
      const colored = !part.surface.vertex_colors && !part.surface.checker;
      batch = new Batch(parent, part.geometry(), this.material(part.surface), !part.surface.wireframe, colored, part.cast_shadows && !see_through);
      this.batches.set(key, batch);
    }
    const c = part.color;
    return batch.add(owner, part.link, part.local, this.color.setRGB(c[0], c[1], c[2], THREE.SRGBColorSpace));
  }

  flush(): void {
    for (const batch of this.batches.values()) batch.flush();
  }

  /** Lets go of geometries that nothing uses any more. */
  sweep(): void {
    for (const [key, batch] of this.batches) {
      if (batch.slots.length > 0) continue;
      batch.dispose();
      this.batches.delete(key);
    }
  }

  /** Everything goes, the materials and their textures too. */
  dispose(): void {
    for (const batch of this.batches.values()) batch.dispose();
    this.batches.clear();
    for (const material of this.materials.values()) material.dispose();
    this.materials.clear();
    this.checker_texture?.dispose();
    this.checker_texture = undefined;
  }

  private material(s: Surface): THREE.MeshStandardMaterial {
    const key = surfaceKey(s);
    let material = this.materials.get(key);
    if (material === undefined) {
      material = new THREE.MeshStandardMaterial({
        vertexColors: s.vertex_colors,
        roughness: s.roughness,
        metalness: 0,
        emissive: new THREE.Color().setHex(s.emissive, THREE.SRGBColorSpace),
        transparent: s.opacity < 1,
        opacity: s.opacity,
        depthWrite: s.opacity >= 1,
        side: s.double_sided ? THREE.DoubleSide : THREE.FrontSide,
        wireframe: s.wireframe,
      });
      if (s.texture !== '') material.map = this.assets.texture(s.texture);
      if (s.checker) material.map = this.checker_texture ??= checker();
      // Acne on closed shapes comes from their lit faces; drawing the back faces alone into the map avoids it.
      material.shadowSide = s.double_sided ? THREE.DoubleSide : THREE.BackSide;
      this.materials.set(key, material);
    }
    return material;
  }
}
