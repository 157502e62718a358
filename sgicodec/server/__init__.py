"""An HTTP server of streams: files with ranges, IIIF Image API 3 and Deep Zoom. Needs the extra `serve`."""
