/** One time for everything that plays together. */
export class Clock {
  time = 0;
  playing = false;
  rate = 1;
  /** What is repeated, seconds. */
  start = 0;
  end = 1;
  private readonly listeners = new Set<() => void>();

  onChange(listener: () => void): void {
    this.listeners.add(listener);
  }

  tell(): void {
    for (const listener of this.listeners) listener();
  }

  span(start: number, end: number): void {
    this.start = start;
    this.end = Math.max(end, start + 1e-3);
    this.seek(this.time);
  }

  seek(time: number): void {
    this.time = Math.min(Math.max(time, this.start), this.end);
    this.tell();
  }

  play(on: boolean): void {
    this.playing = on;
    if (on && this.time >= this.end) this.time = this.start;
    this.tell();
  }

  /** Let time pass; at the end it begins again. */
  advance(seconds: number): void {
    if (!this.playing) return;
    const length = this.end - this.start;
    const next = this.time + seconds * this.rate;
    this.time = next < this.end ? next : this.start + ((next - this.start) % length);
    this.tell();
  }
}
