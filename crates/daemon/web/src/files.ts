// The page of `velomotion view`: its files, and the progress of their clouds.

import { type Report, api } from "./api.ts";
import { h, id, show, text } from "./dom.ts";
import { compact } from "./format.ts";
import { alarm, announce } from "./panels/messages.ts";
import * as quality from "./panels/quality.ts";
import type { CloudSource, Viewer } from "./viewer.ts";

/** A file, as the program describes it. */
interface ViewFile {
  name: string;
  /** `making`: the cloud of a log, or another format is read. */
  state: "making" | "ready" | "failed";
  /** Part of the work that is done, if known. */
  share?: number | null;
  points?: number | null;
  simulated: boolean;
  /** Whether the origin is on the tilt axis. */
  scanner: boolean;
  /** Whether it is a log or recording, which plays. */
  log: boolean;
  /** What the replay of a log reports. */
  report?: Report | null;
  error?: string | null;
  help?: string | null;
}

const list = id<HTMLUListElement>("scans");
let files: ViewFile[] = [];
let current: string | null = null;
let viewer: Viewer | null = null;

export function start(view: Viewer | null): void {
  viewer = view;
  quality.wire(api.file_statistics);
  // It scrolls, and has little that takes the focus.
  const panels = document.querySelector<HTMLElement>(".panels");
  if (panels !== null) panels.tabIndex = 0;
  if (view !== null) {
    view.relinked = open_linked;
    view.turned = quality.turn;
  }
  text(id("scans-title"), "Files");
  show(id("no-scans"), false);
  show(id("scan-lists"), true);
  const events = new EventSource("events");
  events.onmessage = ({ data }: MessageEvent<string>) => {
    show(id("lost"), false);
    update(JSON.parse(data) as ViewFile[]);
  };
  events.onerror = () => {
    text(id("lost"), "velomotion view has ended: what is in view stays, other files cannot be opened.");
    show(id("lost"), true);
  };
}

export function setCurrent(shown: string | null): void {
  if (shown !== current) measured(shown);
  current = shown;
  for (const entry of list.children) {
    const { id } = (entry as HTMLElement).dataset;
    if (id === shown) entry.setAttribute("aria-current", "true");
    else entry.removeAttribute("aria-current");
    const compare = entry.querySelector<HTMLElement>("[data-role=compare]");
    if (compare !== null) show(compare, shown !== null && id !== shown);
  }
}

/** Offers the statistics of a log whose angles are known: the losses and residuals, and more on request. */
function measured(shown: string | null): void {
  const file = files[Number(shown ?? "none")];
  const { name = "", report = null, simulated = false } = file ?? {};
  quality.setScan(shown === null || report === null || file?.scanner !== true ? null : { id: shown, name, state: file.error ? "partial" : "whole", started_s: 0, simulated, report });
}

/** Files are named by their places, since names may repeat. */
const key = (place: number) => String(place);

function update(now: ViewFile[]): void {
  const before = files;
  files = now;
  // A card that is as before keeps the focus.
  const same = (file: ViewFile, place: number) => JSON.stringify(file) === JSON.stringify(before[place]);
  files.forEach((file, place) => {
    const known = list.children[place];
    if (known === undefined) list.append(card(file, place));
    else if (!same(file, place)) known.replaceWith(card(file, place));
  });
  setCurrent(current);
  const only = files.length === 1 ? files[0] : undefined;
  document.body.dataset["files"] = String(files.length);
  document.title = `${only?.name ?? `${files.length} files`} \u2013 velomotion`;
  files.forEach((file, place) => {
    if (file.state === before[place]?.state) return;
    if (file.state === "ready" && !file.error) announce(`${file.name}: the cloud is made`);
    else if (file.state === "ready") alarm(`${file.name}: ${file.error}`);
    if (file.state === "failed") alarm(`${file.name}: ${file.error ?? "failed"}`);
  });
  if (current === null || viewer?.linked_scans.scan != null) open_linked();
  if (current === null && viewer !== null) waiting(only ?? files.find((file) => file.state === "making") ?? files.findLast((file) => file.state === "failed"));
}

/** Opens the files that the page's address names, else the first one that is ready. */
function open_linked(): void {
  const { scan = null, other = null } = viewer?.linked_scans ?? {};
  const [named, second] = [scan, other].map((name) => (name === null ? undefined : files[Number(name)]));
  if (named?.state === "making" || second?.state === "making") return;
  const compared = second?.state === "ready" ? source(Number(other)) : null;
  if (scan !== null) {
    const found = named?.state === "ready";
    const lacks = !found || (other !== null && compared === null);
    if (lacks) text(id("scans-error"), "A file of the link is not here: links name files by their order in the command.");
    show(id("scans-error"), lacks);
    if (found) return open(Number(scan), compared);
    viewer?.forget_link();
    // What is in view stays.
    if (current !== null) return;
  }
  const first = files.findIndex((file) => file.state === "ready");
  if (first >= 0) open(first);
}

/** What is done before the first cloud can be shown. */
function waiting(file: ViewFile | undefined): void {
  if (file === undefined) return;
  const failed = file.state === "failed";
  text(id("view-title"), file.name);
  show(id("view-empty"), !failed);
  show(id("view-failed"), failed);
  const progress = id<HTMLProgressElement>("view-progress");
  show(progress, !failed);
  if (failed) return text(id("view-failed"), [file.error, file.help].filter(Boolean).join("\n"));
  if (typeof file.share === "number") progress.value = file.share;
  else progress.removeAttribute("value");
  const words = !file.log ? "Reading the cloud" : typeof file.share === "number" ? `Making the cloud: ${Math.round(100 * file.share)} %` : "Finding clock and angles";
  id("view-empty").replaceChildren(h("p", {}, words));
}

function source(place: number): CloudSource | null {
  const file = files[place];
  if (file === undefined) return null;
  const { simulated, scanner, log } = file;
  const title = file.error ? `${file.name}: ${file.error}` : file.name;
  return { id: key(place), title, simulated, partial: Boolean(file.error), url: () => `clouds/${place}.ply`, completes: false, scanner, plays: log };
}

function open(place: number, other: CloudSource | null = null): void {
  const opened = source(place);
  if (opened !== null) viewer?.open(opened, other);
}

function card(file: ViewFile, place: number): HTMLElement {
  const state = file.state === "ready" ? (typeof file.points === "number" ? `${compact(file.points)} points` : "") : file.state === "failed" ? "" : typeof file.share === "number" ? `${Math.round(100 * file.share)} %` : "waiting";
  return h("li", { class: "scan file", "data-id": key(place) },
    h("div", {},
      h("h3", { title: file.name }, file.name),
      h("p", {}, state, " ", file.simulated ? h("span", { class: "badge", "data-state": "simulated" }, "SIMULATED") : null)),
    file.error ? h("p", { class: "wrong" }, [file.error, file.help].filter(Boolean).join("\n")) : null,
    file.state === "ready" ? h("div", { class: "row" },
      h("button", { type: "button", "aria-label": `Open ${file.name} in the view`, click: () => open(place) }, "Open"),
      h("button", { type: "button", "data-role": "compare", "aria-label": `Compare the file in view with ${file.name}`, hidden: true, click: () => open(Number(current), source(place)) }, "Compare")) : null);
}
