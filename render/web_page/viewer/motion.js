// @ts-check
// Keyframes: places of draws and the camera at equal times, interpolated linearly between them.

import {unpacked} from './scene.js';

/**
 * @typedef {import('./linear.js').Camera} Camera
 * @typedef {{file: import('./scene.js').FileEntry, rate: number, samples: number, draws: number[], camera: boolean}} MotionEntry
 */

const numbersPerDraw = 21, numbersPerCamera = 13;  // 3×4 object to world and 3×3 world to decoder; see web_page.cpp

export class Motion {
  /** @param {import('./scene.js').Manifest} scene @param {Float64Array} values */
  constructor(scene, values) {
    this.scene = scene;
    this.entry = /** @type {MotionEntry} */ (scene.motion);
    this.values = values;
    this.stride = numbersPerDraw * this.entry.draws.length + (this.entry.camera ? numbersPerCamera : 0);
    if (values.length !== this.stride * this.entry.samples) throw Error(`${this.entry.file.name} is damaged: publish the scene again`);
  }

  /** Seconds. */
  get duration() { return (this.entry.samples - 1) / this.entry.rate; }

  /**
   * Moves the draws of the scene to a time. Returns the camera at that time; null if it has no keyframes.
   * @param {number} seconds @returns {Camera | null}
   */
  apply(seconds) {
    const at = Math.max(0, Math.min(this.entry.samples - 1, seconds * this.entry.rate));
    const first = Math.min(Math.floor(at), Math.max(0, this.entry.samples - 2)), share = at - first;
    const next = Math.min(first + 1, this.entry.samples - 1);
    /** @param {number} from @param {number} count */
    const numbers = (from, count) => Array.from({length: count}, (_, k) => {
      const a = this.values[first * this.stride + from + k], b = this.values[next * this.stride + from + k];
      return a + share * (b - a);
    });
    this.entry.draws.forEach((number, k) => {
      const draw = this.scene.draws[number];
      draw.toWorld = numbers(numbersPerDraw * k, 12);
      this.scene.frames[draw.frame].worldToDecoder = numbers(numbersPerDraw * k + 12, 9);
    });
    if (!this.entry.camera) return null;
    const c = numbers(numbersPerDraw * this.entry.draws.length, numbersPerCamera);
    return {eye: [c[0], c[1], c[2]], target: [c[3], c[4], c[5]], up: [c[6], c[7], c[8]], fov: c[9], orthoHeight: c[10], near: c[11], far: c[12]};
  }
}

/** @param {import('./scene.js').Manifest} scene @returns {Promise<Motion | null>} */
export async function loadMotion(scene) {
  if (!scene.motion) return null;
  const bytes = await unpacked(scene.motion.file, () => {});
  return new Motion(scene, new Float64Array(bytes.buffer, bytes.byteOffset, bytes.byteLength >> 3));
}
