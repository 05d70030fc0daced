// Opens pages that hydrotrace wrote in a headless Chromium: no console errors, nothing fetched, pointing and
// zooming work, no plot is blank, nothing is wider than the screen.
//
//   node pages.cjs FOLDER PAGE.html...     screenshots go to FOLDER; CHROMIUM names the browser
'use strict';
const { mkdtempSync, mkdirSync, readFileSync, rmSync } = require('node:fs');
const { tmpdir } = require('node:os');
const { basename, join, resolve } = require('node:path');
const { pathToFileURL } = require('node:url');
const { chromium } = require('playwright-core');
const AXE = readFileSync(require.resolve('axe-core/axe.min.js'), 'utf8');

const FLAGS = [
  '--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking',
  '--disable-component-update', '--disable-sync',
];
const [folder, ...pages] = process.argv.slice(2);
if (!folder || !pages.length) { console.error('usage: node pages.cjs FOLDER PAGE.html...'); process.exit(2); }
mkdirSync(folder, { recursive: true });

const faults = [];
function check(holds, page, what) { if (!holds) faults.push(`${page}: ${what}`); }

// How many different colours a plot has: a blank one has one.
const colours = canvas => {
  const data = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height).data;
  const seen = new Set();
  for (let i = 0; i < data.length; i += 4) if (data[i + 3]) seen.add((data[i] << 16) | (data[i + 1] << 8) | data[i + 2]);
  return seen.size;
};

async function look(browser, path, width, scheme) {
  const name = basename(path, '.html'), where = `${name} at ${width} px, ${scheme}`;
  const context = await browser.newContext({ viewport: { width, height: 900 }, colorScheme: scheme, hasTouch: width < 500 });
  const page = await context.newPage();
  const fetched = [];
  page.on('console', message => check(!['error', 'warning'].includes(message.type()), where, `console: ${message.text()}`));
  page.on('pageerror', error => check(false, where, `script: ${error.message}`));
  page.on('dialog', dialog => { check(false, where, 'a dialog opened'); dialog.dismiss(); });
  page.on('request', request => fetched.push(request.url()));
  await page.goto(pathToFileURL(resolve(path)).href, { waitUntil: 'load' });
  const ms = await page.evaluate(() => performance.getEntriesByType('navigation')[0].loadEventEnd);
  check(fetched.length === 1, where, `it fetched ${fetched.slice(1).join(', ')}`);
  const overflow = await page.evaluate(() => document.documentElement.scrollWidth - document.documentElement.clientWidth);
  check(overflow <= 0, where, `it is ${overflow} px wider than the screen`);
  await near(page, where);
  await page.evaluate(() => dispatchEvent(new Event('beforeprint')));
  let blank = 0;
  for (const canvas of await page.$$('canvas')) if (await canvas.evaluate(colours) < 3) blank++;
  check(blank === 0, where, `${blank} plots are blank`);
  check(await page.locator('h2').count() > 1, where, 'it has no sections');
  await page.screenshot({ path: join(folder, `${name}-${width}-${scheme}.png`), fullPage: true });
  await accessible(page, where);
  // What a page does is the same in the dark.
  if (scheme === 'light') {
    await use(page, where);
    await tools(page, where);
    await first(page, where, width);
    await turn(page, where);
    await choose(page, where);
    await copy(page, where, context);
  }
  await context.close();
  return ms;
}

// What is far below is not drawn until the reader comes near: its canvas has the size of an untouched one.
const drawn = canvas => canvas.width !== 300 || canvas.height !== 150;
async function near(page, where) {
  const last = page.locator('.live:not(details:not([open]) .live) canvas').last();
  if (await last.count() === 0) return;
  const far = await last.evaluate(canvas => canvas.getBoundingClientRect().top > 2.5 * innerHeight);
  check(!far || !await last.evaluate(drawn), where, 'a plot far below is drawn at once');
  await last.scrollIntoViewIfNeeded();
  await page.waitForTimeout(100);
  check(await last.evaluate(drawn), where, 'a plot stays blank when the page is scrolled to it');
  await page.evaluate(() => scrollTo(0, 0));
}

