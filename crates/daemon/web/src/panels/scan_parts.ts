// What is shown of a scan: its card, its row in the table, the fields that edit it, and its texts whole.

import { type Scan, api, cloudUrl, fileUrl, logUrl, madeUrl, thumbnailUrl } from "../api.ts";
import { h, id, show, text } from "../dom.ts";
import { bytes, compact, duration, moment } from "../format.ts";
import { title } from "../found.ts";
import { announce } from "./messages.ts";

/** Marks the choice of a format with the columns sd, echo and laser. */
const MORE = "+";
/** Cloud formats: extension and displayed name. */
const FORMATS: [string, string][] = [
  ["ply", "PLY"], ["laz", "LAZ"], ["las", "LAS"], ["pcd", "PCD"], ["e57", "E57"], ["csv", "CSV"], ["npz", "NPZ (numpy)"], ["mcap", "MCAP (ROS 2)"],
];
const STATES: Record<string, string> = { recording: "recording", making: "making the cloud", whole: "complete", partial: "partial", failed: "no cloud" };
let formats = FORMATS;

/** Offers the formats that the daemon supports. */
export function setFormats(known: string[]): void {
  const names = new Map(FORMATS);
  formats = known.map((format) => [format, names.get(format) ?? format.toUpperCase()]);
}

/** What the buttons of a scan do. */
export interface Actions {
  open: (scan: Scan) => void;
  edit: (scan: Scan) => void;
  choose: (scan: Scan, on: boolean, range: boolean) => void;
  remove: (scan: Scan) => void;
  /** Shows an error at its scan. */
  refused: (what: string, error: unknown, at: HTMLElement) => void;
}

export const hasCloud = ({ state }: Scan) => state === "whole" || state === "partial";
export const isBusy = ({ state }: Scan) => state === "recording" || state === "making";

function button(role: string, words: string, label: string, click: () => void): HTMLElement {
  return h("button", { type: "button", "data-role": role, "aria-label": label, click }, words);
}

function chooser(scan: Scan, chosen: boolean, { choose }: Actions): HTMLElement {
  const click = (event: Event) => choose(scan, (event.target as HTMLInputElement).checked, (event as MouseEvent).shiftKey);
  return h("label", { class: "choose" }, h("input", { type: "checkbox", "data-role": "choose", "aria-label": `Select ${title(scan)}`, checked: chosen, disabled: isBusy(scan), click }));
}

/** Shows the cloud, or of a running scan the points from now on. */
function opener(scan: Scan, { open }: Actions): HTMLElement | null {
  const name = title(scan);
  if (scan.state === "recording") return button("open", "Live", `Show the live points of ${name}`, () => open(scan));
  return hasCloud(scan) ? button("open", "Open", `Open ${name} in the view`, () => open(scan)) : null;
}

function badge(scan: Scan): HTMLElement {
  return h("span", { class: "badge", "data-state": scan.state }, scan.waits_for_room ? "no cloud yet" : (STATES[scan.state] ?? scan.state));
}

/** A text of a scan; a card may cut it, and a click shows it whole. */
function cut(scan: Scan, kind: "why" | "notes", words: string): HTMLElement {
  return h("button", { type: "button", class: kind, "data-role": kind, title: "Show all of it", click: () => about(scan) }, words);
}

export function card(scan: Scan, chosen: boolean, wrong: HTMLElement, actions: Actions): Node[] {
  const name = title(scan);
  const picture = scan.thumbnail
    ? h("img", { class: "thumb", src: thumbnailUrl(scan.id), alt: `Picture of ${name}`, loading: "lazy", width: 108, height: 72 })
    : h("span", { class: "thumb" });
  const speed = scan.asked?.speed_deg_s;
  const numbers = [
    scan.points ? `${compact(scan.points)} points` : null,
    scan.bytes && !isBusy(scan) ? bytes(scan.bytes) : null,
  ].filter((part) => part !== null).join(" \u00b7 ");
  const length = typeof scan.duration_s === "number" ? h("span", { class: "duration" }, `${numbers === "" ? "" : " \u00b7 "}${duration(scan.duration_s)}`) : null;
  return [
    h("div", { class: "pictured" }, picture, chooser(scan, chosen, actions)),
    h("div", {},
      h("h3", { title: name }, name),
      h("p", {}, moment(scan.started_s), typeof speed === "number" ? ` \u00b7 ${speed} \u00b0/s` : null),
      h("p", {}, numbers, length),
      h("p", { class: "badges" }, badge(scan), " ", scan.simulated ? h("span", { class: "badge", "data-state": "simulated" }, "SIMULATED") : null)),
    h("div", { class: "texts" }, scan.summary ? cut(scan, "why", scan.summary) : null, scan.notes ? cut(scan, "notes", scan.notes) : null),
    h("div", { class: "row" },
      opener(scan, actions),
      isBusy(scan) ? null : button("download", "Download", `Download ${name}`, () => downloads(scan, name, wrong, actions)),
      button("edit", "Edit", `Edit name and notes of ${name}`, () => actions.edit(scan)),
      isBusy(scan) ? null : button("delete", "Delete", `Delete ${name}`, () => actions.remove(scan))),
    wrong,
  ];
}

/** The cells of a scan in the table; index.html has their heads. */
export function cells(scan: Scan, chosen: boolean, wrong: HTMLElement, actions: Actions): Node[] {
  const name = title(scan);
  const cell = (kind: string, ...content: (Node | string | null)[]) => h("div", { role: "cell", class: kind }, ...content);
  const texts = scan.summary || scan.notes;
  return [
    cell("choosing", chooser(scan, chosen, actions)),
    h("div", { role: "rowheader", class: "name", title: name }, name),
    cell("number", moment(scan.started_s)),
    cell("number", typeof scan.duration_s === "number" ? duration(scan.duration_s) : ""),
    cell("number", scan.points ? compact(scan.points) : ""),
    cell("state", badge(scan)),
    cell("about", texts ? cut(scan, scan.summary ? "why" : "notes", texts) : null),
    cell("acting", opener(scan, actions),
      isBusy(scan) ? null : button("download", "\u2193", `Download ${name}`, () => downloads(scan, name, wrong, actions)),
      button("edit", "Edit", `Edit name and notes of ${name}`, () => actions.edit(scan))),
  ];
}

