// Incremental parser of binary little-endian PLY, without lists and faces. It needs neither worker nor DOM.

import type { Columns } from "./frame.ts";

const SIZES: Record<string, number> = {
  char: 1, int8: 1, uchar: 1, uint8: 1, short: 2, int16: 2, ushort: 2, uint16: 2,
  int: 4, int32: 4, uint: 4, uint32: 4, float: 4, float32: 4, double: 8, float64: 8,
};
/** Longest accepted header. */
const MOST_HEADER_BYTES = 65_536;

type Get = (view: DataView, at: number) => number;

interface Header {
  count: number;
  rowBytes: number;
  columns: Map<string, Get>;
  /** Whether velomotion's simulator made the points. */
  simulated: boolean;
}

/** Coordinates from here on lose millimetres as 32-bit numbers: 2^-24 of 16 km is 1 mm. */
const FAR_M = 16_384;

function getter(kind: string, offset: number): Get {
  switch (kind) {
    case "float": case "float32": return (view, at) => view.getFloat32(at + offset, true);
    case "double": case "float64": return (view, at) => view.getFloat64(at + offset, true);
    case "uchar": case "uint8": return (view, at) => view.getUint8(at + offset);
    case "char": case "int8": return (view, at) => view.getInt8(at + offset);
    case "ushort": case "uint16": return (view, at) => view.getUint16(at + offset, true);
    case "short": case "int16": return (view, at) => view.getInt16(at + offset, true);
    case "uint": case "uint32": return (view, at) => view.getUint32(at + offset, true);
    default: return (view, at) => view.getInt32(at + offset, true);
  }
}

/** Parses the header; throws for other kinds of PLY. */
export function parseHeader(text: string): Header {
  const header: Header = { count: -1, rowBytes: 0, columns: new Map(), simulated: /^comment SIMULATED/m.test(text) };
  let element = "";
  for (const line of text.split("\n")) {
    const [word, first, second] = line.trim().split(/\s+/);
    if (word === "format" && first !== "binary_little_endian") throw new Error(`PLY: format ${first}, expected binary_little_endian`);
    if (word === "element") {
      element = first ?? "";
      if (element === "vertex") header.count = Number(second);
    }
    if (word === "property" && element === "vertex") {
      const bytes = SIZES[first ?? ""];
      if (bytes === undefined || second === undefined) throw new Error(`PLY: property ${line}`);
      header.columns.set(second, getter(first ?? "", header.rowBytes));
      header.rowBytes += bytes;
    }
  }
  for (const name of ["x", "y", "z"]) {
    if (!header.columns.has(name)) throw new Error(`PLY: no property ${name}`);
  }
  if (!Number.isSafeInteger(header.count) || header.count < 0) throw new Error("PLY: no number of vertices");
  return header;
}

/** Turns bytes into batches of points. */
export class PlyReader {
  private rest: Uint8Array = new Uint8Array(0);
  private pieces: Uint8Array[] = [];
  /** Bytes of the rest and the pieces. */
  private waiting = 0;
  private header: Header | null = null;
  private start_s: number | null = null;
  private shift: [number, number, number] | null = null;
  private read = 0;

  /** Points in a batch. */
  constructor(private readonly batch: number) {}

  /** Number of points in the header; null before it is read. */
  get count(): number | null {
    return this.header?.count ?? null;
  }

  /** What was subtracted from the positions, metres: not zero for coordinates of a map. */
  get origin(): [number, number, number] {
    return this.shift ?? [0, 0, 0];
  }

  get simulated(): boolean {
    return this.header?.simulated ?? false;
  }

  /** Points read so far. */
  get done(): number {
    return this.read;
  }

  /** Takes bytes and yields the complete batches. */
  *push(piece: Uint8Array): Generator<Columns> {
    this.pieces.push(piece);
    this.waiting += piece.length;
    // Pieces are joined once they have a batch.
    if (this.header !== null && this.waiting < this.batch * this.header.rowBytes) return;
    this.join();
    if (this.header === null && !this.takeHeader()) return;
    yield* this.batches(this.batch);
  }

  /** Yields the rows after the last complete batch; throws if the file is cut off. */
  *end(): Generator<Columns> {
    this.join();
    if (this.header === null) throw new Error("PLY: no header");
    yield* this.batches(1);
    if (this.read < this.header.count) throw new Error(`PLY: ${this.read} of ${this.header.count} points, then the file ends`);
  }

  /** Appends the pieces to the rest. */
  private join(): void {
    const bytes = new Uint8Array(this.waiting);
    let end = 0;
    for (const piece of [this.rest, ...this.pieces]) {
      bytes.set(piece, end);
      end += piece.length;
    }
    this.rest = bytes;
    this.pieces = [];
  }

  private takeHeader(): boolean {
    const start = new TextDecoder("latin1").decode(this.rest.subarray(0, MOST_HEADER_BYTES));
    const end = /end_header\r?\n/.exec(start);
    if (end === null) {
      if (!"ply".startsWith(start.slice(0, 3)) || this.rest.length >= MOST_HEADER_BYTES) throw new Error("not a PLY file");
      return false;
    }
    if (!start.startsWith("ply")) throw new Error("not a PLY file");
    this.header = parseHeader(start.slice(0, end.index));
    this.rest = this.rest.subarray(end.index + end[0].length);
    this.waiting = this.rest.length;
    return true;
  }

  private *batches(least: number): Generator<Columns> {
    const header = this.header;
    if (header === null) return;
    for (;;) {
      const available = Math.floor(this.rest.length / header.rowBytes);
      const take = Math.min(available, this.batch, header.count - this.read);
      const last = this.read + take === header.count;
      if (take === 0 || (take < least && !last)) return;
      yield this.rows(header, take);
      this.rest = this.rest.subarray(take * header.rowBytes);
      this.waiting = this.rest.length;
      this.read += take;
    }
  }

  private rows(header: Header, count: number): Columns {
    const view = new DataView(this.rest.buffer, this.rest.byteOffset, count * header.rowBytes);
    const { rowBytes, columns } = header;
    const axes = ["x", "y", "z"].map((name) => columns.get(name) as Get);
    if (this.shift === null) {
      const first = axes.map((axis) => axis(view, 0));
      this.shift = first.some((m) => Math.abs(m) >= FAR_M) ? first.map((m) => 100 * Math.round(m / 100)) as [number, number, number] : [0, 0, 0];
    }
    const positions = new Float32Array(3 * count);
    axes.forEach((axis, a) => {
      const shift = this.shift?.[a] ?? 0;
      for (let i = 0; i < count; i += 1) positions[3 * i + a] = axis(view, i * rowBytes) - shift;
    });
    const filled = <T extends Float32Array | Uint8Array>(name: string, make: (n: number) => T, from = 0): T => {
      const get = columns.get(name);
      const out = make(get === undefined ? 0 : count);
      if (get !== undefined) for (let i = 0; i < count; i += 1) out[i] = get(view, i * rowBytes) - from;
      return out;
    };
    const floats = (n: number) => new Float32Array(n);
    const bytes = (n: number) => new Uint8Array(n);
    this.start_s ??= columns.get("time")?.(view, 0) ?? 0;
    return {
      count,
      positions,
      times: filled("time", floats, this.start_s),
      sds: filled("sd", floats),
      tilts: filled("tilt", floats),
      intensities: filled("intensity", floats),
      rings: filled("ring", bytes),
      lasers: filled("laser", bytes),
      echoes: filled("echo", bytes),
      distances: floats(0),
    };
  }
}
