// The score over the scene: how the teams stand by their criteria, in digits that can be read from afar.
import type {Context} from '../app/context';
import {formatNumber} from '../app/format';
import {Watch} from '../app/watcher';
import type {Criterion, World} from '../protocol';
import {h} from './dom';
import {teamColor} from './teams';

const teams_max = 8;
const rate_hz = 5;

export class Score {
  readonly element = h('div', {class: 'score', hidden: true, role: 'status', 'aria-live': 'off', 'aria-label': 'Score', testid: 'score'});
  private watch: Watch | null = null;
  private shown = '';

  constructor(private readonly context: Context) {
    context.store.onWorld.on((world) => this.show(world));
  }

  private show(world: World): void {
    const criteria = (world.criteria ?? []).filter((criterion) => criterion.team !== '').slice(0, teams_max);
    const key = JSON.stringify([world.epoch, ...criteria.map((c) => [c.team, c.address])]);
    if (key === this.shown) return;
    this.shown = key;
    this.watch?.close();
    this.watch = null;
    this.element.hidden = true;
    if (criteria.length === 0) return;
    const digits = criteria.map((criterion) => h('b', {class: 'digits', testid: `score-${criterion.team}`}, '–'));
    this.element.classList.toggle('duel', criteria.length === 2);
    this.element.replaceChildren(...this.cells(criteria, digits, world));
    const last: string[] = [];
    this.watch = new Watch(this.context.client, criteria.map((criterion) => criterion.address), rate_hz, (_, values) => {
      this.element.hidden = false;
      for (const [i, digit] of digits.entries()) {
        const text = formatNumber(values[i] ?? Number.NaN, 3);
        if (text === last[i]) continue;
        digit.textContent = text;
        // A goal is seen; what changes all the time is not to blink.
        if (last[i] !== undefined && Number.isInteger(values[i])) digit.animate?.([{transform: 'scale(1.45)'}, {transform: 'scale(1)'}], {duration: 500, easing: 'ease-out'});
        last[i] = text;
      }
    });
  }

  /** Two teams face each other, "red 1 : 0 blue"; others stand in a row. */
  private cells(criteria: Criterion[], digits: HTMLElement[], world: World): HTMLElement[] {
    const name = (criterion: Criterion): HTMLElement => {
      const dot = h('i', {class: 'dot'});
      dot.style.background = teamColor(criterion.team, world);
      return h('span', {class: 'team', title: criterion.value}, dot, h('span', {class: 'ellipsis'}, criterion.team));
    };
    const [first, second] = criteria;
    if (criteria.length === 2 && first && second) return [name(first), digits[0] as HTMLElement, h('span', {class: 'colon'}, ':'), digits[1] as HTMLElement, name(second)];
    return criteria.map((criterion, i) => h('span', {class: 'entry'}, name(criterion), digits[i] as HTMLElement));
  }
}
