/** What mouse, touch and keys do: the rows of the page's help, and of docs/serve.md. */

export const HELP = [
  ["drag, arrow keys", "move"],
  ["wheel, pinch, double click, +, -", "zoom, from half of the whole picture to 32 times its pixels"],
  ["0, 1", "the whole picture; its own size"],
  ["Ellipses, e", "outline the Gaussians that are seen"],
  ["Compare, c", "a second stream or picture beside it, with a slider"],
  ["f", "flip: the first of both alone, then the second"],
  ["Difference, x", "the difference of both, amplified"],
  ["[, ]", "amplify the difference half or twice as much"],
  ["Open, o, dropping a file", "another file; two files are compared"],
  ["Theme, d", "dark or light"],
  ["?", "this help"],
];

/** Fills a dialog with them. */
export function fillHelp(dialog) {
  const rows = HELP.map(([keys, text]) => {
    const row = document.createElement("tr");
    row.append(cell("th", keys), cell("td", text));
    return row;
  });
  dialog.querySelector("table").replaceChildren(...rows);
}

function cell(kind, text) {
  return Object.assign(document.createElement(kind), { textContent: text });
}
