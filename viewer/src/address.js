/** The address follows the view, so that it can be shared and loaded again: #x,y,scale of the view's middle. */

const STILL = 250; // milliseconds: browsers refuse an address that changes with every frame

/** What stands behind # for a view; empty where the whole picture is seen. */
export function hashOf(camera) {
  if (camera.isFit) return "";
  const digits = camera.scale > 1 ? 2 : 0;
  const shown = (value) => Number(value.toFixed(digits));
  return `#${shown(camera.x)},${shown(camera.y)},${Number(camera.scale.toPrecision(5))}`;
}

/** The view of a hash, {x, y, scale}; null where it names none. */
export function viewOf(hash) {
  const numbers = hash.slice(1).split(",").map(Number);
  if (numbers.length !== 3 || !numbers.every(Number.isFinite) || !(numbers[2] > 0)) return null;
  const [x, y, scale] = numbers;
  return { x, y, scale };
}

/** Has the page's address follow a scene, and the scene an address that is changed by hand. Returns what restores. */
export function followAddress(scene) {
  let timer = 0;
  const write = () => {
    const { pathname, search, hash } = location;
    const next = hashOf(scene.camera);
    if (scene.decoder && next !== hash) history.replaceState(null, "", pathname + search + next);
  };
  scene.addEventListener("moved", () => {
    clearTimeout(timer);
    timer = setTimeout(write, STILL);
  });
  const restore = () => {
    const view = viewOf(location.hash);
    if (view && scene.decoder) scene.move((camera) => camera.lookAt(view));
  };
  addEventListener("hashchange", restore);
  return restore;
}
