// @ts-check
// Moves the camera: mouse, touch and keyboard.

import {add, cameraAxes, cross, dot, halfHeight, rotated, scale, sub, unit, withPlanes} from './linear.js';

/** @typedef {import('./linear.js').Camera} Camera */

const nearestPivot = 1e-5, farthestPivot = 50; // distances from the eye, in diagonals of the scene

/**
 * Whether a camera shows something: finite numbers, a distance between eye and target, an up direction, a field of view
 * in 0 … 180 degrees, and planes with 0 < near < far.
 * @param {Camera} camera
 */
function isValid(camera) {
  const {eye, target, up, fov, near, far} = camera, size = camera.orthoHeight ?? 0;
  return [...eye, ...target, ...up, fov, near, far, size].every(Number.isFinite) &&
      Math.hypot(...sub(eye, target)) > 0 && Math.hypot(...up) > 0 && (size > 0 || (fov > 0 && fov < 180 && near > 0)) && far > near;
}

export class Controls {
  /**
   * @param {HTMLElement} element @param {Camera} camera
   * @param {{up: number[], box: [number[], number[]]}} scene the axis of the orbit, and the box of all triangles
   * @param {{changed: () => void, depthAt: (x: number, y: number) => number | null}} page
   */
  constructor(element, camera, scene, page) {
    this.element = element;
    this.camera = camera;
    this.scene = scene;
    this.diagonal = Math.hypot(...sub(scene.box[1], scene.box[0])) || 1;
    this.page = page;
    /** @type {Map<number, {x: number, y: number}>} */
    this.pointers = new Map();
    element.addEventListener('pointerdown', (e) => {
      element.setPointerCapture(e.pointerId);
      this.pointers.set(e.pointerId, {x: e.clientX, y: e.clientY});
    });
    for (const end of ['pointerup', 'pointercancel'])
      element.addEventListener(end, (e) => this.pointers.delete(/** @type {PointerEvent} */ (e).pointerId));
    element.addEventListener('pointermove', (e) => this.pointerMoved(e));
    element.addEventListener('contextmenu', (e) => e.preventDefault());
    element.addEventListener('wheel', (e) => {
      e.preventDefault();
      const step = e.deltaMode === 1 ? 20 * e.deltaY : e.deltaY;
      this.zoom(Math.exp(Math.max(-1, Math.min(1, step / 500))), e.clientX, e.clientY);
    }, {passive: false});
    element.addEventListener('dblclick', (e) => this.setPivot(e.clientX, e.clientY));
  }

  /** @param {PointerEvent} e */
  pointerMoved(e) {
    const before = this.pointers.get(e.pointerId);
    if (!before) return;
    const now = {x: e.clientX, y: e.clientY};
    if (this.pointers.size === 1) {
      if (e.shiftKey || e.buttons & 6) this.pan(now.x - before.x, now.y - before.y);
      else this.orbit(now.x - before.x, now.y - before.y);
    } else if (this.pointers.size === 2) {
      // Two fingers pan and zoom.
      const other = [...this.pointers].find(([id]) => id !== e.pointerId)?.[1];
      if (other) {
        const spread = Math.hypot(now.x - other.x, now.y - other.y), was = Math.hypot(before.x - other.x, before.y - other.y);
        this.pan((now.x - before.x) / 2, (now.y - before.y) / 2);
        if (spread > 0 && was > 0) this.zoom(was / spread, (now.x + other.x) / 2, (now.y + other.y) / 2);
      }
    }
    this.pointers.set(e.pointerId, now);
  }

  /**
   * Whether a key moves the camera, which it then does.
   * @param {KeyboardEvent} e
   */
  keyPressed(e) {
    const {left, top, width, height} = this.element.getBoundingClientRect(), x = left + width / 2, y = top + height / 2;
    /** @type {Object<string, () => void>} */
    const keys = {
      ArrowLeft: () => e.shiftKey ? this.pan(20, 0) : this.orbit(20, 0),
      ArrowRight: () => e.shiftKey ? this.pan(-20, 0) : this.orbit(-20, 0),
      ArrowUp: () => e.shiftKey ? this.pan(0, 20) : this.orbit(0, 20),
      ArrowDown: () => e.shiftKey ? this.pan(0, -20) : this.orbit(0, -20),
      '+': () => this.zoom(0.9, x, y), '=': () => this.zoom(0.9, x, y), '-': () => this.zoom(1 / 0.9, x, y),
    };
    if (!keys[e.key]) return false;
    keys[e.key]();
    return true;
  }

