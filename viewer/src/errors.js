/** A failure that a reader of the page can understand: its message is a sentence. */
export class SgiError extends Error {
  constructor(message) {
    super(message);
    this.name = "SgiError";
  }
}

/** The sentence of any failure. */
export function sentence(error) {
  const text = String(error?.message ?? error).trim();
  const upper = text.charAt(0).toUpperCase() + text.slice(1);
  return /[.!?]$/.test(upper) ? upper : `${upper}.`;
}
