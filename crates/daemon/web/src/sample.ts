// Value ranges of the colour maps, from quantiles of a sample, so that outliers do not stretch them.

import type { Columns } from "./frame.ts";

export interface Range {
  low: number;
  high: number;
}

/** The range of each field; `sd` is null if the cloud lacks it. */
export interface Ranges {
  height: Range;
  intensity: Range;
  ring: Range;
  time: Range;
  sd: Range | null;
  /** Height of the ceiling's lower edge above the tilt axis, metres; null without a ceiling. */
  ceiling_m: number | null;
  /** Radius around the scanner with 97 % of the points, metres. */
  reach_m: number;
}

const MOST = 8_192;

/** A sample of bounded size: every `stride`th point; the stride doubles when the sample is full. */
export class Sample {
  private heights: number[] = [];
  private intensities: number[] = [];
  private distances: number[] = [];
  private sds: number[] = [];
  private rings = 0;
  private latest_s = 0;
  private stride = 1;
  private skip = 0;

  add(points: Columns, time_offset_s = 0): void {
    const { positions: p, count } = points;
    if (count > 0) this.latest_s = Math.max(this.latest_s, (points.times[count - 1] ?? 0) + time_offset_s);
    let i = this.skip;
    for (; i < count; i += this.stride) {
      const [x, y, z] = [p[3 * i] ?? 0, p[3 * i + 1] ?? 0, p[3 * i + 2] ?? 0];
      this.heights.push(z);
      this.distances.push(Math.hypot(x, y, z));
      this.intensities.push(points.intensities[i] ?? 0);
      this.rings = Math.max(this.rings, points.rings[i] ?? 0);
      if (points.sds.length > 0) this.sds.push(points.sds[i] ?? 0);
      if (this.heights.length >= MOST) this.halve();
    }
    this.skip = i - count;
  }

  ranges(): Ranges | null {
    if (this.heights.length === 0) return null;
    const reach = quantile(ascending(this.distances), 0.97);
    return {
      height: between(this.heights, 0.01, 0.99),
      intensity: between(this.intensities, 0.02, 0.98),
      ring: { low: 0, high: Math.max(this.rings, 1) },
      time: { low: 0, high: Math.max(this.latest_s, 1e-3) },
      sd: this.sds.length > 0 ? between(this.sds, 0.01, 0.97) : null,
      ceiling_m: ceiling(ascending(this.heights)),
      reach_m: reach,
    };
  }

  private halve(): void {
    const half = (values: number[]) => values.filter((_, i) => i % 2 === 0);
    this.heights = half(this.heights);
    this.intensities = half(this.intensities);
    this.distances = half(this.distances);
    this.sds = half(this.sds);
    this.stride *= 2;
  }
}

const ascending = (values: number[]) => [...values].sort((a, b) => a - b);

/** Detects a ceiling: many points at nearly the greatest height. */
function ceiling(sorted: number[]): number | null {
  const top = quantile(sorted, 0.97);
  const begin = top - 0.5;
  const share = sorted.filter((height) => height > begin).length / sorted.length;
  return top > 1 && share > 0.1 ? begin : null;
}

function quantile(sorted: number[], share: number): number {
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
}

function between(values: number[], low: number, high: number): Range {
  const sorted = ascending(values);
  const range = { low: quantile(sorted, low), high: quantile(sorted, high) };
  return range.high > range.low ? range : { low: range.low, high: range.low + 1e-3 };
}
