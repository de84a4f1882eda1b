// The form of the next scan, and its plan: duration, resolution, bytes. control.ts handles Start.

import { type CaptureRequest, type CaptureEstimate, type Status, RequestError, api } from "../api.ts";
import { attribute, h, id } from "../dom.ts";
import * as fields from "../fields.ts";
import { bytes, digits, duration, sentence } from "../format.ts";

const form = id<HTMLFormElement>("sweep");
const input = (name: string) => id<HTMLInputElement>(name);
const speed = input("speed");
const slide = input("speed-slide");
const from = input("from");
const to = input("to");
const sweeps = input("sweeps");
const both = input("both");
const accel = input("accel");
const name = input("name");
const tolerance = input("tolerance");
const out = id<HTMLOutputElement>("plan");

/** After an unanswered request. */
const AGAIN_MS = 2_000;

let least_deg_s = 0.05;
let most_deg_s = 98;
let timer = 0;
let serial = 0;
let known = "";

export function wire(): void {
  slide.addEventListener("input", () => {
    speed.value = String(round(least_deg_s * (most_deg_s / least_deg_s) ** Number(slide.value)));
  });
  both.addEventListener("change", () => attribute(sweeps, "placeholder", both.checked ? "2" : "1"));
  fields.watch(form);
  form.addEventListener("input", (event) => {
    if (event.target !== slide) align();
    request_plan_later();
  });
}

/** Rounds to a possible speed: the motor turns at whole rpm. */
function round(deg_s: number): number {
  const rpm = deg_s / least_deg_s;
  const step = rpm < 200 ? 1 : 5;
  return Number((Math.max(1, Math.round(rpm / step) * step) * least_deg_s).toFixed(4));
}

function align(): void {
  const deg_s = Number(speed.value);
  if (deg_s > 0) slide.value = String(Math.log(deg_s / least_deg_s) / Math.log(most_deg_s / least_deg_s));
}

/** Sets the axis's limits and the defaults of empty fields. */
export function setStatus(status: Status): void {
  const { axis, drive, lidar } = status;
  // What the plan depends on; the lidar's speed varies by 1 rpm.
  const now = JSON.stringify([axis, drive.referenced, lidar.state, Math.round((lidar.rpm ?? 0) / 10)]);
  if (now === known) return;
  known = now;
  most_deg_s = axis.max_speed_deg_s;
  least_deg_s = axis.min_speed_deg_s ?? least_deg_s;
  attribute(speed, "min", String(least_deg_s));
  attribute(speed, "max", String(axis.max_speed_deg_s));
  attribute(accel, "max", String(axis.max_accel_deg_s2));
  attribute(accel, "placeholder", String(axis.accel_deg_s2));
  for (const [field, usual] of [[from, axis.max_deg], [to, axis.min_deg]] as const) {
    attribute(field, "min", String(axis.min_deg));
    attribute(field, "max", String(axis.max_deg));
    attribute(field, "placeholder", String(usual));
  }
  align();
  request_plan_later();
}

/** The capture request of the form; null if a field is invalid, which is shown then. */
export function capture_request(): CaptureRequest | null {
  return fields.report(form, true) ? read() : null;
}

function read(): CaptureRequest {
  const request: CaptureRequest = { speed_deg_s: Number(speed.value) };
  if (from.value !== "") request.from_deg = Number(from.value);
  if (to.value !== "") request.to_deg = Number(to.value);
  if (accel.value !== "") request.accel_deg_s2 = Number(accel.value);
  if (sweeps.value !== "") request.sweeps = Number(sweeps.value);
  if (both.checked) request.both_ways = true;
  if (tolerance.value.trim() !== "") request.tolerance = tolerance.value.trim();
  if (name.value.trim() !== "") request.name = name.value.trim();
  return request;
}

/** Requests the plan shortly after the last change. */
export function request_plan_later(): void {
  clearTimeout(timer);
  timer = window.setTimeout(() => void plan(), 250);
}

async function plan(): Promise<void> {
  const mine = ++serial;
  if (!fields.valid(form)) return out.replaceChildren(h("p", { class: "hint" }, "No plan until the form is valid."));
  try {
    const found = await api.plan(read());
    if (mine === serial) draw(found);
  } catch (error) {
    if (mine !== serial) return;
    // What is displayed may be of another speed. It is requested again, also when the connection is back.
    if (error instanceof RequestError && error.status === 0) timer = window.setTimeout(() => void plan(), AGAIN_MS);
    if (error instanceof RequestError && (error.status === 0 || error.status === 401)) return out.replaceChildren(h("p", { class: "hint" }, "No plan without the daemon."));
    const words = error instanceof RequestError ? [error.message, error.help].filter(Boolean).join(": ") : String(error);
    show_error(words);
  }
}

/** Shows why there is no plan. */
function show_error(words: string): void {
  out.replaceChildren(h("p", { class: "wrong" }, words));
}

function draw(found: CaptureEstimate): void {
  const cell = (value: string, words: string) => h("span", {}, h("b", {}, value), words);
  const step = found.step_deg ?? null;
  const resolution = found.resolution_deg ?? null;
  const homing_s = found.homing_s ?? null;
  const homes = homing_s === null ? ", plus homing" : homing_s >= 0.1 ? `, including ${duration(homing_s)} to the home position` : "";
  const all = `${duration(found.moves_s + (homing_s ?? 0))} in total${homes}`;
  const step_words = step === null ? "" : `${digits(step)}\u00b0 of tilt per revolution \u00b7 `;
  const { gap_deg: gap, error_mm: error, warning } = found;
  const seen = gap == null || error == null ? [] : [h("p", {}, `99 % of directions have a point within ${digits(gap)}\u00b0 \u00b7 95 % of points within ${digits(error)} mm at 20 m`)];
  const warned = warning == null ? [] : [h("p", { class: "wrong" }, sentence(warning))];
  out.replaceChildren(
    cell(duration(found.sweep_s), "per sweep"),
    resolution === null ? cell("\u2013", "mean vertical resolution") : cell(`${digits(resolution)}\u00b0`, "mean vertical resolution"),
    h("p", {}, all),
    ...seen,
    ...warned,
    h("p", {}, `${step_words}motor at ${digits(found.motor_rpm, 4)} rpm \u00b7 ${bytes(found.bytes)} at most`),
  );
}
