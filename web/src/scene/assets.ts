// Meshes, grids and textures as the server hands them out: read once, shared by all that name them.
import * as THREE from 'three';

export interface MeshPart {
  first: number;
  triangles: number;
  color: [number, number, number, number];
  /** -1: none. */
  texture: number;
}

export interface MeshBytes {
  positions: Float32Array;
  uvs: Float32Array | null;
  indices: Uint32Array;
  parts: MeshPart[];
}

export interface GridBytes {
  columns: number;
  rows: number;
  size_x_m: number;
  size_y_m: number;
  heights_m: Float32Array;
}

const MESH_MAGIC = 0x314d4c53;
const GRID_MAGIC = 0x31474c53;

/** undefined: the bytes are not a mesh. */
export function readMesh(bytes: ArrayBuffer): MeshBytes | undefined {
  if (bytes.byteLength < 20) return undefined;
  const view = new DataView(bytes);
  if (view.getUint32(0, true) !== MESH_MAGIC) return undefined;
  const vertices = view.getUint32(4, true);
  const triangles = view.getUint32(8, true);
  const has_uv = (view.getUint32(12, true) & 1) !== 0;
  const part_count = view.getUint32(16, true);
  if (bytes.byteLength !== 20 + vertices * (has_uv ? 20 : 12) + triangles * 12 + part_count * 28) return undefined;
  let at = 20;
  const positions = new Float32Array(bytes.slice(at, (at += vertices * 12)));
  const uvs = has_uv ? new Float32Array(bytes.slice(at, (at += vertices * 8))) : null;
  const indices = new Uint32Array(bytes.slice(at, (at += triangles * 12)));
  if (indices.some((i) => i >= vertices) || positions.some((p) => !Number.isFinite(p))) return undefined;
  const parts: MeshPart[] = [];
  for (let i = 0; i < part_count; ++i, at += 28) {
    const first = view.getUint32(at, true);
    const count = view.getUint32(at + 4, true);
    if (first + count > triangles) return undefined;
    const f = (n: number): number => view.getFloat32(at + 8 + 4 * n, true);
    parts.push({ first, triangles: count, color: [f(0), f(1), f(2), f(3)], texture: view.getUint32(at + 24, true) - 1 });
  }
  if (parts.length === 0) parts.push({ first: 0, triangles, color: [0.8, 0.8, 0.8, 1], texture: -1 });
  return { positions, uvs, indices, parts };
}

export function readGrid(bytes: ArrayBuffer): GridBytes | undefined {
  if (bytes.byteLength < 20) return undefined;
  const view = new DataView(bytes);
  const columns = view.getUint32(4, true);
  const rows = view.getUint32(8, true);
  if (view.getUint32(0, true) !== GRID_MAGIC || columns < 2 || rows < 2) return undefined;
  if (bytes.byteLength !== 20 + columns * rows * 4) return undefined;
  const heights_m = new Float32Array(bytes.slice(20));
  if (heights_m.some((h) => !Number.isFinite(h))) return undefined;
  return { columns, rows, size_x_m: view.getFloat32(12, true), size_y_m: view.getFloat32(16, true), heights_m };
}

/** A crease sharper than this shows as an edge. */
const CREASE_COS = Math.cos((38 * Math.PI) / 180);

/**
 * One normal per corner of each triangle (9 numbers a triangle): the mean, weighted by area, of the faces around the point
 * that bend less than a crease. Points are the same when their coordinates are, whatever their index.
 */
