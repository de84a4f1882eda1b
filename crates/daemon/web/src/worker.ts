// Downloads and parses a scan's cloud in a worker, so that the page stays responsive.
//
// Batches are cut into parts of neighbouring points. Each part is shuffled, so that its first points are an even sample, which
// the moving view draws.

import type { Problem } from "./api.ts";
import { MOST_M, PointTree } from "./distance.ts";
import { COLUMNS, type Columns, placed } from "./frame.ts";
import { along_curve } from "./order.ts";
import { PlyReader } from "./ply.ts";
import { type Found, type Picked, type Position, nearer } from "./picked.ts";
import { type Ranges, Sample } from "./sample.ts";

export interface LoadRequest {
  url: string;
  /** Maximum number of points to keep; larger clouds are thinned evenly. */
  most: number;
  /** Address of a cloud from which the distances of the points are measured. */
  other?: string;
  /** Positions of picked points in the coordinates of the cloud, whose values are read anew. */
  picked: Position[];
}

/** The other cloud of a comparison. */
export interface Other {
  origin: Position;
  /** Every how manyth of its points is compared. */
  every: number;
}

export type LoadEvent =
  | { kind: "other"; parts: Columns[]; read: number; total: number }
  | { kind: "points"; parts: Columns[]; ranges: Ranges; origin: Position; read: number; total: number; every: number }
  | { kind: "done"; read: number; total: number; every: number; origin: Position; simulated: boolean; other: Other | null; beyond: number; picked: (Picked | null)[] }
  | { kind: "failed"; error: string };

const BATCH = 262_144;
/** Points of a part. */
const PART = 32_768;
/** Maximum number of points of the other cloud: their search takes 3 s to prepare. */
const MOST_OTHER = 3_000_000;

/** The worker's global scope, which the DOM types do not cover. */
const here = self as unknown as {
  onmessage: ((event: MessageEvent<LoadRequest>) => void) | null;
  postMessage(event: LoadEvent, transfer?: Transferable[]): void;
};

here.onmessage = (event) => {
  void load(event.data).catch((error: unknown) => {
    // What a browser says of a network that fails differs from one to the next.
    const lost = error instanceof TypeError || (error instanceof DOMException && error.name === "NetworkError");
    const reason = error instanceof Error ? error.message : String(error);
    here.postMessage({ kind: "failed", error: lost ? "the connection was lost while the cloud was loaded: open it again" : reason });
  });
};

async function load(order: LoadRequest): Promise<void> {
  const other = order.other === undefined ? null : await readOther(order.other);
  const sample = new Sample();
  let beyond = 0;
  const found = order.picked.map((): Found | null => null);
  const ply = await download(order.url, (columns, { count, done, origin }) => {
    const every = stride(count, order.most);
    if (other !== null) {
      const [x, y, z] = origin.map((m, axis) => m - (other.origin[axis] ?? 0)) as Position;
      columns.distances = other.tree.distances(columns.positions, [x, y, z]);
      for (const distance of columns.distances) if (distance >= MOST_M) beyond += 1;
    }
    order.picked.forEach((position, i) => {
      found[i] = nearer(columns, position.map((m, axis) => m - (origin[axis] ?? 0)) as Position, found[i] ?? null);
    });
    sample.add(columns);
    const ranges = sample.ranges();
    if (ranges === null) return;
    const parts = compact(columns, every);
    const transfer = parts.flatMap((part) => [part.positions, ...COLUMNS.map((name) => part[name])].map((array) => array.buffer));
    here.postMessage({ kind: "points", parts, ranges, origin, read: done + columns.count, total: count ?? 0, every }, transfer);
  });
  here.postMessage({
    kind: "done", read: ply.done, total: ply.count ?? 0, every: stride(ply.count, order.most), origin: ply.origin, simulated: ply.simulated, beyond,
    picked: found.map((one) => one?.picked ?? null),
    other: other === null ? null : { origin: other.origin, every: other.every },
  });
}

/** Downloads the other cloud of a comparison and prepares the search in it. */
async function readOther(url: string): Promise<Other & { tree: PointTree }> {
  const parts: Float32Array[] = [];
  const ply = await download(url, (columns, { count, done }) => {
    const compacted = compact(placed(columns.positions), stride(count, MOST_OTHER)).map((part) => placed(part.positions));
    parts.push(...compacted.map((part) => part.positions));
    here.postMessage({ kind: "other", parts: compacted, read: done + columns.count, total: count ?? 0 });
  });
  const all = new Float32Array(parts.reduce((sum, part) => sum + part.length, 0));
  let end = 0;
  for (const part of parts) {
    all.set(part, end);
    end += part.length;
  }
  return { tree: new PointTree(all), origin: ply.origin, every: stride(ply.count, MOST_OTHER) };
}

/** Every how manyth point is kept. */
const stride = (count: number | null, most: number) => Math.max(1, Math.ceil((count ?? 0) / most));

/** Downloads and parses a cloud, and passes its batches on. */
async function download(url: string, take: (columns: Columns, ply: PlyReader) => void): Promise<PlyReader> {
  const answer = await fetch(url, { credentials: "same-origin" });
  if (!answer.ok || answer.body === null) {
    const body = (await answer.json().catch(() => null)) as { error?: Problem } | null;
    const problem = body?.error;
    throw new Error([problem?.message ?? `the daemon answers ${answer.status}`, problem?.help].filter(Boolean).join(": "));
  }
  const ply = new PlyReader(BATCH);
  const reader = answer.body.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    for (const columns of ply.push(value)) take(columns, ply);
  }
  for (const columns of ply.end()) take(columns, ply);
  return ply;
}

/** Parts of neighbouring points with one of `every` so many, in random order. */
function compact(columns: Columns, every: number): Columns[] {
  const order = along_curve(columns.positions);
  const parts: Columns[] = [];
  for (let from = 0; from < order.length; from += PART * every) parts.push(shuffled(columns, order.subarray(from, from + PART * every), every));
  return parts;
}

/** One of `every` so many of the points in `order`, in a random order with a fixed seed. */
function shuffled(columns: Columns, order: Uint32Array, every: number): Columns {
  let seed = 0x9e3779b9;
  for (let i = order.length - 1; i > 0; i -= 1) {
    seed ^= seed << 13;
    seed ^= seed >>> 17;
    seed ^= seed << 5;
    const j = (seed >>> 0) % (i + 1);
    const other = order[j] ?? 0;
    order[j] = order[i] ?? 0;
    order[i] = other;
  }
  const keep = Math.ceil(order.length / every);
  const pick = <T extends Float32Array | Uint8Array>(from: T): T => {
    const to = new (from.constructor as new (n: number) => T)(from.length > 0 ? keep : 0);
    for (let i = 0; i < to.length; i += 1) to[i] = from[order[i] ?? 0] ?? 0;
    return to;
  };
  const positions = new Float32Array(3 * keep);
  for (let i = 0; i < keep; i += 1) {
    const from = 3 * (order[i] ?? 0);
    positions.set(columns.positions.subarray(from, from + 3), 3 * i);
  }
  const { times, sds, tilts, intensities, rings, lasers, echoes, distances } = columns;
  return {
    count: keep, positions, times: pick(times), sds: pick(sds), tilts: pick(tilts), intensities: pick(intensities), rings: pick(rings), lasers: pick(lasers), echoes: pick(echoes),
    distances: pick(distances),
  };
}
