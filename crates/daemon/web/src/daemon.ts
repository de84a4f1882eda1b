// The page of a daemon: passes its events to the panels and the view.

import { type Scan, type Status, RequestError, api, cloudUrl, sendRequest } from "./api.ts";
import { id, show, text } from "./dom.ts";
import { Events, type Listener } from "./events.ts";
import { count } from "./format.ts";
import { title } from "./found.ts";
import { REFUSAL_MS, outage } from "./outage.ts";
import * as axis from "./panels/axis.ts";
import * as control from "./panels/control.ts";
import * as devices from "./panels/devices.ts";
import { alarm, announce, note, restore } from "./panels/messages.ts";
import { setFormats } from "./panels/scan_parts.ts";
import * as quality from "./panels/quality.ts";
import * as recipe from "./panels/recipe.ts";
import * as scans from "./panels/scans.ts";
import * as signin from "./panels/signin.ts";
import * as sweep from "./panels/sweep.ts";
import type { CloudSource, Viewer } from "./viewer.ts";

const REFUSED = "It answers, but does not send its events: too many pages may be open.";
/** Largest newest scan that is opened automatically. */
const SMALL_POINTS = 3_000_000;

let viewer: Viewer | null = null;
let connected = false;
/** Whether the list of scans is complete. */
let listed = false;
/** Id of the scan that is captured now. */
let capturing: string | null = null;
/** Id of the scan whose end was reported last. */
let reported: string | null = null;

/** The cloud of a scan. */
function source(scan: Scan): CloudSource {
  const { id, simulated, state } = scan;
  return { id, title: title(scan), simulated, partial: state === "partial", url: (complete) => cloudUrl(id, "ply", complete), completes: true, scanner: true, plays: false };
}

const listener: Listener = {
  opened() {
    connected = true;
    devices.setLink("Connected", "good");
    show(id("lost"), false);
    control.setConnected(true);
    sweep.request_plan_later();
    void signin.offer();
    void list();
  },
  lost(retry_s) {
    if (connected) alarm("Connection to the daemon lost.");
    connected = false;
    control.setConnected(false);
    devices.setLink("Offline", "bad");
    if (id("lost").hidden) text(id("lost"), "Connection to the daemon lost: displayed values are old.");
    show(id("lost"), true);
    void probe((why) => {
      // A daemon that has just started answers before the next attempt.
      if (connected || (retry_s < 2 && why === REFUSED)) return;
      const kept = why.includes("ended") ? "What is recorded stays" : "A running scan continues";
      text(id("lost"), `Connection to the daemon lost: displayed values are old. ${why} ${kept}. Reconnecting${retry_s >= 1 ? ` in ${retry_s} s` : ""}.`);
    });
  },
  status(status: Status) {
    axis.setStatus(status);
    control.setStatus(status);
    devices.setStatus(status);
    sweep.setStatus(status);
    quality.setStatus(status);
    const { scan } = status.activity;
    capturing = typeof scan === "string" && status.activity.doing === "capturing" ? scan : null;
    if (capturing !== null) viewer?.begin(capturing, scans.get(capturing)?.name || capturing, status.simulated);
    if (typeof status.drive.angle_deg === "number") viewer?.setTilt(status.drive.angle_deg);
  },
  motion(motion) {
    axis.setAngle(motion.angle_deg);
    control.setMotion(motion);
    devices.setMotion(motion);
    viewer?.setTilt(motion.angle_deg);
  },
  scan(scan, deleted) {
    if (deleted) {
      scans.remove(scan.id);
      quality.forget(scan.id);
      viewer?.forget(scan.id);
      return;
    }
    const before = scans.get(scan.id)?.state;
    scans.set(scan);
    viewer?.rename(scan.id, title(scan));
    if (scan.state === "recording" && before !== "recording") viewer?.begin(scan.id, title(scan), scan.simulated);
    // One that was not known is restored, not new, unless it is in view.
    if (before === undefined && viewer?.shown !== scan.id) void last();
    else if (before !== scan.state) void finished(scan);
  },
  message(message) {
    note(message.level, message.text, message.help);
    // A fault may be over before it is seen in the state of the devices.
    if (message.level === "error") control.showError(message.text, message.help ?? null);
  },
  points(frame) {
    viewer?.frame(frame, events.every);
  },
};

const events = new Events(listener);

/** Reports the end of a scan, and opens its cloud if the scan is in view. */
async function finished(scan: Scan): Promise<void> {
  if (scan.state === "recording" || scan.state === "making") return;
  reported = scan.id;
  const name = title(scan);
  recipe.finished(scan);
  if (scan.state === "whole") announce(`Scan ${name} is complete: ${count(scan.points ?? 0)} points`);
  else note(scan.state === "failed" ? "error" : "warning", `Scan ${name} ${scan.state === "failed" ? "has no cloud" : "is partial"}.`, scan.summary);
  if (viewer?.shown === scan.id) {
    if (scan.state === "failed") viewer.ended(scan.id, name, scan.simulated);
    else viewer.open(source(scan));
  }
  if (viewer?.shown === scan.id) void measured(scan.id);
  await last();
}

/** Shows the report of the scan in view. */
async function measured(name: string | null): Promise<void> {
  quality.setScan(null);
  if (name === null) return;
  try {
    const scan = await api.scan(name);
    if (viewer?.shown === name) quality.setScan(scan);
  } catch {
    // It was deleted, or the connection is lost, which is shown.
  }
}

