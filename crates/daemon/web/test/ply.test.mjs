import assert from "node:assert/strict";
import test from "node:test";

import { load } from "./bundle.mjs";

const { PlyReader } = await load("ply.ts");

/** A file as the daemon writes it, with `sd` where asked, and what it holds. */
function file(count, sd) {
  const head = `ply\nformat binary_little_endian 1.0\ncomment made up\ncomment room for the count ...\nelement vertex ${count}\n`
    + "property float x\nproperty float y\nproperty float z\nproperty float intensity\nproperty uchar ring\nproperty double time\nproperty float tilt\n"
    + (sd ? "property float sd\n" : "") + "end_header\n";
  const row = sd ? 33 : 29;
  const bytes = Buffer.alloc(head.length + row * count);
  bytes.write(head, "latin1");
  for (let i = 0; i < count; i += 1) {
    const at = head.length + row * i;
    [i, -i, 0.5 * i, i % 256].forEach((value, c) => bytes.writeFloatLE(value, at + 4 * c));
    bytes.writeUInt8(i % 16, at + 16);
    bytes.writeDoubleLE(1.76e9 + 0.001 * i, at + 17);
    bytes.writeFloatLE(-45, at + 25);
    if (sd) bytes.writeFloatLE(0.001 * i, at + 29);
  }
  return bytes;
}

function read(bytes, piece, batch = 100) {
  const reader = new PlyReader(batch);
  const batches = [];
  for (let at = 0; at < bytes.length; at += piece) batches.push(...reader.push(bytes.subarray(at, at + piece)));
  batches.push(...reader.end());
  return batches;
}

for (const piece of [1, 7, 64, 1000, 1e9]) {
  test(`whatever pieces of ${piece} the network gives, the points are the same`, () => {
    const batches = read(file(250, true), piece);
    assert.deepEqual(batches.map((b) => b.count), [100, 100, 50]);
    let i = 0;
    for (const b of batches) {
      for (let k = 0; k < b.count; k += 1, i += 1) {
        assert.deepEqual([...b.positions.subarray(3 * k, 3 * k + 3)], [i, i === 0 ? -0 : -i, 0.5 * i]);
        assert.equal(b.intensities[k], i % 256);
        assert.equal(b.rings[k], i % 16);
        assert.ok(Math.abs(b.times[k] - 0.001 * i) < 1e-6);
        assert.ok(Math.abs(b.sds[k] - 0.001 * i) < 1e-6);
      }
    }
    assert.equal(i, 250);
  });
}

test("a missing column is empty", () => assert.equal(read(file(3, false), 50)[0].sds.length, 0));
test("an empty cloud has no points", () => assert.deepEqual(read(file(0, false), 50), []));
test("a truncated file is an error", () => {
  const bytes = file(250, false);
  assert.throws(() => read(bytes.subarray(0, bytes.length - 1), 64), /249 of 250/);
});
test("other files are refused", () => {
  assert.throws(() => read(Buffer.from('{"error": "no such scan"}'), 5), /not a PLY file/);
  assert.throws(() => read(Buffer.from("ply\nformat ascii 1.0\nelement vertex 0\nend_header\n"), 500), /ascii/);
});
