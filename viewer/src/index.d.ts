/** A failure whose message is a sentence for the reader of a page. */
export class SgiError extends Error {}

export interface PictureInfo {
  width: number;
  height: number;
  name: string;
  kind: "stream" | "picture" | "server";
  bytes: number;
  /** The side of a pixel in metres, on the ground or under the microscope; null where the stream does not say it. */
  pixelMetres?: number | null;
}

/** A part of a picture, in its pixels, and how many pixels it is drawn with. */
export interface View {
  x: number;
  y: number;
  width: number;
  height: number;
  columns: number;
  rows: number;
}

export interface Job<T> {
  promise: Promise<T>;
  cancel(): void;
}

/** Draws any part of a picture at any scale. */
export interface Decoder {
  readonly info: PictureInfo;
  /** Bytes that came over the network so far. */
  readonly fetched: number;
  /** Jobs with lower priorities come first. */
  draw(view: View, priority: number): Job<ImageBitmap>;
  close(): void;
}

/** Opens a stream, or another picture that the browser reads. Rejects with an SgiError. */
export function openDecoder(source: string | Blob): Promise<Decoder>;

/** A picture as an ImageBitmap, with `width` pixels across; without, as many as it has. Decoded in the page's workers. */
export function decode(source: string | Blob, options?: { width?: number }): Promise<ImageBitmap>;

export interface Camera {
  x: number;
  y: number;
  scale: number;
  readonly columns: number;
  readonly rows: number;
  readonly width: number;
  readonly height: number;
  fit(): void;
  show(region: { x: number; y: number; width: number; height: number }): void;
  zoomTo(scale: number): void;
  /** Shows a point of the picture in the middle. */
  lookAt(view: { x: number; y: number; scale: number }): void;
}

/** Shows a picture on a canvas. Events: "moved", "drawn", "failed" (detail: the error). */
export class Scene extends EventTarget {
  constructor(canvas: HTMLCanvasElement);
  readonly camera: Camera;
  readonly isDone: boolean;
  open(decoder: Decoder): void;
  /** Shows a second picture to the right of the split; null: none. */
  compare(decoder: Decoder | null): void;
  /** Shows the difference of both pictures, `factor` times as large (a power of two); 0: shows them side by side. */
  showDifference(factor: number): void;
  move(change: (camera: Camera) => void): void;
  close(): void;
}

/** Has `<img src="a.sgi">` show: registers the service worker of a URL on the page's own site. */
export function showImages(url: string | URL): Promise<void>;
