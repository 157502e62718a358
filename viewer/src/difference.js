/** The difference of two pictures on a canvas, amplified by doubling: all browsers can add, not all have filters. */

export const FACTORS = [1, 2, 4, 8, 16, 32];

/** Leaves `factor` times the difference of what a context shows and of a second canvas, channel by channel. */
export function drawDifference(context, second, factor) {
  context.save();
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.globalCompositeOperation = "difference";
  context.drawImage(second, 0, 0);
  context.globalCompositeOperation = "lighter";
  for (let grown = 1; grown < factor; grown *= 2) context.drawImage(context.canvas, 0, 0);
  context.restore();
}
