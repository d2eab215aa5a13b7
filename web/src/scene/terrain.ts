// Heights of the ground, for what is drawn on it: of heightmaps that stand still, else 0.
import type { World } from '../protocol';
import type { Assets, GridBytes } from './assets';
import { invert, multiply, transform } from './poses';

interface Hill {
  /** From the world into the grid's frame, and back. */
  into: Float64Array;
  out: Float64Array;
  grid: GridBytes;
}

export class Terrain {
  private hills: Hill[] = [];
  private key = '';
  private readonly point = [0, 0, 0];

  /** @param changed  called when heights have come */
  constructor(private readonly changed: () => void) {}

  /** Whether there is anything but a plane. */
  get is_there(): boolean {
    return this.hills.length > 0;
  }

  setWorld(world: World, assets: Assets): void {
    const found: { grid: string; out: Float64Array }[] = [];
    const models = new Map(world.models.filter((m) => m.static).map((m) => [m.id, m]));
    for (const instance of world.instances) {
      for (const link of models.get(instance.model)?.links ?? []) {
        for (const { shape, pose } of link.visuals) {
          if (shape.type !== 'heightmap') continue;
          const at_link = new Float64Array(7);
          const out = new Float64Array(7);
          multiply(instance.pose, 0, link.pose, 0, at_link, 0);
          multiply(at_link, 0, pose, 0, out, 0);
          found.push({ grid: shape.grid, out });
        }
      }
    }
    const key = found.map(({ grid, out }) => `${grid} ${out.join(' ')}`).join('\n');
    // The world is told anew whenever anything in it changes; the ground seldom does.
    if (key === this.key) return;
    this.key = key;
    this.hills = [];
    for (const { grid: id, out } of found) {
      void assets.grid(id).then((grid) => {
        if (grid === undefined || key !== this.key) return;
        const into = new Float64Array(7);
        invert(out, 0, into, 0);
        this.hills.push({ into, out, grid });
        this.changed();
      });
    }
  }

  /** After the assets were forgotten: their names mean other things. */
  clear(): void {
    this.key = '';
    this.hills = [];
  }

  /** Height of the highest terrain at a place of the world; 0 where there is none. */
  heightAt(x: number, y: number): number {
    let height = -Infinity;
    for (const { into, out, grid } of this.hills) {
      const p = this.point;
      transform(into, 0, x, y, 0, p);
      const u = (p[0] / grid.size_x_m + 0.5) * (grid.columns - 1);
      const v = (p[1] / grid.size_y_m + 0.5) * (grid.rows - 1);
      if (!(u >= 0 && v >= 0 && u <= grid.columns - 1 && v <= grid.rows - 1)) continue;
      const i = Math.min(grid.columns - 2, Math.floor(u)), j = Math.min(grid.rows - 2, Math.floor(v));
      const a = u - i, b = v - j;
      const at = j * grid.columns + i;
      const h = grid.heights_m;
      const z = (1 - a) * (1 - b) * h[at] + a * (1 - b) * h[at + 1] + (1 - a) * b * h[at + grid.columns] + a * b * h[at + grid.columns + 1];
      transform(out, 0, p[0], p[1], z, p);
      height = Math.max(height, p[2]);
    }
    return height === -Infinity ? 0 : height;
  }
}
