// Names over robots: the nearest 50, drawn in the scene itself so that pictures and videos have them.
//
// One atlas of drawn names and one draw call; quads face the eye with a fixed size in pixels. Names that would cover a
// nearer one are left out.
import * as THREE from 'three';
import type { Body } from '../bodies';

const COLUMNS = 4;
const ROWS = 16;
const MOST = 50;
const CELL_W = 256;
const CELL_H = 40;
const PX_PER_CELL = 0.5;

interface Cell {
  index: number;
  name: string;
  width: number;
  used: number;
}

export class Labels {
  private readonly canvas = document.createElement('canvas');
  private readonly texture: THREE.CanvasTexture;
  private readonly mesh: THREE.Mesh<THREE.InstancedBufferGeometry, THREE.ShaderMaterial>;
  private readonly places = new THREE.InstancedBufferAttribute(new Float32Array(3 * MOST), 3).setUsage(THREE.DynamicDrawUsage);
  private readonly cells_of = new THREE.InstancedBufferAttribute(new Float32Array(4 * MOST), 4).setUsage(THREE.DynamicDrawUsage);
  private readonly cells = new Map<string, Cell>();
  private readonly free: number[] = Array.from({ length: COLUMNS * ROWS }, (_, i) => i).reverse();
  private tick = 0;
  private ink = '#10151c';
  private paper = 'rgba(255,255,255,0.82)';
  private readonly nearest: { body: Body; distance: number; x: number; y: number; z: number }[] = [];
  private readonly boxes = new Float32Array(4 * MOST);
  private readonly projected = new THREE.Vector3();

  constructor(private readonly parent: THREE.Object3D) {
    this.canvas.width = COLUMNS * CELL_W;
    this.canvas.height = ROWS * CELL_H;
    this.texture = new THREE.CanvasTexture(this.canvas);
    this.texture.colorSpace = THREE.SRGBColorSpace;
    this.texture.generateMipmaps = false;
    this.texture.minFilter = THREE.LinearFilter;
    this.texture.premultiplyAlpha = true;
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setAttribute('position', new THREE.Float32BufferAttribute([-0.5, 0, 0, 0.5, 0, 0, 0.5, 1, 0, -0.5, 1, 0], 3));
    geometry.setIndex([0, 1, 2, 0, 2, 3]);
    geometry.setAttribute('place', this.places);
    geometry.setAttribute('cell', this.cells_of);
    geometry.instanceCount = 0;
    this.mesh = new THREE.Mesh(
      geometry,
      new THREE.ShaderMaterial({
        transparent: true,
        depthTest: false,
        depthWrite: false,
        blending: THREE.CustomBlending,
        blendSrc: THREE.OneFactor,
        blendDst: THREE.OneMinusSrcAlphaFactor,
        uniforms: { atlas: { value: this.texture }, view_px: { value: new THREE.Vector2(1, 1) } },
        // The cell's corner, in cells, the width used of it, and how much higher than usual it hangs.
        vertexShader: `attribute vec3 place; attribute vec4 cell; uniform vec2 view_px; varying vec2 at;
          void main() {
            vec4 p = projectionMatrix * modelViewMatrix * vec4(place, 1.0);
            vec2 size_px = vec2(${(CELL_W * PX_PER_CELL).toFixed(1)} * cell.z, ${(CELL_H * PX_PER_CELL).toFixed(1)});
            vec2 middle = floor((p.xy / p.w * 0.5 + 0.5) * view_px);
            p.xy = ((middle + position.xy * size_px + vec2(0.0, 6.0 + cell.w)) / view_px * 2.0 - 1.0) * p.w;
            gl_Position = p;
            vec2 within = vec2((position.x + 0.5) * cell.z, 1.0 - position.y);
            at = (cell.xy + within) / vec2(${COLUMNS.toFixed(1)}, ${ROWS.toFixed(1)});
            at.y = 1.0 - at.y;
          }`,
        fragmentShader: `uniform sampler2D atlas; varying vec2 at;
          void main() {
            gl_FragColor = texture2D(atlas, at);
            if (gl_FragColor.a < 0.01) discard;
            #include <colorspace_fragment>
          }`,
      }),
    );
    this.mesh.frustumCulled = false;
    this.mesh.renderOrder = 20;
    parent.add(this.mesh);
  }

  set visible(show: boolean) {
    this.mesh.visible = show;
  }

  get visible(): boolean {
    return this.mesh.visible;
  }

  setTheme(theme: 'light' | 'dark'): void {
    this.ink = theme === 'light' ? '#10151c' : '#eef3fa';
    this.paper = theme === 'light' ? 'rgba(255,255,255,0.8)' : 'rgba(16,20,27,0.72)';
    for (const cell of this.cells.values()) this.draw(cell);
    this.texture.needsUpdate = true;
  }

