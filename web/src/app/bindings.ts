// Keys that the program of the run has bound to lines of the console: they join the table of actions, and so the help and the palette.
import type {Client} from '../net/client';
import type {Actions} from './actions';
import type {Steer} from './steer';

export interface Binding {
  key: string;
  line: string;
  help: string;
}

/** The bindings in the answer of `help --json`; none where it is something else. */
export function bindingsOf(text: string): Binding[] {
  try {
    const keys = (JSON.parse(text) as {keys?: unknown}).keys;
    if (!Array.isArray(keys)) return [];
    return (keys as Partial<Binding>[]).slice(0, 100).filter((b) => typeof b?.key === 'string' && b.key !== '' && typeof b.line === 'string')
        .map((b) => ({key: (b.key as string).toLowerCase(), line: b.line as string, help: typeof b.help === 'string' && b.help !== '' ? b.help : (b.line as string)}));
  } catch {
    return [];
  }
}

/** Asks for the bindings whenever a run is connected to, and binds what is free. */
export function bindKeys(client: Client, steer: Steer, actions: Actions, tell: (text: string) => void): void {
  let asked = false;
  client.onState.on((state) => {
    if (state !== 'open') asked = false;
  });
  client.onChannels.on(() => {
    if (asked || !client.services.has('/sandlot/console')) return;
    asked = true;
    void steer.ask('help --json').then((answer) => {
      if (!answer.ok) return;
      actions.removeGroup('Run');
      for (const {key, line, help} of bindingsOf(answer.text)) {
        const taken = actions.boundTo(key);
        if (taken) tell(`The key ${key} of the run is taken by “${taken.title}”`);
        else actions.add({id: `run.${key}`, group: 'Run', title: help, keys: [key], steers: true, run: () => void steer.say(line).then((said) => (said.ok && said.text !== '' ? tell(said.text) : undefined))});
      }
    });
  });
}
