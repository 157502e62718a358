import { createRoot } from "react-dom/client";
import "sgi-viewer/element";

/** A .sgi picture. */
export function Picture({ src, alt, sizes }) {
  return <sgi-image src={src} alt={alt} sizes={sizes} />;
}

createRoot(document.getElementById("root")).render(<Picture src="photo.sgi" alt="A photograph" sizes="96px" />);
