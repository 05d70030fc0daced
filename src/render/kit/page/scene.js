// Paths in space: dragging or the arrow keys turn them, a double click or Home shows the first view.
(() => {
  const root = document.documentElement;
  const ink = name => getComputedStyle(root).getPropertyValue('--' + name).trim();
  for (const box of document.querySelectorAll('.scene')) {
    const spec = JSON.parse(box.dataset.scene), canvas = box.appendChild(document.createElement('canvas'));
    const known = p => p[0] !== null && p[1] !== null && p[2] !== null;
    const all = spec.planned.concat(spec.measured).filter(known);
    if (!all.length) continue;
    const ends = [0, 1, 2].map(k => all.reduce(([a, b], p) => [Math.min(a, p[k]), Math.max(b, p[k])], [Infinity, -Infinity]));
    const middle = ends.map(([a, b]) => (a + b) / 2);
    const corner = k => ends.map((e, axis) => e[(k >> axis) & 1]), corners = [0, 1, 2, 3, 4, 5, 6, 7].map(corner);
    const first = { yaw: spec.yaw, pitch: spec.pitch };
    let view = { ...first }, asked = false;
    canvas.setAttribute('aria-hidden', 'true');
    const seen = p => {
      const [x, y, z] = p.map((v, k) => v - middle[k]);
      const cy = Math.cos(view.yaw), sy = Math.sin(view.yaw), depth = x * cy + y * sy;
      return [y * cy - x * sy, depth * Math.sin(view.pitch) - z * Math.cos(view.pitch)];
    };
    // One scale for every view: turning must not zoom.
    const radius = Math.hypot(ends[0][1] - middle[0], ends[1][1] - middle[1], 1e-9);
    const tall = Math.max(...corners.map(p => Math.abs(seen(p)[1])), 0.6 * radius);
    function draw() {
      asked = false;
      const width = box.clientWidth, height = Math.min(420, Math.max(260, width * 0.5)), dense = window.devicePixelRatio || 1;
      if (!width) return;
      canvas.style.height = height + 'px';
      canvas.width = Math.round(width * dense); canvas.height = Math.round(height * dense);
      canvas.dataset.view = view.yaw.toFixed(3) + ' ' + view.pitch.toFixed(3);
      const c = canvas.getContext('2d');
      c.scale(dense, dense); c.lineJoin = c.lineCap = 'round'; c.font = '11px system-ui, sans-serif';
      const scale = Math.min((width / 2 - 24) / radius, (height / 2 - 30) / tall);
      const at = p => { const [x, y] = seen(p); return [width / 2 + x * scale, height / 2 + y * scale]; };
      const line = (points, colour, thick) => {
        c.strokeStyle = colour; c.lineWidth = thick; c.beginPath();
        let pen = false;
        for (const p of points) { if (!known(p)) { pen = false; continue; } c[pen ? 'lineTo' : 'moveTo'](...at(p)); pen = true; }
        c.stroke();
      };
      // The box around the paths shows how they are turned.
      corners.forEach((place, k) => {
        for (let axis = 0; axis < 3; axis++) if (!((k >> axis) & 1)) line([place, corner(k | (1 << axis))], ink('grid'), 1);
      });
      c.fillStyle = ink('soft'); c.textAlign = 'center'; c.textBaseline = 'middle';
      ['x', 'y', 'z'].forEach((name, axis) => {
        const from = corners[0], to = corner(1 << axis), [x, y] = at(from.map((v, k) => (v + to[k]) / 2));
        c.fillText(name, x - 8, y + 8);
      });
      line(spec.planned, ink('planned'), 6);
      for (let i = 1; i < spec.measured.length; i++) {
        const pair = [spec.measured[i - 1], spec.measured[i]];
        if (pair.every(known)) line(pair, ink('step' + spec.steps[i]), 1.5 + 0.6 * spec.steps[i]);
      }
      const rough = 0.25 * width / scale, power = 10 ** Math.floor(Math.log10(rough));
      const bar = [5, 2, 1].map(k => k * power).find(v => v <= rough) || power;
      c.strokeStyle = c.fillStyle = ink('ink'); c.lineWidth = 2; c.textAlign = 'left';
      c.beginPath(); c.moveTo(10, height - 8); c.lineTo(10 + bar * scale, height - 8); c.stroke();
      c.fillText(+bar.toPrecision(2) + ' ' + spec.unit, 10, height - 18);
    }
    const redraw = () => { if (!asked) { asked = true; requestAnimationFrame(draw); } };
    const turn = (yaw, pitch) => {
      view = { yaw: view.yaw + yaw, pitch: Math.min(Math.max(view.pitch + pitch, -1.57), 1.57) };
      redraw();
    };
    box.addEventListener('path', e => {
      Object.assign(spec, { measured: e.detail.path });
      spec.steps = e.detail.value.map(v => Math.min(Math.floor(5 * v / (spec.most || 1)), 4));
      redraw();
    });
    const home = () => { view = { ...first }; redraw(); };
    let from = null;
    canvas.addEventListener('pointerdown', e => { from = [e.clientX, e.clientY]; canvas.setPointerCapture(e.pointerId); });
    canvas.addEventListener('pointermove', e => {
      if (!from) return;
      turn((from[0] - e.clientX) * 0.01, (e.clientY - from[1]) * 0.01);
      from = [e.clientX, e.clientY];
    });
    for (const name of ['pointerup', 'pointercancel']) canvas.addEventListener(name, () => { from = null; });
    canvas.addEventListener('dblclick', home);
    box.addEventListener('keydown', e => {
      const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, 0.1], ArrowDown: [0, -0.1] }[e.key];
      if (step) turn(...step); else if (e.key === 'Home') home(); else return;
      e.preventDefault();
    });
    window.addEventListener('resize', redraw);
    window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', redraw);
    draw();
  }
})();
