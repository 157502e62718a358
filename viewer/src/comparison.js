/** Two pictures on the page: a divider between them, their names, flipping, and their difference. */

import { FACTORS } from "./difference.js";

const STEP = 0.02; // of the width, for an arrow key
const FACTOR = 8; // of the difference, at first

export class Comparison {
  /** parts: the elements divider, left and right (the names of the sides), difference (a button). */
  constructor(scene, parts) {
    Object.assign(this, { scene, parts });
    this.factor = FACTOR;
    const { divider } = parts;
    divider.addEventListener("pointerdown", (event) => divider.setPointerCapture(event.pointerId));
    divider.addEventListener("pointermove", (event) => {
      if (divider.hasPointerCapture(event.pointerId)) this.splitAt(event.clientX / divider.parentElement.clientWidth);
    });
    divider.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -STEP, ArrowRight: STEP }[event.key];
      if (step) this.splitAt(scene.split + step);
    });
  }

  get isOn() {
    return this.scene.layers.length === 2;
  }

  /** Puts the divider at a share of the width. */
  splitAt(split) {
    this.scene.split = Math.min(1, Math.max(0, split));
    this.scene.dirty();
    this.show();
  }

  /** Shows the first picture alone, or the second where that is so. */
  flip() {
    if (!this.isOn) return;
    if (this.scene.difference) this.scene.showDifference(0);
    this.splitAt(this.scene.split === 1 ? 0 : 1);
  }

  toggleDifference() {
    if (!this.isOn) return;
    this.scene.showDifference(this.scene.difference ? 0 : this.factor);
    this.show();
  }

  /** Amplifies the difference by the next factor, or the one before. */
  amplify(step) {
    if (!this.scene.difference) return;
    this.factor = FACTORS[Math.min(FACTORS.length - 1, Math.max(0, FACTORS.indexOf(this.factor) + step))];
    this.scene.showDifference(this.factor);
    this.show();
  }

  /** Brings the page's elements to what the scene shows. */
  show() {
    const { scene, parts, isOn } = this;
    const { split, difference } = scene;
    const [first, second] = scene.layers.map(({ decoder }) => decoder.info.name);
    const isBeside = isOn && !difference;
    parts.divider.hidden = !isBeside;
    parts.divider.style.left = `${100 * split}%`;
    parts.divider.setAttribute("aria-valuenow", Math.round(100 * split));
    parts.left.hidden = !isOn;
    parts.right.hidden = !isBeside;
    parts.left.style.right = isBeside ? `${100 * (1 - split)}%` : "0";
    parts.right.style.left = `${100 * split}%`;
    parts.left.textContent = difference ? `${difference} × the difference of ${first} and ${second}` : first;
    parts.right.textContent = second ?? "";
    parts.difference.disabled = !isOn;
    parts.difference.setAttribute("aria-pressed", String(Boolean(difference)));
  }
}
