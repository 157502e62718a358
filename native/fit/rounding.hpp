// What a step of a fit does to the values that it draws.
#pragma once

namespace sgi {

enum class Rounding : int { kNone, kNoise, kRound };

}  // namespace sgi
