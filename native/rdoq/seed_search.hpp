// The symbols of one seed, chosen by squared error, weighted where the residual has weights, plus price.
#pragma once
#include <cstdint>
#include <vector>

#include "rdoq/coding.hpp"
#include "rdoq/windows.hpp"

namespace sgi {

struct SearchSettings {
  float lmbda;   // squared error per bit
  float cutoff;  // where a Gaussian ends, standard deviations
  int deep;      // how many choices of colours are followed to the end
};

struct Seed {
  const int16_t *inputs;  // of the first network
  const double *values;   // [C + 5] as rendered now
  const float *centre;    // [2] pixels
  float cell;             // pixels
  int8_t log_size;
};

// Works on one seed after the other; one for each thread.
class SeedSearch {
 public:
  SeedSearch(const CodingModel &model, const SearchSettings &settings, const WindowKernel &kernel);

  // Pixels that a seed may cover after a change: a search changes no others.
  Window reserve(const Seed &seed, const Residual &residual);

  // Finds the symbols of least change in squared error plus price within reach of the present values, and takes what
  // they change in the rendered Gaussian out of the residual. Returns that change.
  double search(const Seed &seed, const Window &window, const Residual &residual, Coded &best);

 private:
  struct Place;
  bool splat_of(const double *values, Splat &splat) const;
  void colours_of(const double *values, float *colours) const;
  void try_colours(const Place &place);
  float mix(const Place &place, const Coded &coded) const;
  void changes(const Place &place, const Splat *two, float power, float *out) const;
  double descend(Group group, const ReconstructionGrid &grid, const Place &place, float power, double *values,
                 Coded &coded);
  void follow(const Place &place, const std::vector<int> &chosen);
  void replace(const Place &place, const Coded &coded) const;

  const CodingModel &model_;
  const SearchSettings settings_;
  const WindowKernel &kernel_;
  SeedContext context_;
  const Seed *seed_ = nullptr;
  // Of each candidate, that is each choice of colours:
  std::vector<Coded> candidates_;
  std::vector<ReconstructionGrid> shapes_, offsets_;
  std::vector<double> cost_;   // squared error and price so far
  std::vector<double> guess_;  // the same with the nearest shape and offset
  std::vector<float> planes_;
};

}  // namespace sgi
