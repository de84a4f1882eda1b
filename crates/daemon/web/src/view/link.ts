// The view as text behind the # of an address. Values that are as at the start are left out.

import type { Field } from "../sample.ts";
import type { MapName } from "./maps.ts";

export interface ViewState {
  /** Id of the scan or file. */
  scan?: string;
  /** Azimuth and elevation of the camera, radians; its distance and its target's place, metres. */
  camera?: [number, number, number, number, number, number];
  parallel?: boolean;
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

/** Four decimals: 0.1 mm, and 0.006 degrees. */
const number = (value: number | null) => (value === null ? "" : String(Number(value.toFixed(4))));

export function toHash(state: ViewState): string {
  const parts = new URLSearchParams();
  if (state.scan !== undefined) parts.set("scan", state.scan);
  if (state.camera !== undefined) parts.set("camera", state.camera.map(number).join(","));
  if (state.parallel === true) parts.set("parallel", "1");
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
  if (parts.get("parallel") === "1") state.parallel = true;
  const field = parts.get("field");
  if (field !== null && ["height", "range", "intensity", "ring", "time", "sd"].includes(field)) state.field = field as Field;
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
