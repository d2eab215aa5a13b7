// Geometries of shapes, and which parts of a link are drawn together.
//
// Few draw calls make a crowd cheap. So the plain visuals of a link become one geometry with its colours in the
// vertices, shared by all models whose links look the same; and a link of one plain primitive is a unit box, ball or
// cylinder that is scaled and coloured per instance, shared by everything.
import * as THREE from 'three';
import { mergeGeometries } from 'three/examples/jsm/utils/BufferGeometryUtils.js';
import type { Color, Link, Material, Pose, Shape } from '../protocol';
import { creasedNormals, gridGeometry, type Assets, type MeshBytes } from './assets';
import { localMatrix } from './poses';

export interface Surface {
  /** Of one color for each instance, or the vertices' own. */
  vertex_colors: boolean;
  texture: string;
  opacity: number;
  roughness: number;
  emissive: number;
  double_sided: boolean;
  wireframe: boolean;
  checker: boolean;
}

/** One batch that an instance of a link takes part in. */
export interface Part {
  link: number;
  /** Same key, same geometry. */
  geometry_key: string;
  geometry: () => THREE.BufferGeometry;
  surface: Surface;
  color: Color;
  /** 12 numbers: see poses.ts. */
  local: Float64Array;
  cast_shadows: boolean;
}

const IDENTITY: Pose = [0, 0, 0, 1, 0, 0, 0];
const NO_MATERIAL: Material = { diffuse: [0.75, 0.75, 0.78, 1] };

const PLAIN: Surface = { vertex_colors: false, texture: '', opacity: 1, roughness: 0.7, emissive: 0, double_sided: false, wireframe: false, checker: false };
const CHECKER: Surface = { ...PLAIN, checker: true, roughness: 0.9 };

export const surfaceKey = (s: Surface): string =>
  `${+s.vertex_colors}${+s.double_sided}${+s.wireframe}${+s.checker}|${s.texture}|${s.opacity}|${s.roughness}|${s.emissive}`;

function surfaceOf(material: Material): Surface {
  const specular = material.specular ?? [0, 0, 0, 1];
  const shine = Math.max(specular[0], specular[1], specular[2]);
  // Three steps only: each more would split batches for what nobody sees.
  const roughness = shine > 0.6 ? 0.35 : shine > 0.25 ? 0.55 : 0.75;
  const e = material.emissive ?? [0, 0, 0, 1];
  const emissive = (Math.round(e[0] * 255) << 16) | (Math.round(e[1] * 255) << 8) | Math.round(e[2] * 255);
  return { ...PLAIN, roughness, emissive, texture: material.texture ?? '', opacity: clamp01(material.diffuse[3] ?? 1) };
}

const clamp01 = (v: number): number => Math.min(1, Math.max(0, Number.isFinite(v) ? v : 1));

/**
 * A primitive as a unit geometry and the scale that makes it; undefined: it cannot be scaled from one. Small round things
 * have fewer facets: a thousand casters of a thousand triangles are a million that nobody sees.
 */
function unitOf(shape: Shape): { key: string; scale: [number, number, number] } | undefined {
  switch (shape.type) {
    case 'box':
      return { key: 'box', scale: shape.size };
    case 'sphere':
      return { key: `sphere${fineness(shape.radius)}`, scale: [shape.radius, shape.radius, shape.radius] };
    case 'ellipsoid':
      return { key: `sphere${fineness(Math.max(...shape.radii))}`, scale: shape.radii };
    case 'cylinder':
    case 'cone':
      return { key: `${shape.type}${fineness(shape.radius)}`, scale: [shape.radius, shape.radius, shape.length] };
    default:
      return undefined;
  }
}

/** Facets around, by radius: a chord's sagitta stays below a millimetre or so. */
function fineness(radius_m: number): number {
  return radius_m < 0.04 ? 14 : radius_m < 0.15 ? 24 : radius_m < 1 ? 40 : 72;
}

function unitGeometry(key: string): THREE.BufferGeometry {
  const [, name, count] = /^([a-z]+)(\d*)$/.exec(key) ?? [];
  const facets = Number(count);
  switch (name) {
    case 'sphere':
      return new THREE.SphereGeometry(1, facets, Math.round(facets * 0.6)).rotateX(Math.PI / 2);
    case 'cylinder':
      return new THREE.CylinderGeometry(1, 1, 1, facets).rotateX(Math.PI / 2);
    case 'cone':
      return new THREE.ConeGeometry(1, 1, facets).rotateX(Math.PI / 2);
    default:
      return new THREE.BoxGeometry(1, 1, 1);
  }
}

