// @ts-check
// Keyframes: places of draws and the camera at times, and poses of sets that bend, interpolated linearly.

import {setRotation, streamsOf, unpacked} from './scene.js';

/**
 * @typedef {import('./linear.js').Camera} Camera
 * @typedef {{set: number, seconds: number[], mesh: import('./scene.js').FileEntry, streams: {name: string, count: number}[]}} BendEntry
 * @typedef {{file: import('./scene.js').FileEntry, samples: number, draws: number[], bends: BendEntry[], camera: boolean}} MotionEntry
 */

const numbersPerDraw = 21, numbersPerCamera = 13;  // 3×4 object to world and 3×3 world to decoder; see web_page.cpp

/** The poses of one texture set. */
class Bend {
  /** @param {BendEntry} entry @param {import('./scene.js').SetEntry} set @param {Object<string, Int32Array>} streams */
  constructor(entry, set, streams) {
    this.entry = entry;
    this.step = set.step;
    this.streams = streams;
    // Each pose is stored as its difference from the one before.
    for (let pose = 1; pose < entry.seconds.length; ++pose)
      for (const name of ['x', 'y', 'z', 'qx', 'qy', 'qz', 'qw', 'mirrored']) {
        const values = streams[name + pose], before = streams[name + (pose - 1)];
        if (values) for (let v = 0; v < values.length; ++v) values[v] += before[v];
      }
  }

  /**
   * Moves the vertices of a mesh to a time.
   * @param {import('./scene.js').Mesh} mesh @param {number} seconds
   */
  apply(mesh, seconds) {
    const times = this.entry.seconds, {positions, rotations} = mesh;
    let first = 0;
    while (first + 2 < times.length && times[first + 1] <= seconds) ++first;
    const next = Math.min(first + 1, times.length - 1), length = times[next] - times[first];
    const share = length > 0 ? Math.max(0, Math.min(1, (seconds - times[first]) / length)) : 0;
    /** @param {string} name */
    const pair = (name) => [this.streams[name + first], this.streams[name + next]];
    ['x', 'y', 'z'].forEach((name, axis) => {
      const [a, b] = pair(name);
      for (let v = 0; v < a.length; ++v) positions[3 * v + axis] = (a[v] + share * (b[v] - a[v])) * this.step;
    });
    if (!rotations) return;
    const parts = ['qx', 'qy', 'qz', 'qw'].map(pair), mirrored = pair('mirrored'), nearer = share < 0.5 ? 0 : 1;
    for (let v = 0; v < mirrored[0].length; ++v) {
      // Nothing lies between a rotation and a reflection. Opposite quaternions are the same rotation.
      const part = mirrored[0][v] === mirrored[1][v] ? share : nearer;
      const sign = parts.reduce((sum, [a, b]) => sum + a[v] * b[v], 0) < 0 ? -1 : 1;
      const q = parts.map(([a, b]) => a[v] + part * (sign * b[v] - a[v]));
      setRotation(rotations, v, q[0], q[1], q[2], q[3], mirrored[nearer][v] !== 0);
    }
  }

  /**
   * Extends the boxes of a mesh's clusters, so that they hold all poses.
   * @param {import('./scene.js').Mesh} mesh
   */
  extendClusters(mesh) {
    for (const {first, count, low, high} of mesh.clusters)
      for (let pose = 0; pose < this.entry.seconds.length; ++pose)
        ['x', 'y', 'z'].forEach((name, axis) => {
          const values = this.streams[name + pose];
          for (let k = first; k < first + count; ++k) {
            const value = values[mesh.corners[k]] * this.step;
            low[axis] = Math.min(low[axis], value);
            high[axis] = Math.max(high[axis], value);
          }
        });
  }
}

export class Motion {
  /** @param {import('./scene.js').Manifest} scene @param {Float64Array} values @param {Bend[]} bends */
  constructor(scene, values, bends) {
    this.bends = bends;
    this.scene = scene;
    this.entry = /** @type {MotionEntry} */ (scene.motion);
    this.times = values.subarray(0, this.entry.samples);
    this.values = values.subarray(this.entry.samples);
    this.stride = numbersPerDraw * this.entry.draws.length + (this.entry.camera ? numbersPerCamera : 0);
    if (this.values.length !== this.stride * this.entry.samples) throw Error(`${this.entry.file.name} is damaged: publish the scene again`);
  }

  /** Seconds. */
  get duration() { return this.times[this.times.length - 1]; }

  /**
   * To be called when a renderer has loaded the scene.
   * @param {import('./renderer.js').Renderer} renderer
   */
  prepare(renderer) {
    for (const bend of this.bends) {
      const set = renderer.sets[bend.entry.set];
      if (set) bend.extendClusters(set.mesh);
    }
  }

  /**
   * Moves the draws of the scene, and what bends, to a time. Returns the camera at that time; null if it has no
   * keyframes.
   * @param {number} seconds @param {import('./renderer.js').Renderer} renderer @returns {Camera | null}
   */
  apply(seconds, renderer) {
    for (const bend of this.bends) {
      const set = renderer.sets[bend.entry.set];
      if (!set) continue;
      bend.apply(set.mesh, seconds);
      renderer.updateVertices(set);
    }
    let first = 0, last = this.times.length - 1;
    while (last - first > 1) {
      const middle = (first + last) >> 1;
      if (this.times[middle] <= seconds) first = middle;
      else last = middle;
    }
    const next = last, length = this.times[next] - this.times[first];
    const share = length > 0 ? Math.max(0, Math.min(1, (seconds - this.times[first]) / length)) : 0;
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

/** @param {import('./scene.js').Manifest} scene @param {(bytes: number) => void} received @returns {Promise<Motion | null>} */
export async function loadMotion(scene, received) {
  if (!scene.motion) return null;
  const bytes = await unpacked(scene.motion.file, received);
  const bends = await Promise.all(scene.motion.bends.map(async (entry) =>
    new Bend(entry, scene.sets[entry.set], streamsOf(await unpacked(entry.mesh, received), entry))));
  return new Motion(scene, new Float64Array(bytes.buffer, bytes.byteOffset, bytes.byteLength >> 3), bends);
}
