// Orders points so that neighbours in space are neighbours in the list.

/** Bits of each coordinate: cells of a thousandth of the extent. */
const BITS = 10;

/** The numbers of at most 2^23 points along a Morton curve through their bounding box. */
export function along_curve(positions: Float32Array): Uint32Array {
  const count = positions.length / 3;
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let i = 0; i < positions.length; i += 1) {
    const m = positions[i] ?? 0;
    if (m < (low[i % 3] ?? 0)) low[i % 3] = m;
    if (m > (high[i % 3] ?? 0)) high[i % 3] = m;
  }
  const most = 2 ** BITS - 1;
  const scale = low.map((m, axis) => most / Math.max(1e-9, (high[axis] ?? 0) - m));
  // Cell and number in one float, so that the numbers are sorted without a comparison function.
  const keys = new Float64Array(count);
  for (let i = 0; i < count; i += 1) {
    const [x, y, z] = [0, 1, 2].map((axis) => spread(((positions[3 * i + axis] ?? 0) - (low[axis] ?? 0)) * (scale[axis] ?? 0)));
    keys[i] = ((x ?? 0) | ((y ?? 0) << 1) | ((z ?? 0) << 2)) * 2 ** 23 + i;
  }
  return Uint32Array.from(keys.sort(), (key) => key % 2 ** 23);
}

/** Puts two zeros between the ten bits of a whole number. */
function spread(value: number): number {
  let bits = Math.floor(value);
  bits = (bits | (bits << 16)) & 0x030000ff;
  bits = (bits | (bits << 8)) & 0x0300f00f;
  bits = (bits | (bits << 4)) & 0x030c30c3;
  return (bits | (bits << 2)) & 0x09249249;
}
