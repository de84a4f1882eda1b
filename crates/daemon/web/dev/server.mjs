#!/usr/bin/env node
// Serves the page and an API with artificial data, for work on the page without a daemon.
// node dev/server.mjs PORT [CLOUD.ply] ; without a cloud all scans have an artificial room, whose box differs by scan. /dev/MODE selects a mode: idle, live, fault, absent, gone, token, stuck (no stop is
// answered, and everything else is refused).
import { createHash } from "node:crypto";
import { readFileSync, statSync } from "node:fs";
import { createServer } from "node:http";
import { fileURLToPath } from "node:url";

const [port, cloud] = [Number(process.argv[2] ?? 8017), process.argv[3]];
const dist = fileURLToPath(new URL("../dist/", import.meta.url));
const TYPES = { html: "text/html; charset=utf-8", js: "text/javascript", css: "text/css", svg: "image/svg+xml", txt: "text/plain" };
const ply = cloud ? readFileSync(cloud) : room([2, 1, -0.8]);
let mode = "idle";
let angle = 0;
let packets = 120_000;
const sockets = new Set();
const now_s = () => Date.now() / 1000;

const scan = (n, more = {}) => ({
  id: `hall-${n}-simulated-2026-11-21T15-0${n}-11Z`, name: `hall-${n}`, state: "whole", why: null, started_s: 1_763_737_000 + 300 * n, simulated: true,
  asked: { speed_deg_s: 56.25, name: `hall-${n}` }, points: 243_311, duration_s: 4.9, bytes: 12_345_678, log_bytes: 5e6, cloud_bytes: 7e6, thumbnail: false, ...more,
});
let scans = [
  scan(3),
  scan(2, { state: "partial", why: { message: "stopped by the user", help: "what was captured is saved: the cloud /data/scans/x/cloud.ply and the log /data/scans/x/log.pcapng", kind: "interrupted" }, summary: "Stopped by the user. What was captured is kept.", points: 97_220, simulated: false, asked: { speed_deg_s: 5 } }),
  scan(1, { state: "failed", why: { message: "the disk is nearly full: 12 MB free, 1000 MB are left free", help: "delete scans", kind: "incomplete" }, waits_for_room: true,
    summary: "The disk is nearly full: 12 MB free, 1000 MB are left free. Delete scans, or give another folder or a smaller reserve_bytes under [daemon] of the configuration. The log is kept: its cloud is made as soon as the disk has room.", points: null }),
];
// Many more, for the list.
for (let n = 4; n < Number(process.env.SCANS ?? 0); n += 1) scans.push(scan(-n, { id: `old-${n}`, name: `old-${n}`, notes: n % 5 === 0 ? `note ${n}` : null }));
const deleted = new Map();
/** Even directions, with points that grow upwards. */
function ball(count) {
  return Array.from({ length: count }, (_, i) => {
    const [z, turn] = [1 - (2 * i + 1) / count, 2.399963 * i];
    const r = Math.sqrt(1 - z * z);
    return { direction: [r * Math.cos(turn), r * Math.sin(turn), z], points: Math.round(100 * (1 + z)) };
  });
}
const budget = (at_m) => ({ at_m, error_mm: { range: 9, range_step: 0.6, azimuth: 0.04 * at_m, tilt: 0.05 * at_m, clock: 0.002 * at_m, delay: 0.2 * at_m, mount: null, column_sd: 9, total: 18 + 0.4 * at_m } });
const statistics = {
  points: 243_311, of: "view", density: { bins: 3_120, mean: 77.98, sd: 41.2, empty: 3 }, bins: ball(1_500), gap_deg: { p50: 0.21, p95: 0.61, p99: 0.93, worst: 2.4 },
  ranges: Array.from({ length: 30 }, (_, i) => ({ from_m: i / 2, to_m: (i + 1) / 2, points: i < 3 ? 0 : Math.round(20_000 * Math.exp(-(((i - 11) / 6) ** 2))) })),
  residuals: Array.from({ length: 28 }, (_, i) => ({ at_s: i / 10, delay_us: 18 + i % 3, most_delay_us: i === 11 ? 410 : 60, angle_rms_deg: 0.0007, most_angle_deg: 0.002 })),
  sd_mm: { p50: 9.1, p95: 10.4, p99: 12.8 }, budget: [2, 5, 10, 20, 50, 100].map(budget),
};
const sync = { clock_method: "hull", clock_residual_us: 18.4, clock_bound_us: 36.2, clock_drift_ppm: 12.02, angle_method: "profile", angle_rms_deg: 0.00071, angle_bound_deg: 0.0021 };

