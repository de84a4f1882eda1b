import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { outage } = await load("outage.ts");

test("a dead daemon is told from a lost network", () => {
  assert.match(outage(true, "127.0.0.1", 3), /does not answer/);
  assert.match(outage(false, "localhost", null), /does not answer/);
  assert.match(outage(false, "10.0.0.7", 3), /no network/);
  assert.match(outage(true, "10.0.0.7", 20), /daemon has probably ended/);
  assert.match(outage(true, "10.0.0.7", 2_500), /network is probably lost/);
  assert.match(outage(true, "10.0.0.7", null), /network is probably lost/);
});
