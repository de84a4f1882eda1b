// Plays the points of a cloud in the order of their times.

import { attribute, id, show, text } from "../dom.ts";

const box = id("player");
const button = id<HTMLButtonElement>("play");
const slide = id<HTMLInputElement>("time");
const now = id("time-now");
const rate = id<HTMLSelectElement>("rate");

export class Player {
  private end_s = 0;
  private at_s: number | null = null;
  private frame = 0;
  private last_ms = 0;

  /** `changed` gets the time up to which points are shown; null for all. */
  constructor(private readonly changed: (until_s: number | null) => void) {
    button.addEventListener("click", () => this.toggle());
    slide.addEventListener("input", () => {
      // Pausing draws, which moves the slider.
      const share = Number(slide.value);
      this.pause();
      this.set(share * this.end_s);
    });
  }

  /** Time up to which points are shown; null for all. */
  get until_s(): number | null {
    return this.at_s;
  }

  /** A cloud whose last point is at this time; 0 without times. */
  setEnd(end_s: number): void {
    this.end_s = end_s;
    show(box, end_s > 0);
    this.draw();
  }

  /** Shows the points up to a time; all from the end on. */
  set(time_s: number): void {
    this.at_s = time_s >= this.end_s ? null : Math.max(0, time_s);
    this.draw();
    this.changed(this.at_s);
  }

  /** Shows all points. */
  reset(): void {
    this.pause();
    this.set(Number.POSITIVE_INFINITY);
  }

  play(): void {
    if (this.end_s === 0 || this.frame !== 0) return;
    this.at_s ??= 0;
    this.last_ms = performance.now();
    this.frame = requestAnimationFrame(() => this.tick());
    this.draw();
  }

  private toggle(): void {
    if (this.frame === 0) this.play();
    else this.pause();
  }

  private pause(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    this.draw();
  }

  private tick(): void {
    const now_ms = performance.now();
    const passed_s = (now_ms - this.last_ms) / 1_000;
    this.last_ms = now_ms;
    this.frame = requestAnimationFrame(() => this.tick());
    this.set((this.at_s ?? 0) + passed_s * Number(rate.value));
    if (this.at_s === null) this.pause();
  }

  private draw(): void {
    const playing = this.frame !== 0;
    const at_s = this.at_s ?? this.end_s;
    text(button, playing ? "Pause" : "Play");
    slide.value = String(this.end_s > 0 ? at_s / this.end_s : 1);
    const words = `${at_s.toFixed(2)} of ${this.end_s.toFixed(2)} s`;
    attribute(slide, "aria-valuetext", words);
    text(now, words);
  }
}
