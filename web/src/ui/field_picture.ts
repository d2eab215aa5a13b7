// A field of robot soccer from above, x to the right, with whatever is put on it: a moment, paths of passes, or a picture of heat.
import type {Dimensions, HeatGrid, Pass, SeenPlayer, Spot} from '../app/match';
import {cell_m} from '../app/match';
import {clear, h, svg} from './dom';

const border_m = 0.55, robot_m = 0.42;

export class FieldPicture {
  private readonly heat = h('canvas', {class: 'field-heat', 'aria-hidden': 'true'});
  private readonly lines = svg('g', {class: 'lines'});
  private readonly things = svg('g', {class: 'things'});
  private readonly picture = svg('svg', {class: 'field-svg', role: 'img'}, this.lines, this.things);
  readonly element = h('div', {class: 'field-picture', testid: 'field-picture'}, this.heat, this.picture as unknown as Node);
  private shown: Dimensions | null = null;

  setTitle(title: string): void {
    this.picture.setAttribute('aria-label', title);
  }

  setDimensions(d: Dimensions): void {
    if (this.shown === d) return;
    this.shown = d;
    const x = d.length / 2 + d.goal[0] + 0.15, y = d.width / 2 + border_m;
    this.picture.setAttribute('viewBox', `${-x} ${-y} ${2 * x} ${2 * y}`);
    this.element.style.aspectRatio = `${x} / ${y}`;
    this.place(d, x, y);
    clear(this.lines);
    const [l, w] = [d.length / 2, d.width / 2];
    const rect = (x0: number, y0: number, width: number, height: number): SVGElement => svg('rect', {x: x0, y: y0, width, height});
    this.lines.append(rect(-l, -w, 2 * l, 2 * w), svg('path', {d: `M0 ${-w}V${w}`}), svg('circle', {cx: 0, cy: 0, r: d.circle_radius}), svg('circle', {cx: 0, cy: 0, r: 0.12, class: 'mark'}));
    for (const side of [-1, 1]) {
      for (const [depth, width] of [d.penalty_area, d.goal_area]) this.lines.append(rect(side < 0 ? -l : l - depth, -width / 2, depth, width));
      this.lines.append(svg('rect', {x: side < 0 ? -l - d.goal[0] : l, y: -d.goal[1] / 2, width: d.goal[0], height: d.goal[1], class: 'goal'}));
      for (const y_m of [-d.restart_y, 0, d.restart_y]) this.lines.append(svg('circle', {cx: side * (l - d.penalty_mark), cy: y_m, r: 0.1, class: 'mark'}));
      const r = d.corner_radius;
      for (const up of [-1, 1]) this.lines.append(svg('path', {d: `M${side * (l - r)} ${up * w}A${r} ${r} 0 0 ${side * up > 0 ? 1 : 0} ${side * l} ${up * (w - r)}`}));
    }
  }

  /** Lays the canvas under the lines, cell by cell. */
  private place(d: Dimensions, x: number, y: number): void {
    const columns = Math.ceil(d.length / cell_m) + 2, rows = Math.ceil(d.width / cell_m) + 2;
    const percent = (part: number): string => `${(100 * part).toFixed(3)}%`;
    Object.assign(this.heat.style, {
      left: percent((x - d.length / 2 - cell_m) / (2 * x)), top: percent((y - d.width / 2 - cell_m) / (2 * y)),
      width: percent((columns * cell_m) / (2 * x)), height: percent((rows * cell_m) / (2 * y)),
    });
  }

  private begin(): void {
    clear(this.things);
    this.heat.hidden = true;
  }

  /** Robots and ball at a moment. @param concerned  name of a robot that is ringed  @param point  where the game goes on */
  showMoment(players: readonly SeenPlayer[], ball: Spot | null, color: (team: string) => string, concerned = '', point: Spot | null = null): void {
    this.begin();
    if (point) this.things.append(svg('circle', {cx: point[0], cy: -point[1], r: 0.62, class: 'point'}), svg('path', {d: `M${point[0] - 0.3} ${-point[1]}h.6M${point[0]} ${-point[1] - 0.3}v.6`, class: 'point'}));
    for (const p of players) {
      const [x, y] = [p.at[0], -p.at[1]];
      const nose: Spot = [x + 1.6 * robot_m * Math.cos(p.yaw), y - 1.6 * robot_m * Math.sin(p.yaw)];
      const group = svg('g', {class: 'robot', 'data-robot': p.name}, svg('title', {}, p.name));
      if (p.name === concerned) group.append(svg('circle', {cx: x, cy: y, r: robot_m + 0.24, class: 'ring'}));
      const body = svg('circle', {cx: x, cy: y, r: robot_m}), line = svg('path', {d: `M${x} ${y}L${nose[0]} ${nose[1]}`, class: 'nose'});
      body.style.fill = line.style.stroke = color(p.team);
      group.append(line, body, svg('text', {x, y: y + 0.19}, String(p.number)));
      this.things.append(group);
    }
    if (ball) this.things.append(svg('circle', {cx: ball[0], cy: -ball[1], r: 0.24, class: 'ball'}));
  }

  showPasses(passes: readonly Pass[], color: (team: string) => string): void {
    this.begin();
    for (const [i, pass] of passes.entries()) {
      const [x1, y1, x2, y2] = [pass.begin[0], -pass.begin[1], pass.end[0], -pass.end[1]];
      const length = Math.max(1e-6, Math.hypot(x2 - x1, y2 - y1));
      const [ux, uy] = [(x2 - x1) / length, (y2 - y1) / length];
      const head = `M${x2 - 0.5 * ux - 0.25 * uy} ${y2 - 0.5 * uy + 0.25 * ux}L${x2} ${y2}L${x2 - 0.5 * ux + 0.25 * uy} ${y2 - 0.5 * uy - 0.25 * ux}`;
      const group = svg('g', {class: 'pass', opacity: (0.35 + (0.65 * (i + 1)) / passes.length).toFixed(2)}, svg('title', {}, `${pass.from} to ${pass.to}, ${length.toFixed(1)} m`),
          svg('path', {d: `M${x1} ${y1}L${x2} ${y2}${head}`}), svg('circle', {cx: x1, cy: y1, r: 0.16}));
      group.style.color = color(pass.team);
      this.things.append(group);
    }
  }

  /** @param rgb  colour of what was longest in a place */
  showHeat(grid: HeatGrid, rgb: readonly [number, number, number]): void {
    this.begin();
    let most = 0;
    for (const value of grid.values) most = Math.max(most, value);
    this.heat.hidden = most <= 0;
    if (most <= 0) return;
    if (this.heat.width !== grid.columns || this.heat.height !== grid.rows) [this.heat.width, this.heat.height] = [grid.columns, grid.rows];
    const context = this.heat.getContext('2d');
    if (!context) return;
    const image = context.createImageData(grid.columns, grid.rows);
    for (const [i, value] of grid.values.entries()) {
      // So that a ball that lay still for a while does not hide where it rolled.
      const part = Math.sqrt(value / most);
      for (let c = 0; c < 3; c++) image.data[4 * i + c] = Math.round((rgb[c] as number) + (255 - (rgb[c] as number)) * Math.max(0, part - 0.65));
      image.data[4 * i + 3] = Math.round(235 * Math.min(1, 1.5 * part));
    }
    context.putImageData(image, 0, 0);
  }
}