  /** Chooses and places the names. @param width_px, height_px of the view in CSS pixels @param lift_px  of a name over its usual place */
  update(bodies: Body[], camera: THREE.Camera, width_px: number, height_px: number, selected: Body | null, lift_px: (body: Body) => number): void {
    if (!this.mesh.visible) return;
    ++this.tick;
    this.mesh.material.uniforms.view_px.value.set(width_px, height_px);
    this.choose(bodies, camera, selected);
    let count = 0;
    const boxes = this.boxes;
    for (const candidate of this.nearest) {
      const cell = this.cellOf(candidate.body.instance.name);
      if (cell === null) continue;
      const half_w = (CELL_W * PX_PER_CELL * cell.width) / 2;
      const x = (candidate.x * 0.5 + 0.5) * width_px;
      const lift = lift_px(candidate.body);
      const y = (candidate.y * 0.5 + 0.5) * height_px + lift;
      let covered = false;
      for (let i = 0; i < count && !covered; ++i) {
        covered = Math.abs(boxes[4 * i] - x) < boxes[4 * i + 2] + half_w + 2 && Math.abs(boxes[4 * i + 1] - y) < CELL_H * PX_PER_CELL;
      }
      if (covered) continue;
      boxes[4 * count] = x;
      boxes[4 * count + 1] = y;
      boxes[4 * count + 2] = half_w;
      const world = candidate.body.world;
      this.places.setXYZ(count, world[0], world[1], world[2] + candidate.body.bounds.max.z);
      this.cells_of.setXYZW(count, cell.index % COLUMNS, Math.floor(cell.index / COLUMNS), cell.width, lift);
      ++count;
    }
    this.mesh.geometry.instanceCount = count;
    this.places.needsUpdate = this.cells_of.needsUpdate = true;
  }

  dispose(): void {
    this.parent.remove(this.mesh);
    this.mesh.geometry.dispose();
    this.mesh.material.dispose();
    this.texture.dispose();
  }

  /** The nearest in view, nearest first; the selected before all. */
  private choose(bodies: Body[], camera: THREE.Camera, selected: Body | null): void {
    const nearest = this.nearest;
    nearest.length = 0;
    const p = this.projected;
    for (const body of bodies) {
      p.set(body.world[0], body.world[1], body.world[2] + body.bounds.max.z).project(camera);
      if (p.z < -1 || p.z > 1 || Math.abs(p.x) > 1.05 || Math.abs(p.y) > 1.05) continue;
      const distance = body === selected ? -2 : p.z;
      if (nearest.length === MOST && distance >= nearest[MOST - 1].distance) continue;
      let at = nearest.length;
      while (at > 0 && nearest[at - 1].distance > distance) --at;
      nearest.splice(at, 0, { body, distance, x: p.x, y: p.y, z: p.z });
      if (nearest.length > MOST) nearest.pop();
    }
  }

  private cellOf(name: string): Cell | null {
    let cell = this.cells.get(name);
    if (cell === undefined) {
      let index = this.free.pop();
      if (index === undefined) {
        // The one that was not seen for longest gives its place.
        let oldest: Cell | null = null;
        for (const other of this.cells.values()) if (other.used < this.tick && (oldest === null || other.used < oldest.used)) oldest = other;
        if (oldest === null) return null;
        this.cells.delete(oldest.name);
        index = oldest.index;
      }
      cell = { index, name, width: 1, used: this.tick };
      this.cells.set(name, cell);
      this.draw(cell);
      this.texture.needsUpdate = true;
    }
    cell.used = this.tick;
    return cell;
  }

  private draw(cell: Cell): void {
    const context = this.canvas.getContext('2d');
    if (context === null) return;
    const x = (cell.index % COLUMNS) * CELL_W;
    const y = Math.floor(cell.index / COLUMNS) * CELL_H;
    context.clearRect(x, y, CELL_W, CELL_H);
    context.font = '500 23px system-ui, "Segoe UI", Roboto, "Helvetica Neue", sans-serif';
    let text = cell.name;
    while (text.length > 1 && context.measureText(text).width > CELL_W - 24) text = `${text.slice(0, -2)}…`;
    const width = Math.ceil(context.measureText(text).width) + 20;
    cell.width = (width + 2) / CELL_W;
    context.fillStyle = this.paper;
    context.beginPath();
    context.roundRect(x + 1, y + 3, width, CELL_H - 6, 9);
    context.fill();
    context.fillStyle = this.ink;
    context.textBaseline = 'middle';
    context.fillText(text, x + 11, y + CELL_H / 2 + 1);
  }
}
