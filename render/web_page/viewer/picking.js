// @ts-check
// Finds the surface under a point of the picture.

import {dot, halfHeight, objectToCamera} from './linear.js';

/** @typedef {import('./linear.js').Camera} Camera */

/**
 * Depth of the nearest triangle along the ray through a point of the canvas, 0 … 1 from the top left; holes count as
 * surface. Null where there is no triangle.
 * @param {import('./scene.js').Manifest} scene @param {({mesh: import('./scene.js').Mesh} | null)[]} sets
 * @param {Camera} camera @param {number} x @param {number} y @param {number} aspect @returns {number | null}
 */
export function depthAlongRay(scene, sets, camera, x, y, aspect) {
  let nearest = Infinity;
  const top = halfHeight(camera, 1), px = (2 * x - 1) * top * aspect, py = (1 - 2 * y) * top;
  for (const draw of scene.draws) {
    const set = sets[draw.set];
    if (!set) continue;
    const m = objectToCamera(camera, draw.toWorld, scene.sets[draw.set].origin), {corners, positions} = set.mesh;
    /** @param {number} v @returns {number[]} offset from the ray in the picture plane, and depth */
    const place = (v) => {
      const p = [positions[3 * v], positions[3 * v + 1], positions[3 * v + 2]];
      const [cx, cy, cz] = [0, 1, 2].map((i) => dot(m.slice(4 * i, 4 * i + 3), p) + m[4 * i + 3]);
      return camera.orthoHeight ? [cx - px, cy - py, -cz] : [cx / -cz - px, cy / -cz - py, -cz];
    };
    const placed = new Map();
    const at = (/** @type {number} */ v) => { if (!placed.has(v)) placed.set(v, place(v)); return placed.get(v); };
    for (let k = 0; k < corners.length; k += 3) {
      const [a, b, c] = [at(corners[k]), at(corners[k + 1]), at(corners[k + 2])];
      if (a[2] <= 0 || b[2] <= 0 || c[2] <= 0) continue;
      const wa = b[0] * c[1] - b[1] * c[0], wb = c[0] * a[1] - c[1] * a[0], wc = a[0] * b[1] - a[1] * b[0];
      if (!(wa >= 0 && wb >= 0 && wc >= 0) && !(wa <= 0 && wb <= 0 && wc <= 0)) continue;
      const sum = wa + wb + wc;
      if (sum === 0) continue;
      const depth = camera.orthoHeight ? (wa * a[2] + wb * b[2] + wc * c[2]) / sum : sum / (wa / a[2] + wb / b[2] + wc / c[2]);
      if (depth > camera.near && depth < nearest) nearest = depth;
    }
  }
  return nearest === Infinity ? null : nearest;
}
