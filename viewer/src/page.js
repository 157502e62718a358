/** The page: files come by dropping, choosing, or ?file=URL&other=URL&draw=auto|gpu|cpu; buttons, keys and the line below. */

import { megabytes } from "./bytes.js";
import { openDecoder } from "./decoder.js";
import { sentence } from "./errors.js";
import { listen } from "./gestures.js";
import { MODES } from "./gpu/stage.js";
import { Scene } from "./scene.js";

const part = (id) => document.getElementById(id);
const scene = new Scene(part("canvas"));
const opened = new Map(); // "first" or "second" -> number of the last opening
let chosenFor = "first";

listen(scene, part("canvas"));
globalThis.sgiViewer = { scene, open };

/** Opens a File or a URL as the picture, or as the "second" one beside it. */
async function open(source, where = "first") {
  const number = (opened.get(where) ?? 0) + 1;
  opened.set(where, number);
  say("");
  part("welcome").hidden = true;
  try {
    const decoder = await openDecoder(source);
    if (opened.get(where) !== number) return decoder.close();
    if (where === "second") scene.compare(decoder);
    else scene.open(decoder);
    showState();
    part("canvas").focus();
  } catch (error) {
    say(sentence(error));
    part("welcome").hidden = scene.layers.length > 0;
  }
}

function say(text) {
  part("message").textContent = text;
  part("message").hidden = !text;
}

function showState() {
  const [first, second] = scene.layers.map(({ decoder }) => decoder.info);
  part("name").textContent = second ? `${first.name} | ${second.name}` : first.name;
  document.title = first.name ? `${first.name} – sgi viewer` : "sgi viewer";
  part("divider").hidden = !second;
  part("compare").setAttribute("aria-pressed", String(Boolean(second)));
  part("ellipses").disabled = first.kind !== "stream";
  placeDivider(scene.split);
}

function showNumbers() {
  if (!scene.decoder) return;
  const { scale } = scene.camera;
  const tooMany = scene.ellipses?.total === null;
  part("ellipses").textContent = tooMany ? "Ellipses: zoom in" : "Ellipses";
  showDrawing();
  part("scale").textContent = scale >= 1 ? `${round(scale)}×` : `1/${round(1 / scale)}`;
  if (scene.decoder.info.kind === "server") {
    part("bytes").textContent = `${megabytes(scene.bytes)}, drawn by the server`;
    part("bytes").title = "This installation lacks the decoder's WebAssembly, or this browser has none.";
    return;
  }
  const share = (100 * scene.fetched) / scene.bytes;
  const fetched = scene.fetched ? `${megabytes(scene.fetched)} of ` : "";
  part("bytes").textContent = fetched + megabytes(scene.bytes) + (fetched ? ` (${round(share)} %)` : "");
}

/** Which of both draws and why; in the open, where it is not the one that was chosen. */
function showDrawing() {
  const { stage, drawnBy, why } = scene;
  const instead = stage.mode === "gpu" && drawnBy === "CPU" && why ? " instead of GPU" : "";
  part("drawing").textContent = `${stage.mode === "auto" ? "auto: " : ""}${drawnBy}${instead}`;
  part("drawing").title = `${why || "The GPU draws."} Drawn by the GPU or in workers (g)`;
}

function round(value) {
  return value < 10 ? Number(value.toFixed(2)) : Number(value.toFixed(value < 100 ? 1 : 0));
}

function showPlace(event) {
  if (!scene.decoder) return;
  const box = part("canvas").getBoundingClientRect();
  const ratio = part("canvas").width / box.width;
  const [x, y] = scene.camera.toPicture((event.clientX - box.left) * ratio, (event.clientY - box.top) * ratio);
  const { width, height } = scene.camera;
  const inside = x >= 0 && y >= 0 && x < width && y < height;
  const digits = scene.camera.scale > 2 ? 1 : 0;
  const shown = (value) => (digits ? value.toFixed(digits) : Math.floor(value));
  part("place").textContent = `${inside ? `${shown(x)}, ${shown(y)} of ` : ""}${width} × ${height}`;
}

function placeDivider(split) {
  scene.split = Math.min(1, Math.max(0, split));
  part("divider").style.left = `${100 * scene.split}%`;
  part("divider").setAttribute("aria-valuenow", Math.round(100 * scene.split));
  scene.dirty();
}

function choose(where) {
  chosenFor = where;
  part("file").value = "";
  part("file").click();
}

function compare() {
  if (scene.layers.length < 2) return choose("second");
  scene.compare(null);
  showState();
}

function toggleEllipses() {
  const shown = !scene.ellipses;
  part("ellipses").setAttribute("aria-pressed", String(shown));
  scene.showEllipses(shown);
}

function switchDrawing() {
  scene.stage.choose(MODES[(MODES.indexOf(scene.stage.mode) + 1) % MODES.length]);
}

function toggleTheme() {
  const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
  const now = document.documentElement.dataset.theme ?? (isDark ? "dark" : "light");
  document.documentElement.dataset.theme = now === "dark" ? "light" : "dark";
}

const actions = {
  fit: () => scene.move((camera) => camera.fit()),
  actual: () => scene.move((camera) => camera.zoomTo(1)),
  ellipses: toggleEllipses,
  compare,
  open: () => choose("first"),
  drawing: switchDrawing,
  theme: toggleTheme,
  choose: () => choose("first"),
};
for (const [id, act] of Object.entries(actions)) part(id).addEventListener("click", act);

const keys = { e: toggleEllipses, c: compare, o: actions.open, d: toggleTheme, g: switchDrawing };
addEventListener("keydown", (event) => {
  if (event.target.matches("input") || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key !== "e" || !part("ellipses").disabled) keys[event.key]?.();
});

part("divider").addEventListener("pointerdown", (event) => part("divider").setPointerCapture(event.pointerId));
part("divider").addEventListener("pointermove", (event) => {
  if (part("divider").hasPointerCapture(event.pointerId)) placeDivider(event.clientX / part("stage").clientWidth);
});
part("divider").addEventListener("keydown", (event) => {
  const step = { ArrowLeft: -0.02, ArrowRight: 0.02 }[event.key];
  if (step) placeDivider(scene.split + step);
});

part("file").addEventListener("change", () => open(part("file").files[0], chosenFor));
part("address").addEventListener("submit", (event) => {
  event.preventDefault();
  open(part("url").value);
});
addEventListener("dragover", (event) => {
  event.preventDefault();
  document.body.classList.add("dropping");
});
addEventListener("dragleave", () => document.body.classList.remove("dropping"));
addEventListener("drop", async (event) => {
  event.preventDefault();
  document.body.classList.remove("dropping");
  const [file, other] = event.dataTransfer.files;
  if (file) await open(file, event.shiftKey && scene.layers.length ? "second" : "first");
  if (other && scene.decoder) await open(other, "second");
});

part("canvas").addEventListener("pointermove", showPlace);
scene.addEventListener("moved", showNumbers);
scene.addEventListener("drawn", showNumbers);
scene.addEventListener("failed", ({ detail }) => say(sentence(detail)));

const query = new URLSearchParams(location.search);
scene.stage.choose(query.get("draw"));
if (query.get("file")) {
  await open(query.get("file"));
  if (query.get("other") && scene.decoder) await open(query.get("other"), "second");
}
