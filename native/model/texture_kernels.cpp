// Texture cells in vectors of LANES columns: two small products of matrices for each.
#include "base/vector.hpp"
#include "model/texture_kernel.hpp"

namespace sgi {
namespace {

constexpr int kMaxCellSide = 32;
constexpr int kWaves = 4;  // rows of amplitudes or of pixels side by side

// lines[v] = sum over u of amplitudes[v][u] * across[u], for VECTORS vectors of columns.
template <int VECTORS>
inline void draw_lines(const TexturePart &p, int at, vf (*lines)[VECTORS]) {
  for (int v = 0; v < p.waves_down; v += kWaves) {
    vf sum[kWaves][VECTORS] = {};
    for (int u = 0; u < p.waves_across; ++u) {
      const float *atom = p.across + u * p.across_stride + at;
      for (int i = 0; i < VECTORS; ++i) {
        const vf value = load(atom + i * LANES);
        for (int r = 0; r < kWaves; ++r) sum[r][i] += p.amplitudes[(v + r) * p.side + u] * value;
      }
    }
    for (int r = 0; r < kWaves; ++r)
      for (int i = 0; i < VECTORS; ++i) lines[v + r][i] = sum[r][i];
  }
}

// out[y] += sum over v of down[y][v] * lines[v] for ROWS rows.
template <int ROWS, int VECTORS>
inline void add_rows(const TexturePart &p, int y, const vf (*lines)[VECTORS], float *out, int64_t stride) {
  vf sum[ROWS][VECTORS];
  for (int r = 0; r < ROWS; ++r)
    for (int i = 0; i < VECTORS; ++i) sum[r][i] = load(out + (y + r) * stride + i * LANES);
  for (int v = 0; v < p.waves_down; ++v)
    for (int i = 0; i < VECTORS; ++i)
      for (int r = 0; r < ROWS; ++r) sum[r][i] += p.down[(y + r) * p.side + v] * lines[v][i];
  for (int r = 0; r < ROWS; ++r)
    for (int i = 0; i < VECTORS; ++i) store(out + (y + r) * stride + i * LANES, sum[r][i]);
}

template <int VECTORS>
inline void add_columns(const TexturePart &p, int at, float *out, int64_t stride) {
  vf lines[kMaxCellSide][VECTORS];
  draw_lines<VECTORS>(p, at, lines);
  int y = 0;
  for (; y + kWaves <= p.rows; y += kWaves) add_rows<kWaves, VECTORS>(p, y, lines, out + at, stride);
  for (; y < p.rows; ++y) add_rows<1, VECTORS>(p, y, lines, out + at, stride);
}

void add(const TexturePart &part, float *out, int64_t stride) {
  int at = 0;
  for (; at + 2 * LANES < part.columns; at += 3 * LANES) add_columns<3>(part, at, out, stride);
  if (at + LANES < part.columns) {
    add_columns<2>(part, at, out, stride);
  } else if (at < part.columns) {
    add_columns<1>(part, at, out, stride);
  }
}

}  // namespace

const TextureKernel TextureKernel::SGI_ISA{sgi::add};

}  // namespace sgi
