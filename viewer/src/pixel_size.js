/** How long the side of a pixel is, by what a stream's metadata says (docs/pictures.md): the width of pixels counts. */

const BYTES = { 1: 1, 2: 1, 3: 2, 4: 4, 5: 8, 7: 1, 12: 8 }; // of a value of each type of TIFF
const [ASCII, SHORT, RATIONAL, DOUBLE] = [2, 3, 5, 12];
const [DESCRIPTION, ACROSS, DOWN, UNIT] = [270, 282, 283, 296];
const [PIXEL_SCALE, TIE_POINTS, MATRIX, GEO_KEYS] = [33550, 33922, 34264, 34735];
const [MODEL, ANGULAR_UNIT, PROJECTED_CODE, LINEAR_UNIT] = [1024, 2054, 3072, 3076];
const [PROJECTED, GEOGRAPHIC, DEGREE, WEB_MERCATOR] = [1, 2, 9102, 3857];
const METRES = { 9001: 1, 9002: 0.3048, 9003: 1200 / 3937 }; // of linear units
const UNITS = { 2: 0.0254, 3: 0.01 }; // metres of an inch and of a centimetre
const RADIUS = 6378137; // of the Earth at the equator, metres
const MOST_MEASURED = 20e-6; // metres: coarser densities are what printers and cameras write, not measurements

/** Metres, or null where nothing says so. place and exif: TIFF structures (Uint8Array) or null. */
export function pixelSize(place, exif, { width, height }) {
  const tags = entries(place);
  return ofGround(tags, width, height) ?? ofSlide(entries(exif)) ?? ofDensity(tags) ?? ofDensity(entries(exif));
}

/** The values of the first directory by tag: numbers, of texts a string; empty for what is damaged. */
function entries(bytes) {
  const found = new Map();
  if (!bytes?.length) return found;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  try {
    const little = view.getUint16(0) === 0x4949;
    const start = view.getUint32(4, little);
    for (let number = view.getUint16(start, little), at = start + 2; number > 0; number--, at += 12) {
      const [tag, type, count] = [view.getUint16(at, little), view.getUint16(at + 2, little), view.getUint32(at + 4, little)];
      const each = BYTES[type];
      if (!each || count * each > bytes.length) continue;
      const first = count * each > 4 ? view.getUint32(at + 8, little) : at + 8;
      found.set(tag, values(view, type, first, count, little));
    }
  } catch (error) {
    if (!(error instanceof RangeError)) throw error; // an offset beyond the end
  }
  return found;
}

function values(view, type, first, count, little) {
  const each = BYTES[type];
  if (type === ASCII) return new TextDecoder("latin1").decode(new Uint8Array(view.buffer, view.byteOffset + first, count));
  return Array.from({ length: count }, (_, number) => {
    const at = first + number * each;
    if (type === SHORT) return view.getUint16(at, little);
    if (type === DOUBLE) return view.getFloat64(at, little);
    if (type === RATIONAL) return view.getUint32(at, little) / view.getUint32(at + 4, little);
    return each === 4 ? view.getUint32(at, little) : view.getUint8(at);
  });
}

/** Metres on the ground, in the middle of the picture; null without coordinates in a unit that is known. */
function ofGround(tags, width, height) {
  const place = placement(tags, width, height);
  const keys = geoKeys(tags.get(GEO_KEYS) ?? []);
  if (!place) return null;
  if (keys.get(MODEL) === GEOGRAPHIC) {
    const isDegree = (keys.get(ANGULAR_UNIT) ?? DEGREE) === DEGREE;
    return isDegree ? positive(place.across * (Math.PI / 180) * RADIUS * Math.cos((place.y * Math.PI) / 180)) : null;
  }
  if (keys.get(MODEL) !== PROJECTED) return null;
  const stretched = keys.get(PROJECTED_CODE) === WEB_MERCATOR ? Math.cosh(place.y / RADIUS) : 1;
  return positive((place.across * METRES[keys.get(LINEAR_UNIT)]) / stretched);
}

/** {across: width of a pixel, y: of the picture's middle} in the units of the coordinates; null where none are stated. */
function placement(tags, width, height) {
  const matrix = tags.get(MATRIX);
  if (matrix?.length >= 8) {
    return { across: Math.hypot(matrix[0], matrix[4]), y: (matrix[4] * width + matrix[5] * height) / 2 + matrix[7] };
  }
  const [scale, tie] = [tags.get(PIXEL_SCALE), tags.get(TIE_POINTS)];
  if (!(scale?.length >= 2 && tie?.length >= 6)) return null;
  return { across: scale[0], y: tie[4] - (height / 2 - tie[1]) * scale[1] };
}

/** Keys whose value is a short. */
function geoKeys(shorts) {
  const found = new Map();
  for (let at = 4; at + 3 < shorts.length; at += 4) if (shorts[at + 1] === 0) found.set(shorts[at], shorts[at + 3]);
  return found;
}

/** By the description of a slide, as Aperio's scanners write it. */
function ofSlide(tags) {
  const stated = /\bMPP\s*=\s*([0-9.]+)/.exec(tags.get(DESCRIPTION) ?? "");
  return stated && positive(Number(stated[1]) / 1e6);
}

function ofDensity(tags) {
  const [[across] = [], [down] = [], [unit] = [2]] = [tags.get(ACROSS), tags.get(DOWN), tags.get(UNIT)];
  const size = positive(UNITS[unit] / across);
  return size && down > 0 && size < MOST_MEASURED ? size : null;
}

function positive(value) {
  return value > 0 && value < Infinity ? value : null;
}
