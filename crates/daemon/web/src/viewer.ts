// The view: its cloud, colours, tools and legend. view/ draws it.

import { attribute, id, show, text } from "./dom.ts";
import { MOST_M } from "./distance.ts";
import * as fields from "./fields.ts";
import { count, digits, fixed, length, mm } from "./format.ts";
import { COLUMNS, type Columns, type Frame } from "./frame.ts";
import * as clip from "./panels/clip.ts";
import { announce } from "./panels/messages.ts";
import * as picked from "./panels/picks.ts";
import { Player } from "./panels/player.ts";
import type { Picked, Position } from "./picked.ts";
import * as picture from "./picture.ts";
import { type Field, type Range, type Ranges, tiltAt } from "./sample.ts";
import { Live, Loaded, draw } from "./view/cloud.ts";
import { SIZE_PX, type ViewState, fromHash, toHash } from "./view/link.ts";
import { scaleBar } from "./view/measure.ts";
import { type MapName, MARKS, bar, table } from "./view/maps.ts";
import { Overlay } from "./view/overlay.ts";
import { ALL_S, type Preset, RING_STEP_M, Stage } from "./view/stage.ts";
import type { LoadRequest, LoadEvent } from "./worker.ts";

const FIELDS: Field[] = ["height", "range", "intensity", "ring", "time", "sd", "distance"];
const NOTES: Record<Field, string> = {
  height: "z", range: "from the origin", intensity: "as stored", ring: "0 is the lowest", time: "since the first point", sd: "expected error, RMS", distance: "to the nearest point",
};
/** Phones have less memory on the graphics card. */
const small = matchMedia("(max-width: 899px)");
const dark = matchMedia("(prefers-color-scheme: dark)");
const still = matchMedia("(prefers-reduced-motion: reduce)");
const NO_COLUMNS = Object.fromEntries(COLUMNS.map((name) => [name, false])) as picked.Known;

/** A cloud that can be shown. */
export interface CloudSource {
  id: string;
  title: string;
  simulated: boolean;
  /** Address of its PLY; complete with the columns that stored clouds lack. */
  url: (complete: boolean) => string;
  /** Whether it can be requested complete. */
  completes: boolean;
  /** Whether a part of the scan is missing. */
  partial: boolean;
  /** Whether the origin is on velomotion's tilt axis. */
  scanner: boolean;
  /** Whether it plays once it is loaded. */
  plays: boolean;
}

export class Viewer {
  /** Id of the scan in view, finished or running. */
  shown: string | null = null;
  /** Called when the user leaves the full screen with the browser's own key. */
  left_full_screen: () => void = () => {};
  /** Called with the direction of the camera from its target, radians, after each picture. */
  turned: (azimuth: number, elevation: number) => void = () => {};
  /** Called when the user puts another link into the page's address. */
  relinked: () => void = () => {};
  private readonly stage: Stage;
  private readonly overlay = new Overlay(document.querySelector("#overlay") as SVGSVGElement);
  private readonly player: Player;
  private begun: string | null = null;
  private live: Live | null = null;
  private loaded: Loaded | null = null;
  private worker: Worker | null = null;
  private opened: CloudSource | null = null;
  /** The cloud with which the opened one is compared. */
  private other: CloudSource | null = null;
  private other_points: Loaded | null = null;
  /** What was loaded of the opened cloud. */
  private whole: (LoadEvent & { kind: "done" }) | null = null;
  private field: Field = "height";
  /** The field before the comparison. */
  private field_before: Field = "height";
  private map: MapName = "viridis";
  private ranges: Ranges | null = null;
  private origin: Position = [0, 0, 0];
  private known = NO_COLUMNS;
  private picks: Picked[] = [];
  /** Whether the complete cloud is shown or being loaded. */
  private complete = false;
  private fitted = false;
  private legend_ms = 0;
  /** The view of the page's address, until its scan is shown. */
  private linked: ViewState | null;
  /** The view of a link whose cloud is being loaded. */
  private following: ViewState | null = null;

