// Values of parameters that panels look at: fetched when somebody looks, kept fresh while they do.
import type {Client, Parameter, ParameterValue} from '../net/client';
import {Signal} from '../net/signal';

export class Parameters {
  readonly values = new Map<string, ParameterValue>();
  /** Names whose value came or changed. */
  readonly onChange = new Signal<Set<string>>();
  private readonly looking = new Map<string, number>();

  constructor(private readonly client: Client) {
    client.onParameters.on((list) => this.take(list));
    client.onInfo.on(() => this.fetch([...this.looking.keys()]));
  }

  private take(list: Parameter[]): void {
    const names = new Set<string>();
    for (const p of list) {
      if (typeof p?.name !== 'string') continue;
      this.values.set(p.name, p.value);
      names.add(p.name);
    }
    if (names.size > 0) this.onChange.emit(names);
  }

  private fetch(names: string[]): void {
    if (names.length > 0) void this.client.getParameters(names).catch(() => undefined);
  }

  /** Returns the function that ends the looking. */
  look(names: string[]): () => void {
    const fresh: string[] = [];
    for (const name of names) {
      const count = this.looking.get(name) ?? 0;
      this.looking.set(name, count + 1);
      if (count === 0) fresh.push(name);
    }
    this.client.watchParameters(fresh);
    this.fetch(fresh);
    return () => {
      const ended: string[] = [];
      for (const name of names) {
        const count = (this.looking.get(name) ?? 1) - 1;
        if (count > 0) {
          this.looking.set(name, count);
        } else {
          this.looking.delete(name);
          this.values.delete(name);
          ended.push(name);
        }
      }
      this.client.unwatchParameters(ended);
    };
  }

  /** Null when the value holds now, else why not. */
  async set(name: string, value: ParameterValue): Promise<string | null> {
    return this.setAll([name], value);
  }

  /** Sets one value at several places: in one request, and so in one tick. */
  async setAll(names: string[], value: ParameterValue): Promise<string | null> {
    const type = typeof value === 'number' ? 'float64' : Array.isArray(value) && typeof value[0] === 'number' ? 'float64_array' : undefined;
    try {
      const answer = await this.client.setParameters(names.map((name): Parameter => (type ? {name, value, type} : {name, value})));
      if (answer.reasons.length === 0) return null;
      return answer.reasons.find((reason) => names.some((name) => reason.includes(name))) ?? answer.reasons[answer.reasons.length - 1] ?? null;
    } catch (error) {
      return error instanceof Error ? error.message : String(error);
    }
  }
}
