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
}

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
  const header: Header = { count: -1, rowBytes: 0, columns: new Map() };
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
  private header: Header | null = null;
  private start_s: number | null = null;
  private read = 0;

  /** Points in a batch. */
  constructor(private readonly batch: number) {}

  /** Number of points in the header; null before it is read. */
  get count(): number | null {
    return this.header?.count ?? null;
  }

  /** Points read so far. */
  get done(): number {
    return this.read;
  }

  /** Takes bytes and yields the complete batches. */
  *push(piece: Uint8Array): Generator<Columns> {
    const bytes = new Uint8Array(this.rest.length + piece.length);
    bytes.set(this.rest);
    bytes.set(piece, this.rest.length);
    this.rest = bytes;
    if (this.header === null && !this.takeHeader()) return;
    yield* this.batches(this.batch);
  }

  /** Yields the rows after the last complete batch; throws if the file is cut off. */
  *end(): Generator<Columns> {
    if (this.header === null) throw new Error("PLY: no header");
    yield* this.batches(1);
    if (this.read < this.header.count) throw new Error(`PLY: ${this.read} of ${this.header.count} points, then the file ends`);
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
      this.read += take;
    }
  }

  private rows(header: Header, count: number): Columns {
    const view = new DataView(this.rest.buffer, this.rest.byteOffset, count * header.rowBytes);
    const { rowBytes, columns } = header;
    const zero: Get = () => 0;
    const column = (name: string) => columns.get(name) ?? zero;
    const [x, y, z] = [column("x"), column("y"), column("z")];
    const [intensity, ring, time, sd] = [column("intensity"), column("ring"), column("time"), column("sd")];
    this.start_s ??= time(view, 0);
    const start_s = this.start_s;
    const out: Columns = {
      count,
      positions: new Float32Array(3 * count),
      times: new Float32Array(count),
      sds: new Float32Array(columns.has("sd") ? count : 0),
      intensities: new Uint8Array(count),
      rings: new Uint8Array(count),
    };
    for (let i = 0; i < count; i += 1) {
      const at = i * rowBytes;
      out.positions[3 * i] = x(view, at);
      out.positions[3 * i + 1] = y(view, at);
      out.positions[3 * i + 2] = z(view, at);
      out.times[i] = time(view, at) - start_s;
      out.intensities[i] = intensity(view, at);
      out.rings[i] = ring(view, at);
      if (out.sds.length > 0) out.sds[i] = sd(view, at);
    }
    return out;
  }
}
