// Lists of values.

import type { Scan } from "../api.ts";
import { attribute, h, text } from "../dom.ts";
import { count, digits } from "../format.ts";

export type Tone = "good" | "warn" | "bad" | "off";
export type Fact = [name: string, value: string, tone?: Tone];

/** Updates a list of values; unchanged rows are not touched. */
export function facts(list: HTMLElement, rows: Fact[]): void {
  while (list.children.length > rows.length) list.lastElementChild?.remove();
  rows.forEach(([name, value, tone], i) => {
    let row = list.children[i];
    if (row === undefined) {
      row = h("div", {}, h("dt"), h("dd"));
      list.append(row);
    }
    const [dt, dd] = [row.children[0], row.children[1]];
    if (dt === undefined || dd === undefined) return;
    text(dt, name);
    text(dd, value);
    attribute(dd, "data-tone", tone ?? "off");
  });
}

/** Losses of a scan, and residuals and error bounds of its clock and angle. */
export function residuals({ report }: Scan): Fact[] {
  const rows: Fact[] = [];
  const add = (name: string, value: number | null | undefined, unit: string, scale = 1) => {
    if (typeof value === "number") rows.push([name, `${digits(value * scale)}${unit}`]);
  };
  const sync = report?.sync;
  add("Packet delay, median", sync?.clock_residual_us, " \u00b5s");
  add("Clock error at most", sync?.clock_bound_us, " \u00b5s");
  add("Angle residual", sync?.angle_rms_deg, "\u00b0 RMS");
  add("Angle error at most", sync?.angle_bound_deg, "\u00b0");
  if (sync?.angle_method) rows.push(["Angle method", sync.angle_method]);
  const lost = (report?.lost_packets ?? 0) + (report?.lost_records ?? 0);
  if (report != null) rows.push(["Lost", lost === 0 ? "nothing" : `${count(lost)} packets`, lost === 0 ? "off" : "warn"]);
  add("Error against truth, RMS", report?.truth?.rms_m, " mm", 1e3);
  return rows;
}
