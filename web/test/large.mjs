// How long a large surface takes on the page, and what moves of the slider leave in memory, told at each hundred.
//
//     node test/large.mjs PROGRAM MESH [MOVES]
//
// Held to: the first picture and the exact map within 3 s of opening, each move of the slider shown within 50 ms, no growth over the moves.
// The slider is dragged with the mouse. How long a move takes is told by Chromium itself, from the event to the moment when the frame with what
// it changed is on the screen (EventLatency of its traces), drawing included; a browser that draws without a graphics card is slower.
import { spawn } from "node:child_process";
import { existsSync, readFileSync } from "node:fs";
import { chromium } from "playwright-core";

const [program, mesh, moves = "500"] = process.argv.slice(2);
const executablePath = process.env.CHROMIUM ?? ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const flags = ["--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"];
const drawing = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--enable-precise-memory-info", "--js-flags=--expose-gc"];
const PATIENCE = { timeout: 80_000, polling: 50 };
/** A hand moves the slider some 12 steps a second. */
const STEP = 80;

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

/** How long each event of the mouse took to be seen, in milliseconds: of those that changed a frame. */
function latencies(trace) {
  const begun = new Map();
  const found = [];
  for (const { name, ph, pid, id, id2, ts, args } of JSON.parse(trace).traceEvents) {
    const key = `${pid} ${id ?? id2?.local} ${name}`;
    if (name === "EventLatency" && ph === "b" && args.event_latency?.event_type === "MOUSE_DRAGGED") begun.set(key, ts);
    else if (name === "SubmitCompositorFrameToPresentationCompositorFrame" && ph === "b") begun.set(`${key.replace(name, "EventLatency")} seen`, ts);
    else if (name === "EventLatency" && ph === "e" && begun.has(key)) {
      if (begun.has(`${key} seen`)) found.push((ts - begun.get(key)) / 1000);
      begun.delete(key);
      begun.delete(`${key} seen`);
    }
  }
  return found;
}

function told(times) {
  const sorted = times.toSorted((a, b) => a - b);
  const [half, most, all] = [0.5, 0.99, 1].map((share) => sorted[Math.ceil(share * sorted.length) - 1]?.toFixed(1));
  return `${times.length} seen, half within ${half} ms, 99 % ${most}, all ${all}; ${times.filter((time) => time > 50).length} above 50`;
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
  // A page that is not built into the program yet.
  if (process.env.PAGE) {
    const headers = { Link: "<surface>; rel=preload; as=fetch; crossorigin" };
    await page.route(url, (route) => route.fulfill({ body: readFileSync(process.env.PAGE), contentType: "text/html", headers }));
  }
  await page.goto(url);
  await page.waitForFunction(() => window.seen.map !== undefined, null, PATIENCE);
  const network = await page.evaluate(() => performance.getEntriesByType("resource").map((one) =>
    `${one.name.split("/").at(-1)}: asked ${Math.round(one.startTime)}, answer ${Math.round(one.responseStart)} to ${Math.round(one.responseEnd)}, ${(one.encodedBodySize / 1e6).toFixed(1)} MB`));
  console.log(JSON.stringify(await page.evaluate(() => window.seen)), "ms after opening\n ", network.join("\n  "));
  await page.waitForFunction(() => document.querySelector("#curve polyline[points*=' ']"), null, PATIENCE);

  const settled = () => page.waitForFunction(() => document.querySelector("#state").textContent === "exact map", null, PATIENCE);
  // Two exact maps, as the slider is let go.
  for (const n of Number(moves) ? [16, 32] : []) {
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
  const box = await page.locator("#slider").boundingBox();
  const [least, most] = await page.evaluate(() => ["min", "max"].map((name) => Number(document.querySelector("#slider")[name])));
  const at = (n) => [box.x + 8 + ((box.width - 16) * (n - least)) / (most - least), box.y + box.height / 2];
  const number = (k) => least + ((7 * k) % (most - least + 1));
  const drag = async (from, count) => {
    await page.mouse.move(...at(await page.inputValue("#count")));
    // A hand that has arrived is not yet pressing.
    await page.waitForTimeout(200);
    await page.mouse.down();
    await page.waitForTimeout(200);
    await browser.startTracing(page, { categories: ["benchmark", "cc", "input"] });
    // All processes of the browser begin to trace, which is no part of a move.
    await page.waitForTimeout(300);
    for (let k = from; k < from + count; k++) {
      const began = performance.now();
      await page.mouse.move(...at(number(k)));
      await page.waitForTimeout(Math.max(0, STEP - (performance.now() - began)));
    }
    await page.waitForTimeout(100);
    const times = latencies(await browser.stopTracing());
    await page.mouse.up();
    return times;
  };
  const held = async () => {
    await page.evaluate(() => gc());
    return `page ${(await page.evaluate(() => performance.memory.usedJSHeapSize / 1048576)).toFixed(0)} MB, server ${resident().toFixed(0)} MB`;
  };
  if (Number(moves)) {
    await drag(0, 60);
    await settled();
    console.log(`before the moves: ${await held()}`);
  }
  const times = [];
  for (let done = 0; done < Number(moves); done += 100) {
    const some = await drag(done, Math.min(100, Number(moves) - done));
    times.push(...some);
    await settled();
    const late = some.flatMap((time, k) => (time > 50 ? [`${k}: ${time.toFixed(0)}`] : []));
    console.log(`moves ${done} to ${done + some.length}: ${told(some)}${late.length ? ` (${late.join(", ")})` : ""}; ${await held()}`);
  }
  if (times.length) console.log(`all moves: ${told(times)}`);
} finally {
  await browser.close();
  server.kill();
}
