// Numbers that a panel wants to follow, by address or expression: asked for by the service watch, which answers with a topic. Asked again after
// a lost connection and after a time in which nobody saw the page.
import type {Client} from '../net/client';
import {secondsOf} from '../net/decoders';

export type SamplesHandler = (time_s: number, values: ArrayLike<number>) => void;

interface Samples {
  stamp: unknown;
  values: ArrayLike<number>;
}

interface WatchAnswer {
  ok: boolean;
  text: string;
  topic: string;
}

export class Watch {
  error = '';
  private stopTopic: (() => void) | null = null;
  private generation = 0;
  private readonly stops: (() => void)[] = [];

  constructor(
      private readonly client: Client, private readonly values: string[], private readonly rate_hz: number,
      private readonly onSamples: SamplesHandler, private readonly onError: (text: string) => void = () => undefined) {
    this.stops.push(client.onChannels.on(() => {
      // The service, or the connection, is there (again).
      if (this.stopTopic === null && this.error === '' && !this.asking) this.start();
    }));
    this.stops.push(client.onState.on((state) => {
      if (state !== 'open') this.end();
    }));
    const onVisibility = (): void => {
      if (document.hidden) this.end();
      else if (this.stopTopic === null) this.start();
    };
    document.addEventListener('visibilitychange', onVisibility);
    this.stops.push(() => document.removeEventListener('visibilitychange', onVisibility));
    this.start();
  }

  private asking = false;

  private start(): void {
    if (this.values.length === 0 || document.hidden || !this.client.services.has('/sandlot/watch')) return;
    const generation = ++this.generation;
    this.asking = true;
    this.client.call<WatchAnswer>('/sandlot/watch', {values: this.values, rate_hz: this.rate_hz}).then((answer) => {
      if (generation !== this.generation) return;
      this.asking = false;
      if (!answer.ok) {
        this.fail(answer.text);
        return;
      }
      this.error = '';
      this.stopTopic = this.client.subscribe(answer.topic, (message) => {
        const samples = message.value() as Samples | undefined;
        if (!samples || samples.values === undefined) return;
        const time_s = secondsOf(samples.stamp);
        this.onSamples(Number.isFinite(time_s) ? time_s : Number(message.time_ns) * 1e-9, samples.values);
      });
    }, (error: unknown) => {
      if (generation !== this.generation) return;
      this.asking = false;
      if (this.client.state === 'open') this.fail(error instanceof Error ? error.message : String(error));
    });
  }

  private fail(text: string): void {
    this.error = text;
    this.onError(text);
  }

  private end(): void {
    this.generation += 1;
    this.asking = false;
    this.error = '';
    this.stopTopic?.();
    this.stopTopic = null;
  }

  close(): void {
    this.end();
    for (const stop of this.stops.splice(0)) stop();
  }
}
