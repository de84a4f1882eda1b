// What the daemon is asked and what it answers (docs: The daemon). Left out: how anything looks.

/** What is wrong, and what to do. */
export interface Problem {
  error: string;
  help?: string | null;
  kind?: string;
}

/** An entry of the drive's error history. */
export interface Fault {
  /** Four hexadecimal digits. */
  code: string;
  name?: string | null;
  meaning?: string | null;
  remedy?: string | null;
}

export type DeviceState = "absent" | "connected" | "fault";
export type Doing = "idle" | "connecting" | "homing" | "moving" | "capturing" | "stopping";

export interface Status {
  version: string;
  device: string;
  simulated: boolean;
  started_s: number;
  now_s: number;
  activity: {
    doing: Doing;
    scan?: string | null;
    /** The axis searches its home: first of all in a capture. */
    homes?: boolean;
    /** From 1; 0 before the first move. */
    step?: number | null;
    steps?: number | null;
    from_deg?: number | null;
    to_deg?: number | null;
    left_s?: number | null;
    /** Of the lidar, in this capture. */
    packets?: number | null;
  };
  drive: {
    state: DeviceState;
    problem?: Problem | null;
    port?: string | null;
    link?: string | null;
    cia402?: string | null;
    referenced?: boolean | null;
    angle_deg?: number | null;
    speed_deg_s?: number | null;
    faults: Fault[];
  };
  lidar: {
    state: DeviceState;
    problem?: Problem | null;
    model?: string | null;
    return_mode?: string | null;
    rpm?: number | null;
    packets?: number | null;
    packets_per_s?: number | null;
    lost_packets?: number | null;
    dropped_by_kernel?: number | null;
  };
  axis: {
    min_deg: number;
    max_deg: number;
    max_speed_deg_s: number;
    /** One turn of the motor a minute. */
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

/** What a capture is asked to do; only the speed is needed. */
export interface Asked {
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
  state: ScanState;
  why?: Problem | null;
  /** Whether its cloud is made once the disk has room. */
  waits_for_room?: boolean;
  /** Why it is incomplete and what there is of it, in sentences. */
  summary?: string | null;
  started_s: number;
  simulated: boolean;
  asked?: { [key in keyof Asked]?: Asked[key] | null } | null;
  points?: number | null;
  duration_s?: number | null;
  bytes?: number | null;
  log_bytes?: number | null;
  cloud_bytes?: number | null;
  thumbnail?: boolean | null;
  report?: Report | null;
}

/** Of `capture --json`, what the page shows. */
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

/** What a capture would be. */
export interface Plan {
  motor_rpm: number;
  cruise_deg_s: number;
  sweep_s: number;
  /** All moves, without homing. */
  moves_s: number;
  /** Tilt between two turns of the lidar; null while its speed is not known. */
  step_deg?: number | null;
  /** Mean vertical resolution: what all lasers see in a sweep, shared by the lasers in all turns. */
  resolution_deg?: number | null;
  /** Before the first move, about; null while the axis does not know where it is. */
  homing_s?: number | null;
  frames?: number | null;
  bytes: number;
}

/** A request that was refused or went wrong, in the daemon's own words. */
export class Refused extends Error {
  readonly help: string | null;
  readonly status: number;

  constructor(problem: Problem, status: number) {
    super(problem.error);
    this.help = problem.help ?? null;
    this.status = status;
  }
}

const ROOT = "/api/v1/";

/** Asks; throws `Refused` with what to do next. */
export async function ask<T>(method: string, path: string, body?: unknown): Promise<T> {
  const init: RequestInit = { method, credentials: "same-origin", cache: "no-store" };
  if (body !== undefined) {
    init.headers = { "content-type": "application/json" };
    init.body = JSON.stringify(body);
  }
  let answer: Response;
  try {
    answer = await fetch(path.startsWith("/") ? path : ROOT + path, init);
  } catch {
    const help = "see whether it runs, and whether this device still reaches it";
    throw new Refused({ error: "the daemon does not answer", help }, 0);
  }
  const text = await answer.text();
  const said = parse(text);
  if (!answer.ok) throw new Refused(problem(said, text, answer.status), answer.status);
  return said as T;
}

function parse(text: string): unknown {
  try {
    return text === "" ? null : JSON.parse(text);
  } catch {
    return null;
  }
}

function problem(said: unknown, text: string, status: number): Problem {
  if (typeof said === "object" && said !== null && "error" in said) return said as Problem;
  return { error: text.slice(0, 200) || `the daemon answers ${status}` };
}

export const api = {
  status: () => ask<Status>("GET", "status"),
  scans: async () => {
    const said = await ask<Scan[] | { scans: Scan[] }>("GET", "scans");
    return Array.isArray(said) ? said : said.scans;
  },
  scan: (id: string) => ask<Scan>("GET", `scans/${encodeURIComponent(id)}`),
  remove: (id: string) => ask<unknown>("DELETE", `scans/${encodeURIComponent(id)}`),
  plan: (asked: Asked) => ask<Plan>("GET", `plan?${query(asked)}`),
  capture: (asked: Asked) => ask<Scan>("POST", "captures", asked),
  stopCapture: () => ask<unknown>("POST", "captures/stop"),
  stop: () => ask<unknown>("POST", "tilt/stop"),
  home: () => ask<unknown>("POST", "tilt/home"),
  clear: () => ask<unknown>("POST", "tilt/clear"),
  goto: (to_deg: number, speed_deg_s: number) => ask<unknown>("POST", "tilt/goto", { to_deg, speed_deg_s }),
};

/** Where a scan's cloud comes from. */
export function cloudUrl(id: string, format: string, uncertainty = false): string {
  const more = uncertainty ? "&uncertainty=true" : "";
  return `${ROOT}scans/${encodeURIComponent(id)}/cloud?format=${format}${more}`;
}

export const logUrl = (id: string) => `${ROOT}scans/${encodeURIComponent(id)}/log`;
export const thumbnailUrl = (id: string) => `${ROOT}scans/${encodeURIComponent(id)}/thumbnail`;

/** The events' address on this page's own host; every `thin`th live point. */
export function eventsUrl(thin: number): string {
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  return `${scheme}://${location.host}${ROOT}events?points=true&thin=${thin}`;
}

/** What of a request the plan is asked about: it knows neither name nor tolerance. */
function query(asked: Asked): string {
  const { name: _name, tolerance: _tolerance, ...rest } = asked;
  return new URLSearchParams(Object.entries(rest).map(([key, value]) => [key, String(value)])).toString();
}
