import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { along_curve } = await load("order.ts");

/** Diagonal of the box around points. */
function extent(positions, numbers) {
  const axis = (a) => [...numbers].map((i) => positions[3 * i + a]);
  return Math.hypot(...[0, 1, 2].map((a) => Math.max(...axis(a)) - Math.min(...axis(a))));
}

test("all points are ordered, and neighbours in the list are neighbours in space", () => {
  // A grid of 32 by 32 by 32, numbered in a scattered way.
  const count = 8 * 4096;
  const positions = new Float32Array(3 * count);
  for (let i = 0; i < count; i += 1) {
    const place = (i * 12_345) % count;
    positions.set([place % 32, Math.floor(place / 32) % 32, Math.floor(place / 1_024)], 3 * i);
  }
  const order = along_curve(positions);
  assert.deepEqual([...order].sort((a, b) => a - b), Array.from({ length: count }, (_, i) => i));
  // Each eighth is an octant, 15 wide.
  for (let part = 0; part < 8; part += 1) {
    const diagonal = extent(positions, order.subarray(part * 4096, (part + 1) * 4096));
    assert.equal(diagonal, Math.hypot(15, 15, 15), String(part));
  }
});

test("points in a plane, at one place, and none are ordered", () => {
  const plane = Float32Array.from({ length: 300 }, (_, i) => (i % 3 === 2 ? 1 : i));
  assert.equal(new Set(along_curve(plane)).size, 100);
  assert.deepEqual([...along_curve(new Float32Array(9).fill(5))], [0, 1, 2]);
  assert.equal(along_curve(new Float32Array(0)).length, 0);
});
