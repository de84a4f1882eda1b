// Downloads and parses a scan's cloud in a worker, so that the page stays responsive.
//
// Each batch is shuffled, so that its first points are an even sample, which the moving view draws.

import type { Problem } from "./api.ts";
import { COLUMNS, type Columns } from "./frame.ts";
import { PlyReader } from "./ply.ts";
import { type Ranges, Sample } from "./sample.ts";

export interface LoadRequest {
  url: string;
  /** Maximum number of points to keep; larger clouds are thinned evenly. */
  most: number;
}

export type LoadEvent =
  | { kind: "points"; columns: Columns; ranges: Ranges; read: number; total: number; every: number }
  | { kind: "done"; read: number; total: number; every: number; origin: [number, number, number]; simulated: boolean }
  | { kind: "failed"; error: string; status: number };

const BATCH = 65_536;

/** The worker's global scope, which the DOM types do not cover. */
const here = self as unknown as {
  onmessage: ((event: MessageEvent<LoadRequest>) => void) | null;
  postMessage(event: LoadEvent, transfer?: Transferable[]): void;
};

here.onmessage = (event) => {
  void load(event.data).catch((error: unknown) => {
    here.postMessage({ kind: "failed", error: error instanceof Error ? error.message : String(error), status: 0 });
  });
};

async function load(order: LoadRequest): Promise<void> {
  const answer = await fetch(order.url, { credentials: "same-origin" });
  if (!answer.ok || answer.body === null) {
    const body = (await answer.json().catch(() => null)) as { error?: Problem } | null;
    const problem = body?.error;
    const error = [problem?.message ?? `the daemon answers ${answer.status}`, problem?.help].filter(Boolean).join(": ");
    here.postMessage({ kind: "failed", error, status: answer.status });
    return;
  }
  const ply = new PlyReader(BATCH);
  const sample = new Sample();
  const reader = answer.body.getReader();
  const deliver = (columns: Columns) => {
    const total = ply.count ?? 0;
    const every = Math.max(1, Math.ceil(total / order.most));
    const kept = shuffled(columns, Math.ceil(columns.count / every));
    sample.add(columns);
    const ranges = sample.ranges();
    if (ranges === null) return;
    const transfer = [kept.positions, ...COLUMNS.map((name) => kept[name])].map((array) => array.buffer);
    here.postMessage({ kind: "points", columns: kept, ranges, read: ply.done + columns.count, total, every }, transfer);
  };
  for (;;) {
    const { done, value } = await reader.read();
    if (done) break;
    for (const columns of ply.push(value)) deliver(columns);
  }
  for (const columns of ply.end()) deliver(columns);
  const total = ply.count ?? 0;
  here.postMessage({ kind: "done", read: ply.done, total, every: Math.max(1, Math.ceil(total / order.most)), origin: ply.origin, simulated: ply.simulated });
}

/** `keep` of the points in a random order, with a fixed seed. */
function shuffled(columns: Columns, keep: number): Columns {
  const { count } = columns;
  const order = new Uint32Array(count).map((_, i) => i);
  let seed = 0x9e3779b9;
  for (let i = count - 1; i > 0; i -= 1) {
    seed ^= seed << 13;
    seed ^= seed >>> 17;
    seed ^= seed << 5;
    const j = (seed >>> 0) % (i + 1);
    const other = order[j] ?? 0;
    order[j] = order[i] ?? 0;
    order[i] = other;
  }
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
  const { times, sds, tilts, intensities, rings, lasers, echoes } = columns;
  return {
    count: keep, positions, times: pick(times), sds: pick(sds), tilts: pick(tilts), intensities: pick(intensities), rings: pick(rings), lasers: pick(lasers), echoes: pick(echoes),
  };
}