/** Turned from an arc of radius `profile`, with flat ends. */
function barrelGeometry(radius: number, profile: number, length: number): THREE.BufferGeometry {
  const half = length / 2;
  const rings = 6;
  const points = [new THREE.Vector2(0, -half)];
  for (let i = 0; i <= rings; i++) {
    const z = half * ((2 * i) / rings - 1);
    points.push(new THREE.Vector2(Math.max(0, radius - profile + Math.sqrt(profile * profile - z * z)), z));
  }
  points.push(new THREE.Vector2(0, half));
  return new THREE.LatheGeometry(points, fineness(radius)).rotateX(Math.PI / 2);
}

/** Any primitive at its size; undefined for shapes of assets, planes, and what this page does not know. */
export function primitiveGeometry(shape: Shape): THREE.BufferGeometry | undefined {
  if (shape.type === 'capsule') {
    return new THREE.CapsuleGeometry(shape.radius, shape.length, 8, 24).rotateX(Math.PI / 2);
  }
  if (shape.type === 'barrel') return barrelGeometry(shape.radius, shape.profile, shape.length);
  const unit = unitOf(shape);
  return unit && unitGeometry(unit.key).scale(...unit.scale);
}

const isPrimitive = (shape: Shape): boolean => shape.type === 'capsule' || shape.type === 'barrel' || unitOf(shape) !== undefined;

/** The parts of a link that are known at once; `later` gets those that need an asset. Planes are drawn elsewhere. */
export function partsOfLink(link: Link, index: number, assets: Assets, later: (parts: Part[]) => void): Part[] {
  const parts: Part[] = [];
  const merged = new Map<string, { visuals: typeof link.visuals; surface: Surface }>();
  for (const visual of link.visuals) {
    const material = visual.material ?? NO_MATERIAL;
    const surface = surfaceOf(material);
    const common = { link: index, color: material.diffuse, cast_shadows: visual.cast_shadows !== false };
    const shape = visual.shape;
    if (shape.type === 'plane') continue;
    if (shape.type === 'mesh') {
      const scale = shape.scale ?? [1, 1, 1];
      const local = localMatrix(visual.pose, ...scale);
      void assets.mesh(shape.mesh).then((mesh) => {
        later(mesh ? meshParts(mesh, shape.mesh, material, surface, { ...common, local }) : [placeholder(index, visual.pose)]);
      });
    } else if (shape.type === 'heightmap') {
      const local = localMatrix(visual.pose, 1, 1, 1);
      void assets.grid(shape.grid).then((grid) => {
        later(grid ? [{ ...common, geometry_key: `grid:${shape.grid}`, geometry: () => gridGeometry(grid), surface: { ...surface, double_sided: true }, local }] : [placeholder(index, visual.pose)]);
      });
    } else if (!isPrimitive(shape)) {
      console.warn(`shape "${String((shape as { type: unknown }).type)}" of ${link.name} is drawn as a checkered box`);
      parts.push(placeholder(index, visual.pose));
    } else if (surface.texture !== '' || surface.opacity < 1) {
      // Each by itself: see-through things are sorted by batch, and a picture keeps its coordinates.
      parts.push(primitivePart(shape, visual.pose, surface, common));
    } else {
      const key = `${surfaceKey(surface)}|${+common.cast_shadows}`;
      const group = merged.get(key);
      if (group) group.visuals.push(visual);
      else merged.set(key, { visuals: [visual], surface });
    }
  }
  for (const { visuals, surface } of merged.values()) {
    const first = visuals[0];
    const cast_shadows = first.cast_shadows !== false;
    const material = first.material ?? NO_MATERIAL;
    if (visuals.length === 1) {
      parts.push(primitivePart(first.shape, first.pose, surface, { link: index, color: material.diffuse, cast_shadows }));
      continue;
    }
    // The content is the key, so that the wheels of all robots are one batch.
    const key = JSON.stringify(visuals.map((v) => [v.shape, v.pose, (v.material ?? NO_MATERIAL).diffuse]));
    parts.push({
      link: index, color: [1, 1, 1, 1], cast_shadows, local: localMatrix(IDENTITY, 1, 1, 1),
      surface: { ...surface, vertex_colors: true },
      geometry_key: `merged:${key}`,
      geometry: () => mergeVisuals(visuals),
    });
  }
  return parts;
}

function primitivePart(shape: Shape, pose: Pose, surface: Surface, common: { link: number; color: Color; cast_shadows: boolean }): Part {
  const unit = unitOf(shape);
  if (unit) {
    return { ...common, surface, geometry_key: `unit:${unit.key}`, geometry: () => unitGeometry(unit.key), local: localMatrix(pose, ...unit.scale) };
  }
  return { ...common, surface, geometry_key: JSON.stringify(shape), geometry: () => primitiveGeometry(shape) ?? new THREE.BoxGeometry(), local: localMatrix(pose, 1, 1, 1) };
}

export function placeholder(link: number, pose: Pose): Part {
  return {
    link, color: [1, 1, 1, 1], cast_shadows: true, surface: CHECKER, geometry_key: 'unit:box', geometry: () => unitGeometry('box'),
    local: localMatrix(pose, 0.3, 0.3, 0.3),
  };
}

