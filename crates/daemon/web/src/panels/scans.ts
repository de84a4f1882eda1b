// The list of scans: pictures, opening, downloads, deleting.

import { type Scan, api, cloudUrl, fileUrl, logUrl, thumbnailUrl } from "../api.ts";
import { h, id, show, text } from "../dom.ts";
import { bytes, compact, moment } from "../format.ts";
import { command, refused } from "./control.ts";
import { announce } from "./messages.ts";

/** Marks the choice of a format with the columns sd and echo. */
const MORE = "+";
/** Cloud formats: extension and displayed name. */
const FORMATS: [string, string][] = [
  ["ply", "PLY"], ["laz", "LAZ"], ["las", "LAS"], ["pcd", "PCD"], ["e57", "E57"], ["csv", "CSV"], ["mcap", "MCAP (ROS 2)"],
];
const STATES: Record<string, string> = { recording: "recording", making: "making the cloud", whole: "complete", partial: "partial", failed: "no cloud" };

const list = id<HTMLUListElement>("scans");
const scans = new Map<string, Scan>();
const updated = new Set<string>();
/** `wrong` shows errors of the scan; redrawing its card keeps them. */
const cards = new Map<string, { card: HTMLLIElement; wrong: HTMLElement; drawn: string }>();
let formats = FORMATS;
let current: string | null = null;
let opened: (scan: Scan) => void = () => {};

export function wire(open: (scan: Scan) => void): void {
  opened = open;
}

/** Offers the formats that the daemon supports. */
export function setFormats(known: string[]): void {
  const names = new Map(FORMATS);
  formats = known.map((format) => [format, names.get(format) ?? format.toUpperCase()]);
}

export const all = () => [...scans.values()].sort((a, b) => b.started_s - a.started_s);
export const get = (name: string) => scans.get(name);

/** Loads the list. Events received while it was loading are newer than the list. */
export async function load(list: () => Promise<Scan[]>): Promise<void> {
  updated.clear();
  const now = await list();
  for (const key of [...scans.keys()]) if (!updated.has(key)) scans.delete(key);
  for (const scan of now) if (!updated.has(scan.id)) scans.set(scan.id, scan);
  draw();
}

export function set(scan: Scan): void {
  updated.add(scan.id);
  scans.set(scan.id, { ...scans.get(scan.id), ...scan });
  draw();
}

export function remove(name: string): void {
  updated.add(name);
  scans.delete(name);
  draw();
}

/** Marks the scan that is in view. */
export function setCurrent(name: string | null): void {
  current = name;
  for (const [key, { card }] of cards) {
    if (key === name) card.setAttribute("aria-current", "true");
    else card.removeAttribute("aria-current");
  }
}

function draw(): void {
  const now = all();
  for (const [key, { card }] of cards) {
    if (!scans.has(key)) {
      card.remove();
      cards.delete(key);
    }
  }
  now.forEach((scan, place) => {
    const { report: _report, ...shown } = scan;
    const drawn = JSON.stringify(shown);
    let entry = cards.get(scan.id);
    if (entry === undefined) {
      entry = { card: h("li", { class: "scan", "data-id": scan.id }), wrong: h("p", { class: "wrong", hidden: true }), drawn: "" };
      cards.set(scan.id, entry);
    }
    if (entry.drawn !== drawn) {
      const focused = entry.card.contains(document.activeElement) ? (document.activeElement as HTMLElement).dataset["role"] : undefined;
      entry.card.replaceChildren(...content_or_id(scan), entry.wrong);
      entry.drawn = drawn;
      if (focused !== undefined) entry.card.querySelector<HTMLElement>(`[data-role="${focused}"]`)?.focus();
    }
    if (list.children[place] !== entry.card) list.insertBefore(entry.card, list.children[place] ?? null);
  });
  setCurrent(current);
  show(id("no-scans"), now.length === 0);
  const sum = now.reduce((total, scan) => total + (scan.bytes ?? 0), 0);
  text(id("scans-sum"), now.length === 0 ? "" : `${now.length === 1 ? "1 scan" : `${now.length} scans`} \u00b7 ${bytes(sum)}`);
}

/** One record that cannot be displayed does not hide the others. */
function content_or_id(scan: Scan): Node[] {
  try {
    return content(scan);
  } catch (error) {
    console.error(error);
    return [h("h3", {}, String(scan.id)), h("p", { class: "why" }, "This record cannot be displayed.")];
  }
}

