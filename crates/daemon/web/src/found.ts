// Search and order of the scans.

import type { Scan } from "./api.ts";

export type SortKey = "time" | "name" | "duration" | "points";

export interface Order {
  by: SortKey;
  /** The newest, last, longest or largest first. */
  down: boolean;
}

export const title = (scan: Scan): string => scan.name || scan.id;

const names = new Intl.Collator("en", { numeric: true, sensitivity: "base" });
const VALUES: Record<SortKey, (scan: Scan) => number | string | null> = {
  time: (scan) => scan.started_s,
  name: title,
  duration: (scan) => scan.duration_s ?? null,
  points: (scan) => scan.points ?? null,
};

/** Without accents and capitals. */
const plain = (text: string) => text.normalize("NFKD").replace(/\p{M}/gu, "").toLowerCase();

/** The scans with all words in name, id or notes, in order. Those without the value come last. */
export function found(scans: Iterable<Scan>, words: string, { by, down }: Order): Scan[] {
  const parts = plain(words).split(/\s+/).filter(Boolean);
  const list = [...scans].filter((scan) => {
    if (parts.length === 0) return true;
    const text = plain(`${scan.name ?? ""} ${scan.id} ${scan.notes ?? ""}`);
    return parts.every((part) => text.includes(part));
  });
  const value = VALUES[by];
  return list.sort((a, b) => {
    const [left, right] = [value(a), value(b)];
    const newest = b.started_s - a.started_s;
    if (left === null || right === null) return Number(left === null) - Number(right === null) || newest;
    const rising = typeof left === "string" ? names.compare(left, String(right)) : left - Number(right);
    return (down ? -rising : rising) || newest;
  });
}
