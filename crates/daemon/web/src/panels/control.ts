// Start, home and stop. Stop is never disabled, also has the Escape key, and is repeated until it is acknowledged.

import { type Status, RequestError, api, setStops } from "../api.ts";
import { attribute, id, show, text } from "../dom.ts";
import { duration, fixed } from "../format.ts";
import type { Motion } from "../events.ts";
import { TRY_MS, repeatStop } from "../stop.ts";
import { announce, note } from "./messages.ts";

const start = id<HTMLButtonElement>("start");
const home = id<HTMLButtonElement>("home");
const stop = id<HTMLButtonElement>("stop");
const why = id("start-why");
const doing = id("doing");
const progress = id<HTMLProgressElement>("doing-progress");

const WORDS: Record<string, string> = {
  idle: "Ready", connecting: "Connecting", homing: "Homing", moving: "Moving", capturing: "Sweeping", stopping: "Stopping",
};

/** For so long the state says that the axis was stopped. */
const STOPPED_MS = 5_000;

/** Called when it changes whether the axis may be moved by hand. */
let ready: (ready: boolean) => void = () => {};
let status: Status | null = null;
let connected = false;
let asking = false;
/** Ends the repetition of a stop. */
let stopping: AbortController | null = null;
/** Whether a stop was acknowledged a moment ago. */
let stopped = false;
/** Duration of the move, seconds. */
let whole_s = 0;
let stepped = 0;

export function wire(start_capture: () => void, axis_ready: (ready: boolean) => void): void {
  ready = axis_ready;
  stop.addEventListener("click", () => void halt());
  home.addEventListener("click", () => void command("Home", () => api.home()));
  id("not-stopped-end").addEventListener("click", () => stopping?.abort());
  id("sweep").addEventListener("submit", (event) => {
    event.preventDefault();
    start_capture();
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || rests()) return;
    event.preventDefault();
    stop_motion();
  }, { capture: true });
}

/** Whether the axis is known to rest. A command that is under way, or a state from before the connection was lost, leaves that open. */
const rests = () => (status === null ? id<HTMLDialogElement>("signin").open : connected && !asking && status.activity.doing === "idle");

/** Stops a motion, if there may be one. */
export function stop_motion(): void {
  if (!rests()) void halt();
}

/** Sends a command and reports its error, at its control too. */
export async function command(what: string, go: () => Promise<unknown>, at: HTMLElement = id("control-error")): Promise<void> {
  asking = true;
  show(at, false);
  draw();
  try {
    await go();
  } catch (error) {
    // A stop by the user ends the motion with an error, which the user need not see.
    if (stopping === null) refused(what, error, at);
  } finally {
    asking = false;
    draw();
  }
}

/** Shows an error beside the buttons, until a motion begins or is stopped. */
export function showError(words: string, help: string | null): void {
  text(id("control-error"), help ? `${words}\n${help}` : words);
  show(id("control-error"), true);
}

/** Adds an error to the messages, and shows it at the control that caused it. */
export function refused(what: string, error: unknown, at: HTMLElement): void {
  const help = error instanceof RequestError ? error.help : null;
  const words = `${what}: ${reason(error)}`;
  note("error", words, help);
  text(at, help ? `${words}\n${help}` : words);
  show(at, true);
  at.scrollIntoView({ block: "nearest" });
}

function reason(error: unknown): string {
  return error instanceof RequestError ? error.message : String(error);
}

async function halt(): Promise<void> {
  if (stopping !== null) return;
  stopping = new AbortController();
  show(id("control-error"), false);
  draw();
  const banner = id("not-stopped");
  const unacknowledged = (why: unknown) => {
    const silent = why === null || (why instanceof DOMException && why.name === "AbortError");
    text(id("not-stopped-why"), silent ? `the daemon has not answered for ${TRY_MS / 1_000} s` : reason(why));
    show(banner, true);
  };
  try {
    if (await repeatStop(api.stop, unacknowledged, stopping.signal)) {
      announce("Stopped");
      stopped = true;
      setTimeout(() => {
        stopped = false;
        draw();
      }, STOPPED_MS);
    }
  } finally {
    show(banner, false);
    stopping = null;
    draw();
  }
}

export function setConnected(now: boolean): void {
  connected = now;
  draw();
}

export function setStatus(now: Status): void {
  const before = status?.activity.doing;
  status = now;
  setStops(now.stops, now.started_s);
  const { doing: what, step } = now.activity;
  if (before !== undefined && before !== what) announce(WORDS[what] ?? what);
  // A motion that begins replaces an earlier error; its own error stays.
  if (before === "idle" && what !== before) show(id("control-error"), false);
  if (what !== before || step !== stepped) whole_s = 0;
  stepped = step ?? 0;
  draw();
}

/** Shows the remaining time; called 20 times a second. */
export function setMotion(motion: Motion): void {
  const left_s = motion.left_s ?? null;
  if (left_s === null) return;
  whole_s = Math.max(whole_s, left_s);
  progress.value = whole_s > 0 ? 1 - left_s / whole_s : 0;
  if (status !== null) text(doing, activityText(status, left_s));
}

function activityText(now: Status, left_s: number | null): string {
  const { doing: what, homes, step, steps, to_deg } = now.activity;
  if (homes) return WORDS.homing ?? "";
  const parts = [WORDS[what] ?? what];
  if (typeof to_deg === "number" && (what === "moving" || what === "capturing")) parts[0] += ` to ${fixed(to_deg, Number.isInteger(to_deg) ? 0 : 1)}\u00b0`;
  if (step && steps && steps > 1) parts.push(`${step} of ${steps}`);
  if (left_s !== null && left_s > 0) parts.push(`${left_s < 60 ? `${left_s.toFixed(1)} s` : duration(left_s)} left`);
  return parts.join(" \u00b7 ");
}

/** Why no motion can start; null if it can. */
function obstacle(): string | null {
  if (!connected) return "No connection to the daemon.";
  if (status === null) return "Waiting for the daemon.";
  if (status.drive.state === "absent") return "No drive: see what to do above.";
  if (status.drive.state === "fault") return "The drive is in fault: see what to do above.";
  if (status.lidar.state === "absent") return "No lidar: see what to do above.";
  return null;
}

function draw(): void {
  const moving = status !== null && status.activity.doing !== "idle" && status.activity.doing !== "connecting";
  const obstacle_now = obstacle();
  // Homing needs no lidar, and clears a fault of the drive.
  const homes = obstacle_now === null || (connected && status !== null && status.drive.state !== "absent");
  // The axis is idle for a moment before the stop sets its brake: what is begun then is refused.
  const busy = asking || moving || stopping !== null;
  start.disabled = busy || obstacle_now !== null;
  home.disabled = busy || !homes;
  ready(connected && status?.drive.state === "connected" && !busy);
  text(why, moving ? "" : (obstacle_now ?? ""));
  show(why, why.textContent !== "");
  attribute(stop, "data-moving", String(moving));
  attribute(doing, "data-moving", String(moving));
  if (stopping !== null) text(doing, "Stopping");
  else if (!connected) text(doing, "No connection");
  else if (status !== null) text(doing, obstacle_now !== null && !moving ? "Not ready" : stopped && !moving ? "Stopped" : activityText(status, status.activity.left_s ?? null));
  show(progress, moving);
  const title = !connected ? "No connection" : moving ? (WORDS[status?.activity.doing ?? ""] ?? "Moving") : obstacle_now !== null ? "Not ready" : null;
  const full = title === null ? "velomotion" : `${title} \u2013 velomotion`;
  if (document.title !== full) document.title = full;
}
