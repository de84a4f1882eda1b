// Where a step of the axis ends.

/**
 * The angle after a step: at a limit if the step is longer than the way there. Null if nothing would move, or if the
 * angle is not known. Rounded to 0.001 degrees, as angles are shown.
 */
export function target(angle_deg: number | null, step_deg: number, bounds: { min_deg: number; max_deg: number } | null): number | null {
  if (angle_deg === null || bounds === null) return null;
  const end = Math.round(1_000 * Math.min(bounds.max_deg, Math.max(bounds.min_deg, angle_deg + step_deg))) / 1_000;
  // An axis at rest is within this of its limit.
  const there = Math.abs(end - angle_deg) < 0.02 || Math.sign(end - angle_deg) !== Math.sign(step_deg);
  return there ? null : end;
}
