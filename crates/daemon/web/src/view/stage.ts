// The scene: camera, points, scanner, rings on the floor, depth shading. Draws only after a change.

import {
  BufferAttribute, BufferGeometry, ClampToEdgeWrapping, ColorManagement, DataTexture, DepthTexture, GLSL3, Group, LinearSRGBColorSpace, LineSegments,
  Matrix4, Mesh, NearestFilter, NoBlending, OrthographicCamera, PerspectiveCamera, RawShaderMaterial, RGBAFormat, RGBAIntegerFormat, Scene, UnsignedIntType,
  Vector2, Vector3, Vector4, WebGLRenderer, WebGLRenderTarget,
} from "three";

import type { Picked } from "../picked.ts";
import type { Range } from "../sample.ts";
import { Eye } from "./detail.ts";
import { STEPS } from "./maps.ts";
import { Orbit } from "./orbit.ts";
import * as shaders from "./shaders.ts";

/** Colours are used as given, without conversion. */
ColorManagement.enabled = false;

type Rgb = [number, number, number];
/** If the browser can draw again only after longer while the view moves, the next picture has fewer points. */
const SLOW_MS = 45;
const QUICK_MS = 20;
/** After so many quick pictures in a row one has more points: the browser queues two on the graphics card. */
const QUICK_ONES = 3;
/** The view rests after so long without a move, and so many times the longest picture up to a limit: moves wait for pictures, too. */
const REST_MS = 180;
const REST_PICTURES = 2.5;
const MOST_REST_MS = 2_000;
/** Pictures after a rest that wait for the whole one. */
const WAITING = 3;
/** Points of a picture of a moving view: the first ones, and the limits. */
/** A time after every point; the graphics card has 32 bits. */
export const ALL_S = 3e38;
const FIRST_BUDGET = 1e6;
const LEAST_BUDGET = 1e5;
const MOST_BUDGET = 2e7;

/** A direction to look from. */
export type Preset = "usual" | "top" | "front" | "side" | "scanner";

/** Radius in which a pick takes the nearest point, pixels of the page: a finger is less precise. */
const PICK_PX = { mouse: 6, touch: 16 };

