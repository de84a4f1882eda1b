// The box and the section outside of which points are hidden.

import { id, show, text } from "../dom.ts";
import * as fields from "../fields.ts";
import { fixed } from "../format.ts";
import type { ViewState } from "../view/link.ts";
import type { Stage } from "../view/stage.ts";

const box = ["x-low", "y-low", "z-low", "x-high", "y-high", "z-high"].map((name) => id<HTMLInputElement>(name));
const across = id<HTMLSelectElement>("section");
const offset = id<HTMLInputElement>("section-offset");
const thick = id<HTMLInputElement>("section-thick");
/** Without a limit. */
const ANY_M = 1e6;

export const limit = (field: HTMLInputElement): number | null => (field.value === "" || !Number.isFinite(Number(field.value)) ? null : Number(field.value));

export function wire(stage: Stage): void {
  across.addEventListener("input", reachOver);
  for (const field of [...box, across, offset, thick]) field.addEventListener("input", () => apply(stage));
  id("unclip").addEventListener("click", () => set(stage, {}));
}

/** What was subtracted from the cloud's coordinates, metres; fields have the cloud's own. */
let origin: [number, number, number] = [0, 0, 0];
let centre: [number, number, number] = [0, 0, 0];
let most_m = 10;

/** The offsets of sections reach over the cloud: this far from its centre, metres. */
export function setFrame(stage: Stage, from: [number, number, number], middle: [number, number, number], reach_m: number): void {
  const moved = from.some((m, i) => m !== origin[i]);
  [origin, centre, most_m] = [from, middle, Math.max(1, Math.ceil(1.2 * reach_m))];
  reachOver();
  if (moved) apply(stage);
}

const AXES = ["x", "y", "z"];

function reachOver(): void {
  const axis = Math.max(0, AXES.indexOf(across.value));
  const middle = Math.round((centre[axis] ?? 0) + (origin[axis] ?? 0));
  const value = offset.value;
  offset.min = String(middle - most_m);
  offset.max = String(middle + most_m);
  offset.value = value;
}

export function state(): Pick<ViewState, "box" | "section"> {
  const section = across.value === "" ? {} : { section: { across: across.value as "x" | "y" | "z", offset_m: Number(offset.value), thick_m: limit(thick) ?? 0.2 } };
  return { box: box.map(limit), ...section };
}

export function set(stage: Stage, { box: limits, section }: Pick<ViewState, "box" | "section">): void {
  box.forEach((field, i) => {
    const value = limits?.[i] ?? null;
    field.value = value === null ? "" : String(value);
  });
  across.value = section?.across ?? "";
  reachOver();
  if (section !== undefined) [offset.value, thick.value] = [String(section.offset_m), String(section.thick_m)];
  fields.report(id("tools"));
  apply(stage);
}

function apply(stage: Stage): void {
  const { box: limits = [], section } = state();
  const own = (m: number | null, i: number) => (m === null ? null : m - (origin[i % 3] ?? 0));
  const [low, high] = [limits.map(own).slice(0, 3), limits.map(own).slice(3)];
  stage.setBox(low.map((m) => m ?? -ANY_M), high.map((m) => m ?? ANY_M));
  const axis = AXES.indexOf(section?.across ?? "");
  const offset_m = section === undefined ? 0 : section.offset_m - (origin[axis] ?? 0);
  stage.setSection(AXES.map((_, i) => (i === axis ? 1 : 0)), offset_m, section === undefined ? ANY_M : section.thick_m / 2);
  show(id("section-fields"), section !== undefined);
  text(id("section-at"), section === undefined ? "" : `at ${section.across} = ${fixed(section.offset_m, 2)} m`);
  const hidden = limits.some((m) => m !== null) || section !== undefined;
  text(id("clipped"), hidden ? "parts hidden" : "");
  text(id("view-clipped"), hidden ? "Parts are hidden by box or section." : "");
}
