// @ts-check
// Vectors and matrices in double precision. Vectors are arrays of 3 numbers; matrices are row-major arrays.

/** @typedef {[number, number, number]} Vec3 */
/** @typedef {{eye: Vec3, target: Vec3, up: Vec3, fov: number, orthoHeight?: number, near: number, far: number}} Camera */

/** @param {number[]} a @param {number[]} b @returns {Vec3} */
export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
/** @param {number[]} a @param {number[]} b @returns {Vec3} */
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
/** @param {number[]} a @param {number} s @returns {Vec3} */
export const scale = (a, s) => [a[0] * s, a[1] * s, a[2] * s];
/** @param {number[]} a @param {number[]} b */
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
/** @param {number[]} a @param {number[]} b @returns {Vec3} */
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
/** @param {number[]} a @returns {Vec3} */
export const unit = (a) => scale(a, 1 / Math.hypot(a[0], a[1], a[2]));

/**
 * Rows right, up and back of a camera: a rotation from world to camera space.
 * @param {Camera} camera @returns {[Vec3, Vec3, Vec3]}
 */
export function cameraAxes(camera) {
  const back = unit(sub(camera.eye, camera.target));
  let side = cross(camera.up, back);
  // An `up` along the view axis defines nothing: another axis replaces it.
  if (Math.hypot(...side) < 1e-9 * Math.hypot(...camera.up)) side = cross(Math.abs(back[1]) < 0.9 ? [0, 1, 0] : [0, 0, -1], back);
  const right = unit(side);
  return [right, cross(back, right), back];
}

/**
 * Product of two 3×3 matrices.
 * @param {number[]} a @param {number[]} b
 */
export function multiply3(a, b) {
  const m = new Array(9).fill(0);
  for (let i = 0; i < 3; ++i)
    for (let j = 0; j < 3; ++j) for (let k = 0; k < 3; ++k) m[3 * i + j] += a[3 * i + k] * b[3 * k + j];
  return m;
}

/** @param {number[]} m */
export const transposed3 = (m) => [m[0], m[3], m[6], m[1], m[4], m[7], m[2], m[5], m[8]];

/**
 * The 3×4 matrix from an object, whose positions are relative to `origin`, to camera space.
 * @param {Camera} camera @param {number[]} toWorld 3×4 @param {number[]} origin
 */
export function objectToCamera(camera, toWorld, origin) {
  const axes = cameraAxes(camera);
  const m = new Array(12).fill(0);
  const place = [0, 1, 2].map((i) => toWorld[4 * i + 3] + dot(toWorld.slice(4 * i, 4 * i + 3), origin) - camera.eye[i]);
  for (let i = 0; i < 3; ++i) {
    for (let j = 0; j < 3; ++j) for (let k = 0; k < 3; ++k) m[4 * i + j] += axes[i][k] * toWorld[4 * k + j];
    m[4 * i + 3] = dot(axes[i], place);
  }
  return m;
}

/**
 * Half of the visible height at a depth.
 * @param {Camera} camera @param {number} depth
 */
export const halfHeight = (camera, depth) =>
  camera.orthoHeight ? camera.orthoHeight / 2 : depth * Math.tan(camera.fov * Math.PI / 360);

/**
 * The 4×4 matrix from camera to clip space. `reversed`: depth from 1 (near) to 0, else from −1 to 1.
 * @param {Camera} camera @param {number} aspect @param {boolean} reversed
 */
export function projection(camera, aspect, reversed) {
  const f = 1 / halfHeight(camera, 1), n = camera.near, r = camera.far, p = new Array(16).fill(0);
  p[0] = f / aspect;
  p[5] = f;
  if (camera.orthoHeight) {
    p[15] = 1;
    p[10] = reversed ? 1 / (r - n) : -2 / (r - n);
    p[11] = reversed ? r / (r - n) : -(r + n) / (r - n);
  } else {
    p[14] = -1;
    p[10] = reversed ? n / (r - n) : -(r + n) / (r - n);
    p[11] = reversed ? n * r / (r - n) : -2 * n * r / (r - n);
  }
  return p;
}

/**
 * The camera with near and far planes around a box.
 * @param {Camera} camera @param {[number[], number[]]} box @returns {Camera}
 */
export function withPlanes(camera, box) {
  const [, , back] = cameraAxes(camera);
  let nearest = Infinity, farthest = -Infinity;
  for (let corner = 0; corner < 8; ++corner) {
    const p = [0, 1, 2].map((axis) => box[corner >> axis & 1][axis]), depth = -dot(back, sub(p, camera.eye));
    nearest = Math.min(nearest, depth);
    farthest = Math.max(farthest, depth);
  }
  const room = 0.05 * (farthest - nearest) + 1e-9 * Math.abs(farthest);
  if (camera.orthoHeight) return {...camera, near: nearest - room, far: farthest + room};
  const far = Math.max(farthest + room, 1e-6 * (farthest - nearest));
  return {...camera, near: Math.max(nearest - room, far / 10000), far};
}

/**
 * Product of a 4×4 and a 3×4 matrix, as 4×4.
 * @param {number[]} p @param {number[]} m
 */
export function multiply4(p, m) {
  const out = new Array(16).fill(0);
  for (let i = 0; i < 4; ++i)
    for (let j = 0; j < 4; ++j) {
      for (let k = 0; k < 3; ++k) out[4 * i + j] += p[4 * i + k] * m[4 * k + j];
      if (j === 3) out[4 * i + 3] += p[4 * i + 3];
    }
  return out;
}

/**
 * Column-major floats of a row-major matrix, for uniforms.
 * @param {number[]} m @param {number} size
 */
export function columns(m, size) {
  const out = new Float32Array(size * size);
  for (let i = 0; i < size; ++i) for (let j = 0; j < size; ++j) out[size * j + i] = m[size * i + j];
  return out;
}

/**
 * Rotation of a vector about a unit axis.
 * @param {number[]} v @param {Vec3} axis @param {number} angle @returns {Vec3}
 */
export function rotated(v, axis, angle) {
  const c = Math.cos(angle), s = Math.sin(angle);
  return add(add(scale(v, c), scale(cross(axis, v), s)), scale(axis, dot(axis, v) * (1 - c)));
}
