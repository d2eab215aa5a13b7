// A stick on the screen for mouse, pen and finger: up is forward, sideways turns.
import {h} from './dom';

export class Stick {
  private readonly knob = h('div', {class: 'knob'});
  readonly element = h('div', {class: 'stick', role: 'application', 'aria-label': 'Stick: up and down drive, left and right turn', testid: 'stick'}, this.knob);
  private pointer: number | null = null;

  constructor(private readonly moved: (x: number, y: number) => void) {
    this.element.addEventListener('pointerdown', (event) => {
      this.pointer = event.pointerId;
      this.element.setPointerCapture(event.pointerId);
      this.follow(event);
      event.preventDefault();
      event.stopPropagation();
    });
    this.element.addEventListener('pointermove', (event) => {
      if (event.pointerId === this.pointer) this.follow(event);
    });
    const release = (event: PointerEvent): void => {
      if (event.pointerId !== this.pointer) return;
      this.pointer = null;
      this.set(0, 0);
    };
    this.element.addEventListener('pointerup', release);
    this.element.addEventListener('pointercancel', release);
    this.element.addEventListener('lostpointercapture', release);
  }

  private follow(event: PointerEvent): void {
    const box = this.element.getBoundingClientRect();
    const radius = box.width / 2 - 14;
    let x = (event.clientX - box.left - box.width / 2) / radius;
    let y = (box.top + box.height / 2 - event.clientY) / radius;
    const size = Math.hypot(x, y);
    if (size > 1) {
      x /= size;
      y /= size;
    }
    this.set(Math.abs(x) < 0.08 ? 0 : x, Math.abs(y) < 0.08 ? 0 : y);
  }

  private set(x: number, y: number): void {
    const reach_px = this.element.clientWidth / 2 - 26;
    this.knob.style.transform = `translate(${x * reach_px}px, ${-y * reach_px}px)`;
    this.moved(x, y);
  }
}
