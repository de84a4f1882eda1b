// Messages: short ones for screen readers, and a list. devices.ts shows current problems.

import { h, id } from "../dom.ts";

const MOST = 40;
/** Keeps the messages of this tab over a reload. */
const KEPT = "velomotion-messages";
type Message = { at: string; level: "info" | "warning" | "error"; full: string };
const list = id<HTMLOListElement>("messages");
const polite = id("announce");
const urgent = id("alarm");
const clock = new Intl.DateTimeFormat("en-GB", { hour: "2-digit", minute: "2-digit", second: "2-digit" });

const day = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short" });
/** The time, with the day unless it is today's. */
const words_of = (at: Date) => (at.toDateString() === new Date().toDateString() ? "" : `${day.format(at)}, `) + clock.format(at);

let timer = 0;
let kept: Message[] = [];

/** Shows the messages of before a reload. */
export function restore(): void {
  try {
    kept = JSON.parse(sessionStorage.getItem(KEPT) ?? "[]") as Message[];
    for (const message of kept) draw(message);
  } catch {
    kept = [];
  }
}

/** Forgets them: the next person at this tab may not read them. */
export function forget(): void {
  kept = [];
  sessionStorage.removeItem(KEPT);
}

function draw({ at, level, full }: Message): void {
  list.prepend(h("li", { "data-level": level }, h("time", { datetime: at }, words_of(new Date(at))), level === "info" ? null : `${level}: `, full));
  while (list.children.length > MOST) list.lastElementChild?.remove();
}

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
  const full = help ? `${text}\n${help}` : text;
  const message = { at: new Date().toISOString(), level, full };
  draw(message);
  kept = [...kept, message].slice(-MOST);
  try {
    sessionStorage.setItem(KEPT, JSON.stringify(kept));
  } catch {
    // Not in a private window.
  }
  if (level === "error") alarm(full);
}
