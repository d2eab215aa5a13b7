// What came from outside and was carried out or refused: /sandlot/commands.
import type {Context, Panel} from '../app/context';
import {formatTime} from '../app/format';
import {ticker} from '../app/ticker';
import type {Command, Commands} from '../protocol';
import {h} from './dom';
import {icon} from './icons';
import {VirtualList} from './virtual_list';

const kept = 5000;

export class CommandsPanel implements Panel {
  readonly commands: Command[] = [];
  private readonly search = h('input', {type: 'search', placeholder: 'Search', 'aria-label': 'Search the commands'});
  private readonly refused = h('input', {type: 'checkbox', class: 'switch'});
  private readonly none = h('div', {class: 'empty'}, 'Nothing has come from outside yet. What you change shows up here.');
  private readonly list = new VirtualList<Command>(22, (c) => h('div', {class: `log-row${c.refused ? ' error' : ''}`, title: c.refused ? `${c.text}\nrefused: ${c.why}` : c.text},
      h('span', {class: 'mono faint time'}, formatTime(c.time_s)), h('span', {class: 'dim source'}, c.source === 'admin' ? 'admin' : `${c.source} ${c.id}`), h('span', {class: 'level'}, c.kind),
      h('span', {class: 'ellipsis dim who'}, c.target), h('span', {class: 'ellipsis grow mono'}, c.text), c.refused ? h('span', {class: 'ellipsis why'}, `refused: ${c.why}`) : null));
  readonly element = h('div', {class: 'pane log', testid: 'commands'}, h('div', {class: 'pane-head'}, h('div', {class: 'search grow'}, icon('search', 14), this.search), h('label', {class: 'inline'}, this.refused, 'Refused only')), this.list.element, this.none);
  private visible = false;

  constructor(context: Context) {
    this.list.followTail();
    this.search.addEventListener('input', this.update);
    this.refused.addEventListener('change', this.update);
    context.client.subscribe('/sandlot/commands', (message) => {
      const value = message.value() as Commands;
      for (const command of value.commands ?? []) this.commands.push(command);
      if (this.commands.length > kept) this.commands.splice(0, this.commands.length - kept);
      if (this.visible) ticker.request(this.update);
    });
  }

  private readonly update = (): void => {
    const text = this.search.value.trim().toLowerCase();
    this.none.hidden = this.commands.length > 0;
    this.list.set(this.commands.filter((c) => (!this.refused.checked || c.refused) && (text === '' || `${c.source} ${c.kind} ${c.target} ${c.text} ${c.why}`.toLowerCase().includes(text))));
  };

  setVisible(visible: boolean): void {
    this.visible = visible;
    if (visible) this.update();
  }
}
