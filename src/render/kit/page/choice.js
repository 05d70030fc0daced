// Choosing: a point of a plot, or the slider, shows its motion, its numbers and the line that makes it.
(() => {
  const block = document.getElementById('choices');
  if (!block) return;
  const options = JSON.parse(block.textContent), box = document.querySelector('.choice'), slider = box.querySelector('input');
  const [name, list, pre] = [box.querySelector('strong'), box.querySelector('ul'), box.querySelector('pre')];
  const points = plotted.plots.filter(plot => plot.dots), motions = plotted.plots.filter(plot => plot.spec.group === 'run');
  function choose(k) {
    const option = options[k];
    slider.value = k;
    slider.setAttribute('aria-valuetext', option.name);
    name.textContent = option.name;
    list.replaceChildren(...option.lines.map(line => Object.assign(document.createElement('li'), { textContent: line })));
    pre.querySelector('code').textContent = option.command;
    pre.hidden = !option.command;
    motions.forEach((plot, i) => { if (option.charts[i]) plot.become(option.charts[i]); });
    for (const scene of document.querySelectorAll('.scene')) scene.dispatchEvent(new CustomEvent('path', { detail: option }));
    for (const plot of points) { plot.ring = option.point; plot.draw(); }
  }
  slider.addEventListener('input', () => choose(+slider.value));
  for (const plot of points) {
    const all = plot.spec.panels[0].series, place = ([s, i]) => [plot.pixel(plot.spec.xs[all[s].x][i]), plot.y(all[s].y[i])];
    plot.canvas.addEventListener('click', e => {
      const away = option => { const [x, y] = place(option.point); return Math.hypot(x - e.offsetX, y - e.offsetY); };
      const near = options.map(away), k = near.indexOf(Math.min(...near));
      if (near[k] < 40) choose(k);
    });
  }
  choose(0);
})();
