// The WebSocket of events: reports a lost connection at once and reconnects automatically.

import { type Scan, type Status, eventsUrl } from "./api.ts";
import { type Frame, parseFrame } from "./frame.ts";

export interface Motion {
  angle_deg: number;
  speed_deg_s: number;
  left_s?: number | null;
  received?: number | null;
}

export interface Message {
  level: "info" | "warning" | "error";
  text: string;
  help?: string | null;
}

export interface Listener {
  opened(): void;
  /** The connection is lost; the next attempt is after `retry_s`. */
  lost(retry_s: number): void;
  status(status: Status): void;
  motion(motion: Motion): void;
  scan(scan: Scan, deleted: boolean): void;
  message(message: Message): void;
  points(frame: Frame): void;
}

/** The daemon sends a status every second; a connection silent for so long is dead, even if it was never closed. */
const SILENCE_MS = 4_000;
/** Code with which the daemon closes a connection whose events are not read in time. */
const TOO_SLOW = 1008;
const WAITS_S = [0.5, 1, 2, 4, 8];

export class Events {
  private socket: WebSocket | null = null;
  private tries = 0;
  private thin = 1;
  private opened_ms = 0;
  private silence = 0;
  private again = 0;
  private capturing = false;
  /** Whether the daemon has said that this device is too slow. */
  private is_slow = false;

  constructor(private readonly listener: Listener) {}

  /** Only every n-th live point is sent. */
  get every(): number {
    return this.thin;
  }

  open(): void {
    this.close();
    const socket = new WebSocket(eventsUrl(this.thin));
    socket.binaryType = "arraybuffer";
    this.socket = socket;
    this.restart_timeout();
    socket.onopen = () => {
      this.tries = 0;
      this.opened_ms = performance.now();
      this.restart_timeout();
      this.listener.opened();
    };
    socket.onmessage = (event: MessageEvent<string | ArrayBuffer>) => {
      this.restart_timeout();
      if (typeof event.data === "string") this.text(event.data);
      else this.binary(event.data);
    };
    socket.onclose = ({ code }) => {
      this.is_slow ||= code === TOO_SLOW;
      this.lost(socket);
    };
  }

  /** Closes the connection until the next `open`. */
  close(): void {
    clearTimeout(this.silence);
    clearTimeout(this.again);
    const socket = this.socket;
    this.socket = null;
    socket?.close();
  }

  private restart_timeout(): void {
    clearTimeout(this.silence);
    this.silence = window.setTimeout(() => {
      const socket = this.socket;
      if (socket !== null) this.lost(socket);
    }, SILENCE_MS);
  }

  private lost(socket: WebSocket): void {
    if (socket !== this.socket) return;
    // A working connection that is cut off in mid-sweep: this device may be too slow for all points, so request fewer.
    const worked = performance.now() - this.opened_ms > 1_000 && this.tries === 0;
    if (this.capturing && worked) this.thin = Math.min(64, this.thin * 4);
    this.close();
    const wait_s = WAITS_S[Math.min(this.tries, WAITS_S.length - 1)] ?? 8;
    this.tries += 1;
    this.listener.lost(wait_s);
    this.again = window.setTimeout(() => this.open(), wait_s * 1_000);
  }

  private text(text: string): void {
    let event: Record<string, unknown>;
    try {
      event = JSON.parse(text) as Record<string, unknown>;
    } catch {
      return;
    }
    switch (event["type"]) {
      case "status": {
        const status = event["status"] as Status;
        this.capturing = status.activity.doing === "capturing";
        this.listener.status(status);
        // The next scan gets all points again, if only the network was lost.
        if (this.thin > 1 && !this.is_slow && status.activity.doing === "idle") {
          this.thin = 1;
          this.open();
        }
        return;
      }
      case "motion":
        return this.listener.motion(event as unknown as Motion);
      case "scan":
        return this.listener.scan(event["scan"] as Scan, event["deleted"] === true);
      case "message":
        return this.listener.message(event as unknown as Message);
    }
  }

  private binary(bytes: ArrayBuffer): void {
    const frame = parseFrame(bytes);
    if (frame !== null) this.listener.points(frame);
  }
}
