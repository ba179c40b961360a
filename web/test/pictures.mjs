// Screenshots beside stored ones. Both are made so small that letters and edges blur: what is compared is what is where, and in
// what colour, not how a machine draws it.
//
//     STORE=1 node test/run.mjs PROGRAM MESH      takes what is seen as what is to be seen
import { existsSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const folder = fileURLToPath(new URL("pictures/", import.meta.url));
/** How many pixels a small picture has, at most. */
const PIXELS = 64_000;
/** The mean difference of a channel (of 255), and the share of the pixels that are off by more than FAR, that are put down to fonts and
 * drawing: the same page at another run differs by 0.1 and 0.000, with another colour by 4 and 0.1 at least. */
const MEAN = 1.5;
const FAR = 40;
const SHARE = 0.012;

/** Whether pictures are to be compared: with those that another version of the browser has drawn they are not. Says so. */
export function areComparable(version) {
  const path = `${folder}browser.txt`;
  if (process.env.STORE) {
    mkdirSync(folder, { recursive: true });
    writeFileSync(path, `${version}\n`);
  }
  const stored = existsSync(path) ? readFileSync(path, "utf8").trim() : "none";
  const is = stored === version;
  if (!is) console.log(`skipped: how the page looks (its pictures were drawn by Chromium ${stored}, this is ${version}; STORE=1 draws them anew)`);
  return is;
}

/** Compares what a page shows with what is stored under a name; says in what it differs, or nothing. */
export async function differs(page, name) {
  const shot = await small(page, (await page.screenshot()).toString("base64"));
  const path = `${folder}${name}.png`;
  if (process.env.STORE) {
    mkdirSync(folder, { recursive: true });
    writeFileSync(path, Buffer.from(shot, "base64"));
  }
  if (!existsSync(path)) return `${name} is not stored`;
  const { size, mean, share } = await distance(page, shot, readFileSync(path).toString("base64"));
  if (!size) return `${name} has another size`;
  return mean > MEAN || share > SHARE ? `${name} is off by ${mean.toFixed(2)} in the mean, ${(100 * share).toFixed(1)} % of it far` : "";
}

/** A picture made small, each pixel the mean of what it covers. */
async function small(page, png) {
  return page.evaluate(async ([png, pixels]) => {
    const image = new Image();
    image.src = `data:image/png;base64,${png}`;
    await image.decode();
    let [width, height] = [image.width, image.height];
    const most = Math.round(width * Math.min(1, Math.sqrt(pixels / (width * height))));
    const draw = (from) => {
      const one = document.createElement("canvas");
      [one.width, one.height] = [width, height];
      const context = one.getContext("2d");
      context.imageSmoothingQuality = "high";
      context.drawImage(from, 0, 0, width, height);
      return one;
    };
    let now = draw(image);
    // By halves: a browser looks at few pixels round about.
    while (width > most) {
      [width, height] = [Math.round(Math.max(width / 2, most)), Math.round(height / Math.min(2, width / most))];
      now = draw(now);
    }
    return now.toDataURL("image/png").split(",")[1];
  }, [png, PIXELS]);
}

/** How far two small pictures are from each other. */
async function distance(page, a, b) {
  return page.evaluate(async ([a, b, far]) => {
    const pixels = async (png) => {
      const image = new Image();
      image.src = `data:image/png;base64,${png}`;
      await image.decode();
      const canvas = document.createElement("canvas");
      [canvas.width, canvas.height] = [image.width, image.height];
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height);
    };
    const [p, q] = [await pixels(a), await pixels(b)];
    if (p.width !== q.width || p.height !== q.height) return { size: false };
    let [sum, off] = [0, 0];
    for (let k = 0; k < p.data.length; k += 4) {
      const apart = [0, 1, 2].map((i) => Math.abs(p.data[k + i] - q.data[k + i]));
      sum += apart[0] + apart[1] + apart[2];
      off += Number(Math.max(...apart) > far);
    }
    const count = p.data.length / 4;
    return { size: true, mean: sum / (3 * count), share: off / count };
  }, [a, b, FAR]);
}
