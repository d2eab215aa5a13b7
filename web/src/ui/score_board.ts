// The board of a match over the scene: who plays, the score, the clock, and what the referee waits for.
import type {Context} from '../app/context';
import type {Game} from '../app/game';
import {clockText, GameState, wordsOf} from '../app/match';
import {ticker} from '../app/ticker';
import {h, setText, setTitle} from './dom';

class Side {
  readonly dot = h('i', {class: 'dot'});
  readonly name = h('span', {class: 'ellipsis'});
  readonly cards = h('span', {class: 'cards'});
  readonly team = h('span', {class: 'team'}, this.dot, this.name, this.cards);
  readonly digits = h('b', {class: 'digits'}, '–');
  score = -1;

  show(team: GameState['teams'][number], color: string): void {
    this.dot.style.background = color;
    setText(this.name, team.title || team.name);
    setTitle(this.team, `${team.title ? `${team.name}, ${team.title}` : team.name}: ${team.robots} robots, ${team.yellow} yellow, ${team.red} red cards`);
    const cards = 'y'.repeat(Math.min(5, team.yellow)) + 'r'.repeat(Math.min(5, team.red));
    if (this.cards.dataset.shown !== cards) {
      this.cards.dataset.shown = cards;
      this.cards.replaceChildren(...[...cards].map((c) => h('i', {class: c === 'y' ? 'card yellow' : 'card red'})));
    }
    this.digits.dataset.testid = `board-${team.name}`;
    if (team.score === this.score) return;
    setText(this.digits, String(team.score));
    if (this.score >= 0) this.digits.animate?.([{transform: 'scale(1.45)'}, {transform: 'scale(1)'}], {duration: 500, easing: 'ease-out'});
    this.score = team.score;
  }
}

/** "Throw-in, magenta · preparing"; what is said of a game that simply goes on is little. */
export function newsOf(state: GameState): string {
  if (state.stage === 'ended') return 'The game is over';
  if (state.stage === 'half_time') return 'Teams change sides';
  const piece = state.set_piece === '' ? '' : `${wordsOf(state.set_piece)}${state.team === '' ? '' : `, ${state.team}`}`;
  const phase = state.phase === 'running' ? (state.in_play ? 'in play' : 'ball is to be played') : state.phase;
  return piece === '' ? (phase.charAt(0).toUpperCase() + phase.slice(1)) : state.phase === 'running' && state.in_play ? 'In play' : `${piece} · ${phase}`;
}

export class ScoreBoard {
  private readonly sides = [new Side(), new Side()] as const;
  private readonly clock = h('b', {class: 'match-clock', testid: 'board-clock'});
  private readonly stage = h('span', {class: 'match-stage', testid: 'board-stage'});
  private readonly flag = h('i', {class: 'dot'});
  private readonly news = h('span', {class: 'ellipsis', testid: 'board-news'});
  private readonly foot = h('div', {class: 'match-foot'}, this.flag, this.news);
  readonly element = h('div', {class: 'score match', hidden: true, role: 'status', 'aria-live': 'off', 'aria-label': 'Match', testid: 'board'},
      h('div', {class: 'match-line'}, this.sides[0].team, this.sides[0].digits, h('div', {class: 'match-time'}, this.clock, this.stage), this.sides[1].digits, this.sides[1].team), this.foot);

  constructor(context: Context, private readonly game: Game) {
    game.onState.on(() => ticker.request(this.update));
    context.store.onWorld.on(() => ticker.request(this.update));
  }

  private readonly update = (): void => {
    const state = this.game.state;
    this.element.hidden = state === null;
    // The score by criteria says the same with less.
    this.element.parentElement?.classList.toggle('has-match', state !== null);
    if (!state) return;
    state.teams.slice(0, 2).forEach((team, i) => this.sides[i as 0 | 1].show(team, this.game.color(team.name)));
    setText(this.clock, clockText(state.clock_s));
    setTitle(this.clock, `${clockText(state.remaining_s)} left`);
    setText(this.stage, wordsOf(state.stage));
    setText(this.news, newsOf(state));
    this.flag.hidden = state.team === '' || state.set_piece === '';
    this.flag.style.background = this.game.color(state.team);
    this.foot.classList.toggle('waits', state.phase !== 'running' || !state.in_play);
  };
}
