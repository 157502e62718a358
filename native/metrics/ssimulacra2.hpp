// SSIMULACRA 2 (Sneyers 2022, version 2.1): from the norms of its maps to a score, and how the score moves with them.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "metrics/maps.hpp"

namespace sgi {

constexpr int kVisualChannels = 3;  // X, Y and B
constexpr int kVisualScales = 6;    // each of half the one before
constexpr int kSmallestScale = 8;   // pixels of a side, below which there is no scale

using ChannelSums = std::array<MapSums, kVisualChannels>;
using ChannelSlopes = std::array<std::array<MapSlope, kVisualMaps>, kVisualChannels>;

// Whether a map of a channel counts at all where there are so many scales.
bool counts(int scales, int scale, int channel, VisualMap map);

// The score, up to 100, from the sums at each scale, which has so many pixels; and the slopes of each scale, if asked
// for. Without scales it is 100.
double visual_score(const std::vector<ChannelSums> &sums, const std::vector<int64_t> &pixels,
                    std::vector<ChannelSlopes> *slopes);

}  // namespace sgi
