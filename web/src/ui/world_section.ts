// What the inspector shows while nothing is selected: the world in numbers, and what one may do first.
import type {Context} from '../app/context';
import {formatNumber} from '../app/format';
import {Watch} from '../app/watcher';
import type {Criterion, World} from '../protocol';
import {h, setReason} from './dom';
import {icon} from './icons';
import {keyLabel} from '../app/actions';
import {teamColor} from './teams';
import {driveOf} from './teleop';
import {draggableValue} from './values';

export class WorldSection {
  readonly element: HTMLElement;
  private watch: Watch | null = null;
  private readonly steered: {button: HTMLButtonElement; title: string}[] = [];

  constructor(private readonly context: Context, world: World) {
    const {actions, store} = context;
    const robots = world.instances.filter((i) => i.robot);
    // To drive: one that no controller steers as well.
    const driven = robots.find((r) => driveOf(r) !== null && r.controllers.length === 0) ?? robots.find((r) => driveOf(r) !== null);
    const first = (driven ?? robots[0])?.name;
    const facts: [string, string][] = [
      ['Robots', String(robots.length)], ['Objects', String(world.instances.length - robots.length)], ['Physics', world.engine], ['Step', `${formatNumber(1000 * world.step_s)} ms`],
      ['Gravity', `${formatNumber(Math.hypot(...world.gravity), 4)} m/s²`], ['Seed', String(world.seed)],
    ];
    const row = (title: string, symbol: string, key: string, steers: boolean, run: () => void): HTMLElement => {
      const button = h('button', {class: 'plain part-row', on: {click: run}}, icon(symbol, 14), h('span', {}, title), key === '' ? null : h('kbd', {}, keyLabel(key)));
      if (steers) this.steered.push({button, title});
      return button;
    };
    const withFirst = (id: string) => (): void => {
      store.select(first ?? null);
      actions.run(id);
    };
    this.element = h('div', {},
        h('section', {class: 'block'}, h('dl', {class: 'facts'}, ...facts.flatMap(([name, value]) => [h('dt', {}, name), h('dd', {class: 'mono'}, value)]))),
        ...(world.criteria === undefined ? [] : [this.judgedBy(world.criteria, world)]),
        h('section', {class: 'block'}, h('h3', {}, 'Start here'),
          ...(driven === undefined ? [] : [row(`Drive ${first}`, 'gamepad', '', true, withFirst('robots.drive'))]), ...(first === undefined ? [] : [row(`Follow ${first}`, 'follow', '', false, withFirst('robots.follow'))]),
          row('Pull things about', 'pull', 'ctrl+drag', true, () => actions.run('tool.pull')),
          row('Add an object', 'plus', '', true, () => actions.run('scene.add')),
          row('All commands', 'search', 'ctrl+k', false, () => actions.run('page.palette')),
          row('All keys', 'help', 'h', false, () => actions.run('page.help'))),
        h('p', {class: 'hint-line faint'}, 'Select a robot or an object, in the list or in the scene, for its numbers and its settings.'));
    this.steering();
  }

  /** The present value of each criterion; it can be dragged to a plot. */
  private judgedBy(criteria: Criterion[], world: World): HTMLElement {
    const cells = criteria.map((criterion) => {
      const cell = h('dd', {class: 'mono', title: 'Drag it to a plot'}, '–');
      draggableValue(cell, criterion.address, '');
      return cell;
    });
    this.watch = new Watch(this.context.client, criteria.map((criterion) => criterion.address), 4, (_, values) => {
      for (const [i, cell] of cells.entries()) cell.textContent = Number.isFinite(values[i]) ? formatNumber(values[i], 4) : '–';
    });
    const name = (criterion: Criterion): HTMLElement => {
      const goal = criterion.success === undefined ? '' : `; succeeded when ${criterion.success}`;
      const label = h('dt', {title: criterion.value + goal}, criterion.team === '' ? 'This run' : criterion.team);
      if (criterion.team !== '') label.style.color = teamColor(criterion.team, world);
      return label;
    };
    return h('section', {class: 'block'}, h('h3', {}, 'Judged by'), h('dl', {class: 'facts'}, ...criteria.flatMap((criterion, i) => [name(criterion), cells[i]])));
  }

  close(): void {
    this.watch?.close();
  }

  steering(): void {
    for (const {button, title} of this.steered) setReason(button, this.context.store.whyNotSteer(), title);
  }
}