  constructor(private readonly changed: (shown: string | null) => void) {
    const canvas = id<HTMLCanvasElement>("canvas");
    const linked = fromHash(location.hash);
    this.linked = Object.keys(linked).length > 0 ? linked : null;
    this.stage = new Stage(canvas);
    this.stage.detail = (eye, budget) => draw([this.loaded, this.other_points].filter((cloud) => cloud !== null), eye, budget);
    this.stage.drawn = () => {
      this.overlay.draw(this.stage, this.picks);
      this.turned(this.stage.orbit.pose.azimuth, this.stage.orbit.pose.elevation);
    };
    this.stage.orbit.tapped = (event) => {
      const { left, top } = canvas.getBoundingClientRect();
      this.pick(event.clientX - left, event.clientY - top, event.pointerType === "touch");
    };
    this.player = new Player((until_s) => this.until(until_s));
    canvas.addEventListener("webglcontextrestored", () => {
      if (this.opened !== null) this.open(this.opened, this.other);
    });
    canvas.addEventListener("keydown", (event) => {
      if (event.key === "0" || event.key === "Home") this.fit();
      else if (event.key === "Enter") this.pick(canvas.clientWidth / 2, canvas.clientHeight / 2, true);
      else if (event.key === "Delete" || event.key === "Backspace") this.unpick();
    });
    this.tools();
    dark.addEventListener("change", () => this.paint());
    this.paint();
  }

  /** Ids of the scan that the page's address names, and of the one with which it is compared. */
  get linked_scans(): { scan: string | null; other: string | null } {
    return { scan: this.linked?.scan ?? null, other: this.linked?.with ?? null };
  }

  /** Whether the points in view are those of a running scan, as far as the page knows. */
  get is_live(): boolean {
    return this.live !== null && this.opened === null;
  }

  /** Shows the live points of a new scan; `again` those from now on, after the user opened another scan. */
  begin(scan: string, title: string, simulated: boolean, again = false): void {
    // If the user opened another scan meanwhile, it stays in view.
    if (this.begun === scan && (!again || this.is_live)) return;
    this.begun = scan;
    this.clear();
    this.following = null;
    this.shown = scan;
    this.live = new Live(this.stage.points, small.matches ? 1_500_000 : 6_000_000);
    this.stage.scene.add(this.live.group);
    this.stage.setScanner(true);
    this.head(`Live: ${title}`, simulated);
    this.describe(0, "");
    this.changed(scan);
  }

  /** A scan in view ended without a cloud: its live points stay in view. */
  ended(scan: string, title: string, simulated: boolean): void {
    if (this.live === null || this.live.count === 0) return this.forget(scan);
    this.head(`${title}: no cloud, live points only`, simulated);
  }

  /** Adds live points; the daemon sends every `thin`th. */
  frame(frame: Frame, thin: number): void {
    this.setTilt(frame.tilt_deg);
    const live = this.live;
    if (live === null) return;
    this.learn(frame);
    live.add(frame, frame.start_s);
    this.describe(live.received, [thin > 1 ? `every ${thin}th point` : "", live.count < live.received ? `${count(live.count)} drawn` : "", frame.left_out > 0 ? `${count(frame.left_out)} records not shown live, but recorded` : ""].filter(Boolean).join("; "));
    const now_ms = performance.now();
    if (now_ms - this.legend_ms > 250) {
      this.legend_ms = now_ms;
      this.range(live.ranges);
    }
    this.stage.draw();
  }

  /** Shows the platform's tilt now, unless a scan plays: it has its own. */
  setTilt(tilt_deg: number): void {
    if (this.player.until_s === null) this.stage.setTilt(tilt_deg);
  }

  /**
   * Shows a finished cloud; with another one, coloured by the distance from that. Live points of the same scan stay in
   * view until the cloud is loaded, and points that are picked stay.
   */
  open(source: CloudSource, other: CloudSource | null = null, complete = false): void {
    const follows = this.live !== null && this.shown === source.id && other === null;
    const again = this.shown === source.id;
    // A link whose cloud is loaded again is still followed.
    const linked = this.take_link(source.id) ?? (again ? this.following : null);
    this.following = linked;
    const kept = again && linked === null ? this.picks : [];
    const picked = linked?.picks ?? kept.map((pick) => this.own(pick.position));
    const origin = this.origin;
    // A comparison that is loaded again keeps its colours.
    const field = other !== null && other === this.other ? this.field : "distance";
    if (follows) this.worker?.terminate();
    else this.clear();
    if (other !== null) this.compare(other, field);
    this.shown = source.id;
    this.opened = source;
    if (!again) this.fitted = false;
    this.stage.setScanner(source.scanner);
    this.stage.uniform("cutaway", source.scanner && id<HTMLInputElement>("cutaway").checked);
    this.head(this.title, source.simulated || other?.simulated === true);
    show(id("view-partial"), source.partial || other?.partial === true);
    if (other !== null) {
      text(id("view-points"), "");
      this.colour();
    }
    text(id("view-note"), follows ? "live points; the cloud is loading" : other !== null ? `loading ${other.title}` : "");
    this.complete = source.completes && (complete || linked?.complete === true || this.field === "sd");
    this.picks = kept;
    if (again) this.origin = origin;
    this.show_picks();
    this.download(source, follows, picked, linked);
    this.changed(source.id);
  }

