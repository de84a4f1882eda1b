// Live points: the binary messages of the events (docs: The daemon, Events).

const HEAD_BYTES = 32;
const POINT_BYTES = 22;
const MOST_POINTS = 16_384;
/** "VMP1", little-endian. */
const MAGIC = 0x31504d56;

/** Points as columns: 3 N positions, N of each other value, or none of a column that the cloud lacks. */
export interface Columns {
  count: number;
  /** Metres. */
  positions: Float32Array;
  /** Seconds after the cloud's or frame's first point. */
  times: Float32Array;
  /** Expected errors, metres. */
  sds: Float32Array;
  /** Tilt angles, degrees. */
  tilts: Float32Array;
  intensities: Uint8Array | Float32Array;
  rings: Uint8Array;
  /** Numbers of the lasers in firing order. */
  lasers: Uint8Array;
  /** Which returns of their pulses, as docs/src/formats.md numbers them. */
  echoes: Uint8Array;
  /** Distances to the nearest points of the cloud with which this one is compared, metres. */
  distances: Float32Array;
}

/** The columns other than the positions. */
export const COLUMNS = ["times", "sds", "tilts", "intensities", "rings", "lasers", "echoes", "distances"] as const;

/** Points with nothing but positions. */
export function placed(positions: Float32Array): Columns {
  const [floats, bytes] = [new Float32Array(0), new Uint8Array(0)];
  return { count: positions.length / 3, positions, times: floats, sds: floats, tilts: floats, intensities: bytes, rings: bytes, lasers: bytes, echoes: bytes, distances: floats };
}

export interface Frame extends Columns {
  /** Unix seconds of the first point. */
  start_s: number;
  /** Within the scan, from 0. */
  number: number;
  /** Records omitted from the live cloud so far. */
  left_out: number;
  tilt_deg: number;
}

/** Parses a frame; null if the bytes are not a frame. The columns are views into `bytes`. */
export function parseFrame(bytes: ArrayBuffer): Frame | null {
  if (bytes.byteLength < HEAD_BYTES) return null;
  const head = new DataView(bytes);
  const count = head.getUint32(4, true);
  if (head.getUint32(0, true) !== MAGIC || count > MOST_POINTS) return null;
  if (bytes.byteLength !== HEAD_BYTES + POINT_BYTES * count) return null;
  const at = (column: number) => HEAD_BYTES + column * count;
  return {
    count,
    start_s: head.getFloat64(8, true),
    number: head.getUint32(16, true),
    left_out: head.getUint32(20, true),
    tilt_deg: head.getFloat32(24, true),
    positions: new Float32Array(bytes, at(0), 3 * count),
    times: new Float32Array(bytes, at(12), count),
    sds: new Float32Array(bytes, at(16), count),
    tilts: new Float32Array(count).fill(head.getFloat32(24, true)),
    intensities: new Uint8Array(bytes, at(20), count),
    rings: new Uint8Array(bytes, at(21), count),
    lasers: new Uint8Array(0),
    echoes: new Uint8Array(0),
    distances: new Float32Array(0),
  };
}
