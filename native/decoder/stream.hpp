// An opened stream: any region at any scale.
#pragma once
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/isa.hpp"
#include "bitstream/stream_reader.hpp"
#include "bitstream/tile.hpp"
#include "decoder/view.hpp"

namespace sgi {

struct DecoderSettings {
  int threads = 0;  // 0: one for each core
  Isa isa = Isa::portable;
  int64_t cache_bytes = int64_t(1) << 28;  // what decoded tiles may take
};

// How samples are stored: as floats, nominally 0 ... 1 and not clipped, or as samples of a type.
enum class Output { values, u8, u16, f32 };

// What all tiles hold together.
struct Survey {
  int64_t seeds;
  std::array<double, kParts> part_bytes;
  double mask_bytes;
  uint32_t symbol_crc;
  int64_t texture_cells[3];  // of sides 8, 16, 32
};

// Several threads may use one at once; they take turns.
class Stream {
 public:
  Stream(std::unique_ptr<ByteSource> source, const DecoderSettings &settings);
  ~Stream();

  const StreamReader &chunks() const;
  const Header &header() const;

  // Fills out [rows, columns, C], rows `stride` bytes apart, with rows top ... top + rows - 1 of a view. What lies
  // outside the picture is nodata, else 0. exact: never from the overview. dither: of samples of eight bits where the
  // source had more.
  void draw(const PictureView &view, int64_t top, int64_t rows, Output output, bool exact, bool dither, void *out,
            int64_t stride);
  Survey survey();
  bool has_overview() const;
  Stream &overview();  // throws Error (usage) where there is none

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace sgi
