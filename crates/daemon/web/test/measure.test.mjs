import assert from "node:assert/strict";
import { test } from "node:test";
import { load } from "./bundle.mjs";

const { distance, scaleBar } = await load("view/measure.ts");
const point = (x, y, z, sd_m) => ({ position: [x, y, z], sd_m });

test("the uncertainty of a distance adds those of its ends in quadrature", () => {
  const found = distance(point(1, 2, 3, 0.003), point(1, 5, 7, 0.004));
  assert.equal(found.m, 5);
  assert.ok(Math.abs(found.sd_m - 0.005) < 1e-12);
  assert.deepEqual(found.along_m, [0, 3, 4]);
  assert.equal(distance(point(0, 0, 0, 0), point(1, 0, 0, 0.004)).sd_m, null);
});

test("scale bars have round lengths and fit", () => {
  for (const [metres_per_px, words] of [[0.1, "5 m"], [0.0123, "1 m"], [0.0055, "50 cm"], [0.0001, "5 mm"], [3, "200 m"]]) {
    const bar = scaleBar(metres_per_px, 96, true);
    assert.equal(bar.words, words);
    assert.equal(scaleBar(metres_per_px, 96, false).words, `\u2248 ${words}`, "in perspective");
    assert.ok(bar.px <= 96 && bar.px > 96 / 2.6, `${bar.px} px`);
    assert.ok(Math.abs(bar.px * metres_per_px - bar.m) < 1e-9);
  }
});

test("a picked point is read anew from the nearest point within 5 cm", async () => {
  const { nearer } = await load("picked.ts");
  const none = new Uint8Array(0);
  const columns = (x) => ({
    count: 2, positions: new Float32Array([x, 2, 3, x, 2, 3.1]), times: new Float32Array([4, 5]), sds: new Float32Array([0.001, 0.002]), tilts: none, intensities: none,
    rings: new Uint8Array([7, 8]), lasers: new Uint8Array([9, 10]), echoes: none, distances: none,
  });
  const first = nearer(columns(1.01), [1, 2, 3.1], null);
  assert.deepEqual([first.picked.time_s, first.picked.ring, first.picked.laser, first.picked.intensity, first.picked.complete], [5, 8, 10, 0, true]);
  assert.ok(Math.abs(first.off_m - 0.01) < 1e-6);
  const exact = nearer(columns(1), [1, 2, 3], first);
  assert.deepEqual([exact.off_m, exact.picked.ring], [0, 7]);
  assert.equal(nearer(columns(1.02), [1, 2, 3], exact), exact);
  assert.equal(nearer(columns(1.06), [1, 2, 3], null), null);
});
