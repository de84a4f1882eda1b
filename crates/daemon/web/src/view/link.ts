// The view as text behind the # of an address. Values that are as at the start are left out.

import type { Position } from "../picked.ts";
import type { Field } from "../sample.ts";
import type { MapName } from "./maps.ts";

export interface ViewState {
  /** Id of the scan or file. */
  scan?: string;
  /** Id of the scan or file with which it is compared, and whether both are drawn. */
  with?: string;
  both?: boolean;
  /** Azimuth and elevation of the camera, radians; its distance and its target's place, metres. */
  camera?: [number, number, number, number, number, number];
  parallel?: boolean;
  /** Whether the cloud has all its columns. */
  complete?: boolean;
  /** Picked points, in the coordinates of the cloud, metres. */
  picks?: Position[];
  /** Size of the points, pixels. */
  size?: number;
  shading?: boolean;
  cutaway?: boolean;
  field?: Field;
  map?: MapName;
  /** Limits of the colours; null where automatic. */
  limits?: [number | null, number | null];
  /** Least x, y and z, then greatest; null without limit. */
  box?: (number | null)[];
  /** Section: its direction, offset and thickness, metres. */
  section?: { across: "x" | "y" | "z"; offset_m: number; thick_m: number };
  /** Points up to this time, seconds. */
  until_s?: number;
}

export const SIZE_PX = 1.5;
const MOST_PICKS = 2;
const FIELDS: Field[] = ["height", "range", "intensity", "ring", "time", "sd", "distance"];

/** Four decimals: 0.1 mm, and 0.006 degrees. */
const number = (value: number | null) => (value === null ? "" : String(Number(value.toFixed(4))));

export function toHash(state: ViewState): string {
  const parts = new URLSearchParams();
  if (state.scan !== undefined) parts.set("scan", state.scan);
  if (state.camera !== undefined) parts.set("camera", state.camera.map(number).join(","));
  if (state.with !== undefined) parts.set("with", state.with);
  for (const name of ["both", "parallel", "complete"] as const) if (state[name] === true) parts.set(name, "1");
  for (const name of ["shading", "cutaway"] as const) if (state[name] === false) parts.set(name, "0");
  if (state.size !== undefined && state.size !== SIZE_PX) parts.set("size", number(state.size));
  if (state.picks !== undefined && state.picks.length > 0) parts.set("picks", state.picks.flat().map(number).join(","));
  if (state.field !== undefined) parts.set("field", state.field);
  if (state.map !== undefined) parts.set("map", state.map);
  if (state.limits?.some((limit) => limit !== null)) parts.set("limits", state.limits.map(number).join(","));
  if (state.box?.some((limit) => limit !== null)) parts.set("box", state.box.map(number).join(","));
  const { section } = state;
  if (section !== undefined) parts.set("section", [section.across, number(section.offset_m), number(section.thick_m)].join(","));
  if (state.until_s !== undefined) parts.set("until", number(state.until_s));
  return `#${parts.toString().replaceAll("%2C", ",")}`;
}

/** Reads the text; what is not of its form is left out. */
export function fromHash(hash: string): ViewState {
  const parts = new URLSearchParams(hash.replace(/^#/, ""));
  const state: ViewState = {};
  const numbers = (name: string, count: number): (number | null)[] | null => {
    const words = parts.get(name)?.split(",");
    if (words?.length !== count) return null;
    const values = words.map((word) => (word === "" ? null : Number(word)));
    return values.every((value) => value === null || Number.isFinite(value)) ? values : null;
  };
  const scan = parts.get("scan");
  if (scan !== null) state.scan = scan;
  const camera = numbers("camera", 6);
  if (camera !== null && !camera.includes(null)) state.camera = camera as NonNullable<ViewState["camera"]>;
  const other = parts.get("with");
  if (other !== null) state.with = other;
  for (const name of ["both", "parallel", "complete"] as const) if (parts.get(name) === "1") state[name] = true;
  for (const name of ["shading", "cutaway"] as const) if (parts.get(name) === "0") state[name] = false;
  const size = numbers("size", 1)?.[0];
  if (typeof size === "number") state.size = size;
  for (let count = 1; count <= MOST_PICKS; count += 1) {
    const picks = numbers("picks", 3 * count);
    if (picks !== null && !picks.includes(null)) state.picks = Array.from({ length: count }, (_, i) => picks.slice(3 * i, 3 * i + 3) as Position);
  }
  const field = parts.get("field");
  // Distances are of a comparison.
  if (field !== null && FIELDS.includes(field as Field) && (field !== "distance" || other !== null)) state.field = field as Field;
  const map = parts.get("map");
  if (map !== null && ["viridis", "cividis", "grey"].includes(map)) state.map = map as MapName;
  const limits = numbers("limits", 2);
  if (limits !== null) state.limits = limits as [number | null, number | null];
  const box = numbers("box", 6);
  if (box !== null) state.box = box;
  const [across, offset, thick] = parts.get("section")?.split(",") ?? [];
  const [offset_m, thick_m] = [Number(offset), Number(thick)];
  if ((across === "x" || across === "y" || across === "z") && Number.isFinite(offset_m) && thick_m > 0) state.section = { across, offset_m, thick_m };
  const until = numbers("until", 1)?.[0];
  if (typeof until === "number") state.until_s = until;
  return state;
}
