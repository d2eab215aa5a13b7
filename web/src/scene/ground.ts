// Endless planes with their grid.
//
// A plane is a disc of rings around what the camera looks at: two triangles of kilometres would have depths that are wrong
// by decimetres, and swallow wheels. Lines are drawn by the plane's own material, so that nothing lies in its way.
import * as THREE from 'three';
import type { Assets } from './assets';
import type { Bodies } from './bodies';
import { multiply } from './poses';

interface Ground {
  mesh: THREE.Mesh;
  material: THREE.MeshStandardMaterial;
  color: THREE.Color;
  /** Stands for no plane of the world: wears the theme's colour. */
  fallback: boolean;
  origin: THREE.Vector3;
  turn: THREE.Quaternion;
  /** Of the disc's middle on the plane. */
  offset: { value: THREE.Vector2 };
}

const RINGS = 20;
const GROWTH = 1.5;
const SECTORS = 64;
/** The disc moves in steps, so that its depths do not shimmer. */
const STEP_M = 2;

export class Grounds {
  private readonly list: Ground[] = [];
  private readonly geometry = discGeometry();
  private readonly uniforms = { grid_color: { value: new THREE.Color() }, grid_strength: { value: 0.2 } };
  private readonly local = new THREE.Vector3();
  private readonly inverse = new THREE.Quaternion();
  private readonly one = new THREE.Vector3(1, 1, 1);
  private theme_color = new THREE.Color();

  constructor(private readonly scene: THREE.Scene) {}

  setWorld(bodies: Bodies, assets: Assets): void {
    this.clear();
    const at = new Float64Array(7);
    for (const plane of bodies.planes) {
      multiply(plane.body.world, 7 * plane.link, plane.pose, 0, at, 0);
      const ground = this.add(new THREE.Color().setRGB(plane.color[0], plane.color[1], plane.color[2], THREE.SRGBColorSpace), plane.texture === '' ? null : assets.texture(plane.texture), false);
      ground.origin.set(at[0], at[1], at[2]);
      const normal = new THREE.Vector3(...plane.normal).normalize().applyQuaternion(new THREE.Quaternion(at[4], at[5], at[6], at[3]));
      ground.turn.setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal);
    }
    if (this.list.length === 0) this.add(new THREE.Color(), null, true);
  }

  setTones(color: string, tint: number, grid: string, grid_strength: number): void {
    this.theme_color.set(color);
    this.uniforms.grid_color.value.set(grid);
    this.uniforms.grid_strength.value = grid_strength;
    for (const ground of this.list) {
      if (ground.fallback) ground.material.color.copy(this.theme_color);
      // A picture keeps more of its own colours.
      else ground.material.color.copy(ground.color).lerp(this.theme_color, ground.material.map ? tint / 2 : tint);
    }
  }

  /** Keeps the fine rings where the camera looks. */
  follow(focus: THREE.Vector3): void {
    for (const ground of this.list) {
      const p = this.local.copy(focus).sub(ground.origin).applyQuaternion(this.inverse.copy(ground.turn).invert());
      p.set(Math.round(p.x / STEP_M) * STEP_M, Math.round(p.y / STEP_M) * STEP_M, 0);
      ground.offset.value.set(p.x, p.y);
      p.applyQuaternion(ground.turn).add(ground.origin);
      ground.mesh.matrix.compose(p, ground.turn, this.one);
      ground.mesh.matrixWorldNeedsUpdate = true;
    }
  }

  dispose(): void {
    this.clear();
    this.geometry.dispose();
  }

  private clear(): void {
    for (const ground of this.list) {
      this.scene.remove(ground.mesh);
      ground.material.dispose();
    }
    this.list.length = 0;
  }

  private add(color: THREE.Color, map: THREE.Texture | null, fallback: boolean): Ground {
    const material = new THREE.MeshStandardMaterial({ map, roughness: 0.95, metalness: 0 });
    const offset = { value: new THREE.Vector2() };
    // Everything that lies on the plane wins over it.
    material.polygonOffset = true;
    material.polygonOffsetFactor = 1;
    material.polygonOffsetUnits = 4;
    material.onBeforeCompile = (shader) => {
      Object.assign(shader.uniforms, this.uniforms, { offset });
      shader.vertexShader = shader.vertexShader
        .replace('#include <common>', '#include <common>\nvarying vec2 on_plane;\nuniform vec2 offset;')
        .replace('#include <begin_vertex>', `#include <begin_vertex>
          on_plane = position.xy + offset;
          #ifdef USE_MAP
            // A picture every metre, as the plane has no size of its own.
            vMapUv = on_plane;
          #endif`);
      shader.fragmentShader = shader.fragmentShader
        .replace('#include <common>', `#include <common>
          varying vec2 on_plane;
          uniform vec3 grid_color;
          uniform float grid_strength;
          float lines(vec2 at, float every, float width) {
            vec2 p = at / every;
            vec2 step_size = fwidth(p);
            vec2 near = abs(fract(p - 0.5) - 0.5) / max(step_size, vec2(1e-6));
            float line = 1.0 - min(min(near.x, near.y) / width, 1.0);
            // Where lines come closer than pixels they would flicker: they go before.
            return line * (1.0 - smoothstep(0.08, 0.35, max(step_size.x, step_size.y)));
          }`)
        .replace('#include <map_fragment>', `#include <map_fragment>
          float grid = max(0.5 * lines(on_plane, 1.0, 1.1), max(lines(on_plane, 10.0, 1.4), 0.6 * lines(on_plane, 100.0, 1.6)));
          diffuseColor.rgb = mix(diffuseColor.rgb, grid_color, grid * grid_strength);`);
    };
    const mesh = new THREE.Mesh(this.geometry, material);
    mesh.receiveShadow = true;
    mesh.matrixAutoUpdate = false;
    mesh.frustumCulled = false;
    mesh.renderOrder = -1;
    const ground: Ground = { mesh, material, color: color.clone(), fallback, origin: new THREE.Vector3(), turn: new THREE.Quaternion(), offset };
    this.list.push(ground);
    this.scene.add(mesh);
    return ground;
  }
}

/** Rings that grow outwards, in the xy plane, facing z. */
function discGeometry(): THREE.BufferGeometry {
  const positions = [0, 0, 0];
  const indices: number[] = [];
  for (let ring = 0; ring < RINGS; ++ring) {
    const radius_m = GROWTH ** ring;
    const first = 1 + ring * SECTORS;
    for (let sector = 0; sector < SECTORS; ++sector) {
      const angle = (2 * Math.PI * sector) / SECTORS;
      positions.push(radius_m * Math.cos(angle), radius_m * Math.sin(angle), 0);
      const here = first + sector;
      const next = first + ((sector + 1) % SECTORS);
      if (ring === 0) indices.push(0, here, next);
      else indices.push(here - SECTORS, here, next, here - SECTORS, next, next - SECTORS);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.Float32BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.Float32BufferAttribute(positions.map((_, i) => (i % 3 === 2 ? 1 : 0)), 3));
  geometry.setAttribute('uv', new THREE.Float32BufferAttribute(new Float32Array((positions.length / 3) * 2), 2));
  geometry.setIndex(indices);
  return geometry;
}
