#include "rdoq/seed_search.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "model/gaussians.hpp"
#include "raster/binning.hpp"

namespace sgi {
namespace {

constexpr double kMaxGrowth = 0.7, kMaxShift = 2.0;  // of a window: a logarithm, and cells

void nearest(const CodingModel &model, Group group, const ReconstructionGrid &grid, const double *values,
             int64_t *symbols) {
  for (int j = 0; j < model.group(group).size(); ++j) symbols[j] = grid.nearest(j, values[j]);
}

}  // namespace

// What the candidates of one seed are measured against.
struct SeedSearch::Place {
  const Residual &residual;
  const Window &window;
  Window drawn;                 // the part of the window in which the Gaussian as rendered now ends
  float colours[kMaxChannels];  // as rendered now
  float *g;                     // the Gaussian as rendered now
  float *weighted;              // the same times the pixels' weights; g itself where all are 1
  float *mixed;                 // the residual with a candidate's colours in the old place, times these colours
  float *fresh;                 // the Gaussian that replaces it

  Plane working(float *plane) const { return {plane, window.stride}; }
};

SeedSearch::SeedSearch(const CodingModel &model, const SearchSettings &settings, const WindowKernel &kernel)
    : model_(model), settings_(settings), kernel_(kernel), context_(model, 1 + 2 * model.channels()) {
  const size_t candidates = 1 + 2 * size_t(model.channels());
  candidates_.resize(candidates);
  shapes_.resize(candidates);
  offsets_.resize(candidates);
  cost_.resize(candidates);
  guess_.resize(candidates);
}

// values: shape (a, b, c), then offset. False for what is not rendered.
bool SeedSearch::splat_of(const double *values, Splat &splat) const {
  const float cell = seed_->cell;
  const Covariance<float> c({float(values[0]), float(values[1]), float(values[2])}, cell * cell);
  const float covariance[3] = {c.xx(), c.xy(), c.yy()};
  const float centre[2] = {seed_->centre[0] + cell * float(values[3]), seed_->centre[1] + cell * float(values[4])};
  return prepare_splat(centre, covariance, settings_.cutoff, splat);
}

void SeedSearch::colours_of(const double *values, float *colours) const {
  for (int c = 0; c < model_.channels(); ++c) colours[c] = float(values[c]);
}

Window SeedSearch::reserve(const Seed &seed, const Residual &residual) {
  seed_ = &seed;
  Splat splat;
  if (!splat_of(seed.values + model_.channels(), splat)) return {};
  context_.start(seed.inputs, seed.log_size);
  Coded &coded = candidates_[0];
  for (int j = 0; j < model_.attributes(); ++j) coded.decoded[j] = std::llrint(seed.values[j] / kDecodedUnit);
  context_.update(kShape, coded, 0);
  context_.predict(kShape, 1, shapes_.data());
  context_.predict(kOffset, 1, offsets_.data());
  const int64_t *shape = shapes_[0].step, *offset = offsets_[0].step;
  const double growth = std::min(double(shape[0] + std::max(shape[1], shape[2])) * kDecodedUnit, kMaxGrowth);
  const double shift = std::min(double(std::max(offset[0], offset[1])) * kDecodedUnit, kMaxShift) * seed.cell;
  return window_around(splat, float(std::exp(growth)), float(shift) + 1, residual);
}

// Candidate 0 keeps the colours as near as it can, the others move one of them by one step.
void SeedSearch::try_colours(const Place &place) {
  const int channels = model_.channels(), count = 1 + 2 * channels;
  const double *old = seed_->values;
  ReconstructionGrid grid;
  context_.predict(kColour, 1, &grid);
  float along[kMaxChannels];  // each channel of the residual times G
  for (int c = 0; c < channels; ++c)
    along[c] = kernel_.inner(place.residual.plane(c, place.window), place.window, place.weighted);
  const float square = kernel_.inner(place.working(place.g), place.window, place.weighted);
  for (int k = 0; k < count; ++k) {
    int64_t symbols[kMaxChannels];
    nearest(model_, kColour, grid, old, symbols);
    if (k) symbols[(k - 1) / 2] += k % 2 ? 1 : -1;
    commit(model_, kColour, grid, symbols, candidates_[k]);
    double moved[kMaxChannels];
    float delta[kMaxChannels];
    for (int j = 0; j < channels; ++j) moved[j] = grid.value(j, symbols[j]) - old[j];
    colours_of(moved, delta);
    cost_[k] = settings_.lmbda * bits_of(model_, kColour, grid, symbols);
    for (int c = 0; c < channels; ++c) cost_[k] += double(delta[c]) * (double(delta[c]) * square - 2.0 * along[c]);
    context_.update(kColour, candidates_[k], k);
  }
  guess_ = cost_;
  for (const Group group : {kShape, kOffset}) {
    std::vector<ReconstructionGrid> &grids = group == kShape ? shapes_ : offsets_;
    context_.predict(group, count, grids.data());
    for (int k = 0; k < count; ++k) {
      int64_t symbols[3];
      nearest(model_, group, grids[k], old + model_.group(group).first, symbols);
      guess_[k] += settings_.lmbda * bits_of(model_, group, grids[k], symbols);
      commit(model_, group, grids[k], symbols, candidates_[k]);
      if (group == kShape) context_.update(kShape, candidates_[k], k);
    }
  }
}

// Fills `mixed` for a candidate's colours; returns their square.
float SeedSearch::mix(const Place &place, const Coded &coded) const {
  double values[kMaxChannels];
  float colours[kMaxChannels];
  for (int j = 0; j < model_.channels(); ++j) values[j] = double(coded.decoded[j]) * kDecodedUnit;
  colours_of(values, colours);
  float power = 0, overlap = 0;
  std::fill_n(place.mixed, place.window.size(), 0.0f);
  for (int c = 0; c < model_.channels(); ++c) {
    kernel_.add_scaled(place.residual.plane(c, place.window), place.window, colours[c], place.mixed);
    power += colours[c] * colours[c];
    overlap += colours[c] * (colours[c] - place.colours[c]);
  }
  kernel_.add_scaled(place.working(place.g), place.window, -overlap, place.mixed);
  return power;
}

// Looks at the pixels within the Gaussian as rendered now and those of `two`: beyond, nothing changes.
void SeedSearch::changes(const Place &place, const Splat *two, float power, float *out) const {
  Window part = place.drawn;
  for (int i = 0; i < 2; ++i) part = around_both(part, window_around(two[i], 1, 0, place.residual));
  part = part_of(place.window, part);
  const int64_t first = int64_t(part.y - place.window.y) * part.stride + (part.x - place.window.x);
  const float *mixed = place.mixed + first, *g = place.g + first;
  if (place.residual.weights)
    kernel_.weighted_changes(two, part, place.residual.weights_in(part), power, mixed, g, out);
  else
    kernel_.changes(two, part, power, mixed, g, out);
}

// Starts at the symbols of a group that lie nearest to `values` (shape, then offset) and moves each by one where
// squared error plus price falls. Writes the group's part of `values` and `coded`; returns what place and bits cost.
double SeedSearch::descend(Group group, const ReconstructionGrid &grid, const Place &place, float power, double *values,
                           Coded &coded) {
  const int size = model_.group(group).size();
  double *own = values + model_.group(group).first - model_.channels();
  int64_t symbols[3];
  nearest(model_, group, grid, own, symbols);
  for (int j = 0; j < size; ++j) own[j] = grid.value(j, symbols[j]);
  Splat two[2];
  float change[2];
  double least = INFINITY;
  if (splat_of(values, two[0])) {
    two[1] = two[0];
    changes(place, two, power, change);
    least = change[0] + settings_.lmbda * bits_of(model_, group, grid, symbols);
  }
  for (int j = 0; j < size; ++j) {
    const int64_t from = symbols[j];
    bool sound[2];
    for (int side = 0; side < 2; ++side) {
      own[j] = grid.value(j, from + (side ? -1 : 1));
      sound[side] = splat_of(values, two[side]) && holds(place.window, two[side], place.residual);
    }
    int64_t best = from;
    if (sound[0] || sound[1]) {
      if (!sound[0] || !sound[1]) two[!sound[1]] = two[!sound[0]];
      changes(place, two, power, change);
      for (int side = 0; side < 2; ++side) {
        symbols[j] = from + (side ? -1 : 1);
        const double cost = change[side] + settings_.lmbda * bits_of(model_, group, grid, symbols);
        if (!sound[side] || !(cost < least)) continue;
        least = cost;
        best = symbols[j];
      }
    }
    symbols[j] = best;
    own[j] = grid.value(j, best);
  }
  commit(model_, group, grid, symbols, coded);
  return least;
}

// Chooses shape and offset for the colours of the `chosen` candidates and completes their costs.
void SeedSearch::follow(const Place &place, const std::vector<int> &chosen) {
  const double *old = seed_->values + model_.channels();
  for (const int k : chosen) {
    Coded &coded = candidates_[k];
    double values[kPlaceAttributes];
    std::copy_n(old, kPlaceAttributes, values);
    const float power = mix(place, coded);
    descend(kShape, shapes_[k], place, power, values, coded);
    int64_t symbols[3];
    std::copy_n(coded.symbols + model_.group(kShape).first, 3, symbols);
    cost_[k] += settings_.lmbda * bits_of(model_, kShape, shapes_[k], symbols);
    context_.update(kShape, coded, 0);
    context_.predict(kOffset, 1, offsets_.data());
    cost_[k] += descend(kOffset, offsets_[0], place, power, values, coded);
  }
}

void SeedSearch::replace(const Place &place, const Coded &coded) const {
  double values[kMaxAttributes];
  float colours[kMaxChannels];
  for (int j = 0; j < model_.attributes(); ++j) values[j] = double(coded.decoded[j]) * kDecodedUnit;
  colours_of(values, colours);
  Splat splat;
  if (splat_of(values + model_.channels(), splat)) kernel_.draw(splat, place.window, place.fresh);
  for (int c = 0; c < model_.channels(); ++c) {
    const Plane plane = place.residual.plane(c, place.window);
    kernel_.subtract(plane, place.window, -place.colours[c], place.g);
    kernel_.subtract(plane, place.window, colours[c], place.fresh);
  }
}

double SeedSearch::search(const Seed &seed, const Window &window, const Residual &residual, Coded &best) {
  seed_ = &seed;
  context_.start(seed.inputs, seed.log_size);
  const int64_t size = window.size();
  planes_.assign((residual.weights ? 4 : 3) * size, 0.0f);
  float *planes = planes_.data();
  Place place{residual,      window,           {}, {}, planes, residual.weights ? planes + 3 * size : planes,
              planes + size, planes + 2 * size};
  Splat splat;
  if (splat_of(seed.values + model_.channels(), splat)) {
    kernel_.draw(splat, window, place.g);
    place.drawn = window_around(splat, 1, 0, residual);
  }
  if (residual.weights) kernel_.weigh(residual.weights_in(window), window, place.g, place.weighted);
  colours_of(seed.values, place.colours);
  try_colours(place);
  std::vector<int> order(candidates_.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return guess_[a] < guess_[b]; });
  order.resize(std::min<size_t>(std::max(settings_.deep, 1), order.size()));
  follow(place, order);
  const int chosen = *std::min_element(order.begin(), order.end(), [&](int a, int b) { return cost_[a] < cost_[b]; });
  best = candidates_[chosen];
  replace(place, best);
  return cost_[chosen];
}

}  // namespace sgi
