// The page in a real browser, as a person would use it. Takes the program and a mesh; says what was measured.
//
//     node test/run.mjs PROGRAM MESH [FOLDER FOR SCREENSHOTS]
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, statSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { chromium } from "playwright-core";
import { areComparable, differs } from "./pictures.mjs";

const [program, mesh, pictures] = process.argv.slice(2);
const folder = mkdtempSync(join(tmpdir(), "cones-page-"));
const executablePath = ["/usr/bin/chromium", "/usr/bin/chromium-browser", "/usr/bin/google-chrome"].find(existsSync);
const flags = [
  "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync",
];
const drawing = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"];
const complaints = [];
let passed = 0;

/** A new window, whose complaints are kept. */
async function open(browser, url, how = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, acceptDownloads: true, ...how });
  const page = await context.newPage();
  page.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
  page.on("pageerror", (error) => complaints.push(error.message));
  await page.goto(url);
  return page;
}

const maps = (page) => page.evaluate(() => Number(document.body.dataset.maps ?? 0));
const state = (page) => page.textContent("#state");

/** Waits for the first map of a page, and for what it is like. */
async function firstMap(page) {
  await page.waitForFunction(() => Number(document.body.dataset.maps ?? 0) > 0, null, { timeout: 60_000 });
  await page.waitForFunction(() => !document.querySelector("#state").classList.contains("busy"), null, { timeout: 60_000 });
}

/** Does something and waits for the exact map of it. */
async function afterMap(page, act) {
  const before = await maps(page);
  await act();
  await page.waitForFunction((before) => Number(document.body.dataset.maps ?? 0) > before, before, { timeout: 60_000 });
  await page.waitForFunction(() => !document.querySelector("#state").classList.contains("busy"), null, { timeout: 60_000 });
}

async function test(name, act) {
  const began = Date.now();
  try {
    await act();
    assert.deepEqual(complaints, [], "the console has complaints");
    passed++;
    console.log(`ok   ${name} (${Date.now() - began} ms)`);
  } catch (error) {
    process.exitCode = 1;
    console.log(`FAIL ${name}: ${error.stack}`);
  }
  complaints.length = 0;
}

/** Fields in a folder: a picture, a volume and a series of bumps, and a network. */
function writeFields(folder) {
  const bump = (x, y, z) => Math.sin(0.31 * x) * Math.cos(0.23 * y) * Math.cos(0.4 * z) + 0.2 * Math.sin(0.05 * x * y);
  const [columns, rows, layers] = [60, 40, 9];
  const at = (k) => bump(k % columns, Math.floor(k / columns) % rows, Math.floor(k / columns / rows));
  const grey = Uint8Array.from({ length: columns * rows }, (_, k) => 127 + 100 * at(k));
  writeFileSync(join(folder, "bumps.pgm"), Buffer.concat([Buffer.from(`P5 ${columns} ${rows} 255\n`), grey]));
  const head = `{'descr': '<f4', 'fortran_order': False, 'shape': (${layers}, ${rows}, ${columns}), }`.padEnd(117) + "\n";
  const values = Float32Array.from({ length: columns * rows * layers }, (_, k) => at(k));
  writeFileSync(join(folder, "volume.npy"), Buffer.concat([Buffer.from("\x93NUMPY\x01\x00v\x00", "latin1"), Buffer.from(head), Buffer.from(values.buffer)]));
  writeFileSync(join(folder, "series.txt"), Array.from({ length: 200 }, (_, x) => bump(x, x, 0).toFixed(4)).join("\n"));
  const towns = ["New York", "Llanfairpwllgwyngyllgogerychwyrndrobwllllantysiliogogogoch, of the longest names", "Rome", "Oslo", "<b>Ur</b>"];
  writeFileSync(join(folder, "net.nodes.csv"), ["id,name,value", ...towns.map((name, k) => `${k},"${name}",${[9, 2, 7, 1, 5][k]}`)].join("\n"));
  writeFileSync(join(folder, "net.edges.csv"), "a,b\n0,1\n1,2\n2,3\n3,4\n");
}

/** Fields whose numbers are hard to write: large whole ones, ones that differ late, infinite ones; of three parts, the least of which has a pair that ends. */
function writeHardFields(folder) {
  const bump = (k) => Math.sin(0.8 * k) + 0.3 * Math.sin(0.31 * k);
  const values = (of) => Array.from({ length: 120 }, (_, k) => of(bump(k), k)).join("\n");
  writeFileSync(join(folder, "whole.txt"), values((b) => Math.round(52736 + 20000 * b)));
  writeFileSync(join(folder, "late.txt"), values((b) => (1e9 + 0.3 * b).toFixed(4)));
  const array = (of) => {
    const head = "{'descr': '<f8', 'fortran_order': False, 'shape': (120,), }".padEnd(117) + "\n";
    const numbers = Float64Array.from({ length: 120 }, (_, k) => of(bump(k), k));
    return Buffer.concat([Buffer.from("\x93NUMPY\x01\x00v\x00", "latin1"), Buffer.from(head), Buffer.from(numbers.buffer)]);
  };
  writeFileSync(join(folder, "infinite.npy"), array((b, k) => (k === 50 ? -Infinity : 5 + b)));
  writeFileSync(join(folder, "parts.npy"), array((b, k) => (k === 70 || k === 90 ? NaN : k > 70 ? 0.01 * b : 5 * b)));
}

