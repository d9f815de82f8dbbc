// @ts-check
// The page: loads the scene, draws frames when something changes, and offers window.viewer.

import {loadManifest, pictureAddress, totalBytes} from './scene.js';
import {loadMotion} from './motion.js';
import {depthAlongRay} from './picking.js';
import {Renderer} from './renderer.js';
import {Controls} from './controls.js';

/** @typedef {import('./linear.js').Camera} Camera */

const restAfter = 150;        // milliseconds without a change until the picture is drawn with all samples
const wantedFrame = 40;       // milliseconds of a frame while moving
const rotationPeriod = 20000; // milliseconds of a full rotation of the turntable

/** @param {string} id */
const element = (id) => /** @type {HTMLElement} */ (document.getElementById(id));
const canvas = /** @type {HTMLCanvasElement} */ (element('picture'));

/** @param {unknown} error */
function showError(error) {
  element('message').textContent = error instanceof Error ? error.message : String(error);
  element('message').hidden = false;
  element('progress').hidden = true;
}

/** A scene in the page. */
class Viewer extends EventTarget {
  constructor() {
    super();
    element('message').hidden = true;
    element('message').classList.remove('late');
    /** Resolves when everything is drawn; rejects if the page cannot show the scene. */
    this.ready = this.start();
    this.ready.catch(showError);
  }

  async start() {
    element('progress').hidden = false;
    this.scene = await loadManifest('scene.json');
    this.renderer = new Renderer(canvas, this.scene);
    /** The edited scene and the one before the edits, with their renderers; the latter is loaded when asked for. */
    this.edited = {scene: this.scene, renderer: this.renderer};
    this.controls = new Controls(canvas, this.scene.home, this.scene, {
      changed: () => this.changed(),
      depthAt: (x, y) => this.scene && this.renderer ?
          depthAlongRay(this.scene, this.renderer.sets, this.camera, x, y, canvas.width / canvas.height) : null,
    });
    this.share = 1;
    this.frames = 0;
    this.frameTime = 0;
    this.drawCallsOfLastFrame = 0;
    this.moved = -Infinity;
    this.atRest = false;
    this.pending = false;
    this.rotating = false;
    /** @type {boolean} */
    this.playing = false;
    this.follows = true;
    for (const name of ['pointerdown', 'wheel']) canvas.addEventListener(name, () => { this.follows = false; });
    canvas.addEventListener('webglcontextlost', (e) => { e.preventDefault(); this.lost = true; });
    canvas.addEventListener('webglcontextrestored', () => { this.lost = false; void this.restore(); });
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    this.showStored(this.scene.home);
    this.setUpTools();
    const {scene} = this;
    await this.loadAll(async (received) => { this.motion = await loadMotion(scene, received); });
    this.motion?.prepare(this.renderer);
    this.setUpPlayer();
    element('progress').hidden = true;
    await this.drawnAtRest();
    document.getElementById('poster')?.remove();
    this.dispatchEvent(new Event('ready'));
  }

  /**
   * Shows the scene before the edits, or the edited one again. Resolves when it is drawn.
   * @param {boolean} before
   */
  async showBefore(before) {
    if (!this.edited?.scene.before) throw Error('this page has no scene before the edits; publish it with --before');
    element('before').setAttribute('aria-pressed', String(before));
    this.setPlaying(false);
    if (before && !this.earlier) {
      element('progress').hidden = false;
      const scene = await loadManifest('before.json'), earlier = {scene, renderer: new Renderer(canvas, scene)};
      try {
        Object.assign(this, earlier);
        await this.loadAll();
        this.earlier = earlier;
      } catch (error) {
        Object.assign(this, this.edited);
        element('before').setAttribute('aria-pressed', 'false');
        throw error;
      } finally {
        element('progress').hidden = true;
      }
    }
    Object.assign(this, before ? this.earlier : this.edited);
    if (this.controls && this.scene) this.controls.scene = this.scene;
    element('player').hidden = before || !this.moves;
    await this.drawnAtRest();
  }

  /** Whether there is something to play. */
  get moves() { return this.motion !== undefined && this.motion !== null && this.motion.duration > 0; }

