// Sky, light, ground and grid: what is there before anything stands in the world.
import * as THREE from 'three';
import type { World } from '../protocol';
import type { Assets } from './assets';
import type { Bodies } from './bodies';
import { Grounds } from './ground';
import { Zones } from './zones';
import { multiply } from './poses';

export type Theme = 'light' | 'dark';

interface Tones {
  zenith: string;
  horizon: string;
  ground: string;
  hemi_sky: string;
  hemi_ground: string;
  hemi: number;
  sun: number;
  grid: string;
  grid_strength: number;
  /** The ground's colour is drawn this much towards the theme's. */
  ground_tint: number;
}

const TONES: Record<Theme, Tones> = {
  light: { zenith: '#8fb4dc', horizon: '#e9eef3', ground: '#d3d6da', hemi_sky: '#eef4fb', hemi_ground: '#b9b7b2', hemi: 1.55, sun: 2.7, grid: '#3c4654', grid_strength: 0.2, ground_tint: 0.12 },
  dark: { zenith: '#0c1118', horizon: '#28303c', ground: '#222831', hemi_sky: '#c6d2e4', hemi_ground: '#5a5d66', hemi: 1.35, sun: 1.7, grid: '#b8cbe6', grid_strength: 0.13, ground_tint: 0.82 },
};

/** A forward renderer pays for every lamp in every pixel. */
const MOST_LAMPS = 8;

export class Backdrop {
  readonly scene: THREE.Scene;
  private readonly sky: THREE.Mesh<THREE.SphereGeometry, THREE.ShaderMaterial>;
  private readonly hemi = new THREE.HemisphereLight();
  /** From the eye, weak: sides that the sun does not reach keep their shape. */
  private readonly fill = new THREE.DirectionalLight('#ffffff', 0.4);
  private readonly suns: { light: THREE.DirectionalLight; strength: number }[] = [];
  private readonly lamps: { light: THREE.PointLight | THREE.SpotLight; lamp: { body: { world: Float64Array }; link: number; pose: number[] } | null }[] = [];
  private readonly grounds: Grounds;
  private readonly zones: Zones;
  private readonly fog = new THREE.Fog(0, 1, 2);
  private readonly direction = new THREE.Vector3(-0.4, 0.3, -0.85);
  private tones = TONES.light;
  private shows_grid = true;
  private ambient = 1;
  private readonly shadow_box = { x: NaN, y: NaN, z: NaN, radius: 0 };

  constructor(scene: THREE.Scene) {
    this.scene = scene;
    this.grounds = new Grounds(scene);
    this.zones = new Zones(scene);
    this.sky = new THREE.Mesh(
      new THREE.SphereGeometry(1, 32, 16).rotateX(Math.PI / 2),
      new THREE.ShaderMaterial({
        side: THREE.BackSide,
        depthWrite: false,
        depthTest: false,
        uniforms: { zenith: { value: new THREE.Color() }, horizon: { value: new THREE.Color() } },
        vertexShader: `varying vec3 direction;
          void main() { direction = position; vec4 p = projectionMatrix * vec4(mat3(modelViewMatrix) * position, 1.0); gl_Position = p; }`,
        fragmentShader: `uniform vec3 zenith; uniform vec3 horizon; varying vec3 direction;
          float noise(vec2 p) { return fract(sin(dot(p, vec2(12.9898, 78.233))) * 43758.5453); }
          void main() {
            float up = clamp(normalize(direction).z, 0.0, 1.0);
            gl_FragColor = vec4(mix(horizon, zenith, 1.0 - pow(1.0 - up, 2.2)), 1.0);
            #include <colorspace_fragment>
            // Half a step of noise hides the bands of a wide gradient.
            gl_FragColor.rgb += (noise(gl_FragCoord.xy) - 0.5) / 255.0;
          }`,
      }),
    );
    this.sky.frustumCulled = false;
    this.sky.renderOrder = -10;
    this.hemi.position.set(0, 0, 1);
    scene.fog = this.fog;
    scene.add(this.sky, this.hemi, this.fill, this.fill.target);
  }

