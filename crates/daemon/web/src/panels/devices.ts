// The two devices: chips in the header, problems with remedies, the tilt gauge, values. control.ts has the buttons.

import { type DriveFault, type Problem, type Scan, type Status, api } from "../api.ts";
import { attribute, h, id, show, text } from "../dom.ts";
import type { Motion } from "../events.ts";
import { bytes, count, digits, fixed, sentence } from "../format.ts";
import { title } from "../found.ts";
import { command } from "./control.ts";
import { type Fact, type Tone, facts, residuals } from "./facts.ts";
import { alarm } from "./messages.ts";

function chip(name: string, words: string, tone: Tone): void {
  const element = id(name);
  attribute(element, "data-tone", tone);
  text(element, words);
}

const TONES: Record<string, Tone> = { connected: "good", absent: "warn", fault: "bad" };
/** What the drive's state means for the motor (CiA 402). */
const POWERED: Record<string, string> = { "switch-on disabled": "motor off", "ready to switch on": "motor off", "switched on": "motor off", "operation enabled": "motor powered", "quick stop active": "stopping" };
const STATES: Record<string, string> = { connected: "ready", absent: "absent", fault: "fault" };

export function setLink(words: string, tone: Tone): void {
  chip("chip-link", words, tone);
}

export function setStatus(status: Status): void {
  const { drive, lidar, disk } = status;
  const silent = lidar.state === "connected" && !lidar.packets_per_s;
  chip("chip-drive", `Drive ${STATES[drive.state] ?? drive.state}`, TONES[drive.state] ?? "off");
  chip("chip-lidar", `Lidar ${STATES[lidar.state] ?? lidar.state}`, silent ? "warn" : (TONES[lidar.state] ?? "off"));
  text(id("device"), `${status.device} \u00b7 ${status.version}`);
  show(id("simulated"), status.simulated);
  problems(status);
  if (status.activity.doing === "idle") {
    if (typeof drive.angle_deg === "number") setMotion({ angle_deg: drive.angle_deg, speed_deg_s: drive.speed_deg_s ?? 0 });
    else for (const name of ["angle", "speed-now"]) text(id(name), "\u2013");
  }
  marks(status.axis.min_deg, status.axis.max_deg);

  const lost = (lidar.lost_packets ?? 0) + (lidar.dropped_by_kernel ?? 0);
  const share = lidar.received ? lost / (lidar.received + lost) : 0;
  const lidar_facts: Fact[] = [
    ["Model", [lidar.model, lidar.return_mode].filter(Boolean).join(", ") || "\u2013"],
    ["Revolutions", lidar.rpm ? `${count(lidar.rpm)} rpm` : "\u2013"],
    ["Packets", typeof lidar.packets_per_s === "number" ? `${count(lidar.packets_per_s)} /s` : "\u2013", silent ? "warn" : "off"],
    ["Lost", lost === 0 ? "none" : `${count(lidar.lost_packets ?? 0)} in the network, ${count(lidar.dropped_by_kernel ?? 0)} in this host (${digits(100 * share, 2)} %)`, lost === 0 ? "off" : "warn"],
  ];
  if (status.activity.doing === "capturing") lidar_facts.push(["In this scan", `${count(status.activity.received ?? 0)} packets`]);
  facts(id("lidar-facts"), lidar_facts);
  spark(lidar.packets_per_s ?? 0);
  const faults = drive.faults.map(faultWords);
  const rows: Fact[] = [
    ["State", state_words(drive.cia402) ?? STATES[drive.state] ?? drive.state, drive.state === "fault" ? "bad" : "off"],
    ["Link", [drive.link, drive.port].filter(Boolean).join(", ") || "\u2013"],
    ["Angle known", drive.referenced === true ? "yes" : drive.referenced === false ? "no, homing required" : "\u2013"],
  ];
  if (faults.length > 0) rows.push(["Fault history", faults.join("; "), drive.state === "fault" ? "bad" : "off"]);
  if (typeof disk?.free_bytes === "number") {
    const near = typeof disk.reserve_bytes === "number" && disk.free_bytes < 2 * disk.reserve_bytes;
    rows.push(["Disk free", bytes(disk.free_bytes), near ? "warn" : "off"]);
  }
  facts(id("drive-facts"), rows);
}

/** The drive's state as it names it, after what it means. */
function state_words(name: string | null | undefined): string | null {
  const means = POWERED[name?.toLowerCase() ?? ""];
  return means === undefined ? (name ?? null) : `${means} (${name})`;
}

