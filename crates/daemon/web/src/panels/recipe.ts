// Two scans for a calibration: both ways, one fast and one slow, one after the other. Stop ends it.

import { type CaptureRequest, type Scan, api } from "../api.ts";
import { id, show, text } from "../dom.ts";
import { title } from "../found.ts";
import { command, refused } from "./control.ts";
import { announce, note } from "./messages.ts";

/** The speeds tell play from delay, degrees per second. */
const SPEEDS_DEG_S = [56.25, 10];

const button = id<HTMLButtonElement>("recipe");
const state = id("recipe-state");
const error = id("recipe-error");
/** Scans of a recipe that runs; the last of them is under way. */
let begun: Scan[] | null = null;
let form: () => CaptureRequest | null = () => null;

/** `request` reads the form of the next scan, of which angles and acceleration count. */
export function wire(request: () => CaptureRequest | null): void {
  form = request;
  button.addEventListener("click", () => {
    if (form() === null) return;
    show(error, false);
    begun = [];
    void command("Scan for a calibration", next, error);
  });
}

export function setReady(ready: boolean): void {
  button.disabled = !ready || begun !== null;
}

async function next(): Promise<void> {
  const request = form();
  const speed_deg_s = SPEEDS_DEG_S[begun?.length ?? 0];
  if (begun === null || request === null || speed_deg_s === undefined) return end();
  text(state, `Scan ${begun.length + 1} of ${SPEEDS_DEG_S.length}: ${speed_deg_s}\u00b0/s`);
  const { name: _name, tolerance: _tolerance, ...angles } = request;
  try {
    const scan = await api.capture({ ...angles, speed_deg_s, sweeps: 2, both_ways: true });
    // Stopped meanwhile.
    begun?.push(scan);
  } catch (error) {
    end();
    throw error;
  }
}

/** Goes on when a scan is complete, and says what to do with both. */
export function finished(scan: Scan): void {
  if (begun === null || begun.at(-1)?.id !== scan.id) return;
  if (scan.state !== "whole") {
    refused("Scan for a calibration", `${title(scan)} is not complete`, error);
    return end();
  }
  if (begun.length < SPEEDS_DEG_S.length) return void next().catch((why: unknown) => refused("Scan for a calibration", why, error));
  const logs = begun.map((one) => `velomotion-${one.id}.pcapng`).join(" ");
  note("info", "Two scans for a calibration are complete.", `Download both logs, then run:\nvelomotion calibrate ${logs} -o mount.toml`);
  announce("Two scans for a calibration are complete");
  end();
}

/** Starts no further scan. */
export function end(): void {
  begun = null;
  text(state, "");
}
