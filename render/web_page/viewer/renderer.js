// @ts-check
// Draws the scene by WebGL 2. At rest: features of 2×2 samples per pixel into an integer target, averaged, then decoded
// once per pixel. While moving: one sample per pixel, decoded while drawing, at a resolution that follows the frame rate.

import {
  cameraAxes, columns, dot, halfHeight, multiply3, multiply4, objectToCamera, projection, transposed3,
} from './linear.js';
import {loadImage, loadLight, loadMesh} from './scene.js';

/**
 * @typedef {import('./linear.js').Camera} Camera
 * @typedef {import('./scene.js').Manifest} Manifest
 * @typedef {import('./scene.js').Mesh} Mesh
 * @typedef {{program: WebGLProgram, at: (name: string) => WebGLUniformLocation | null}} Program
 * @typedef {{framebuffer: WebGLFramebuffer, textures: Object<string, WebGLTexture>, width: number, height: number}} Target
 * @typedef {{mesh: Mesh, array: WebGLVertexArrayObject, positions: WebGLBuffer, rotations: WebGLBuffer | null, texels: WebGLTexture}} GpuSet
 */

// Above this number of clusters in view, drawing each by its own call costs more than front-to-back order saves.
const mostSortedClusters = 1500;

export class Renderer {
  /** @param {HTMLCanvasElement} canvas @param {Manifest} scene */
  constructor(canvas, scene) {
    const gl = canvas.getContext('webgl2', {antialias: false, depth: false, powerPreference: 'high-performance'});
    if (!gl) throw Error('This page needs WebGL 2, which this browser does not offer. Try a current version of Firefox, Chrome, Edge or Safari.');
    if (!gl.getExtension('EXT_color_buffer_float') && (scene.targets.rays || scene.targets.light))
      throw Error('This page needs WebGL 2 with EXT_color_buffer_float, which this device does not offer.');
    const precision = gl.getShaderPrecisionFormat(gl.FRAGMENT_SHADER, gl.HIGH_FLOAT);
    if (!precision || precision.precision < 23)
      throw Error('This page needs 32-bit floats in fragment shaders (highp), which this device does not offer.');
    const largest = gl.getParameter(gl.MAX_TEXTURE_SIZE);
    for (const {texels} of scene.sets)
      if (texels.width > largest || texels.height > largest)
        throw Error(`This device supports textures up to ${largest}², but the scene has one of ${texels.width}×${texels.height}.`);
    const targets = 1 + (scene.targets.frames ? 1 : 0) + (scene.targets.rays ? 1 : 0) + scene.targets.light;
    if (targets > gl.getParameter(gl.MAX_DRAW_BUFFERS))
      throw Error(`This page needs ${targets} render targets at once, which this device does not offer.`);
    /** Largest side of a picture with 2×2 samples per pixel. */
    this.largestPicture = Math.floor(Math.min(largest, gl.getParameter(gl.MAX_RENDERBUFFER_SIZE)) / 2);
    this.gl = gl;
    this.scene = scene;
    /** @type {WebGLTexture | undefined} */
    this.frameTable = undefined;
    this.clip = gl.getExtension('EXT_clip_control');
    /** @type {Map<string, Program>} */
    this.programs = new Map();
    /** @type {(GpuSet | null)[]} */
    this.sets = scene.sets.map(() => null);
    /** @type {({gain: WebGLTexture, offset: WebGLTexture | null, gloss: WebGLTexture[] | null} | null)[]} */
    this.lights = scene.draws.map(() => null);
    /** @type {Map<string, Target>} */
    this.targets = new Map();
    this.drawCalls = 0;
    this.trianglesDrawn = 0;
    this.aspect = 1;
  }

  /**
   * Uploads a texture set.
   * @param {number} number @param {(bytes: number) => void} received
   */
  async load(number, received) {
    const entry = this.scene.sets[number];
    const [mesh, image0, image1] = await Promise.all(
        [loadMesh(entry, received), loadImage(entry.texels.images[0], received), loadImage(entry.texels.images[1], received)]);
    for (const image of [image0, image1])
      if (image.width !== entry.texels.width || image.height !== entry.texels.height) throw Error('a feature image has the wrong size');
    this.sets[number] = {mesh, ...this.vertexArray(mesh), texels: this.joined(image0, image1)};
    image0.close();
    image1.close();
  }

