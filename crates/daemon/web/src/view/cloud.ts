// Points on the graphics card, in chunks.

import { BufferAttribute, BufferGeometry, DynamicDrawUsage, Group, Points, type RawShaderMaterial, Sphere, Vector3 } from "three";

import { COLUMNS, type Columns } from "../frame.ts";
import { type Ranges, Sample } from "../sample.ts";
import { type Eye, detailed } from "./detail.ts";

/** Points per chunk of a growing cloud. */
const CHUNK = 65_536;
const FAR = new Sphere(new Vector3(), 1e4);

/** The shader's name of a column. */
const ATTRIBUTES: Record<(typeof COLUMNS)[number], string> = { times: "time", sds: "sd", tilts: "tilt", intensities: "intensity", rings: "ring", lasers: "laser", echoes: "echo", distances: "distance_m" };

function chunk(columns: Columns, material: RawShaderMaterial): Points {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new BufferAttribute(columns.positions, 3));
  for (const name of COLUMNS) {
    // Without an attribute the shader reads zero.
    if (columns[name].length > 0) geometry.setAttribute(ATTRIBUTES[name], new BufferAttribute(columns[name], 1));
  }
  return new Points(geometry, material);
}

/** A downloaded cloud, stored on the graphics card only. */
export class Loaded {
  readonly group = new Group();
  ranges: Ranges | null = null;
  count = 0;

  constructor(private readonly material: RawShaderMaterial) {}

  add(columns: Columns, ranges: Ranges | null): void {
    const points = chunk(columns, this.material);
    points.geometry.computeBoundingSphere();
    for (const attribute of Object.values(points.geometry.attributes)) {
      if (attribute instanceof BufferAttribute) attribute.onUpload(forget);
    }
    points.userData["count"] = columns.count;
    this.group.add(points);
    this.ranges = ranges;
    this.count += columns.count;
  }

  /** The chunks, whose points are in random order. */
  get chunks(): Points[] {
    return this.group.children as Points[];
  }

  dispose(): void {
    for (const child of this.group.children) (child as Points).geometry.dispose();
    this.group.removeFromParent();
  }
}

/** Draws about so many points of all clouds that are shown, where the picture shows them; without an eye all points. */
export function draw(clouds: Loaded[], eye: Eye | null, budget: number): void {
  const chunks = clouds.filter(({ group }) => group.visible && group.parent !== null).flatMap((cloud) => cloud.chunks);
  const ball = new Sphere();
  const parts = chunks.map((points) => {
    const count = points.userData["count"] as number;
    points.updateWorldMatrix(true, false);
    return { count, area_px: eye?.area_px(ball.copy(points.geometry.boundingSphere ?? FAR).applyMatrix4(points.matrixWorld)) ?? 0 };
  });
  const counts = eye === null ? parts.map(({ count }) => count) : detailed(parts, budget);
  chunks.forEach((points, i) => points.geometry.setDrawRange(0, counts[i] ?? 0));
}

/** Frees the main memory of an uploaded attribute. */
function forget(this: BufferAttribute): void {
  (this as { array: ArrayLike<number> }).array = new (this.array.constructor as new (n: number) => Float32Array)(0);
}

/** A cloud that grows during a scan. If it has too many points, every second one is removed. */
export class Live {
  readonly group = new Group();
  /** Points received, kept or not. */
  received = 0;
  private sample = new Sample();
  private stride = 1;
  private skip = 0;
  private kept = 0;
  private start_s: number | null = null;
  private chunks: { columns: Columns; points: Points }[] = [];

  constructor(
    private readonly material: RawShaderMaterial,
    private readonly most: number,
  ) {}

  get count(): number {
    return this.kept;
  }

  get ranges(): Ranges | null {
    return this.sample.ranges();
  }

  add(columns: Columns, start_s: number): void {
    this.start_s ??= start_s;
    const offset_s = start_s - this.start_s;
    this.sample.add(columns, offset_s);
    this.received += columns.count;
    let i = this.skip;
    for (; i < columns.count; i += this.stride) this.append(columns, i, offset_s);
    this.skip = i - columns.count;
    for (const { columns: c, points } of this.chunks) upload(points, c.count);
    if (this.kept > this.most) this.halve();
  }

  dispose(): void {
    for (const { points } of this.chunks) points.geometry.dispose();
    this.group.removeFromParent();
  }

  private append(from: Columns, i: number, offset_s: number): void {
    let last = this.chunks.at(-1);
    if (last === undefined || last.columns.count === CHUNK) {
      last = this.grow();
    }
    const { columns: to } = last;
    const at = to.count;
    to.positions[3 * at] = from.positions[3 * i] ?? 0;
    to.positions[3 * at + 1] = from.positions[3 * i + 1] ?? 0;
    to.positions[3 * at + 2] = from.positions[3 * i + 2] ?? 0;
    for (const name of COLUMNS) if (to[name].length > 0) to[name][at] = from[name][i] ?? 0;
    to.times[at] = (from.times[i] ?? 0) + offset_s;
    to.count += 1;
    this.kept += 1;
  }

  private grow(): { columns: Columns; points: Points } {
    const columns: Columns = {
      count: 0,
      positions: new Float32Array(3 * CHUNK),
      times: new Float32Array(CHUNK),
      sds: new Float32Array(CHUNK),
      tilts: new Float32Array(CHUNK),
      intensities: new Uint8Array(CHUNK),
      rings: new Uint8Array(CHUNK),
      lasers: new Uint8Array(0),
      echoes: new Uint8Array(0),
      distances: new Float32Array(0),
    };
    const points = chunk(columns, this.material);
    points.geometry.boundingSphere = FAR;
    points.frustumCulled = false;
    for (const attribute of Object.values(points.geometry.attributes)) {
      if (attribute instanceof BufferAttribute) attribute.setUsage(DynamicDrawUsage);
    }
    const grown = { columns, points };
    points.userData["uploaded"] = 0;
    this.group.add(points);
    this.chunks.push(grown);
    return grown;
  }

  private halve(): void {
    const old = this.chunks;
    this.chunks = [];
    this.kept = 0;
    for (const { columns, points } of old) {
      for (let i = 0; i < columns.count; i += 2) this.append(columns, i, 0);
      points.geometry.dispose();
      points.removeFromParent();
    }
    this.stride *= 2;
    for (const { columns, points } of this.chunks) upload(points, columns.count);
  }
}

/** Uploads the new points of a chunk. */
function upload(points: Points, count: number): void {
  const uploaded = points.userData["uploaded"] as number;
  if (uploaded === count) return;
  for (const attribute of Object.values(points.geometry.attributes)) {
    if (!(attribute instanceof BufferAttribute)) continue;
    attribute.addUpdateRange(uploaded * attribute.itemSize, (count - uploaded) * attribute.itemSize);
    attribute.needsUpdate = true;
  }
  points.geometry.setDrawRange(0, count);
  points.userData["uploaded"] = count;
}
