// The box and the section outside of which points are hidden.

import { id, show, text } from "../dom.ts";
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
  for (const field of [...box, across, offset, thick]) field.addEventListener("input", () => apply(stage));
  id("unclip").addEventListener("click", () => set(stage, {}));
}

/** The offsets of sections reach this far from the centre, metres. */
export function setReach(reach_m: number): void {
  const most = Math.max(1, Math.ceil(1.2 * reach_m));
  offset.min = String(-most);
  offset.max = String(most);
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
  if (section !== undefined) [offset.value, thick.value] = [String(section.offset_m), String(section.thick_m)];
  apply(stage);
}

function apply(stage: Stage): void {
  const { box: limits = [], section } = state();
  stage.setBox(limits.slice(0, 3).map((m) => m ?? -ANY_M), limits.slice(3).map((m) => m ?? ANY_M));
  stage.setSection(["x", "y", "z"].map((axis) => (axis === section?.across ? 1 : 0)), section?.offset_m ?? 0, section === undefined ? ANY_M : section.thick_m / 2);
  show(id("section-fields"), section !== undefined);
  text(id("section-at"), section === undefined ? "" : `at ${section.across} = ${fixed(section.offset_m, 2)} m`);
  text(id("clipped"), limits.some((m) => m !== null) || section !== undefined ? "parts hidden" : "");
}
