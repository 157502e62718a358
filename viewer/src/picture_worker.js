/** A worker that reads and draws a picture which the browser can read: it answers as worker.js does. */

let picture;

self.onmessage = async ({ data: { job, task, place, view } }) => {
  try {
    const [answer, moved] = task === "open" ? await opened(place) : drawn(view);
    self.postMessage({ job, answer, fetched: 0 }, moved);
  } catch (error) {
    self.postMessage({ job, error: String(error?.message ?? error), fetched: 0 });
  }
};

async function opened(blob) {
  picture = await createImageBitmap(blob);
  return [{ width: picture.width, height: picture.height }, []];
}

function drawn({ x, y, width, height, columns, rows }) {
  const canvas = new OffscreenCanvas(columns, rows);
  const context = canvas.getContext("2d");
  context.imageSmoothingQuality = "high";
  const [sx, sy] = [columns / width, rows / height];
  context.setTransform(sx, 0, 0, sy, -x * sx, -y * sy);
  context.drawImage(picture, 0, 0);
  const bitmap = canvas.transferToImageBitmap();
  return [bitmap, [bitmap]];
}
