/** The package as others get it: packed, installed in a new project, built by bundlers, and seen in Chromium. */

import assert from "node:assert/strict";
import { execFileSync, spawnSync } from "node:child_process";
import { copyFileSync, mkdtempSync, readdirSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { launch, pageOf, shot } from "./browser.js";
import { GOLDEN, ROOT, decoded } from "./command.js";
import { farthest } from "./pixels.js";
import { readPng, rgba } from "./png.js";
import { serve } from "./server.js";

const VIEWER = join(ROOT, "viewer");
const NAME = "rgb8-texture.sgi";
const ASSETS = ["worker=sgi-viewer/worker", "sgi-worker=sgi-viewer/service-worker", "wasm/sgi=sgi-viewer/sgi.wasm", "wasm/sgi-scalar=sgi-viewer/sgi-scalar.wasm"];
const PAGE = `<!doctype html><meta charset="utf-8"><link rel="icon" href="data:,">
<style>body { margin: 0; } canvas { display: block; width: 192px; height: 128px; }</style>
<canvas id="picture"></canvas>`;
const SCRIPT = `import { Scene, openDecoder } from "sgi-viewer";
const scene = new Scene(document.getElementById("picture"));
scene.open(await openDecoder("/files/${NAME}"));
globalThis.sgiViewer = { scene };
`;

let browser, project;

before(async () => {
  project = mkdtempSync(join(tmpdir(), "sgi-project-"));
  const npm = (...args) => execFileSync("npm", [...args, "--silent"], { cwd: project }).toString().trim();
  writeFileSync(join(project, "package.json"), '{"type": "module", "private": true}');
  npm("install", "--offline", "--no-audit", "--no-fund", `./${npm("pack", VIEWER)}`);
  writeFileSync(join(project, "main.js"), SCRIPT);
  writeFileSync(join(project, "index.html"), `${PAGE}<script type="module" src="./main.js"></script>`);
  browser = await launch();
});

after(async () => {
  await browser?.close();
  rmSync(project, { recursive: true });
});

/** Runs a program of viewer/node_modules in the project. */
function run(program, ...args) {
  execFileSync(join(VIEWER, "node_modules/.bin", program), args, { cwd: project, stdio: ["ignore", "ignore", "inherit"], env: { ...process.env, NODE_PATH: join(VIEWER, "node_modules") } });
}

function esbuild(out, ...args) {
  run("esbuild", ...args, ...ASSETS, "--bundle", "--format=esm", "--loader:.wasm=copy", `--outdir=${out}`, "--log-level=warning");
}

const bundlers = {
  vite: (out) => run("vite", "build", "--base=./", `--outDir=${out}`, "--logLevel=warn"),
  webpack: async (out) => {
    const { default: webpack } = await import("webpack");
    const path = join(project, out);
    const stats = await new Promise((resolve, reject) => {
      const options = { context: project, mode: "production", entry: "./main.js", output: { path }, performance: { hints: false } };
      webpack(options, (error, result) => (error ? reject(error) : resolve(result)));
    });
    assert.deepEqual(stats.toJson({ all: false, errors: true, warnings: true }), { errors: [], warnings: [] });
  },
  esbuild: (out) => esbuild(out, "main.js"),
};

for (const [name, build] of Object.entries(bundlers)) {
  test(`${name}: a page that is built shows what sgi decode draws`, async (context) => {
    await build(name);
    if (name !== "vite") writeFileSync(join(project, name, "index.html"), `${PAGE}<script type="module" src="./main.js"></script>`);
    const server = await serve({ "/files/": GOLDEN, "/app/": join(project, name) });
    context.after(() => server.close());
    const page = await pageOf(browser, `${server.address}/app/`);
    await page.waitForFunction(() => globalThis.sgiViewer?.scene.isDone, null, { polling: 50 });
    const expected = decoded(join(GOLDEN, NAME), "--no-dither");
    assert.ok(farthest(await shot(page, expected.width, expected.height), rgba(expected)) <= 1);
    assert.ok([...server.sent.keys()].some((path) => path.startsWith("/app/") && path.endsWith(".wasm")));
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
}

const DEMOS = {
  plain: () => copyFileSync(join(VIEWER, "demo/plain.html"), join(project, "index.html")),
  react: (out) => {
    copyFileSync(join(VIEWER, "demo/react.jsx"), join(project, "react.jsx"));
    esbuild(out, "react.jsx", "--jsx=automatic", "--define:process.env.NODE_ENV=\"production\"");
    writeFileSync(join(project, out, "index.html"), '<link rel="icon" href="data:,"><div id="root"></div><script type="module" src="react.js"></script>');
  },
};

test("esbuild: an image by the service worker", async (context) => {
  writeFileSync(join(project, "images.js"), 'import { showImages } from "sgi-viewer";\nawait showImages("sgi-worker.js");\n');
  esbuild("images", "images.js");
  copyFileSync(join(GOLDEN, NAME), join(project, "images/photo.sgi"));
  writeFileSync(join(project, "images/index.html"), '<link rel="icon" href="data:,"><img src="photo.sgi"><script type="module" src="images.js"></script>');
  const server = await serve({ "/": join(project, "images") });
  context.after(() => server.close());
  const page = await pageOf(browser, `${server.address}/`);
  await page.waitForFunction(() => document.images[0].naturalWidth);
  const found = readPng(await page.locator("img").screenshot());
  assert.ok(farthest(rgba(found), rgba(decoded(join(GOLDEN, NAME), "--no-dither"))) <= 1);
  assert.deepEqual(page.errors, []);
  await page.context().close();
});

for (const [name, build] of Object.entries(DEMOS)) {
  test(`demo ${name}: an element shows the picture`, async (context) => {
    build(name);
    const folder = name === "plain" ? project : join(project, name);
    copyFileSync(join(GOLDEN, NAME), join(folder, "photo.sgi"));
    const server = await serve({ "/": folder });
    context.after(() => server.close());
    const page = await pageOf(browser, `${server.address}/`);
    await page.waitForFunction(() => document.querySelector("sgi-image")?.shown);
    const found = readPng(await page.locator("sgi-image").screenshot());
    assert.ok(farthest(rgba(found), rgba(decoded(join(GOLDEN, NAME), "--scale", "1/2", "--no-dither"))) <= 1);
    assert.deepEqual(page.errors, []);
    await page.context().close();
  });
}

test("types: a program in TypeScript", () => {
  copyFileSync(join(VIEWER, "test/program.ts"), join(project, "program.ts"));
  run("tsc", "--noEmit", "--strict", "--target", "es2022", "--module", "esnext", "--moduleResolution", "bundler", "program.ts");
});

test("packing without the decoder is refused", () => {
  const folder = mkdtempSync(join(tmpdir(), "sgi-unbuilt-"));
  for (const name of ["package.json", "prepack.js"]) copyFileSync(join(VIEWER, name), join(folder, name));
  const { status, stderr } = spawnSync("npm", ["pack"], { cwd: folder, encoding: "utf8" });
  assert.notEqual(status, 0);
  assert.match(stderr, /sgi-viewer cannot be packed: .* missing\. Run `make viewer` first\./);
  assert.ok(!readdirSync(folder).some((name) => name.endsWith(".tgz")));
  rmSync(folder, { recursive: true });
});