  /** Shows the new name of the scan in view. */
  rename(scan: string, title: string): void {
    const renamed = [this.opened, this.other].find((source) => source?.id === scan) ?? null;
    if (renamed === null) return;
    renamed.title = title;
    text(id("view-title"), this.title);
    if (this.whole !== null) this.describe_whole(this.whole);
    this.colour();
  }

  /** Removes a deleted scan from the view. */
  forget(scan: string): void {
    if (this.shown !== scan) return;
    this.clear();
    this.shown = null;
    this.opened = null;
    text(id("view-title"), "Point cloud");
    text(id("view-points"), "");
    text(id("view-note"), "");
    show(id("view-simulated"), false);
    show(id("view-empty"), true);
    show(id("legend"), false);
    this.changed(null);
    this.stage.draw();
  }

  private get title(): string {
    return [this.opened, this.other].flatMap((source) => source?.title ?? []).join(" compared with ");
  }

  /** Begins or ends a comparison. */
  private compare(other: CloudSource | null, field: Field): void {
    this.other = other;
    const option = document.querySelector("#field [value=distance]") as HTMLOptionElement;
    option.hidden = option.disabled = other === null;
    show(id("both-clouds-row"), other !== null);
    if (field === "distance" && this.field !== "distance") this.field_before = this.field;
    if (field === this.field) return;
    this.field = id<HTMLSelectElement>("field").value = field;
    for (const limit of ["limit-low", "limit-high"]) id<HTMLInputElement>(limit).value = "";
    fields.report(id("tools"));
  }

  private show_both(): void {
    if (this.other_points === null) return;
    this.other_points.group.visible = id<HTMLInputElement>("both-clouds").checked;
    this.stage.draw();
  }

  /** A position in the coordinates of the cloud. */
  private own(position: Position): Position {
    return position.map((m, axis) => m + (this.origin[axis] ?? 0)) as Position;
  }

  /** Loads a cloud; `picked` are points whose values are read anew. */
  private download(source: CloudSource, follows: boolean, picked: Position[], linked: ViewState | null): void {
    const kept = this.picks;
    const worker = new Worker("worker.js", { type: "module" });
    const cloud = new Loaded(this.stage.points);
    this.worker = worker;
    const progress = id<HTMLProgressElement>("view-progress");
    progress.removeAttribute("value");
    show(progress, true);
    if (!follows) this.swap(cloud);
    const { other } = this;
    const other_points = other === null ? null : new Loaded(this.stage.plain);
    this.other_points = other_points;
    worker.onmessage = ({ data }: MessageEvent<LoadEvent>) => {
      if (worker !== this.worker) return;
      if (data.kind === "other") {
        for (const part of data.parts) other_points?.add(part, null);
        attribute(progress, "value", String(data.read / Math.max(1, 2 * data.total)));
      } else if (data.kind === "points") {
        for (const part of data.parts) {
          this.learn(part);
          cloud.add(part, data.ranges);
        }
        const share = data.read / Math.max(1, data.total);
        attribute(progress, "value", String(other === null ? share : (1 + share) / 2));
        if (this.loaded !== cloud) return;
        this.origin = data.origin;
        this.describe(data.read, `of ${count(data.total)}`);
        this.range(data.ranges);
        this.stage.animate();
      } else {
        show(progress, false);
        worker.terminate();
        if (data.kind === "failed") return this.failed(data.error);
        this.swap(cloud);
        this.origin = data.origin;
        if (data.simulated) show(id("view-simulated"), true);
        this.range(cloud.ranges);
        // Those of a link, unless the user has picked others meanwhile.
        if (kept.length === 0 && this.picks.length === 0) this.picks = data.picked.filter((pick) => pick !== null);
        // One that is not found in the new cloud would keep values of the old one.
        this.picks = this.picks.flatMap((pick) => (kept.includes(pick) ? (data.picked[kept.indexOf(pick)] ?? []) : pick));
        this.whole = data;
        this.show_picks();
        this.describe_whole(data);
        if (data.other !== null && other_points !== null) {
          const from = data.other.origin;
          other_points.group.position.fromArray(from.map((m, axis) => m - (data.origin[axis] ?? 0)));
          this.stage.other.add(other_points.group);
          this.show_both();
          announce(`${this.title}: ${id("view-note").textContent ?? ""}`);
        }
        this.player.setEnd(this.ranges?.end_s ?? 0);
        this.following = null;
        if (linked !== null) this.follow(linked);
        this.stage.draw();
        if (source.plays && other === null && !still.matches && this.player.until_s === null) this.player.play();
      }
    };
    worker.onerror = () => this.failed("the cloud cannot be read");
    const order: LoadRequest = {
      url: new URL(source.url(this.complete), location.href).href, most: small.matches ? 3_000_000 : 24_000_000, picked,
    };
    if (other !== null) order.other = new URL(other.url(false), location.href).href;
    worker.postMessage(order);
  }

