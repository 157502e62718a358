/** What other programs use of the package. */
export { decode, openDecoder } from "./decoder.js";
export { Scene } from "./scene.js";
export { SgiError } from "./errors.js";
export { showImages } from "./images.js";
