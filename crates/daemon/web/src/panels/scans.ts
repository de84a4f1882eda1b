// The scans: as cards and in a table, found, sorted, selected, edited and deleted.

import { type Scan, RequestError, api } from "../api.ts";
import { attribute, h, id, show, text } from "../dom.ts";
import { bytes, count } from "../format.ts";
import { type Order, type SortKey, found, title } from "../found.ts";
import { Rows } from "../rows.ts";
import { refused } from "./control.ts";
import { announce } from "./messages.ts";
import * as parts from "./scan_parts.ts";
import { offer } from "./undo.ts";

/** Scans that are requested at once. */
const PART = 100;
const narrow = matchMedia("(max-width: 899px)");
const search = id<HTMLInputElement>("search");
const sorting = id<HTMLSelectElement>("order");
const choose_all = id<HTMLInputElement>("choose-all");

const scans = new Map<string, Scan>();
const updated = new Set<string>();
/** Errors of a scan, which outlive its card. */
const errors = new Map<string, HTMLElement>();
/** The selected ones, of those that are shown. */
const chosen = new Set<string>();
let shown: Scan[] = [];
let order: Order = { by: "time", down: true };
let current: string | null = null;
let last_chosen: string | null = null;
/** The fields of the scans that are edited, by place and id. They keep what is typed while they are out of sight. */
const editors = new Map<string, HTMLElement | null>();
let loads = 0;
let opened: (scan: Scan) => void = () => {};
let compared: (newer: Scan, older: Scan) => void = () => {};

type Place = "card" | "row";

/** One record that cannot be displayed does not hide the others. */
function content(scan: Scan, place: Place): Node[] {
  try {
    const actions = { open: opened, edit: () => edit(scan, place), choose, remove: (one: Scan) => void remove_all([one]), refused: show_error };
    const key = `${place} ${scan.id}`;
    if (editors.has(key)) {
      const editor = editors.get(key) ?? parts.editor(scan, (changed) => edited(scan, place, changed), actions);
      editors.set(key, editor);
      return [place === "card" ? editor : h("div", { role: "cell", class: "edit-cell" }, editor)];
    }
    const marked = chosen.has(scan.id);
    return place === "card" ? parts.card(scan, marked, error_of(scan), actions) : parts.cells(scan, marked, id("scans-error"), actions);
  } catch (error) {
    console.error(error);
    return [h("h3", {}, String(scan.id)), h("p", {}, "This record cannot be displayed.")];
  }
}

/** A list of all scans in one of both forms. */
function rows(list: string, place: Place, of: { scroller: string; across: () => boolean; usual_px: number; gap_px: number }): Rows<Scan> {
  return new Rows<Scan>(id(list), {
    ...of,
    tag: place === "card" ? "li" : "div",
    scroller: id(of.scroller),
    key: (scan) => scan.id,
    state: (scan) => {
      // Fields keep what is typed.
      if (editors.has(`${place} ${scan.id}`)) return "edited";
      const { report: _report, ...rest } = scan;
      return JSON.stringify([rest, scan.id === current, chosen.has(scan.id)]);
    },
    draw: (scan, row) => {
      row.className = place === "card" ? "scan" : "scan-row";
      row.dataset["id"] = scan.id;
      if (place === "row") row.setAttribute("role", "row");
      if (scan.id === current) row.setAttribute("aria-current", "true");
      else row.removeAttribute("aria-current");
      row.replaceChildren(...content(scan, place));
    },
  });
}

const strip = rows("scans", "card", { scroller: "strip", across: () => !narrow.matches, usual_px: 330, gap_px: 12 });
const table = rows("scan-rows", "row", { scroller: "scan-rows-scroller", across: () => false, usual_px: 40, gap_px: 0 });

