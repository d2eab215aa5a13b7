// All that the page can be told to do: one list that the keys, the command palette, the help sheet and the tooltips come from.

export interface Action {
  id: string;
  title: string;
  group: 'Time' | 'View' | 'Scene' | 'Robots' | 'Panels' | 'Page' | 'Run';
  /** Keys as KeyboardEvent.key says them, lower case, "ctrl+" before; empty: no key. */
  keys: string[];
  /** Changes the run: only for those who may. */
  steers?: boolean;
  run: () => void;
}

export class Actions {
  /** In the order in which they came. Those of the group Run are bound by the program of the run, and go with it. */
  readonly list: Action[] = [];
  private readonly byKey = new Map<string, Action>();
  private readonly byId = new Map<string, Action>();

  constructor(readonly whyNot: (action: Action) => string | null, private readonly complain: (text: string) => void) {}

  add(...actions: Action[]): void {
    for (const action of actions) {
      if (this.byId.has(action.id)) throw new Error(`two actions ${action.id}`);
      for (const key of action.keys) {
        if (this.byKey.has(key)) throw new Error(`the key ${key} has two actions: ${this.byKey.get(key)?.id} and ${action.id}`);
        this.byKey.set(key, action);
      }
      this.byId.set(action.id, action);
      this.list.push(action);
    }
  }

  boundTo(key: string): Action | undefined {
    return this.byKey.get(key);
  }

  removeGroup(group: Action['group']): void {
    for (const action of this.list.filter((a) => a.group === group)) {
      for (const key of action.keys) this.byKey.delete(key);
      this.byId.delete(action.id);
      this.list.splice(this.list.indexOf(action), 1);
    }
  }

  run(id: string): void {
    const action = this.byId.get(id);
    if (!action) throw new Error(`no action ${id}`);
    const reason = action.steers ? this.whyNot(action) : null;
    if (reason !== null) this.complain(reason);
    else action.run();
  }

  /** "Pause (space)". */
  titleOf(id: string, title?: string): string {
    const action = this.byId.get(id);
    if (!action) return title ?? id;
    const key = action.keys[0];
    return (title ?? action.title) + (key ? ` (${keyLabel(key)})` : '');
  }

  /** True when the key did something. */
  press(key: string): boolean {
    const action = this.byKey.get(key);
    if (!action) return false;
    this.run(action.id);
    return true;
  }
}

/** The name of a key press in the table above; null for bare modifiers. */
export function keyOf(event: {key: string; ctrlKey: boolean; metaKey: boolean; altKey: boolean}): string | null {
  if (['Control', 'Shift', 'Alt', 'Meta'].includes(event.key)) return null;
  const key = event.key === ' ' ? 'space' : event.key.toLowerCase();
  return (event.ctrlKey || event.metaKey ? 'ctrl+' : '') + (event.altKey ? 'alt+' : '') + key;
}

const labels: Record<string, string> = {
  space: 'Space', escape: 'Esc', arrowup: '↑', arrowdown: '↓', arrowleft: '←', arrowright: '→', delete: 'Del', enter: 'Enter',
};

export function keyLabel(key: string): string {
  return key.split(/\+(?=.)/).map((part) => labels[part] ?? (part === 'ctrl' ? 'Ctrl' : part === 'alt' ? 'Alt' : part.length === 1 ? part.toUpperCase() : part)).join(' ');
}
