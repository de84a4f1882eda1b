// The form of the next scan, and what it would be: time, resolution, bytes. Left out: pressing Start (control.ts).

import { type Asked, type Plan, type Status, Refused, api } from "../api.ts";
import { attribute, h, id } from "../dom.ts";
import { bytes, digits, duration } from "../format.ts";

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
  form.addEventListener("input", (event) => {
    if (event.target !== slide) align();
    later();
  });
}

/** The motor makes whole turns a minute: the slider keeps to speeds that can be. */
function round(deg_s: number): number {
  const turns = deg_s / least_deg_s;
  const step = turns < 200 ? 1 : 5;
  return Number((Math.max(1, Math.round(turns / step) * step) * least_deg_s).toFixed(4));
}

function align(): void {
  const deg_s = Number(speed.value);
  if (deg_s > 0) slide.value = String(Math.log(deg_s / least_deg_s) / Math.log(most_deg_s / least_deg_s));
}

/** The axis's limits and what is taken where a field is empty. */
export function setStatus(status: Status): void {
  const { axis } = status;
  const now = JSON.stringify(axis);
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
  later();
}

/** The capture that the form asks for; null where a field is wrong, which the browser then says. */
export function asked(): Asked | null {
  unfold();
  if (!form.reportValidity()) return null;
  return read();
}

/** A field that is wrong cannot be pointed at where it is folded away. */
function unfold(): void {
  for (const more of form.querySelectorAll("details")) if (more.querySelector(":invalid") !== null) more.open = true;
}

/** The field that is wrong, in words; null where none is. */
function wrong(): string | null {
  const field = form.querySelector<HTMLInputElement>("input:invalid");
  if (field === null) return null;
  const label = field.closest("label")?.firstChild?.textContent?.trim() ?? field.name;
  return `${label}: ${field.validity.patternMismatch ? field.title : field.validationMessage}`;
}

function read(): Asked {
  const asked: Asked = { speed_deg_s: Number(speed.value) };
  if (from.value !== "") asked.from_deg = Number(from.value);
  if (to.value !== "") asked.to_deg = Number(to.value);
  if (accel.value !== "") asked.accel_deg_s2 = Number(accel.value);
  if (sweeps.value !== "") asked.sweeps = Number(sweeps.value);
  if (both.checked) asked.both_ways = true;
  if (tolerance.value.trim() !== "") asked.tolerance = tolerance.value.trim();
  if (name.value.trim() !== "") asked.name = name.value.trim();
  return asked;
}

/** Asks for the plan a moment after the last change. */
function later(): void {
  clearTimeout(timer);
  timer = window.setTimeout(() => void plan(), 250);
}

async function plan(): Promise<void> {
  const mine = ++serial;
  const words = wrong();
  if (words !== null) return say(words);
  try {
    const found = await api.plan(read());
    if (mine === serial) draw(found);
  } catch (error) {
    if (mine !== serial || (error instanceof Refused && (error.status === 0 || error.status === 401))) return;
    const words = error instanceof Refused ? [error.message, error.help].filter(Boolean).join(": ") : String(error);
    say(words);
  }
}

/** Why there is no plan. */
function say(words: string): void {
  out.replaceChildren(h("p", { class: "wrong" }, words));
}

function draw(found: Plan): void {
  const cell = (value: string, words: string) => h("span", {}, h("b", {}, value), words);
  const step = found.step_deg ?? null;
  const resolution = found.resolution_deg ?? null;
  const homing_s = found.homing_s ?? null;
  const homes = homing_s === null ? ", and homing first" : homing_s >= 0.1 ? `, ${duration(homing_s)} of it to the home first` : "";
  const all = `${duration(found.moves_s + (homing_s ?? 0))} in all${homes}`;
  const turn = step === null ? "" : `${digits(step)}\u00b0 of tilt a turn \u00b7 `;
  out.replaceChildren(
    cell(duration(found.sweep_s), "a sweep"),
    resolution === null ? cell("\u2013", "mean vertical resolution") : cell(`${digits(resolution)}\u00b0`, "mean vertical resolution"),
    h("p", {}, all),
    h("p", {}, `${turn}${digits(found.motor_rpm, 4)} rpm \u00b7 ${bytes(found.bytes)} at most`),
  );
}
