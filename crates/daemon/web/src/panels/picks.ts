// The values of picked points, and the distance of two.

import { MOST_M } from "../distance.ts";
import { h, id, show } from "../dom.ts";
import { count, digits, fixed, length, mm } from "../format.ts";
import type { Columns } from "../frame.ts";
import { distance } from "../view/measure.ts";
import type { Picked } from "../picked.ts";

/** The columns that a cloud has. */
export type Known = { [key in keyof Omit<Columns, "count" | "positions">]: boolean };

const box = id("picked");
/** Where the values would cover the view. */
const narrow = matchMedia("(max-width: 899px)");
/** Whether the user unfolded the values. */
let unfolded: boolean | null = null;
const ECHOES: Record<number, string> = { 1: "strongest", 2: "last", 3: "strongest and last", 4: "second return" };

export interface Actions {
  clear: () => void;
  /** Loads the columns that the cloud lacks; null if they cannot be had. */
  load: (() => void) | "loading" | null;
}

/** Shows up to two points; `origin` was subtracted from their positions. */
export function draw(picks: Picked[], known: Known, origin: [number, number, number], { clear, load }: Actions): void {
  show(box, picks.length > 0);
  if (picks.length === 0) return;
  const [a, b] = picks;
  const parts: (Node | string)[] = [];
  if (a !== undefined && b !== undefined) {
    const found = distance(a, b);
    const along = found.along_m.map((m) => fixed(m, 3)).join(", ");
    parts.push(
      h("p", { class: "distance" }, h("b", {}, `${found.m.toFixed(3)} m`), found.sd_m === null ? "" : ` \u00b1 ${mm(found.sd_m)}`),
      // Ranges are from the scanner, which is not in the coordinates of a map.
      origin.every((m) => m === 0) && apart(a, b) > found.m / 2 ? h("p", { class: "hint", "data-tone": "warn" }, `Point B is ${length(apart(a, b))} ${Math.hypot(...b.position) > Math.hypot(...a.position) ? "farther" : "nearer"} than A: look whether both are on what you measure.`) : "",
      h("p", { class: "hint" }, `${Math.hypot(found.along_m[0], found.along_m[1]).toFixed(3)} m in plan; x, y, z: ${along} m \u00b7 ${found.sd_m === null ? load === null ? "the cloud has no uncertainty" : "for its standard error, load uncertainty" : "\u00b1 is one standard deviation at most, from the errors of both points; not from where you point"}`),
    );
  }
  if (b === undefined) parts.push(h("p", { class: "hint" }, "Pick another point for the distance."));
  const values = h("details", { open: unfolded ?? !narrow.matches }, h("summary", {}, "Values"), table(picks, known, origin, load !== null)) as HTMLDetailsElement;
  values.addEventListener("toggle", () => { unfolded = values.open; });
  parts.push(values);
  if (load !== null && !known.lasers) {
    const loading = load === "loading";
    parts.push(h("button", { type: "button", id: "complete", disabled: loading, ...(loading ? {} : { click: load }) }, loading ? "Loading uncertainty, laser and return" : "Load uncertainty, laser and return"));
  }
  parts.push(h("button", { type: "button", id: "unpick", click: clear }, "Clear"));
  box.replaceChildren(...parts);
}

/** Difference of the distances of two points from the scanner, metres: large if one beam missed what the other met. */
const apart = (a: Picked, b: Picked): number => Math.abs(Math.hypot(...a.position) - Math.hypot(...b.position));

function table(picks: Picked[], known: Known, origin: [number, number, number], loads: boolean): HTMLElement {
  const absent = ({ complete }: Pick<Picked, "complete">) => (complete || !loads ? "not known" : "loading");
  const axis = (i: 0 | 1 | 2) => (pick: Picked) => `${fixed(pick.position[i] + origin[i], 3)} m`;
  const rows: [string, boolean, (pick: Picked) => string][] = [
    ["x", true, axis(0)],
    ["y", true, axis(1)],
    ["z", true, axis(2)],
    ["Range", origin.every((m) => m === 0), ({ position }) => `${Math.hypot(...position).toFixed(3)} m`],
    ["sd", known.sds, (pick) => (pick.sd_m > 0 ? mm(pick.sd_m) : absent(pick))],
    ["Time", known.times, ({ time_s }) => `${time_s.toFixed(4)} s`],
    ["Tilt", known.tilts, ({ tilt_deg }) => `${fixed(tilt_deg, 3)}\u00b0`],
    ["Ring", known.rings, ({ ring }) => count(ring)],
    ["Laser", known.lasers, ({ laser, complete }) => (complete ? count(laser) : "loading")],
    ["Intensity", known.intensities, ({ intensity }) => digits(intensity)],
    ["Return", known.echoes, ({ echo, complete }) => ECHOES[echo] ?? absent({ complete })],
    ["Distance", known.distances, ({ distance_m }) => (distance_m < MOST_M ? length(distance_m) : `over ${length(MOST_M)}`)],
  ];
  const head = h("tr", {}, h("td"), ...picks.map((_, i) => h("th", { scope: "col" }, `Point ${"AB"[i] ?? ""}`)));
  const body = rows.filter(([, shown]) => shown).map(([name, , value]) => h("tr", {}, h("th", { scope: "row" }, name), ...picks.map((pick) => h("td", {}, value(pick)))));
  return h("table", {}, h("thead", {}, head), h("tbody", {}, ...body));
}