/** Formats an entry of the drive's error history. */
function faultWords(fault: DriveFault): string {
  return [fault.code, fault.name ?? fault.meaning].filter(Boolean).join(" ");
}

let shown = "";
/** The error of clearing a fault. It outlives the problem's text, which may change at any time. */
const clear_error = h("p", { class: "wrong", id: "clear-error", hidden: true });

/** Shows problems of the devices with their remedies, above everything else. */
function problems(status: Status): void {
  const found: { device: string; state: string; problem: Problem }[] = [];
  for (const [device, of] of [["Drive", status.drive], ["Lidar", status.lidar]] as const) {
    if (of.problem) found.push({ device, state: of.state, problem: of.problem });
    else if (of.state !== "connected") found.push({ device, state: of.state, problem: { message: of.state === "absent" ? "not connected" : "in fault" } });
  }
  const now = JSON.stringify([found, status.activity.doing === "connecting"]);
  if (now === shown) return;
  shown = now;
  if (status.drive.state !== "fault") show(clear_error, false);
  const list = id("problems");
  list.replaceChildren(...found.map(({ device, state, problem }) => h("section", { class: "problem", "aria-label": `Problem: ${device}`, "data-device": device.toLowerCase(), "data-state": state },
    h("h2", {}, `${device} ${STATES[state] ?? state}`),
    h("p", {}, sentence(problem.message)),
    problem.help ? h("p", { class: "todo" }, `What to do: ${problem.help}`) : null,
    device === "Drive" && state === "fault" ? h("div", { class: "row" }, h("button", { type: "button", id: "clear", click: () => void command("Clear", () => api.clear(), clear_error) }, "Clear the fault")) : null,
    device === "Drive" && state === "fault" ? clear_error : null,
  )));
  if (found.length > 0) alarm(found.map(({ device, state, problem }) => `${device} ${STATES[state] ?? state}: ${sentence(problem.message)} ${problem.help ?? ""}`).join(" "));
}

const head = id("gauge-head");

export function setMotion(motion: Motion): void {
  text(id("angle"), `${fixed(motion.angle_deg, 2)}\u00b0`);
  text(id("speed-now"), `${fixed(Math.abs(motion.speed_deg_s), Math.abs(motion.speed_deg_s) < 10 ? 2 : 1)} \u00b0/s`);
  attribute(head, "transform", `rotate(${motion.angle_deg.toFixed(2)})`);
}

let marked = "";

/** Draws the arc of the gauge between the limits. 0 is level; the needle is the lidar's axis of rotation. */
function marks(min_deg: number, max_deg: number): void {
  const now = `${min_deg} ${max_deg}`;
  if (now === marked) return;
  marked = now;
  const at = (deg: number, radius: number) => {
    const turn = (deg * Math.PI) / 180;
    return `${(radius * Math.sin(turn)).toFixed(1)} ${(-radius * Math.cos(turn)).toFixed(1)}`;
  };
  attribute(id("gauge-arc"), "d", `M${at(min_deg, 58)}A58 58 0 ${max_deg - min_deg > 180 ? 1 : 0} 1 ${at(max_deg, 58)}`);
  const svg = "http://www.w3.org/2000/svg";
  id("gauge-marks").replaceChildren(...[min_deg, max_deg].map((deg) => {
    const mark = document.createElementNS(svg, "text");
    const [x, y] = at(deg, 69).split(" ");
    mark.setAttribute("x", x ?? "0");
    mark.setAttribute("y", y ?? "0");
    mark.setAttribute("text-anchor", "middle");
    mark.textContent = `${fixed(deg, Number.isInteger(deg) ? 0 : 1)}\u00b0`;
    return mark;
  }));
}

const rates: number[] = [];

/** Draws the packet rate of the last two minutes. */
function spark(rate: number): void {
  rates.push(rate);
  if (rates.length > 120) rates.shift();
  const most = Math.max(...rates, 1) * 1.15;
  const path = rates.map((value, i) => `${i === 0 ? "M" : "L"}${i + 120 - rates.length} ${(23 - (22 * value) / most).toFixed(1)}`).join("");
  attribute(id("spark").firstElementChild as Element, "d", path);
}

/** Shows clock and angle of a scan with their error bounds. */
export function setLast(scan: Scan | null): void {
  if (!scan?.report?.sync) return facts(id("last-facts"), [["Scan", scan ? title(scan) : "none yet"]]);
  facts(id("last-facts"), [["Scan", title(scan)], ...residuals(scan)]);
}
