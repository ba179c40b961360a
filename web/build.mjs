// Builds the page: one file with script, style and the licences of what is inside. With --check it only says whether the
// committed file is what would be built.
import { build } from "esbuild";
import { readFileSync, writeFileSync } from "node:fs";
import { fileURLToPath } from "node:url";

const at = (path) => fileURLToPath(new URL(path, import.meta.url));
const text = (path) => readFileSync(at(path), "utf8");
const target = at("../cli/page/index.html");

const built = await build({
  entryPoints: [at("src/main.ts")],
  bundle: true,
  minify: true,
  format: "iife",
  target: "es2022",
  charset: "utf8",
  legalComments: "inline",
  write: false,
});
const style = await build({ entryPoints: [at("src/style.css")], minify: true, write: false });
const version = JSON.parse(text("node_modules/three/package.json")).version;
const licences = `The page is part of cones, MIT or Apache-2.0. Inside is three.js ${version}:\n\n${text("node_modules/three/LICENSE").trim()}\n`;
// Nothing inside may end the element early, and what is put in is no pattern.
const script = built.outputFiles[0].text.trim().replaceAll("</script", "<\\/script");
const page = text("src/page.html")
  .replace("<!--LICENCES-->", () => `<!--\n${licences}-->`)
  .replace("/*STYLE*/", () => style.outputFiles[0].text.trim())
  .replace("/*SCRIPT*/", () => script);

if (process.argv.includes("--check")) {
  if (readFileSync(target, "utf8") !== page) {
    console.error("cli/page/index.html is not what web/ builds: run npm run build there");
    process.exit(1);
  }
} else {
  writeFileSync(target, page);
  console.log(`${target}: ${Math.round(page.length / 1024)} KiB`);
}
