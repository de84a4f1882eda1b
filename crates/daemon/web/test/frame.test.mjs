import assert from "node:assert/strict";
import test from "node:test";

import { load } from "./bundle.mjs";

const { parseFrame } = await load("frame.ts");
const { Sample } = await load("sample.ts");

function frame(count) {
  const bytes = new ArrayBuffer(32 + 22 * count);
  const view = new DataView(bytes);
  [..."VMP1"].forEach((letter, i) => view.setUint8(i, letter.charCodeAt(0)));
  view.setUint32(4, count, true);
  view.setFloat64(8, 1.76e9 + 0.25, true);
  view.setUint32(16, 7, true);
  view.setUint32(20, 3, true);
  view.setFloat32(24, -12.5, true);
  for (let i = 0; i < count; i += 1) {
    [i, 2 * i, 3 * i].forEach((value, c) => view.setFloat32(32 + 12 * i + 4 * c, value, true));
    view.setFloat32(32 + 12 * count + 4 * i, 0.5 * i, true);
    view.setFloat32(32 + 16 * count + 4 * i, 0.25 * i, true);
    view.setUint8(32 + 20 * count + i, 100 + i);
    view.setUint8(32 + 21 * count + i, i);
  }
  return bytes;
}

test("a frame is parsed at the documented offsets", () => {
  const { start_s, number, left_out, tilt_deg, positions, times, sds, intensities, rings } = parseFrame(frame(3));
  assert.deepEqual([start_s, number, left_out, tilt_deg], [1.76e9 + 0.25, 7, 3, -12.5]);
  assert.deepEqual([...positions], [0, 0, 0, 1, 2, 3, 2, 4, 6]);
  assert.deepEqual([[...times], [...sds]], [[0, 0.5, 1], [0, 0.25, 0.5]]);
  assert.deepEqual([[...intensities], [...rings]], [[100, 101, 102], [0, 1, 2]]);
});

test("other bytes are no frame", () => {
  assert.equal(parseFrame(new ArrayBuffer(10)), null);
  assert.equal(parseFrame(new ArrayBuffer(32)), null);
  assert.equal(parseFrame(frame(3).slice(0, 90)), null);
  const many = frame(1);
  new DataView(many).setUint32(4, 0xffffffff, true);
  assert.equal(parseFrame(many), null);
});

test("ranges ignore single outliers and stay small", () => {
  const sample = new Sample();
  const count = 50_000;
  const columns = {
    count, positions: new Float32Array(3 * count), times: new Float32Array(count).fill(2), sds: new Float32Array(count).fill(0.003),
    intensities: new Uint8Array(count).fill(50), rings: new Uint8Array(count).fill(15), tilts: [], lasers: [], echoes: [], distances: [],
  };
  for (let i = 0; i < count; i += 1) columns.positions[3 * i + 2] = i === 0 ? 1e6 : (i % 1000) / 100;
  for (let batch = 0; batch < 4; batch += 1) sample.add(columns, batch);
  const ranges = sample.ranges();
  assert.ok(Math.abs(ranges.height.low - 0.1) < 0.3 && Math.abs(ranges.height.high - 9.9) < 0.3);
  assert.deepEqual(ranges.ring, { low: 0, high: 15 });
  assert.equal(ranges.time.high, 5);
  assert.ok(ranges.sd.low <= 0.0031 && ranges.reach_m < 11);
  assert.equal(new Sample().ranges(), null);
});
