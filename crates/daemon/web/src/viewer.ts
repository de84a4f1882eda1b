// The view: its cloud, colours, tools and legend. view/ draws it.

import { type Scan, cloudUrl } from "./api.ts";
import { attribute, id, show, text } from "./dom.ts";
import { count, digits, fixed } from "./format.ts";
import type { Frame } from "./frame.ts";
import type { Range, Ranges } from "./sample.ts";
import { Live, Loaded } from "./view/cloud.ts";
import { type MapName, css, table } from "./view/maps.ts";
import { RING_STEP_M, Stage } from "./view/stage.ts";
import type { LoadRequest, LoadEvent } from "./worker.ts";

type Field = "height" | "intensity" | "ring" | "time" | "sd";
const FIELDS: Field[] = ["height", "intensity", "ring", "time", "sd"];
const NOTES: Record<Field, string> = {
  height: "above the tilt axis", intensity: "calibrated by the lidar", ring: "0 is the lowest", time: "since the first point", sd: "expected error, RMS",
};
/** Phones have less memory on the graphics card. */
const small = matchMedia("(max-width: 899px)");
const dark = matchMedia("(prefers-color-scheme: dark)");

export class Viewer {
  /** The scan in view, finished or running. */
  shown: string | null = null;
  private readonly stage: Stage;
  private begun: string | null = null;
  private live: Live | null = null;
  private loaded: Loaded | null = null;
  private worker: Worker | null = null;
  private opened: Scan | null = null;
  private field: Field = "height";
  private map: MapName = "viridis";
  private ranges: Ranges | null = null;
  private fitted = false;
  private legend_ms = 0;

  constructor(private readonly changed: (shown: string | null) => void) {
    const canvas = id<HTMLCanvasElement>("canvas");
    this.stage = new Stage(canvas);
    this.stage.share = (share) => this.loaded?.share(share);
    canvas.addEventListener("webglcontextrestored", () => {
      if (this.opened !== null) this.open(this.opened);
    });
    canvas.addEventListener("keydown", (event) => {
      if (event.key === "0" || event.key === "Home") this.fit();
    });
    this.tools();
    dark.addEventListener("change", () => this.paint());
    this.paint();
  }

  /** Shows the live points of a new scan. */
  begin(scan: string, title: string, simulated: boolean): void {
    // If the user opened another scan meanwhile, it stays in view.
    if (this.begun === scan) return;
    this.begun = scan;
    this.clear();
    this.shown = scan;
    this.live = new Live(this.stage.points, small.matches ? 1_500_000 : 6_000_000);
    this.stage.scene.add(this.live.group);
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
    this.stage.setTilt(frame.tilt_deg);
    const live = this.live;
    if (live === null) return;
    live.add(frame, frame.start_s);
    this.describe(live.received, [thin > 1 ? `every ${thin}th point` : "", live.count < live.received ? `${count(live.count)} drawn` : "", frame.left_out > 0 ? `${count(frame.left_out)} records not shown live, but recorded` : ""].filter(Boolean).join("; "));
    const now_ms = performance.now();
    if (now_ms - this.legend_ms > 250) {
      this.legend_ms = now_ms;
      this.range(live.ranges);
    }
    this.stage.draw();
  }

  setTilt(tilt_deg: number): void {
    this.stage.setTilt(tilt_deg);
  }

