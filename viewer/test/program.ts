// What package.test.js has TypeScript check: the types of the package, as a program uses them.
import { Scene, SgiError, decode, openDecoder } from "sgi-viewer";
import { decode as decodePixels } from "sgi-viewer/node";
import { SgiImage } from "sgi-viewer/element";
import { register } from "sgi-viewer/openseadragon";

const scene = new Scene(document.querySelector("canvas")!);
try {
  const decoder = await openDecoder("city.sgi");
  scene.open(decoder);
  const thumbnail: ImageBitmap = await decode("city.sgi", { width: 200 });
  const pixels: Uint8ClampedArray = (await decodePixels("city.sgi", { width: thumbnail.width })).data;
  const bitmap: ImageBitmap = await decoder.draw({ x: 0, y: 0, width: 8, height: 8, columns: 4, rows: 4 }, 0).promise;
  scene.move((camera) => camera.show({ x: 0, y: 0, width: Math.min(pixels.length, bitmap.width), height: bitmap.height }));
  const source = new (register({}))({ url: "city.sgi" });
  const image: SgiImage = document.createElement("sgi-image");
  image.src = "city.sgi";
  // @ts-expect-error a number is no source
  await openDecoder(source === null ? 1 : 2);
} catch (error) {
  if (error instanceof SgiError) console.log(error.message);
}
export {};
