// Messages: short ones for screen readers, and a list. devices.ts shows current problems.

import { h, id } from "../dom.ts";

const MOST = 40;
const list = id<HTMLOListElement>("messages");
const polite = id("announce");
const urgent = id("alarm");
const clock = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit", second: "2-digit" });

let timer = 0;

/** Announces to screen readers after a short pause; the latest text wins. */
export function announce(words: string): void {
  clearTimeout(timer);
  timer = window.setTimeout(() => {
    polite.textContent = words;
  }, 400);
}

/** Announces to screen readers at once. */
export function alarm(words: string): void {
  urgent.textContent = words;
}

/** Adds a message to the list; errors are announced too. */
export function note(level: "info" | "warning" | "error", text: string, help?: string | null): void {
  const now = new Date();
  const full = help ? `${text}\n${help}` : text;
  const item = h("li", { "data-level": level }, h("time", { datetime: now.toISOString() }, clock.format(now)), level === "info" ? null : `${level}: `, full);
  list.prepend(item);
  while (list.children.length > MOST) list.lastElementChild?.remove();
  if (level === "error") alarm(full);
}
