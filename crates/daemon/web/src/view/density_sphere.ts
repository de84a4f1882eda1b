// Points by direction on a small sphere, as the daemon counts them in bins of 3 degrees.

import { MARKS, css } from "./maps.ts";

export interface Bin {
  direction: [number, number, number];
  points: number;
}

/** Radii of a bin's discs, radians: large ones leave no ground between them, small ones on top of all have each its own colour. */
const DISCS_RAD = [0.05, 0.026];

/**
 * The bins on the far half of a sphere around the scanner, seen from a camera in this direction (radians, as the orbit has
 * it), nearest to the edge first: x to the right and y up from -1 to 1, and how flat its disc is seen.
 */
export function seen(bins: Bin[], azimuth: number, elevation: number): { x: number; y: number; flat: number; points: number }[] {
  const [sa, ca, se, ce] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
  return bins.flatMap(({ direction: [x, y, z], points }) => {
    const toward = ce * ca * x + ce * sa * y + se * z;
    return toward > 0 ? [] : [{ x: ca * y - sa * x, y: ce * z - se * (ca * x + sa * y), flat: -toward, points }];
  }).sort((a, b) => a.flat - b.flat);
}

/** Colours end at the points that one of 50 bins exceeds. */
export function limit(bins: Bin[]): number {
  const sorted = bins.map(({ points }) => points).sort((a, b) => a - b);
  return Math.max(1, sorted[Math.floor(0.98 * (sorted.length - 1))] ?? 1);
}

/** Draws them; bins without a point have a colour of their own. */
export function draw(canvas: HTMLCanvasElement, bins: Bin[], azimuth: number, elevation: number, colours: Uint8Array): void {
  const context = canvas.getContext("2d");
  if (context === null) return;
  const { width, height } = canvas;
  const radius = 0.47 * Math.min(width, height);
  const most = limit(bins);
  context.clearRect(0, 0, width, height);
  const drawn = seen(bins, azimuth, elevation);
  for (const disc_rad of DISCS_RAD) for (const { x, y, flat, points } of drawn) {
    context.fillStyle = points === 0 ? `rgb(${MARKS[1].map((part) => 255 * part).join(" ")})` : css(colours, points / most);
    context.beginPath();
    context.ellipse(width / 2 + radius * x, height / 2 - radius * y, radius * disc_rad * Math.max(0.15, flat), radius * disc_rad, Math.atan2(-y, x), 0, 2 * Math.PI);
    context.fill();
  }
}