  private describe_whole(whole: LoadEvent & { kind: "done" }): void {
    this.describe(whole.total, [this.distance_note(whole), whole.every > 1 ? `every ${whole.every}th drawn` : ""].filter(Boolean).join("; "));
  }

  /** How far the points are from the other cloud; empty without a comparison. */
  private distance_note({ other, beyond, total }: LoadEvent & { kind: "done" }): string {
    const within_m = this.ranges?.within_m ?? null;
    if (this.other === null || other === null || within_m === null) return "";
    const { title } = this.other;
    const parts = ([["50", within_m.p50], ["95", within_m.p95]] as const).filter(([, m]) => m < MOST_M).map(([share, m]) => `${share} % within ${length(m)}`);
    const none = beyond > 0 ? `${digits((100 * beyond) / total, 2)} % without a point ${parts.length > 0 ? "" : `of ${title} `}within ${length(MOST_M)}` : "";
    return [parts.length > 0 ? `${parts.join(", ")} of ${title}` : "", none, other.every > 1 ? `compared with every ${other.every}th point` : ""].filter(Boolean).join("; ");
  }

  private swap(cloud: Loaded): void {
    if (this.loaded === cloud) return;
    this.live?.dispose();
    this.live = null;
    this.loaded?.dispose();
    this.loaded = cloud;
    this.stage.scene.add(cloud.group);
  }

  private failed(error: string): void {
    show(id("view-progress"), false);
    this.complete = false;
    // Opening it again must not ask for the column that the daemon could not add.
    if (this.field === "sd" && this.whole === null) id<HTMLSelectElement>("field").value = this.field = "height";
    // What is left of them is of two clouds.
    if (this.live === null) this.unpick();
    if (this.live !== null) return text(id("view-note"), error);
    if (this.other !== null) text(id("view-note"), "");
    text(id("view-failed"), error);
    show(id("view-failed"), true);
  }

  private clear(): void {
    this.worker?.terminate();
    this.worker = null;
    this.live?.dispose();
    this.live = null;
    this.loaded?.dispose();
    this.loaded = null;
    this.other_points?.dispose();
    this.other_points = null;
    this.compare(null, this.field === "distance" ? this.field_before : this.field);
    this.opened = null;
    this.complete = false;
    this.whole = null;
    this.ranges = null;
    this.origin = [0, 0, 0];
    this.unpick();
    this.player.reset();
    this.player.setEnd(0);
    show(id("view-progress"), false);
    show(id("view-failed"), false);
    show(id("view-partial"), false);
    if (!this.stage.orbit.touched) this.fitted = false;
  }

  private head(title: string, simulated: boolean): void {
    text(id("view-title"), title);
    show(id("view-simulated"), simulated);
    show(id("view-empty"), false);
  }

  private describe(points: number, more: string): void {
    text(id("view-points"), `${count(points)} points`);
    text(id("view-note"), more);
  }

  /** Remembers which columns the points have. */
  private learn(columns: Columns): void {
    this.known = Object.fromEntries(COLUMNS.map((name) => [name, columns[name].length > 0])) as picked.Known;
  }

