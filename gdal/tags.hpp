// Tags of TIFF without a picture, as they travel with a stream, as a file of one black pixel that GDAL opens.
#pragma once
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <string>
#include <vector>

struct Layout {
  int bands;
  bool is_colour, has_alpha;  // whether the first bands are red, green and blue, and the last one alpha
};

// The file: it has the bands of a layout, and of the tags in the first directory those that are `wanted`. Values, and
// directories that a tag points to, stay where they are. Nothing of what is no directory of TIFF.
std::vector<uint8_t> as_tiff(const uint8_t *tags, size_t size, const Layout &layout,
                             std::initializer_list<uint16_t> wanted);

// A tag's text in such a file; empty if it has none.
std::string text_of(const std::vector<uint8_t> &tiff, uint16_t tag);