export function creasedNormals(positions: Float32Array, indices: ArrayLike<number>): Float32Array {
  const corners = indices.length;
  const faces = new Float32Array(corners);
  for (let c = 0; c < corners; c += 3) {
    const a = 3 * indices[c], b = 3 * indices[c + 1], d = 3 * indices[c + 2];
    const ux = positions[b] - positions[a], uy = positions[b + 1] - positions[a + 1], uz = positions[b + 2] - positions[a + 2];
    const vx = positions[d] - positions[a], vy = positions[d + 1] - positions[a + 1], vz = positions[d + 2] - positions[a + 2];
    faces[c] = uy * vz - uz * vy;
    faces[c + 1] = uz * vx - ux * vz;
    faces[c + 2] = ux * vy - uy * vx;
  }
  const points = weld(positions);
  // The corners at each point, as one list with a beginning per point.
  const begin = new Int32Array(points.count + 1);
  for (let c = 0; c < corners; ++c) ++begin[points.of[indices[c]] + 1];
  for (let p = 0; p < points.count; ++p) begin[p + 1] += begin[p];
  const list = new Int32Array(corners);
  const next = begin.slice();
  for (let c = 0; c < corners; ++c) list[next[points.of[indices[c]]]++] = c;
  const normals = new Float32Array(3 * corners);
  for (let c = 0; c < corners; ++c) {
    const face = c - (c % 3);
    const nx = faces[face], ny = faces[face + 1], nz = faces[face + 2];
    const length = Math.hypot(nx, ny, nz);
    let x = nx, y = ny, z = nz;
    const point = points.of[indices[c]];
    // A fan of thousands of triangles about one point would take its square: beyond 64 the face's own normal will do.
    if (begin[point + 1] - begin[point] <= 64) {
      for (let n = begin[point]; n < begin[point + 1]; ++n) {
        const other = list[n] - (list[n] % 3);
        if (other === face) continue;
        const ox = faces[other], oy = faces[other + 1], oz = faces[other + 2];
        if (nx * ox + ny * oy + nz * oz < CREASE_COS * length * Math.hypot(ox, oy, oz)) continue;
        x += ox;
        y += oy;
        z += oz;
      }
    }
    const scale = 1 / (Math.hypot(x, y, z) || 1);
    normals[3 * c] = x * scale;
    normals[3 * c + 1] = y * scale;
    normals[3 * c + 2] = z * scale;
  }
  return normals;
}

/** Numbers the distinct points: `of[vertex]` < count. An open hash table, since a Map of strings takes seconds. */
function weld(positions: Float32Array): { of: Int32Array; count: number } {
  const vertices = positions.length / 3;
  const bits = new Int32Array(positions.buffer, positions.byteOffset, positions.length);
  let size = 16;
  while (size < 2 * vertices) size *= 2;
  const table = new Int32Array(size).fill(-1);
  const of = new Int32Array(vertices);
  let count = 0;
  for (let v = 0; v < vertices; ++v) {
    let hash = Math.imul(bits[3 * v], 73856093) ^ Math.imul(bits[3 * v + 1], 19349663) ^ Math.imul(bits[3 * v + 2], 83492791);
    hash ^= hash >>> 15;
    for (let at = hash & (size - 1); ; at = (at + 1) & (size - 1)) {
      const other = table[at];
      if (other < 0) {
        table[at] = v;
        of[v] = count++;
        break;
      }
      if (positions[3 * other] === positions[3 * v] && positions[3 * other + 1] === positions[3 * v + 1] && positions[3 * other + 2] === positions[3 * v + 2]) {
        of[v] = of[other];
        break;
      }
    }
  }
  return { of, count };
}

