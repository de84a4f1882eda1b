// A long list of which only the rows in sight, the first one and the one with the focus are in the document.

import { attribute } from "./dom.ts";

/** Rows this far out of sight are drawn too: scrolling and the Tab key find them there. */
const MARGIN_PX = 300;

export interface RowsOf<T> {
  tag: "li" | "div";
  /** What scrolls, unless the page does. */
  scroller: HTMLElement;
  /** Whether the rows are side by side; else they are one below the other. */
  across: () => boolean;
  /** Size along the list until a row is measured, and the gap between two. */
  usual_px: number;
  gap_px: number;
  key: (item: T) => string;
  /** What a row shows: it is drawn again when this changes. */
  state: (item: T) => string;
  draw: (item: T, row: HTMLElement) => void;
}

export class Rows<T> {
  /** Null until the first list: the element may be another's. */
  private items: readonly T[] | null = null;
  private starts: number[] = [];
  private sizes = new Map<string, number>();
  private readonly drawn = new Map<string, { row: HTMLElement; state: string }>();
  private across = false;
  private frame = 0;
  private readonly resized = new ResizeObserver(() => this.later());

  constructor(private readonly list: HTMLElement, private readonly of: RowsOf<T>) {
    for (const event of ["scroll", "resize"]) addEventListener(event, () => this.later(), { capture: true, passive: true });
    this.resized.observe(of.scroller);
  }

  set(items: readonly T[]): void {
    this.items = items;
    const known = new Set(items.map(this.of.key));
    for (const key of this.sizes.keys()) if (!known.has(key)) this.sizes.delete(key);
    this.update();
  }

  /** Draws what is in sight and has changed. */
  update(): void {
    cancelAnimationFrame(this.frame);
    this.frame = 0;
    const { items } = this;
    if (items === null) return;
    // Hidden on this screen.
    if (this.of.scroller.offsetParent === null) return this.remove(() => true);
    if (this.across !== this.of.across()) {
      this.across = !this.across;
      this.sizes.clear();
    }
    const focused = document.activeElement;
    const role = focused instanceof HTMLElement && this.list.contains(focused) ? focused.dataset["role"] : undefined;
    const owner = this.focused();
    // Measured sizes move other rows into sight.
    for (let pass = 0; pass < 4; pass += 1) {
      this.place(items);
      if (!this.measure(items)) break;
    }
    // A row that was moved or drawn again has lost the focus.
    if (owner === null || document.activeElement === focused) return;
    const row = this.drawn.get(owner)?.row;
    const again = focused instanceof HTMLElement && row?.contains(focused) ? focused : row?.querySelector<HTMLElement>(`[data-role="${role}"]`);
    again?.focus({ preventScroll: true });
  }

  /** Scrolls to an item. */
  reveal(name: string): void {
    const { items } = this;
    const i = items?.findIndex((item) => this.of.key(item) === name) ?? -1;
    const { scroller } = this.of;
    if (items === null || i < 0 || scroller.offsetParent === null) return;
    const [start, size] = [this.starts[i] ?? 0, this.size(items[i] as T)];
    const [low, high] = this.sight();
    if (start >= low && start + size <= high) return;
    if (this.across) scroller.scrollLeft += start - low;
    else if (scroller.scrollHeight > scroller.clientHeight) scroller.scrollTop += start - low;
  }

  private later(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame(() => this.update());
  }

  private size(item: T): number {
    return this.sizes.get(this.of.key(item)) ?? this.of.usual_px;
  }

  /** The part of the list that is in sight, pixels from its start. */
  private sight(): [number, number] {
    const list = this.list.getBoundingClientRect();
    const clip = this.of.scroller.getBoundingClientRect();
    return this.across
      ? [Math.max(clip.left, 0) - list.left, Math.min(clip.right, innerWidth) - list.left]
      : [Math.max(clip.top, 0) - list.top, Math.min(clip.bottom, innerHeight) - list.top];
  }

  /** Key of the row with the focus. */
  private focused(): string | null {
    for (const [key, { row }] of this.drawn) if (row.contains(document.activeElement)) return key;
    return null;
  }

  private place(items: readonly T[]): void {
    const { key, gap_px } = this.of;
    let end = 0;
    this.starts = items.map((item) => {
      const start = end;
      end += this.size(item) + gap_px;
      return start;
    });
    const [along, other] = this.across ? (["width", "height"] as const) : (["height", "width"] as const);
    this.list.style[along] = `${Math.max(0, end - gap_px)}px`;
    this.list.style[other] = "";
    const [low, high] = this.sight();
    const focused = this.focused();
    const wanted = new Map<string, number>();
    items.forEach((item, i) => {
      const start = this.starts[i] ?? 0;
      const near = start + this.size(item) > low - MARGIN_PX && start < high + MARGIN_PX;
      if (near || i === 0 || key(item) === focused) wanted.set(key(item), i);
    });
    this.remove((name) => !wanted.has(name));
    let before: Element | null = this.list.firstElementChild;
    for (const [name, i] of wanted) {
      const row = this.row(name, i, items);
      if (row === before) before = row.nextElementSibling;
      else this.list.insertBefore(row, before);
    }
  }

  /** The row of an item, with its present content and place. */
  private row(name: string, i: number, items: readonly T[]): HTMLElement {
    const item = items[i] as T;
    let entry = this.drawn.get(name);
    if (entry === undefined) {
      entry = { row: document.createElement(this.of.tag), state: "" };
      this.drawn.set(name, entry);
      this.resized.observe(entry.row);
    }
    const { row } = entry;
    const state = this.of.state(item);
    if (entry.state !== state) {
      entry.state = state;
      this.of.draw(item, row);
    }
    if (this.of.tag === "li") {
      attribute(row, "aria-setsize", String(items.length));
      attribute(row, "aria-posinset", String(i + 1));
      // The first row of a table is its head.
    } else attribute(row, "aria-rowindex", String(i + 2));
    const start = `${this.starts[i]}px`;
    row.style.left = this.across ? start : "";
    row.style.top = this.across ? "" : start;
    return row;
  }

  private remove(unwanted: (name: string) => boolean): void {
    for (const [name, { row }] of this.drawn) {
      if (!unwanted(name)) continue;
      this.resized.unobserve(row);
      row.remove();
      this.drawn.delete(name);
    }
  }

  /** Whether a row has another size than assumed. What is in sight stays where it is. */
  private measure(items: readonly T[]): boolean {
    const [low] = this.sight();
    let changed = false;
    let above_px = 0;
    items.forEach((item, i) => {
      const name = this.of.key(item);
      const row = this.drawn.get(name)?.row;
      if (row === undefined) return;
      const px = this.across ? row.offsetWidth : row.offsetHeight;
      const more_px = px - this.size(item);
      this.sizes.set(name, px);
      if (more_px === 0) return;
      changed = true;
      if ((this.starts[i] ?? 0) + px < low) above_px += more_px;
    });
    if (above_px !== 0 && !this.across) {
      const { scroller } = this.of;
      if (scroller.scrollHeight > scroller.clientHeight) scroller.scrollTop += above_px;
      else scrollBy({ top: above_px, behavior: "instant" });
    }
    return changed;
  }
}
