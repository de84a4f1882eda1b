import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { duration } = await load("format.ts");

test("durations are rounded before they are split", () => {
  for (const [seconds, words] of [[9.994, "9.99 s"], [59.4, "59 s"], [59.7, "1 min 0 s"], [119.7, "2 min 0 s"], [3_599.7, "1 h 0 min"], [7_170, "2 h 0 min"]]) assert.equal(duration(seconds), words);
});
