// Distances to the nearest point of another cloud. It needs neither worker nor DOM.
//
// A tree of bounding boxes: the density of a scan falls with the square of the range, so that no grid's cell size suits all of it.

/** Greatest distance that is measured, metres. */
export const MOST_M = 1;
/** Boxes of at most that many points are not halved. */
const LEAF = 12;

/** The points of a cloud in boxes, each halved across its longest side. Box n has the halves 2 n and 2 n + 1; the whole is 1. */
export class PointTree {
  /** The number of points; those that are not finite are left out. */
  readonly count: number;
  /** Of each box: least x, y and z, then greatest. */
  private readonly boxes: Float32Array;
  private x = 0;
  private y = 0;
  private z = 0;
  private least_square = 0;

  /** Reorders the positions (x, y, z, x, ...) in place. */
  constructor(private readonly positions: Float32Array) {
    let count = 0;
    for (let i = 0; i + 2 < positions.length; i += 3) {
      const [x, y, z] = [positions[i] ?? 0, positions[i + 1] ?? 0, positions[i + 2] ?? 0];
      if (!Number.isFinite(x + y + z)) continue;
      positions[3 * count] = x;
      positions[3 * count + 1] = y;
      positions[3 * count + 2] = z;
      count += 1;
    }
    this.count = count;
    this.boxes = new Float32Array(12 * 2 ** Math.max(0, Math.ceil(Math.log2(count / LEAF))));
    if (count > 0) this.halve(1, 0, count);
  }

  /** Distance from a place to the nearest point, metres: `MOST_M` if there is none within. */
  distance(x: number, y: number, z: number): number {
    this.x = x;
    this.y = y;
    this.z = z;
    this.least_square = MOST_M * MOST_M;
    if (this.count > 0 && this.square(1) < this.least_square) this.search(1, 0, this.count);
    return Math.sqrt(this.least_square);
  }

  /** Distances of points whose coordinates have another origin, which is at `shift` in those of the tree. */
  distances(positions: Float32Array, shift: readonly [number, number, number]): Float32Array {
    const out = new Float32Array(positions.length / 3);
    for (let i = 0; i < out.length; i += 1) {
      out[i] = this.distance((positions[3 * i] ?? 0) + shift[0], (positions[3 * i + 1] ?? 0) + shift[1], (positions[3 * i + 2] ?? 0) + shift[2]);
    }
    return out;
  }

  private halve(box: number, begin: number, end: number): void {
    let [axis, longest_m] = [0, -1];
    for (let a = 0; a < 3; a += 1) {
      let low = Infinity;
      let high = -Infinity;
      for (let i = 3 * begin + a; i < 3 * end; i += 3) {
        const value = this.positions[i] ?? 0;
        if (value < low) low = value;
        if (value > high) high = value;
      }
      this.boxes[6 * box + a] = low;
      this.boxes[6 * box + 3 + a] = high;
      if (high - low > longest_m) [axis, longest_m] = [a, high - low];
    }
    if (end - begin <= LEAF) return;
    const middle = (begin + end) >> 1;
    select(this.positions, begin, end - 1, middle, axis);
    this.halve(2 * box, begin, middle);
    this.halve(2 * box + 1, middle, end);
  }

  /** Square of the distance from the place to a box. */
  private square(box: number): number {
    const b = this.boxes;
    const i = 6 * box;
    const dx = Math.max((b[i] ?? 0) - this.x, 0, this.x - (b[i + 3] ?? 0));
    const dy = Math.max((b[i + 1] ?? 0) - this.y, 0, this.y - (b[i + 4] ?? 0));
    const dz = Math.max((b[i + 2] ?? 0) - this.z, 0, this.z - (b[i + 5] ?? 0));
    return dx * dx + dy * dy + dz * dz;
  }

  /** Searches a box, which has the points from `begin` to `end`; its nearer half first. */
  private search(box: number, begin: number, end: number): void {
    if (end - begin <= LEAF) return this.compare(begin, end);
    const middle = (begin + end) >> 1;
    const left = this.square(2 * box);
    const right = this.square(2 * box + 1);
    if (left <= right) {
      if (left < this.least_square) this.search(2 * box, begin, middle);
      if (right < this.least_square) this.search(2 * box + 1, middle, end);
    } else {
      if (right < this.least_square) this.search(2 * box + 1, middle, end);
      if (left < this.least_square) this.search(2 * box, begin, middle);
    }
  }

  private compare(begin: number, end: number): void {
    const p = this.positions;
    let least = this.least_square;
    for (let i = 3 * begin; i < 3 * end; i += 3) {
      const dx = (p[i] ?? 0) - this.x;
      const dy = (p[i + 1] ?? 0) - this.y;
      const dz = (p[i + 2] ?? 0) - this.z;
      const square = dx * dx + dy * dy + dz * dz;
      if (square < least) least = square;
    }
    this.least_square = least;
  }
}

/** Reorders points so that none before `middle` is greater along an axis, and none after it less (Hoare's algorithm). */
function select(positions: Float32Array, first: number, last: number, middle: number, axis: number): void {
  while (first < last) {
    const pivot = positions[3 * middle + axis] ?? 0;
    let i = first;
    let j = last;
    while (i <= j) {
      while ((positions[3 * i + axis] ?? 0) < pivot) i += 1;
      while ((positions[3 * j + axis] ?? 0) > pivot) j -= 1;
      if (i > j) break;
      for (let a = 0; a < 3; a += 1) {
        const value = positions[3 * i + a] ?? 0;
        positions[3 * i + a] = positions[3 * j + a] ?? 0;
        positions[3 * j + a] = value;
      }
      i += 1;
      j -= 1;
    }
    if (j < middle) first = i;
    if (middle < i) last = j;
  }
}
