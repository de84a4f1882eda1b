// A stop that is repeated until it is acknowledged.

/**
 * Longest wait for the answer to one request, and for the first acknowledgement before the alarm. A stop is
 * acknowledged at standstill, after up to 0.8 s.
 */
export const TRY_MS = 2_000;
/** Pause after a failed request. */
const PAUSE_MS = 200;

/**
 * Sends the stop until it is answered or `ended`. Calls `unacknowledged` with the last error after two
 * seconds without an answer, and again after each later failure. Returns whether it was answered.
 */
export async function repeatStop(
  send: (signal: AbortSignal) => Promise<unknown>,
  unacknowledged: (why: unknown) => void,
  ended: AbortSignal,
): Promise<boolean> {
  let why: unknown = null;
  let late = false;
  const alarm = setTimeout(() => {
    late = true;
    unacknowledged(why);
  }, TRY_MS);
  const pause = () => new Promise((again) => setTimeout(again, PAUSE_MS));
  try {
    while (!ended.aborted) {
      const attempt = new AbortController();
      const abort = () => attempt.abort();
      const limit = setTimeout(abort, TRY_MS);
      ended.addEventListener("abort", abort);
      try {
        await send(attempt.signal);
        return true;
      } catch (error) {
        why = error;
      } finally {
        clearTimeout(limit);
        ended.removeEventListener("abort", abort);
      }
      if (ended.aborted) break;
      if (late) unacknowledged(why);
      await pause();
    }
    return false;
  } finally {
    clearTimeout(alarm);
  }
}