const status = () => ({
  version: "0.1.0", device: "sim", simulated: true, started_s: 1.76e9, now_s: now_s(),
  activity: mode === "live"
    ? { doing: "capturing", scan: "live", step: 1, steps: 2, from_deg: 0, to_deg: -45, left_s: (45 + angle) / 5.625 }
    : { doing: "idle", scan: null, step: 0, steps: 0, from_deg: null, to_deg: null, left_s: null },
  drive: {
    state: mode === "fault" ? "fault" : mode === "absent" ? "absent" : "connected",
    problem: mode === "fault" ? { message: "the drive reports 8611: following error", help: "see whether something holds the platform; then clear the fault and home" }
      : mode === "absent" ? { message: "no drive found yet: looking for an EPOS2 (USB 0403:A8B0) with a serial port (serial ports: none)", help: "plug the EPOS2 in and switch it on: it is connected as soon as it is there\nvelomotion doctor lists what is there; a drive that is not on USB needs a [device.NAME] of the configuration", kind: "no-device" } : null,
    port: "/dev/pts/4", link: "usb", cia402: mode === "fault" ? "fault" : mode === "live" ? "operation enabled" : "switch-on disabled", referenced: true,
    angle_deg: mode === "absent" ? null : angle, speed_deg_s: mode === "live" ? -5.625 : 0, faults: mode === "fault" ? [{ code: "8611", meaning: "following error" }] : [],
  },
  lidar: { state: "connected", problem: null, model: "VLP-16", return_mode: "strongest", rpm: 600, received: (packets += 754), packets_per_s: 753 + 2 * Math.random(), lost_packets: 0, dropped_by_kernel: 0 },
  axis: { min_deg: -45, max_deg: 0, max_speed_deg_s: 98, min_speed_deg_s: 0.05, max_accel_deg_s2: 10_000, accel_deg_s2: 5_000, home_deg: 0 },
  disk: { free_bytes: 34.1e9, reserve_bytes: 1e9, scans: scans.length, scans_bytes: 37e6, keep_scans: 100, keep_bytes: 5e10 },
  clients: { events: sockets.size, dropped: 0 },
});

/** A cloud in a room with a box of 0.8 m, in the daemon's format. */
function room(box, count = Number(process.env.POINTS ?? 243_311)) {
  const head = Buffer.from(`ply\nformat binary_little_endian 1.0\ncomment SIMULATED\nelement vertex ${count}\n${["float x", "float y", "float z", "float intensity", "uchar ring", "double time", "float tilt"].map((column) => `property ${column}\n`).join("")}end_header\n`);
  const rows = Buffer.alloc(29 * count);
  for (let i = 0; i < count; i += 1) {
    const [turn, elevation] = [0.618034 * 2 * Math.PI * i, Math.asin(Math.min(1, (1.9 * i) / count - 0.9))];
    const way = [Math.cos(elevation) * Math.cos(turn), Math.cos(elevation) * Math.sin(turn), Math.sin(elevation)];
    const sides = way.map((part, axis) => [(box[axis] - 0.4) / part, (box[axis] + 0.4) / part].sort((a, b) => a - b));
    const [near, far] = [Math.max(...sides.map(([side]) => side)), Math.min(...sides.map(([, side]) => side))];
    const wall = Math.min(...way.map((part, axis) => [6, 4, 1.3][axis] / Math.abs(part)));
    const range = (near > 0 && near < far ? Math.min(near, wall) : wall) + 0.01 * (Math.random() + Math.random() - 1);
    way.forEach((part, axis) => rows.writeFloatLE(range * part, 29 * i + 4 * axis));
    rows.writeFloatLE(near > 0 && near < far ? 90 : 30, 29 * i + 12);
    rows[29 * i + 16] = i % 16;
    rows.writeDoubleLE(1.76e9 + (4.9 * i) / count, 29 * i + 17);
    rows.writeFloatLE((-45 * i) / count, 29 * i + 25);
  }
  return Buffer.concat([head, rows]);
}

