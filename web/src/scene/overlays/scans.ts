// Laser points and their fan, per device, where the device was when the scan came.
import * as THREE from 'three';
import { transform } from '../poses';

export interface Scan {
  angle_min: number;
  angle_increment: number;
  range_min: number;
  range_max: number;
  ranges: ArrayLike<number>;
}

/** Beams are measured at most so many per scan: beyond, every n-th is drawn. */
const MOST_BEAMS = 4096;

interface Drawn {
  points: THREE.Points<THREE.BufferGeometry, THREE.ShaderMaterial>;
  fan: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial>;
  capacity: number;
}

export class Scans {
  private readonly drawn = new Map<string, Drawn>();
  private readonly group = new THREE.Group();
  private readonly point_material: THREE.ShaderMaterial;
  private readonly fan_material = new THREE.ShaderMaterial({
    transparent: true,
    side: THREE.DoubleSide,
    depthWrite: false,
    // Strong at the sensor and faint where it ends, so that several fans do not dye the room.
    uniforms: { share: { value: 1 } },
    vertexShader: `attribute float strength; varying float alpha;
      void main() { alpha = strength; gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0); }`,
    fragmentShader: `varying float alpha; uniform float share;
      void main() { gl_FragColor = vec4(1.0, 0.25, 0.12, share * (alpha * alpha * 0.09 + 0.008));
        #include <colorspace_fragment>
      }`,
  });
  private readonly at = [0, 0, 0];

  constructor(private readonly parent: THREE.Object3D) {
    this.point_material = new THREE.ShaderMaterial({
      transparent: true,
      depthWrite: false,
      uniforms: { size_px: { value: 5 } },
      vertexShader: `attribute float nearness; uniform float size_px; varying float shade;
        void main() {
          shade = nearness;
          vec4 p = modelViewMatrix * vec4(position, 1.0);
          gl_Position = projectionMatrix * p;
          gl_PointSize = size_px;
        }`,
      // Red near, through orange, to violet far: hues that stand out from grey walls in both themes.
      fragmentShader: `varying float shade;
        void main() {
          float r = length(gl_PointCoord - 0.5);
          float alpha = 1.0 - smoothstep(0.38, 0.5, r);
          if (alpha < 0.02) discard;
          vec3 far = vec3(0.20, 0.32, 0.98);
          vec3 middle = vec3(0.93, 0.18, 0.55);
          vec3 near = vec3(1.0, 0.28, 0.05);
          vec3 color = shade < 0.5 ? mix(far, middle, shade * 2.0) : mix(middle, near, shade * 2.0 - 1.0);
          gl_FragColor = vec4(color, alpha * 0.95);
          #include <colorspace_fragment>
        }`,
    });
    parent.add(this.group);
  }

  set visible(show: boolean) {
    this.group.visible = show;
  }

  setPointSize(size_px: number): void {
    this.point_material.uniforms.size_px.value = size_px;
  }

  /** @param pose of the device in the world */
  set(path: string, scan: Scan | null, pose: Float64Array): void {
    let drawn = this.drawn.get(path);
    const total = scan ? scan.ranges.length : 0;
    if (scan === null || total === 0) {
      if (drawn) this.remove(path, drawn);
      return;
    }
    const every = Math.ceil(total / MOST_BEAMS);
    const beams = Math.ceil(total / every);
    if (drawn === undefined || drawn.capacity < beams) {
      if (drawn) this.remove(path, drawn);
      drawn = this.add(path, beams);
    }
    this.write(drawn, scan, every, pose);
  }

  clear(): void {
    for (const [path, drawn] of [...this.drawn]) this.remove(path, drawn);
  }

  keepOnly(known: (path: string) => boolean): void {
    for (const [path, drawn] of [...this.drawn]) if (!known(path)) this.remove(path, drawn);
  }

  dispose(): void {
    this.clear();
    this.parent.remove(this.group);
    this.point_material.dispose();
    this.fan_material.dispose();
  }

