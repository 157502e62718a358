#include "decoder/tile_renderer.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "base/error.hpp"
#include "base/thread_pool.hpp"
#include "model/base_view.hpp"
#include "model/constants.hpp"
#include "model/model_gaussians.hpp"
#include "model/steps.hpp"
#include "model/texture_drawing.hpp"

namespace sgi {
namespace {

constexpr int64_t kMaxPairs = 1 << 24;  // (tile, Gaussian) pairs of a block; a sound one has a tenth at most
// A tile of a reduced view that has no more samples is drawn at once, whatever part is asked for: each part would have
// to look at all of its Gaussians again.
constexpr int64_t kWholeSamples = 1 << 18;
// What is restored is drawn in bands: large ones draw less of their margins twice, small ones stay in the cache and in
// memory that is there.
constexpr int64_t kBand = 1 << 19, kBandOfThread = 1 << 17;  // samples; the latter where many threads share one
constexpr int64_t kBandArriving = 1 << 17;                   // while texture arrives: then what is there of it is drawn
constexpr float kCutoff = 3.5f;
constexpr double kFinePixels = 1 << 20;  // of a float's whole numbers, with 1/16 of a pixel between

DecoderWeights weights_of(const AttributeDecoder &decoder) {
  const auto floats = [&](const std::vector<int64_t> &from) {
    std::vector<float> to(from.size());
    for (size_t i = 0; i < from.size(); ++i) to[i] = std::ldexp(float(from[i]), -decoder.shift);
    return to;
  };
  return {floats(decoder.w1), floats(decoder.b1), floats(decoder.w2), floats(decoder.b2)};
}

GaussianSet gaussians_of(const ModelSpec &spec, const TileModel &model, int threads, Isa isa) {
  const int64_t count = model.seeds() * spec.per_seed;
  GaussianSet all{std::vector<float>(2 * count), std::vector<float>(3 * count),
                  std::vector<float>(spec.channels * count), spec.channels};
  model_gaussians(spec, {model.corner.data(), model.log_size.data(), model.decoded.data(), model.seeds()},
                  weights_of(model.colours), weights_of(model.shapes), threads, isa,
                  {all.means.data(), all.covariances.data(), all.colours.data()});
  return all;
}

std::vector<double> base_colours(const TileModel &model) {
  const double step = double(step_of(model.base_step)) * std::ldexp(1.0, -kFractionBits);
  std::vector<double> values(model.base.size());
  for (size_t i = 0; i < values.size(); ++i) values[i] = double(model.base[i]) * step;
  return values;
}

template <class T>
int64_t bytes_of(const std::vector<T> &held) {
  return int64_t(held.size() * sizeof(T));
}

}  // namespace

TileRenderer::TileRenderer(const Header &header, std::vector<uint8_t> payload, int threads,
                           const DecoderSettings &settings)
    : settings_(settings) {
  TileChunk chunk = decode_tile_chunk(header, {payload.data(), payload.size()});
  header_ = header.of_tile(chunk.number);
  place_ = header.grid().rect(chunk.number);
  is_empty_ = chunk.is_empty;
  masks_ = std::move(chunk.masks), exact_ = std::move(chunk.exact);
  facts_.mask_bytes = int64_t(payload.size() - (is_empty_ ? 0 : chunk.model.size));
  gaussians_.channels = header_.spec.channels;
  if (is_empty_) return;
  auto reader = std::make_unique<TileReader>(
      header_, chunk.model, TileReading{threads, settings.isa, settings.checked, settings.tile_memory});
  const TileModel model = reader->model();
  if (reader->has_texture())
    texture_ = std::make_unique<ArrivingTexture>(std::move(reader), std::move(payload), threads);
  else
    facts_.end = reader->finish();
  take(model, threads);
}

void TileRenderer::take(const TileModel &model, int threads) {
  const ModelSpec &spec = header_.spec;
  facts_.seeds = model.seeds();
  gaussians_ = gaussians_of(spec, model, threads, settings_.isa);
  base_ = base_colours(model);
  if (const RestorationChoice &choice = model.restoration; choice.network)
    restoration_.emplace(restoration_network(choice.network, header_.own_network), choice.step, spec.channels,
                         header_.width, header_.height, settings_.isa);
}

void TileRenderer::complete() {
  if (texture_) texture_->wait();
}

TileFacts TileRenderer::facts() {
  complete();
  TileFacts facts = facts_;
  if (!texture_) return facts;
  facts.end = texture_->end();
  for (const uint8_t log_size : texture_->cells().log_size) ++facts.texture_cells[log_size - kTextureLeast];
  return facts;
}

int64_t TileRenderer::memory() const {
  int64_t bytes = gaussians_.memory() + bytes_of(base_);
  if (rescaled_) bytes += rescaled_->gaussians.memory();
  if (whole_) bytes += bytes_of(whole_->samples);
  if (texture_ && texture_->has_ended()) {
    const TextureCells &cells = texture_->cells();
    bytes += bytes_of(cells.corner) + bytes_of(cells.log_size) + bytes_of(cells.amplitudes) + bytes_of(cells.waves) +
             cells.floats * int64_t(sizeof(float));
  }
  const Mask *before = nullptr;
  for (const BandMask &mask : masks_) {
    if (mask.pixels && mask.pixels.get() != before) bytes += mask.pixels->memory();
    before = mask.pixels.get();
  }
  return bytes + bytes_of(exact_);
}

void TileRenderer::prepare(const PictureView &view, int threads) {
  if (!whole(view, threads)) rescale(view, threads);
}

void TileRenderer::draw(const PictureView &view, int64_t x, int64_t y, const PixelBlock &block,
                        const SampleFormat &format, int threads) {
  const Whole *known = whole(view, threads);
  const int64_t left = known ? x - known->left : -1, top = known ? y - known->top : -1;
  const int64_t channels = header_.spec.channels;
  if (left >= 0 && top >= 0 && left <= known->columns - block.columns && top <= known->rows - block.rows)
    for (int64_t row = 0; row < block.rows; ++row)
      format.store(&known->samples[((top + row) * known->columns + left) * channels],
                   format.part(block, 0, row, block.columns, 1), 1);
  else
    draw_blocks(view, x, y, block, format, threads);
  complete();  // what is wrong with the rest of the payload is said now
}

// What a reduced view shows of the tile, if that is little.
const TileRenderer::Whole *TileRenderer::whole(const PictureView &view, int threads) {
  if (std::max(view.sx, view.sy) >= 1) return nullptr;
  const auto is_same = [&] {
    return whole_->view.is_aligned(view) && whole_->view.columns == view.columns && whole_->view.rows == view.rows;
  };
  if (whole_ && is_same()) return &*whole_;
  // First and last pixel and one on of the `most` of an axis that show what begins at `start` and has `size` pixels.
  const auto first = [](double start, double scale) {
    return std::max<int64_t>(0, int64_t(std::floor(start * scale)));
  };
  const auto last = [](double start, int64_t size, double scale, int64_t most) {
    return std::min(most, int64_t(std::ceil((start + double(size)) * scale)));
  };
  const double x = double(place_.x) - view.x, y = double(place_.y) - view.y;
  const int64_t left = first(x, view.sx), columns = last(x, place_.width, view.sx, view.columns) - left;
  const int64_t top = first(y, view.sy), rows = last(y, place_.height, view.sy, view.rows) - top;
  const int64_t samples = columns * rows * header_.spec.channels;
  if (columns <= 0 || rows <= 0 || samples > kWholeSamples) return nullptr;
  Whole drawn{view, left, top, columns, rows, std::vector<float>(samples)};
  const SampleFormat values(header_, kValues, std::nullopt, settings_.isa);
  draw_blocks(view, left, top, {drawn.samples.data(), columns, rows, columns * header_.spec.channels}, values, threads);
  return &whole_.emplace(std::move(drawn));
}

void TileRenderer::draw_blocks(const PictureView &view, int64_t x, int64_t y, const PixelBlock &block,
                               const SampleFormat &format, int threads) {
  const bool restores = restoration_ && std::min(view.sx, view.sy) >= 1;
  int64_t most = std::max<int64_t>(1, settings_.block_samples);
  if (restores) most = std::min(most, std::max(kBand, kBandOfThread * resolve_threads(threads)));
  const int64_t width = restores ? restoration_->block_columns(block.columns)
                                 : std::min(block.columns, int64_t(std::ceil(4 * std::sqrt(double(most)))));  // flat
  Restored tools{{Rasterizer(settings_.isa, threads, kMaxPairs), gaussians_, 0, 0}, tools_for(view, threads)};
  for (int64_t top = 0, height; top < block.rows; top += height) {
    const bool arrives = texture_ && !texture_->has_ended() && resolve_threads(threads) > 1;
    height = std::max<int64_t>(1, (arrives ? std::min(most, kBandArriving) : most) / (width * header_.spec.channels));
    height = std::min(height, block.rows - top);
    for (int64_t left = 0; left < block.columns; left += width) {
      const PixelBlock part = format.part(block, left, top, std::min(width, block.columns - left), height);
      if (restores)
        draw_restored(tools, view, x + left, y + top, part, format, threads);
      else
        draw_block(tools.shown, view, x + left, y + top, part.columns, part.rows, format.samples(part), threads);
    }
  }
}

void TileRenderer::draw_restored(Restored &tools, const PictureView &view, int64_t x, int64_t y,
                                 const PixelBlock &block, const SampleFormat &format, int threads) const {
  const OutputAxis columns = across(view, x, block.columns), rows = down(view, y, block.rows);
  const TileBlock needed = restoration_->needed(columns, rows);
  const PictureView own{double(place_.x), double(place_.y), 1, 1, place_.width, place_.height};
  const auto drawn = draw_channels<const float>(tools.own, tools.drawn, own, needed, threads);
  const auto store = [&](int64_t left, int64_t top, int64_t count, const float *const *channels) {
    format.store_channels(channels, format.part(block, left - columns.first, top - rows.first, count, 1));
  };
  if (view.is_plain())
    return restoration_->restore(drawn, {columns.first, rows.first, block.columns, block.rows}, threads, store);
  const auto shown = draw_channels<float>(tools.shown, tools.planes, view, {x, y, block.columns, block.rows}, threads);
  restoration_->add(drawn, columns, rows, threads, shown.first);
  parallel_for(block.rows, threads, [&](int64_t row) {
    std::vector<const float *> channels;
    for (int c = 0; c < header_.spec.channels; ++c) channels.push_back(shown.at(c, x, y + row));
    store(columns.first, rows.first + row, block.columns, channels.data());
  });
}

// The channels of a block of a view.
template <class T>
TilePlanes<T> TileRenderer::draw_channels(Tools &tools, KeptFloats &memory, const PictureView &view,
                                          const TileBlock &block, int threads) const {
  const int64_t plane = block.columns * block.rows;
  float *planes = memory.room(plane * header_.spec.channels);
  draw_block(tools, view, block.left, block.top, block.columns, block.rows, ChannelPlanes{planes, block.columns, plane},
             threads);
  return {planes, block};
}

// Rows of the tile of which an axis shows texture, from its first on.
int64_t TileRenderer::rows_seen(const OutputAxis &down) const {
  if (down.scale < 1) return header_.height;  // what pixels see depends on their size
  const double last = down.centre(down.count - 1) + kTextureOverlap;
  return int64_t(std::clamp(std::floor(last) + 1, 0.0, double(header_.height)));
}

OutputAxis TileRenderer::across(const PictureView &view, int64_t x, int64_t count) const {
  return {view.x - double(place_.x), view.sx, x, count};
}

OutputAxis TileRenderer::down(const PictureView &view, int64_t y, int64_t count) const {
  return {view.y - double(place_.y), view.sy, y, count};
}

// Draws a block of a view, to samples or to channels.
template <class Sink>
void TileRenderer::draw_block(Tools &tools, const PictureView &view, int64_t x, int64_t y, int64_t columns,
                              int64_t rows, const Sink &sink, int threads) const {
  const ModelSpec &spec = header_.spec;
  const OutputAxis across = this->across(view, x, columns), down = this->down(view, y, rows);
  Background behind{};
  BaseView base;
  if (!base_.empty()) {
    const int64_t cell = spec.base_cell, cells = (header_.width + cell - 1) / cell;
    const BaseGrid grid{base_.data(), spec.channels, int64_t(base_.size()) / (spec.channels * cells), cells};
    base = base_view(grid, spec.base_cell, across, down, threads);
    behind.lines = base.lines.data(), behind.count = base.count, behind.width = columns;
    behind.top = base.top.data(), behind.down = base.down.data(), behind.taps = base.taps;
  }
  const View crop{int(across.first - tools.left), int(down.first - tools.top), int(columns), int(rows)};
  std::optional<TextureDrawing> texture;
  GroupPlanes planes;
  if (texture_) {
    const TextureBlocks groups{crop.x0 - crop.tile_x0() * kTileWidth, crop.y0 - crop.tile_y0() * kTileHeight,
                               kGroupWidth, kGroupHeight, kGroupStride};
    texture.emplace(texture_->first_rows(rows_seen(down)), across, down, groups, settings_.isa);
    planes = [&](int64_t column, int64_t row, float *to) { return texture->draw(column, row, to); };
  }
  try {
    tools.raster.draw(tools.gaussians.view(), crop, kCutoff, behind, planes, sink);
  } catch (const std::overflow_error &) {
    throw Error(Fault::limit, "the Gaussians cover too much of the picture; decode smaller regions");
  }
}

TileRenderer::Tools TileRenderer::tools_for(const PictureView &view, int threads) {
  Rasterizer raster(settings_.isa, threads, kMaxPairs);
  if (view.is_plain()) return {std::move(raster), gaussians_, 0, 0};
  rescale(view, threads);
  return {std::move(raster), rescaled_->gaussians, rescaled_->left, rescaled_->top};
}

// Keeps the Gaussians of a view that is not plain. They count from the tile's corner, so that all views of a scale draw
// the same, unless floats would be too coarse there.
void TileRenderer::rescale(const PictureView &view, int threads) {
  if (view.is_plain()) return;
  const OutputAxis x = across(view, 0, 1), y = down(view, 0, 1);
  const int64_t left = double(place_.width) * view.sx <= kFinePixels ? 0 : x.first;
  const int64_t top = double(place_.height) * view.sy <= kFinePixels ? 0 : y.first;
  const double at_x = double(left) + x.offset, at_y = double(top) + y.offset;
  if (rescaled_ && rescaled_->sx == view.sx && rescaled_->sy == view.sy && rescaled_->x == at_x && rescaled_->y == at_y)
    return;
  rescaled_ = Rescaled{view.sx,
                       view.sy,
                       at_x,
                       at_y,
                       left,
                       top,
                       rescaled(gaussians_.view(), {view.sx, at_x}, {view.sy, at_y}, kPixelVariance, threads)};
}

}  // namespace sgi