  setTheme(theme: Theme): void {
    const tones = (this.tones = TONES[theme]);
    (this.sky.material.uniforms.zenith.value as THREE.Color).set(tones.zenith);
    (this.sky.material.uniforms.horizon.value as THREE.Color).set(tones.horizon);
    this.fog.color.set(tones.horizon);
    this.hemi.color.set(tones.hemi_sky);
    this.hemi.groundColor.set(tones.hemi_ground);
    this.hemi.intensity = tones.hemi * this.ambient;
    for (const sun of this.suns) sun.light.intensity = tones.sun * sun.strength;
    this.grounds.setTones(tones.ground, tones.ground_tint, tones.grid, this.shows_grid ? tones.grid_strength : 0);
  }

  setGrid(show: boolean): void {
    this.shows_grid = show;
    this.setTheme(this.tones === TONES.dark ? 'dark' : 'light');
  }

  setWorld(world: World, bodies: Bodies, assets: Assets): void {
    this.setLights(world, bodies);
    this.grounds.setWorld(bodies, assets);
    this.zones.setWorld(world);
    this.setTheme(this.tones === TONES.dark ? 'dark' : 'light');
  }

  /**
   * Fits sky, fog and shadows to what the camera sees. `focus`: what it looks at; `reach_m`: how far that is.
   * True when the shadows must be drawn anew.
   */
  follow(camera: THREE.Camera, focus: THREE.Vector3, reach_m: number, map_texels: number): boolean {
    this.grounds.follow(focus);
    this.fill.position.setFromMatrixPosition(camera.matrixWorld);
    this.fill.target.position.copy(focus);
    this.fill.target.updateMatrixWorld();
    const orthographic = camera instanceof THREE.OrthographicCamera;
    this.sky.visible = !orthographic;
    this.fog.near = orthographic ? 1e6 : Math.max(25, 4 * reach_m);
    this.fog.far = orthographic ? 2e6 : Math.max(140, 22 * reach_m);
    // In steps, since each other size of the map moves all edges.
    const radius_m = Math.min(120, Math.max(3, Math.sqrt(2) ** Math.ceil(2 * Math.log2(Math.max(0.1, 2.2 * reach_m)))));
    return this.fitShadows(focus, radius_m, map_texels);
  }

  setShadows(show: boolean): void {
    for (const sun of this.suns) sun.light.castShadow = show && sun === this.suns[0];
    this.shadow_box.x = NaN;
  }

  /** Lamps on links go where their links went. */
  placeLamps(): void {
    const at = this.lamp_pose;
    for (const { light, lamp } of this.lamps) {
      if (lamp === null) continue;
      multiply(lamp.body.world, 7 * lamp.link, lamp.pose, 0, at, 0);
      placeLight(light, at);
    }
  }

  dispose(): void {
    this.sky.geometry.dispose();
    this.sky.material.dispose();
    this.grounds.dispose();
    this.zones.dispose();
    for (const sun of this.suns) sun.light.dispose();
  }

  private readonly lamp_pose = new Float64Array(7);

  private fitShadows(focus: THREE.Vector3, radius_m: number, map_texels: number): boolean {
    const sun = this.suns[0]?.light;
    if (sun === undefined || !sun.castShadow) return false;
    // On the map's own raster, else edges crawl while the camera moves.
    const texel_m = (2 * radius_m) / map_texels;
    const step_m = texel_m * Math.max(1, Math.round(radius_m / 8 / texel_m));
    const x = Math.round(focus.x / step_m) * step_m;
    const y = Math.round(focus.y / step_m) * step_m;
    const z = Math.round(focus.z / step_m) * step_m;
    const box = this.shadow_box;
    if (box.x === x && box.y === y && box.z === z && box.radius === radius_m) return false;
    Object.assign(box, { x, y, z, radius: radius_m });
    sun.target.position.set(x, y, z);
    sun.position.set(x, y, z).addScaledVector(this.direction, -3 * radius_m);
    sun.target.updateMatrixWorld();
    const camera = sun.shadow.camera;
    camera.left = camera.bottom = -radius_m;
    camera.right = camera.top = radius_m;
    camera.near = 0.1;
    camera.far = 6 * radius_m;
    camera.updateProjectionMatrix();
    sun.shadow.mapSize.set(map_texels, map_texels);
    sun.shadow.normalBias = texel_m * 0.6;
    sun.shadow.bias = -0.0002;
    sun.shadow.radius = 2.2;
    return true;
  }

