// Value ranges of the colour maps, from quantiles of a sample, so that outliers do not stretch them.

import type { Columns } from "./frame.ts";

export interface Range {
  low: number;
  high: number;
}

/** A value by which points are coloured. */
export type Field = "height" | "range" | "intensity" | "ring" | "time" | "sd" | "distance";

/** The range of each field; null if the cloud lacks it. */
export interface Ranges extends Record<Field, Range | null> {
  height: Range;
  range: Range;
  /** Distances within which half and 95 % of the points have one of the other cloud, metres; null without a comparison. */
  within_m: { p50: number; p95: number } | null;
  /** Height of the ceiling's lower edge above the tilt axis, metres; null without a ceiling. */
  ceiling_m: number | null;
  /** Centre of the view: the scanner, or the middle of a cloud that is not around its origin. */
  centre: [number, number, number];
  /** Radius around the centre with 97 % of the points, metres. */
  reach_m: number;
  /** The latest time, seconds. */
  end_s: number;
  /** Times in order, seconds, and the tilt angles then, degrees. */
  track: { times: number[]; tilts: number[] };
}

const MOST = 8_192;

/** A row of the sample. */
type Row = { x: number; y: number; z: number; range: number; intensity: number; sd: number; time: number; tilt: number; distance: number };

/** A sample of bounded size: every `stride`th point; the stride doubles when the sample is full. */
export class Sample {
  private rows: Row[] = [];
  private highest_ring = 0;
  private end_s = 0;
  private stride = 1;
  private skip = 0;
  private has = { intensity: false, ring: false, time: false, sd: false, tilt: false, distance: false };

  add(points: Columns, time_offset_s = 0): void {
    const { positions: p, count } = points;
    this.has = {
      intensity: points.intensities.length > 0, ring: points.rings.length > 0, time: points.times.length > 0, sd: points.sds.length > 0, tilt: points.tilts.length > 0,
      distance: points.distances.length > 0,
    };
    // Clouds of other programs need not be in the order of their times.
    for (const time_s of points.times) this.end_s = Math.max(this.end_s, time_s + time_offset_s);
    let i = this.skip;
    for (; i < count; i += this.stride) {
      const [x, y, z] = [p[3 * i] ?? 0, p[3 * i + 1] ?? 0, p[3 * i + 2] ?? 0];
      this.rows.push({
        x, y, z, range: Math.hypot(x, y, z), intensity: points.intensities[i] ?? 0, sd: points.sds[i] ?? 0,
        time: (points.times[i] ?? 0) + time_offset_s, tilt: points.tilts[i] ?? 0, distance: points.distances[i] ?? 0,
      });
      this.highest_ring = Math.max(this.highest_ring, points.rings[i] ?? 0);
      if (this.rows.length >= MOST) this.halve();
    }
    this.skip = i - count;
  }

  ranges(): Ranges | null {
    if (this.rows.length === 0) return null;
    const column = (name: keyof Row) => this.rows.map((row) => row[name]);
    const [x, y, z] = [ascending(column("x")), ascending(column("y")), ascending(column("z"))];
    const centre: [number, number, number] = around(x) && around(y) ? [0, 0, 0] : [quantile(x, 0.5), quantile(y, 0.5), quantile(z, 0.5)];
    const distances = ascending(column("distance"));
    const away = this.rows.map((row) => Math.hypot(row.x - centre[0], row.y - centre[1], row.z - centre[2]));
    const timed = this.has.time && this.end_s > 0;
    const track = timed && this.has.tilt ? [...this.rows].sort((a, b) => a.time - b.time) : [];
    return {
      height: between(z, 0.01, 0.99),
      range: between(ascending(column("range")), 0.01, 0.99),
      intensity: this.has.intensity ? between(ascending(column("intensity")), 0.02, 0.98) : null,
      ring: this.has.ring ? { low: 0, high: Math.max(this.highest_ring, 1) } : null,
      time: timed ? { low: 0, high: Math.max(this.end_s, 1e-3) } : null,
      sd: this.has.sd ? between(ascending(column("sd")), 0.01, 0.97) : null,
      distance: this.has.distance ? { low: 0, high: Math.max(quantile(distances, 0.97), 1e-3) } : null,
      within_m: this.has.distance ? { p50: quantile(distances, 0.5), p95: quantile(distances, 0.95) } : null,
      ceiling_m: ceiling(z),
      centre,
      reach_m: quantile(ascending(away), 0.97),
      end_s: timed ? this.end_s : 0,
      track: { times: track.map((row) => row.time), tilts: track.map((row) => row.tilt) },
    };
  }

  private halve(): void {
    this.rows = this.rows.filter((_, i) => i % 2 === 0);
    this.stride *= 2;
  }
}

/** The tilt angle at a time, from the nearest earlier sample; null without samples. */
export function tiltAt({ times, tilts }: Ranges["track"], time_s: number): number | null {
  let [low, high] = [0, times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((times[middle] ?? 0) <= time_s) low = middle + 1;
    else high = middle;
  }
  return tilts[Math.max(0, low - 1)] ?? null;
}

const ascending = (values: number[]) => [...values].sort((a, b) => a - b);

/** Whether the origin is between the outermost points. */
const around = (sorted: number[]) => quantile(sorted, 0) <= 0 && quantile(sorted, 1) >= 0;

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

function between(sorted: number[], low: number, high: number): Range {
  const range = { low: quantile(sorted, low), high: quantile(sorted, high) };
  return range.high > range.low ? range : { low: range.low, high: range.low + 1e-3 };
}