  /**
   * Uploads the light map of a draw.
   * @param {number} number @param {(bytes: number) => void} received
   */
  async loadLightOf(number, received) {
    const light = this.scene.draws[number].light;
    if (!light) return;
    const gl = this.gl;
    /** @param {import('./scene.js').FileEntry} entry @param {number} channels */
    const upload = async (entry, channels = 4) => {
      const values = await loadLight(light, entry, channels, received);
      const texture = this.texture(channels === 4 ? gl.RGBA16F : gl.RG16F, light.width, light.height, gl.LINEAR);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, light.width, light.height, channels === 4 ? gl.RGBA : gl.RG, gl.HALF_FLOAT, values);
      return texture;
    };
    this.lights[number] = {gain: await upload(light.gain), offset: light.offset ? await upload(light.offset) : null,
      gloss: light.gloss ? [await upload(light.gloss.before), await upload(light.gloss.after), await upload(light.gloss.suns, 2)] : null};
  }

  /** @param {number} format @param {number} width @param {number} height @param {number} filter */
  texture(format, width, height, filter) {
    const gl = this.gl, texture = /** @type {WebGLTexture} */ (gl.createTexture());
    gl.activeTexture(gl.TEXTURE0);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, format, width, height);
    for (const [name, value] of [[gl.TEXTURE_MIN_FILTER, filter], [gl.TEXTURE_MAG_FILTER, filter],
      [gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE], [gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE]])
      gl.texParameteri(gl.TEXTURE_2D, name, value);
    return texture;
  }

  /**
   * The integer texture of two feature images, byte for byte.
   * @param {ImageBitmap} image0 @param {ImageBitmap} image1
   */
  joined(image0, image1) {
    const gl = this.gl, {width, height} = image0;
    gl.pixelStorei(gl.UNPACK_PREMULTIPLY_ALPHA_WEBGL, false);
    gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
    const images = [image0, image1].map((image) => {
      const texture = this.texture(gl.RGBA8, width, height, gl.NEAREST);
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, gl.RGBA, gl.UNSIGNED_BYTE, image);
      return texture;
    });
    const texels = this.texture(gl.RG32UI, width, height, gl.NEAREST), framebuffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.TEXTURE_2D, texels, 0);
    const program = this.program('join');
    gl.useProgram(program.program);
    images.forEach((texture, k) => this.bind(program, `image${k}`, k, texture));
    gl.disable(gl.DEPTH_TEST);
    gl.viewport(0, 0, width, height);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.deleteFramebuffer(framebuffer);
    for (const texture of images) gl.deleteTexture(texture);
    return texels;
  }

  /** @param {Mesh} mesh */
  vertexArray(mesh) {
    const gl = this.gl, array = /** @type {WebGLVertexArrayObject} */ (gl.createVertexArray());
    gl.bindVertexArray(array);
    /** @param {number} location @param {ArrayBufferView} data @param {number} size @param {number} stride @param {number} offset @param {boolean} integers */
    const attribute = (location, data, size, stride, offset, integers) => {
      gl.enableVertexAttribArray(location);
      if (integers) gl.vertexAttribIPointer(location, size, gl.UNSIGNED_SHORT, stride, offset);
      else gl.vertexAttribPointer(location, size, gl.FLOAT, false, stride, offset);
    };
    /** @param {ArrayBufferView} data */
    const buffer = (data) => {
      const made = /** @type {WebGLBuffer} */ (gl.createBuffer());
      gl.bindBuffer(gl.ARRAY_BUFFER, made);
      gl.bufferData(gl.ARRAY_BUFFER, data, gl.STATIC_DRAW);
      return made;
    };
    const positions = buffer(mesh.positions);
    attribute(0, mesh.positions, 3, 0, 0, false);
    buffer(mesh.texels);
    attribute(1, mesh.texels, 2, 0, 0, false);
    buffer(mesh.rectangles);
    attribute(6, mesh.rectangles, 4, 8, 0, true);
    attribute(7, mesh.rectangles, 2, 8, 0, true);  // the texels are packed already: a rectangle is at its own corner
    let rotations = null;
    if (mesh.rotations) {
      rotations = buffer(mesh.rotations);
      for (const column of [0, 1, 2]) attribute(2 + column, mesh.rotations, 3, 36, 12 * column, false);
    }
    if (mesh.lightPlaces) {
      buffer(mesh.lightPlaces);
      attribute(5, mesh.lightPlaces, 2, 0, 0, false);
    }
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, gl.createBuffer());
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, mesh.corners, gl.STATIC_DRAW);
    gl.bindVertexArray(null);
    return {array, positions, rotations};
  }

  /**
   * Uploads the positions and rotations of a set again.
   * @param {GpuSet} set
   */
  updateVertices({mesh, positions, rotations}) {
    const gl = this.gl;
    gl.bindBuffer(gl.ARRAY_BUFFER, positions);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, mesh.positions);
    if (!rotations || !mesh.rotations) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, rotations);
    gl.bufferSubData(gl.ARRAY_BUFFER, 0, mesh.rotations);
  }

  /** @param {string} name @returns {Program} */
  program(name) {
    const known = this.programs.get(name);
    if (known) return known;
    const gl = this.gl, texts = this.scene.programs[name];
    const program = /** @type {WebGLProgram} */ (gl.createProgram());
    for (const [type, text] of /** @type {[number, string][]} */ ([[gl.VERTEX_SHADER, texts.vertex], [gl.FRAGMENT_SHADER, texts.fragment]])) {
      const shader = /** @type {WebGLShader} */ (gl.createShader(type));
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) throw Error(`${name}: ${gl.getShaderInfoLog(shader)}`);
      gl.attachShader(program, shader);
    }
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS) && !gl.isContextLost()) throw Error(`${name}: ${gl.getProgramInfoLog(program)}`);
    /** @type {Map<string, WebGLUniformLocation | null>} */
    const places = new Map();
    const made = {
      program,
      /** @param {string} uniform */
      at: (uniform) => {
        if (!places.has(uniform)) places.set(uniform, gl.getUniformLocation(program, uniform));
        return places.get(uniform) ?? null;
      },
    };
    this.programs.set(name, made);
    return made;
  }

  /** @param {Program} program @param {string} name @param {number} unit @param {WebGLTexture} texture */
  bind(program, name, unit, texture) {
    const gl = this.gl;
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.uniform1i(program.at(name), unit);
  }

  /**
   * The render target of a name; made again when its size changes.
   * @param {string} name @param {number} width @param {number} height @param {[string, number][]} formats @param {boolean} depth
   */
  target(name, width, height, formats, depth) {
    const gl = this.gl, known = this.targets.get(name);
    if (known && known.width === width && known.height === height) return known;
    if (known) {
      // A bound framebuffer that loses its textures would leave Chromium's canvas without a buffer to draw to.
      gl.bindFramebuffer(gl.FRAMEBUFFER, null);
      for (const texture of Object.values(known.textures)) gl.deleteTexture(texture);
      gl.deleteFramebuffer(known.framebuffer);
    }
    /** @type {Object<string, WebGLTexture>} */
    const textures = {};
    for (const [key, format] of formats) textures[key] = this.texture(format, width, height, gl.NEAREST);
    if (depth) textures.depth = this.texture(gl.DEPTH_COMPONENT32F, width, height, gl.NEAREST);
    const framebuffer = /** @type {WebGLFramebuffer} */ (gl.createFramebuffer());
    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    formats.forEach(([key], k) => gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + k, gl.TEXTURE_2D, textures[key], 0));
    if (depth) gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.TEXTURE_2D, textures.depth, 0);
    gl.drawBuffers(formats.map((_, k) => gl.COLOR_ATTACHMENT0 + k));
    const made = {framebuffer, textures, width, height};
    this.targets.set(name, made);
    return made;
  }

  /** @param {Camera} camera @param {number} width @param {number} height @param {Program} program */
  setRays(camera, width, height, program) {
    const top = camera.orthoHeight ? 0 : halfHeight(camera, 1), right = top * this.aspect;
    this.gl.uniform2f(program.at('ray_scale'), 2 * right / width, 2 * top / height);
    this.gl.uniform2f(program.at('ray_offset'), -right, -top);
  }

  /**
   * Rotation from camera space to the directions that a frame's decoder takes.
   * @param {Camera} camera @param {number} frame
   */
  cameraToFed(camera, frame) {
    return multiply3(this.scene.frames[frame].worldToDecoder, transposed3(cameraAxes(camera).flat()));
  }

  /**
   * Draws all sets with the programs of a stage, nearest clusters first.
   * @param {Camera} camera @param {'geometry' | 'forward'} stage @param {(program: Program, frame: number) => void} prepare
   */
  drawSets(camera, stage, prepare) {
    const gl = this.gl, reversed = this.clip !== null, toClip = projection(camera, this.aspect, reversed);
    gl.enable(gl.DEPTH_TEST);
    gl.depthMask(true);
    if (this.clip) this.clip.clipControlEXT(this.clip.LOWER_LEFT_EXT, this.clip.ZERO_TO_ONE_EXT);
    gl.depthFunc(reversed ? gl.GEQUAL : gl.LEQUAL);
    gl.clearBufferfv(gl.DEPTH, 0, [reversed ? 0 : 1]);
    this.scene.draws.forEach((draw, number) => {
      const set = this.sets[draw.set], light = this.lights[number];
      if (!set || (draw.light && !light)) return;
      const program = this.program(`${stage} ${draw.kind}`), toCamera = objectToCamera(camera, draw.toWorld, this.scene.sets[draw.set].origin);
      const matrix = multiply4(toClip, toCamera);
      gl.useProgram(program.program);
      gl.uniformMatrix4fv(program.at('object_to_clip'), false, columns(matrix, 4));
      this.bind(program, 'features', 0, set.texels);
      if (set.mesh.rotations || draw.light?.gloss) this.setRotations(camera, program, draw, toCamera);
      if (draw.light && light) {
        gl.uniform2f(program.at('light_size'), draw.light.width, draw.light.height);
        this.bind(program, 'light_gain', 2, light.gain);
        if (light.offset) this.bind(program, 'light_offset', 3, light.offset);
        if (draw.light.gloss && light.gloss) this.setGloss(program, draw.light.gloss, light.gloss);
      }
      prepare(program, draw.frame);
      gl.bindVertexArray(set.array);
      this.drawClusters(set.mesh, matrix);
    });
    gl.bindVertexArray(null);
    gl.disable(gl.DEPTH_TEST);
    if (this.clip) this.clip.clipControlEXT(this.clip.LOWER_LEFT_EXT, this.clip.NEGATIVE_ONE_TO_ONE_EXT);
  }

  /** @param {Camera} camera @param {Program} program @param {import('./scene.js').DrawEntry} draw @param {number[]} toCamera */
  setRotations(camera, program, draw, toCamera) {
    const gl = this.gl;
    gl.uniform1i(program.at('parallel_rays'), camera.orthoHeight ? 1 : 0);
    gl.uniformMatrix4fv(program.at('object_to_camera'), false, columns([...toCamera, 0, 0, 0, 1], 4));
    gl.uniformMatrix3fv(program.at('camera_to_object'), false,
                        columns(multiply3(transposed3(draw.objectToFed), this.cameraToFed(camera, draw.frame)), 3));
    gl.uniformMatrix3fv(program.at('object_to_fed'), false, columns(draw.objectToFed, 3));
  }

  /** @param {Program} program @param {import('./scene.js').GlossEntry} gloss @param {WebGLTexture[]} textures */
  setGloss(program, gloss, textures) {
    const gl = this.gl;
    ['gloss_before', 'gloss_after', 'gloss_suns'].forEach((name, k) => this.bind(program, name, 6 + k, textures[k]));
    gl.uniform3fv(program.at('gloss_sky'), gloss.sky);
    gl.uniform3fv(program.at('gloss_sun_direction'), gloss.directions);
    gl.uniform3fv(program.at('gloss_sun_light'), gloss.lights);
    gl.uniform1i(program.at('gloss_sun_count'), gloss.count);
    gl.uniform1f(program.at('gloss_sharpness'), gloss.sharpness);
  }

  /**
   * Draws the clusters in view.
   * @param {Mesh} mesh @param {number[]} matrix object to clip space
   */
  drawClusters(mesh, matrix) {
    const gl = this.gl;
    /** @type {{cluster: import('./scene.js').Cluster, depth: number}[]} */
    const seen = [];
    for (const cluster of mesh.clusters) {
      const out = [0, 0, 0, 0, 0];
      let nearest = Infinity;
      for (let corner = 0; corner < 8; ++corner) {
        const p = [0, 1, 2].map((axis) => (corner >> axis & 1 ? cluster.high : cluster.low)[axis]);
        const x = dot(matrix, p) + matrix[3], y = dot(matrix.slice(4), p) + matrix[7], w = dot(matrix.slice(12), p) + matrix[15];
        [x < -w, x > w, y < -w, y > w, w < 0].forEach((beyond, k) => { if (beyond) ++out[k]; });
        nearest = Math.min(nearest, w);
      }
      if (!out.includes(8)) seen.push({cluster, depth: nearest});
    }
    if (seen.length <= mostSortedClusters) seen.sort((a, b) => a.depth - b.depth);
    for (let k = 0; k < seen.length;) {
      const {first} = seen[k].cluster;
      let {count} = seen[k].cluster;
      while (++k < seen.length && seen[k].cluster.first === first + count) count += seen[k].cluster.count;
      gl.drawElements(gl.TRIANGLES, count, gl.UNSIGNED_INT, 4 * first);
      ++this.drawCalls;
      this.trianglesDrawn += count / 3;
    }
  }

  /**
   * Draws a picture of `width` × `height` pixels into a framebuffer (null: the canvas) with 4 samples per pixel.
   * @param {Camera} camera @param {number} width @param {number} height @param {WebGLFramebuffer | null} framebuffer
   */
  drawAtRest(camera, width, height, framebuffer) {
    const gl = this.gl, {targets} = this.scene;
    if (Math.max(width, height) > this.largestPicture) throw Error(`This device draws pictures of up to ${this.largestPicture} pixels per side.`);
    this.begin(width, height);
    if (targets.frames) this.frameTable ??= this.texture(gl.RGBA32F, 4, this.scene.frames.length, gl.NEAREST);
    /** @type {[string, number][]} */
    const formats = [['features', gl.RG32UI]];
    if (targets.frames) formats.push(['frames', gl.R16UI]);
    if (targets.rays) formats.push(['rays', gl.RGBA32F]);
    if (targets.light > 0) formats.push(['gain', gl.RGBA16F]);
    if (targets.light > 1) formats.push(['offset', gl.RGBA16F]);
    const samples = this.target('samples', 2 * width, 2 * height, formats, true);
    gl.bindFramebuffer(gl.FRAMEBUFFER, samples.framebuffer);
    gl.viewport(0, 0, 2 * width, 2 * height);
    gl.clearBufferuiv(gl.COLOR, 0, [0, 0, 0, 0]);
    if (targets.rays) gl.clearBufferfv(gl.COLOR, targets.frames ? 2 : 1, [0, 0, 0, 0]);
    this.drawSets(camera, 'geometry', (program, frame) => gl.uniform1ui(program.at('frame'), frame));

    gl.bindFramebuffer(gl.FRAMEBUFFER, framebuffer);
    gl.viewport(0, 0, width, height);
    this.clearToBackground();
    const program = this.program('resolve');
    gl.useProgram(program.program);
    this.bind(program, 'features', 0, samples.textures.features);
    if (targets.frames) {
      this.bind(program, 'frames', 1, samples.textures.frames);
      const table = [];
      let decoders = 0;
      for (let k = 0; k < this.scene.frames.length; ++k) {
        const {decoder, alpha} = this.scene.frames[k], m = this.cameraToFed(camera, k);
        for (let column = 0; column < 3; ++column) table.push(m[column], m[3 + column], m[6 + column], 0);
        table.push(decoder, alpha[0], alpha[1], 0);
        decoders = Math.max(decoders, decoder + 1);
      }
      this.bind(program, 'frame_table', 5, /** @type {WebGLTexture} */ (this.frameTable));
      gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, 4, this.scene.frames.length, gl.RGBA, gl.FLOAT, new Float32Array(table));
      gl.uniform1f(program.at('decoder_count'), decoders);
    } else {
      this.setDecoder(camera, program, 0);
    }
    if (targets.rays) this.bind(program, 'rays', 2, samples.textures.rays);
    if (targets.light > 0) this.bind(program, 'light_gain', 3, samples.textures.gain);
    if (targets.light > 1) this.bind(program, 'light_offset', 4, samples.textures.offset);
    this.setRays(camera, 2 * width, 2 * height, program);
    gl.uniform4fv(program.at('background'), this.clearColor());
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    ++this.drawCalls;
  }

  /**
   * Draws into the canvas with one sample per pixel at a share of its resolution.
   * @param {Camera} camera @param {number} width @param {number} height @param {number} share
   */
  drawMoving(camera, width, height, share) {
    const gl = this.gl, w = Math.max(1, Math.round(share * width)), h = Math.max(1, Math.round(share * height));
    this.begin(width, height);
    const target = this.target('moving', w, h, [['picture', gl.RGBA8]], true);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    gl.viewport(0, 0, w, h);
    this.clearToBackground();
    this.drawSets(camera, 'forward', (program, frame) => {
      this.setDecoder(camera, program, frame);
      this.setRays(camera, w, h, program);
    });
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target.framebuffer);
    gl.bindFramebuffer(gl.DRAW_FRAMEBUFFER, null);
    gl.blitFramebuffer(0, 0, w, h, 0, 0, width, height, gl.COLOR_BUFFER_BIT, gl.LINEAR);
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  }

  /** @param {number} width @param {number} height */
  begin(width, height) {
    this.aspect = width / height;
    this.drawCalls = 0;
    this.trianglesDrawn = 0;
    this.gl.disable(this.gl.BLEND);
    this.gl.disable(this.gl.CULL_FACE);
  }

  clearToBackground() {
    this.gl.clearBufferfv(this.gl.COLOR, 0, this.clearColor());
  }

  /** The background with alpha, multiplied by it. */
  clearColor() { return this.scene.transparent ? [0, 0, 0, 0] : [...this.scene.background, 1]; }

  /** @param {Camera} camera @param {Program} program @param {number} frame */
  setDecoder(camera, program, frame) {
    const gl = this.gl, {decoder, alpha} = this.scene.frames[frame];
    gl.uniform1i(program.at('decoder'), decoder);
    gl.uniformMatrix3fv(program.at('camera_to_fed'), false, columns(this.cameraToFed(camera, frame), 3));
    gl.uniform2fv(program.at('alpha_code'), alpha);
  }

  /**
   * RGBA bytes of a picture with 4 samples per pixel, top row first.
   * @param {Camera} camera @param {number} width @param {number} height
   */
  pixels(camera, width, height) {
    const gl = this.gl, target = this.target('capture', width, height, [['picture', gl.RGBA8]], false);
    this.drawAtRest(camera, width, height, target.framebuffer);
    gl.bindFramebuffer(gl.FRAMEBUFFER, target.framebuffer);
    const bytes = new Uint8ClampedArray(4 * width * height), flipped = new Uint8ClampedArray(bytes.length);
    gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, bytes);
    // Pictures have colours that are not multiplied by alpha.
    if (this.scene.transparent)
      for (let p = 0; p < bytes.length; p += 4)
        for (let c = p; bytes[p + 3] > 0 && c < p + 3; ++c) bytes[c] = bytes[c] * 255 / bytes[p + 3];
    for (let y = 0; y < height; ++y) flipped.set(bytes.subarray(4 * width * y, 4 * width * (y + 1)), 4 * width * (height - 1 - y));
    return flipped;
  }
}