  private range(ranges: Ranges | null): void {
    if (ranges === null) return;
    const wider = this.ranges === null || ranges.reach_m > 1.3 * this.ranges.reach_m;
    this.ranges = { ...ranges, reach_m: Math.max(ranges.reach_m, this.ranges?.reach_m ?? 0) };
    clip.setFrame(this.stage, this.origin, this.ranges.centre, this.ranges.reach_m);
    if (!this.fitted || (wider && !this.stage.orbit.touched)) {
      this.fitted = true;
      this.fit();
    }
    this.colour();
  }

  private fit(from: Preset = "usual"): void {
    this.stage.fit(this.ranges?.reach_m ?? 15, this.ranges?.centre ?? [0, 0, 0], from);
  }

  /** Shows the points up to a time, and the platform's tilt then. */
  private until(until_s: number | null): void {
    this.stage.uniform("until_s", until_s ?? ALL_S);
    if (until_s === null || this.ranges === null) return;
    const tilt_deg = tiltAt(this.ranges.track, until_s);
    if (tilt_deg !== null) this.stage.setTilt(tilt_deg);
    this.stage.animate();
  }

  /** Picks the point at a place; a third one begins anew. */
  private pick(x: number, y: number, touch: boolean): void {
    const found = this.stage.pickAt(x, y, touch);
    if (found === null) return announce("No point there");
    found.complete = this.known.lasers;
    this.picks = this.picks.length === 1 ? [...this.picks, found] : [found];
    this.show_picks();
    announce(id("picked").textContent ?? "");
  }

  private unpick(): void {
    this.picks = [];
    this.show_picks();
  }

  private show_picks(): void {
    const { opened, other } = this;
    const load = () => {
      if (opened !== null) this.open(opened, other, true);
    };
    picked.draw(this.picks, this.known, this.origin, {
      clear: () => {
        this.unpick();
        id("canvas").focus();
      },
      load: opened?.completes !== true ? null : this.complete ? "loading" : load,
    });
    this.stage.draw();
  }

  /** Limits of the colours that the user gave; null where automatic. */
  private get limits(): [number | null, number | null] {
    return [clip.limit(id<HTMLInputElement>("limit-low")), clip.limit(id<HTMLInputElement>("limit-high"))];
  }

  /** Updates range and legend of the selected field. */
  private colour(): void {
    const range = this.ranges?.[this.field] ?? null;
    const legend = id("legend");
    show(legend, this.ranges !== null);
    if (this.ranges === null) return;
    const [low, high] = this.limits;
    const scale = this.field === "sd" || this.field === "distance" ? 1e-3 : 1;
    // Heights that people read and type are the cloud's own.
    const shift = this.field === "height" ? this.origin[2] : 0;
    const automatic: Range = range ?? { low: 0, high: 1 };
    const of = { low: low === null ? automatic.low : scale * low - shift, high: high === null ? automatic.high : scale * high - shift };
    this.stage.setField(FIELDS.indexOf(this.field), of.high > of.low ? of : { low: of.low, high: of.low + 1e-6 });
    this.stage.setMarks([low === null ? null : MARKS[0], high === null ? null : MARKS[1]]);
    const note = this.field === "distance" ? `${NOTES.distance} of ${this.other?.title ?? ""}, gaps between its lines included` : this.field === "range" && this.origin.some((m) => m !== 0) ? `from ${this.origin.join(", ")} m` : NOTES[this.field];
    text(id("legend-note"), `${note} \u00b7 rings ${RING_STEP_M} m apart`);
    this.stage.uniform("ceiling_m", this.ranges.ceiling_m ?? 1e6);
    const words = (value: number) => {
      if (range === null) return "";
      switch (this.field) {
        case "height": case "range": return `${fixed(value + shift, of.high - of.low < 0.1 ? 3 : of.high - of.low < 2 ? 2 : 1)} m`;
        case "intensity": return digits(value);
        case "ring": return Number.isInteger(value) ? fixed(value, 0) : "";
        case "time": return `${digits(value)} s`;
        case "sd": return mm(value);
        case "distance": return of.high < 0.1 ? mm(value) : `${digits(value, 2)} m`;
      }
    };
    text(id("limits-unit"), { height: "m", range: "m", intensity: "", ring: "", time: "s", sd: "mm", distance: "mm" }[this.field]);
    text(id("legend-low"), range === null ? "not in this cloud" : words(of.low));
    text(id("legend-middle"), words((of.low + of.high) / 2));
    text(id("legend-high"), words(of.high));
    show(id("legend-below"), low !== null);
    text(id("legend-below"), `below ${words(of.low)}`);
    show(id("legend-above"), high !== null);
    text(id("legend-above"), `above ${words(of.high)}`);
  }

