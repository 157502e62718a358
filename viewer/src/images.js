/** Has <img src="a.sgi"> show, by a service worker (service_worker.js). */

/** Registers the worker of a URL on the page's site, and loads again the images that were asked for before that. */
export async function showImages(url) {
  const container = navigator.serviceWorker;
  const controlled = new Promise((resolve) => {
    if (container.controller) resolve();
    else container.addEventListener("controllerchange", resolve, { once: true });
  });
  await container.register(url, { type: "module" });
  await controlled;
  for (const image of document.images) {
    if (/\.sgi($|[?#])/.test(image.src) && image.complete && !image.naturalWidth) image.src = `${image.src}`;
  }
}
