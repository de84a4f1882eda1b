// Deleted scans that can still be restored: the daemon keeps them for 10 s.

import { type Scan, RequestError, api } from "../api.ts";
import { id, show, text } from "../dom.ts";
import { count } from "../format.ts";
import { title } from "../found.ts";
import { refused } from "./control.ts";
import { announce } from "./messages.ts";

const KEPT_MS = 10_000;

interface Deleted {
  scan: Scan;
  until_ms: number;
  /** Called when it is restored. */
  restored: () => void;
}

let deleted: Deleted[] = [];
let timer = 0;

id("undo-now").addEventListener("click", () => void undo());

/** Offers to restore a scan whose deletion was requested at `begun_ms`, and those deleted before it for longer. */
export function offer(scan: Scan, begun_ms: number, restored: () => void): void {
  const until_ms = begun_ms + KEPT_MS;
  for (const one of deleted) one.until_ms = until_ms;
  deleted.push({ scan, until_ms, restored });
  draw();
}

function draw(): void {
  clearTimeout(timer);
  const now_ms = performance.now();
  deleted = deleted.filter(({ until_ms }) => until_ms > now_ms);
  const [first] = deleted;
  const had_focus = document.activeElement === id("undo-now");
  show(id("undo"), first !== undefined);
  if (first === undefined) {
    if (had_focus) id("search").focus({ preventScroll: true });
    return;
  }
  text(id("undo-what"), `${deleted.length === 1 ? title(first.scan) : `${count(deleted.length)} scans`} deleted`);
  text(id("undo-left"), `${Math.ceil((first.until_ms - now_ms) / 1_000)} s`);
  timer = window.setTimeout(draw, 250);
}

/** Restores all that can be. The daemon reports each. */
async function undo(): Promise<void> {
  const list = deleted;
  deleted = [];
  draw();
  let restored = 0;
  for (const one of list) {
    try {
      await api.restore(one.scan.id);
      restored += 1;
      one.restored();
    } catch (error) {
      refused(`Undo: ${title(one.scan)}`, error, id("scans-error"));
      // It can be tried again, unless the daemon has it no more.
      if (!(error instanceof RequestError && error.status === 404)) deleted.push(one);
    }
  }
  draw();
  if (restored > 0) announce(`${restored === 1 ? "The scan is" : `${restored} scans are`} back`);
}
