/** The element <sgi-image src alt sizes>, which importing this module defines. Events: "load", "error". */
export class SgiImage extends HTMLElement {
  src: string;
}

declare global {
  interface HTMLElementTagNameMap {
    "sgi-image": SgiImage;
  }
}
