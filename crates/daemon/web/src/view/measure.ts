// Distances between picked points, and lengths of the scale bar.

import type { Picked } from "../picked.ts";

/** A distance with its uncertainty, metres; null if a point has none. */
export interface Distance {
  m: number;
  /**
   * Standard error. A point's sd is the root mean square of its error in three dimensions, so along any line
   * its error is at most that; the errors of two points are taken as independent.
   */
  sd_m: number | null;
  /** Along x, y and z. */
  along_m: [number, number, number];
}

export function distance(a: Picked, b: Picked): Distance {
  const along_m = [0, 1, 2].map((axis) => (b.position[axis] ?? 0) - (a.position[axis] ?? 0)) as [number, number, number];
  const known = a.sd_m > 0 && b.sd_m > 0;
  return { m: Math.hypot(...along_m), sd_m: known ? Math.hypot(a.sd_m, b.sd_m) : null, along_m };
}

/** A scale bar: the longest of 1, 2 and 5 times a power of ten metres that is at most `most_px` long. In perspective it holds at the target's distance. */
export function scaleBar(metres_per_px: number, most_px: number, parallel: boolean): { m: number; px: number; words: string } {
  const most_m = metres_per_px * most_px;
  const power = 10 ** Math.floor(Math.log10(most_m));
  const m = power * ([5, 2, 1].find((step) => step * power <= most_m) ?? 1);
  const words = m >= 1 ? `${Number(m.toPrecision(3))} m` : m >= 0.01 ? `${Number((100 * m).toPrecision(3))} cm` : `${Number((1_000 * m).toPrecision(3))} mm`;
  return { m, px: m / metres_per_px, words: parallel ? words : `\u2248 ${words}` };
}
