// Requests to the daemon and its answers (docs: The daemon).

import { whole } from "./download.ts";
import type { Bin } from "./view/density_sphere.ts";

/** An error and its remedy. */
export interface Problem {
  message: string;
  help?: string | null;
  kind?: string;
}

/** An entry of the drive's error history. */
export interface DriveFault {
  /** Four hexadecimal digits. */
  code: string;
  name?: string | null;
  meaning?: string | null;
  remedy?: string | null;
}

export type DeviceHealth = "absent" | "connected" | "fault";
export type Doing = "idle" | "connecting" | "homing" | "moving" | "capturing" | "stopping";

export interface Status {
  version: string;
  device: string;
  simulated: boolean;
  started_s: number;
  now_s: number;
  /** Stops of the axis that clients have requested. */
  stops: number;
  activity: {
    doing: Doing;
    scan?: string | null;
    /** The axis is homing, also at the start of a capture. */
    homes?: boolean;
    /** From 1; 0 before the first move. */
    step?: number | null;
    steps?: number | null;
    from_deg?: number | null;
    to_deg?: number | null;
    left_s?: number | null;
    /** Lidar packets in this capture. */
    received?: number | null;
  };
  drive: {
    state: DeviceHealth;
    problem?: Problem | null;
    port?: string | null;
    link?: string | null;
    cia402?: string | null;
    referenced?: boolean | null;
    angle_deg?: number | null;
    speed_deg_s?: number | null;
    faults: DriveFault[];
  };
  lidar: {
    state: DeviceHealth;
    problem?: Problem | null;
    model?: string | null;
    return_mode?: string | null;
    rpm?: number | null;
    received?: number | null;
    packets_per_s?: number | null;
    lost_packets?: number | null;
    dropped_by_kernel?: number | null;
  };
  axis: {
    min_deg: number;
    max_deg: number;
    max_speed_deg_s: number;
    /** Speed at 1 rpm of the motor. */
    min_speed_deg_s?: number;
    max_accel_deg_s2: number;
    accel_deg_s2: number;
    home_deg?: number;
  };
  disk?: {
    free_bytes?: number | null;
    reserve_bytes?: number | null;
    scans?: number | null;
    scans_bytes?: number | null;
    keep_scans?: number | null;
    keep_bytes?: number | null;
  };
}

/** Request of a capture; only the speed is required. */
export interface CaptureRequest {
  speed_deg_s: number;
  from_deg?: number;
  to_deg?: number;
  accel_deg_s2?: number;
  sweeps?: number;
  both_ways?: boolean;
  tolerance?: string;
  name?: string;
}

export type ScanState = "recording" | "making" | "whole" | "partial" | "failed";

export interface Scan {
  id: string;
  name?: string | null;
  notes?: string | null;
  state: ScanState;
  why?: Problem | null;
  /** Whether the cloud is made when the disk has room. */
  waits_for_room?: boolean;
  /** Why the scan is incomplete and what exists of it, as sentences. */
  summary?: string | null;
  started_s: number;
  simulated: boolean;
  asked?: { [key in keyof CaptureRequest]?: CaptureRequest[key] | null } | null;
  points?: number | null;
  duration_s?: number | null;
  bytes?: number | null;
  log_bytes?: number | null;
  cloud_bytes?: number | null;
  thumbnail?: boolean | null;
  report?: Report | null;
}

/** The part of `capture --json` that the page shows. */
export interface Report {
  lost_packets?: number;
  lost_records?: number;
  sync?: {
    clock_method?: string;
    clock_residual_us?: number;
    clock_bound_us?: number;
    clock_drift_ppm?: number;
    angle_method?: string;
    angle_rms_deg?: number | null;
    angle_bound_deg?: number | null;
  };
  truth?: { rms_m: number; worst_m: number } | null;
}

/** What the daemon measures of a scan. */
export interface ScanStatistics {
  points: number;
  /** Whether density and gaps are of the directions in view; else of all. */
  of: "view" | "all";
  /** Points per bin. */
  density: { bins: number; mean: number; sd: number; empty: number };
  /** Those bins. */
  bins: Bin[];
  gap_deg: { p50: number; p95: number; p99: number; worst: number };
  ranges: { from_m: number; to_m: number; points: number }[];
  /** Standard deviations that the points state. */
  sd_mm?: { p50: number; p95: number; p99: number } | null;
  /** Residuals of clock and angle in equal parts of the recording. */
  residuals: Residuals[];
  /** None without the request of a capture. */
  budget?: { at_m: number; error_mm: ErrorBudget }[];
}