/** Wires of a link's collision shapes. */
export function collisionParts(link: Link, index: number, assets: Assets, later: (parts: Part[]) => void): Part[] {
  const material: Material = { diffuse: [0.1, 0.85, 0.55, 1] };
  const visuals = link.collisions.map((c) => ({ name: c.name, pose: c.pose, shape: c.shape, material, cast_shadows: false }));
  const wires = (parts: Part[]): Part[] => parts.map((p) => ({ ...p, surface: { ...p.surface, wireframe: true }, cast_shadows: false }));
  return wires(partsOfLink({ ...link, visuals }, index, assets, (parts) => later(wires(parts))));
}

function mergeVisuals(visuals: Link['visuals']): THREE.BufferGeometry {
  const matrix = new THREE.Matrix4();
  const color = new THREE.Color();
  const geometries = visuals.map((visual) => {
    const geometry = (primitiveGeometry(visual.shape) ?? new THREE.BoxGeometry()).toNonIndexed();
    const [x, y, z, qw, qx, qy, qz] = visual.pose;
    geometry.applyMatrix4(matrix.makeRotationFromQuaternion(new THREE.Quaternion(qx, qy, qz, qw)).setPosition(x, y, z));
    geometry.deleteAttribute('uv');
    const d = (visual.material ?? NO_MATERIAL).diffuse;
    setColor(geometry, color.setRGB(d[0], d[1], d[2], THREE.SRGBColorSpace));
    return geometry;
  });
  return mergeGeometries(geometries) ?? new THREE.BoxGeometry();
}

function setColor(geometry: THREE.BufferGeometry, color: THREE.Color): void {
  const count = geometry.getAttribute('position').count;
  const colors = new Float32Array(3 * count);
  for (let i = 0; i < count; ++i) colors.set([color.r, color.g, color.b], 3 * i);
  geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
}

/** A mesh as one part for all its plain colours, and one for each texture and each see-through colour. */
function meshParts(mesh: MeshBytes, id: string, material: Material, surface: Surface, common: { link: number; color: Color; cast_shadows: boolean; local: Float64Array }): Part[] {
  const own = material.from_mesh === true;
  const groups = new Map<string, { parts: MeshBytes['parts']; texture: string; opacity: number }>();
  for (const part of mesh.parts) {
    const texture = own ? (part.texture >= 0 ? `t${part.texture}` : '') : surface.texture;
    const opacity = own ? clamp01(part.color[3]) : surface.opacity;
    const key = `${texture}|${opacity}`;
    const group = groups.get(key);
    if (group) group.parts.push(part);
    else groups.set(key, { parts: [part], texture, opacity });
  }
  let normals: Float32Array | undefined;
  return [...groups].map(([key, group]) => ({
    ...common,
    color: own ? ([1, 1, 1, 1] as Color) : common.color,
    geometry_key: `mesh:${id}:${own ? key : 'all'}`,
    geometry: () => {
      normals ??= creasedNormals(mesh.positions, mesh.indices);
      return meshGeometry(mesh, group.parts, normals, own);
    },
    // Files wind their triangles either way, and many are open: both sides are drawn.
    surface: { ...surface, texture: group.texture, opacity: group.opacity, vertex_colors: own, double_sided: true },
  }));
}

function meshGeometry(mesh: MeshBytes, parts: MeshBytes['parts'], normals: Float32Array, colored: boolean): THREE.BufferGeometry {
  const triangles = parts.reduce((sum, p) => sum + p.triangles, 0);
  const positions = new Float32Array(9 * triangles);
  const directions = new Float32Array(9 * triangles);
  const uvs = mesh.uvs ? new Float32Array(6 * triangles) : null;
  const colors = colored ? new Float32Array(9 * triangles) : null;
  const color = new THREE.Color();
  let corner = 0;
  for (const part of parts) {
    color.setRGB(part.color[0], part.color[1], part.color[2], THREE.SRGBColorSpace);
    for (let c = 3 * part.first; c < 3 * (part.first + part.triangles); ++c, ++corner) {
      const vertex = mesh.indices[c];
      for (let k = 0; k < 3; ++k) {
        positions[3 * corner + k] = mesh.positions[3 * vertex + k];
        directions[3 * corner + k] = normals[3 * c + k];
      }
      if (uvs && mesh.uvs) uvs.set([mesh.uvs[2 * vertex], mesh.uvs[2 * vertex + 1]], 2 * corner);
      if (colors) colors.set([color.r, color.g, color.b], 3 * corner);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute('position', new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute('normal', new THREE.BufferAttribute(directions, 3));
  if (uvs) geometry.setAttribute('uv', new THREE.BufferAttribute(uvs, 2));
  if (colors) geometry.setAttribute('color', new THREE.BufferAttribute(colors, 3));
  return geometry;
}
