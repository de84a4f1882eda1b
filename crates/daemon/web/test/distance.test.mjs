import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { MOST_M, PointTree } = await load("distance.ts");

/** Numbers from 0 to 1, the same in each run. */
function random(seed) {
  return () => {
    seed = (Math.imul(seed, 1_664_525) + 1_013_904_223) >>> 0;
    return seed / 2 ** 32;
  };
}

/** The nearest point's distance by trying all. */
function tried(points, x, y, z) {
  let least = MOST_M;
  for (let i = 0; i < points.length; i += 3) least = Math.min(least, Math.hypot(points[i] - x, points[i + 1] - y, points[i + 2] - z));
  return least;
}

/** Checks distances of places against all points. */
function check(points, places) {
  const tree = new PointTree(points.slice());
  tree.distances(Float32Array.from(places), [0, 0, 0]).forEach((distance, i) => {
    const expected = tried(points, places[3 * i], places[3 * i + 1], places[3 * i + 2]);
    assert.ok(Math.abs(distance - expected) < 1e-6, `place ${i}: ${distance} m, expected ${expected} m`);
  });
}

test("distances are those of the nearest points, also of negative coordinates and beyond 1 m", () => {
  const next = random(7);
  const cloud = (count, size) => Float32Array.from({ length: 3 * count }, () => size * (next() - 0.5));
  for (const size of [0.1, 3, 30]) check(cloud(2_000, size), cloud(500, 1.2 * size));
});

test("points of a wall, a line, a lattice and one place are found", () => {
  const next = random(8);
  const places = Float32Array.from({ length: 900 }, () => Math.round(8 * (next() - 0.5)) / 4);
  const made = (point) => Float32Array.from(Array.from({ length: 1_000 }, (_, i) => point(i)).flat());
  check(made((i) => [0.05 * (i % 40) - 1, 0.05 * Math.floor(i / 40) - 1, -0.5]), places);
  check(made((i) => [0.01 * i - 5, 0, 0]), places);
  check(made((i) => [0.25 * (i % 10) - 1, 0.25 * (Math.floor(i / 10) % 10) - 1, 0.25 * Math.floor(i / 100) - 1]), places);
  check(made(() => [0.25, -0.25, 0.5]), places);
});

test("an empty cloud, and one beyond 1 m, give exactly 1 m", () => {
  assert.equal(new PointTree(new Float32Array(0)).distance(0, 0, 0), 1);
  const tree = new PointTree(new Float32Array([1, 0, 0, -5, 0, 0]));
  assert.equal(tree.distance(0, 0, 0), 1);
  assert.equal(tree.distance(-2.5, 0, 0), 1);
  assert.equal(tree.distance(0.5, 0, 0), 0.5);
  assert.equal(tree.distance(1, 0, 0), 0);
  assert.deepEqual([...tree.distances(new Float32Array(0), [0, 0, 0])], []);
});

test("points that are not finite are left out", () => {
  const points = Float32Array.from({ length: 300 }, (_, i) => (i % 6 === 1 ? NaN : 0.01 * i));
  const tree = new PointTree(points);
  assert.equal(tree.count, 50);
  assert.equal(tree.distance(NaN, 0, 0), 1);
  assert.ok(tree.distance(0.03, 0.04, 0.05) < 1e-6);
});

test("other origins are subtracted without loss", () => {
  const tree = new PointTree(new Float32Array([1, 2, 3]));
  const [distance] = tree.distances(new Float32Array([-99, 202, 3.25]), [100, -200, 0]);
  assert.equal(distance, 0.25);
  assert.equal(tree.distances(new Float32Array([1, 2, 3]), [500_000, 0, 0])[0], 1);
});