  private setLights(world: World, bodies: Bodies): void {
    for (const { light } of [...this.suns, ...this.lamps]) {
      this.scene.remove(light);
      if ('target' in light) this.scene.remove(light.target);
      light.dispose();
    }
    this.suns.length = this.lamps.length = 0;
    this.shadow_box.x = NaN;
    const brightness = (world.ambient[0] + world.ambient[1] + world.ambient[2]) / 3;
    // 0.4 is what files say that say nothing; a cave may be darker and a desert brighter, in reason.
    this.ambient = Math.min(1.4, Math.max(0.45, 0.6 + brightness));
    const directional = world.lights.filter((l) => l.type === 'directional');
    for (const light of directional.slice(0, 3)) {
      const [, , , w, x, y, z] = light.pose;
      this.addSun(new THREE.Vector3(0, 0, -1).applyQuaternion(new THREE.Quaternion(x, y, z, w)), new THREE.Color(light.color[0], light.color[1], light.color[2]), 1 / Math.sqrt(Math.min(3, directional.length)));
    }
    const lamps = [
      ...world.lights.filter((l) => l.type !== 'directional').map((light) => ({ light, lamp: null })),
      ...bodies.lights.map(({ body, link, light }) => ({ light, lamp: { body, link, pose: light.pose as number[] } })),
    ];
    for (const { light, lamp } of lamps.slice(0, MOST_LAMPS)) this.addLamp(light, lamp);
    if (directional.length === 0 && lamps.length === 0) this.addSun(new THREE.Vector3(-0.45, 0.35, -0.82), new THREE.Color(1, 0.98, 0.95), 1);
  }

  private addSun(direction: THREE.Vector3, color: THREE.Color, share: number): void {
    const brightest = Math.max(color.r, color.g, color.b, 1e-3);
    const light = new THREE.DirectionalLight(color.multiplyScalar(1 / brightest));
    if (direction.z > -0.15) direction.z = -0.15;
    direction.normalize();
    if (this.suns.length === 0) this.direction.copy(direction);
    light.position.copy(direction).multiplyScalar(-10);
    light.castShadow = this.suns.length === 0;
    this.suns.push({ light, strength: share * Math.min(1.15, 0.55 + 0.5 * brightest) });
    this.scene.add(light, light.target);
  }

  private addLamp(light: World['lights'][number], lamp: (typeof this.lamps)[number]['lamp']): void {
    const color = new THREE.Color(light.color[0], light.color[1], light.color[2]);
    // Files tell attenuation by three numbers, three.js by one power: take the strength at 1 m, and the steepest power.
    const at_1_m = 1 / Math.max(0.2, light.constant + light.linear + light.quadratic);
    const decay = light.quadratic > 0 ? 2 : light.linear > 0 ? 1 : 0;
    // Unlimited is told as null; three.js takes 0 for that.
    const range_m = Number.isFinite(light.range_m) ? light.range_m : 0;
    const made = light.type === 'spot'
      ? new THREE.SpotLight(color, 3 * at_1_m, range_m, Math.min(1.5, Math.max(0.05, light.outer_rad / 2 || 0.5)), 0.4, decay)
      : new THREE.PointLight(color, 3 * at_1_m, range_m, decay);
    this.scene.add(made);
    if (made instanceof THREE.SpotLight) this.scene.add(made.target);
    this.lamps.push({ light: made, lamp });
    placeLight(made, Float64Array.from(light.pose));
  }

}

const DOWN = new THREE.Vector3();
const TURN = new THREE.Quaternion();

function placeLight(light: THREE.PointLight | THREE.SpotLight, at: Float64Array): void {
  light.position.set(at[0], at[1], at[2]);
  if (light instanceof THREE.SpotLight) {
    DOWN.set(0, 0, -1).applyQuaternion(TURN.set(at[4], at[5], at[6], at[3]));
    light.target.position.copy(light.position).add(DOWN);
    light.target.updateMatrixWorld();
  }
}
