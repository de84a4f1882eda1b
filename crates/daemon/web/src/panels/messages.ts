// What is said: to screen readers in few words, and in a list that stays. Left out: standing problems (devices.ts).

import { h, id } from "../dom.ts";

const MOST = 40;
const list = id<HTMLOListElement>("said");
const polite = id("announce");
const urgent = id("alarm");
const clock = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit", second: "2-digit" });

let timer = 0;

/** For the ear alone, after a short pause: of several in a row the last counts. */
export function announce(words: string): void {
  clearTimeout(timer);
  timer = window.setTimeout(() => {
    polite.textContent = words;
  }, 400);
}

/** For the ear, at once. */
export function alarm(words: string): void {
  urgent.textContent = words;
}

/** For the list; errors are spoken too. */
export function note(level: "info" | "warning" | "error", text: string, help?: string | null): void {
  const now = new Date();
  const whole = help ? `${text}\n${help}` : text;
  const item = h("li", { "data-level": level }, h("time", { datetime: now.toISOString() }, clock.format(now)), level === "info" ? null : `${level}: `, whole);
  list.prepend(item);
  while (list.children.length > MOST) list.lastElementChild?.remove();
  if (level === "error") alarm(whole);
}
