#include "bitstream/residual_layer.hpp"

#include "base/crc32.hpp"
#include "base/error.hpp"
#include "bitstream/range_decoder.hpp"
#include "bitstream/varint.hpp"

namespace sgi {

namespace {

constexpr size_t kCrcBytes = 4;

[[noreturn]] void corrupt(const char *text) { throw Error(Fault::corrupt, std::string("residual layer: ") + text); }

int64_t count_of(const Header &header) { return residual_blocks(header.width) * residual_blocks(header.height); }

}  // namespace

int64_t longest_residual_table(const Header &header) {
  return kMaxVarintBytes + count_of(header) * int64_t(kMaxVarintBytes + kCrcBytes);
}

ResidualTable read_residual_table(const Header &header, Bytes start, int64_t length) {
  if (header.sample_type == SampleType::f32) corrupt("the picture has floats");
  if (length < count_of(header) * int64_t(1 + kCrcBytes)) corrupt("it is too short for the blocks of the picture");
  size_t at = 0;
  const int64_t max_error = decode_varint(start, at);
  if (max_error >= int64_t(largest_of(header.sample_type))) corrupt("its greatest error is no less than any sample");
  ResidualTable table{int32_t(max_error), {}};
  table.blocks.resize(size_t(count_of(header)));
  for (ResidualTable::Block &block : table.blocks) {
    block.bytes = decode_varint(start, at);
    if (block.bytes > length || start.size - at < kCrcBytes) corrupt("a block ends behind it");
    for (size_t i = 0; i < kCrcBytes; ++i) block.crc |= uint32_t(start.data[at++]) << (8 * i);
  }
  auto offset = int64_t(at);
  for (ResidualTable::Block &block : table.blocks) {
    block.offset = offset;
    offset += block.bytes;
  }
  if (offset != length) corrupt("its blocks do not fill it");
  return table;
}

ResidualShape residual_shape(const Header &header, int64_t width, int64_t height, int32_t max_error) {
  const bool is_rgb = header.channels == ChannelLayout::rgb || header.channels == ChannelLayout::rgba;
  return {width,    height, header.spec.channels, is_rgb, header.alpha(), int32_t(largest_of(header.sample_type)),
          max_error};
}

void record_residual(const ResidualShape &shape, Isa isa, const uint16_t *drawn, uint16_t *samples, BitRecorder &bits) {
  ResidualCoding<BitRecorder>(shape, kernel_for<PredictorKernel>(isa), bits).code(samples, drawn);
}

void decode_residual(const ResidualShape &shape, Isa isa, Bytes bytes, uint32_t crc, const uint16_t *drawn,
                     uint16_t *samples) {
  RangeDecoder decoder(bytes.data, int64_t(bytes.size));
  BitReader bits(decoder);
  if (!ResidualCoding<BitReader>(shape, kernel_for<PredictorKernel>(isa), bits).code(samples, drawn))
    corrupt("the samples of a block do not decode");
  if (!decoder.maybe_exhausted()) corrupt("bytes are left over behind the samples of a block");
  const auto count = size_t(shape.width * shape.height * shape.channels);
  if (crc32({reinterpret_cast<const uint8_t *>(samples), count * sizeof *samples}) != crc)
    corrupt("the samples of a block are not those that were written");
}

}  // namespace sgi
