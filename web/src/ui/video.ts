// Records what the scene shows as a WebM file, in the page.
import type {Context} from '../app/context';
import {formatTime} from '../app/format';
import {saveBlob} from './save';

const frames_per_s = 30;
const bits_per_s = 8_000_000;

export class Video {
  private recorder: MediaRecorder | null = null;
  private started_ms = 0;
  onChange: () => void = () => undefined;

  constructor(private readonly context: Context) {}

  get active(): boolean {
    return this.recorder !== null;
  }

  elapsed(): string {
    return formatTime(Math.floor((performance.now() - this.started_ms) / 1000)).replace(/\.00/, '');
  }

  toggle(): void {
    if (this.recorder) {
      this.recorder.stop();
      return;
    }
    if (typeof MediaRecorder === 'undefined') {
      this.context.toast('This browser cannot record video', 'warning');
      return;
    }
    const kind = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'].find((k) => MediaRecorder.isTypeSupported(k));
    const chunks: Blob[] = [];
    let recorder: MediaRecorder;
    try {
      recorder = new MediaRecorder(this.context.scene.captureStream(frames_per_s), {mimeType: kind, videoBitsPerSecond: bits_per_s});
    } catch (error) {
      this.context.toast(`Recording did not start: ${error instanceof Error ? error.message : String(error)}`, 'error');
      return;
    }
    recorder.ondataavailable = (event) => {
      if (event.data.size > 0) chunks.push(event.data);
    };
    recorder.onstop = () => {
      this.recorder = null;
      for (const track of recorder.stream.getTracks()) track.stop();
      const name = `${(this.context.store.world?.name ?? 'sandlot').replace(/[^\w-]+/g, '-')}.${kind?.includes('mp4') ? 'mp4' : 'webm'}`;
      saveBlob(new Blob(chunks, {type: kind}), name);
      this.context.toast(`Saved ${name}`);
      this.onChange();
    };
    recorder.start(1000);
    this.recorder = recorder;
    this.started_ms = performance.now();
    this.onChange();
  }
}
