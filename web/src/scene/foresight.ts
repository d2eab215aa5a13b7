// What a drag asks for, shown before it is answered.
//
// While the run plays, messages come thirty times a second and tell the truth. While it stands still the answer to a drag
// is the only message, so the body is shown at once where it is asked to be. A drag that nobody answers (a spectator's, or
// one that is refused) is taken back.
import type { Bodies, Body } from './bodies';
import type { Drag } from './hands';

/** Without a message of it for so long a body is taken to stand. */
const STANDS_STILL_MS = 300;
const ANSWER_WITHIN_MS = 1000;

export class Foresight {
  private begin: { body: Body; pose: Float64Array; ms: number } | null = null;
  private timer = 0;

  constructor(
    private readonly bodies: Bodies,
    private readonly show: (name: string, position: readonly number[], yaw_rad?: number) => void,
    private readonly changed: () => void,
  ) {}

  drag(drag: Drag): void {
    const body = this.bodies.by_name.get(drag.name);
    if (body === undefined || drag.mode === 'pull') return;
    const now_ms = performance.now();
    if (drag.phase === 'start') this.begin = { body, pose: body.world.slice(0, 7), ms: now_ms };
    const begin = this.begin;
    if (begin === null || begin.body !== body || now_ms - body.told_ms < STANDS_STILL_MS) return;
    this.show(drag.name, drag.target, drag.yaw);
    if (drag.phase !== 'end') return;
    window.clearTimeout(this.timer);
    this.timer = window.setTimeout(() => {
      if (this.bodies.by_name.get(drag.name) !== body || body.told_ms > begin.ms) return;
      body.override(begin.pose, this.bodies.scratch);
      this.bodies.noteMoved(body);
      this.changed();
    }, ANSWER_WITHIN_MS);
  }

  dispose(): void {
    window.clearTimeout(this.timer);
  }
}