export function wire(open: (scan: Scan) => void, compare: (newer: Scan, older: Scan) => void): void {
  [opened, compared] = [open, compare];
  search.addEventListener("input", draw);
  sorting.addEventListener("change", () => {
    const [by, down] = sorting.value.split(" ");
    sort({ by: by as SortKey, down: down === "down" });
  });
  for (const head of document.querySelectorAll<HTMLElement>("#scan-table [data-sort]")) {
    const by = head.dataset["sort"] as SortKey;
    head.addEventListener("click", () => sort({ by, down: order.by === by ? !order.down : by !== "name" }));
  }
  choose_all.addEventListener("change", () => {
    chosen.clear();
    if (choose_all.checked) for (const scan of shown) if (!parts.isBusy(scan)) chosen.add(scan.id);
    draw();
  });
  id("compare").addEventListener("click", () => {
    const [newer, older] = pair();
    if (newer !== undefined && older !== undefined) compared(newer, older);
  });
  id("delete-chosen").addEventListener("click", () => void remove_all(shown.filter((scan) => chosen.has(scan.id))));
  narrow.addEventListener("change", draw);
}

export const all = () => found(scans.values(), "", { by: "time", down: true });
export const get = (name: string) => scans.get(name);

/** Loads the list in parts, and reports each. Events received meanwhile are newer than the list. */
export async function load(loaded: (complete: boolean) => void): Promise<void> {
  const mine = ++loads;
  updated.clear();
  const listed: string[] = [];
  for (let complete = false; !complete; ) {
    const before = listed.findLast((name) => scans.has(name)) ?? null;
    let part: Scan[];
    try {
      part = await api.scans(PART, before);
    } catch (error) {
      if (before === null || !(error instanceof RequestError) || error.status !== 404) throw error;
      // It was deleted meanwhile: the one before it is asked for.
      forget(before);
      continue;
    }
    if (mine !== loads) return;
    for (const scan of part) {
      listed.push(scan.id);
      if (!updated.has(scan.id)) scans.set(scan.id, scan);
    }
    complete = part.length < PART;
    if (complete) {
      const known = new Set(listed);
      for (const key of [...scans.keys()]) if (!known.has(key) && !updated.has(key)) forget(key);
    }
    draw();
    loaded(complete);
  }
}

export function set(scan: Scan): void {
  updated.add(scan.id);
  scans.set(scan.id, { ...scans.get(scan.id), ...scan });
  draw();
}

export function remove(name: string): void {
  updated.add(name);
  forget(name);
  draw();
}

function forget(name: string): void {
  scans.delete(name);
  errors.delete(name);
  for (const place of ["card", "row"]) editors.delete(`${place} ${name}`);
}

/** Marks the scan that is in view. */
export function setCurrent(name: string | null): void {
  current = name;
  strip.update();
  table.update();
  if (name === null) return;
  strip.reveal(name);
  table.reveal(name);
}

function sort(now: Order): void {
  order = now;
  draw();
}

function draw(): void {
  shown = found(scans.values(), search.value, order);
  const found_ids = new Set(shown.map((scan) => scan.id));
  for (const name of chosen) if (!found_ids.has(name)) chosen.delete(name);
  // Hidden lists draw no rows.
  for (const name of ["scan-find", "scan-lists"]) show(id(name), scans.size > 0);
  strip.set(shown);
  table.set(shown);
  attribute(id("scan-table"), "aria-rowcount", String(shown.length + 1));
  sorting.value = `${order.by} ${order.down ? "down" : "up"}`;
  for (const head of document.querySelectorAll<HTMLElement>("#scan-table [data-sort]")) {
    const sorted = head.dataset["sort"] !== order.by ? "none" : order.down ? "descending" : "ascending";
    attribute(head.parentElement ?? head, "aria-sort", sorted);
  }
  const sum = shown.reduce((total, scan) => total + (scan.bytes ?? 0), 0);
  const number = (n: number) => (n === 1 ? "1 scan" : `${count(n)} scans`);
  text(id("scans-sum"), scans.size === 0 ? "" : search.value === "" ? `${number(scans.size)} \u00b7 ${bytes(sum)}` : `${count(shown.length)} of ${number(scans.size)} \u00b7 ${bytes(sum)}`);
  text(id("no-scans"), scans.size === 0 ? "None yet." : "No scan has these words.");
  show(id("no-scans"), shown.length === 0);
  const can = shown.filter((scan) => !parts.isBusy(scan)).length;
  choose_all.disabled = can === 0;
  choose_all.checked = can > 0 && chosen.size === can;
  choose_all.indeterminate = chosen.size > 0 && chosen.size < can;
  text(id("chosen"), chosen.size === 0 ? "Select all" : `${count(chosen.size)} selected`);
  text(id("delete-chosen"), `Delete ${count(chosen.size)}`);
  show(id("delete-chosen"), chosen.size > 0);
  show(id("compare"), pair().length === 2);
}