  /** Applies the colours of the theme and of the selected map. */
  private paint(): void {
    const night = dark.matches;
    const colours = table(this.map, night);
    this.stage.setColours(colours);
    if (night) this.stage.setBackground([0.043, 0.063, 0.086], [0.13, 0.18, 0.23], [0.55, 0.64, 0.73], [0.49, 0.77, 1]);
    else this.stage.setBackground([0.933, 0.949, 0.965], [0.76, 0.8, 0.84], [0.3, 0.36, 0.42], [0.04, 0.35, 0.66]);
    bar(id<HTMLCanvasElement>("legend-bar"), colours);
    this.colour();
  }

  private choose_field(field: Field): void {
    this.field = field;
    // Stored clouds mostly lack that column; the daemon adds it on request.
    if (field === "sd" && this.ranges !== null && this.ranges.sd === null && this.opened?.completes === true) this.open(this.opened, this.other);
    this.colour();
  }

  /** The view as it is now. */
  private state(): ViewState {
    const { azimuth, elevation, distance_m } = this.stage.orbit.pose;
    const [x, y, z] = this.stage.orbit.target.toArray();
    const until_s = this.player.until_s;
    const on = (name: string) => id<HTMLInputElement>(name).checked;
    return {
      ...(this.shown === null ? {} : { scan: this.shown }), ...(this.other === null ? {} : { with: this.other.id, both: on("both-clouds") }),
      camera: [azimuth, elevation, distance_m, x, y, z], parallel: on("parallel"), complete: this.complete, picks: this.picks.map((pick) => this.own(pick.position)),
      size: Number(id<HTMLInputElement>("size").value), shading: on("shading"), cutaway: on("cutaway"), field: this.field, limits: this.limits, map: this.map, ...clip.state(), ...(until_s === null ? {} : { until_s }),
    };
  }

  /** The view of the page's address, if it is of this scan or of any. */
  private take_link(scan: string): ViewState | null {
    const state = this.linked;
    if (state === null || (state.scan ?? scan) !== scan) return null;
    this.linked = null;
    return state;
  }

  /** Forgets the page's address, whose scan is not there. */
  forget_link(): void {
    this.linked = null;
  }

  /** Shows the view of a link. */
  private follow(state: ViewState): void {
    const input = (name: string) => id<HTMLInputElement>(name);
    // As the user does.
    const changed = (name: string) => input(name).dispatchEvent(new Event(input(name).type === "checkbox" ? "change" : "input"));
    // What a link leaves out is as at the start.
    const boxes = { parallel: state.parallel ?? false, shading: state.shading ?? true, cutaway: state.cutaway ?? true, "both-clouds": state.both ?? false };
    for (const [name, on] of Object.entries(boxes)) {
      input(name).checked = on;
      changed(name);
    }
    input("size").value = String(state.size ?? SIZE_PX);
    changed("size");
    if (state.camera !== undefined) {
      const [azimuth, elevation, distance_m, ...target] = state.camera;
      this.stage.orbit.look(azimuth, elevation, distance_m, this.stage.orbit.target.clone().fromArray(target));
      this.stage.orbit.touched = true;
    }
    if (state.map !== undefined) id<HTMLSelectElement>("map").value = this.map = state.map;
    clip.set(this.stage, state);
    this.player.set(state.until_s ?? Number.POSITIVE_INFINITY);
    if (state.field !== undefined && (state.field !== "distance" || this.other !== null)) {
      (state.limits ?? [null, null]).forEach((limit, i) => {
        input(i === 0 ? "limit-low" : "limit-high").value = limit === null ? "" : String(limit);
      });
      id<HTMLSelectElement>("field").value = state.field;
      this.choose_field(state.field);
    }
    this.paint();
  }

