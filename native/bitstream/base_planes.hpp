// The base layer's planes from their prediction errors (docs/format.md, "Base layer").
#pragma once
#include <cstdint>

namespace sgi {

// The prediction 0..3 of element (x, y) of a plane of `columns` columns, from those to the left, above, and above to
// the left; at an edge the one that is there stands for all.
int64_t base_prediction(const int64_t *plane, int64_t columns, int64_t x, int64_t y, int predictor);

// Adds to every element of plane [rows, columns] its prediction. Stops at the first value beyond +-most and returns
// false.
bool add_predictions(int64_t *plane, int64_t rows, int64_t columns, int predictor, int64_t most);

}  // namespace sgi
