import assert from "node:assert/strict";
import { createServer } from "node:http";
import test from "node:test";

import { load } from "./bundle.mjs";

const { whole } = await load("download.ts");

const FILE = Buffer.from(Array.from({ length: 300_000 }, (_, i) => (i * 7 + (i >> 9)) % 251));

/** A server that cuts its first answers off after so many bytes; `tag` names the version of each answer. */
async function server(cuts, tag, run) {
  const asked = [];
  const http = createServer((request, answer) => {
    const version = tag(asked.length);
    const range = request.headers["if-range"] === version ? /bytes=(\d+)-/.exec(request.headers.range ?? "") : null;
    const from = range === null ? 0 : Number(range[1]);
    asked.push(request.headers.range ?? "whole");
    answer.writeHead(range === null ? 200 : 206, { "content-length": FILE.length - from, etag: version });
    const cut = cuts[asked.length - 1];
    if (cut === undefined) return answer.end(FILE.subarray(from));
    answer.write(FILE.subarray(from, from + cut), () => setTimeout(() => request.socket.destroy(), 20));
  });
  await new Promise((done) => http.listen(0, "127.0.0.1", done));
  const url = `http://127.0.0.1:${http.address().port}/`;
  try {
    const bytes = await run((headers) => fetch(url, { headers }));
    return [bytes, asked];
  } finally {
    http.closeAllConnections();
    http.close();
  }
}

const bytes = async (ask, is_lost = () => true, received = () => {}) => Buffer.from(await (await whole(ask, is_lost, received, async () => {})).arrayBuffer());

test("an interrupted download goes on where it ended", async () => {
  const sizes = [];
  const [got, asked] = await server([100_000, 50_000], () => '"1"', (ask) => bytes(ask, () => true, (size) => sizes.push(size)));
  assert.ok(got.equals(FILE));
  assert.equal(sizes.at(-1), FILE.length);
  assert.deepEqual(sizes, sizes.toSorted((a, b) => a - b));
  assert.deepEqual(asked, ["whole", "bytes=100000-", "bytes=150000-"]);
});

test("bytes of another version begin anew", async () => {
  const [got, asked] = await server([100_000], (request) => `"${request}"`, bytes);
  assert.ok(got.equals(FILE));
  assert.deepEqual(asked, ["whole", "bytes=100000-"]);
});

test("a daemon that brings nothing is given up, and a refusal at once", async () => {
  let tries = 0;
  const lost = () => { tries += 1; throw new Error("lost"); };
  await assert.rejects(bytes(lost), /lost/);
  assert.equal(tries, 7);
  await assert.rejects(bytes(lost, () => false), /lost/);
  assert.equal(tries, 8);
});
