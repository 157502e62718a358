// A stream behind a file of GDAL, and what it says of itself.
#pragma once
#include <cpl_vsi.h>
#include <sgi.h>

#include <memory>

#include "described.hpp"

struct Source {
  struct CloseFile {
    void operator()(VSILFILE *file) const { VSIFCloseL(file); }
  };
  struct CloseStream {
    void operator()(sgi_stream *stream) const { sgi_close(stream); }
  };
  std::unique_ptr<VSILFILE, CloseFile> file;
  std::unique_ptr<sgi_stream, CloseStream> stream;  // which reads the file, and so goes first
  sgi_info info{};
  bool exact = false;
  Described described;

  Tags metadata(sgi_metadata kind) const {
    const void *bytes = nullptr;
    size_t size = 0;
    if (sgi_get_metadata(stream.get(), kind, &bytes, &size) != SGI_OK) return {nullptr, 0};
    return {bytes, size};
  }
  GDALDataType type() const {
    return info.sample == SGI_SAMPLE_U8 ? GDT_Byte : info.sample == SGI_SAMPLE_U16 ? GDT_UInt16 : GDT_Float32;
  }
  Layout layout() const {
    const bool is_colour = info.layout == SGI_LAYOUT_RGB || info.layout == SGI_LAYOUT_RGBA;
    const bool has_alpha = info.layout == SGI_LAYOUT_GRAY_ALPHA || info.layout == SGI_LAYOUT_RGBA;
    return {int(info.channels), is_colour, has_alpha};
  }
};

// Opens a stream, of which it keeps the file. Null, with an error of GDAL's, where it is none.
std::shared_ptr<Source> open_source(const char *name, VSILFILE *file);