  /**
   * Orbits about the pivot, with the scene's up direction upwards.
   * @param {number} dx pixels @param {number} dy pixels
   */
  orbit(dx, dy) {
    const camera = this.camera, up = unit(this.scene.up), perPixel = Math.PI / this.element.clientHeight;
    // At a pole, the picture's right direction stands for that of the horizon.
    const right = rotated(cameraAxes({...camera, up})[0], up, -dx * perPixel);
    let away = rotated(sub(camera.eye, camera.target), up, -dx * perPixel);
    const height = Math.asin(Math.max(-1, Math.min(1, dot(unit(away), up)))), limit = Math.PI / 2 - 0.01;
    away = rotated(away, right, -Math.max(-limit - height, Math.min(limit - height, dy * perPixel)));
    this.show({...camera, up, eye: add(camera.target, away)});
  }

  /**
   * Rotates the eye about the scene's up direction.
   * @param {number} angle radians
   */
  rotate(angle) {
    const camera = this.camera, up = unit(this.scene.up);
    this.show({...camera, up, eye: add(camera.target, rotated(sub(camera.eye, camera.target), up, angle))});
  }

  /**
   * Moves eye and pivot with the pointer.
   * @param {number} dx pixels @param {number} dy pixels
   */
  pan(dx, dy) {
    const camera = this.camera, [right, up] = cameraAxes(camera);
    const distance = Math.hypot(...sub(camera.eye, camera.target)), pixel = 2 * halfHeight(camera, distance) / this.element.clientHeight;
    const motion = add(scale(right, -dx * pixel), scale(up, dy * pixel));
    this.show({...camera, eye: add(camera.eye, motion), target: add(camera.target, motion)});
  }

  /**
   * Zooms to a point of the page.
   * @param {number} wanted factor of the visible size @param {number} x @param {number} y
   */
  zoom(wanted, x, y) {
    const camera = this.camera, away = sub(camera.eye, camera.target), distance = Math.hypot(...away);
    const size = camera.orthoHeight || distance;
    const factor = Math.max(nearestPivot * this.diagonal / size, Math.min(farthestPivot * this.diagonal / size, wanted));
    const at = this.pointAt(x, y, distance), shift = scale(sub(at, camera.target), 1 - factor);
    const target = add(camera.target, shift);
    if (camera.orthoHeight) this.show({...camera, target, eye: add(target, away), orthoHeight: camera.orthoHeight * factor});
    else this.show({...camera, target, eye: add(target, scale(away, factor))});
  }

  /**
   * The point at a depth under a point of the page.
   * @param {number} x @param {number} y @param {number} depth
   */
  pointAt(x, y, depth) {
    const {left, top, width, height} = this.element.getBoundingClientRect(), camera = this.camera;
    const [right, up, back] = cameraAxes(camera), half = halfHeight(camera, depth);
    const across = (2 * (x - left) / width - 1) * half * width / height, above = (1 - 2 * (y - top) / height) * half;
    return add(add(camera.eye, scale(back, -depth)), add(scale(right, across), scale(up, above)));
  }

  /**
   * Makes the surface under a point of the page the pivot.
   * @param {number} x @param {number} y
   */
  setPivot(x, y) {
    const {left, top, width, height} = this.element.getBoundingClientRect();
    const depth = this.page.depthAt((x - left) / width, (y - top) / height);
    if (depth === null) return;
    const target = this.pointAt(x, y, depth), shift = sub(target, this.camera.target);
    // The eye keeps its depth along the view axis.
    const [, , back] = cameraAxes(this.camera);
    const motion = sub(shift, scale(back, dot(shift, back)));
    this.show({...this.camera, target, eye: add(this.camera.eye, motion)});
  }

  /**
   * Shows a camera with planes around the scene.
   * @param {Camera} camera
   */
  show(camera) { this.move(withPlanes(camera, this.scene.box)); }

  /**
   * Shows a camera as it is; false if it shows nothing (isValid()).
   * @param {Camera} camera
   */
  move(camera) {
    if (!isValid(camera)) return false;
    this.camera = camera;
    this.page.changed();
    return true;
  }
}
