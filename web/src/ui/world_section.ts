// What the inspector shows while nothing is selected: the world in numbers, and what one may do first.
import type {Context} from '../app/context';
import {formatNumber} from '../app/format';
import type {World} from '../protocol';
import {h, setReason} from './dom';
import {icon} from './icons';
import {keyLabel} from '../app/actions';
import {driveOf} from './teleop';

export class WorldSection {
  readonly element: HTMLElement;
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
        h('section', {class: 'block'}, h('h3', {}, 'Start here'),
          ...(driven === undefined ? [] : [row(`Drive ${first}`, 'gamepad', '', true, withFirst('robots.drive'))]), ...(first === undefined ? [] : [row(`Follow ${first}`, 'follow', '', false, withFirst('robots.follow'))]),
          row('Pull things about', 'pull', 'ctrl+drag', true, () => actions.run('tool.pull')),
          row('Add an object', 'plus', '', true, () => actions.run('scene.add')),
          row('All commands', 'search', 'ctrl+k', false, () => actions.run('page.palette')),
          row('All keys', 'help', 'h', false, () => actions.run('page.help'))),
        h('p', {class: 'hint-line faint'}, 'Select a robot or an object, in the list or in the scene, for its numbers and its settings.'));
    this.steering();
  }

  steering(): void {
    for (const {button, title} of this.steered) setReason(button, this.context.store.whyNotSteer(), title);
  }
}
