// Why the daemon does not answer, as far as a browser can tell.

/** A machine without the daemon refuses a connection within this time; one that is out of reach does not answer. */
export const REFUSAL_MS = 1_000;

/** `failed_ms` is the time after which a request failed; null if it has not failed yet. */
export function outage(online: boolean, host: string, failed_ms: number | null): string {
  if (["localhost", "127.0.0.1", "[::1]"].includes(host)) return "The daemon on this machine does not answer: it has probably ended.";
  if (!online) return "This device has no network.";
  if (failed_ms !== null && failed_ms < REFUSAL_MS) return "Its machine refuses at once: the daemon has probably ended.";
  return "Its machine does not answer: the network is probably lost, or the machine is off.";
}
