// Levels of detail: how many points of each part of a cloud are drawn while the view moves.

import { Frustum, Matrix4, type PerspectiveCamera, Sphere } from "three";

/** Points of a part per pixel that it covers, beyond which more of them do not show in a moving view. */
const MOST_PER_PX = 4;
/** A part in view is never left out. */
const LEAST = 32;

/** A part of a cloud: the number of its points, in random order, and how many pixels it covers. */
export interface Part {
  count: number;
  area_px: number;
}

/** The number of points to draw of each part, about `budget` in all: as many per pixel everywhere, if there are so many. */
export function detailed(parts: Part[], budget: number): number[] {
  const wanted = parts.map(({ count, area_px }) => (area_px > 0 ? Math.min(count, Math.max(LEAST, MOST_PER_PX * area_px)) : 0));
  const sum = wanted.reduce((total, points) => total + points, 0);
  const share = Math.min(1, budget / Math.max(1, sum));
  return wanted.map((points) => Math.ceil(share * points));
}

/** A camera's picture. */
export class Eye {
  private readonly frustum = new Frustum();
  private readonly focal_px: number;
  private readonly screen_px: number;

  /** `parallel_m` is the distance of the target in a parallel view, else 0. */
  constructor(private readonly camera: PerspectiveCamera, height_px: number, private readonly parallel_m: number) {
    camera.updateMatrixWorld();
    this.frustum.setFromProjectionMatrix(new Matrix4().multiplyMatrices(camera.projectionMatrix, camera.matrixWorldInverse));
    this.focal_px = height_px / (2 * Math.tan((camera.fov * Math.PI) / 360));
    this.screen_px = height_px * height_px * camera.aspect;
  }

  /** Pixels that a ball covers, from 1 to those of the picture; 0 out of view. */
  area_px(ball: Sphere): number {
    if (!this.frustum.intersectsSphere(ball)) return 0;
    const square = this.parallel_m > 0 ? this.parallel_m ** 2 : this.camera.position.distanceToSquared(ball.center) - ball.radius ** 2;
    const radius_px = (ball.radius * this.focal_px) / Math.sqrt(Math.max(1e-6, square));
    return Math.min(this.screen_px, Math.max(1, Math.PI * radius_px ** 2));
  }
}