export class Stage {
  readonly orbit: Orbit;
  readonly points: RawShaderMaterial;
  /** The material of the cloud with which another is compared. */
  readonly plain: RawShaderMaterial;
  readonly scene = new Scene();
  /** The cloud with which another is compared; its points are not picked. */
  readonly other = new Group();
  /** Called with the eye and the number of points to draw; without an eye all are. */
  detail: (eye: Eye | null, budget: number) => void = () => {};
  /** Called after each picture. */
  drawn: () => void = () => {};
  /** What is drawn besides the points. */
  private readonly furniture = new Group();
  private readonly pick: RawShaderMaterial;
  private readonly renderer: WebGLRenderer;
  private readonly camera = new PerspectiveCamera(50, 1, 0.1, 1_000);
  private readonly target = new WebGLRenderTarget(1, 1, { minFilter: NearestFilter, magFilter: NearestFilter });
  private readonly screen = new Scene();
  private readonly flat = new OrthographicCamera();
  private readonly shade: RawShaderMaterial;
  private readonly ink = { grid: line(), scanner: line(), beam: line() };
  private readonly head = new Group();
  private readonly colours: DataTexture;
  private background: Rgb = [0, 0, 0];
  private frame = 0;
  private rest = 0;
  private moving = false;
  private budget = FIRST_BUDGET;
  private quick = 0;
  private longest_ms = 0;
  private waiting = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    this.renderer = new WebGLRenderer({ canvas, antialias: false, powerPreference: "high-performance" });
    this.renderer.outputColorSpace = LinearSRGBColorSpace;
    this.renderer.autoClear = false;
    this.colours = new DataTexture(new Uint8Array(4 * STEPS), STEPS, 1, RGBAFormat);
    this.colours.wrapS = ClampToEdgeWrapping;
    this.points = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: shaders.POINT_VERTEX,
      fragmentShader: shaders.POINT_FRAGMENT,
      uniforms: {
        eye: { value: new Vector3() }, size: { value: 2 }, height_px: { value: 1 }, field: { value: 0 }, parallel_m: { value: 0 },
        limits: { value: new Vector2(0, 1) }, below: { value: new Vector4() }, above: { value: new Vector4() },
        box_low: { value: new Vector3(-1e6, -1e6, -1e6) }, box_high: { value: new Vector3(1e6, 1e6, 1e6) }, section: { value: new Vector4() },
        section_half_m: { value: 1e6 }, until_s: { value: ALL_S }, cutaway: { value: true }, ceiling_m: { value: 1e6 }, colours: { value: this.colours },
      },
    });
    // The same values, so that both clouds are cut alike.
    this.plain = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: shaders.PLAIN_VERTEX, fragmentShader: shaders.POINT_FRAGMENT, uniforms: { ...this.points.uniforms, ink: { value: new Vector3() } },
    });
    this.pick = new RawShaderMaterial({
      glslVersion: GLSL3, vertexShader: shaders.PICK_VERTEX, fragmentShader: shaders.PICK_FRAGMENT, uniforms: this.points.uniforms, blending: NoBlending,
    });
    this.target.depthTexture = new DepthTexture(1, 1);
    this.shade = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: shaders.SCREEN_VERTEX,
      fragmentShader: shaders.SCREEN_FRAGMENT,
      depthTest: false,
      uniforms: {
        picture: { value: this.target.texture }, depth: { value: this.target.depthTexture }, pixel_size: { value: new Vector2() },
        clip: { value: new Vector2() }, strength: { value: 9 }, parallel_m: { value: 0 },
      },
    });
    const triangle = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    const cover = new Mesh(triangle, this.shade);
    cover.frustumCulled = false;
    this.screen.add(cover);
    this.furniture.add(rings(this.ink.grid), tripod(this.ink.scanner), this.head);
    this.scene.add(this.furniture, this.other);
    this.head.add(scanner(this.ink.beam));
    this.orbit = new Orbit(this.camera, canvas, () => this.moved());
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  /** Sets one of the standard views at a distance where `reach_m` around the centre fits. Front looks forward, side to the left. */
  fit(reach_m: number, centre: [number, number, number], from: Preset = "usual"): void {
    const target = new Vector3(...centre);
    const wide = 2.4 / this.camera.aspect;
    const whole = Math.max(2.2, wide) * reach_m;
    if (from === "top") this.orbit.look(-Math.PI / 2, Math.PI / 2 - 1e-3, whole, target);
    else if (from === "front") this.orbit.look(-Math.PI / 2, 0, whole, target);
    else if (from === "side") this.orbit.look(0, 0, whole, target);
    else if (from === "scanner") this.orbit.look(-Math.PI / 2, 0.15, Math.max(2, reach_m / 8));
    else this.orbit.look(-2.05, 0.62, Math.max(1.5, wide) * reach_m, target);
  }

  /** Shows or hides the scanner and the rings at its foot: other clouds have other origins. */
  setScanner(shown: boolean): void {
    this.furniture.visible = shown;
    this.draw();
  }

  /** The values of the point that is drawn nearest to a place of the canvas, in pixels of the page; null if none is near. */
  pickAt(x: number, y: number, touch: boolean): Picked | null {
    const size = this.renderer.getDrawingBufferSize(new Vector2());
    const scale = size.y / Math.max(1, this.canvas.clientHeight);
    const side = 2 * Math.round(PICK_PX[touch ? "touch" : "mouse"] * scale) + 1;
    const integers = { count: 3, format: RGBAIntegerFormat, type: UnsignedIntType, internalFormat: "RGBA32UI", minFilter: NearestFilter, magFilter: NearestFilter } as const;
    const target = new WebGLRenderTarget(side, side, integers);
    // Enlarges the square around the place to the whole target.
    const [right, up] = [(2 * x) / this.canvas.clientWidth - 1, 1 - (2 * y) / this.canvas.clientHeight];
    const enlarge = new Matrix4().makeScale(size.x / side, size.y / side, 1).multiply(new Matrix4().makeTranslation(-right, -up, 0));
    const projection = this.camera.projectionMatrix.clone();
    const context = this.renderer.getContext() as WebGL2RenderingContext;
    const shown = this.furniture.visible;
    const read = new Uint32Array(12 * side * side);
    try {
      this.detail(null, Infinity);
      this.prepare();
      this.camera.projectionMatrix.premultiply(enlarge);
      this.furniture.visible = this.other.visible = false;
      this.scene.overrideMaterial = this.pick;
      this.renderer.setRenderTarget(target);
      this.renderer.state.buffers.depth.setMask(true);
      for (const buffer of [0, 1, 2]) context.clearBufferuiv(context.COLOR, buffer, new Uint32Array(4));
      context.clear(context.DEPTH_BUFFER_BIT);
      this.renderer.render(this.scene, this.camera);
      for (const buffer of [0, 1, 2]) {
        context.readBuffer(context.COLOR_ATTACHMENT0 + buffer);
        context.readPixels(0, 0, side, side, context.RGBA_INTEGER, context.UNSIGNED_INT, read, 4 * side * side * buffer);
      }
    } finally {
      this.scene.overrideMaterial = null;
      this.furniture.visible = shown;
      this.other.visible = true;
      this.camera.projectionMatrix.copy(projection);
      this.renderer.setRenderTarget(null);
      target.dispose();
    }
    return nearest(read, side);
  }

  /** Place of a point on the canvas, in pixels of the page; null behind the camera. */
  project(position: [number, number, number]): [number, number] | null {
    const at = new Vector3(...position).project(this.camera);
    if (Math.abs(at.z) > 1) return null;
    return [((at.x + 1) / 2) * this.canvas.clientWidth, ((1 - at.y) / 2) * this.canvas.clientHeight];
  }

  /** Directions of x, y and z on the canvas: right and down, at most 1 long. */
  axes(): [number, number][] {
    const m = this.camera.matrix.elements;
    return [0, 1, 2].map((axis) => [m[axis] ?? 0, -(m[4 + axis] ?? 0)]);
  }

  /** Direction in which the camera looks. */
  get forward(): [number, number, number] {
    const m = this.camera.matrix.elements;
    return [-m[8], -m[9], -m[10]];
  }

  /** Metres per pixel of the page at the target. */
  get metres_per_px(): number {
    return this.orbit.span_m / Math.max(1, this.canvas.clientHeight);
  }

  /** The picture as it is now. */
  picture(): HTMLCanvasElement {
    this.moving = false;
    this.render();
    return this.canvas;
  }

  /** Points outside of these limits are hidden, metres. */
  setBox(low: number[], high: number[]): void {
    (this.points.uniforms["box_low"] as { value: Vector3 }).value.fromArray(low);
    (this.points.uniforms["box_high"] as { value: Vector3 }).value.fromArray(high);
    this.draw();
  }

  /** Points farther than half a thickness from a plane are hidden. */
  setSection(normal: number[], offset_m: number, half_m: number): void {
    (this.points.uniforms["section"] as { value: Vector4 }).value.fromArray([...normal, offset_m]);
    this.uniform("section_half_m", half_m);
  }

  /** Colours of the values below and above the limits; null colours them like the limit. */
  setMarks(marks: (Rgb | null)[]): void {
    for (const [i, name] of ["below", "above"].entries()) {
      const mark = marks[i] ?? null;
      (this.points.uniforms[name] as { value: Vector4 }).value.set(...(mark ?? [0, 0, 0]), mark === null ? 0 : 1);
    }
    this.draw();
  }

  setBackground(background: Rgb, grid: Rgb, scanner: Rgb, beam: Rgb): void {
    this.background = background;
    (this.ink.grid.uniforms["ink"] as { value: Vector3 }).value.set(...grid);
    (this.ink.scanner.uniforms["ink"] as { value: Vector3 }).value.set(...scanner);
    (this.plain.uniforms["ink"] as { value: Vector3 }).value.set(...scanner);
    (this.ink.beam.uniforms["ink"] as { value: Vector3 }).value.set(...beam);
    this.draw();
  }

  setColours(table: Uint8Array): void {
    (this.colours.image.data as Uint8Array).set(table);
    this.colours.needsUpdate = true;
    this.draw();
  }

  setField(field: number, range: Range): void {
    this.uniform("field", field);
    (this.points.uniforms["limits"] as { value: Vector2 }).value.set(range.low, range.high);
    this.draw();
  }

  uniform(name: "size" | "section_half_m" | "until_s" | "ceiling_m" | "cutaway" | "field", value: number | boolean): void {
    (this.points.uniforms[name] as { value: unknown }).value = value;
    this.draw();
  }

  setShading(on: boolean): void {
    (this.shade.uniforms["strength"] as { value: number }).value = on ? 9 : 0;
    this.draw();
  }

  /** Sets the tilt angle; positive angles rotate z towards x. */
  setTilt(tilt_deg: number): void {
    const turn = (tilt_deg * Math.PI) / 180;
    if (Math.abs(this.head.rotation.y - turn) < 1e-4) return;
    this.head.rotation.y = turn;
    this.draw();
  }

  /** Schedules a picture of a changing view, with fewer points on a slow graphics card. */
  animate(): void {
    this.moved();
  }

  /** Schedules a picture. */
  draw(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame(() => this.render());
  }

  private moved(): void {
    if (!this.moving) this.waiting = WAITING;
    this.moving = true;
    this.wait_for_rest();
    this.draw();
  }

  private wait_for_rest(): void {
    clearTimeout(this.rest);
    this.rest = window.setTimeout(() => {
      // More moves may wait for this picture.
      if (this.frame !== 0) return this.wait_for_rest();
      this.moving = false;
      this.longest_ms = 0;
      this.draw();
    }, Math.max(REST_MS, Math.min(MOST_REST_MS, REST_PICTURES * this.longest_ms)));
  }

  private resize(): void {
    const ratio = Math.min(window.devicePixelRatio, 2);
    const [width, height] = [Math.max(1, this.canvas.clientWidth), Math.max(1, this.canvas.clientHeight)];
    this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(width, height, false);
    const size = this.renderer.getDrawingBufferSize(new Vector2());
    this.target.setSize(size.x, size.y);
    (this.shade.uniforms["pixel_size"] as { value: Vector2 }).value.set(1 / size.x, 1 / size.y).multiplyScalar(ratio);
    (this.points.uniforms["height_px"] as { value: number }).value = size.y;
    this.camera.aspect = width / height;
    this.orbit.apply();
  }

  private render(): void {
    this.frame = 0;
    this.prepare();
    const size = this.renderer.getDrawingBufferSize(new Vector2());
    this.detail(this.moving ? new Eye(this.camera, size.y, this.orbit.parallel ? this.orbit.pose.distance_m : 0) : null, this.budget);
    (this.shade.uniforms["clip"] as { value: Vector2 }).value.set(this.camera.near, this.camera.far);
    const [r, g, b] = this.background;
    const context = this.renderer.getContext();
    this.renderer.setRenderTarget(this.target);
    context.clearColor(r, g, b, 1);
    this.renderer.state.buffers.depth.setMask(true);
    context.clear(context.COLOR_BUFFER_BIT | context.DEPTH_BUFFER_BIT);
    this.renderer.render(this.scene, this.camera);
    this.renderer.setRenderTarget(null);
    this.renderer.render(this.screen, this.flat);
    this.drawn();
    const begun_ms = performance.now();
    if (this.moving) requestAnimationFrame(() => this.adapt(performance.now() - begun_ms));
  }

  /** Passes the camera to the shaders. */
  private prepare(): void {
    const { parallel, pose } = this.orbit;
    // The camera of a parallel view is far away: all its rays have one direction.
    const eye = (this.points.uniforms["eye"] as { value: Vector3 }).value.copy(this.camera.position);
    if (parallel) eye.addScaledVector(new Vector3(...this.forward), -1e4);
    for (const material of [this.points, this.shade]) (material.uniforms["parallel_m"] as { value: number }).value = parallel ? pose.distance_m : 0;
  }

  /** Draws fewer points if the browser could draw again only after long, more if soon. */
  private adapt(took_ms: number): void {
    if (!this.moving) return;
    if (this.waiting > 0) {
      this.waiting -= 1;
      return;
    }
    this.longest_ms = Math.max(took_ms, 0.8 * this.longest_ms);
    this.quick = took_ms < QUICK_MS ? this.quick + 1 : 0;
    if (took_ms > SLOW_MS) this.budget = Math.max(LEAST_BUDGET, this.budget * Math.min(1 / 1.6, Math.max(1 / 8, SLOW_MS / took_ms)));
    if (this.quick < QUICK_ONES) return;
    this.quick = 0;
    this.budget = Math.min(MOST_BUDGET, this.budget * 1.5);
  }
}