// What axe-core finds wrong for people who see or point otherwise.
async function accessible(page, where) {
  await page.evaluate(AXE);
  const { violations } = await page.evaluate(() => axe.run(document));
  for (const { id, nodes } of violations) check(false, where, `${id}: ${nodes[0].html.slice(0, 120)}`);
}

// Points at the first plot, zooms it, resets it.
async function use(page, where) {
  const run = page.locator('.joint figure.chart'), any = page.locator('figure.chart:not(.tile)');
  const figure = (await run.count() ? run : any).first(), plot = figure.locator('canvas');
  if (await figure.count() === 0) return;
  await plot.scrollIntoViewIfNeeded();
  const box = await plot.boundingBox(), read = figure.locator('.read');
  const at = (x, y) => [box.x + box.width * x, box.y + box.height * y];
  await page.mouse.move(...at(0.15, 0.85));
  const first = await read.textContent();
  await page.mouse.move(...at(0.9, 0.1));
  const second = await read.textContent();
  const after = await plot.boundingBox();
  check(after.y === box.y && after.height === box.height, where, `the read-out moves the plot by ${after.y - box.y} px`);
  check(first !== '' && second !== '' && first !== second, where, `the read-out stays ${JSON.stringify(first)}`);
  const range = () => plot.evaluate(canvas => canvas.dataset.range);
  const whole = await range();
  await page.mouse.move(...at(0.4, 0.5));
  await page.mouse.down();
  await page.mouse.move(...at(0.5, 0.5), { steps: 4 });
  await page.mouse.up();
  const zoomed = await range();
  check(zoomed !== whole, where, 'dragging does not zoom');
  const span = text => { const [a, b] = text.split(' ').map(Number); return b - a; };
  check(span(zoomed) < 0.2 * span(whole), where, `dragging a tenth shows ${span(zoomed)} of ${span(whole)}`);
  await page.mouse.dblclick(...at(0.5, 0.5));
  check(await range() === whole, where, 'a double click does not reset');
  const tile = page.locator('.goto').first();
  if (await tile.count() > 0) {
    await tile.click();
    check(await range() !== whole, where, 'a click on a transition does not show it');
  }
}

