// Numbers of the context model and of drawing (docs/format.md), and of the arithmetic around them, stated here alone:
// Python reads them from the extension.
#pragma once

namespace sgi {

// Fixed point.
constexpr int kFractionBits = 24;  // values of attributes, means and steps
constexpr int kInputBits = 6;      // inputs of MLP_p
constexpr int kMeanBits = 8;       // predicted means, in base steps
constexpr int kGammaBits = 4;
constexpr int kPerOctave = 6;  // logarithms count sixths of an octave

// Steps q = 2^((index - kStepZero) / 6), and scales of 2^((index - kScaleZero) / 6) steps.
constexpr int kStepZero = 96, kStepCount = 103;
constexpr int kScaleZero = 24, kScaleCount = 64;
constexpr int kRefineLimit = 24;     // sixths of an octave either way
constexpr int kAmplitudeZero = -20;  // amplitude index at which a step is its base step: 2^(-20/6) = 0.1
constexpr int kOctaveLimit = 12;     // of a scale that is predicted in octaves, either way; in the fit alone

// How far decisions move towards zero for a scale of one step, and at most: the next symbol costs sqrt(2) q / (sigma ln
// 2) more bits, and at the step that rate theory picks a bit is worth ln 2 / 12 of a squared step.
constexpr double kDeadZone = 0.118, kDeadZoneLimit = 0.3;

constexpr double kMinMass = 0x1p-20;  // probability of a value: what the escape symbol guarantees

// What MLP_p sees of a seed.
constexpr int kLevels = 8;   // cell sizes told apart: 2^0 to 2^7 pixels
constexpr int kSummary = 7;  // three colours, the loudness, three shape numbers
constexpr int kMaxNeighbours = 6;
constexpr int kNeighbourWeights[kMaxNeighbours] = {4, 3, 3, 2, 2, 2};  // sixteenths, nearest first
constexpr int kLevelInputs = kLevels + 1;                              // and the colour step
constexpr int kNeighbourInputs = 1 + kSummary + 5 + 1 + kSummary + 2;
constexpr int kCommonInputs = kLevelInputs + kNeighbourInputs;
constexpr int kMaxOwnInputs = 12;
constexpr int kColourGainBits = 4;  // colours are small: their inputs are sixteen times as large
constexpr int kLoudnessZero = 6;    // octaves below 1 at which the loudness is 0
constexpr int kOffsetLimit = 8;     // cells
constexpr int kInputLimit = 1 << 13, kHiddenLimit = 1 << 15;  // of MLP_p, in units of 2^-6

// What a seed draws.
constexpr double kMinVariance =
    0.05;                           // pixels² added to every variance: what is thinner can neither be seen nor fitted
constexpr double kShapeLimit = 12;  // of exponents, so that a hostile stream cannot reach infinity

// Variance, output pixels², of the Gaussian that stands for a pixel's area when a picture is made much smaller. A
// square has 1/12; its spectrum up to the Nyquist frequency is best met by a little more.
constexpr double kPixelVariance = 0.1;

// docs/notes/2026-11-texture.md compares other overlaps and other sizes of cells.
constexpr int kTextureOverlap = 4;                  // pixels by which texture cells reach over each other
constexpr int kTextureRoot = 5, kTextureLeast = 3;  // log2 of the sides of cells: 32, 16 and 8 pixels
constexpr int kContrastLimit = 15;                  // of the contrast of a root cell, either way

enum Group { kColour, kShape, kOffset, kGroups };

// What a seed's earlier groups add to what MLP_p sees at a coding step: nothing, its colours, and its shape too.
constexpr int own_input_count(int step) { return step == 0 ? 0 : step == 1 ? 7 : kMaxOwnInputs; }

}  // namespace sgi
