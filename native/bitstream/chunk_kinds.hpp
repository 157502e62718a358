// The kinds of chunks (docs/format.md, "File"): readers and reports of sizes go by this table.
#pragma once
#include <string>

namespace sgi {

struct ChunkKind {
  char letter;
  const char *name;      // what people call it
  bool is_once;          // whether a file has at most one
  const char *metadata;  // which field of `Metadata` in Python travels in it; nullptr for none
};

// In the order in which they are written.
constexpr ChunkKind kChunkKinds[] = {
    {'H', "header", true, nullptr},   {'s', "software", true, nullptr}, {'i', "ICC profile", true, "icc"},
    {'c', "EXIF", true, "exif"},      {'x', "XMP", true, "xmp"},        {'g', "place", true, "geo"},
    {'o', "overview", true, nullptr}, {'r', "residual", true, nullptr}, {'T', "tile", false, nullptr},
    {'X', "index", true, nullptr},    {'E', "end mark", true, nullptr},
};

// Letters of all of them but header and end mark, which are always known; an overview has no overview and no residual.
inline std::string known_chunks(bool is_overview = false) {
  std::string letters;
  for (const ChunkKind &kind : kChunkKinds)
    if (kind.letter != 'H' && kind.letter != 'E' && !(is_overview && (kind.letter == 'o' || kind.letter == 'r')))
      letters += kind.letter;
  return letters;
}

}  // namespace sgi
