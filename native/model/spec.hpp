// The model specification: what encoder and decoder must share, and the groups of seed attributes.
#pragma once
#include <vector>

namespace sgi {

enum class SeedLayoutKind { adaptive, uniform };
enum class GroupName { colour, shape, feature, scales, offset };

// Attributes of a seed that are coded together: columns [start, start + size) of the attribute matrix.
struct SeedGroup {
  GroupName name;
  int start, size;
};

// What MLP_p may see, and where its weights come from.
struct ContextSpec {
  int prior = 0;  // number of a shipped network; 0: the weights travel in the stream
  int hidden = 1;
  int neighbours = 0;  // seeds of earlier passes that a seed sees; 0: all seeds are one pass
  std::vector<int> hash_resolutions;
  int hash_features = 4, hash_log2_entries = 13;
};

// The architecture, field by field as in docs/format.md, "Header fields".
struct ModelSpec {
  int channels = 1;
  SeedLayoutKind layout = SeedLayoutKind::adaptive;  // and what seeds hold, see is_plain()
  int per_seed = 1;                                  // K
  int features = 4;                                  // D
  int hidden = 0;                                    // of MLP_c and MLP_Sigma; 0: there are none
  int base_cell = 0;                                 // pixels; 0: no base layer
  ContextSpec context;
  bool texture = false, luma_space = false, restoration = false;

  // In coding order; their sizes sum to `attributes`.
  std::vector<SeedGroup> groups() const;
  int attributes() const;
  // Whether seeds hold their Gaussians as they are: colours, log-covariances, offsets. Others hold features, of which
  // decoders make colours and rotations, scales and offsets.
  bool is_plain() const { return layout == SeedLayoutKind::adaptive; }
};

}  // namespace sgi
