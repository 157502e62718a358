/** Which part of the picture the screen shows: the picture's point in the middle, and screen pixels for each of its. */

export const MOST_ENLARGED = 32;

export class Camera {
  constructor() {
    this.x = this.y = 0;
    this.scale = 1;
    this.columns = this.rows = 1; // of the screen, in its own pixels
    this.width = this.height = 1; // of the picture
  }

  /** The scale at which the whole picture is seen. */
  get fitting() {
    return Math.min(this.columns / this.width, this.rows / this.height);
  }

  get least() {
    return Math.min(this.fitting, 1) / 2;
  }

  fit() {
    this.scale = Math.min(this.fitting, MOST_ENLARGED);
    this.x = this.width / 2;
    this.y = this.height / 2;
  }

  /** Whether it shows the picture as `fit` does. */
  get isFit() {
    const scale = Math.min(this.fitting, MOST_ENLARGED);
    const isWhole = Math.abs(this.scale / scale - 1) < 1e-6;
    return isWhole && Math.abs(this.x - this.width / 2) * scale < 1 && Math.abs(this.y - this.height / 2) * scale < 1;
  }

  /** Shows a point of the picture in the middle, at a scale. */
  lookAt({ x, y, scale }) {
    this.scale = Math.min(MOST_ENLARGED, Math.max(this.least, scale));
    Object.assign(this, { x, y });
    this.hold();
  }

  toScreen(x, y) {
    return [(x - this.x) * this.scale + this.columns / 2, (y - this.y) * this.scale + this.rows / 2];
  }

  toPicture(column, row) {
    return [(column - this.columns / 2) / this.scale + this.x, (row - this.rows / 2) / this.scale + this.y];
  }

  /** Moves the picture by pixels of the screen. */
  pan(columns, rows) {
    this.x -= columns / this.scale;
    this.y -= rows / this.scale;
    this.hold();
  }

  /** Enlarges by a factor, so that what is at a point of the screen stays there. */
  zoom(factor, column, row) {
    this.zoomTo(this.scale * factor, column, row);
  }

  zoomTo(scale, column = this.columns / 2, row = this.rows / 2) {
    const [x, y] = this.toPicture(column, row);
    this.scale = Math.min(MOST_ENLARGED, Math.max(this.least, scale));
    const [nx, ny] = this.toPicture(column, row);
    this.x += x - nx;
    this.y += y - ny;
    this.hold();
  }

  /** Shows a region of the picture as large as the screen allows. */
  show({ x, y, width, height }) {
    this.scale = Math.min(MOST_ENLARGED, this.columns / width, this.rows / height);
    this.x = x + width / 2;
    this.y = y + height / 2;
  }

  hold() {
    this.x = Math.min(this.width, Math.max(0, this.x));
    this.y = Math.min(this.height, Math.max(0, this.y));
  }

  /** The same for the same view. */
  get key() {
    const { x, y, scale, columns, rows } = this;
    return `${x},${y},${scale},${columns},${rows}`;
  }

  /** The region that is seen, inside the picture: {x, y, width, height}. */
  get seen() {
    const [left, top] = this.toPicture(0, 0);
    const x = Math.min(this.width, Math.max(0, left));
    const y = Math.min(this.height, Math.max(0, top));
    const width = Math.max(0, Math.min(this.width, left + this.columns / this.scale) - x);
    const height = Math.max(0, Math.min(this.height, top + this.rows / this.scale) - y);
    return { x, y, width, height };
  }
}
