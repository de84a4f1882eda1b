import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { wrapped } = await load("picture.ts");

test("lines below a picture are broken where they do not fit", () => {
  const fits = (line) => line.length <= 12;
  assert.deepEqual(wrapped("only the points up to 3.00 s", fits), ["only the", "points up to", "3.00 s"]);
  assert.deepEqual(wrapped("a-word-without-a-place b", fits), ["a-word-without-a-place", "b"]);
});
