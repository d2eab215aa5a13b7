// The controllers of a robot, with what each does now: started, stopped, configured and unloaded by buttons.
import type {Context} from '../app/context';
import {word} from '../app/format';
import {h, setReason} from './dom';
import {icon} from './icons';
import {heading} from './pose_section';

/** A row of `controllers ROBOT --json`. */
export interface ControllerRow {
  path: string;
  kind: string;
  state: 'unconfigured' | 'inactive' | 'active';
  program: boolean;
  claims: string[];
}

/** What can be done to a controller in a state: the word of the console, and what its button says of it. */
export function actsOn(state: ControllerRow['state']): [act: string, symbol: string, title: string][] {
  const unload: [string, string, string] = ['unload', 'trash', 'Unload: take it from the robot'];
  if (state === 'active') return [['stop', 'pause', 'Stop: it gives no more orders']];
  if (state === 'inactive') return [['start', 'play', 'Start'], unload];
  return [['configure', 'chip', 'Configure: read its keys'], unload];
}

export class ControllersSection {
  readonly element = h('section', {class: 'block', testid: 'controllers', hidden: true});
  private buttons: [HTMLButtonElement, string][] = [];
  private shown = '';
  private readonly stopWorld: () => void;

  constructor(private readonly context: Context, private readonly robot: string) {
    this.stopWorld = context.store.onWorld.on(() => void this.refresh());
    void this.refresh();
  }

  private async refresh(): Promise<void> {
    const {steer} = this.context;
    const answer = await steer.ask(`controllers ${word(this.robot)} --json`);
    if (!answer.ok || answer.text === this.shown) return;
    let rows: ControllerRow[];
    try {
      rows = JSON.parse(answer.text) as ControllerRow[];
    } catch {
      return;
    }
    this.shown = answer.text;
    this.buttons = [];
    this.element.hidden = rows.length === 0;
    this.element.replaceChildren(heading('Controllers'), ...rows.map((row) => this.row(row)));
    this.steering();
  }

  private row(row: ControllerRow): HTMLElement {
    const {store, steer} = this.context;
    const name = row.path.slice(this.robot.length + 1);
    const known = store.find(row.path) !== null;
    const title = [row.path, row.claims.length > 0 ? `commands ${row.claims.join(', ')}` : ''].filter((t) => t).join('\n');
    const open = h('button', {class: 'plain part-row', title, testid: `part-${row.path}`, disabled: !known, on: {click: () => store.select(row.path)}},
        icon(row.program ? 'brain' : 'chip', 14), h('span', {}, name), h('span', {class: 'faint ellipsis', testid: `state-${row.path}`}, `${row.kind.replace(/_/g, ' ')} · ${row.state}`));
    const buttons = actsOn(row.state).map(([act, symbol, says]) => {
      const button = h('button', {class: 'plain icon-only', 'aria-label': `${says} (${name})`, testid: `${act}-${row.path}`, on: {click: () => {
        void steer.say(`controllers ${act} ${row.path}`).then(() => this.refresh());
      }}}, icon(symbol, 14));
      this.buttons.push([button, says]);
      return button;
    });
    return h('div', {class: 'controller-row'}, open, ...buttons);
  }

  steering(): void {
    for (const [button, title] of this.buttons) setReason(button, this.context.store.whyNotSteer(), title);
  }

  close(): void {
    this.stopWorld();
  }
}