  /** Whether the scene before the edits is shown. */
  get showsBefore() { return this.earlier !== undefined && this.scene === this.earlier.scene; }

  /**
   * Shows the scene at a time of its keyframes.
   * @param {number} seconds
   */
  seek(seconds) {
    if (!this.motion || !this.edited) throw Error('this page has no keyframes');
    if (!Number.isFinite(seconds)) throw RangeError(`${seconds} is not a time in seconds`);
    this.seconds = Math.max(0, Math.min(this.motion.duration, seconds));
    const camera = this.motion.apply(this.seconds, this.edited.renderer);
    // A camera that somebody moves is theirs until the film is played again.
    if (camera && this.follows) this.showStored(camera);
    /** @type {HTMLInputElement} */ (element('time')).value = String(this.seconds);
    this.changed();
  }

  /** @param {boolean} on */
  setPlaying(on) {
    if (on === this.playing) return;
    if (on && !this.motion) throw Error('this page has no keyframes');
    this.playing = on;
    this.follows = true;
    this.playedAt = undefined;
    if (on && this.motion && (this.seconds ?? 0) >= this.motion.duration) this.seconds = 0;
    element('play').setAttribute('aria-pressed', String(on));
    element('play').textContent = on ? 'Pause' : 'Play';
    this.changed();
  }

  setUpPlayer() {
    const {motion} = this;
    element('player').hidden = !this.moves;
    if (!motion) return;
    const time = /** @type {HTMLInputElement} */ (element('time'));
    time.max = String(motion.duration);
    time.oninput = () => { this.setPlaying(false); this.follows = true; this.seek(Number(time.value)); };
    element('play').onclick = () => this.setPlaying(!this.playing);
  }

  /**
   * Loads all sets; each appears as soon as it is there.
   * @param {(received: (bytes: number) => void) => Promise<void>} [more] what else to load at last
   */
  async loadAll(more) {
    const {scene, renderer} = this;
    if (!scene || !renderer) return;
    const all = totalBytes(scene);
    let loaded = 0;
    /** @param {number} bytes */
    const received = (bytes) => {
      loaded += bytes;
      const percent = all ? Math.min(100, Math.round(100 * loaded / all)) : 100;
      element('progress').setAttribute('aria-valuenow', String(percent));
      element('bar').style.width = percent + '%';
      element('loaded').textContent = `${(loaded / 1e6).toFixed(1)} of ${(all / 1e6).toFixed(1)} MB`;
    };
    received(0);
    await Promise.all(scene.sets.map(async (set, k) => {
      await renderer.load(k, received);
      this.changed();
    }));
    await Promise.all(scene.draws.map(async ({light}, k) => {
      await renderer.loadLightOf(k, received);
      if (light) this.changed();
    }));
    await more?.(received);
  }

  /** After a lost context: everything is uploaded again. */
  async restore() {
    if (!this.scene) return;
    try {
      // The scene before the edits is loaded again when it is asked for.
      Object.assign(this, this.edited);
      if (this.controls) this.controls.scene = this.scene;
      element('player').hidden = !this.moves;
      this.earlier = undefined;
      element('before').setAttribute('aria-pressed', 'false');
      this.renderer = new Renderer(canvas, this.scene);
      this.edited = {scene: this.scene, renderer: this.renderer};
      await this.loadAll();
      this.motion?.prepare(this.renderer);
      if (this.seconds !== undefined) this.seek(this.seconds);
      await this.drawnAtRest();
      this.dispatchEvent(new Event('restored'));
    } catch (error) {
      showError(error);
    }
  }

  /** @returns {Camera} */
  get camera() { return /** @type {Controls} */ (this.controls).camera; }

  /**
   * Shows a camera: lengths in scene units, fov vertical in degrees; orthoHeight above 0 for parallel rays. Throws
   * RangeError if it shows nothing.
   * @param {Partial<Camera>} camera
   */
  setView(camera) {
    if (!this.controls?.move({...this.camera, ...camera}))
      throw RangeError('this camera shows nothing: ' + JSON.stringify(camera));
  }