function content(scan: Scan): Node[] {
  const title = scan.name || scan.id;
  const has_cloud = scan.state === "whole" || scan.state === "partial";
  const busy = scan.state === "recording" || scan.state === "making";
  const picture = scan.thumbnail
    ? h("img", { class: "thumb", src: thumbnailUrl(scan.id), alt: `Picture of ${title}`, loading: "lazy", width: 108, height: 72 })
    : h("span", { class: "thumb" });
  const numbers = [
    scan.points ? `${compact(scan.points)} points` : null,
    scan.bytes && !busy ? bytes(scan.bytes) : null,
  ].filter((part) => part !== null).join(" \u00b7 ");
  const speed = scan.asked?.speed_deg_s;
  const row = h("div", { class: "row" },
    has_cloud ? h("button", { type: "button", "data-role": "open", "aria-label": `Open ${title} in the view`, click: () => opened(scan) }, "Open") : null,
    busy ? null : downloads(scan, title, has_cloud),
    busy ? null : h("button", { type: "button", "data-role": "delete", "aria-label": `Delete ${title}`, click: () => void confirm_delete(scan) }, "Delete"),
  );
  return [
    picture,
    h("div", {},
      h("h3", { title }, title),
      h("p", {}, moment(scan.started_s), typeof speed === "number" ? ` \u00b7 ${speed} \u00b0/s` : null),
      h("p", {}, numbers),
      h("p", { class: "badges" }, h("span", { class: "badge", "data-state": scan.state }, scan.waits_for_room ? "no cloud yet" : (STATES[scan.state] ?? scan.state)), " ",
        scan.simulated ? h("span", { class: "badge", "data-state": "simulated" }, "SIMULATED") : null),
    ),
    ...(scan.summary ? [h("p", { class: "why", tabindex: 0 }, scan.summary)] : []),
    row,
  ];
}

/** A list of formats; choosing one downloads it. */
function downloads(scan: Scan, title: string, has_cloud: boolean): HTMLElement {
  const choose = h("select", { "data-role": "download", "aria-label": `Download ${title} as` }, h("option", { value: "" }, "Download"),
    ...(has_cloud ? formats.map(([format, words]) => h("option", { value: format }, words)) : []),
    h("option", { value: "log" }, "log (pcapng)"),
    has_cloud ? h("optgroup", { label: "With uncertainty and echo" }, ...formats.map(([format, words]) => h("option", { value: `${format}${MORE}` }, words))) : null);
  choose.addEventListener("change", () => {
    const format = choose.value;
    choose.value = "";
    if (format === "") return;
    void download(scan, title, format);
  });
  return choose;
}

/** Downloads a file; a refusal is shown at its scan. */
async function download(scan: Scan, title: string, choice: string): Promise<void> {
  const more = choice.endsWith(MORE);
  const format = choice.replace(MORE, "");
  const at = error_of(scan);
  show(at, false);
  announce(`Downloading ${title} as ${format}`);
  try {
    const [url, exists] = format === "log" ? [logUrl(scan.id), true] : [cloudUrl(scan.id, format, more, more), format === "ply" && !more];
    const href = await fileUrl(url, exists);
    h("a", { href, download: `${scan.id}.${format === "log" ? "pcapng" : format}` }).click();
    // The browser has begun to read it by then.
    if (!exists) setTimeout(() => URL.revokeObjectURL(href), 60_000);
  } catch (error) {
    refused(`Download as ${format}`, error, at);
  }
}

/** Where errors of a scan are shown. */
function error_of(scan: Scan): HTMLElement {
  return cards.get(scan.id)?.wrong ?? id("scans-error");
}

async function confirm_delete(scan: Scan): Promise<void> {
  const dialog = id<HTMLDialogElement>("delete");
  text(id("delete-what"), scan.name ? `${scan.name} (${scan.id})` : scan.id);
  dialog.returnValue = "";
  const before = document.activeElement;
  // Not modal: the stop button must remain usable.
  dialog.show();
  const escape = (event: KeyboardEvent) => {
    if (event.key === "Escape") dialog.close("keep");
  };
  dialog.addEventListener("keydown", escape);
  await new Promise((resolve) => dialog.addEventListener("close", resolve, { once: true }));
  dialog.removeEventListener("keydown", escape);
  if (before instanceof HTMLElement) before.focus();
  if (dialog.returnValue !== "delete") return;
  await command("Delete", async () => {
    await api.remove(scan.id);
    remove(scan.id);
    announce("Deleted");
    id("scans-title").scrollIntoView({ block: "nearest" });
  }, error_of(scan));
}