/** Residuals within a part of the recording, null without packets or positions. */
export interface Residuals {
  /** Middle of the part, seconds. */
  at_s: number;
  /** Median and greatest delay of the packets beyond the least, microseconds. */
  delay_us: number | null;
  most_delay_us: number | null;
  /** Deviation of the drive's positions from the curve: root mean square, and the greatest, degrees. */
  angle_rms_deg: number | null;
  most_angle_deg: number | null;
}

/** Errors of a point at a distance, millimetres; the total is of 95 % of points. */
export interface ErrorBudget {
  range: number;
  range_step: number;
  azimuth: number;
  tilt: number;
  clock: number;
  delay: number;
  mount: number | null;
  total: number;
}

/** Estimate of a capture. */
export interface CaptureEstimate {
  motor_rpm: number;
  cruise_deg_s: number;
  sweep_s: number;
  /** All moves, without homing. */
  moves_s: number;
  /** Tilt per revolution of the lidar; null while its speed is unknown. */
  step_deg?: number | null;
  /** Mean vertical resolution: the elevation range seen in a sweep over the number of scan lines. */
  resolution_deg?: number | null;
  /** Distance to the nearest point for 99 % of directions in view. */
  gap_deg?: number | null;
  /** Error of 95 % of points at 20 m. */
  error_mm?: number | null;
  /** A slightly slower sweep that sees much more. */
  warning?: string | null;
  /** Approximate duration of homing before the first move; null while the angle is unknown. */
  homing_s?: number | null;
  frames?: number | null;
  bytes: number;
}

/** A refused or failed request, with the daemon's error message. */
export class RequestError extends Error {
  readonly help: string | null;
  readonly status: number;

  constructor(problem: Problem, status: number) {
    super(problem.message);
    this.help = problem.help ?? null;
    this.status = status;
  }
}

const ROOT = "/api/v1/";

/** Sends a request; throws `RequestError` with the remedy. */
export async function sendRequest<T>(method: string, path: string, body?: unknown, headers: Record<string, string> = {}): Promise<T> {
  const init: RequestInit = { method, headers };
  if (body !== undefined) {
    init.headers = { ...headers, "content-type": "application/json" };
    init.body = JSON.stringify(body);
  }
  const answer = await answered(path.startsWith("/") ? path : ROOT + path, init);
  return parse(await answer.text()) as T;
}

/** The answer to a request; throws `RequestError` for a refusal and for none. */
async function answered(url: string, init: RequestInit): Promise<Response> {
  let answer: Response;
  try {
    answer = await fetch(url, { credentials: "same-origin", cache: "no-store", ...init });
  } catch {
    const help = "check that it runs and that this device can reach it";
    throw new RequestError({ message: "the daemon does not answer", help }, 0);
  }
  if (answer.ok) return answer;
  const text = await answer.text();
  throw new RequestError(problem(parse(text), text, answer.status), answer.status);
}

/** URL to save a file from that is made now; `received` gets the number of its bytes so far, and `signal` ends it. */
export async function madeUrl(url: string, received: (bytes: number) => void, signal: AbortSignal): Promise<string> {
  // An answer that breaks off is not a refusal. What was made for it may count until the daemon knows of its end.
  const is_lost = (error: unknown) => !signal.aborted && (!(error instanceof RequestError) || [0, 429, 503].includes(error.status));
  const wait = (ms: number) => new Promise<unknown>((done) => {
    setTimeout(done, ms);
    signal.addEventListener("abort", done);
  });
  return URL.createObjectURL(await whole((headers) => answered(url, { headers, signal }), is_lost, received, wait));
}

/** The URL of a file that exists, which may be large and is not held here; throws for a refusal. */
export async function fileUrl(url: string): Promise<string> {
  // A refusal of HEAD has no text: GET has it.
  await answered(url, { method: "HEAD" }).catch(() => answered(url, {}).then((answer) => answer.body?.cancel()));
  return url;
}

