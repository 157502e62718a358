/** A service worker by which <img src="a.sgi"> shows: it decodes what images ask for, and answers with PNG. */

import { loadModule } from "./module.js";
import { decodeHere } from "./whole.js";

addEventListener("install", () => skipWaiting());
addEventListener("activate", (event) => event.waitUntil(clients.claim()));
addEventListener("fetch", (event) => {
  const { destination, url } = event.request;
  if (destination === "image" && new URL(url).pathname.endsWith(".sgi")) event.respondWith(picture(new URL(url)));
});

/** ?width=N asks for a picture of N pixels across. A failure shows as one of the network. */
async function picture(url) {
  try {
    const [module, answer] = await Promise.all([loadModule(), fetch(url)]);
    if (!answer.ok) return answer;
    const width = Number(url.searchParams.get("width")) || undefined;
    const { width: columns, height, data } = decodeHere(module, new Uint8Array(await answer.arrayBuffer()), width);
    const canvas = new OffscreenCanvas(columns, height);
    canvas.getContext("2d").putImageData(new ImageData(data, columns, height), 0, 0);
    return new Response(await canvas.convertToBlob());
  } catch (error) {
    console.error(`${url}: ${error.message}`);
    return Response.error();
  }
}