  /**
   * Shows a stored camera. In a window that is higher than wide, it shows as much from left to right as in a square one.
   * @param {Camera} camera
   */
  showStored(camera) {
    const narrow = Math.min(1, canvas.width / canvas.height);
    if (camera.orthoHeight) this.controls?.move({...camera, orthoHeight: camera.orthoHeight / narrow});
    else this.controls?.move({...camera, fov: 360 / Math.PI * Math.atan(Math.tan(camera.fov * Math.PI / 360) / narrow)});
  }

  /**
   * A PNG data URL of the present view at 4 samples per pixel.
   * @param {number} width @param {number} height
   */
  async captureFrame(width, height) {
    await this.ready;
    const picture = document.createElement('canvas');
    const pixels = /** @type {Renderer} */ (this.renderer).pixels(this.camera, width, height);
    picture.width = width;
    picture.height = height;
    const context = /** @type {CanvasRenderingContext2D} */ (picture.getContext('2d'));
    context.putImageData(new ImageData(pixels, width, height), 0, 0);
    this.changed();
    return picture.toDataURL('image/png');
  }

  /** Counts of the page: frames drawn so far, and of the last frame its milliseconds, draw calls and triangles. */
  stats() {
    return {frames: this.frames, milliseconds: this.frameTime, drawCalls: this.drawCallsOfLastFrame,
      trianglesDrawn: this.renderer?.trianglesDrawn, triangles: this.scene?.triangles,
      bytes: this.scene ? totalBytes(this.scene) : 0, resolution: this.share, atRest: this.atRest};
  }

  changed() {
    this.moved = performance.now();
    this.atRest = false;
    this.request();
  }

  request() {
    if (this.pending) return;
    this.pending = true;
    requestAnimationFrame((now) => { this.pending = false; this.frame(now); });
  }

  /** @param {number} now */
  frame(now) {
    const {renderer} = this;
    if (!renderer || this.lost || canvas.width === 0 || canvas.height === 0) return;
    if (this.rotating) this.rotateTo(now);
    if (this.playing) this.playTo(now);
    const begin = performance.now(), moving = this.rotating || this.playing || begin - (this.moved ?? 0) < restAfter;
    try {
      if (moving) renderer.drawMoving(this.camera, canvas.width, canvas.height, this.share ?? 1);
      else renderer.drawAtRest(this.camera, canvas.width, canvas.height, null);
    } catch (error) {
      showError(error);
      this.dispatchEvent(new CustomEvent('failed', {detail: error}));
      return;
    }
    // Waits for the GPU, so that the time is that of the frame.
    renderer.gl.readPixels(0, 0, 1, 1, renderer.gl.RGBA, renderer.gl.UNSIGNED_BYTE, new Uint8Array(4));
    this.frameTime = performance.now() - begin;
    this.frames = (this.frames ?? 0) + 1;
    this.drawCallsOfLastFrame = renderer.drawCalls;
    if (moving) {
      const ratio = Math.sqrt(wantedFrame / Math.max(this.frameTime, 1));
      this.share = Math.min(1, Math.max(0.25, (this.share ?? 1) * Math.min(1.1, Math.max(0.8, ratio))));
      this.request();
      return;
    }
    this.atRest = true;
    this.dispatchEvent(new Event('rest'));
    this.showStats();
  }

  /** Resolves when the present view is drawn with all samples; rejects if it cannot be drawn. */
  drawnAtRest() {
    return new Promise((resolve, reject) => {
      this.addEventListener('rest', resolve, {once: true});
      this.addEventListener('failed', (e) => reject(/** @type {CustomEvent} */ (e).detail), {once: true});
      this.moved = -Infinity;
      this.request();
    });
  }

  resize() {
    const largest = (this.renderer?.largestPicture ?? Infinity) / Math.max(canvas.clientWidth, canvas.clientHeight, 1);
    const ratio = Math.min(window.devicePixelRatio || 1, 2, largest);
    const width = Math.max(1, Math.floor(canvas.clientWidth * ratio)), height = Math.max(1, Math.floor(canvas.clientHeight * ratio));
    if (canvas.width === width && canvas.height === height) return;
    canvas.width = width;
    canvas.height = height;
    this.changed();
    // A new size clears the canvas; without a frame now, the browser would show it empty.
    this.frame(performance.now());
  }