/** The hit that is nearest to the middle of a square of picked values. */
function nearest(read: Uint32Array, side: number): Picked | null {
  const floats = new Float32Array(read.buffer);
  const second = 4 * side * side;
  let found: { at: number; square: number } | null = null;
  for (let at = 0; at < side * side; at += 1) {
    if (((read[second + 4 * at + 3] ?? 0) & 0x80000000) === 0) continue;
    const square = (((at % side) - (side - 1) / 2) ** 2) + ((Math.floor(at / side) - (side - 1) / 2) ** 2);
    if (found === null || square < found.square) found = { at, square };
  }
  if (found === null) return null;
  const first = 4 * found.at;
  const float = (i: number) => floats[i] ?? 0;
  const whole = read[second + first + 3] ?? 0;
  return {
    position: [float(first), float(first + 1), float(first + 2)], time_s: float(first + 3), sd_m: float(second + first), tilt_deg: float(second + first + 1),
    intensity: float(second + first + 2), ring: whole & 255, laser: (whole >> 16) & 255, echo: (whole >> 8) & 255,
    distance_m: float(2 * second + first), complete: false,
  };
}

function line(): RawShaderMaterial {
  return new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader: shaders.LINE_VERTEX,
    fragmentShader: shaders.LINE_FRAGMENT,
    uniforms: { ink: { value: new Vector3() } },
  });
}