/** Terrain about its frame's origin; each cell is split from its corner of least x and y to the opposite one. */
export function gridGeometry(grid: GridBytes): THREE.BufferGeometry {
  const { columns, rows } = grid;
  const positions = new Float32Array(3 * columns * rows);
  const uvs = new Float32Array(2 * columns * rows);
  for (let row = 0, v = 0; row < rows; ++row) {
    for (let column = 0; column < columns; ++column, ++v) {
      const u = column / (columns - 1);
      const w = row / (rows - 1);
      positions[3 * v] = (u - 0.5) * grid.size_x_m;
      positions[3 * v + 1] = (w - 0.5) * grid.size_y_m;
      positions[3 * v + 2] = grid.heights_m[v];
      uvs[2 * v] = u;
      uvs[2 * v + 1] = w;
    }
  }
  const indices = new Uint32Array(6 * (columns - 1) * (rows - 1));
  let at = 0;
  for (let row = 0; row + 1 < rows; ++row) {
    for (let column = 0; column + 1 < columns; ++column) {
      const a = row * columns + column;
      indices.set([a, a + 1, a + columns + 1, a, a + columns + 1, a + columns], at);
      at += 6;
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('uv', new THREE.BufferAttribute(uvs, 2));
  geometry.setIndex(new THREE.BufferAttribute(indices, 1));
  geometry.computeVertexNormals();
  return geometry;
}

/** Loads by id; each asset once, failures too, with one warning on the console. */
export class Assets {
  private readonly pending = new Map<string, Promise<unknown>>();
  private readonly textures = new Map<string, THREE.Texture>();
  private disposed = false;

  constructor(
    private readonly base: string,
    private readonly changed: () => void,
  ) {}

  mesh(id: string): Promise<MeshBytes | undefined> {
    return this.once(`mesh/${id}`, readMesh);
  }

  grid(id: string): Promise<GridBytes | undefined> {
    return this.once(`grid/${id}`, readGrid);
  }

  /** A texture that is a checker until its picture is there. */
  texture(id: string): THREE.Texture {
    const known = this.textures.get(id);
    if (known) return known;
    const texture = checker();
    this.textures.set(id, texture);
    void this.fetch(`texture/${id}`)
      .then(async (response) => createImageBitmap(await response.blob(), { imageOrientation: 'flipY', premultiplyAlpha: 'none' }))
      .then((picture) => {
        if (this.disposed) return;
        // A canvas of another size needs storage of its own.
        texture.dispose();
        texture.image = picture;
        // The bitmap is flipped already; WebGL ignores the flag for bitmaps anyhow.
        texture.flipY = false;
        texture.magFilter = THREE.LinearFilter;
        texture.needsUpdate = true;
        this.changed();
      })
      .catch((error: unknown) => console.warn(`texture ${id} is not drawn: ${String(error)}`));
    return texture;
  }

  dispose(): void {
    this.disposed = true;
    this.forget();
  }

  /** For another server, whose ids mean other things. */
  forget(): void {
    this.pending.clear();
    for (const texture of this.textures.values()) texture.dispose();
    this.textures.clear();
  }

  private once<T>(path: string, read: (bytes: ArrayBuffer) => T | undefined): Promise<T | undefined> {
    let result = this.pending.get(path) as Promise<T | undefined> | undefined;
    if (result === undefined) {
      result = this.fetch(path)
        .then(async (response) => {
          const value = read(await response.arrayBuffer());
          if (value === undefined) throw new Error('damaged');
          return value;
        })
        .catch((error: unknown) => {
          console.warn(`${path} is drawn as a checkered box: ${String(error)}`);
          return undefined;
        });
      this.pending.set(path, result);
    }
    return result;
  }

  private async fetch(path: string): Promise<Response> {
    const response = await fetch(`${this.base}/${path.split('/').map(encodeURIComponent).join('/')}`);
    if (!response.ok) throw new Error(`the server answers ${response.status}`);
    return response;
  }
}

/** What is drawn in the place of a picture that is not there. */
export function checker(): THREE.Texture {
  const canvas = document.createElement('canvas');
  canvas.width = canvas.height = 64;
  const context = canvas.getContext('2d');
  if (context) {
    context.fillStyle = '#d9d9de';
    context.fillRect(0, 0, 64, 64);
    context.fillStyle = '#c061cb';
    for (let i = 0; i < 16; ++i) if ((i + (i >> 2)) % 2) context.fillRect((i % 4) * 16, (i >> 2) * 16, 16, 16);
  }
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.magFilter = THREE.NearestFilter;
  texture.anisotropy = 8;
  return texture;
}
