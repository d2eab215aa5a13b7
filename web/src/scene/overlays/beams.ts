// Beams of sensors that measure one distance: a line from the sensor to what it met, and the distance there as a number.
import * as THREE from 'three';
import { transform } from '../poses';

const WIDTH = 128;
const HEIGHT = 48;
/** Part of the view's height that a number takes. */
const PLATE = 0.042;

interface Beam {
  line: THREE.Line<THREE.BufferGeometry, THREE.LineBasicMaterial>;
  plate: THREE.Sprite;
  canvas: HTMLCanvasElement;
  text: string;
}

/** "0.42 m"; nothing was met: "–". */
export function distanceText(distance_m: number): string {
  return Number.isFinite(distance_m) ? `${distance_m.toFixed(distance_m < 10 ? 2 : 1)} m` : '–';
}

export class Beams {
  private readonly beams = new Map<string, Beam>();
  private readonly group = new THREE.Group();
  private readonly material = new THREE.LineBasicMaterial({ color: '#0fb5d0', transparent: true, opacity: 0.9, depthWrite: false, toneMapped: false });
  private readonly end = [0, 0, 0];

  constructor(private readonly parent: THREE.Object3D) {
    parent.add(this.group);
  }

  set visible(show: boolean) {
    this.group.visible = show;
  }

  /** @param pose of the device in the world @param length_m of the line @param distance_m  as measured */
  set(path: string, pose: Float64Array, length_m: number, distance_m: number): void {
    let beam = this.beams.get(path);
    if (beam === undefined) {
      beam = this.add();
      this.beams.set(path, beam);
    }
    transform(pose, 0, length_m, 0, 0, this.end);
    const places = beam.line.geometry.getAttribute('position') as THREE.BufferAttribute;
    places.setXYZ(0, pose[0], pose[1], pose[2]);
    places.setXYZ(1, this.end[0], this.end[1], this.end[2]);
    places.needsUpdate = true;
    beam.plate.position.set(this.end[0], this.end[1], this.end[2]);
    const text = distanceText(distance_m);
    if (text !== beam.text) this.write(beam, text);
  }

  keepOnly(known: (path: string) => boolean): void {
    for (const [path, beam] of [...this.beams]) {
      if (known(path)) continue;
      this.group.remove(beam.line, beam.plate);
      beam.line.geometry.dispose();
      beam.plate.material.map?.dispose();
      beam.plate.material.dispose();
      this.beams.delete(path);
    }
  }

  dispose(): void {
    this.keepOnly(() => false);
    this.parent.remove(this.group);
    this.material.dispose();
  }

  private add(): Beam {
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6), 3).setUsage(THREE.DynamicDrawUsage));
    const canvas = document.createElement('canvas');
    canvas.width = WIDTH;
    canvas.height = HEIGHT;
    const map = new THREE.CanvasTexture(canvas);
    map.colorSpace = THREE.SRGBColorSpace;
    map.generateMipmaps = false;
    map.minFilter = THREE.LinearFilter;
    const line = new THREE.Line(geometry, this.material);
    const plate = new THREE.Sprite(new THREE.SpriteMaterial({ map, sizeAttenuation: false, depthTest: false, depthWrite: false, transparent: true, toneMapped: false, fog: false }));
    plate.scale.set((PLATE * WIDTH) / HEIGHT, PLATE, 1);
    plate.renderOrder = 15;
    line.frustumCulled = plate.frustumCulled = false;
    line.renderOrder = 6;
    this.group.add(line, plate);
    return { line, plate, canvas, text: '' };
  }

  private write(beam: Beam, text: string): void {
    beam.text = text;
    const context = beam.canvas.getContext('2d');
    if (context === null) return;
    context.clearRect(0, 0, WIDTH, HEIGHT);
    context.font = '600 26px system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif';
    const width = context.measureText(text).width + 18;
    context.fillStyle = 'rgba(8, 58, 68, 0.86)';
    context.beginPath();
    context.roundRect((WIDTH - width) / 2, 6, width, HEIGHT - 12, 8);
    context.fill();
    context.fillStyle = '#e9fbff';
    context.textAlign = 'center';
    context.textBaseline = 'middle';
    context.fillText(text, WIDTH / 2, HEIGHT / 2 + 1);
    if (beam.plate.material.map) beam.plate.material.map.needsUpdate = true;
  }
}
