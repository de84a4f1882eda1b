import assert from "node:assert/strict";
import test from "node:test";

import { load } from "./bundle.mjs";

const { limit, seen } = await load("view/density_sphere.ts");

const bin = (direction, points = 1) => ({ direction, points });

test("the half of the sphere toward which the view looks is seen, as the view shows it", () => {
  // The edge of the half is rounded to either side.
  const [right, forward, back, up] = [bin([1, 1e-6, 0], 1), bin([0, 1, 0], 2), bin([0, -1, 0], 3), bin([0, 1e-6, 1], 4)];
  // From behind the scanner: forward is in the middle, x to the right.
  const behind = seen([right, forward, back, up], -Math.PI / 2, 0);
  const at = (points) => behind.find((one) => one.points === points);
  assert.equal(at(3), undefined);
  assert.ok(Math.hypot(at(2).x, at(2).y) < 1e-12 && Math.abs(at(2).flat - 1) < 1e-12);
  assert.ok(Math.abs(at(1).x - 1) < 1e-12 && Math.abs(at(4).y - 1) < 1e-12);
  // From above: forward is up.
  const above = seen([bin([0, 1, -1e-6], 2), bin([0, 0, -1], 5)], -Math.PI / 2, Math.PI / 2);
  assert.ok(above.some(({ x, y, points }) => points === 2 && Math.abs(x) < 1e-12 && Math.abs(y - 1) < 1e-12));
  assert.ok(above.some(({ flat, points }) => points === 5 && flat > 0.999));
});

test("colours end where few bins have more points", () => {
  assert.equal(limit(Array.from({ length: 100 }, (_, i) => bin([0, 0, 1], i))), 97);
  assert.equal(limit([bin([0, 0, 1], 0)]), 1);
});