/** A cylinder of long triangles, and two tetrahedra that share a vertex. */
function writeHardMeshes(folder) {
  const sides = 40;
  const at = (k, z) => [Math.cos((2 * Math.PI * k) / sides), Math.sin((2 * Math.PI * k) / sides), z].map((x) => x.toFixed(6)).join(" ");
  const facets = Array.from({ length: sides }, (_, k) => [
    [at(k, -1.5), at(k + 1, -1.5), at(k + 1, 1.5)], [at(k, -1.5), at(k + 1, 1.5), at(k, 1.5)], [at(k, 1.5), at(k + 1, 1.5), "0 0 1.5"], [at(k + 1, -1.5), at(k, -1.5), "0 0 -1.5"],
  ]).flat();
  const facet = (points) => `facet normal 0 0 0\nouter loop\n${points.map((p) => `vertex ${p}\n`).join("")}endloop\nendfacet`;
  writeFileSync(join(folder, "needles.stl"), `solid needles\n${facets.map(facet).join("\n")}\nendsolid needles\n`);
  const points = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [-1, 0, 0], [0, -1, 0], [0, 0, -1]];
  const faces = [[1, 3, 2], [1, 2, 4], [1, 4, 3], [2, 3, 4], [1, 6, 5], [1, 5, 7], [1, 7, 6], [5, 6, 7]];
  writeFileSync(join(folder, "fans.obj"), [...points.map((p) => `v ${p.join(" ")}`), ...faces.map((f) => `f ${f.join(" ")}`)].join("\n"));
  writeFileSync(join(folder, "one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
}

/** The arrays of what the server sends, by name. */
function arrays(body) {
  const length = body.readUInt32LE(0);
  const { arrays } = JSON.parse(body.subarray(4, 4 + length));
  const read = { u32: (at) => body.readUInt32LE(at), f32: (at) => body.readFloatLE(at) };
  return (name) => Array.from({ length: arrays[name].length }, (_, k) => read[arrays[name].type](4 + length + arrays[name].at + 4 * k));
}

/** The seams of a map as the server sends it: chains of vertices. */
function seams(body) {
  const [all, lengths] = ["seams", "seam_lengths"].map(arrays(body));
  let at = 0;
  return lengths.map((length) => all.slice(at, (at += length)));
}

const edge = (a, b) => [Math.min(a, b), Math.max(a, b)].join();
const edgesOf = (chain) => chain.slice(1).map((v, k) => edge(chain[k], v));

/** The edges of the seams of a map as the server sends it, each by its vertices, the lower first. */
const seamEdges = (body) => new Set(seams(body).flatMap(edgesOf));

async function picture(page, name) {
  if (!pictures) return;
  await page.waitForTimeout(300);
  await page.screenshot({ path: join(pictures, `${name}.png`), fullPage: name.includes("phone") });
}

/** How many colours are seen in a part of the page, and how many pixels as dark as seams. */
async function look(page, selector) {
  const png = (await page.locator(selector).screenshot()).toString("base64");
  return page.evaluate(async (png) => {
    // Not by fetch: the page may talk to its server alone.
    const image = new Image();
    image.src = `data:image/png;base64,${png}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [image.width, image.height];
    const context = canvas.getContext("2d");
    context.drawImage(image, 0, 0);
    const { data } = context.getImageData(0, 0, image.width, image.height);
    const colours = new Set();
    let dark = 0;
    for (let k = 0; k < data.length; k += 4) {
      colours.add((data[k] >> 4) * 256 + (data[k + 1] >> 4) * 16 + (data[k + 2] >> 4));
      dark += Number(Math.max(data[k], data[k + 1], data[k + 2]) < 48);
    }
    return { colours: colours.size, dark };
  }, png);
}

/** How many colours are seen: few where nothing is drawn. */
const seen = async (page, selector) => (await look(page, selector)).colours;

/** Whether anything is cut off at the sides, or lies over something else. */
async function flaws(page) {
  return page.evaluate(() => {
    const found = [];
    if (document.documentElement.scrollWidth > innerWidth) found.push(`the page is ${document.documentElement.scrollWidth} wide`);
    const header = document.querySelector("header");
    if (header.scrollHeight > header.clientHeight + 1) found.push("the views cover the header");
    const shown = (element) => element.checkVisibility() && element.getClientRects().length > 0;
    const all = [...document.querySelectorAll("header > *, #controls > *, button, select, h1, figcaption")].filter(shown);
    for (const element of all) {
      const box = element.getBoundingClientRect();
      const name = element.id || element.textContent.slice(0, 20);
      if (box.right > innerWidth + 1 || box.left < -1) found.push(`${name} is cut off`);
      if (element.matches("button, figcaption") && element.scrollWidth > element.clientWidth + 1) found.push(`${name} does not fit`);
    }
    for (const svg of document.querySelectorAll("figure svg, #tree svg")) {
      const frame = svg.getBoundingClientRect();
      for (const text of svg.querySelectorAll("text")) {
        const box = text.getBoundingClientRect();
        if (box.left < frame.left - 1 || box.right > frame.right + 1) found.push(`${text.textContent} of a chart is cut off`);
      }
    }
    const theme = document.querySelector("#theme").getBoundingClientRect();
    const words = document.createRange();
    words.selectNodeContents(document.querySelector("#about"));
    for (const box of words.getClientRects()) {
      if (Math.min(box.right, theme.right) - Math.max(box.left, theme.left) > 1 && Math.min(box.bottom, theme.bottom) - Math.max(box.top, theme.top) > 1) found.push("the switch covers what is said of the surface");
    }
    const buttons = all.filter((element) => element.matches("button, select") && !element.closest("figure"));
    buttons.forEach((a, k) => buttons.slice(k + 1).forEach((b) => {
      const [p, q] = [a.getBoundingClientRect(), b.getBoundingClientRect()];
      const over = Math.min(p.right, q.right) - Math.max(p.left, q.left) > 1 && Math.min(p.bottom, q.bottom) - Math.max(p.top, q.top) > 1;
      if (over) found.push(`${a.textContent} lies over ${b.textContent}`);
    }));
    return found;
  });
}

/** A server and its address. */
async function serve(...args) {
  const server = spawn(program, ["view", "--no-open", ...args]);
  server.stderr.on("data", (data) => process.stderr.write(data));
  const url = await new Promise((found, failed) => {
    server.stdout.once("data", (data) => found(String(data).trim()));
    server.once("exit", () => failed(new Error("cones view has ended")));
  });
  return { server, url };
}

/** A page of a server of its own, for as long as it is used. */
async function served(browser, args, use) {
  const { server, url } = await serve(...args);
  try {
    const page = await open(browser, url);
    await firstMap(page);
    await use(page);
    await page.context().close();
  } finally {
    server.kill();
  }
}

const { server, url } = await serve(mesh, "-n", "8");
const browser = await chromium.launch({ executablePath, headless: true, args: [...flags, ...drawing] });
const comparable = areComparable(browser.version());
try {
  const page = await open(browser, url, { colorScheme: "light" });
  await test("the map is there after loading", async () => {
    await firstMap(page);
    await page.waitForSelector("#curve polyline[points*=' ']", { timeout: 60_000 });
    assert.equal(await page.inputValue("#count"), "8");
    assert.equal(await page.locator("#cones li").count(), 8);
    assert.equal(await state(page), "exact map");
    assert.match(await page.textContent("#numbers"), /Quasi-conformal, mean1\.\d/);
    assert.ok((await seen(page, "#surface canvas")) > 60, "the surface is drawn");
    assert.ok((await seen(page, "#atlas canvas")) > 8, "the map is drawn");
    await picture(page, "desk-light");
  });
  await test("the slider shows cones at once, and the exact map after that", async () => {
    const ms = await page.evaluate(() => {
      const slider = document.querySelector("#slider");
      const began = performance.now();
      slider.value = "16";
      slider.dispatchEvent(new Event("input", { bubbles: true }));
      return [performance.now() - began, document.querySelectorAll("#cones li").length];
    });
    console.log(`     slider: ${ms[0].toFixed(1)} ms`);
    assert.equal(ms[1], 16);
    await afterMap(page, () => page.locator("#slider").press("ArrowRight"));
    assert.equal(await page.inputValue("#count"), "17");
    assert.equal(await page.locator("#cones li").count(), 17);
  });
  await test("many moves come to the map of the last", async () => {
    await afterMap(page, async () => {
      for (let k = 0; k < 12; k++) await page.locator("#slider").press("ArrowLeft");
    });
    await page.waitForFunction(() => document.querySelector("#state").textContent === "exact map");
    assert.equal(await page.locator("#cones li").count(), 5);
    assert.match(await page.textContent("#numbers"), /measured\d/);
  });
  await test("seams of all numbers are known before the slider moves; the map of the last comes when it is let go", async () => {
    const asked = [];
    const note = (request) => asked.push(request.url().split("/").at(-1));
    page.on("request", note);
    // Seams of all numbers are found while nothing else is to be done.
    for (let quiet = 0, count = -1; quiet < 8; quiet = count === asked.length ? quiet + 1 : 0, count = asked.length) await page.waitForTimeout(100);
    asked.length = 0;
    const box = await page.locator("#slider").boundingBox();
    const at = (n) => [box.x + 8 + ((box.width - 16) * (n - 3)) / 61, box.y + box.height / 2];
    await page.mouse.move(...at(5));
    await page.mouse.down();
    const [dark, told] = [[], []];
    const MOVING = "computing the map …,true,–";
    for (const n of [12, 40, 20, 30]) {
      await page.mouse.move(...at(n));
      await page.waitForTimeout(60);
      told.push(await page.evaluate(() => [
        document.querySelector("#state").textContent, document.querySelector("#atlas").classList.contains("stale"), document.querySelector("#numbers").rows[1].cells[1].textContent,
      ].join()));
      dark.push((await look(page, "#surface canvas")).dark);
    }
    await page.waitForTimeout(400);
    const rows = await page.locator("#cones li").count();
    assert.equal(String(rows), await page.inputValue("#count"));
    assert.ok(!asked.includes("cones"), `${asked}`);
    assert.ok(dark.every((pixels) => pixels > 150), `seams are seen: ${dark}`);
    assert.deepEqual(told, [MOVING, MOVING, MOVING, MOVING], "nothing is told of the map before");
    await afterMap(page, () => page.mouse.up());
    assert.ok(asked.includes("map") && !asked.includes("cones"), `${asked}`);
    assert.equal(await page.locator("#cones li").count(), rows);
    page.off("request", note);
    await afterMap(page, () => page.fill("#count", "5").then(() => page.press("#count", "Enter")));
  });
  await test("a number beyond what the page shows is not changed in silence", async () => {
    const typed = (text) => page.fill("#count", text).then(() => page.press("#count", "Enter"));
    assert.ok(await page.isHidden("#bound"));
    await afterMap(page, () => typed("500"));
    assert.equal(await page.inputValue("#count"), "64");
    assert.equal(await page.textContent("#bound"), "the page shows 64 at most");
    await afterMap(page, () => typed("5"));
    assert.ok(await page.isHidden("#bound"));
    await typed("");
    assert.equal(await page.inputValue("#count"), "5");
    assert.ok(await page.isHidden("#bound"));
    await afterMap(page, () => typed("3"));
    for (const beyond of ["-5", "0"]) {
      await typed(beyond);
      assert.equal(await page.inputValue("#count"), "3");
      assert.equal(await page.textContent("#bound"), "3 at least are needed");
    }
    await afterMap(page, () => typed("5"));
  });
  await test("a cone at no vertex is refused, and all stays as it is", async () => {
    const shown = () => Promise.all([page.inputValue("#count"), page.textContent("#numbers"), page.locator("#cones li").count(), page.isDisabled("#redo")]);
    const before = await shown();
    await page.fill("#vertex", "99999999");
    await page.press("#vertex", "Enter");
    await page.waitForSelector("#state.failed");
    assert.match(await state(page), /^cone 99999999 is not a vertex of any face/);
    assert.deepEqual(await shown(), before);
  });
  await test("every colour has its legend, and is another picture", async () => {
    for (const [mode, legend] of [["area", "ideal 1"], ["stretch", "ideal 1"], ["factor", "φ"], ["islands", "island"], ["plain", ""], ["checker", "squares"]]) {
      await page.click(`[data-mode=${mode}]`);
      assert.ok((await page.textContent("#scale")).includes(legend), mode);
      assert.equal(await page.getAttribute(`[data-mode=${mode}]`, "aria-pressed"), "true");
    }
  });
  await test("what is pointed at on one side lights up on the other", async () => {
    const box = await page.locator("#surface canvas").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await page.waitForSelector("#atlas .mark:not([hidden])");
    assert.match(await page.textContent("#place"), /vertex \d+.*φ.*area.*σ₁\/σ₂.*island 1/);
    const mark = await page.locator("#atlas .mark").boundingBox();
    await page.mouse.move(mark.x + 11, mark.y + 11);
    const back = await page.locator("#surface .mark").boundingBox();
    assert.ok(Math.hypot(back.x + 11 - box.x - box.width / 2, back.y + 11 - box.y - box.height / 2) < 12, "there and back");
  });
  await test("a cone is added, dragged, removed, and all of it undone", async () => {
    await page.click("#edit");
    const box = await page.locator("#surface canvas").boundingBox();
    await afterMap(page, () => page.mouse.click(box.x + 0.5 * box.width, box.y + 0.55 * box.height));
    assert.equal(await page.locator("#cones li").count(), 6);
    const added = await page.textContent("#cones li:last-child");
    assert.equal(await page.getAttribute("#cones li:last-child button", "aria-pressed"), "true", "what was added is selected");
    await afterMap(page, async () => {
      await page.mouse.move(box.x + 0.5 * box.width, box.y + 0.55 * box.height);
      await page.mouse.down();
      await page.mouse.move(box.x + 0.53 * box.width, box.y + 0.5 * box.height, { steps: 4 });
      await page.mouse.up();
    });
    assert.equal(await page.locator("#cones li").count(), 6);
    assert.notEqual(await page.textContent("#cones li:last-child"), added);
    assert.equal(await page.getAttribute("#cones li:last-child button", "aria-pressed"), "true", "what was dragged is selected");
    await afterMap(page, () => page.keyboard.press("Delete"));
    assert.equal(await page.locator("#cones li").count(), 5);
    await afterMap(page, () => page.click("#undo"));
    await afterMap(page, () => page.keyboard.press("Control+z"));
    assert.equal(await page.textContent("#cones li:last-child"), added);
    await afterMap(page, () => page.click("#redo"));
    assert.notEqual(await page.textContent("#cones li:last-child"), added);
    await page.waitForFunction(() => /^\d+\.\d{3}$/.test(document.querySelector("#numbers").rows[0].cells[1].textContent), null, { timeout: 5000 });
    await page.click("#edit");
  });
  await test("a map that comes with other cones while one is chosen or dragged changes no other", async () => {
    const listed = () => page.locator("#cones li button").evaluateAll((rows) => rows.map((row) => Number(row.dataset.vertex)));
    /** Asks for so many cones, whose map comes when it is let, and has more cones and other ones. */
    const asked = async (n) => {
      let let_go;
      const waits = new Promise((go) => (let_go = go));
      await page.route("**/map", async (route) => {
        await waits;
        await route.continue({ postData: JSON.stringify({ ...route.request().postDataJSON(), n: n + 9, method: "iterative" }) });
      }, { times: 1 });
      await page.fill("#count", String(n));
      await page.press("#count", "Enter");
      await page.waitForTimeout(300);
      return let_go;
    };
    let come = await asked(11);
    const foreseen = await listed();
    const k = 5;
    await page.locator("#cones li button").nth(k).click();
    await afterMap(page, come);
    assert.notDeepEqual(await listed(), foreseen);
    const selected = await page.locator("#cones li button[aria-pressed=true]").evaluateAll((rows) => rows.map((row) => Number(row.dataset.vertex)));
    assert.deepEqual(selected, (await listed()).includes(foreseen[k]) ? [foreseen[k]] : []);
    await page.click("#edit");
    for (const goesOn of [true, false]) {
      come = await asked(goesOn ? 12 : 13);
      const before = await listed();
      // One that is in sight, by its mark.
      let at = null;
      for (let k = 0; k < before.length && !at; k++) {
        await page.locator("#cones li button").nth(k).click();
        const mark = page.locator("#surface .mark:not(.behind)");
        const box = (await mark.count()) && (await mark.boundingBox());
        if (box) at = { vertex: before[k], x: box.x + 11, y: box.y + 11 };
      }
      await page.mouse.move(at.x, at.y);
      await page.mouse.down();
      await page.mouse.move(at.x + 12, at.y + 9, { steps: 3 });
      await afterMap(page, come);
      if (goesOn) await page.mouse.move(at.x + 20, at.y + 14, { steps: 3 });
      const [request] = await Promise.all([page.waitForRequest((request) => request.url().endsWith("/map")), afterMap(page, () => page.mouse.up())]);
      const after = request.postDataJSON().given.map(([vertex]) => vertex);
      assert.deepEqual(before.filter((vertex) => !after.includes(vertex)), [at.vertex], "the dragged one has moved");
      assert.equal(after.length, before.length, "and all others are as they were shown");
    }
    await page.click("#edit");
    await afterMap(page, () => page.fill("#count", "5").then(() => page.press("#count", "Enter")));
  });
  await test("a tool that is taken and laid down while a map is computed does not say that it is there", async () => {
    let come;
    const waits = new Promise((go) => (come = go));
    await page.route("**/map", (route) => waits.then(() => route.continue()), { times: 1 });
    await page.locator("#slider").press("ArrowRight");
    await page.click("#edit");
    assert.match(await page.textContent("#hint"), /click adds a cone/);
    assert.equal(await state(page), "computing the map …");
    await page.click("#edit");
    assert.equal(await page.textContent("#hint"), "");
    assert.equal(await state(page), "computing the map …");
    await afterMap(page, come);
    assert.equal(await state(page), "exact map");
    await afterMap(page, () => page.locator("#slider").press("ArrowLeft"));
  });
  await test("a save is done though another choice is made meanwhile", async () => {
    let come;
    const waits = new Promise((go) => (come = go));
    await page.route("**/save/cones", (route) => waits.then(() => route.continue()), { times: 1 });
    await page.fill("#count", "23");
    await page.press("#count", "Enter");
    const saved = page.waitForEvent("download");
    await page.click("#save-cones");
    await afterMap(page, () => page.fill("#count", "5").then(() => page.press("#count", "Enter")));
    come();
    const path = join(folder, "saved.txt");
    await (await saved).saveAs(path);
    assert.equal(readFileSync(path, "utf8").trim().split("\n").filter((line) => !line.startsWith("#")).length, 23);
  });
  await test("a cone that is chosen by keys keeps the focus, F fits both views from anywhere", async () => {
    await page.locator("#cones li button").nth(2).focus();
    await page.keyboard.press("Enter");
    assert.equal(await page.evaluate(() => [...document.querySelectorAll("#cones button")].indexOf(document.activeElement)), 2);
    await page.keyboard.press("Escape");
    const look = () => page.locator("#atlas canvas").screenshot();
    const before = await look();
    await page.locator("#atlas canvas").hover();
    await page.mouse.wheel(0, -600);
    await page.waitForTimeout(300);
    await page.mouse.move(2, 2);
    const near = await look();
    assert.ok(!before.equals(near));
    await page.keyboard.press("f");
    await page.waitForTimeout(300);
    assert.ok(!near.equals(await look()));
  });
  await test("seams are pinned along chains, kept through other changes, undone, saved and loaded", async () => {
    const box = await page.locator("#surface canvas").boundingBox();
    const at = (x, y) => page.mouse.click(box.x + x * box.width, box.y + y * box.height);
    const pins = () => page.evaluate(() => document.querySelector("#unpin").disabled === false);
    /** Does something; what its map was asked with, and the edges of the seams that came. */
    const mapOf = async (act) => {
      const [response] = await Promise.all([page.waitForResponse((response) => response.url().endsWith("/map") && response.ok()), afterMap(page, act)]);
      return { question: response.request().postDataJSON(), edges: seamEdges(await response.body()) };
    };
    const includes = ({ edges }, some) => some.every((edge) => edges.has(String(edge)));
    assert.equal(await pins(), false);
    await page.click("#cut");
    assert.equal(await page.getAttribute("#edit", "aria-pressed"), "false");
    await at(0.47, 0.62);
    assert.equal(await pins(), false, "the first click only begins a chain");
    const first = await mapOf(() => at(0.53, 0.55));
    assert.ok(await pins());
    const { cut } = first.question;
    assert.ok(cut.length > 1 && includes(first, cut), "the map is cut along the chain");
    await page.click("#avoid");
    await at(0.45, 0.7);
    await afterMap(page, () => at(0.5, 0.75));
    const other = await mapOf(() => page.locator("#slider").press("ArrowRight"));
    assert.deepEqual(other.question.cut, cut, "another number of cones leaves them");
    assert.ok(other.question.avoid.length > 1 && includes(other, cut));
    assert.ok(!other.question.avoid.some((edge) => other.edges.has(String(edge))), "and no seam runs where none is to");
    const downloads = [];
    page.on("download", (download) => downloads.push(download));
    await page.click("#save-pins");
    while (downloads.length < 2) await page.waitForTimeout(20);
    const files = [];
    for (const download of downloads) {
      files.push(join(folder, download.suggestedFilename()));
      await download.saveAs(files.at(-1));
    }
    page.removeAllListeners("download");
    assert.deepEqual(files.map((file) => file.replace(/.*hare-/, "")), ["seams.txt", "avoid.txt"]);
    const made = spawnSync(program, ["unwrap", mesh, "-n", "6", "-o", join(folder, "pinned.obj"), "--seams", files[0], "--avoid", files[1], "-q"], { encoding: "utf8" });
    assert.equal(made.status, 0, made.stderr);
    // Cones of a surface that was opened along seams come back with these.
    const [saved] = await Promise.all([page.waitForEvent("download"), page.click("#save-cones")]);
    const cones = join(folder, "of-charts.txt");
    await saved.saveAs(cones);
    assert.match(readFileSync(cones, "utf8"), /^#: charts$/m);
    await afterMap(page, () => page.click("#unpin"));
    await afterMap(page, () => page.setInputFiles("#file", cones));
    assert.match(await state(page), /give the same seams/);
    for (const file of files) await afterMap(page, () => page.setInputFiles("#file", file));
    assert.deepEqual((await mapOf(() => page.setInputFiles("#file", cones))).edges, other.edges);
    for (let k = 0; k < 4; k++) await afterMap(page, () => page.click("#undo"));
    await afterMap(page, () => page.click("#unpin"));
    assert.equal(await pins(), false);
    const again = await mapOf(() => page.setInputFiles("#file", files[0]));
    assert.deepEqual(again.question.cut, cut);
    // By hand nobody writes the heading first, or at all.
    const lines = readFileSync(files[0], "utf8").trim().split("\n");
    for (const [name, text] of [["plain.txt", lines.slice(1)], ["late.txt", ["# mine", ...lines]]]) {
      await afterMap(page, () => page.click("#unpin"));
      writeFileSync(join(folder, name), text.join("\n"));
      assert.deepEqual((await mapOf(() => page.setInputFiles("#file", join(folder, name)))).question.cut, cut, name);
      for (let k = 0; k < 2; k++) await afterMap(page, () => page.click("#undo"));
    }
    writeFileSync(join(folder, "twice.txt"), "5\n6\n7\n5\n");
    await page.setInputFiles("#file", join(folder, "twice.txt"));
    await page.waitForSelector("#state.failed");
    assert.equal(await state(page), "twice.txt: the file lists cone 5 twice");
    // What the server refuses is not chosen.
    writeFileSync(join(folder, "none.txt"), "# edges to cut, for --seams\n1 2000\n");
    await afterMap(page, () => page.setInputFiles("#file", join(folder, "none.txt")));
    assert.match(await state(page), /there is no edge/);
    assert.ok((await pins()) && (await page.isEnabled("#undo")));
    complaints.splice(0, complaints.length, ...complaints.filter((text) => !text.includes("422")));
    for (let k = 0; k < 2; k++) await afterMap(page, () => page.click("#undo"));
    assert.ok(await pins(), "what was unpinned is pinned again");
    for (let k = 0; k < 3; k++) await afterMap(page, () => page.click("#undo"));
    assert.equal(await pins(), false);
    await page.click("#avoid");
  });
  await test("seams are pinned on the map as on the surface, one from end to end by a double click", async () => {
    const asked = async (act) => {
      const [request] = await Promise.all([page.waitForRequest((request) => request.url().endsWith("/map")), afterMap(page, act)]);
      return request.postDataJSON();
    };
    const box = await page.locator("#atlas canvas").boundingBox();
    const at = (x, y) => page.mouse.click(box.x + x * box.width, box.y + y * box.height);
    await page.click("#cut");
    await at(0.48, 0.5);
    const { cut } = await asked(() => at(0.54, 0.45));
    assert.ok(cut.length > 1, "clicks on the map pin what lies between");
    await page.click("#avoid");
    const [response] = await Promise.all([page.waitForResponse((response) => response.url().endsWith("/map") && response.ok()), afterMap(page, () => page.locator("#slider").press("ArrowRight"))]);
    const body = await response.body();
    // The middle of the longest seam that is not pinned, where the map has it on the screen: the unit square fills the height but for a rim.
    const pinned = new Set(cut.map(String));
    const free = seams(body).filter((chain) => !edgesOf(chain).some((one) => pinned.has(one)));
    const seam = free.reduce((longest, chain) => (chain.length > longest.length ? chain : longest));
    const triangles = arrays(Buffer.from(await (await fetch(`${url}surface`)).arrayBuffer()))("triangles");
    const corner = triangles.indexOf(seam[seam.length >> 1]);
    const [u, v] = arrays(body)("uv").slice(2 * corner, 2 * corner + 2);
    const unit = Math.min(box.width, box.height) / 1.08;
    const [x, y] = [box.x + 0.5 * box.width + (u - 0.5) * unit, box.y + 0.5 * box.height - (v - 0.5) * unit];
    const { avoid } = await asked(() => page.mouse.dblclick(x, y));
    assert.deepEqual(avoid.map(String).sort(), edgesOf(seam).sort(), "a seam from end to end");
    await afterMap(page, () => page.click("#undo"));
    await at(0.5, 0.5);
    const open = await asked(() => page.mouse.dblclick(x, y));
    assert.deepEqual(open.avoid.map(String).sort(), edgesOf(seam).sort(), "and not the way to it from where a chain was begun");
    for (let k = 0; k < 3; k++) await afterMap(page, () => page.click("#undo"));
    await page.click("#avoid");
    assert.equal(await page.isDisabled("#unpin"), true);
  });
  await test("cones are saved and loaded, maps are saved", async () => {
    const save = async (button) => {
      const [download] = await Promise.all([page.waitForEvent("download"), page.click(button)]);
      const path = join(folder, download.suggestedFilename());
      await download.saveAs(path);
      return path;
    };
    const cones = await save("#save-cones");
    const count = await page.locator("#cones li").count();
    const lines = readFileSync(cones, "utf8").trim().split("\n");
    assert.equal(lines.filter((line) => !line.startsWith("#")).length, count);
    const obj = await save("#save-obj");
    assert.match(readFileSync(obj, "utf8"), /^vt /m);
    const measured = spawnSync(program, ["measure", obj, "--json"], { encoding: "utf8" });
    assert.equal(JSON.parse(measured.stdout).distortion?.flipped ?? JSON.parse(measured.stdout).flipped, 0);
    assert.equal(readFileSync(await save("#save-glb")).subarray(0, 4).toString(), "glTF");
    await afterMap(page, () => page.locator("#slider").press("ArrowRight"));
    await afterMap(page, () => page.setInputFiles("#file", cones));
    assert.equal(await page.locator("#cones li").count(), count);
    writeFileSync(join(folder, "wrong.txt"), "here no cones\n");
    await page.setInputFiles("#file", join(folder, "wrong.txt"));
    await page.waitForSelector("#state.failed");
    assert.match(await state(page), /^wrong\.txt: no cone/);
  });
  await test("methods and curvatures are chosen, a click on the curve chooses N", async () => {
    await afterMap(page, () => page.selectOption("#method", "alternating"));
    await afterMap(page, () => page.selectOption("#angles", "harmonic"));
    await page.waitForSelector("#curve polyline[points*=' ']");
    const box = await page.locator("#curve").boundingBox();
    await afterMap(page, () => page.mouse.click(box.x + box.width / 2, box.y + 30));
    assert.ok(Number(await page.inputValue("#count")) > 20);
    await picture(page, "desk-paper");
  });
  await test("a reload begins anew, several windows at once", async () => {
    await page.reload();
    await firstMap(page);
    const other = await open(browser, url);
    await firstMap(other);
    assert.equal(await other.inputValue("#count"), "8");
    await other.context().close();
  });
  await test("all of it is reached by keys", async () => {
    const reached = new Set();
    for (let k = 0; k < 40; k++) {
      await page.keyboard.press("Tab");
      reached.add(await page.evaluate(() => document.activeElement?.id || document.activeElement?.dataset?.mode || document.activeElement?.tagName));
    }
    for (const id of ["area", "theme", "CANVAS", "slider", "count", "method", "angles", "edit", "load", "save-obj", "vertex"]) assert.ok(reached.has(id), id);
    const before = await page.locator("#surface canvas").screenshot();
    await page.focus("#surface canvas");
    await page.keyboard.press("ArrowLeft");
    await page.waitForTimeout(200);
    assert.ok(!before.equals(await page.locator("#surface canvas").screenshot()), "it turns");
  });
  await test("memory does not grow over many moves", async () => {
    const held = () => page.evaluate(() => performance.memory?.usedJSHeapSize ?? 0);
    const resident = () => Number(/VmRSS:\s+(\d+)/.exec(readFileSync(`/proc/${server.pid}/status`, "utf8"))?.[1] ?? 0);
    const move = (count) => page.evaluate(async (count) => {
      const slider = document.querySelector("#slider");
      for (let k = 0; k < count; k++) {
        slider.value = String(4 + ((7 * k) % 60));
        slider.dispatchEvent(new Event("input", { bubbles: true }));
        await new Promise((next) => setTimeout(next, 20));
      }
    }, count);
    await move(60);
    const before = [await held(), resident()];
    await move(440);
    const after = [await held(), resident()];
    console.log(`     page ${before.map((x, k) => `${Math.round(x / (k ? 1024 : 1048576))}`)} -> ${after.map((x, k) => Math.round(x / (k ? 1024 : 1048576)))} MB (page, server)`);
    assert.ok(after[0] < before[0] + 60e6 && after[1] < before[1] + 60e3, "it grows");
  });
  await page.context().close();


  for (const [name, viewport] of [["desk", { width: 1280, height: 800 }], ["phone", { width: 390, height: 844 }]]) {
    for (const colorScheme of comparable ? ["light", "dark"] : []) {
      await test(`it looks as it did: ${name}, ${colorScheme}`, async () => {
        const other = await open(browser, url, { viewport, colorScheme });
        await firstMap(other);
        await other.waitForSelector("#curve polyline[points*=' ']", { timeout: 60_000 });
        await other.waitForTimeout(400);
        assert.equal(await differs(other, `${name}-${colorScheme}`), "");
        await other.click("[data-mode=area]");
        await other.waitForTimeout(400);
        assert.equal(await differs(other, `${name}-${colorScheme}-area`), "");
        if (!process.env.STORE) assert.notEqual(await differs(other, `${name}-${colorScheme}`), "", "another colour is told");
        await other.context().close();
      });
    }
  }

  const sizes = [["desk", 1280, 800], ["laptop", 1024, 768], ["tablet", 900, 700], ["phone", 390, 844], ["wide", 1920, 1080], ["low", 1280, 600], ["netbook", 1024, 600]];
  for (const [name, width, height] of sizes) {
    for (const colorScheme of ["light", "dark"]) {
      await test(`nothing is cut off or covered: ${name}, ${colorScheme}`, async () => {
        const other = await open(browser, url, { viewport: { width, height }, colorScheme });
        await firstMap(other);
        assert.deepEqual(await flaws(other), []);
        await other.click("[data-mode=area]");
        assert.deepEqual(await flaws(other), []);
        await picture(other, `${name}-${colorScheme}-area`);
        const dark = () => other.evaluate(() => getComputedStyle(document.body).backgroundColor);
        const before = await dark();
        await other.click("#theme");
        assert.notEqual(await dark(), before, "the switch switches");
        await other.context().close();
      });
    }
  }

  const report = join(folder, "report.html");
  await test("the report opens from the disk without a network", async () => {
    const made = spawnSync(program, ["unwrap", mesh, "-n", "9", "-o", join(folder, "out.obj"), "--report", report], { encoding: "utf8" });
    assert.equal(made.status, 0, made.stderr);
    console.log(`     ${(statSync(report).size / 1e6).toFixed(2)} MB`);
    const asked = [];
    const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, offline: true });
    const file = await context.newPage();
    file.on("request", (request) => request.url().startsWith("http") && asked.push(request.url()));
    file.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
    file.on("pageerror", (error) => complaints.push(error.message));
    await file.goto(`file://${report}`);
    await firstMap(file);
    assert.equal(await file.inputValue("#count"), "9");
    assert.equal(await file.locator("#cones li").count(), 9);
    assert.ok((await seen(file, "#atlas canvas")) > 8, "the map is drawn");
    const stored = new Set();
    for (let n = 9; n < 40; n++) {
      await afterMap(file, () => file.locator("#slider").press("ArrowRight"));
      assert.equal(await file.locator("#cones li").count(), n + 1);
      if (await file.isHidden("#badge")) stored.add(n + 1);
    }
    assert.ok(stored.size >= 4, `${[...stored]}`);
    for (const id of ["#edit", "#add", "#auto"]) assert.equal(await file.isVisible(id), false);
    assert.deepEqual(asked, []);
    await picture(file, "report");
    await context.close();
  });

  await test("a report tells what is predicted for the cones of its map", async () => {
    const made = spawnSync(program, ["unwrap", mesh, "-o", join(folder, "out.obj"), "--report", report, "--json"], { encoding: "utf8" });
    assert.equal(made.status, 0, made.stderr);
    const { chosen, predicted_area } = JSON.parse(made.stdout).number;
    const file = await browser.newPage();
    await file.goto(`file://${report}`);
    await firstMap(file);
    assert.equal(await file.inputValue("#count"), String(chosen));
    assert.equal(await file.textContent("#numbers tr:first-child td:last-child"), predicted_area.toFixed(3));
    await file.close();
  });

  await test("as many cones as the surface asks for can be chosen again, with what is predicted for them", async () => {
    const made = spawnSync(program, ["unwrap", mesh, "-o", join(folder, "out.obj"), "--json"], { encoding: "utf8" });
    const { chosen, predicted_area } = JSON.parse(made.stdout).number;
    await served(browser, [mesh], async (page) => {
      const shown = () => Promise.all([page.inputValue("#count"), page.textContent("#numbers tr:first-child td:last-child"), page.getAttribute("#auto", "aria-pressed")]);
      const automatic = [String(chosen), predicted_area.toFixed(3), "true"];
      assert.deepEqual(await shown(), automatic);
      await page.waitForSelector("#curve polyline[points*=' ']", { timeout: 60_000 });
      await page.waitForTimeout(300);
      assert.deepEqual(await shown(), automatic, "also when the curve is known");
      await afterMap(page, () => page.fill("#count", "20").then(() => page.press("#count", "Enter")));
      assert.notDeepEqual(await shown(), automatic);
      await afterMap(page, () => page.click("#auto"));
      assert.deepEqual(await shown(), automatic);
    });
  });
  writeHardMeshes(folder);
  await test("on a refined model cones are put where they can be, and it is said that it is refined", async () => {
    await served(browser, [join(folder, "needles.stl"), "-n", "6"], async (page) => {
      assert.match(await page.textContent("#about"), /^82 vertices, 160 triangles, refined to [\d,]+ vertices/);
      assert.match(await page.textContent("#warnings"), /refined to even triangles/);
      for (const id of ["#cut", "#avoid"]) {
        assert.ok(await page.isDisabled(id));
        assert.match(await page.getAttribute(id, "title"), /even triangles/);
      }
      await page.click("#edit");
      const box = await page.locator("#surface canvas").boundingBox();
      // Apart from each other, lest two are nearest to the same vertex.
      for (let k = 0; k < 6; k++) {
        const before = await page.locator("#cones li").count();
        await afterMap(page, () => page.mouse.click(box.x + (0.4 + 0.034 * k) * box.width, box.y + (0.35 + 0.031 * ((5 * k) % 7)) * box.height));
        assert.equal(await state(page), "exact map");
        assert.equal(await page.locator("#cones li").count(), before + 1);
      }
    });
  });
  await test("what was mended is told in the page and in a report", async () => {
    const fans = /1 vertex with several fans of faces, opened/;
    await served(browser, [join(folder, "fans.obj")], async (page) => assert.match(await page.textContent("#warnings"), fans));
    spawnSync(program, ["unwrap", join(folder, "fans.obj"), "-o", join(folder, "out.obj"), "--report", report, "-q"]);
    const file = await browser.newPage();
    await file.goto(`file://${report}`);
    await firstMap(file);
    assert.match(await file.textContent("#warnings"), fans);
    await file.close();
    // So few vertices bear no cones that could be foreseen.
    complaints.splice(0, complaints.length, ...complaints.filter((text) => !text.includes("422")));
  });
  await test("where there is nothing to find nothing is said to be found", async () => {
    await served(browser, [join(folder, "one.obj")], async (page) => {
      assert.equal(await page.textContent("#about"), "3 vertices, 1 triangle, 1 boundary loop");
      await page.waitForFunction(() => !["#curve", "#diagram"].some((chart) => document.querySelector(chart).textContent.includes("being found")), null, { timeout: 5000 });
    });
  });

  // Fields: a mesh, a picture, a volume, a series.
  writeFields(folder);
  const fields = [
    ["mesh", ["features", mesh], "vertex"],
    ["picture", ["persistence", join(folder, "bumps.pgm")], ","],
    ["volume", ["persistence", join(folder, "volume.npy")], ","],
    ["series", ["persistence", join(folder, "series.txt")], ""],
  ];
  for (const [name, command, place] of fields) {
    await test(`a field on a ${name} is seen with its segments, tree, bars and pairs`, async () => {
      const html = join(folder, `${name}.html`);
      const made = spawnSync(program, [...command, "--report", html], { encoding: "utf8" });
      assert.equal(made.status, 0, made.stderr);
      const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, offline: true });
      const file = await context.newPage();
      file.on("console", (message) => message.type() === "error" && complaints.push(message.text()));
      file.on("pageerror", (error) => complaints.push(error.message));
      await file.goto(`file://${html}`);
      await firstMap(file);
      const count = async () => [Number(await file.inputValue("#count")), await file.locator("#cones li").count(), await file.locator("#tree circle").count()];
      const [n, ...shown] = await count();
      assert.ok(n > 1 && n <= 8 && shown.every((other) => other === n), `${await count()}`);
      assert.ok((await seen(file, "#surface canvas")) > 8, "segments are drawn");
      await file.fill("#count", "9999");
      await file.press("#count", "Enter");
      assert.equal(await file.textContent("#bound"), `the page shows ${(await count())[0]} at most`);
      await file.fill("#count", String(n));
      await file.press("#count", "Enter");
      assert.ok(await file.isHidden("#bound"));
      await file.locator("#slider").press("ArrowLeft");
      assert.ok((await count())[0] < n, "fewer extrema");
      await file.click("#cones li:nth-child(2) button");
      assert.match(await file.textContent("#numbers"), /Persistence[\d.]+/);
      assert.ok((await file.textContent("#numbers")).includes(place));
      const box = await file.locator("#surface canvas").boundingBox();
      await file.mouse.move(box.x + 0.5 * box.width, box.y + 0.55 * box.height);
      assert.match(await file.textContent("#place"), /about -?[\d.]+.*belongs to/);
      const before = await file.locator("#surface canvas").screenshot();
      await file.click("[data-mode=values]");
      await file.waitForTimeout(300);
      assert.ok(!before.equals(await file.locator("#surface canvas").screenshot()), "values look otherwise");
      await file.selectOption("#direction", "0");
      assert.equal(await file.textContent("#number span"), "Minima");
      assert.deepEqual(await flaws(file), []);
      if (name === "volume") {
        const layer = await file.inputValue("#layer");
        await file.locator("#layer").press("ArrowRight");
        assert.notEqual(await file.inputValue("#layer"), layer);
      }
      await picture(file, `field-${name}`);
      if (name === "picture" && comparable) {
        await file.waitForTimeout(300);
        assert.equal(await differs(file, "field"), "");
      }
      await context.close();
    });
  }
  writeHardFields(folder);
  const hard = [
    ["whole.txt", /values from 26972 to 78251$/, /^Maximum at\d+Value, birth7\d{4}Saddle/],
    ["late.txt", /values from 999999999\.\d+ to 1000000000\.\d+$/, /birth1000000000\.\d+Saddle/],
    ["infinite.npy", /values from 3\.\d+ to 6\.\d+$/, /^Minimum at50Value, birth−∞Saddle/],
    ["parts.npy", /values from -\d/, /Saddle atnone/],
  ];
  for (const [name, about, numbers] of hard) {
    await test(`numbers are written as they are, and nothing is cut off: ${name}`, async () => {
      const html = join(folder, "hard.html");
      const made = spawnSync(program, ["persistence", join(folder, name), "--nan", "mask", "--report", html], { encoding: "utf8" });
      assert.equal(made.status, 0, made.stderr);
      const file = await open(browser, `file://${html}`, { offline: true });
      await firstMap(file);
      if (name === "infinite.npy") await file.selectOption("#direction", "0");
      assert.match(await file.textContent("#about"), about);
      await file.click("#cones li:first-child button");
      assert.match(await file.textContent("#numbers"), numbers);
      await file.click("[data-mode=values]");
      assert.deepEqual(await flaws(file), []);
      if (name === "parts.npy") {
        const marked = async () => [await file.inputValue("#count"), await file.locator("#cones li").count(), await file.locator("#tree circle").count()].map(String);
        for (let k = 0; k < 3; k++) await file.locator("#slider").press("ArrowLeft");
        const never = file.locator("#cones li").filter({ hasText: "" });
        assert.ok((await never.count()) >= 3, "all three parts are there at every level");
        assert.equal(new Set(await marked()).size, 1);
        await file.locator("#cones li").nth(2).locator("button").click();
        assert.match(await file.textContent("#numbers"), /Saddle atnone/);
      }
      await picture(file, `hard-${name}`);
      await file.context().close();
    });
  }
  await test("a network is seen with its tree, bars and pairs, and its nodes by their names", async () => {
    const html = join(folder, "network.html");
    const made = spawnSync(program, ["persistence", join(folder, "net.nodes.csv"), "--report", html], { encoding: "utf8" });
    assert.equal(made.status, 0, made.stderr);
    const file = await open(browser, `file://${html}`, { offline: true });
    await firstMap(file);
    assert.match(await file.textContent("#about"), /network, values from 1 to 9/);
    assert.deepEqual(await file.locator("#cones li span:first-child").allTextContents(), ["New York", "Rome", "<b>Ur</b>"]);
    // In one step: between finding and measuring, a chart may be drawn anew.
    const sizes = (selector) => file.evaluate((selector) => Array.from(document.querySelectorAll(selector), (shape) => shape.getBBox()).map(({ width, height }) => ({ width, height })), selector);
    const bars = (await sizes("#curve [data-pair]")).map(({ width }) => width);
    assert.ok(bars.length === 3 && bars.every((width) => width > 20), `${bars}`);
    const depths = (await sizes("#tree path")).map(({ height }) => height);
    assert.ok(depths.length === 3 && depths.every((height) => height > 20), `${depths}`);
    assert.match(await file.locator("#diagram circle title").first().textContent(), /maximum at New York: 9 to the end/);
    await file.click("#cones li:nth-child(2) button");
    assert.match(await file.textContent("#numbers"), /Maximum atRome.*Saddle atLlanfair.*Persistence5JoinsNew York/);
    assert.deepEqual(await flaws(file), []);
    await picture(file, "field-network");
    await file.context().close();
  });
} finally {
  await browser.close();
}

const plain = await chromium.launch({ executablePath, headless: true, args: [...flags, "--disable-gpu", "--disable-3d-apis"] });
try {
  await test("without WebGL the map is shown, and it is said why the surface is not", async () => {
    const page = await open(plain, url);
    await firstMap(page);
    assert.match(await page.textContent("#surface .message"), /no WebGL/);
    assert.ok((await seen(page, "#atlas canvas")) > 8, "the map is drawn");
    const box = await page.locator("#atlas canvas").boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
    await picture(page, "plain");
  });
} finally {
  await plain.close();
  server.kill();
  rmSync(folder, { recursive: true, force: true });
}
console.log(process.exitCode ? "some tests failed" : `${passed} passed`);
