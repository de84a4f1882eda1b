import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { fromHash, toHash } = await load("view/link.ts");

test("a link holds the view", () => {
  const state = {
    scan: "2026-11-25T15-51-22Z", camera: [-2.05, 0.62, 31.5, 1, -2, 0.25], parallel: true, complete: true, with: "2026-11-24T09-00-00Z", both: true, picks: [[1.5, -2, 0.25], [500000.125, 4600000.5, -2]], size: 3, shading: false, cutaway: false, field: "distance", map: "cividis", limits: [null, 12.5],
    box: [null, -3, null, 4, null, 2.5], section: { across: "y", offset_m: -1.25, thick_m: 0.2 }, until_s: 1.5,
  };
  assert.deepEqual(fromHash(toHash(state)), state);
  assert.match(toHash(state), /camera=-2\.05,0\.62,31\.5,1,-2,0\.25/);
});

test("what has no limit is left out, and what is not a view is ignored", () => {
  assert.equal(toHash({ limits: [null, null], box: [null, null, null, null, null, null] }), "#");
  assert.deepEqual(fromHash(""), {});
  assert.deepEqual(fromHash("#field=smell&map=red&camera=1,2&camera=x&limits=1&box=a,,,,,&section=w,1,1&until=soon&parallel=yes"), {});
  assert.deepEqual(fromHash("#field=distance&picks=1,2&size=big&shading=1&cutaway=yes&complete=0&both=2"), {});
  assert.equal(toHash({ size: 1.5, shading: true, cutaway: true, both: false, complete: false, picks: [] }), "#");
  assert.deepEqual(fromHash("#camera=,1,1,1,1,1&section=x,1,0"), {});
});
