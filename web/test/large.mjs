// How long a large surface takes on the page, and what moves of the slider leave in memory, told at each hundred.
//
//     node test/large.mjs PROGRAM MESH [MOVES]
//
// Times are the browser's own, from the moment it asks for the page. What is held to: the first picture and the exact map within
// 3 s, each move of the slider shown within 50 ms, no growth over the moves. A browser that draws without a graphics card is slower.
import { spawn } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { chromium } from "playwright-core";

const [program, mesh, moves = "500"] = process.argv.slice(2);
const executablePath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const flags = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const drawing = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--enable-precise-memory-info", "--js-flags=--expose-gc"];

/** Notes when what has been drawn, from before the page's own script runs. */
function watch() {
  window.seen = {};
  const canvases = new Set();
  const frame = requestAnimationFrame;
  // What was sent to be drawn is drawn when a pixel can be read.
  const note = (name) => frame(() => frame(() => {
    for (const gl of canvases) gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
    window.seen[name] ??= Math.round(performance.now());
  }));
  for (const name of ["drawArrays", "drawElements"]) {
    const draw = WebGL2RenderingContext.prototype[name];
    WebGL2RenderingContext.prototype[name] = function (...of) {
      draw.apply(this, of);
      // The surface or the map, not a frame or a mark.
      const isLarge = (name === "drawArrays" ? of[2] : of[1]) > 10_000;
      if (isLarge && !canvases.has(this) && canvases.add(this).size === 1) note("picture");
    };
  }
  document.addEventListener("DOMContentLoaded", () => {
    new MutationObserver(() => document.body.dataset.maps === "1" && note("map")).observe(document.body, { attributes: true });
  });
}

const began = Date.now();
const server = spawn(program, ["view", mesh, "--no-open"]);
server.stderr.on("data", () => {});
const url = await new Promise((found) => server.stdout.once("data", (data) => found(String(data).trim())));
console.log(`server ready after ${Date.now() - began} ms`);
const resident = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${server.pid}/status`, "utf8"))[1]) / 1024;
const browser = await chromium.launch({ executablePath, headless: true, args: [...flags, ...drawing] });
try {
  const page = await (await browser.newContext({ viewport: { width: 1280, height: 800 } })).newPage();
  page.on("pageerror", (error) => console.log(error.message));
  await page.addInitScript(watch);
  await page.goto(url);
  await page.waitForFunction(() => window.seen.map !== undefined, null, { timeout: 80_000, polling: 50 });
  const network = await page.evaluate(() => performance.getEntriesByType("resource").map((one) =>
    `${one.name.split("/").at(-1)}: asked ${Math.round(one.startTime)}, answer ${Math.round(one.responseStart)} to ${Math.round(one.responseEnd)}, ${(one.encodedBodySize / 1e6).toFixed(1)} MB`));
  console.log(JSON.stringify(await page.evaluate(() => window.seen)), "ms after opening\n ", network.join("\n  "));
  await page.waitForFunction(() => document.querySelector("#curve polyline[points*=' ']"), null, { timeout: 80_000 });
  console.log(await page.textContent("#state"), "|", await page.textContent("#numbers"));

  const settled = () => page.waitForFunction(() => document.querySelector("#state").textContent === "exact map", null, { timeout: 80_000, polling: 50 });
  // Two exact maps, as the slider is let go.
  for (const n of [16, 32]) {
    const took = await page.evaluate(async (n) => {
      const began = performance.now();
      const before = document.body.dataset.maps;
      const slider = document.querySelector("#slider");
      slider.value = String(n);
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      while (document.body.dataset.maps === before) await new Promise((next) => setTimeout(next, 5));
      return performance.now() - began;
    }, n);
    await settled();
    console.log(`exact map with ${n} cones after ${Math.round(took)} ms |`, (await page.textContent("#numbers")).match(/Time.*/)[0]);
  }
  const move = (from, count) => page.evaluate(async ([from, count]) => {
    const slider = document.querySelector("#slider");
    const [least, most] = [slider.min, slider.max].map(Number);
    const next = () => new Promise(requestAnimationFrame);
    const times = { script: [], shown: [] };
    for (let k = from; k < from + count; k++) {
      // As a hand moves it, some 12 steps a second.
      await new Promise((done) => setTimeout(done, 50));
      await next();
      const began = performance.now();
      slider.value = String(least + ((7 * k) % (most - least + 1)));
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      times.script.push(performance.now() - began);
      // Drawn in the next frame; what is sent to be drawn then is done when the one after begins.
      await next();
      await next();
      times.shown.push(performance.now() - began);
    }
    return times;
  }, [from, count]);
  const held = async () => {
    await page.evaluate(() => gc());
    return [await page.evaluate(() => performance.memory.usedJSHeapSize / 1048576), resident()];
  };
  const summary = (times) => {
    const sorted = times.toSorted((a, b) => a - b);
    return [0.5, 0.99, 1].map((share) => sorted[Math.ceil(share * sorted.length) - 1].toFixed(1)).join(", ");
  };
  await move(0, 60);
  await settled();
  const told = (count, [page, server]) => console.log(`${count} moves: page ${page.toFixed(1)} MB, server ${server.toFixed(0)} MB`);
  told(0, await held());
  const times = { script: [], shown: [] };
  for (let done = 0; done < Number(moves); done += 100) {
    const some = await move(done, Math.min(100, Number(moves) - done));
    for (const name of Object.keys(times)) times[name].push(...some[name]);
    await settled();
    told(times.shown.length, await held());
  }
  for (const name of ["script", "shown"]) console.log(`${moves} moves, ${name} after ms (half, 99 %, all within): ${summary(times[name])}`);
} finally {
  await browser.close();
  server.kill();
}