/** The selected scans, the newer first, if they are two with clouds. */
function pair(): Scan[] {
  const list = chosen.size === 2 ? shown.filter((scan) => chosen.has(scan.id) && parts.hasCloud(scan)) : [];
  return list.length === 2 ? list.sort((a, b) => b.started_s - a.started_s) : [];
}

/** Selects a scan, or with the shift key all from the last one to it. */
function choose(scan: Scan, on: boolean, range: boolean): void {
  const place = (name: string | null) => shown.findIndex((one) => one.id === name);
  const last = place(last_chosen);
  // The last one chosen may be deleted or no longer found.
  const [from, to] = [range && last >= 0 ? last : place(scan.id), place(scan.id)].sort((a, b) => a - b);
  for (const one of shown.slice(from, (to ?? 0) + 1)) {
    if (on && !parts.isBusy(one)) chosen.add(one.id);
    else chosen.delete(one.id);
  }
  last_chosen = scan.id;
  draw();
}

const root = (place: Place) => id(place === "card" ? "scans" : "scan-rows");

function edit(scan: Scan, place: Place): void {
  editors.set(`${place} ${scan.id}`, null);
  draw();
  root(place).querySelector<HTMLElement>(`[data-id="${CSS.escape(scan.id)}"] .edit [data-role=name]`)?.focus();
}

function edited(scan: Scan, place: Place, changed: Scan | null): void {
  editors.delete(`${place} ${scan.id}`);
  if (changed === null) draw();
  else set(changed);
  root(place).querySelector<HTMLElement>(`[data-id="${CSS.escape(scan.id)}"] [data-role=edit]`)?.focus();
}

/** Where errors of a scan are shown. */
function error_of(scan: Scan): HTMLElement {
  let wrong = errors.get(scan.id);
  if (wrong === undefined) {
    // A long one scrolls, by the keyboard too.
    wrong = h("p", { class: "wrong", hidden: true, tabindex: 0 });
    errors.set(scan.id, wrong);
  }
  return wrong;
}

/** Shows an error, which makes its card higher, in sight. */
function show_error(what: string, error: unknown, at: HTMLElement): void {
  refused(what, error, at);
  strip.update();
  table.update();
  at.scrollIntoView({ block: "nearest" });
}

/** Deletes scans, and offers to undo it. The first refusal ends it. */
async function remove_all(list: Scan[]): Promise<void> {
  const only = list.length === 1 ? list[0] : undefined;
  const at = only === undefined ? id("scans-error") : error_of(only);
  show(at, false);
  const focused = document.activeElement;
  const gone: Scan[] = [];
  for (const scan of list) {
    const in_view = current === scan.id;
    const begun_ms = performance.now();
    try {
      await api.remove(scan.id);
    } catch (error) {
      show_error(only === undefined ? `Delete ${title(scan)}` : "Delete", error, at);
      break;
    }
    gone.push(scan);
    offer(scan, begun_ms, () => {
      if (in_view) opened(scan);
    });
    updated.add(scan.id);
    scans.delete(scan.id);
  }
  draw();
  if (gone.length === 0) return;
  announce(`${gone.length === 1 ? title(gone[0] as Scan) : `${gone.length} scans`} deleted; can be undone for 10 s`);
  // The button that was pressed is gone or hidden.
  if (!(focused instanceof HTMLElement) || !focused.isConnected || !focused.checkVisibility()) id("undo-now").focus();
}
