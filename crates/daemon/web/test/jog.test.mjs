import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { target } = await load("jog.ts");
const bounds = { min_deg: -45, max_deg: 0 };

test("a step ends at its angle, or at the limit on its way", () => {
  assert.equal(target(-20, 1, bounds), -19);
  assert.equal(target(-20.0004, -0.1, bounds), -20.1);
  assert.equal(target(-40, -10, bounds), -45);
  assert.equal(target(-0.4, 10, bounds), 0);
});

test("a step beyond a limit, or from an unknown angle, moves nothing", () => {
  assert.equal(target(-45, -1, bounds), null);
  assert.equal(target(-44.99, -10, bounds), null);
  assert.equal(target(0.5, 1, bounds), null);
  assert.equal(target(null, 1, bounds), null);
  assert.equal(target(-20, 1, null), null);
});
