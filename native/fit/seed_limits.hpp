// Bounds of what MLP_p says, in the fit's units.
#pragma once
#include "model/steps.hpp"

namespace sgi {
namespace {

constexpr float kLn2 = 0.69314718056f;
// Without a bound of steps, good fits were a matter of luck (docs/notes/2026-11-fit-settings.md).
constexpr float kMinStep = 0x1p-16f, kGreatestStep = 2.0f, kMinScale = 0x1p-4f;  // in steps
static_assert(octaves(-kStepZero) == -16 && octaves(kStepCount - 1 - kStepZero) == 1 && octaves(-kScaleZero) == -4);

}  // namespace
}  // namespace sgi
