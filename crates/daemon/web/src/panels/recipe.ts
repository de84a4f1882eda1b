// Two scans for a calibration: both ways, one fast and one slow. Each is started by the user: nothing moves on its own.

import { type CaptureRequest, type Scan, api } from "../api.ts";
import { id, show, text } from "../dom.ts";
import { title } from "../found.ts";
import { command, refused } from "./control.ts";
import { announce, note } from "./messages.ts";
import { get } from "./scans.ts";

/** The speeds tell play from delay, degrees per second. */
const SPEEDS_DEG_S = [56.25, 10];

const button = id<HTMLButtonElement>("recipe");
const error = id("recipe-error");
/** Complete scans of the recipe. */
let complete: Scan[] = [];
/** Id of the one under way. */
let under_way: string | null = null;

/** `request` reads the form of the next scan, of which angles and acceleration count. */
export function wire(request: () => CaptureRequest | null): void {
  button.addEventListener("click", () => {
    const form = request();
    if (form !== null) void command("Scan for a calibration", () => begin(form), error);
  });
}

export function setReady(ready: boolean): void {
  button.disabled = !ready;
}

async function begin({ name: _name, tolerance: _tolerance, ...angles }: CaptureRequest): Promise<void> {
  const speed_deg_s = SPEEDS_DEG_S[complete.length] ?? 0;
  const scan = await api.capture({ ...angles, speed_deg_s, sweeps: 2, both_ways: true });
  under_way = scan.id;
  // Its end may have been reported before this answer.
  const now = get(scan.id);
  if (now !== undefined) finished(now);
}

/** Counts a scan that is complete, and says what is next. */
export function finished(scan: Scan): void {
  if (scan.id !== under_way || scan.state === "recording" || scan.state === "making") return;
  under_way = null;
  show(error, false);
  if (scan.state !== "whole") return refused("Scan for a calibration", `${title(scan)} is not complete: scan again`, error);
  complete.push(scan);
  if (complete.length === SPEEDS_DEG_S.length) {
    const logs = complete.map((one) => `velomotion-${one.id}.pcapng`).join(" ");
    note("info", "Both scans for a calibration are complete.", `Download their logs, then run, with the names of your files:\nvelomotion calibrate ${logs} -o mount.toml`);
    announce("Both scans for a calibration are complete");
    complete = [];
  }
  const next = SPEEDS_DEG_S[complete.length] ?? 0;
  text(button, complete.length === 0 ? "Scan for a calibration" : `Second scan, at ${next}\u00b0/s`);
}