/** A frame of a WebSocket: text or binary, unmasked as servers send. */
function frame(data) {
  const body = Buffer.from(data);
  const opcode = typeof data === "string" ? 0x81 : 0x82;
  const head = body.length < 126 ? Buffer.from([opcode, body.length])
    : body.length < 65_536 ? Buffer.from([opcode, 126, body.length >> 8, body.length & 255])
      : Buffer.concat([Buffer.from([opcode, 127, 0, 0, 0, 0]), Buffer.from([body.length >>> 24, (body.length >> 16) & 255, (body.length >> 8) & 255, body.length & 255])]);
  return Buffer.concat([head, body]);
}
const tell = (event) => sockets.forEach((socket) => socket.write(frame(typeof event === "object" && !Buffer.isBuffer(event) ? JSON.stringify(event) : event)));

const rows = parse();
function parse() {
  const end = ply.indexOf("end_header\n") + 11;
  const count = Number(/element vertex (\d+)/.exec(ply.subarray(0, end).toString("latin1"))[1]);
  return { at: end, count, bytes: (ply.length - end) / count };
}
let sent = 0;
function points() {
  if (sent >= rows.count) return;
  const count = Math.min(1_500, rows.count - sent);
  const out = Buffer.alloc(32 + 22 * count);
  const row = (i) => rows.at + (sent + i) * rows.bytes;
  const start = ply.readDoubleLE(row(0) + 17);
  out.write("VMP1");
  out.writeUInt32LE(count, 4);
  out.writeDoubleLE(start, 8);
  out.writeUInt32LE(sent, 16);
  angle = ply.readFloatLE(row(count - 1) + 25);
  out.writeFloatLE(angle, 24);
  for (let i = 0; i < count; i += 1) {
    ply.copy(out, 32 + 12 * i, row(i), row(i) + 12);
    out.writeFloatLE(ply.readDoubleLE(row(i) + 17) - start, 32 + 12 * count + 4 * i);
    out.writeFloatLE(0.01, 32 + 16 * count + 4 * i);
    out[32 + 20 * count + i] = ply.readFloatLE(row(i) + 12);
    out[32 + 21 * count + i] = ply[row(i) + 16];
  }
  sent += count;
  tell(out);
}

setInterval(() => tell({ type: "status", status: status() }), 1_000);
setInterval(() => {
  if (mode !== "live") return;
  points();
  tell({ type: "motion", angle_deg: angle, speed_deg_s: -5.625, left_s: (45 + angle) / 5.625, received: Math.round(sent / 320) });
}, 50);