// Wheel, keys, second cursor, legend, tables, address.
async function tools(page, where) {
  const run = page.locator('.joint figure.chart'), any = page.locator('figure.chart:not(.tile)');
  const figure = (await run.count() ? run : any).first();
  if (await figure.count() === 0) return;
  const canvas = figure.locator('canvas'), box = figure.locator('.live');
  await canvas.scrollIntoViewIfNeeded();
  await page.mouse.move(0, 0);
  const range = () => canvas.evaluate(c => c.dataset.range);
  const span = text => { const [a, b] = text.split(' ').map(Number); return b - a; };
  await box.focus();
  await page.keyboard.press('Home');
  const whole = await range();
  await page.keyboard.press('+');
  const zoomed = await range();
  check(span(zoomed) < 0.9 * span(whole), where, 'plus does not zoom');
  await page.keyboard.press('Shift+ArrowRight');
  check(await range() !== zoomed, where, 'shift and an arrow do not move the range');
  await page.keyboard.press('Home');
  check(await range() === whole, where, 'Home does not show the whole range');
  const place = await canvas.boundingBox(), read = figure.locator('.read');
  if (!where.includes('360')) {
    await page.mouse.move(place.x + 0.5 * place.width, place.y + 40);
    const scrolled = await page.evaluate(() => scrollY);
    await page.keyboard.down('Control');
    await page.mouse.wheel(0, -100);
    await page.keyboard.up('Control');
    await page.waitForTimeout(50);
    check(span(await range()) < 0.9 * span(whole) && await page.evaluate(() => scrollY) === scrolled, where, 'ctrl and wheel do not zoom');
    await page.mouse.dblclick(place.x + 0.5 * place.width, place.y + 40);
    await page.keyboard.press('Escape');
    await page.mouse.click(place.x + 0.3 * place.width, place.y + 40);
    await page.mouse.move(place.x + 0.6 * place.width, place.y + 40);
    const text = await read.textContent();
    const dots = await figure.locator('.legend .point').count();
    check(dots > 0 || text.includes('\u0394'), where, `no difference from the second cursor: ${JSON.stringify(text)}`);
    await page.keyboard.press('Escape');
  }
  const entry = figure.locator('.legend [role=button]').first();
  if (await entry.count() > 0) {
    const shown = () => canvas.evaluate(c => c.toDataURL());
    const before = await shown();
    await entry.focus();
    await page.keyboard.press('Enter');
    check(await entry.getAttribute('aria-pressed') === 'false' && await shown() !== before, where, 'a legend does not hide its line');
    await page.keyboard.press('Enter');
    check(await shown() === before, where, 'a legend does not bring its line back');
  }
  const head = page.locator('.scroll thead th.number[tabindex]:visible').first();
  if (await head.count() > 0) {
    const cells = () => head.evaluate(h => Array.from(h.closest('table').tBodies[0].rows, row => parseFloat(row.cells[h.cellIndex].textContent)).filter(v => !Number.isNaN(v)));
    await head.focus();
    await page.keyboard.press('Enter');
    const down = await cells();
    check(down.every((v, i) => i === 0 || down[i - 1] >= v), where, `a heading does not sort: ${down}`);
    await page.keyboard.press('Enter');
    const up = await cells();
    check(up.every((v, i) => i === 0 || up[i - 1] <= v), where, `a heading does not sort the other way: ${up}`);
  }
}

// A report answers on its first screen: the cards, the lines to type, below them lanes by joint; a lane and a row show their place, which the address keeps.
async function first(page, where, width) {
  const lanes = page.locator('.lanes rect[data-from]');
  if (await lanes.count() === 0) return;
  if (width > 1000) {
    await page.evaluate(() => scrollTo(0, 0));
    const next = await page.locator('.next').boundingBox(), top = await page.locator('.lanes').first().boundingBox();
    check(next.y + next.height < 900, where, `what to do next ends at ${next.y + next.height} px`);
    check(top.y > next.y && top.y < next.y + next.height + 200, where, `the lanes begin at ${top.y} px`);
  }
  const plot = page.locator('.joint canvas').first();
  const range = () => plot.evaluate(c => c.dataset.range);
  const whole = await range();
  await lanes.first().scrollIntoViewIfNeeded();
  await lanes.first().click({ force: true });
  const shown = await range();
  check(shown !== whole, where, 'a lane does not show its stretch');
  await page.waitForTimeout(50);
  const hash = await page.evaluate(() => location.hash);
  check(hash.startsWith('#t='), where, `the address is ${hash}`);
  await page.reload();
  check(await range() === hash.slice(3).split(',').map(Number).join(' '), where, `the address shows ${await range()}, not ${hash}`);
  const row = page.locator('tr[data-from]').first();
  if (await row.count() > 0) {
    await row.focus();
    await page.keyboard.press('Enter');
    check(await range() !== shown, where, 'a row does not show its start');
  }
}

// Turns the path of the tool by pointer and keys, and back.
async function turn(page, where) {
  const box = page.locator('.scene'), canvas = box.locator('canvas');
  if (await box.count() === 0) return;
  await box.scrollIntoViewIfNeeded();
  const view = async () => { await page.waitForTimeout(100); return canvas.evaluate(c => c.dataset.view); };
  const first = await view(), at = await canvas.boundingBox();
  await page.mouse.move(at.x + 50, at.y + 50);
  await page.mouse.down();
  await page.mouse.move(at.x + 120, at.y + 80, { steps: 4 });
  await page.mouse.up();
  const dragged = await view();
  check(dragged !== first, where, 'dragging does not turn the path');
  await box.focus();
  await page.keyboard.press('ArrowLeft');
  check(await view() !== dragged, where, 'an arrow key does not turn the path');
  await page.keyboard.press('Home');
  check(await view() === first, where, 'Home does not show the first view');
  check((await box.getAttribute('aria-label')).includes('arrow keys'), where, 'the path has no label');
}