  private write(drawn: Drawn, scan: Scan, every: number, pose: Float64Array): void {
    const position = drawn.points.geometry.getAttribute('position') as THREE.BufferAttribute;
    const nearness = drawn.points.geometry.getAttribute('nearness') as THREE.BufferAttribute;
    const fan = drawn.fan.geometry.getAttribute('position') as THREE.BufferAttribute;
    const points = position.array as Float32Array;
    const shades = nearness.array as Float32Array;
    const corners = fan.array as Float32Array;
    const strength = drawn.fan.geometry.getAttribute('strength') as THREE.BufferAttribute;
    const strengths = strength.array as Uint8Array;
    let previous_m = 0;
    const far_m = Number.isFinite(scan.range_max) && scan.range_max > 0 ? scan.range_max : 30;
    let count = 0;
    let corner = 0;
    let had_previous = false;
    let px = 0, py = 0, pz = 0;
    for (let i = 0; i < scan.ranges.length; i += every) {
      const range = scan.ranges[i];
      const angle = scan.angle_min + i * scan.angle_increment;
      const hit = Number.isFinite(range) && range >= scan.range_min && range <= far_m;
      // A beam that met nothing is drawn to its reach; one that is invalid not at all.
      const length = hit ? range : range === Infinity ? far_m : 0;
      transform(pose, 0, Math.cos(angle) * length, Math.sin(angle) * length, 0, this.at);
      const [x, y, z] = this.at;
      if (hit) {
        points[3 * count] = x;
        points[3 * count + 1] = y;
        points[3 * count + 2] = z;
        shades[count++] = Math.sqrt(Math.max(0, 1 - length / far_m));
      }
      if (had_previous && length > 0) {
        strengths[corner / 3] = 255;
        strengths[corner / 3 + 1] = fading(previous_m, far_m);
        strengths[corner / 3 + 2] = fading(length, far_m);
        corners[corner++] = pose[0];
        corners[corner++] = pose[1];
        corners[corner++] = pose[2];
        corners[corner++] = px;
        corners[corner++] = py;
        corners[corner++] = pz;
        corners[corner++] = x;
        corners[corner++] = y;
        corners[corner++] = z;
      }
      had_previous = length > 0;
      previous_m = length;
      px = x;
      py = y;
      pz = z;
    }
    position.needsUpdate = nearness.needsUpdate = fan.needsUpdate = strength.needsUpdate = true;
    drawn.points.geometry.setDrawRange(0, count);
    drawn.fan.geometry.setDrawRange(0, corner / 3);
  }

  private add(path: string, beams: number): Drawn {
    const points = new THREE.BufferGeometry();
    points.setAttribute('position', new THREE.BufferAttribute(new Float32Array(3 * beams), 3).setUsage(THREE.DynamicDrawUsage));
    points.setAttribute('nearness', new THREE.BufferAttribute(new Float32Array(beams), 1).setUsage(THREE.DynamicDrawUsage));
    const fan = new THREE.BufferGeometry();
    fan.setAttribute('position', new THREE.BufferAttribute(new Float32Array(9 * beams), 3).setUsage(THREE.DynamicDrawUsage));
    fan.setAttribute('strength', new THREE.BufferAttribute(new Uint8Array(3 * beams), 1, true).setUsage(THREE.DynamicDrawUsage));
    const drawn: Drawn = { points: new THREE.Points(points, this.point_material), fan: new THREE.Mesh(fan, this.fan_material), capacity: beams };
    for (const object of [drawn.fan, drawn.points]) {
      object.frustumCulled = false;
      object.matrixAutoUpdate = false;
      this.group.add(object);
    }
    drawn.fan.renderOrder = 5;
    drawn.points.renderOrder = 6;
    this.drawn.set(path, drawn);
    this.share();
    return drawn;
  }

  /** Many fans over each other are as strong as three. */
  private share(): void {
    this.fan_material.uniforms.share.value = Math.min(1, 3 / Math.max(1, this.drawn.size));
  }

  private remove(path: string, drawn: Drawn): void {
    this.group.remove(drawn.points, drawn.fan);
    drawn.points.geometry.dispose();
    drawn.fan.geometry.dispose();
    this.drawn.delete(path);
    this.share();
  }
}

/** Of a fan that is full at the sensor and nothing at its reach, as a byte. */
const fading = (length_m: number, far_m: number): number => 255 * Math.max(0, 1 - length_m / Math.min(far_m, 4));
