// The axis by hand: to an angle, or by a step. control.ts has the stop.

import { type Status, api } from "../api.ts";
import { attribute, h, id, show } from "../dom.ts";
import * as fields from "../fields.ts";
import { fixed } from "../format.ts";
import { target } from "../jog.ts";
import { command } from "./control.ts";

/** Steps of the buttons, degrees. */
const STEPS_DEG = [-10, -1, -0.1, 0.1, 1, 10];

const form = id<HTMLFormElement>("axis");
const to = id<HTMLInputElement>("goto");
const speed = id<HTMLInputElement>("goto-speed");
const steps = STEPS_DEG.map((step) => {
  const words = `${step > 0 ? "+" : ""}${fixed(step, Math.abs(step) < 1 ? 1 : 0)}\u00b0`;
  return { step, button: h("button", { type: "button", "data-jog": step, "aria-label": `Move by ${words}`, click: () => jog(step) }, words) };
});

let angle_deg: number | null = null;
let bounds: { min_deg: number; max_deg: number } | null = null;

export function wire(): void {
  id("jog").append(...steps.map(({ button }) => button));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    if (fields.report(form, true)) move(Number(to.value));
  });
  fields.watch(form);
}

/** Moves by a step, within the limits. */
function jog(step: number): void {
  const end = target(angle_deg, step, bounds);
  if (end !== null && fields.report(id("goto-speed-field"), true)) move(end);
}

function move(to_deg: number): void {
  void command(`Go to ${fixed(to_deg, 2)}\u00b0`, () => api.goto(to_deg, Number(speed.value)), id("axis-error"));
}

export function setStatus({ axis, drive }: Status): void {
  bounds = axis;
  attribute(to, "min", String(axis.min_deg));
  attribute(to, "max", String(axis.max_deg));
  attribute(to, "placeholder", `${axis.min_deg} to ${axis.max_deg}`);
  attribute(speed, "max", String(axis.max_speed_deg_s));
  if (axis.min_speed_deg_s !== undefined) attribute(speed, "min", String(axis.min_speed_deg_s));
  // Known after homing.
  angle_deg = drive.referenced === true ? (drive.angle_deg ?? null) : null;
  show(id("axis-unknown"), drive.state === "connected" && drive.referenced !== true);
}

export function setAngle(now_deg: number): void {
  if (angle_deg !== null) angle_deg = now_deg;
}

/** Whether a motion may be started; called whenever that changes. */
export function setReady(ready: boolean): void {
  id<HTMLButtonElement>("go").disabled = !ready || angle_deg === null;
  for (const { step, button } of steps) button.disabled = !ready || target(angle_deg, step, bounds) === null;
}
