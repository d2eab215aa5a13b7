// Areas of the ground: parts with a surface of their own, with arrows where they carry what stands on them, and markers. Flat patches with their names.
import * as THREE from 'three';
import type { Marker, World, Zone } from '../protocol';

/** Above the ground, below what stands on it; the offset in depth keeps it from flickering far away. */
const HEIGHT_M = 0.002;

export class Zones {
  private readonly group = new THREE.Group();

  constructor(scene: THREE.Scene) {
    this.group.name = 'zones';
    scene.add(this.group);
  }

  setWorld(world: World): void {
    this.clear();
    for (const zone of world.zones ?? []) this.add(zone);
    (world.markers ?? []).forEach((marker, i) => this.addMarker(marker, i));
  }

  dispose(): void {
    this.clear();
    this.group.removeFromParent();
  }

  private clear(): void {
    for (const child of [...this.group.children]) {
      const mesh = child as THREE.Mesh<THREE.BufferGeometry, THREE.MeshBasicMaterial>;
      mesh.geometry.dispose();
      mesh.material.map?.dispose();
      mesh.material.dispose();
      this.group.remove(mesh);
    }
  }

  private add(zone: Zone): void {
    const outline = zone.corners.length > 0
      ? new THREE.Shape(zone.corners.map(([x, y]) => new THREE.Vector2(x, y)))
      : new THREE.Shape().absarc(zone.centre[0], zone.centre[1], zone.radius_m, 0, 2 * Math.PI, false);
    const box = this.addPatch(zone.name, [outline], colorOf(zone), 0.4);
    this.addArrows(zone, box);
  }

  private addMarker(marker: Marker, index: number): void {
    const [r, g, b, a] = marker.color;
    const outlines = marker.outlines.map((outline) => new THREE.Shape(outline.map(([x, y]) => new THREE.Vector2(x, y))));
    const color = new THREE.Color().setRGB(r, g, b, THREE.SRGBColorSpace);
    // Where its outlines overlap, a pixel is drawn once: the stencil holds the number of the marker that was drawn last.
    this.addPatch(marker.name, outlines, color, (marker.painted ? 0.9 : 0.35) * a, 1 + (index % 255));
  }

  /** @returns the box about the patch */
  private addPatch(name: string, outlines: THREE.Shape[], color: THREE.Color, opacity: number, stencil = 0): THREE.Box3 {
    const geometry = new THREE.ShapeGeometry(outlines, 48);
    const material = new THREE.MeshBasicMaterial({
      color, transparent: true, opacity, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -2,
      stencilWrite: stencil > 0, stencilRef: stencil, stencilFunc: THREE.NotEqualStencilFunc, stencilZPass: THREE.ReplaceStencilOp,
    });
    const patch = new THREE.Mesh(geometry, material);
    patch.position.z = HEIGHT_M;
    this.group.add(patch);
    geometry.computeBoundingBox();
    const label = labelOf(name, geometry.boundingBox!);
    if (label !== null) this.group.add(label);
    return geometry.boundingBox!;
  }

  /** Two arrow heads beside the name, the way the belt runs. */
  private addArrows(zone: Zone, box: THREE.Box3): void {
    const [vx, vy] = zone.belt_velocity;
    if (!(Math.hypot(vx, vy) > 0)) return;
    const size = box.getSize(new THREE.Vector3());
    const length = 0.16 * Math.min(size.x, size.y);
    const head = new THREE.Shape([[0.6, 0], [-0.4, 0.9], [-0.9, 0.9], [0.1, 0], [-0.9, -0.9], [-0.4, -0.9]].map(([x, y]) => new THREE.Vector2(length * x, length * y)));
    for (const side of [-1, 1]) {
      const arrow = new THREE.Mesh(
        new THREE.ShapeGeometry(head),
        new THREE.MeshBasicMaterial({ color: '#6b4a00', transparent: true, opacity: 0.75, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 }),
      );
      arrow.rotation.z = Math.atan2(vy, vx);
      box.getCenter(arrow.position);
      // Beside the name, which lies along the longer side: over and under it, or before and after.
      const along_name = Math.abs(vx) > Math.abs(vy) === size.x >= size.y;
      const gap = (along_name ? 0.42 : 0.3) * (Math.abs(vx) > Math.abs(vy) ? size.x : size.y);
      arrow.position.x += (side * gap * vx) / Math.hypot(vx, vy);
      arrow.position.y += (side * gap * vy) / Math.hypot(vx, vy);
      arrow.position.z = 1.5 * HEIGHT_M;
      this.group.add(arrow);
    }
  }
}

/** Belts are yellow, holes black; else from blue, slippery, to brown, rough. */
function colorOf(zone: Zone): THREE.Color {
  if (zone.hole) return new THREE.Color('#111417');
  if (Math.hypot(zone.belt_velocity[0], zone.belt_velocity[1]) > 0) return new THREE.Color('#d9a520');
  const rough = Math.min(1, Math.sqrt(Math.max(0, zone.friction)));
  return new THREE.Color('#58b4e8').lerp(new THREE.Color('#7a4a1e'), rough);
}

/** The name, written on the ground along the longer side. */
function labelOf(name: string, box: THREE.Box3): THREE.Mesh | null {
  const canvas = document.createElement('canvas');
  canvas.width = 512;
  canvas.height = 128;
  const context = canvas.getContext('2d');
  if (context === null) return null;
  context.font = '600 84px system-ui, sans-serif';
  context.textAlign = 'center';
  context.textBaseline = 'middle';
  context.fillStyle = '#ffffff';
  context.strokeStyle = 'rgba(0, 0, 0, 0.6)';
  context.lineWidth = 7;
  context.strokeText(name, 256, 64, 500);
  context.fillText(name, 256, 64, 500);
  const map = new THREE.CanvasTexture(canvas);
  map.colorSpace = THREE.SRGBColorSpace;
  map.anisotropy = 8;  // it is mostly seen at a slant
  const size = box.getSize(new THREE.Vector3());
  const upright = size.y > size.x;
  const width = Math.min(0.9 * Math.max(size.x, size.y), 2.4 * Math.min(size.x, size.y));
  const label = new THREE.Mesh(
    new THREE.PlaneGeometry(width, width / 4),
    new THREE.MeshBasicMaterial({ map, transparent: true, depthWrite: false, polygonOffset: true, polygonOffsetFactor: -2, polygonOffsetUnits: -4 }),
  );
  box.getCenter(label.position);
  label.position.z = 2 * HEIGHT_M;
  if (upright) label.rotation.z = Math.PI / 2;
  return label;
}
