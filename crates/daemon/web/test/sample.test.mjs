import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { Sample, tiltAt } = await load("sample.ts");
const none = { times: [], sds: [], tilts: [], intensities: [], rings: [], lasers: [], echoes: [], distances: [] };

/** A grid of points around a place. */
function grid(x0, y0, z0) {
  const positions = [];
  for (let i = 0; i < 400; i += 1) positions.push(x0 + (i % 20) - 9.5, y0 + Math.floor(i / 20) - 9.5, z0 + 0.01 * i);
  return { ...none, count: 400, positions: new Float32Array(positions) };
}

test("a cloud around its origin is seen from there, another one from its middle", () => {
  const own = new Sample();
  own.add(grid(0, 0, 0));
  assert.deepEqual(own.ranges().centre, [0, 0, 0]);
  const other = new Sample();
  other.add(grid(500, -300, 20));
  const { centre, reach_m } = other.ranges();
  assert.ok(Math.abs(centre[0] - 500) < 1 && Math.abs(centre[1] + 300) < 1 && Math.abs(centre[2] - 22) < 1, String(centre));
  assert.ok(reach_m < 15, String(reach_m));
});

test("a cloud ends at its latest time, in whatever order its points are", () => {
  const sample = new Sample();
  sample.add({ ...grid(0, 0, 0), times: Float32Array.from({ length: 400 }, (_, i) => 400 - i) });
  assert.equal(sample.ranges().end_s, 400);
});

test("columns that a cloud lacks have no range", () => {
  const sample = new Sample();
  sample.add(grid(0, 0, 0));
  const { ring, time, intensity, sd, end_s, range } = sample.ranges();
  assert.deepEqual([ring, time, intensity, sd, end_s], [null, null, null, null, 0]);
  assert.ok(range.low > 0 && range.high < 15);
});

test("distances have a range from 0, and the shares that the note states", () => {
  const sample = new Sample();
  sample.add({ ...grid(0, 0, 0), distances: Float32Array.from({ length: 400 }, (_, i) => 0.001 * i) });
  const { distance, within_m } = sample.ranges();
  assert.deepEqual([distance.low, ...[distance.high, within_m.p50, within_m.p95].map((m) => m.toFixed(3))], [0, "0.388", "0.200", "0.380"]);
});

test("the tilt at a time is that of the latest point before", () => {
  const sample = new Sample();
  const times = Float32Array.from({ length: 400 }, (_, i) => 0.01 * i);
  sample.add({ ...grid(0, 0, 0), times, tilts: times.map((time) => -10 * time) });
  const { track, end_s } = sample.ranges();
  assert.ok(Math.abs(end_s - 3.99) < 1e-6);
  assert.ok(Math.abs(tiltAt(track, 2.004) + 20) < 1e-4);
  assert.ok(Math.abs(tiltAt(track, -1)) < 1e-6);
  assert.equal(tiltAt({ times: [], tilts: [] }, 1), null);
});