  /** Shows a scan from the list. Live points of the same scan stay in view until the cloud is loaded. */
  open(scan: Scan): void {
    const follows = this.live !== null && this.shown === scan.id;
    const again = this.shown === scan.id;
    if (follows) this.worker?.terminate();
    else this.clear();
    this.shown = scan.id;
    this.opened = scan;
    if (!again) this.fitted = false;
    this.head(scan.name || scan.id, scan.simulated);
    text(id("view-note"), follows ? "live points; the cloud is loading" : "");
    this.download(scan, this.field === "sd", follows);
    this.changed(scan.id);
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

  private download(scan: Scan, uncertainty: boolean, follows: boolean): void {
    const worker = new Worker("worker.js", { type: "module" });
    const cloud = new Loaded(this.stage.points);
    this.worker = worker;
    const progress = id<HTMLProgressElement>("view-progress");
    progress.removeAttribute("value");
    show(progress, true);
    if (!follows) this.swap(cloud);
    worker.onmessage = ({ data }: MessageEvent<LoadEvent>) => {
      if (worker !== this.worker) return;
      if (data.kind === "points") {
        cloud.add(data.columns, data.ranges);
        attribute(progress, "value", String(data.read / Math.max(1, data.total)));
        if (this.loaded !== cloud) return;
        this.describe(data.read, `of ${count(data.total)}`);
        this.range(data.ranges);
        this.stage.draw();
      } else {
        show(progress, false);
        worker.terminate();
        if (data.kind === "failed") return this.failed(data.error);
        this.swap(cloud);
        this.range(cloud.ranges);
        this.describe(data.total, data.every > 1 ? `every ${data.every}th drawn` : "");
        this.stage.draw();
      }
    };
    worker.onerror = () => this.failed("the cloud cannot be read");
    const order: LoadRequest = { url: new URL(cloudUrl(scan.id, "ply", uncertainty), location.href).href, most: small.matches ? 3_000_000 : 12_000_000 };
    worker.postMessage(order);
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
    if (this.live !== null) return text(id("view-note"), error);
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
    this.opened = null;
    this.ranges = null;
    show(id("view-progress"), false);
    show(id("view-failed"), false);
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

  private range(ranges: Ranges | null): void {
    if (ranges === null) return;
    const wider = this.ranges === null || ranges.reach_m > 1.3 * this.ranges.reach_m;
    this.ranges = { ...ranges, reach_m: Math.max(ranges.reach_m, this.ranges?.reach_m ?? 0) };
    if (!this.fitted || (wider && !this.stage.orbit.touched)) {
      this.fitted = true;
      this.fit();
    }
    this.colour();
  }

  private fit(from: "usual" | "top" | "scanner" = "usual"): void {
    this.stage.fit(this.ranges?.reach_m ?? 15, from);
  }

  /** Updates range and legend of the selected field. */
  private colour(): void {
    const range = this.ranges?.[this.field] ?? null;
    const legend = id("legend");
    show(legend, this.ranges !== null);
    if (this.ranges === null) return;
    const of: Range = range ?? { low: 0, high: 1 };
    this.stage.setField(FIELDS.indexOf(this.field), of);
    text(id("legend-note"), `${NOTES[this.field]} \u00b7 rings ${RING_STEP_M} m apart`);
    this.stage.uniform("ceiling_m", this.ranges.ceiling_m ?? 1e6);
    const words = (value: number) => {
      if (range === null) return "";
      switch (this.field) {
        case "height": return `${fixed(value, 1)} m`;
        case "intensity": return fixed(value, 0);
        case "ring": return Number.isInteger(value) ? fixed(value, 0) : "";
        case "time": return `${digits(value)} s`;
        case "sd": return `${digits(1e3 * value, 2)} mm`;
      }
    };
    text(id("legend-low"), range === null ? "not in this cloud" : words(of.low));
    text(id("legend-middle"), words((of.low + of.high) / 2));
    text(id("legend-high"), words(of.high));
  }

  /** Applies the colours of the theme and of the selected map. */
  private paint(): void {
    const night = dark.matches;
    const colours = table(this.map, night);
    this.stage.setColours(colours);
    if (night) this.stage.setBackground([0.043, 0.063, 0.086], [0.13, 0.18, 0.23], [0.55, 0.64, 0.73], [0.49, 0.77, 1]);
    else this.stage.setBackground([0.933, 0.949, 0.965], [0.76, 0.8, 0.84], [0.3, 0.36, 0.42], [0.04, 0.35, 0.66]);
    const bar = id<HTMLCanvasElement>("legend-bar");
    const context = bar.getContext("2d");
    for (let i = 0; context !== null && i < bar.width; i += 1) {
      context.fillStyle = css(colours, i / (bar.width - 1));
      context.fillRect(i, 0, 1, 1);
    }
    this.colour();
  }

  private tools(): void {
    const field = id<HTMLSelectElement>("field");
    field.addEventListener("change", () => {
      this.field = field.value as Field;
      // Stored clouds mostly lack that column; the daemon adds it on request.
      if (this.field === "sd" && this.ranges !== null && this.ranges.sd === null && this.opened !== null) this.open(this.opened);
      this.colour();
    });
    const map = id<HTMLSelectElement>("map");
    map.addEventListener("change", () => {
      this.map = map.value as MapName;
      this.paint();
    });
    const size = id<HTMLInputElement>("size");
    const resize = () => this.stage.uniform("size", Number(size.value) * Math.min(devicePixelRatio, 2));
    size.addEventListener("input", resize);
    resize();
    const below = id<HTMLInputElement>("below");
    below.addEventListener("input", () => {
      const { low, high } = this.ranges?.height ?? { low: -2, high: 10 };
      const all = Number(below.value) === 100;
      const limit = low + ((high - low) * Number(below.value)) / 100;
      text(id("hidden-heights"), all ? "nothing" : `above ${fixed(limit, 1)} m`);
      this.stage.uniform("below_m", all ? 1e6 : limit);
    });
    const check = (name: string, set: (on: boolean) => void) => {
      const box = id<HTMLInputElement>(name);
      box.addEventListener("change", () => set(box.checked));
    };
    check("cutaway", (on) => this.stage.uniform("cutaway", on));
    check("shading", (on) => this.stage.setShading(on));
    id("fit").addEventListener("click", () => this.fit());
    id("top").addEventListener("click", () => this.fit("top"));
    id("inside").addEventListener("click", () => this.fit("scanner"));
  }
}
