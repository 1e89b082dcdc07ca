// `node build.mjs` writes what the Python package carries; `--test` writes the tests as files that Node runs.
import { readdirSync, readFileSync } from "node:fs";
import { build } from "esbuild";

const home = "../src/miburi/report/templates";
if (process.argv.includes("--test")) {
  const entryPoints = readdirSync("test").map((name) => `test/${name}`);
  await build({ entryPoints, outdir: "build", bundle: true, platform: "node", format: "esm", outExtension: { ".js": ".mjs" } });
} else {
  const licence = readFileSync("node_modules/uplot/LICENSE", "utf8").trim();
  const banner = `/*! This file is built from web/src by \`npm run build\`. It holds uPlot:\n${licence}\n*/`;
  await build({
    entryPoints: ["src/page.ts", "src/page.css"],
    outdir: home,
    bundle: true,
    minify: true,
    charset: "utf8",
    format: "iife",
    target: ["es2022"],
    legalComments: "none",
    banner: { js: banner },
  });
}