function segments(points: number[], material: RawShaderMaterial): LineSegments {
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(points), 3));
  const lines = new LineSegments(geometry, material);
  lines.frustumCulled = false;
  return lines;
}

function circle(radius: number, height: number, parts: number, centre: [number, number, number] = [0, 0, 0]): number[] {
  const at = (i: number) => {
    const turn = (2 * Math.PI * i) / parts;
    return [centre[0] + radius * Math.cos(turn), centre[1] + radius * Math.sin(turn), centre[2] + height];
  };
  return Array.from({ length: parts }, (_, i) => [...at(i), ...at(i + 1)]).flat();
}

/** Rings 5 m apart at the foot of the tripod. */
export const RING_STEP_M = 5;
const FOOT_M = -1.2;

function rings(material: RawShaderMaterial): LineSegments {
  const lines: number[] = [];
  for (let radius = RING_STEP_M; radius <= 20; radius += RING_STEP_M) lines.push(...circle(radius, FOOT_M, 128));
  lines.push(-20, 0, FOOT_M, 20, 0, FOOT_M, 0, -20, FOOT_M, 0, 20, FOOT_M);
  return segments(lines, material);
}

function tripod(material: RawShaderMaterial): LineSegments {
  const lines: number[] = [];
  for (let leg = 0; leg < 3; leg += 1) {
    const turn = (2 * Math.PI * leg) / 3 + Math.PI / 6;
    lines.push(0, 0, -0.12, 0.5 * Math.cos(turn), 0.5 * Math.sin(turn), FOOT_M);
  }
  return segments(lines, material);
}

/** The lidar on its platform, tilting about y: a cylinder and its horizontal plane. */
function scanner(material: RawShaderMaterial): LineSegments {
  const lines = [...circle(0.14, -0.1, 24), ...circle(0.14, 0.14, 24)];
  for (let i = 0; i < 8; i += 1) {
    const [x, y] = [0.14 * Math.cos((i * Math.PI) / 4), 0.14 * Math.sin((i * Math.PI) / 4)];
    lines.push(x, y, -0.1, x, y, 0.14);
  }
  lines.push(...circle(1.2, 0.06, 64), -1.2, 0, 0.06, -0.14, 0, 0.06, 0.14, 0, 0.06, 1.2, 0, 0.06);
  return segments(lines, material);
}
