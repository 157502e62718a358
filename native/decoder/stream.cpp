#include "decoder/stream.hpp"

#include <algorithm>
#include <exception>
#include <string>

#include "base/crc32.hpp"
#include "base/error.hpp"
#include "base/thread_pool.hpp"
#include "decoder/compositor.hpp"
#include "decoder/exact_view.hpp"

namespace sgi {
namespace {

using Lock = std::lock_guard<std::recursive_mutex>;

void check_overview(const Header &found, const Header &header) {
  const auto refuse = [](const std::string &text) { throw Error(Fault::corrupt, text); };
  const Level size = overview_size(header.width, header.height);
  const auto named = [](int64_t x, int64_t y) { return std::to_string(x) + "×" + std::to_string(y); };
  if (size.width == header.width && size.height == header.height) refuse("it is no smaller than the picture");
  if (found.width != size.width || found.height != size.height)
    refuse("it has " + named(found.width, found.height) + " pixels, not " + named(size.width, size.height));
  if (found.channels != header.channels || found.spec.channels != header.spec.channels)
    refuse("its channels are not the picture's");
  if (found.sample_type != header.sample_type || found.low != header.low || found.high != header.high)
    refuse("its samples are not of the picture's type and range");
}

std::optional<double> nodata_of(const Header &header) {
  return header.masked == Masked::nodata ? std::optional(header.nodata) : std::nullopt;
}

// One checksum of the symbols of several tiles; that of a single one is its own.
uint32_t joined_crc(const std::vector<uint32_t> &crcs) {
  if (crcs.size() == 1) return crcs[0];
  std::vector<uint8_t> bytes;
  for (const uint32_t crc : crcs)
    for (int shift = 0; shift < 32; shift += 8) bytes.push_back(uint8_t(crc >> shift));
  return crc32({bytes.data(), bytes.size()});
}

}  // namespace

Stream::Stream(std::unique_ptr<ByteSource> source, const DecoderSettings &settings, bool is_overview)
    : settings_(settings), chunks_(std::move(source), is_overview), tiles_(chunks_, settings_),
      nodata_(nodata_of(chunks_.header())) {}

std::vector<uint8_t> Stream::tile(int64_t number) {
  const Lock lock(turn_);
  return chunks_.tile(number);
}

void Stream::set_blank(double sample) {
  const Lock lock(turn_);
  nodata_ = sample;
}

void Stream::prepare(const PictureView &view, bool exact) {
  const Lock lock(turn_);
  const InnerView inner = inner_view(view, header().width, header().height);
  if (inner.view.rows == 0 || inner.view.columns == 0) return;
  if (has_overview() && !exact)
    if (const auto small = overview_view(header().width, header().height, inner.view))
      return overview().prepare(*small, true);
  decode_tiles(header(), tiles_, inner.view, settings_.between);
}

void Stream::draw(const PictureView &view, int64_t top, int64_t rows, Output output, const DrawOptions &options,
                  void *out, int64_t stride) {
  const Lock lock(turn_);
  const SampleFormat format(header(), output, nodata_, settings_.isa);
  const PixelBlock block{out, view.columns, rows, stride / format.sample_bytes()};
  const InnerView inner = inner_view(view, header().width, header().height);
  if (inner.view.columns == view.columns && inner.view.rows == view.rows)
    return draw_inside(view, top, block, output, options);
  format.fill(format.blank, block);
  const int64_t first = std::max(top, inner.top), last = std::min(top + rows, inner.top + inner.view.rows);
  if (first < last && inner.view.columns)
    draw_inside(inner.view, first - inner.top,
                format.part(block, inner.left, first - top, inner.view.columns, last - first), output, options);
}

void Stream::draw_inside(const PictureView &view, int64_t top, const PixelBlock &block, Output output,
                         const DrawOptions &options) {
  if (has_overview() && !options.exact)
    if (const auto small = overview_view(header().width, header().height, view)) {
      Stream &shown = overview();
      const Lock lock(shown.turn_);
      return shown.draw_inside(*small, top, block, output, options);
    }
  const SampleFormat format(header(), output, nodata_, settings_.isa);
  const Drawing drawing{format, options.dither && format.is_dithered(header().sample_type), settings_.threads,
                        settings_.between};
  ExactBlocks *blocks = options.lossy ? nullptr : exact_blocks();
  const bool is_whole = view.is_plain() && output == header().sample_type, is_alpha = blocks && blocks->is_alpha();
  if (!blocks || !(is_whole || is_alpha || blocks->has_views()))
    return draw_view(header(), tiles_, view, top, block, drawing);
  // nodata: whatever `set_blank` says
  const SampleFormat source(header(), header().sample_type, nodata_of(header()), format.isa);
  const Drawing plain{source, false, drawing.threads, drawing.between};
  const auto draw = [&](const ExactBlocks::Place &at, const PixelBlock &out) {
    const PictureView whole{double(at.x), double(at.y), 1, 1, at.width, at.height};
    draw_view(header(), tiles_, whole, 0, out, plain);
  };
  if (!blocks->has_all_channels() || (!is_whole && blocks->has_cells()))
    draw_view(header(), tiles_, view, top, block, drawing);
  if (is_whole) return blocks->fill(int64_t(view.x), int64_t(view.y) + top, block, header().sample_type, draw);
  ExactView{header(), view, format, draw, drawing.dither, drawing.threads}.fill(*blocks, top, block);
}

bool Stream::has_exact_views() {
  const Lock lock(turn_);
  const ExactBlocks *blocks = exact_blocks();
  return blocks && (blocks->has_views() || blocks->is_alpha());
}

bool Stream::has_exact_alpha() {
  const Lock lock(turn_);
  const ExactBlocks *blocks = exact_blocks();
  return blocks && blocks->is_alpha();
}

double Stream::graphics_error() {
  const Lock lock(turn_);
  const ExactBlocks *blocks = exact_blocks();
  return blocks && blocks->has_cells() ? blocks->max_error() : -1;
}

ExactBlocks *Stream::exact_blocks() {
  if (chunks_.residual_bytes() < 0) return nullptr;
  if (!exact_blocks_) exact_blocks_ = std::make_unique<ExactBlocks>(chunks_, settings_);
  return exact_blocks_.get();
}

double Stream::max_error() {
  const Lock lock(turn_);
  const ExactBlocks *blocks = exact_blocks();
  return blocks && !blocks->has_cells() && blocks->has_all_channels() ? blocks->max_error() : -1;
}

std::vector<int> Stream::exact_bands() {
  const Lock lock(turn_);
  const ExactBlocks *blocks = exact_blocks();
  return blocks && !blocks->is_alpha() && !blocks->has_all_channels() ? blocks->channels() : std::vector<int>{};
}

void Stream::check_residual() {
  const Lock lock(turn_);
  chunks_.check_residual();
}

void Stream::check_exact() {
  const Lock lock(turn_);
  if (!exact_blocks()) return;
  check_residual();
  constexpr int64_t kSamples = int64_t(1) << 24;  // at a time, or a block
  const SampleType own = header().sample_type;
  const int64_t pixel = header().spec.channels * bytes_of(own);
  const int64_t blocks = std::max<int64_t>(1, kSamples / (kResidualBlock * kResidualBlock * header().spec.channels));
  const int64_t side = std::min(header().width, blocks * kResidualBlock);
  std::vector<uint8_t> samples(size_t(side * kResidualBlock * pixel));
  for (int64_t y = 0; y < header().height; y += kResidualBlock)
    for (int64_t x = 0; x < header().width; x += side) {
      const int64_t columns = std::min(side, header().width - x), rows = std::min(kResidualBlock, header().height - y);
      draw({double(x), double(y), 1, 1, columns, rows}, 0, rows, own, {true, false, false}, samples.data(),
           columns * pixel);
    }
}

const Survey &Stream::survey() {
  const Lock lock(turn_);
  if (survey_) return *survey_;
  Survey found;
  std::vector<uint32_t> crcs;
  tiles_.for_each_fact([&](const TileFacts &facts) {
    found.seeds += facts.seeds;
    for (int part = 0; part < kParts; ++part) found.part_bytes[part] += facts.end.bits[part] / 8;
    if (header().masked != Masked::none || header().has_exact) found.mask_bytes += facts.mask_bytes;
    for (int size = 0; size < 3; ++size) found.texture_cells[size] += facts.texture_cells[size];
    crcs.push_back(facts.end.symbol_crc);
  });
  found.symbol_crc = joined_crc(crcs);
  return survey_.emplace(found);
}

Stream &Stream::overview() {
  const Lock lock(turn_);
  if (overview_) return *overview_;
  if (!has_overview()) throw Error(Fault::usage, "there is no overview");
  overview_bytes_ = chunks_.overview();
  const Bytes bytes{overview_bytes_.data(), overview_bytes_.size()};
  try {
    auto small = std::make_unique<Stream>(memory_source(bytes), settings_, true);
    check_overview(small->header(), header());
    overview_ = std::move(small);
  } catch (const Error &error) {
    throw Error(error.fault, std::string("overview: ") + error.what());
  }
  return *overview_;
}

const TileRenderer &Stream::renderer(int64_t number) {
  const Lock lock(turn_);
  return tiles_.tile(number);
}

Stream::Tiles Stream::tiles() {
  const Lock lock(turn_);
  return {tiles_.held(), tiles_.decoded(), tiles_.ahead()};
}

}  // namespace sgi
