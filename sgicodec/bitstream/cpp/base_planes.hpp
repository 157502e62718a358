// The base layer's planes from their prediction errors (docs/format.md, "Base layer").
#pragma once
#include <cstdint>

namespace sgi {

// Adds to every element of plane [rows, columns] its prediction from the elements to the left, above, and above to the
// left, by predictor 0..3. Stops at the first value beyond +-most and returns false.
bool add_predictions(int64_t *plane, int64_t rows, int64_t columns, int predictor, int64_t most);

}  // namespace sgi
