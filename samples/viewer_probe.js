// Put in front of a viewer page by measure_viewer.py. Wraps WebGL and requestAnimationFrame, waits until the whole scene is
// drawn, times frames, and sends times, camera and picture to the server. EXPECTED: {triangles, images, frames}.
(() => {
  let gl = null, drawn = 0, images = 0, largest = 0, camera = null, loaded = 0;
  const times = [], names = new Map(), values = new Map(), prototype = WebGL2RenderingContext.prototype;
  const send = (name, body) => fetch('/probe/' + name, {method: 'POST', body});
  window.addEventListener('error', (event) => send('failed', String(event.message)));
  const wrap = (name, after) => {
    const original = prototype[name];
    prototype[name] = function (...args) {
      const result = original.apply(this, args);
      after(this, args, result);
      return result;
    };
  };
  wrap('getUniformLocation', (_, [program, name], location) => { if (location) names.set(location, name); });
  wrap('uniformMatrix4fv', (context, [location, , matrix]) => {
    const program = context.getParameter(context.CURRENT_PROGRAM);
    if (!values.has(program)) values.set(program, {});
    values.get(program)[names.get(location)] = Array.from(matrix);
  });
  const countDraw = (context, mode, count) => {
    gl = context;
    if (mode !== context.TRIANGLES) return;
    drawn += count / 3;
    const of = values.get(context.getParameter(context.CURRENT_PROGRAM));
    if (count <= largest || !of || !of.modelViewMatrix || !of.projectionMatrix) return;
    largest = count;
    camera = {modelView: of.modelViewMatrix, projection: of.projectionMatrix};
  };
  wrap('drawArrays', (context, [mode, , count]) => countDraw(context, mode, count));
  wrap('drawElements', (context, [mode, count]) => countDraw(context, mode, count));
  const countImage = (_, args) => { if (args[args.length - 1] instanceof HTMLImageElement || args[args.length - 1] instanceof ImageBitmap) ++images; };
  wrap('texImage2D', countImage);
  wrap('texSubImage2D', countImage);

  // Reading a pixel waits until the frame is drawn.
  const finish = () => {
    const bound = gl.getParameter(gl.READ_FRAMEBUFFER_BINDING);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, null);
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, bound);
  };
  const report = async () => {
    const canvas = gl.canvas, picture = document.createElement('canvas');
    picture.width = canvas.width;
    picture.height = canvas.height;
    const context = picture.getContext('2d');
    context.drawImage(canvas, 0, 0);
    const blob = await new Promise((done) => picture.toBlob(done, 'image/png'));
    await send('picture', blob);
    await send('report', JSON.stringify({load: loaded, frames: times, camera, width: canvas.width, height: canvas.height}));
  };
  const request = window.requestAnimationFrame.bind(window);
  window.requestAnimationFrame = (callback) => request((now) => {
    drawn = 0;
    const start = performance.now();
    callback(now);
    if (!gl || times.length >= EXPECTED.frames) return;
    finish();
    const end = performance.now();
    if (!loaded) {
      if (drawn >= EXPECTED.triangles && images >= EXPECTED.images) loaded = end;
    } else {
      times.push(end - start);
      if (times.length === EXPECTED.frames) report();
    }
  });
})();
