// Orbit camera: rotates about a target, pans and zooms by mouse, touch, wheel and keys. z stays up.

import { type PerspectiveCamera, Spherical, Vector3 } from "three";

/** A touch that moves less picks a point. */
const TAP_PX = 6;
/** Behind the target everything is drawn up to here. */
const REACH_M = 600;
const LEAST_M = 0.3;
const MOST_M = 1_000;
const UP = new Vector3(0, 0, 1);

export class Orbit {
  readonly target = new Vector3();
  /** Whether the user has moved the camera since the last `look`. */
  touched = false;
  /** Whether the projection is parallel (orthographic). */
  parallel = false;
  /** Called when a mouse, finger or pen touches a place without moving. */
  tapped: (event: PointerEvent) => void = () => {};
  private distance_m = 30;
  /** Direction from the target to the camera, from x towards y, radians. */
  private azimuth = -2.2;
  /** Above the horizon, radians. */
  private elevation = 0.6;
  private readonly pointers = new Map<number, PointerEvent>();
  private pressed: PointerEvent | null = null;

  constructor(
    private readonly camera: PerspectiveCamera,
    private readonly canvas: HTMLCanvasElement,
    private readonly changed: () => void,
  ) {
    camera.up.copy(UP);
    canvas.addEventListener("pointerdown", (event) => this.down(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.up(event));
    canvas.addEventListener("pointercancel", (event) => this.pointers.delete(event.pointerId));
    canvas.addEventListener("wheel", (event) => this.wheel(event), { passive: false });
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("keydown", (event) => this.key(event));
    this.apply();
  }

  /** Sets the camera: radians, metres. */
  look(azimuth: number, elevation: number, distance_m: number, target = new Vector3()): void {
    this.azimuth = azimuth;
    this.elevation = elevation;
    this.distance_m = distance_m;
    this.target.copy(target);
    this.touched = false;
    this.apply();
  }

  /** The camera: radians, metres. */
  get pose(): { azimuth: number; elevation: number; distance_m: number } {
    return { azimuth: this.azimuth, elevation: this.elevation, distance_m: this.distance_m };
  }

  /** Height of the view at the target, metres. */
  get span_m(): number {
    return 2 * this.distance_m * Math.tan((this.camera.fov * Math.PI) / 360);
  }

  setParallel(on: boolean): void {
    this.parallel = on;
    this.apply();
  }

  turn(azimuth: number, elevation: number): void {
    this.azimuth += azimuth;
    this.elevation = Math.min(Math.PI / 2 - 1e-3, Math.max(-Math.PI / 2 + 1e-3, this.elevation + elevation));
    this.moved();
  }

  zoom(factor: number): void {
    this.distance_m = Math.min(MOST_M, Math.max(LEAST_M, this.distance_m * factor));
    this.moved();
  }

  /** Pans by shares of the view's height, right and up. */
  pan(right: number, up: number): void {
    const span = this.span_m;
    const matrix = this.camera.matrix.elements;
    this.target.addScaledVector(new Vector3(matrix[0], matrix[1], matrix[2]), right * span);
    this.target.addScaledVector(new Vector3(matrix[4], matrix[5], matrix[6]), up * span);
    this.moved();
  }

  private moved(): void {
    this.touched = true;
    this.apply();
  }

  /** Updates the camera. */
  apply(): void {
    const eye = new Vector3().setFromSpherical(new Spherical(this.distance_m, Math.PI / 2 - this.elevation, 0));
    // Spherical has y up; rotate so that z is up.
    const flat = eye.z;
    this.camera.position.set(flat * Math.cos(this.azimuth), flat * Math.sin(this.azimuth), eye.y).add(this.target);
    this.camera.far = this.distance_m + REACH_M;
    this.camera.near = this.parallel ? -this.camera.far : Math.max(0.02, this.distance_m / 200);
    this.camera.lookAt(this.target);
    if (this.parallel) {
      const [half, wide] = [this.span_m / 2, (this.camera.aspect * this.span_m) / 2];
      this.camera.projectionMatrix.makeOrthographic(-wide, wide, half, -half, this.camera.near, this.camera.far);
      this.camera.projectionMatrixInverse.copy(this.camera.projectionMatrix).invert();
    } else this.camera.updateProjectionMatrix();
    this.camera.updateMatrix();
    this.changed();
  }

  private down(event: PointerEvent): void {
    this.canvas.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, event);
    this.pressed = this.pointers.size === 1 && event.button === 0 ? event : null;
  }

  private up(event: PointerEvent): void {
    this.pointers.delete(event.pointerId);
    const { pressed } = this;
    this.pressed = null;
    if (pressed === null || pressed.pointerId !== event.pointerId) return;
    if (Math.hypot(event.clientX - pressed.clientX, event.clientY - pressed.clientY) < TAP_PX) this.tapped(event);
  }

  private move(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (before === undefined) return;
    const height = this.canvas.clientHeight;
    if (this.pointers.size === 2) {
      this.pinch(before, event, height);
    } else if (this.pointers.size === 1) {
      const [x, y] = [(event.clientX - before.clientX) / height, (event.clientY - before.clientY) / height];
      const sideways = event.buttons !== 1 || event.shiftKey || event.ctrlKey || event.metaKey;
      if (sideways) this.pan(-x, y);
      else this.turn(-x * Math.PI, y * Math.PI);
    }
    this.pointers.set(event.pointerId, event);
  }

  /** Two fingers: their midpoint pans, their distance zooms. */
  private pinch(before: PointerEvent, now: PointerEvent, height: number): void {
    const other = [...this.pointers.values()].find((pointer) => pointer.pointerId !== now.pointerId);
    if (other === undefined) return;
    const distance = (one: PointerEvent) => Math.hypot(one.clientX - other.clientX, one.clientY - other.clientY);
    this.zoom(Math.max(distance(before), 1) / Math.max(distance(now), 1));
    this.pan(-(now.clientX - before.clientX) / 2 / height, (now.clientY - before.clientY) / 2 / height);
  }

  private wheel(event: WheelEvent): void {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? event.deltaY / 100 : event.deltaY / 3;
    this.zoom(1.12 ** Math.max(-5, Math.min(5, lines)));
  }

  private key(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const [right, up] = ({ ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] } as Record<string, [number, number]>)[event.key] ?? [0, 0];
    if (right !== 0 || up !== 0) {
      if (event.shiftKey) this.pan(right * 0.05, up * 0.05);
      else this.turn(right * 0.1, up * 0.1);
    } else if (event.key === "+" || event.key === "=") this.zoom(1 / 1.15);
    else if (event.key === "-") this.zoom(1.15);
    else return;
    event.preventDefault();
  }
}
