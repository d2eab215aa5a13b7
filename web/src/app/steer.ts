// Everything that changes the run goes through here: console lines, said one way, with what went wrong shown.
import type {Client} from '../net/client';
import {Signal} from '../net/signal';
import {word} from './format';
import type {Store} from './store';

export interface Answer {
  ok: boolean;
  text: string;
}

export class Steer {
  /** Errors of lines that nobody else shows. */
  readonly onError = new Signal<string>();
  /** What a line that was accepted says, where it is not yet carried out: a run that stands still does so with the next tick. */
  readonly onNote = new Signal<string>();
  private dragging = false;
  private nextDrag: string | null = null;

  constructor(private readonly client: Client, private readonly store: Store) {}

  async ask(line: string): Promise<Answer> {
    try {
      const answer = await this.client.call<Answer>('/sandlot/console', {line});
      return {ok: answer.ok === true, text: String(answer.text ?? '')};
    } catch (error) {
      return {ok: false, text: error instanceof Error ? error.message : String(error)};
    }
  }

  /** Says a line that changes something; an error becomes a toast. */
  async say(line: string, quiet = false): Promise<Answer> {
    const reason = /^(pause|run|step|speed|reset|jump)\b/.test(line) ? this.store.whyNotPlay() : this.store.whyNotSteer();
    const answer = reason === null ? await this.ask(line) : {ok: false, text: reason};
    if (!answer.ok) this.onError.emit(answer.text || `“${line}” failed`);
    else if (!quiet && answer.text.includes('next tick')) this.onNote.emit(answer.text);
    return answer;
  }

  /** As ask(), with the text as JSON; null when it is none. */
  async list<T>(what: string): Promise<T | null> {
    const answer = await this.ask(`list ${what} --json`);
    if (!answer.ok) return null;
    try {
      return JSON.parse(answer.text) as T;
    } catch {
      return null;
    }
  }

  async complete(line: string): Promise<string[]> {
    try {
      const answer = await this.client.call<{candidates?: string[]}>('/sandlot/complete', {line}, 3000);
      return Array.isArray(answer.candidates) ? answer.candidates.map(String) : [];
    } catch {
      return [];
    }
  }

  togglePlay(): void {
    const playing = this.store.status?.state === 'playing' || this.store.status?.state === 'seeking';
    void this.say(playing ? 'pause' : 'run');
  }

  jump(time_s: number): void {
    void this.say(`jump ${plain(time_s)}`);
  }

  /** Drags come faster than answers: the newest waits, those between are dropped. */
  drag(line: string): void {
    if (this.dragging) {
      this.nextDrag = line;
      return;
    }
    this.dragging = true;
    void this.say(line, true).then((answer) => {
      this.dragging = false;
      const next = this.nextDrag;
      this.nextDrag = null;
      if (next !== null && answer.ok) this.drag(next);
    });
  }

  remove(name: string): Promise<Answer> {
    return this.say(`remove ${word(name)}`);
  }
}

/** A number as the command language reads it back: all digits that count, no exponent sign trouble, no locale. */
export function plain(value: number): string {
  return String(Number(value.toPrecision(12)));
}
