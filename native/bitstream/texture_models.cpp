#include "bitstream/texture_models.hpp"

#include <algorithm>
#include <cstddef>

namespace sgi {

std::vector<int32_t> BitModels::logits() const {
  std::vector<int32_t> logits;
  for (const BitModel &model : models_) logits.push_back(int32_t(model.word) >> BitModel::kCountBits);
  return logits;
}

bool BitModels::start(Bytes bytes) {
  if (bytes.size != models_.size()) return false;
  std::fill(models_.begin(), models_.end(), BitModel());
  for (size_t i = 0; i < models_.size(); ++i) models_[i].move(int32_t(int8_t(bytes.data[i])) * (1 << 12));
  return true;
}

}  // namespace sgi