  private tools(): void {
    const field = id<HTMLSelectElement>("field");
    const limits = ["limit-low", "limit-high"].map((name) => id<HTMLInputElement>(name));
    field.addEventListener("change", () => {
      for (const limit of limits) limit.value = "";
      fields.report(id("tools"));
      this.choose_field(field.value as Field);
    });
    for (const limit of limits) limit.addEventListener("input", () => this.colour());
    const map = id<HTMLSelectElement>("map");
    map.addEventListener("change", () => {
      this.map = map.value as MapName;
      this.paint();
    });
    const size = id<HTMLInputElement>("size");
    const resize = () => this.stage.uniform("size", Number(size.value) * Math.min(devicePixelRatio, 2));
    size.addEventListener("input", resize);
    resize();
    const check = (name: string, set: (on: boolean) => void) => {
      const box = id<HTMLInputElement>(name);
      box.addEventListener("change", () => set(box.checked));
    };
    check("cutaway", (on) => this.stage.uniform("cutaway", on && this.opened?.scanner !== false));
    check("shading", (on) => this.stage.setShading(on));
    check("both-clouds", () => this.show_both());
    id("swap").addEventListener("click", () => {
      const { opened, other } = this;
      if (opened !== null && other !== null) this.open(other, opened);
    });
    check("parallel", (on) => this.stage.orbit.setParallel(on));
    id("fit").addEventListener("click", () => this.fit());
    for (const preset of ["top", "front", "side", "scanner"] as const) id(preset).addEventListener("click", () => this.fit(preset));
    clip.wire(this.stage);
    fields.watch(id("tools"));
    id("picture").addEventListener("click", () => void this.save_picture());
    id("link").addEventListener("click", () => void this.copy_link());
    id("large").addEventListener("click", () => this.enlarge(!document.body.classList.contains("large")));
    // A link that is pasted into the address of this page.
    addEventListener("hashchange", () => {
      const linked = fromHash(location.hash);
      if (Object.keys(linked).length === 0) return;
      this.linked = linked;
      if (linked.scan !== undefined) this.relinked();
      else if (this.opened !== null) this.open(this.opened, this.other);
    });
    document.addEventListener("fullscreenchange", () => {
      if (document.fullscreenElement !== null || !document.body.classList.contains("large")) return;
      this.enlarge(false);
      this.left_full_screen();
    });
  }

  /** The view on the whole screen, or in the whole window where the browser has no full screen. */
  private enlarge(on: boolean): void {
    document.body.classList.toggle("large", on);
    attribute(id("large"), "aria-pressed", String(on));
    text(id("large"), on ? "Leave full screen" : "Full screen");
    // A browser may refuse; the window is used then.
    if (on) void document.documentElement.requestFullscreen?.().catch(() => {});
    else if (document.fullscreenElement !== null) void document.exitFullscreen();
  }

  private async save_picture(): Promise<void> {
    const words = (name: string) => id(name).textContent ?? "";
    const simulated = id("view-simulated").hidden ? "" : "SIMULATED \u00b7 ";
    const title = words("view-title");
    const partial = id("view-partial").hidden ? "" : "PARTIAL \u00b7 ";
    const until = this.player.until_s === null ? "" : `only the points up to ${words("time-now")}`;
    const limits = ["legend-below", "legend-above"].filter((name) => !id(name).hidden).map(words);
    const lines = [`${simulated}${partial}${title}`, [words("view-points"), words("view-note"), until, words("view-clipped")].filter(Boolean).join(" \u00b7 "), [`coloured by ${id<HTMLSelectElement>("field").selectedOptions[0]?.text ?? ""}`, ...limits].join(" \u00b7 ")];
    if (this.picks.length === 2) lines.push(`A to B: ${document.querySelector("#picked .distance")?.textContent ?? ""}`);
    try {
      const points = this.stage.picture();
      await picture.save(points, title, {
        lines, legend: { low: words("legend-low"), high: words("legend-high") }, scale: scaleBar(this.stage.metres_per_px, 96, this.stage.orbit.parallel),
        picks: this.picks.map((pick) => this.stage.project(pick.position)),
      });
      this.told("Picture saved");
    } catch (error) {
      this.told(String(error));
    }
  }

  /** Puts the view into the page's address, and that on the clipboard. */
  private async copy_link(): Promise<void> {
    history.replaceState(null, "", toHash(this.state()));
    try {
      await navigator.clipboard.writeText(location.href);
      this.told("Link copied");
    } catch {
      this.told("The address of this page is now the link");
    }
  }

  private told(words: string): void {
    text(id("tool-done"), words);
    announce(words);
  }
}
