// Downloads of files that the daemon makes on request. An interrupted one goes on where it ended.

/** Waits before the next attempts, milliseconds. */
const WAITS_MS = [500, 1_000, 2_000, 4_000, 8_000, 16_000];

/**
 * The bytes of a file; `received` gets their number so far.
 *
 * `ask` sends a request with these headers and throws for a refusal; `is_lost` tells an error that may
 * pass. Bytes of another version, which the daemon's validator shows, begin anew.
 */
export async function whole(
  ask: (headers: Record<string, string>) => Promise<Response>,
  is_lost: (error: unknown) => boolean,
  received: (bytes: number) => void,
  wait = (ms: number) => new Promise<unknown>((done) => setTimeout(done, ms)),
): Promise<Blob> {
  let pieces: Uint8Array<ArrayBuffer>[] = [];
  let bytes = 0;
  let tag: string | null = null;
  let kind = "";
  for (let lost = 0; ;) {
    const before = bytes;
    try {
      const answer: Response = await ask(tag === null || bytes === 0 ? {} : { range: `bytes=${bytes}-`, "if-range": tag });
      if (answer.status !== 206) [pieces, bytes] = [[], 0];
      tag = answer.headers.get("etag");
      kind = answer.headers.get("content-type") ?? "";
      if (answer.body !== null) {
        const reader = answer.body.getReader();
        for (let read = await reader.read(); !read.done; read = await reader.read()) {
          pieces.push(read.value);
          bytes += read.value.length;
          received(bytes);
        }
      }
      return new Blob(pieces, { type: kind });
    } catch (error) {
      // Attempts that bring something count anew.
      if (bytes > before) lost = 0;
      const ms = WAITS_MS[lost];
      if (!is_lost(error) || ms === undefined) throw error;
      lost += 1;
      await wait(ms);
    }
  }
}
