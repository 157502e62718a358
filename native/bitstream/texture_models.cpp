#include "bitstream/texture_models.hpp"

#include <cstddef>

namespace sgi {

bool BitModels::start(const uint8_t *bytes, int64_t size) {
  if (size != int64_t(logits_.size())) return false;
  for (size_t i = 0; i < logits_.size(); ++i) logits_[i] = uint32_t(int32_t(int8_t(bytes[i])) * (1 << 12));
  return true;
}

}  // namespace sgi
