/** The outlines of Gaussians: each ellipse lies one standard deviation from the centre. */

const NUMBERS = 5; // x, y, half axes a and b in pixels, angle

export function drawEllipses(context, camera, { shapes, count }) {
  const [left, top] = camera.toScreen(0, 0);
  context.setTransform(camera.scale, 0, 0, camera.scale, left, top);
  context.beginPath();
  for (let at = 0; at < count * NUMBERS; at += NUMBERS) {
    const [x, y, a, b, angle] = shapes.subarray(at, at + NUMBERS);
    context.moveTo(x + a * Math.cos(angle), y + a * Math.sin(angle));
    context.ellipse(x, y, a, b, angle, 0, 2 * Math.PI);
  }
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.lineWidth = 3;
  context.strokeStyle = "rgb(0 0 0 / 35%)";
  context.stroke();
  context.lineWidth = 1;
  context.strokeStyle = "rgb(255 230 80 / 90%)";
  context.stroke();
}
