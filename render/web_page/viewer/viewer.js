// @ts-check
// The page: loads the scene, draws frames when something changes, and offers window.viewer.

import {rotated, sub, add, unit} from './linear.js';
import {loadManifest, totalBytes} from './scene.js';
import {Renderer} from './renderer.js';
import {Controls} from './controls.js';

/** @typedef {import('./linear.js').Camera} Camera */

const restAfter = 150;    // milliseconds without a change until the picture is drawn with all samples
const wantedFrame = 40;   // milliseconds of a frame while moving
const turnPeriod = 20000; // milliseconds of a turn of the turntable

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
    /** Resolves when everything is drawn; rejects if the page cannot show the scene. */
    this.ready = this.start();
    this.ready.catch(showError);
  }

  async start() {
    this.scene = await loadManifest();
    this.renderer = new Renderer(canvas, this.scene);
    this.controls = new Controls(canvas, this.scene.home, {
      changed: () => this.changed(),
      depthAt: (x, y) => this.renderer?.rayDepth(this.camera, x, y, canvas.width / canvas.height) ?? null,
    });
    this.share = 1;
    this.frames = 0;
    this.frameTime = 0;
    this.drawCallsOfLastFrame = 0;
    this.moved = -Infinity;
    this.atRest = false;
    this.pending = false;
    this.turning = false;
    canvas.addEventListener('webglcontextlost', (e) => { e.preventDefault(); this.lost = true; });
    canvas.addEventListener('webglcontextrestored', () => { this.lost = false; void this.restore(); });
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
    this.setUpTools();
    await this.loadAll();
    element('progress').hidden = true;
    await this.drawnAtRest();
    this.dispatchEvent(new Event('ready'));
  }

  /** Loads all sets; each appears as soon as it is there. */
  async loadAll() {
    const {scene, renderer} = this;
    if (!scene || !renderer) return;
    const all = totalBytes(scene);
    let loaded = 0;
    const show = () => {
      const percent = all ? Math.round(100 * loaded / all) : 100;
      element('progress').setAttribute('aria-valuenow', String(percent));
      element('bar').style.width = percent + '%';
      element('loaded').textContent = `${(loaded / 1e6).toFixed(1)} of ${(all / 1e6).toFixed(1)} MB`;
      this.changed();
    };
    show();
    await Promise.all(scene.sets.map(async (set, k) => {
      await renderer.load(k);
      loaded += set.mesh.bytes + set.texels.images[0].bytes + set.texels.images[1].bytes;
      show();
    }));
    await Promise.all(scene.draws.map(async ({light}, k) => {
      await renderer.loadLightOf(k);
      if (light) loaded += light.gain.bytes + (light.offset ? light.offset.bytes : 0);
      if (light) show();
    }));
  }

  /** After a lost context: everything is uploaded again. */
  async restore() {
    if (!this.scene) return;
    try {
      this.renderer = new Renderer(canvas, this.scene);
      await this.loadAll();
      await this.drawnAtRest();
      this.dispatchEvent(new Event('restored'));
    } catch (error) {
      showError(error);
    }
  }

  /** @returns {Camera} */
  get camera() { return /** @type {Controls} */ (this.controls).camera; }

  /**
   * Shows a camera: lengths in scene units, fov vertical in degrees.
   * @param {Partial<Camera>} camera
   */
  setView(camera) { this.controls?.move({...this.camera, ...camera}); }

  /**
   * A PNG data URL of the present view at 4 samples per pixel.
   * @param {number} width @param {number} height
   */
  async captureFrame(width, height) {
    await this.ready;
    const picture = document.createElement('canvas');
    picture.width = width;
    picture.height = height;
    const context = /** @type {CanvasRenderingContext2D} */ (picture.getContext('2d'));
    context.putImageData(new ImageData(/** @type {Renderer} */ (this.renderer).pixels(this.camera, width, height), width, height), 0, 0);
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
    if (this.turning) this.turnTo(now);
    const begin = performance.now(), moving = this.turning || begin - (this.moved ?? 0) < restAfter;
    try {
      if (moving) renderer.drawMoving(this.camera, canvas.width, canvas.height, this.share ?? 1);
      else renderer.drawAtRest(this.camera, canvas.width, canvas.height, null);
    } catch (error) {
      showError(error);
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

  /** Resolves when the present view is drawn with all samples. */
  drawnAtRest() {
    return new Promise((resolve) => {
      this.addEventListener('rest', resolve, {once: true});
      this.moved = -Infinity;
      this.request();
    });
  }

  resize() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const width = Math.max(1, Math.round(canvas.clientWidth * ratio)), height = Math.max(1, Math.round(canvas.clientHeight * ratio));
    if (canvas.width === width && canvas.height === height) return;
    canvas.width = width;
    canvas.height = height;
    this.changed();
  }

  /** @param {number} now */
  turnTo(now) {
    const camera = this.camera, angle = 2 * Math.PI * (now - (this.turnedAt ?? now)) / turnPeriod;
    this.turnedAt = now;
    this.controls?.move({...camera, eye: add(camera.target, rotated(sub(camera.eye, camera.target), unit(camera.up), angle))});
  }

  /** @param {boolean} on */
  setTurning(on) {
    this.turning = on;
    this.turnedAt = undefined;
    element('turn').setAttribute('aria-pressed', String(on));
    this.changed();
  }

  setUpTools() {
    const {scene} = this;
    if (!scene) return;
    const home = () => { this.setTurning(false); this.controls?.move(scene.home); };
    const turn = () => this.setTurning(!this.turning);
    const full = () => void (document.fullscreenElement ? document.exitFullscreen() : document.documentElement.requestFullscreen());
    const about = () => {
      const panel = element('panel');
      panel.hidden = !panel.hidden;
      element('about').setAttribute('aria-expanded', String(!panel.hidden));
      this.showStats();
    };
    element('home').onclick = home;
    element('turn').onclick = turn;
    element('full').onclick = full;
    element('about').onclick = about;
    element('turn').hidden = matchMedia('(prefers-reduced-motion: reduce)').matches;
    element('full').hidden = !document.fullscreenEnabled;
    canvas.addEventListener('keydown', (e) => {
      if (e.ctrlKey || e.metaKey || e.altKey) return;
      const action = {h: home, t: turn, f: full, i: about}[e.key.toLowerCase()];
      if (action) action();
    });
    for (const text of scene.decisions) {
      const item = document.createElement('li');
      item.textContent = text;
      element('decisions').append(item);
    }
    const views = /** @type {HTMLSelectElement} */ (element('views'));
    views.hidden = scene.views.length === 0;
    views.append(new Option('First view', ''));
    scene.views.forEach(({name}, k) => views.append(new Option(name, String(k))));
    views.onchange = () => { this.setTurning(false); this.controls?.move(views.value === '' ? scene.home : scene.views[Number(views.value)].camera); };
  }

  showStats() {
    const s = this.stats();
    element('stats').textContent = `${s.triangles} triangles, ${(s.bytes / 1e6).toFixed(1)} MB, ${this.frameTime?.toFixed(1)} ms for the last frame of ${canvas.width} × ${canvas.height} pixels`;
  }
}

/** @type {any} */ (window).viewer = new Viewer();
