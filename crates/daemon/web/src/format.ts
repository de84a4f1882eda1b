// Formats numbers, sizes and times in English and the reader's time zone.

const whole = new Intl.NumberFormat("en", { maximumFractionDigits: 0 });
const short = new Intl.NumberFormat("en", { notation: "compact", maximumSignificantDigits: 3 });
const day = new Intl.DateTimeFormat("en-GB", { day: "numeric", month: "short", hour: "2-digit", minute: "2-digit" });

export const count = (n: number) => whole.format(n);
export const compact = (n: number) => short.format(n);
export const moment = (unix_s: number) => day.format(new Date(unix_s * 1_000));

/** With a real minus sign and a fixed number of decimals. */
export function fixed(n: number, decimals: number): string {
  const text = n.toFixed(decimals);
  return Number(text) === 0 ? text.replace("-", "") : text.replace("-", "\u2212");
}

/** With a number of significant digits, without trailing zeros. */
export function digits(n: number, significant = 3): string {
  return String(Number(n.toPrecision(significant))).replace("-", "\u2212");
}

export const mm = (m: number) => `${digits(1_000 * m, 2)} mm`;

/** In millimetres below 0.1 m. */
export const length = (m: number) => (m < 0.1 ? mm(m) : `${digits(m, 2)} m`);

export function bytes(n: number): string {
  const units = ["B", "kB", "MB", "GB", "TB"];
  let [size, unit] = [n, 0];
  while (size >= 1_000 && unit < units.length - 1) [size, unit] = [size / 1_000, unit + 1];
  return `${unit === 0 ? size : size.toPrecision(3)} ${units[unit]}`;
}

/** With a capital letter at the start and a full stop at the end. */
export function sentence(text: string): string {
  const stop = /[.!?]$/.test(text) ? "" : ".";
  return text.charAt(0).toUpperCase() + text.slice(1) + stop;
}

export function duration(seconds: number): string {
  if (seconds < 59.5) return `${seconds < 10 ? seconds.toFixed(2) : seconds.toFixed(0)} s`;
  const whole_s = Math.round(seconds);
  if (whole_s < 3_600) return `${Math.floor(whole_s / 60)} min ${whole_s % 60} s`;
  const minutes = Math.round(seconds / 60);
  return `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}
