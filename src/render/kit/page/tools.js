// What makes a page a tool: wheel and keys on plots, legends that hide, one scale for all, tables that sort, the view in the address.
(() => {
  const { plots, group, extent, padded } = plotted;
  const clamp = (v, a, b) => Math.min(Math.max(v, a), b);
  const large = plots.filter(plot => !plot.tile);

  // Shows a range in all plots of a group, within their whole one and no narrower than a ten-thousandth of it.
  function show(plot, [a, b]) {
    const [low, high] = plot.full, least = (high - low) / 1e4;
    if (b - a >= high - low) { for (const other of group(plot)) other.show(other.full); return; }
    const width = Math.max(b - a, least), from = clamp(a, low, high - width);
    for (const other of group(plot)) other.show([from, from + width]);
  }
  const scaled = ([a, b], at, by) => [at - (at - a) * by, at + (b - at) * by];
  const moved = ([a, b], share) => [a + share * (b - a), b + share * (b - a)];

  for (const plot of large) {
    const { canvas, box } = plot;
    // A bare wheel scrolls the page.
    canvas.addEventListener('wheel', e => {
      if (!e.ctrlKey && !e.metaKey && !e.shiftKey) return;
      e.preventDefault();
      const step = e.deltaY || e.deltaX;
      if (e.shiftKey) show(plot, moved(plot.range, Math.sign(step) * 0.15));
      else show(plot, scaled(plot.range, plot.value(clamp(e.offsetX, plot.left(), plot.left() + plot.width())), step > 0 ? 1.25 : 0.8));
    }, { passive: false });
    box.tabIndex = 0;
    box.setAttribute('role', 'application');
    box.setAttribute('aria-label', plot.spec.title + ': arrow keys move the cursor, with shift the range, plus and minus zoom, M marks, Home shows all');
    box.addEventListener('keydown', e => {
      const [a, b] = plot.range, at = plot.at ?? (a + b) / 2, side = { ArrowLeft: -1, ArrowRight: 1 }[e.key];
      if (side && e.shiftKey) show(plot, moved(plot.range, 0.15 * side));
      else if (side) for (const other of group(plot)) other.point(clamp(at + side * (b - a) / 200, a, b), 0);
      else if (e.key === '+' || e.key === '=') show(plot, scaled(plot.range, at, 0.8));
      else if (e.key === '-') show(plot, scaled(plot.range, at, 1.25));
      else if (e.key === 'Home') show(plot, plot.full);
      else if (e.key === 'm') for (const other of group(plot)) { other.put(plot.mark === undefined || other !== plot ? at : undefined); }
      else if (e.key === 'Escape') for (const other of group(plot)) { other.put(undefined); other.point(null); }
      else return;
      e.preventDefault();
    });
    for (const entry of box.parentElement.querySelectorAll('.legend > span')) {
      const own = () => plot.spec.panels.flatMap(panel => panel.series).filter(s => s.name === entry.textContent);
      if (!own().length) continue;
      Object.assign(entry, { tabIndex: 0 });
      entry.setAttribute('role', 'button');
      entry.setAttribute('aria-pressed', 'true');
      const toggle = () => {
        const hidden = entry.getAttribute('aria-pressed') === 'true';
        for (const s of own()) s.hidden = hidden;
        entry.setAttribute('aria-pressed', String(!hidden));
        plot.draw();
      };
      entry.addEventListener('click', toggle);
      entry.addEventListener('keydown', e => { if (e.key === 'Enter' || e.key === ' ') { e.preventDefault(); toggle(); } });
    }
  }

  // One vertical scale for panels of the same name.
  for (const box of document.querySelectorAll('.same-scale input')) {
    const run = large.filter(plot => plot.spec.group === 'run' && plot.box.closest('.joint'));
    box.addEventListener('change', () => {
      const ranges = new Map();
      for (const plot of run) for (const panel of plot.spec.panels) {
        const both = [...(ranges.get(panel.label) || []), ...extent(panel.series.flatMap(s => s.y))];
        ranges.set(panel.label, extent(both));
      }
      for (const plot of run) {
        for (const panel of plot.spec.panels) panel.common = box.checked ? padded(ranges.get(panel.label)) : undefined;
        plot.draw();
      }
    });
  }

  // Tables sort by the column that is clicked: numbers by size, the largest first, words by the alphabet.
  const value = row => cell => {
    const text = row.cells[cell].dataset.sort ?? row.cells[cell].textContent.trim(), size = parseFloat(text);
    return Number.isNaN(size) ? text : size;
  };
  for (const head of document.querySelectorAll('.scroll thead th')) {
    const table = head.closest('table'), body = table.tBodies[0], column = head.cellIndex;
    if (!body || body.rows.length < 2) continue;
    head.tabIndex = 0;
    const sort = () => {
      const words = head.className === 'word', before = head.getAttribute('aria-sort');
      const down = before ? before === 'ascending' : !words;
      for (const other of table.tHead.rows[0].cells) other.removeAttribute('aria-sort');
      head.setAttribute('aria-sort', down ? 'descending' : 'ascending');
      const sign = down ? -1 : 1;
      const order = (a, b) => {
        const [x, y] = [value(a)(column), value(b)(column)];
        // Cells without a number come last.
        if (typeof x !== typeof y) return typeof x === 'number' ? -1 : 1;
        return sign * (typeof x === 'number' ? x - y : x.localeCompare(y, 'en', { numeric: true }));
      };
      body.append(...Array.from(body.rows).sort(order));
    };
    head.addEventListener('click', sort);
    head.addEventListener('keydown', e => { if (e.key === 'Enter') sort(); });
  }

  // The address keeps what is shown of the run, so that a link shows it again.
  const run = large.filter(plot => plot.spec.group === 'run');
  if (run.length) {
    const given = /[#&]t=(-?[\d.]+),(-?[\d.]+)/.exec(location.hash);
    if (given && +given[1] < +given[2]) show(run[0], [+given[1], +given[2]]);
    let kept = location.hash;
    const keep = () => {
      const [a, b] = run[0].range, hash = run[0].range === run[0].full ? '' : `#t=${a.toFixed(3)},${b.toFixed(3)}`;
      if (hash === kept || (!hash && !/[#&]t=/.test(location.hash))) return;
      kept = hash;
      try { history.replaceState(null, '', hash || location.pathname); } catch { /* a file that may not change its address */ }
    };
    for (const type of ['pointerup', 'keyup', 'dblclick', 'wheel', 'click']) document.addEventListener(type, () => setTimeout(keep));
  }
})();
