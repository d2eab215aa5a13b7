// What a frame costs, averaged over the last second.

export interface SceneStats {
  fps: number;
  /** Mean per frame: decoding, kinematics, matrices, overlays. */
  script_ms: number;
  /** Mean per frame: what the renderer takes to hand it all to WebGL. */
  submit_ms: number;
  draw_calls: number;
  triangles: number;
  instances: number;
}

const WINDOW = 240;

export class Meter {
  private readonly times_ms = new Float64Array(WINDOW).fill(-Infinity);
  private readonly scripts_ms = new Float64Array(WINDOW);
  private readonly submits_ms = new Float64Array(WINDOW);
  private at = 0;
  private pending_ms = 0;

  /** Script time outside of frames (a message that came) counts for the next frame. */
  addScript(ms: number): void {
    this.pending_ms += ms;
  }

  frame(now_ms: number, script_ms: number, submit_ms: number): void {
    this.times_ms[this.at] = now_ms;
    this.scripts_ms[this.at] = script_ms + this.pending_ms;
    this.submits_ms[this.at] = submit_ms;
    this.pending_ms = 0;
    this.at = (this.at + 1) % WINDOW;
  }

  read(now_ms: number): { fps: number; script_ms: number; submit_ms: number } {
    let frames = 0, script_ms = 0, submit_ms = 0;
    for (let i = 0; i < WINDOW; ++i) {
      if (this.times_ms[i] < now_ms - 1000) continue;
      ++frames;
      script_ms += this.scripts_ms[i];
      submit_ms += this.submits_ms[i];
    }
    const share = frames > 0 ? 1 / frames : 0;
    return { fps: frames, script_ms: script_ms * share, submit_ms: submit_ms * share };
  }
}
