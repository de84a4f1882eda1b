import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { detailed, Eye } = await load("view/detail.ts");
const { PerspectiveCamera, Sphere, Vector3 } = await import("three");

test("the budget goes where the picture shows the points", () => {
  const parts = [{ count: 30_000, area_px: 100_000 }, { count: 30_000, area_px: 1_000 }, { count: 30_000, area_px: 0 }];
  // Within the budget: no more than four points per pixel, and none out of view.
  assert.deepEqual(detailed(parts, 1e6), [30_000, 4_000, 0]);
  const few = detailed(parts, 3_400);
  assert.deepEqual(few, [3_000, 400, 0]);
  // A part that is smaller than a pixel is drawn.
  assert.deepEqual(detailed([{ count: 30_000, area_px: 0.1 }, { count: 8, area_px: 0.1 }], 1e6), [32, 8]);
  assert.deepEqual(detailed([], 1e6), []);
});

test("near parts cover more pixels than far ones, those behind the camera none", () => {
  const camera = new PerspectiveCamera(50, 1.6, 0.1, 1_000);
  camera.up.set(0, 0, 1);
  camera.position.set(0, 0, 0);
  camera.lookAt(1, 0, 0);
  const eye = new Eye(camera, 900, 0);
  const area = (x, radius) => eye.area_px(new Sphere(new Vector3(x, 0, 0), radius));
  // 1 m at 10 m: 900 / (2 tan 25 deg) / sqrt(99) = 97.0 px.
  assert.ok(Math.abs(area(10, 1) - Math.PI * 97.0 ** 2) < 50, String(area(10, 1)));
  assert.ok(area(10, 1) > 3.9 * area(20, 1));
  assert.equal(area(-10, 1), 0);
  // Around the camera: the whole picture.
  assert.equal(area(0, 5), 900 * 900 * 1.6);
  // In a parallel view the distance does not matter.
  const parallel = new Eye(camera, 900, 15);
  const at = (x) => parallel.area_px(new Sphere(new Vector3(x, 0, 0), 1));
  assert.equal(at(10), at(20));
});