/** Fields for name and notes, in the place of a card or row. `done` gets the changed scan; null if nothing was changed. */
export function editor(scan: Scan, done: (changed: Scan | null) => void, { refused }: Actions): HTMLElement {
  const name = h("input", { type: "text", maxlength: 60, "data-role": "name", value: scan.name ?? "", placeholder: scan.id, "aria-label": `Name of ${title(scan)}` });
  const notes = h("textarea", { maxlength: 2_000, rows: 3, "data-role": "notes", placeholder: "Notes", "aria-label": `Notes on ${title(scan)}` }, scan.notes ?? "");
  const wrong = h("p", { class: "wrong", hidden: true });
  const save = async (event: Event) => {
    event.preventDefault();
    show(wrong, false);
    try {
      // What was not changed here may have been changed elsewhere.
      const texts = { ...(name.value === (scan.name ?? "") ? {} : { name: name.value }), ...(notes.value === (scan.notes ?? "") ? {} : { notes: notes.value }) };
      const changed = await api.edit(scan.id, texts);
      announce(`Saved ${title(changed)}`);
      done(changed);
    } catch (error) {
      refused("Save", error, wrong);
    }
  };
  const form = h("form", { class: "edit", submit: (event) => void save(event) }, name, notes, wrong,
    h("div", { class: "row" }, h("button", { type: "submit", class: "start" }, "Save"), h("button", { type: "button", click: () => done(null) }, "Cancel")));
  form.addEventListener("keydown", (event) => {
    // While the axis moves this key stops it, and nothing else.
    if (event.key === "Escape" && !event.defaultPrevented) done(null);
    if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) form.requestSubmit();
  });
  return form;
}

/** Opens a dialog. Not modal: the stop button must remain usable. */
function beside(dialog: HTMLDialogElement): void {
  const before = document.activeElement;
  if (dialog.open) dialog.close();
  dialog.show();
  dialog.onkeydown = (event) => {
    // While the axis moves this key stops it, and nothing else.
    if (event.key === "Escape" && !event.defaultPrevented) dialog.close();
  };
  dialog.onclose = () => {
    if (before instanceof HTMLElement) before.focus();
  };
}

/** Shows the texts of a scan whole. */
function about(scan: Scan): void {
  const dialog = id<HTMLDialogElement>("about");
  text(id("about-title"), title(scan));
  text(id("about-why"), scan.summary ?? "");
  show(id("about-why"), Boolean(scan.summary));
  text(id("about-notes"), scan.notes ?? "");
  show(id("about-notes"), Boolean(scan.notes));
  beside(dialog);
}

/** Lists the formats of a scan, which begin its download. */
function downloads(scan: Scan, name: string, wrong: HTMLElement, actions: Actions): void {
  const dialog = id<HTMLDialogElement>("download");
  const choice = (format: string, words: string) =>
    h("button", { type: "submit", value: format, click: () => void download(scan, name, format, wrong, actions) }, words);
  text(id("download-title"), `Download ${name}`);
  const cloud = hasCloud(scan) ? formats : [];
  id("download-cloud").replaceChildren(...cloud.map(([format, words]) => choice(format, words)), choice("log", "log (pcapng)"));
  id("download-more").replaceChildren(...cloud.map(([format, words]) => choice(`${format}${MORE}`, words)));
  show(id("download-with"), cloud.length > 0);
  beside(dialog);
}

/** Downloads a file; a refusal is shown at its scan. */
async function download(scan: Scan, name: string, choice: string, wrong: HTMLElement, { refused }: Actions): Promise<void> {
  const more = choice.endsWith(MORE);
  const format = choice.replace(MORE, "");
  show(wrong, false);
  const file = `${scan.name || "velomotion"}-${scan.id}.${format === "log" ? "pcapng" : format}`;
  announce(`Downloading ${name}: ${file}`);
  const save = (href: string) => h("a", { href, download: file }).click();
  const cancel = new AbortController();
  let shown: HTMLElement | null = null;
  try {
    if (format === "log") return save(await fileUrl(logUrl(scan.id)));
    if (format === "ply" && !more) return save(await fileUrl(cloudUrl(scan.id, format, more)));
    const received = h("span", {}, "making the cloud");
    // Its size is not known before it is made.
    shown = h("li", {}, h("span", { class: "name", title: file }, file), h("progress", { "aria-label": `Download of ${name}` }), received,
      h("button", { type: "button", "aria-label": `Cancel the download of ${name}`, click: () => cancel.abort() }, "Cancel"));
    id("downloads").append(shown);
    const href = await madeUrl(cloudUrl(scan.id, format, more), (size) => text(received, bytes(size)), cancel.signal);
    save(href);
    announce(`Downloaded ${name}: ${file}`);
    // The browser has begun to read it by then.
    setTimeout(() => URL.revokeObjectURL(href), 60_000);
  } catch (error) {
    if (cancel.signal.aborted) announce(`Download of ${name} cancelled`);
    else refused(`Download as ${format}`, error, wrong);
  } finally {
    const focused = shown?.contains(document.activeElement) === true;
    shown?.remove();
    if (focused) document.querySelector<HTMLElement>(`[data-id="${CSS.escape(scan.id)}"] [data-role=download]`)?.focus();
  }
}
