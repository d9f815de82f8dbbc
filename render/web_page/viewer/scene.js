// @ts-check
// Loads the scene: scene.json and the files that it names, from a server or from elements of the page itself.

/**
 * @typedef {{name: string, bytes: number}} FileEntry
 * @typedef {{mesh: FileEntry, texels: {width: number, height: number, images: [FileEntry, FileEntry]}, vertices: number,
 *   triangles: number, step: number, texelSteps: number, origin: number[], streams: {name: string, count: number}[]}} SetEntry
 * @typedef {{before: FileEntry, after: FileEntry, suns: FileEntry, sky: number[], directions: number[], lights: number[], count: number, sharpness: number}} GlossEntry
 * @typedef {{width: number, height: number, gain: FileEntry, offset?: FileEntry, gloss?: GlossEntry}} LightEntry
 * @typedef {{set: number, frame: number, kind: string, toWorld: number[], objectToFed: number[], light?: LightEntry}} DrawEntry
 * @typedef {{decoder: number, worldToDecoder: number[], alpha: [number, number]}} FrameEntry
 * @typedef {{draws: DrawEntry[], sets: SetEntry[], frames: FrameEntry[], home: import('./linear.js').Camera,
 *   background: [number, number, number], up: [number, number, number], box: [number[], number[]], targets: {frames: boolean, rays: boolean, light: number},
 *   programs: Object<string, {vertex: string, fragment: string}>, decisions: string[], triangles: number,
 *   views: {name: string, camera: import('./linear.js').Camera, thumbnail?: FileEntry}[], motion?: import('./motion.js').MotionEntry,
 *   before?: boolean, transparent?: boolean}} Manifest
 * @typedef {{first: number, count: number, low: number[], high: number[]}} Cluster
 * @typedef {{corners: Uint32Array, positions: Float32Array, texels: Float32Array, rectangles: Uint16Array,
 *   rotations?: Float32Array, lightPlaces?: Float32Array, clusters: Cluster[]}} Mesh
 */

const clusterTriangles = 256;

/**
 * The bytes of a file of the page. `received` is called with the number of further bytes.
 * @param {string} name @param {(bytes: number) => void} [received] @returns {Promise<Uint8Array>}
 */
async function fileBytes(name, received) {
  const element = document.getElementById(name);
  if (element) {
    const text = atob(element.textContent ?? '');
    received?.(text.length);
    return Uint8Array.from(text, (c) => c.charCodeAt(0));
  }
  let answer;
  try {
    answer = await fetch(name);
  } catch {
    throw Error(`${name} cannot be loaded. Is the network or the server down?`);
  }
  if (!answer.ok || !answer.body) throw Error(`${name} cannot be loaded (${answer.status})`);
  const reader = answer.body.getReader(), pieces = [];
  let size = 0;
  for (;;) {
    const {done, value} = await reader.read();
    if (done) break;
    pieces.push(value);
    size += value.length;
    received?.(value.length);
  }
  const bytes = new Uint8Array(size);
  let at = 0;
  for (const piece of pieces) {
    bytes.set(piece, at);
    at += piece.length;
  }
  return bytes;
}

/** @param {string} name scene.json or before.json @returns {Promise<Manifest>} */
export async function loadManifest(name) {
  const element = document.getElementById(name);
  const text = element ? element.textContent ?? '' : new TextDecoder().decode(await fileBytes(name));
  try {
    return JSON.parse(text);
  } catch {
    throw Error(name + ' is damaged: publish the scene again, or copy its folder again');
  }
}

/**
 * The contents of a gzip file. Some servers unpack it on the way.
 * @param {FileEntry} entry @param {(bytes: number) => void} received @returns {Promise<Uint8Array>}
 */
export async function unpacked(entry, received) {
  const bytes = await fileBytes(entry.name, received);
  if (bytes[0] !== 0x1f || bytes[1] !== 0x8b) return bytes;
  try {
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Uint8Array(await new Response(stream).arrayBuffer());
  } catch {
    throw damaged(entry);
  }
}

/** @param {FileEntry} entry */
const damaged = (entry) => Error(`${entry.name} is damaged: publish the scene again, or copy its folder again`);

/**
 * A feature image with its bytes as in the file.
 * @param {FileEntry} entry @param {(bytes: number) => void} received
 */
export async function loadImage(entry, received) {
  const blob = new Blob([await fileBytes(entry.name, received)], {type: entry.name.endsWith('.webp') ? 'image/webp' : 'image/png'});
  try {
    return await createImageBitmap(blob, {premultiplyAlpha: 'none', colorSpaceConversion: 'none'});
  } catch {
    throw damaged(entry);
  }
}

/**
 * An address of a picture of the page, for an img element.
 * @param {FileEntry} entry
 */
export async function pictureAddress(entry) {
  return URL.createObjectURL(new Blob([await fileBytes(entry.name)], {type: 'image/png'}));
}

/**
 * Half floats of a light map.
 * @param {LightEntry} light @param {FileEntry} entry @param {number} channels @param {(bytes: number) => void} received
 */
export async function loadLight(light, entry, channels, received) {
  const bytes = await unpacked(entry, received);
  if (bytes.length !== 2 * channels * light.width * light.height) throw damaged(entry);
  return new Uint16Array(bytes.buffer);
}

