/** A bar as long as a round length in the picture: on the ground, under the microscope, else in its pixels. */

const UNITS = [
  [1e3, "km"],
  [1, "m"],
  [1e-2, "cm"],
  [1e-3, "mm"],
  [1e-6, "µm"],
  [1e-9, "nm"],
];

/**
 * {pixels: its length on the screen, text}. scale: screen pixels for each of the picture's; most: screen pixels that it
 * may take; metres: of a pixel of the picture, null where nothing says so.
 */
export function scaleBar(scale, most, metres) {
  const each = scale / (metres ?? 1);
  const length = roundDown(most / each);
  return { pixels: length * each, text: metres ? lengthText(length) : `${number(length)} px` };
}

/** The largest of …, 1, 2, 5, 10, 20, … that is not longer. */
function roundDown(length) {
  const power = 10 ** Math.floor(Math.log10(length) + 1e-9);
  const digit = [5, 2].find((each) => each * power <= length * (1 + 1e-9)) ?? 1;
  return digit * power;
}

function lengthText(metres) {
  const [unit, name] = UNITS.find(([unit]) => metres >= unit * (1 - 1e-9)) ?? UNITS.at(-1);
  return `${number(metres / unit)} ${name}`;
}

function number(value) {
  return String(Number(value.toPrecision(3)));
}