  /** @param {number} now */
  rotateTo(now) {
    this.controls?.rotate(2 * Math.PI * (now - (this.rotatedAt ?? now)) / rotationPeriod);
    this.rotatedAt = now;
  }

  /** @param {number} now */
  playTo(now) {
    const passed = (now - (this.playedAt ?? now)) / 1000;
    this.playedAt = now;
    this.seek((this.seconds ?? 0) + passed);
    if (this.motion && (this.seconds ?? 0) >= this.motion.duration) this.setPlaying(false);
  }

  /** @param {boolean} on */
  setRotating(on) {
    this.rotating = on;
    this.rotatedAt = undefined;
    element('rotate').setAttribute('aria-pressed', String(on));
    this.changed();
  }

  /** @param {boolean} open */
  openPanel(open) {
    element('panel').hidden = !open;
    element('about').setAttribute('aria-expanded', String(open));
    this.showStats();
  }

  setUpTools() {
    const {scene} = this;
    if (!scene) return;
    const home = () => { this.setRotating(false); this.setPlaying(false); this.showStored(scene.home); };
    const rotate = () => this.setRotating(!this.rotating);
    const full = () => void (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
    const about = () => this.openPanel(element('panel').hidden);
    const play = () => { if (this.motion && !this.showsBefore) this.setPlaying(!this.playing); };
    const before = () => { if (scene.before) this.showBefore(!this.showsBefore).catch(showError); };
    element('before').hidden = !scene.before;
    element('before').onclick = before;
    document.documentElement.classList.toggle('transparent', Boolean(scene.transparent));
    element('home').onclick = home;
    element('rotate').onclick = rotate;
    element('full').onclick = full;
    element('about').onclick = about;
    element('close').onclick = () => { this.openPanel(false); element('about').focus(); };
    element('rotate').hidden = matchMedia('(prefers-reduced-motion: reduce)').matches;
    element('full').hidden = !document.fullscreenEnabled;
    window.addEventListener('keydown', (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey || e.target instanceof HTMLSelectElement || e.target instanceof HTMLInputElement) return;
      const action = {h: home, r: rotate, f: full, i: about, p: play, b: before, escape: () => this.openPanel(false)}[e.key.toLowerCase()];
      if (action) action();
      else if (this.controls?.keyPressed(e)) e.preventDefault();
    });
    for (const text of scene.decisions) {
      const item = document.createElement('li');
      item.textContent = text;
      element('decisions').append(item);
    }
    const views = /** @type {HTMLSelectElement} */ (element('views'));
    views.hidden = scene.views.length === 0;
    views.append(new Option('Views', ''));
    scene.views.forEach(({name}, k) => views.append(new Option(name, String(k))));
    /** @param {Camera} camera */
    const choose = (camera) => { this.setRotating(false); this.setPlaying(false); this.showStored(camera); };
    views.onchange = () => {
      const view = scene.views[Number(views.value)];
      if (views.value === '' || !view) return;
      // The menu names no view, so that each can be chosen again.
      views.value = '';
      choose(view.camera);
    };
    for (const {name, camera, thumbnail} of scene.views) {
      if (!thumbnail) continue;
      const button = document.createElement('button'), image = document.createElement('img');
      image.alt = name;
      button.title = name;
      button.append(image);
      button.onclick = () => choose(camera);
      element('gallery').append(button);
      pictureAddress(thumbnail).then((address) => { image.src = address; }, showError);
    }
    element('gallery').hidden = !scene.views.some(({thumbnail}) => thumbnail);
  }

  showStats() {
    const s = this.stats();
    element('stats').textContent = `${s.triangles} triangles, ${(s.bytes / 1e6).toFixed(2)} MB, ${this.frameTime?.toFixed(1)} ms for the last frame of ${canvas.width} × ${canvas.height} pixels`;
  }
}

/** @type {any} */ (window).viewer = new Viewer();