// Chooses plans of a front by slider and by point: line, numbers, motion and path follow.
async function choose(page, where) {
  const slider = page.locator('.choice input'), line = page.locator('.choice code');
  if (await slider.count() === 0) return;
  const shown = () => page.evaluate(() => [document.querySelector('.choice code').textContent, document.querySelector('.choice ul').textContent,
    plotted.plots.filter(p => p.spec.group === 'run').map(p => p.range.join(' ')).join(), document.querySelector('.scene canvas').toDataURL()]);
  const settled = async () => { await page.waitForTimeout(100); return shown(); };
  const chosen = await settled();
  await slider.focus();
  await page.keyboard.press('ArrowRight');
  const fastest = await settled();
  check(fastest.every((part, k) => part !== chosen[k]), where, 'the slider does not show another plan');
  check(/--times 0,[\d.,]+ -o/.test(fastest[0]), where, `the line is ${fastest[0]}`);
  const at = await page.evaluate(() => {
    const plot = plotted.plots.find(p => p.dots), s = plot.spec.panels[0].series[0], last = s.y.length - 1;
    plot.canvas.scrollIntoView({ block: 'center' });
    const box = plot.canvas.getBoundingClientRect();
    return [box.x + plot.pixel(plot.spec.xs[s.x][last]), box.y + plot.y(s.y[last])];
  });
  await page.mouse.click(...at);
  const slowest = await settled();
  check(slowest[0] !== fastest[0] && slowest[2] !== fastest[2], where, 'a click on a point does not show its plan');
  await slider.focus();
  await page.keyboard.press('Home');
  check((await settled())[0] === chosen[0] && await line.isVisible(), where, 'Home does not show the chosen plan');
}

// Reads the checks by their words and copies the first command.
async function copy(page, where, context) {
  const marks = await page.locator('.checks .mark').allTextContents();
  if (marks.length) {
    check(marks.length >= 6 && marks.every(word => ['ok', 'CARE', 'STOP'].includes(word)), where, `the checks read ${marks}`);
    const answer = await page.locator('.card .headline').first().boundingBox();
    check(answer.y + answer.height < 900, where, 'the verdict is not on the first screen');
  }
  const block = page.locator('pre').first();
  if (await block.count() === 0) return;
  await context.grantPermissions(['clipboard-read', 'clipboard-write']);
  await block.locator('.copy').click();
  await page.waitForTimeout(100);
  const copied = await page.evaluate(() => navigator.clipboard.readText());
  check(copied !== '' && copied === await block.locator('code').textContent(), where, `the button copied ${JSON.stringify(copied)}`);
}

async function main() {
  const profile = mkdtempSync(join(tmpdir(), 'pages-'));
  const executablePath = process.env.CHROMIUM || '/usr/bin/chromium';
  const context = await chromium.launchPersistentContext(profile, { executablePath, headless: true, args: FLAGS });
  try {
    for (const path of pages) {
      for (const [width, scheme] of [[1280, 'light'], [1280, 'dark'], [360, 'light']]) {
        const ms = await look(context.browser(), path, width, scheme);
        console.log(`${basename(path)} ${width} px ${scheme}: loaded in ${ms.toFixed(0)} ms`);
      }
    }
  } finally {
    await context.close();
    rmSync(profile, { recursive: true, force: true });
  }
  for (const fault of new Set(faults)) console.error(fault);
  console.log(faults.length ? `${faults.length} faults` : `${pages.length} pages hold`);
  return faults.length ? 1 : 0;
}
main().then(code => process.exit(code), error => { console.error(error); process.exit(1); });
