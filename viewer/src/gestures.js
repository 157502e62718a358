/** Pointer, touch, wheel and keys move a scene's camera. */

const STEP = 80; // screen pixels of an arrow key, before the device's ratio
const FACTOR = 1.25;

const KEYS = {
  ArrowLeft: (camera, step) => camera.pan(step, 0),
  ArrowRight: (camera, step) => camera.pan(-step, 0),
  ArrowUp: (camera, step) => camera.pan(0, step),
  ArrowDown: (camera, step) => camera.pan(0, -step),
  "+": (camera) => camera.zoom(FACTOR),
  "=": (camera) => camera.zoom(FACTOR),
  "-": (camera) => camera.zoom(1 / FACTOR),
  0: (camera) => camera.fit(),
  Home: (camera) => camera.fit(),
  1: (camera) => camera.zoomTo(1),
};

/** Has the canvas listen, and what lies over it pass the wheel on. Returns a function that ends it. */
export function listen(scene, canvas, over = []) {
  const pointers = new Map();
  const ratio = () => canvas.width / canvas.clientWidth;
  const place = (event) => {
    const box = canvas.getBoundingClientRect();
    return [(event.clientX - box.left) * ratio(), (event.clientY - box.top) * ratio()];
  };

  const down = (event) => {
    if (event.button > 0) return;
    canvas.setPointerCapture(event.pointerId);
    pointers.set(event.pointerId, place(event));
  };
  const move = (event) => {
    if (!pointers.has(event.pointerId)) return;
    const before = span([...pointers.values()]);
    pointers.set(event.pointerId, place(event));
    const after = span([...pointers.values()]);
    scene.move((camera) => {
      camera.pan(after.x - before.x, after.y - before.y);
      if (before.width > 0 && after.width > 0) camera.zoom(after.width / before.width, after.x, after.y);
    });
  };
  const up = (event) => pointers.delete(event.pointerId);
  const wheel = (event) => {
    event.preventDefault();
    const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
    scene.move((camera) => camera.zoom(2 ** (-event.deltaY * lines * (event.ctrlKey ? 0.01 : 0.0025)), ...place(event)));
  };
  const twice = (event) => scene.move((camera) => camera.zoom(event.shiftKey ? 0.5 : 2, ...place(event)));
  const key = (event) => {
    const act = KEYS[event.key];
    if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    scene.move((camera) => act(camera, STEP * ratio()));
  };

  const all = { pointerdown: down, pointermove: move, pointerup: up, pointercancel: up, wheel, dblclick: twice, keydown: key };
  for (const [name, listener] of Object.entries(all)) canvas.addEventListener(name, listener, { passive: false });
  for (const element of over) element.addEventListener("wheel", wheel, { passive: false });
  return () => {
    for (const element of over) element.removeEventListener("wheel", wheel);
    for (const [name, listener] of Object.entries(all)) canvas.removeEventListener(name, listener);
  };
}

/** The middle of the pointers, and how far two of them are apart. */
function span(places) {
  const x = places.reduce((sum, [across]) => sum + across, 0) / places.length;
  const y = places.reduce((sum, [, along]) => sum + along, 0) / places.length;
  const width = places.length > 1 ? Math.hypot(places[0][0] - places[1][0], places[0][1] - places[1][1]) : 0;
  return { x, y, width };
}
