// The choice of cells (blocks) and symbols of texture, root by root. A root is a superblock of 32x32 pixels.
#pragma once
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "bitstream/texture_field.hpp"
#include "bitstream/texture_models.hpp"
#include "rdoq/texture_search.hpp"
#include "rdoq/texture_trellis.hpp"

namespace sgi {

// What every part of a search for texture reads.
struct TextureSought {
  const TextureAmplitudes &amplitudes;
  const int8_t *contrasts;
  const TextureSteps &steps;
  const TextureSettings settings;
  const uint8_t *division;  // TextureField::log_size of a layer whose cells are taken, or null

  int contrast(const TextureField &field, const TextureCell &cell) const {
    return settings.has_contrast ? contrasts[field.root(cell.x, cell.y)] : 0;
  }
  bool seen(const TextureCell &cell) const {
    return cell.x < amplitudes.layout.width && cell.y < amplitudes.layout.height;
  }

  // Amplitudes of a cell in steps.
  void scale(const TextureField &field, const TextureCell &cell, int channel, CellValues<float> &scaled) const;
};

// Amplitudes of a cell in steps, with what channels have to make good of the first one.
class ScaledCell {
 public:
  ScaledCell(const TextureSought &sought, const TextureField &field, const TextureCell &cell)
      : sought_(sought), field_(field), cell_(cell) {}

  // Of a channel; the first one's symbols must be in the field for the others. They hold until the next call.
  const CellValues<float> &of(int channel);

 private:
  void find_left();

  const TextureSought &sought_;
  const TextureField &field_;
  const TextureCell cell_;
  bool has_left_ = false;
  CellValues<float> scaled_, left_;  // what symbols leave of the first channel
};

// A cell's cost without texture, and estimates of it as one cell and divided.
struct TextureProspect {
  float nothing = 0, whole = 0, parts = std::numeric_limits<float>::infinity();
};

// Decides on one root after the other, by models that learn nothing from it.
class TextureRootSearch {
 public:
  TextureRootSearch(const TextureSought &sought, TextureField &field) : sought_(sought), field_(field) {
    for (auto &of_size : choices_) of_size.resize(size_t(field.channels));
  }

  // What is best for a root: the field shows it afterwards, and `plan` has all nodes in coding order.
  void decide(const TextureCell &root, const BitModels &models, std::vector<int> &plan);
  // What a root costs about, in squared steps.
  float estimated(const TextureCell &root) {
    const float best = look_ahead(root);
    return std::min(best, prospect(root).nothing);
  }

 private:
  float cost(const BitContext &context, int bit) const;
  float choose_leaf(const TextureCell &cell);
  std::vector<Choice> &choices(const TextureCell &cell) { return choices_[size_t(cell.log - kTextureLeast)]; }
  TextureProspect estimate(const TextureCell &cell) const;
  TextureProspect &prospect(const TextureCell &cell);
  float look_ahead(const TextureCell &cell);
  float decide_node(const TextureCell &cell, std::vector<int> &plan);
  int given_log(const TextureCell &cell) const;
  void follow_node(const TextureCell &cell, std::vector<int> &plan);

  const TextureSought &sought_;
  TextureField &field_;
  const BitModels *models_ = nullptr;
  std::array<std::array<TextureProspect, 1 << 2 * (kTextureRoot - kTextureLeast)>, kTextureSizes>
      prospects_;                                           // of a root
  std::array<std::vector<Choice>, kTextureSizes> choices_;  // of all channels of the last cell of each size
};

}  // namespace sgi
