/** Adds SgiTileSource to OpenSeadragon, which then knows {type: "sgi", url} and {type: "sgi", file}. Returns the class. */
export function register(OpenSeadragon: object): new (options: { url?: string; file?: Blob }) => object;
