#include "bitstream/texture_stream.hpp"

#include <algorithm>
#include <utility>

#include "base/error.hpp"

namespace sgi {

namespace {

// Codes a layer node by node; `given` is the layer when writing, null when reading. cells: gets what is coded, null for
// nobody.
template <class Bits>
class LayerCoding {
 public:
  LayerCoding(BitModels &models, TextureField &field, Bits &bits, const TextureField *given, TextureDequantizer *cells,
              int64_t width, int64_t height, bool has_contrast)
      : coding(models, field, bits), field_(field), given_(given), cells_(cells), width_(width), height_(height),
        has_contrast_(has_contrast) {}

  void root(const TextureCell &cell) {
    const int what = coding.node(cell, what_is(cell));
    if (what && has_contrast_) {
      int8_t &contrast = field_.contrast[field_.root(cell.x, cell.y)];
      contrast = int8_t(coding.contrast(given_ ? given_->contrast[field_.root(cell.x, cell.y)] : 0));
    }
    inside(cell, what);
  }

  // What says nothing is not sound: a layer, a split node or a leaf without symbols.
  bool sound() const { return coding.sound() && !is_void_; }
  bool any() const { return leaves_ > 0; }

  TextureCoding<Bits> coding;

 private:
  // Only leaves are marked, and a leaf fills its place.
  int what_is(const TextureCell &cell) const {
    if (!given_) return kNoTexture;
    if (given_->log_size[given_->unit(cell.x, cell.y)] == cell.log) return kTextureLeaf;
    for (int64_t y = cell.y; y < cell.y + cell.side(); y += kUnit)
      for (int64_t x = cell.x; x < cell.x + cell.side(); x += kUnit)
        if (given_->log_size[given_->unit(x, y)]) return kSplitNode;
    return kNoTexture;
  }

  void node(const TextureCell &cell) {
    if (cell.x < width_ && cell.y < height_ && sound()) inside(cell, coding.node(cell, what_is(cell)));
  }

  void inside(const TextureCell &cell, int what) {
    if (!sound()) return;
    const int64_t before = leaves_;
    if (what == kSplitNode)
      for (int number = 0; number < 4; ++number) node(cell.child(number));
    if (what == kTextureLeaf) leaf(cell);
    is_void_ = is_void_ || (what != kNoTexture && leaves_ == before);
  }

  void leaf(const TextureCell &cell) {
    field_.mark(cell, cell.log);
    const int side = cell.side();
    bool any = false;
    if (cells_) cells_->begin(cell, field_.contrast[field_.root(cell.x, cell.y)]);
    for (int channel = 0; channel < field_.channels; ++channel) {
      std::fill_n(values_.begin(), side * side, int16_t(0));
      if (given_)
        for (int row = 0; row < side; ++row)
          std::copy_n(given_->at(channel, cell) + row * field_.width, side, &values_[row * side]);
      const int last =
          coding.block(cell, channel, given_ ? last_diagonal(values_.data(), side, cell.log) : -1, values_);
      field_.add(cell, channel, values_.data(), last);
      if (cells_) cells_->channel(values_.data(), side, last);
      any = any || last >= 0;
    }
    if (cells_) cells_->end();
    leaves_ += any;
  }

  TextureField &field_;
  const TextureField *given_;
  TextureDequantizer *cells_;
  int64_t width_, height_;
  bool has_contrast_, is_void_ = false;
  int64_t leaves_ = 0;
  CellSymbols values_;
};

}  // namespace

TextureField empty_field(int64_t width, int64_t height, int channels, KeptSymbols kept) {
  return {texture_roots(width), texture_roots(height), channels, kept};
}

template <class Bits>
std::vector<int32_t> write_texture(BitModels &models, Bits &bits, const TextureField &field, int64_t width,
                                   int64_t height, bool has_contrast) {
  TextureField coded = empty_field(width, height, field.channels);
  LayerCoding<Bits> layer(models, coded, bits, &field, nullptr, width, height, has_contrast);
  each_root(width, height, [&](const TextureCell &cell) {
    if (layer.sound()) layer.root(cell);
  });
  if (!layer.sound() || !layer.any() || coded.symbols != field.symbols || coded.contrast != field.contrast ||
      coded.log_size != field.log_size)
    throw Error(
        Fault::usage,
        "a layer has cells; all begin inside the tile and have symbols, up to 16390 either way; there are no others; "
        "contrasts are where there is texture");
  return std::move(layer.coding.symbols);
}

template std::vector<int32_t> write_texture(BitModels &models, RangeEncoder &bits, const TextureField &field,
                                            int64_t width, int64_t height, bool has_contrast);
template std::vector<int32_t> write_texture(BitModels &models, BitTaker &bits, const TextureField &field, int64_t width,
                                            int64_t height, bool has_contrast);

void read_texture(BitModels models, SymbolReader &reader, int64_t width, int64_t height, bool has_contrast,
                  TextureField &field, TextureDequantizer *cells, const RowsRead &rows_read) {
  LayerCoding<RangeDecoder> layer(models, field, reader.range(), nullptr, cells, width, height, has_contrast);
  std::vector<int32_t> &symbols = layer.coding.symbols;
  each_root(width, height, [&](const TextureCell &cell) {
    if (!cell.x) field.begin_roots(cell.y);
    if (layer.sound()) layer.root(cell);
    reader.record(symbols.data(), int64_t(symbols.size()));
    symbols.clear();
    if (rows_read && cell.x + cell.side() >= width) rows_read(cell.y + cell.side());
  });
  if (!layer.sound() || !layer.any())
    throw Error(Fault::corrupt, "texture: the payload does not decode; it is damaged");
}

}  // namespace sgi