function answer(request, response) {
  const { pathname, searchParams } = new URL(request.url, "http://localhost");
  const reply = (code, body) => response.writeHead(code, { "content-type": "application/json" }).end(JSON.stringify(body));
  if (pathname.startsWith("/dev/")) {
    mode = pathname.slice(5);
    sent = 0;
    if (mode === "gone") sockets.forEach((socket) => socket.destroy());
    if (mode === "live") tell({ type: "scan", scan: scan(4, { id: "live", name: "yard", state: "recording", points: null }), deleted: false });
    tell({ type: "status", status: status() });
    return reply(200, mode);
  }
  if (mode === "gone") return request.socket.destroy();
  if (pathname === "/login" && request.method === "GET") return reply(200, { signed_in: false });
  if (pathname === "/login") {
    mode = "idle";
    return reply(200, {});
  }
  if (pathname.startsWith("/api/") && mode === "token") return reply(401, { error: { message: "a token is needed", help: "sign in", kind: "denied" } });
  if (pathname === "/api/v1/status") return reply(200, status());
  if (pathname === "/api/v1/scans") {
    const from = scans.findIndex(({ id }) => id === searchParams.get("before")) + 1;
    return reply(200, { scans: scans.slice(from, from + Number(searchParams.get("limit") ?? scans.length)) });
  }
  if (pathname === "/api/v1/plan") {
    const speed = Number(searchParams.get("speed_deg_s"));
    if (!(speed <= 98)) return reply(400, { error: { message: `speed ${speed} deg/s: expected 0.025 to 98`, help: "choose a slower one", kind: "usage" } });
    return reply(200, { motor_rpm: Math.round(20 * speed), cruise_deg_s: Math.round(20 * speed) / 20, sweep_s: 45 / speed + 0.011, moves_s: 45 / speed + 0.6, step_deg: speed / 10, frames: 450 / speed, bytes: (45 / speed + 3) * 1.3e6 });
  }
  const one = /^\/api\/v1\/scans\/([^/]+)(?:\/(\w+))?$/.exec(pathname);
  if (one !== null) {
    if (one[2] === "restore" && deleted.has(one[1])) {
      const back = deleted.get(one[1]);
      deleted.delete(back.id);
      scans = [...scans, back].sort((a, b) => b.started_s - a.started_s);
      tell({ type: "scan", scan: back, deleted: false });
      return reply(200, back);
    }
    const found = scans.find((each) => each.id === one[1]);
    if (found === undefined) return reply(404, { error: { message: "no such scan", help: "GET /api/v1/scans lists them", kind: "not-found" } });
    if (mode === "stuck" && one[2] !== undefined) return reply(429, { error: { message: "too many downloads at once", help: "try again when others have ended", kind: "limit" } });
    if (one[2] === "statistics") return setTimeout(() => reply(200, statistics), 1_000);
    if (one[2] === "cloud") return response.writeHead(200, { "content-type": "application/octet-stream" }).end(cloud || found.state !== "partial" ? ply : room([2.4, 0.2, -0.8]));
    if (request.method === "DELETE") {
      scans = scans.filter((each) => each !== found);
      deleted.set(found.id, found);
      return response.writeHead(204).end();
    }
    if (request.method === "PATCH") {
      let body = "";
      request.on("data", (part) => (body += part));
      request.on("end", () => reply(200, Object.assign(found, JSON.parse(body))));
      return;
    }
    return reply(200, { ...found, report: { lost_packets: 0, sync, truth: { rms_m: 0.00071, worst_m: 0.0018 } }, messages: [] });
  }
  if (mode === "stuck" && pathname === "/api/v1/tilt/stop") return;
  if (request.method === "POST" && mode === "stuck") return reply(507, { error: "this scan may need 900 MB: the disk has 12 MB free", help: "delete scans", kind: "incomplete" });
  if (request.method === "POST") return reply(200, {});
  const name = pathname === "/" ? "index.html" : pathname.slice(1);
  try {
    if (!/^[\w.]+$/.test(name) || !statSync(dist + name).isFile()) throw new Error(name);
    response.writeHead(200, { "content-type": TYPES[name.split(".").pop()], "cache-control": "no-store" }).end(readFileSync(dist + name));
  } catch {
    reply(404, { error: { message: "no such path", kind: "not-found" } });
  }
}

const server = createServer(answer);
server.on("upgrade", (request, socket) => {
  if (mode === "gone" || mode === "token") return socket.destroy();
  const key = createHash("sha1").update(`${request.headers["sec-websocket-key"]}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`).digest("base64");
  socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${key}\r\n\r\n`);
  sockets.add(socket);
  socket.on("close", () => sockets.delete(socket));
  socket.on("error", () => sockets.delete(socket));
  socket.write(frame(JSON.stringify({ type: "status", status: status() })));
});
server.listen(port, "127.0.0.1", () => console.log(`http://127.0.0.1:${port}/`));