/**
 * Streams of integers: successive differences, zigzag coded, in four planes of bytes.
 * @param {Uint8Array} bytes @param {{mesh: FileEntry, streams: {name: string, count: number}[]}} set @returns {Object<string, Int32Array>}
 */
export function streamsOf(bytes, set) {
  /** @type {Object<string, Int32Array>} */
  const streams = {};
  let at = 0;
  if (bytes.length !== 4 * set.streams.reduce((sum, {count}) => sum + count, 0)) throw damaged(set.mesh);
  for (const {name, count} of set.streams) {
    const values = new Int32Array(count);
    let value = 0;
    for (let k = 0; k < count; ++k) {
      const code = bytes[at + k] | bytes[at + count + k] << 8 | bytes[at + 2 * count + k] << 16 | bytes[at + 3 * count + k] << 24;
      value = value + ((code >>> 1) ^ -(code & 1)) | 0;
      values[k] = value;
    }
    streams[name] = values;
    at += 4 * count;
  }
  return streams;
}

/**
 * Sets the rotation matrix of a vertex, column-major, from a quaternion of any length.
 * @param {Float32Array} rotations @param {number} vertex @param {number} qx @param {number} qy @param {number} qz @param {number} qw
 * @param {boolean} mirrored
 */
export function setRotation(rotations, vertex, qx, qy, qz, qw, mirrored) {
  const scale = 1 / (Math.hypot(qx, qy, qz, qw) || 1), sign = mirrored ? -1 : 1, x = qx * scale, y = qy * scale, z = qz * scale, w = qw * scale;
  let at = 9 * vertex;
  rotations[at++] = sign * (1 - 2 * (y * y + z * z));
  rotations[at++] = sign * 2 * (x * y + z * w);
  rotations[at++] = sign * 2 * (x * z - y * w);
  rotations[at++] = sign * 2 * (x * y - z * w);
  rotations[at++] = sign * (1 - 2 * (x * x + z * z));
  rotations[at++] = sign * 2 * (y * z + x * w);
  rotations[at++] = sign * 2 * (x * z + y * w);
  rotations[at++] = sign * 2 * (y * z - x * w);
  rotations[at] = sign * (1 - 2 * (x * x + y * y));
}

/** @param {Uint32Array} corners @param {Float32Array} positions @returns {Cluster[]} */
function clustersOf(corners, positions) {
  const clusters = [];
  for (let first = 0; first < corners.length; first += 3 * clusterTriangles) {
    const count = Math.min(3 * clusterTriangles, corners.length - first);
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let k = first; k < first + count; ++k)
      for (let axis = 0; axis < 3; ++axis) {
        const value = positions[3 * corners[k] + axis];
        if (value < low[axis]) low[axis] = value;
        if (value > high[axis]) high[axis] = value;
      }
    clusters.push({first, count, low, high});
  }
  return clusters;
}

/** @param {SetEntry} set @param {(bytes: number) => void} received @returns {Promise<Mesh>} */
export async function loadMesh(set, received) {
  const s = streamsOf(await unpacked(set.mesh, received), set), n = set.vertices;
  const positions = new Float32Array(3 * n), texels = new Float32Array(2 * n), rectangles = new Uint16Array(4 * n);
  const {x, y, z, u, v, left, top, width, height} = s, {step, texelSteps} = set;
  for (let k = 0; k < n; ++k) {
    positions[3 * k] = x[k] * step;
    positions[3 * k + 1] = y[k] * step;
    positions[3 * k + 2] = z[k] * step;
    texels[2 * k] = left[k] + u[k] / texelSteps;
    texels[2 * k + 1] = top[k] + v[k] / texelSteps;
    rectangles[4 * k] = left[k];
    rectangles[4 * k + 1] = top[k];
    rectangles[4 * k + 2] = left[k] + width[k];
    rectangles[4 * k + 3] = top[k] + height[k];
  }
  const corners = new Uint32Array(s.corners.buffer);
  /** @type {Mesh} */
  const mesh = {corners, positions, texels, rectangles, clusters: clustersOf(corners, positions)};
  if (s.qx) {
    mesh.rotations = new Float32Array(9 * n);
    for (let k = 0; k < n; ++k) setRotation(mesh.rotations, k, s.qx[k], s.qy[k], s.qz[k], s.qw[k], s.mirrored[k] !== 0);
  }
  if (s.light_x) {
    mesh.lightPlaces = new Float32Array(2 * n);
    for (let k = 0; k < n; ++k) mesh.lightPlaces.set([s.light_x[k] / 256, s.light_y[k] / 256], 2 * k);
  }
  return mesh;
}

/**
 * All files of the scene.
 * @param {Manifest} scene
 */
export function totalBytes(scene) {
  let bytes = 0;
  for (const set of scene.sets) bytes += set.mesh.bytes + set.texels.images[0].bytes + set.texels.images[1].bytes;
  for (const {light} of scene.draws)
    for (const entry of light ? [light.gain, light.offset, light.gloss?.before, light.gloss?.after, light.gloss?.suns] : []) bytes += entry?.bytes ?? 0;
  if (scene.motion) for (const file of [scene.motion.file, ...scene.motion.bends.map(({mesh}) => mesh)]) bytes += file.bytes;
  return bytes;
}
