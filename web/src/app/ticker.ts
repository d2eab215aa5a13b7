// Runs what wants to be drawn, each thing at most once per animation frame.
export class Ticker {
  private readonly wanted = new Set<() => void>();
  private running = false;

  request(update: () => void): void {
    this.wanted.add(update);
    if (this.running) return;
    this.running = true;
    requestAnimationFrame(() => {
      this.running = false;
      const now = [...this.wanted];
      this.wanted.clear();
      for (const one of now) {
        try {
          one();
        } catch (error) {
          console.error(error);
        }
      }
    });
  }
}

export const ticker = new Ticker();
