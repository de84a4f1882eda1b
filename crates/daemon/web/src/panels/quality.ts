// How far the scan in view can be trusted: losses and residuals, and on request density, gaps, ranges and errors.

import type { Residuals, Scan, ScanStatistics, Status } from "../api.ts";
import { attribute, h, id, show, text } from "../dom.ts";
import { compact, count, digits, fixed } from "../format.ts";
import { title } from "../found.ts";
import { refused } from "./control.ts";
import { type Fact, facts, residuals } from "./facts.ts";
import { announce } from "./messages.ts";
import { hasCloud } from "./scan_parts.ts";
import * as sphere from "../view/density_sphere.ts";
import { bar, table } from "../view/maps.ts";

const button = id<HTMLButtonElement>("measure");
const distance = id<HTMLSelectElement>("budget-at");
/** What the daemon measured, by scan. */
const known = new Map<string, ScanStatistics>();
let scan: Scan | null = null;
/** Id of the scan that is being measured. */
let measuring: string | null = null;
let capturing = false;
const dark = matchMedia("(prefers-color-scheme: dark)");
/** Direction from which the view looks, radians. */
let camera = { azimuth: 0, elevation: 0 };
let sphere_seen = false;
let request: (id: string) => Promise<ScanStatistics>;

/** `ask` requests the statistics of a scan. */
export function wire(ask: (id: string) => Promise<ScanStatistics>): void {
  request = ask;
  button.addEventListener("click", () => void measure());
  distance.addEventListener("change", draw);
  dark.addEventListener("change", draw);
  // It is drawn where it is seen: the view draws often.
  new IntersectionObserver((entries) => {
    sphere_seen = entries.at(-1)?.isIntersecting === true;
    draw_sphere();
  }).observe(id("sphere"));
}

/** Turns the sphere with the view; angles of the camera in radians. */
export function turn(azimuth: number, elevation: number): void {
  if (azimuth === camera.azimuth && elevation === camera.elevation) return;
  camera = { azimuth, elevation };
  draw_sphere();
}

/** Shows a scan with its report; null for none, or one that is not finished. */
export function setScan(now: Scan | null): void {
  scan = now !== null && hasCloud(now) ? now : null;
  show(id("quality-error"), false);
  draw();
}

/** Forgets a deleted scan. */
export function forget(name: string): void {
  known.delete(name);
}

export function setStatus({ activity }: Status): void {
  const now = activity.doing === "capturing";
  if (now === capturing) return;
  capturing = now;
  draw();
}

async function measure(): Promise<void> {
  const wanted = scan;
  if (wanted === null || measuring !== null) return;
  measuring = wanted.id;
  show(id("quality-error"), false);
  draw();
  try {
    known.set(wanted.id, await request(wanted.id));
    announce(`Density, gaps and errors of ${title(wanted)} are measured`);
  } catch (error) {
    refused(`Measure ${title(wanted)}`, error, id("quality-error"));
  } finally {
    measuring = null;
    draw();
  }
}

function draw(): void {
  show(id("quality"), scan !== null);
  if (scan === null) return;
  facts(id("quality-facts"), residuals(scan));
  const found = known.get(scan.id);
  show(button, found === undefined);
  button.disabled = capturing || measuring !== null;
  text(id("measure-why"), capturing ? "Not while a scan runs: it needs this machine." : "");
  show(id("measuring"), measuring === scan.id);
  show(id("measured"), found !== undefined);
  if (found !== undefined) draw_measured(found);
}

function draw_measured(found: ScanStatistics): void {
  const { density, gap_deg: gap, sd_mm: sd } = found;
  const where = found.of === "view" ? "in the field of view" : "on the sphere";
  const rows: Fact[] = [
    [`Bins of 3\u00b0 ${where}`, `${count(density.bins)} of 5,120`],
    ["Points per bin", `${digits(density.mean)} \u00b1 ${digits(density.sd)}`],
    ["Without a point", density.empty === 0 ? "none" : `${count(density.empty)} ${density.empty === 1 ? "bin" : "bins"}`, density.empty === 0 ? "off" : "warn"],
    ["Gap, half of directions", `${digits(gap.p50)}\u00b0`],
    ["Gap, 99 %", `${digits(gap.p99)}\u00b0`],
    ["Largest gap", `${digits(gap.worst)}\u00b0`],
  ];
  rows.push(...(sd == null ? [["Stated sd", "none"] as Fact] : [["Stated sd, half of points", `${digits(sd.p50, 2)} mm`] as Fact, ["Stated sd, 99 %", `${digits(sd.p99, 2)} mm`] as Fact]));
  facts(id("measured-facts"), rows);
  draw_sphere();
  describe_sphere(found);
  draw_ranges(found);
  draw_residuals("delays", found.residuals, "delay_us", "most_delay_us", " \u00b5s", 1);
  draw_residuals("deviations", found.residuals, "angle_rms_deg", "most_angle_deg", "\u00b0", 1e-4);
  const { budget: all = [] } = found;
  const at = all.map(({ at_m }) => String(at_m));
  if ([...distance.options].map(({ value }) => value).join() !== at.join()) {
    const before = distance.value;
    distance.replaceChildren(...at.map((m) => h("option", { value: m }, `${m} m`)));
    distance.value = at.includes(before) ? before : (at.find((m) => Number(m) === 20) ?? at[0] ?? "");
  }
  const budget = all.find(({ at_m }) => String(at_m) === distance.value)?.error_mm;
  show(id("budget"), budget !== undefined);
  if (budget === undefined) return;
  const mm = (value: number) => `${digits(value, 2)} mm`;
  facts(id("budget-facts"), [
    ["Range", mm(Math.hypot(budget.range, budget.range_step))], ["Azimuth", mm(budget.azimuth)], ["Tilt", mm(budget.tilt)], ["Clock", mm(budget.clock)], ["Delay", mm(budget.delay)],
    ["Mount", budget.mount === null ? "not included" : mm(budget.mount), budget.mount === null ? "warn" : "off"], ["95 % of points within", mm(budget.total)],
  ]);
}

