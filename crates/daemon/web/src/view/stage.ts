// The scene: camera, points, scanner, rings on the floor, depth shading. Draws only after a change.

import {
  BufferAttribute, BufferGeometry, ClampToEdgeWrapping, ColorManagement, DataTexture, DepthTexture, GLSL3, Group, LinearSRGBColorSpace, LineSegments,
  Mesh, NearestFilter, OrthographicCamera, PerspectiveCamera, RawShaderMaterial, RGBAFormat, Scene, Vector2, Vector3, WebGLRenderer, WebGLRenderTarget,
} from "three";

import type { Range } from "../sample.ts";
import { STEPS } from "./maps.ts";
import { Orbit } from "./orbit.ts";
import * as shaders from "./shaders.ts";

/** Colours are used as given, without conversion. */
ColorManagement.enabled = false;

type Rgb = [number, number, number];
/** If a picture takes longer while the view moves, the next one has fewer points. */
const SLOW_MS = 45;
const QUICK_MS = 20;

export class Stage {
  readonly orbit: Orbit;
  readonly points: RawShaderMaterial;
  readonly scene = new Scene();
  /** Called with the share of the points to draw. */
  share: (share: number) => void = () => {};
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
  private part = 1;
  private last_ms = 0;

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
        eye: { value: new Vector3() }, size: { value: 2 }, height_px: { value: 1 }, field: { value: 0 },
        range: { value: new Vector2(0, 1) }, below_m: { value: 1e6 }, cutaway: { value: true }, ceiling_m: { value: 1e6 }, colours: { value: this.colours },
      },
    });
    this.target.depthTexture = new DepthTexture(1, 1);
    this.shade = new RawShaderMaterial({
      glslVersion: GLSL3,
      vertexShader: shaders.SCREEN_VERTEX,
      fragmentShader: shaders.SCREEN_FRAGMENT,
      depthTest: false,
      uniforms: {
        picture: { value: this.target.texture }, depth: { value: this.target.depthTexture }, pixel_size: { value: new Vector2() },
        clip: { value: new Vector2() }, strength: { value: 9 },
      },
    });
    const triangle = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array([-1, -1, 0, 3, -1, 0, -1, 3, 0]), 3));
    const cover = new Mesh(triangle, this.shade);
    cover.frustumCulled = false;
    this.screen.add(cover);
    this.scene.add(rings(this.ink.grid), tripod(this.ink.scanner), this.head);
    this.head.add(scanner(this.ink.beam));
    this.orbit = new Orbit(this.camera, canvas, () => this.moved());
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  /** Sets one of the standard views at a distance where `reach_m` fits. */
  fit(reach_m: number, from: "usual" | "top" | "scanner" = "usual"): void {
    const wide = 2.4 / this.camera.aspect;
    const away = Math.max(1.5, wide) * reach_m;
    if (from === "top") this.orbit.look(-Math.PI / 2, Math.PI / 2 - 1e-3, Math.max(2.2, wide) * reach_m);
    else if (from === "scanner") this.orbit.look(-Math.PI / 2, 0.15, Math.max(2, reach_m / 8));
    else this.orbit.look(-2.05, 0.62, away);
  }

  setBackground(background: Rgb, grid: Rgb, scanner: Rgb, beam: Rgb): void {
    this.background = background;
    (this.ink.grid.uniforms["ink"] as { value: Vector3 }).value.set(...grid);
    (this.ink.scanner.uniforms["ink"] as { value: Vector3 }).value.set(...scanner);
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
    (this.points.uniforms["range"] as { value: Vector2 }).value.set(range.low, range.high);
    this.draw();
  }

  uniform(name: "size" | "below_m" | "ceiling_m" | "cutaway" | "field", value: number | boolean): void {
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

  /** Schedules a picture. */
  draw(): void {
    if (this.frame === 0) this.frame = requestAnimationFrame(() => this.render());
  }

  private moved(): void {
    this.moving = true;
    clearTimeout(this.rest);
    this.rest = window.setTimeout(() => {
      this.moving = false;
      this.draw();
    }, 180);
    this.draw();
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
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  private render(): void {
    this.frame = 0;
    this.adapt();
    this.share(this.moving ? this.part : 1);
    (this.points.uniforms["eye"] as { value: Vector3 }).value.copy(this.camera.position);
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
  }

  /** Draws fewer points while pictures are slow, more while they are fast. */
  private adapt(): void {
    const now_ms = performance.now();
    const took_ms = now_ms - this.last_ms;
    this.last_ms = now_ms;
    if (!this.moving || took_ms > 500) return;
    if (took_ms > SLOW_MS) this.part = Math.max(0.02, this.part / 1.6);
    else if (took_ms < QUICK_MS) this.part = Math.min(1, this.part * 1.15);
  }
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