function parse(text: string): unknown {
  try {
    return text === "" ? null : JSON.parse(text);
  } catch {
    return null;
  }
}

function problem(json: unknown, text: string, status: number): Problem {
  if (typeof json === "object" && json !== null && "error" in json) return json.error as Problem;
  return { message: text.slice(0, 200) || `the daemon answers ${status}` };
}

/** Stops of the axis that the page knows of, since the start of the daemon. */
let stops = 0;
let since_s: number | null = null;

/** Takes the stops of a status; one may arrive after a later one. */
export function setStops(known: number, started_s: number): void {
  stops = since_s === started_s ? Math.max(stops, known) : known;
  since_s = started_s;
}

/** Stops the axis. What is begun after its answer knows of this stop. */
async function stop(signal: AbortSignal): Promise<void> {
  const answer = await answered(`${ROOT}tilt/stop`, { method: "POST", signal });
  stops = Math.max(stops, Number(answer.headers.get("velomotion-stops")));
}

/** Sends a request that moves the axis. The daemon refuses one that arrives after a later stop. */
function move<T>(path: string, body?: unknown): Promise<T> {
  return sendRequest<T>("POST", path, body, since_s === null ? {} : { "velomotion-stops": String(stops) });
}

export const api = {
  status: () => sendRequest<Status>("GET", "status"),
  /** At most `limit` scans older than one, the newest first. */
  scans: async (limit: number, before: string | null) => {
    const query = new URLSearchParams({ limit: String(limit), ...(before === null ? {} : { before }) });
    return (await sendRequest<{ scans: Scan[] }>("GET", `scans?${query}`)).scans;
  },
  scan: (id: string) => sendRequest<Scan>("GET", `scans/${encodeURIComponent(id)}`),
  /** Of a file of `velomotion view`. */
  file_statistics: (id: string) => sendRequest<ScanStatistics>("GET", new URL(`statistics/${id}`, location.href).pathname),
  statistics: (id: string) => sendRequest<ScanStatistics>("GET", `scans/${encodeURIComponent(id)}/statistics`),
  /** Absent texts stay, empty ones are removed. */
  edit: (id: string, texts: { name?: string; notes?: string }) => sendRequest<Scan>("PATCH", `scans/${encodeURIComponent(id)}`, texts),
  /** The scan can be restored for 10 s. */
  remove: (id: string) => sendRequest<unknown>("DELETE", `scans/${encodeURIComponent(id)}?undo=true`),
  restore: (id: string) => sendRequest<Scan>("POST", `scans/${encodeURIComponent(id)}/restore`),
  plan: (request: CaptureRequest) => sendRequest<CaptureEstimate>("GET", `plan?${query(request)}`),
  capture: (request: CaptureRequest) => move<Scan>("captures", request),
  /** Stops any motion; of a capture the swept part is kept. */
  stop,
  home: () => move<unknown>("tilt/home"),
  clear: () => sendRequest<unknown>("POST", "tilt/clear"),
  goto: (to_deg: number, speed_deg_s: number) => move<unknown>("tilt/goto", { to_deg, speed_deg_s }),
};

/** URL of a scan's cloud, with the further columns. */
export function cloudUrl(id: string, format: string, complete: boolean): string {
  const more = complete ? "&uncertainty=true&echo=true&laser=true" : "";
  return `${ROOT}scans/${encodeURIComponent(id)}/cloud?format=${format}${more}`;
}

export const logUrl = (id: string) => `${ROOT}scans/${encodeURIComponent(id)}/log`;
export const thumbnailUrl = (id: string) => `${ROOT}scans/${encodeURIComponent(id)}/thumbnail`;

/** URL of the events on this page's host, with every `thin`th live point. */
export function eventsUrl(thin: number): string {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  return `${scheme}://${location.host}${ROOT}events?points=true&thin=${thin}`;
}

/** Query of the plan: the request without name and tolerance. */
function query(request: CaptureRequest): string {
  const { name: _name, tolerance: _tolerance, ...rest } = request;
  return new URLSearchParams(Object.entries(rest).map(([key, value]) => [key, String(value)])).toString();
}
