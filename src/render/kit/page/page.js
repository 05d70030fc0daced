'use strict';
// Draws the plots of a page from its data block. Drag zooms, double click resets, pointing reads values;
// plots of one group share range and pointer.
const plotted = (() => {
  const root = document.documentElement;
  root.classList.add('js');
  const specs = JSON.parse(document.getElementById('data').textContent);
  const style = getComputedStyle(root), colour = name => style.getPropertyValue('--' + name).trim();
  const clamp = (v, a, b) => Math.min(Math.max(v, a), b);
  const LINE = { planned: 5, measured: 1.6, error: 1.6, before: 1.4, command: 1.4, guide: 1 };

  // Multiples of 1, 2 or 5 times a power of ten within a range.
  function ticks([low, high], most) {
    const rough = (high - low) / Math.max(most, 1), power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= rough * 0.999) || rough;
    const list = [];
    for (let k = Math.ceil(low / step); k * step <= high + step * 1e-9 && list.length < 40; k++) list.push(k * step);
    if (list.length < 2 && most < 16) return ticks([low, high], most + 1);
    return { list, digits: clamp(-Math.floor(Math.log10(step) + 1e-9), 0, 6) };
  }
  const measured = (v, unit) => (unit === 'deg' ? v.toFixed(3) : number(v)) + (unit ? ' ' + unit : '');
  const number = v => Math.abs(v) >= 1000 ? v.toFixed(0) : String(+v.toPrecision(5));

  // First place whose coordinate is not below x; coordinates ascend.
  function place(xs, x) {
    let low = 0, high = xs.length;
    while (low < high) { const mid = (low + high) >> 1; if (xs[mid] < x) low = mid + 1; else high = mid; }
    return low;
  }

  class Plot {
    constructor(box, spec) {
      Object.assign(this, { box, spec, tile: spec.size === 'tile', range: spec.x_range || extent(spec.xs.flat()) });
      this.full = this.range;
      this.canvas = box.appendChild(document.createElement('canvas'));
      this.hair = box.appendChild(Object.assign(document.createElement('div'), { className: 'hair', hidden: true }));
      this.pin = box.appendChild(Object.assign(document.createElement('div'), { className: 'hair pin', hidden: true }));
      this.sel = box.appendChild(Object.assign(document.createElement('div'), { className: 'sel', hidden: true }));
      this.read = box.parentElement.querySelector('.read');
      this.dots = spec.panels.some(p => p.series.some(s => s.role === 'point'));
      this.canvas.style.height = spec.height + 'px';
      this.canvas.setAttribute('role', 'img');
      this.canvas.setAttribute('aria-label', spec.title);
      if (!this.tile) this.listen();
    }
    left() { return this.tile ? 34 : 62; }
    // Asking for a width lays the page out, so each drawing asks once.
    width() { return this.wide ??= Math.max(this.box.clientWidth - this.left() - 10, 10); }
    pixel(x) { return this.left() + (x - this.range[0]) / (this.range[1] - this.range[0]) * this.width(); }
    value(px) { return this.range[0] + (px - this.left()) / this.width() * (this.range[1] - this.range[0]); }
    show(range) {
      this.range = range;
      this.canvas.dataset.range = range.join(' ');
      this.box.classList.toggle('zoomed', range !== this.full);
      this.draw();
      this.put(this.mark);
    }
    // Shows something else, with the lines hidden that were.
    become(spec) {
      const hidden = new Set(this.spec.panels.flatMap(p => p.series).filter(s => s.hidden).map(s => s.name));
      for (const s of spec.panels.flatMap(p => p.series)) s.hidden = hidden.has(s.name);
      const note = this.box.parentElement.querySelector('.note');
      if (note) note.textContent = spec.note;
      this.spec = spec;
      this.full = spec.x_range || extent(spec.xs.flat());
      this.put(undefined);
      this.show(this.full);
    }
    // What is far from the screen, or folded, waits until it comes near.
    draw() {
      this.wide = undefined;
      this.stale = !this.near;
      if (this.near) this.paint();
    }
    paint() {
      const { canvas, spec, box } = this, scale = window.devicePixelRatio || 1, width = box.clientWidth;
      this.wide = undefined;
      this.stale = !width;
      if (!width) return;
      canvas.width = Math.round(width * scale);
      canvas.height = Math.round(spec.height * scale);
      const c = canvas.getContext('2d');
      c.scale(scale, scale);
      c.font = (this.tile ? 10 : 11) + 'px system-ui, sans-serif';
      const foot = this.tile ? 16 : 32, gap = 10;
      const room = spec.height - foot - 4 - gap * (spec.panels.length - 1);
      const shares = spec.panels.reduce((sum, p) => sum + p.share, 0);
      let top = 4;
      spec.panels.forEach((panel, k) => {
        const height = room * panel.share / shares;
        this.panel(c, panel, top, height, k === spec.panels.length - 1);
        top += height + gap;
      });
    }
    panel(c, panel, top, height, last) {
      const { spec } = this, left = this.left(), width = this.width(), bottom = top + height;
      const inside = xs => [Math.max(place(xs, this.range[0]) - 1, 0), place(xs, this.range[1]) + 1];
      const shown = panel.series.filter(s => !s.hidden);
      const [low, high] = panel.common || panel.range || padded(extent(shown.flatMap(s => {
        const xs = spec.xs[s.x];
        return this.dots ? s.y : s.y.slice(...inside(xs));
      })));
      const y = this.y = v => bottom - (v - low) / (high - low) * height;
      c.save();
      c.beginPath(); c.rect(left, top, width, height); c.clip();
      for (const band of spec.bands) {
        c.fillStyle = colour(band.shade);
        c.fillRect(this.pixel(band.from), top, Math.max(this.pixel(band.to) - this.pixel(band.from), 1), height);
      }
      c.restore();
      const across = ticks(this.range, clamp(width / (this.tile ? 45 : 80), 2, 12)), up = ticks([low, high], clamp(height / 26, 2, 8));
      c.lineWidth = 1; c.strokeStyle = colour('grid'); c.fillStyle = colour('soft');
      c.beginPath();
      for (const t of across.list) { c.moveTo(this.pixel(t), top); c.lineTo(this.pixel(t), bottom); }
      for (const v of up.list) { c.moveTo(left, y(v)); c.lineTo(left + width, y(v)); }
      c.stroke();
      c.textAlign = 'right'; c.textBaseline = 'middle';
      for (const v of up.list) c.fillText(v.toFixed(up.digits), left - 5, y(v));
      if (last) {
        c.textAlign = 'center'; c.textBaseline = 'top';
        for (const t of across.list) c.fillText(t.toFixed(across.digits), clamp(this.pixel(t), left, left + width - 8), bottom + 4);
        if (!this.tile) c.fillText(spec.x_label, left + width / 2, bottom + 18);
      }
      if (low < 0 && high > 0) {
        c.strokeStyle = colour('soft'); c.beginPath(); c.moveTo(left, y(0)); c.lineTo(left + width, y(0)); c.stroke();
      }
      c.save();
      c.beginPath(); c.rect(left, top - 2, width, height + 4); c.clip();
      const edges = panel.series.filter(s => s.role === 'band');
      if (edges.length === 2) this.area(c, edges, y, inside(spec.xs[edges[0].x]));
      for (const s of shown) if (s.role !== 'band') this.series(c, s, y, inside(spec.xs[s.x]));
      c.restore();
      if (this.tile) return;
      c.save();
      c.translate(9, top + height / 2); c.rotate(-Math.PI / 2);
      c.fillStyle = colour('soft'); c.textAlign = 'center'; c.textBaseline = 'middle';
      c.fillText(panel.label, 0, 0);
      c.restore();
    }
    // What lies between two edges.
    area(c, [low, high], y, [from, to]) {
      const xs = this.spec.xs[low.x], end = Math.min(to, xs.length);
      c.fillStyle = colour('band');
      c.beginPath();
      for (let i = from; i < end; i++) c.lineTo(this.pixel(xs[i]), y(low.y[i]));
      for (let i = end - 1; i >= from; i--) c.lineTo(this.pixel(xs[i]), y(high.y[i]));
      c.fill();
    }
    series(c, s, y, [from, to]) {
      const xs = this.spec.xs[s.x];
      c.strokeStyle = c.fillStyle = colour(s.role);
      if (s.role === 'point' || s.role === 'named') {
        s.y.forEach((v, i) => {
          if (v === null) return;
          c.beginPath(); c.arc(this.pixel(xs[i]), y(v), s.role === 'named' ? 4.5 : 2.5, 0, 7); c.fill();
          if (this.ring && s === this.spec.panels[0].series[this.ring[0]] && i === this.ring[1]) {
            c.lineWidth = 2; c.beginPath(); c.arc(this.pixel(xs[i]), y(v), 8, 0, 7); c.stroke();
          }
          if (s.role === 'named') { c.textAlign = 'left'; c.textBaseline = i % 2 ? 'top' : 'bottom'; c.fillText(s.names[i], this.pixel(xs[i]) + 7, y(v)); }
        });
        return;
      }
      c.lineWidth = LINE[s.role]; c.lineJoin = 'round'; c.lineCap = 'round';
      c.setLineDash(s.role === 'guide' || s.role === 'command' ? [5, 4] : []);
      c.beginPath();
      let pen = false;
      for (let i = from; i < Math.min(to, s.y.length); i++) {
        if (s.y[i] === null) { pen = false; continue; }
        c[pen ? 'lineTo' : 'moveTo'](this.pixel(xs[i]), y(s.y[i]));
        pen = true;
      }
      c.stroke(); c.setLineDash([]);
    }
    // The values nearest to a coordinate, in words; null hides them. Points are nearest on the screen.
    point(x, py) {
      this.at = x;
      this.hair.hidden = x === null || x < this.range[0] || x > this.range[1];
      if (this.hair.hidden) { this.read.textContent = ''; return; }
      this.hair.style.left = this.pixel(x) + 'px';
      const words = [], marked = this.mark !== undefined;
      const time = /^(.*?)(?: \(([^)]*)\))?$/.exec(this.spec.x_label);
      for (const panel of this.spec.panels) for (const s of panel.series) {
        if (s.hidden || ['named', 'guide', 'band'].includes(s.role)) continue;
        const xs = this.spec.xs[s.x], i = this.index(s, x, py);
        if (i < 0) continue;
        const from = marked && !this.dots ? this.index(s, this.mark, py) : -1;
        const both = (values, unit) => measured(values[i], unit) + (from < 0 ? '' : ` (\u0394 ${measured(values[i] - values[from], unit)})`);
        if (!words.length) words.push(time[1] + ' ' + both(xs, time[2]));
        words.push((s.names ? s.names[i] : s.name) + ' ' + both(s.y, (/\(([^)]*)\)$/.exec(panel.label) || [])[1]));
      }
      this.read.textContent = words.join('  ·  ');
    }
    // The sample nearest to a coordinate; -1 where there is none.
    index(s, x, py) {
      const xs = this.spec.xs[s.x];
      let i = this.dots ? this.nearest(s, x, py) : place(xs, x);
      if (!this.dots && i > 0 && (i >= xs.length || x - xs[i - 1] < xs[i] - x)) i--;
      return i >= 0 && i < xs.length && s.y[i] !== null ? i : -1;
    }
    // The second cursor, from which the read-out counts; undefined takes it away.
    put(mark) {
      this.mark = mark;
      this.pin.hidden = mark === undefined || mark < this.range[0] || mark > this.range[1];
      if (!this.pin.hidden) this.pin.style.left = this.pixel(mark) + 'px';
    }
    nearest(s, x, py) {
      let best = -1, least = Infinity;
      if (this.y) this.spec.xs[s.x].forEach((v, i) => {
        const d = Math.hypot(this.pixel(v) - this.pixel(x), this.y(s.y[i]) - py);
        if (d < least) { least = d; best = i; }
      });
      return best;
    }
    listen() {
      const { canvas, sel } = this, at = e => clamp(e.clientX - canvas.getBoundingClientRect().left, this.left(), this.left() + this.width());
      let start = null;
      const drop = () => { start = null; sel.hidden = true; };
      canvas.addEventListener('pointerdown', e => { start = at(e); canvas.setPointerCapture(e.pointerId); });
      canvas.addEventListener('pointermove', e => {
        for (const plot of group(this)) plot.point(this.value(at(e)), e.offsetY);
        if (start === null) return;
        sel.hidden = false;
        sel.style.left = Math.min(start, at(e)) + 'px';
        sel.style.width = Math.abs(at(e) - start) + 'px';
      });
      canvas.addEventListener('pointerup', e => {
        if (start !== null && Math.abs(at(e) - start) > 6) {
          const ends = [this.value(Math.min(start, at(e))), this.value(Math.max(start, at(e)))];
          for (const plot of group(this)) plot.show(ends);
        } else if (start !== null) {
          const mark = this.mark === undefined ? this.value(at(e)) : undefined;
          for (const plot of group(this)) { plot.put(mark); plot.point(this.value(at(e)), e.offsetY); }
        }
        drop();
      });
      canvas.addEventListener('pointercancel', drop);
      canvas.addEventListener('pointerleave', () => { for (const plot of group(this)) plot.point(null); });
      canvas.addEventListener('dblclick', () => { for (const plot of group(this)) plot.show(plot.full); });
      const reset = Object.assign(document.createElement('button'), { type: 'button', className: 'reset', textContent: 'Whole range' });
      reset.addEventListener('click', () => { for (const plot of group(this)) plot.show(plot.full); });
      this.box.appendChild(reset);
    }
  }
  function extent(values) {
    let low = Infinity, high = -Infinity;
    for (const v of values) if (v !== null) { if (v < low) low = v; if (v > high) high = v; }
    return low < high ? [low, high] : low === high ? [low - 0.5, high + 0.5] : [0, 1];
  }
  function padded([low, high]) { const room = 0.06 * (high - low); return [low - room, high + room]; }

  const plots = Array.from(document.querySelectorAll('.live'), box => new Plot(box, specs[+box.dataset.chart]));
  const group = plot => plot.spec.group === null ? [plot] : plots.filter(p => p.spec.group === plot.spec.group);
  const all = () => { for (const plot of plots) plot.draw(); };
  for (const plot of plots) plot.show(plot.full);
  const nearby = new IntersectionObserver(entries => {
    for (const { target, isIntersecting } of entries) for (const plot of plots) if (plot.box === target) {
      plot.near = isIntersecting;
      if (plot.near && plot.stale) plot.paint();
    }
  }, { rootMargin: '100% 0px' });
  for (const plot of plots) nearby.observe(plot.box);
  window.addEventListener('beforeprint', () => { for (const plot of plots) if (plot.stale) plot.paint(); });
  let width = root.clientWidth;
  window.addEventListener('resize', () => { if (root.clientWidth !== width) { width = root.clientWidth; all(); } });
  window.matchMedia('(prefers-color-scheme: dark)').addEventListener('change', all);

  // Whatever names a stretch of the run shows it.
  function go(e) {
    const target = e.target.closest('[data-from]');
    if (!target || (e.type === 'keydown' && e.key !== 'Enter')) return;
    const ends = [+target.dataset.from, +target.dataset.to];
    for (const plot of plots) if (plot.spec.group === 'run') plot.show([Math.max(ends[0], plot.full[0]), Math.min(ends[1], plot.full[1])]);
    const joint = Array.from(document.querySelectorAll('.joint')).find(el => el.dataset.name === target.dataset.joint);
    if (joint) joint.scrollIntoView({ behavior: 'smooth', block: 'center' });
  }
  // Commands are copied by a button; without the right to write to the clipboard they are selected.
  for (const block of document.querySelectorAll('pre:not(.form)')) {
    const button = Object.assign(document.createElement('button'), { type: 'button', className: 'copy', textContent: 'Copy' });
    const code = block.querySelector('code');
    button.addEventListener('click', async () => {
      try { await navigator.clipboard.writeText(code.textContent); button.textContent = 'Copied'; }
      catch { getSelection().selectAllChildren(code); button.textContent = 'Selected'; }
    });
    block.appendChild(button);
  }
  document.addEventListener('click', go);
  document.addEventListener('keydown', go);
  return { plots, group, number, extent, padded };
})();
