// The console: the same command language as the terminal's.
import type {Context, Panel} from '../app/context';
import {remember, remembered} from '../app/settings';
import {h} from './dom';
import {Suggestions} from './overlays';

const lines_max = 1000;
const history_max = 200;

/** The part that all candidates begin with. */
export function commonStart(candidates: string[]): string {
  let start = candidates[0] ?? '';
  for (const c of candidates) while (!c.startsWith(start)) start = start.slice(0, -1);
  return start;
}

/** The line with its last word (what the candidates are for) replaced. */
export function completeLine(line: string, candidate: string): string {
  const word = /(?:[^\s"]|"[^"]*"?)*$/.exec(line)?.[0] ?? '';
  return line.slice(0, line.length - word.length) + candidate;
}

export class ConsolePanel implements Panel {
  private readonly output = h('div', {class: 'console-output mono', role: 'log', 'aria-live': 'polite', tabindex: '0', testid: 'console-output'});
  private readonly input = h('input', {class: 'mono', placeholder: 'help', 'aria-label': 'Console line', testid: 'console-input', autocapitalize: 'off'});
  readonly element = h('div', {class: 'pane console'}, this.output, h('div', {class: 'console-line'}, h('span', {class: 'mono prompt', 'aria-hidden': 'true'}, '›'), this.input));
  private readonly history = remembered<string[]>('console.history', []).filter((l) => typeof l === 'string');
  private at = this.history.length;
  private draft = '';

  constructor(private readonly context: Context) {
    const suggestions = new Suggestions(this.input, (text) => this.context.steer.complete(text), (candidate) => {
      this.input.value = completeLine(this.input.value, candidate);
    }, false);
    this.input.addEventListener('keydown', (event) => {
      if (event.key === 'Enter') {
        suggestions.close();
        void this.run(this.input.value);
      } else if (event.key === 'Tab' && !event.shiftKey) {
        event.preventDefault();
        void this.complete(suggestions);
      } else if (event.key === 'ArrowUp' || event.key === 'ArrowDown') {
        event.preventDefault();
        this.recall(event.key === 'ArrowUp' ? -1 : 1);
      } else if (event.key === 'l' && event.ctrlKey) {
        event.preventDefault();
        this.output.replaceChildren();
      } else if (event.key === 'Escape') {
        this.input.blur();
      } else {
        suggestions.close();
      }
      event.stopPropagation();
    });
    this.print('Type “help” for the commands; Tab completes, arrows recall.', 'faint');
  }

  private async complete(suggestions: Suggestions): Promise<void> {
    const line = this.input.value;
    const candidates = await this.context.steer.complete(line);
    if (this.input.value !== line || candidates.length === 0) return;
    const start = commonStart(candidates);
    const done = completeLine(line, start);
    if (done.length > line.length) this.input.value = done;
    if (candidates.length > 1) suggestions.show(candidates.slice(0, 100));
  }

  private recall(by: number): void {
    if (this.at === this.history.length) this.draft = this.input.value;
    this.at = Math.max(0, Math.min(this.history.length, this.at + by));
    this.input.value = this.at === this.history.length ? this.draft : this.history[this.at] ?? '';
    this.input.setSelectionRange(this.input.value.length, this.input.value.length);
  }

  private async run(text: string): Promise<void> {
    const line = text.trim();
    this.input.value = '';
    if (line === '') return;
    if (this.history[this.history.length - 1] !== line) this.history.push(line);
    if (this.history.length > history_max) this.history.shift();
    this.at = this.history.length;
    this.draft = '';
    remember('console.history', this.history);
    this.print(`› ${line}`, 'said');
    const slot = this.print('…', 'faint');
    const answer = await this.context.steer.ask(line);
    slot.className = answer.ok ? '' : 'bad';
    slot.textContent = answer.text.replace(/\n$/, '');
    if (slot.textContent === '') slot.remove();
    this.toEnd();
  }

  private print(text: string, kind: string): HTMLElement {
    const line = h('div', {class: kind}, text);
    this.output.append(line);
    while (this.output.childElementCount > lines_max) this.output.firstElementChild?.remove();
    this.toEnd();
    return line;
  }

  private toEnd(): void {
    this.output.scrollTop = this.output.scrollHeight;
  }

  focus(): void {
    this.input.focus();
  }

  setVisible(visible: boolean): void {
    if (visible) this.toEnd();
  }
}
