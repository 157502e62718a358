/**
 * The page: files come by dropping, choosing, or ?file=URL&other=URL#x,y,scale; buttons and keys act on the scene.
 */

import { followAddress } from "./address.js";
import { Comparison } from "./comparison.js";
import { openDecoder } from "./decoder.js";
import { sentence } from "./errors.js";
import { listen } from "./gestures.js";
import { fillHelp } from "./help.js";
import { Scene } from "./scene.js";
import { StatusLine } from "./status_line.js";

const part = (id) => document.getElementById(id);
const parts = (...ids) => Object.fromEntries(ids.map((id) => [id, part(id)]));
const scene = new Scene(part("canvas"));
const comparison = new Comparison(scene, parts("divider", "left", "right", "difference"));
const restore = followAddress(scene);
const opened = new Map(); // "first" or "second" -> number of the last opening
let chosenFor = "first";

new StatusLine(scene, parts("canvas", "bar", "ellipses", "scale", "bytes", "place"));
listen(scene, part("canvas"), [part("divider")]);
fillHelp(part("help"));
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
  part("compare").setAttribute("aria-pressed", String(Boolean(second)));
  part("ellipses").disabled = first.kind !== "stream";
  comparison.show();
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

function toggleTheme() {
  const isDark = matchMedia("(prefers-color-scheme: dark)").matches;
  const now = document.documentElement.dataset.theme ?? (isDark ? "dark" : "light");
  document.documentElement.dataset.theme = now === "dark" ? "light" : "dark";
}

function help() {
  if (part("help").open) part("help").close();
  else part("help").showModal();
}

const actions = {
  fit: () => scene.move((camera) => camera.fit()),
  actual: () => scene.move((camera) => camera.zoomTo(1)),
  ellipses: toggleEllipses,
  compare,
  difference: () => comparison.toggleDifference(),
  open: () => choose("first"),
  theme: toggleTheme,
  choose: () => choose("first"),
  ask: help,
};
for (const [id, act] of Object.entries(actions)) part(id).addEventListener("click", act);

const keys = {
  e: toggleEllipses,
  c: compare,
  f: () => comparison.flip(),
  x: actions.difference,
  "[": () => comparison.amplify(-1),
  "]": () => comparison.amplify(1),
  o: actions.open,
  d: toggleTheme,
  "?": help,
};
addEventListener("keydown", (event) => {
  if (event.target.matches("input") || event.ctrlKey || event.metaKey || event.altKey) return;
  if (event.key !== "e" || !part("ellipses").disabled) keys[event.key]?.();
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

scene.addEventListener("failed", ({ detail }) => say(sentence(detail)));

const query = new URLSearchParams(location.search);
if (query.get("file")) {
  await open(query.get("file"));
  restore();
  if (query.get("other") && scene.decoder) await open(query.get("other"), "second");
}