function draw_sphere(): void {
  const bins = scan === null ? undefined : known.get(scan.id)?.bins;
  if (bins === undefined || !sphere_seen) return;
  sphere.draw(id<HTMLCanvasElement>("sphere"), bins, camera.azimuth, camera.elevation, table("viridis", dark.matches));
}

/** Its colours, and the bin with the fewest points. */
function describe_sphere({ bins }: ScanStatistics): void {
  bar(id<HTMLCanvasElement>("sphere-bar"), table("viridis", dark.matches));
  ends("sphere", ["0", `${compact(sphere.limit(bins))} or more`]);
  const fewest = bins.reduce<sphere.Bin | null>((a, b) => (a === null || b.points < a.points ? b : a), null);
  const [x, y, z] = fewest?.direction ?? [0, 0, 0];
  const degrees = (radians: number, [positive, negative]: [string, string]) => `${fixed(Math.abs((180 / Math.PI) * radians), 0)}\u00b0 ${radians < 0 ? negative : positive}`;
  text(id("sphere-words"), fewest === null ? "" : `Fewest: ${fewest.points === 0 ? "none" : count(fewest.points)} at ${degrees(Math.atan2(x, y), ["right of forward", "left of forward"])}, ${degrees(Math.asin(z), ["up", "down"])}.`);
}

/** Bars of residuals over time, the greatest behind the usual ones, their heights by the logarithm; and both in words. `least` is the least value that counts. */
function draw_residuals(name: "delays" | "deviations", all: Residuals[], usual: "delay_us" | "angle_rms_deg", most: "most_delay_us" | "most_angle_deg", unit: string, least: number): void {
  const greatest = all.reduce<Residuals | null>((a, b) => ((b[most] ?? -Infinity) > (a?.[most] ?? -Infinity) ? b : a), null);
  const sorted = all.flatMap((one) => one[usual] ?? []).sort((a, b) => a - b);
  const middle = sorted[Math.floor(sorted.length / 2)];
  const high = (value: number) => Math.log1p(Math.max(0, value) / Math.max(least, middle ?? 0));
  const scale = 38 / Math.max(1e-6, high(greatest?.[most] ?? 0));
  const width = 120 / Math.max(1, all.length);
  const bars = (key: typeof usual | typeof most) => all.map((one, i) => `M${(i * width).toFixed(2)} 40v${(-scale * high(one[key] ?? 0)).toFixed(2)}h${width.toFixed(2)}V40z`).join("");
  [most, usual].forEach((key, i) => attribute(id(name).children[i] as Element, "d", bars(key)));
  ends(name, all.length === 0 || greatest === null ? [] : [`${(all[0]?.at_s ?? 0).toFixed(1)} s`, `to ${digits(greatest[most] ?? 0, 2)}${unit}`, `${(all.at(-1)?.at_s ?? 0).toFixed(1)} s`]);
  text(id(`${name}-words`), middle === undefined || greatest === null ? "none" : `usually ${digits(middle, 2)}${unit}, at most ${digits(greatest[most] ?? 0, 2)}${unit} near ${greatest.at_s.toFixed(2)} s`);
}

/** Writes below a plot where its axis begins, what its height is, and where it ends. */
function ends(name: string, words: string[]): void {
  id(`${name}-axis`).replaceChildren(...words.map((one) => h("span", {}, one)));
}

/** Bars of the points by range, and their middle in words. */
function draw_ranges({ ranges, points }: ScanStatistics): void {
  const most = Math.max(1, ...ranges.map((one) => one.points));
  const width = 120 / Math.max(1, ranges.length);
  const last_bin = ranges.at(-1);
  const bars = ranges.map((one, i) => `M${(i * width).toFixed(2)} 40v${(-38 * one.points / most).toFixed(2)}h${(0.9 * width).toFixed(2)}V40z`);
  attribute(id("ranges").firstElementChild as Element, "d", bars.join(""));
  const [first, last] = [ranges.find((one) => one.points > 0), ranges.at(-1)];
  let below = 0;
  const middle = ranges.find((one) => (below += one.points) >= points / 2);
  ends("ranges", ranges.length === 0 ? [] : [`${digits(ranges[0]?.from_m ?? 0)} m`, `at most ${compact(most)} points in ${digits((last_bin?.to_m ?? 0) - (last_bin?.from_m ?? 0))} m`, `${digits(last_bin?.to_m ?? 0)} m`]);
  text(id("ranges-words"), first === undefined || last === undefined || middle === undefined ? "" : `${digits(first.from_m)} to ${digits(last.to_m)} m, half of the points within ${digits(middle.to_m)} m`);
}
