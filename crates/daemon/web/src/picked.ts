// The values of a picked point.

import type { Columns } from "./frame.ts";

export type Position = [number, number, number];

export interface Picked {
  position: Position;
  time_s: number;
  sd_m: number;
  tilt_deg: number;
  intensity: number;
  ring: number;
  laser: number;
  echo: number;
  /** From the nearest point of the cloud with which this one is compared, metres. */
  distance_m: number;
  /** Whether the cloud had the columns that stored clouds lack. */
  complete: boolean;
}

/** Live points are about so much less accurate than those of the cloud, metres. */
const NEAR_M = 0.05;

/** A picked point and how far it is from the position where it was looked for, metres. */
export interface Found {
  picked: Picked;
  off_m: number;
}

/** The values of the point that is nearest to a position, if that is nearer than `before`; `before` if none is. */
export function nearer(columns: Columns, [x, y, z]: Position, before: Found | null): Found | null {
  const { positions: p, count } = columns;
  let [best, least] = [-1, (before?.off_m ?? NEAR_M) ** 2];
  for (let i = 0; i < count; i += 1) {
    const square = ((p[3 * i] ?? 0) - x) ** 2 + ((p[3 * i + 1] ?? 0) - y) ** 2 + ((p[3 * i + 2] ?? 0) - z) ** 2;
    if (square < least) [best, least] = [i, square];
  }
  return best < 0 ? before : { picked: valuesOf(columns, best), off_m: Math.sqrt(least) };
}

function valuesOf(columns: Columns, i: number): Picked {
  const { positions: p, times, sds, tilts, intensities, rings, lasers, echoes, distances } = columns;
  return {
    position: [p[3 * i] ?? 0, p[3 * i + 1] ?? 0, p[3 * i + 2] ?? 0], complete: lasers.length > 0, time_s: times[i] ?? 0, sd_m: sds[i] ?? 0, tilt_deg: tilts[i] ?? 0, intensity: intensities[i] ?? 0, ring: rings[i] ?? 0, laser: lasers[i] ?? 0,
    echo: echoes[i] ?? 0, distance_m: distances[i] ?? 0,
  };
}