/** Marks the scan in view. */
export function setCurrent(name: string | null): void {
  scans.setCurrent(name);
  void measured(name);
}

/** Shows clock and angle of the newest scan with a cloud. */
async function last(): Promise<void> {
  const newest = scans.all().find((scan) => scan.state === "whole" || scan.state === "partial");
  if (newest === undefined) return devices.setLast(null);
  try {
    const scan = await api.scan(newest.id);
    scans.set(scan);
    devices.setLast(scan);
  } catch {
    devices.setLast(newest);
  }
}

/** Opens the scans that the page's address names, or says that they are not in the complete list; false if there is none to wait for. */
function open_linked(view: Viewer, complete: boolean): boolean {
  const names = view.linked_scans;
  if (names.scan === null) return false;
  const [linked, other] = [names.scan, names.other].map((name) => (name === null ? undefined : scans.get(name)));
  const lacks = linked === undefined ? "The scan of the link is" : names.other !== null && other === undefined ? "The scan with which the link compares is" : null;
  if (lacks !== null && !complete) return true;
  show(id("scans-error"), lacks !== null);
  if (lacks !== null) {
    text(id("scans-error"), `${lacks} not on this daemon: it may have been deleted.`);
    note("warning", `${lacks} not on this daemon.`, "It may have been deleted.");
    announce(`${lacks} not on this daemon`);
  }
  if (linked === undefined) view.forget_link();
  else view.open(source(linked), other === undefined ? null : source(other));
  return linked !== undefined;
}

/** Reports that the scan in view ended or was deleted while the page was not connected: no event said so. */
function catch_up(): void {
  const shown = viewer?.shown ?? null;
  if (viewer === null || shown === null) return;
  const scan = scans.get(shown);
  if (scan === undefined) {
    // It began after the list was made.
    if (viewer.is_live && shown === capturing) return;
    quality.forget(shown);
    viewer.forget(shown);
    note("warning", "The scan in view was deleted while the page was not connected.", null);
  } else if (viewer.is_live && scan.id !== reported) void finished(scan);
}

async function list(): Promise<void> {
  try {
    await scans.load((complete) => {
      listed = complete;
      if (complete) catch_up();
      if (viewer === null || open_linked(viewer, complete) || viewer.shown !== null) return;
      const newest = scans.all().find((scan) => scan.state === "whole" || scan.state === "partial");
      if (newest !== undefined && (newest.points ?? 0) <= SMALL_POINTS) viewer.open(source(newest));
    });
    await last();
  } catch (error) {
    control.refused("List of scans", error, id("scans-error"));
  }
}

/** Checks whether the daemon requires a token, which a refused WebSocket does not say, and passes on why it does not answer. */
async function probe(silent: (why: string) => void = () => {}): Promise<void> {
  const begin_ms = performance.now();
  const why = (failed_ms: number | null) => silent(outage(navigator.onLine, location.hostname, failed_ms));
  const late = setTimeout(() => why(null), REFUSAL_MS);
  try {
    listener.status(await api.status());
    silent(REFUSED);
  } catch (error) {
    if (error instanceof RequestError && error.status === 401) {
      events.close();
      show(id("lost"), false);
      devices.setLink("Sign in", "warn");
      signin.open();
    } else if (error instanceof RequestError && error.status === 0) why(performance.now() - begin_ms);
  } finally {
    clearTimeout(late);
  }
}

/** Reads the daemon's cloud formats from its API description. */
async function formats(): Promise<void> {
  try {
    const description = await sendRequest<{ paths?: Record<string, { get?: { parameters?: { name: string; schema?: { enum?: string[] } }[] } }> }>("GET", "openapi.json");
    const path = Object.entries(description.paths ?? {}).find(([name]) => name.endsWith("/cloud"))?.[1];
    const known = path?.get?.parameters?.find((parameter) => parameter.name === "format")?.schema?.enum;
    if (known !== undefined && known.length > 0) setFormats(known);
  } catch {
    // The default list remains.
  }
}

/** Starts the page; without a view everything else works. */
export function start(view: Viewer | null): void {
  viewer = view;
  // The browser takes the Escape key that ends the full screen: it stops the axis too.
  if (viewer !== null) {
    viewer.left_full_screen = control.stop_motion;
    viewer.turned = quality.turn;
    viewer.relinked = () => {
      if (viewer !== null) open_linked(viewer, listed);
    };
  }
  restore();
  control.wire(() => {
    const capture = sweep.capture_request();
    if (capture !== null) void control.command("Start", () => api.capture(capture));
  }, (ready) => {
    axis.setReady(ready);
    recipe.setReady(ready);
  });
  recipe.wire(sweep.capture_request);
  axis.wire();
  sweep.wire();
  quality.wire(api.statistics);
  const open = (scan: Scan, other: Scan | null) => {
    if (scan.state === "recording") viewer?.begin(scan.id, title(scan), scan.simulated, true);
    else viewer?.open(source(scan), other === null ? null : source(other));
    id("canvas").scrollIntoView({ block: "nearest" });
  };
  scans.wire((scan) => open(scan, null), open);
  signin.wire(() => {
    events.open();
    void formats();
  });
  // A phone that wakes up reconnects at once.
  document.addEventListener("visibilitychange", () => {
    if (!document.hidden && !connected) events.open();
  });
  addEventListener("online", () => {
    if (!connected) events.open();
  });
  void formats();
  events.open();
  void probe();
}
