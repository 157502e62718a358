// Texture: a block of threads draws a block of pixels, cell by cell in their order. A cell is two small products of
// matrices: amplitudes times basis functions along x are its lines, and basis functions along y times lines
// its pixels.
#pragma once
#include "cuda/arguments.hpp"
#include "cuda/base/block.hpp"

namespace sgi {

constexpr int kTextureThreads = 256, kTextureBlock = 32, kTextureFields = 9, kTextureChannels = 4;
constexpr int kTexturePixels = kTextureBlock * kTextureBlock / kTextureThreads;

namespace {

using TextureLines = float[kTextureBlock][kTextureBlock];

// A cell as TextureTables has it, in one block of pixels.
struct TextureCell {
  int side, begin, left, columns, across, stride, top, rows, down;
};

inline TextureCell texture_cell(const TextureArguments &a, int shown, int block) {
  const int32_t *f = a.cells + int64_t(a.shown[shown]) * kTextureFields;
  const int x = block % a.blocks_across * kTextureBlock, y = block / a.blocks_across * kTextureBlock;
  return {f[0], f[1], f[2] - x, f[3], f[4], f[5], f[6] - y, f[7], f[8]};
}

inline void draw_lines(const TextureArguments &a, const TextureCell &cell, int channel, int t, TextureLines &lines) {
  const float *amplitudes = a.amplitudes + cell.begin + channel * cell.side * cell.side;
  for (int at = t; at < cell.side * kTextureBlock; at += kTextureThreads) {
    const int line = at / kTextureBlock, column = at % kTextureBlock - cell.left;
    float sum = 0.0f;
    if (column >= 0 && column < cell.columns)
      for (int k = 0; k < cell.side; ++k)
        sum += amplitudes[line * cell.side + k] * a.across[cell.across + int64_t(k) * cell.stride + column];
    lines[line][at % kTextureBlock] = sum;
  }
}

struct TextureSums {
  float value[kTextureChannels][kTexturePixels];
};

inline int row_of(int t, int q) { return t / kTextureBlock + q * (kTextureThreads / kTextureBlock); }

inline void add_pixels(const TextureArguments &a, const TextureCell &cell, int t, const TextureLines &lines,
                       float *sums) {
  for (int q = 0; q < kTexturePixels; ++q) {
    const int row = row_of(t, q) - cell.top;
    if (row < 0 || row >= cell.rows) continue;
    const float *atoms = a.down + cell.down + int64_t(row) * cell.side;
    for (int k = 0; k < cell.side; ++k) sums[q] += atoms[k] * lines[k][t % kTextureBlock];
  }
}

inline void write_texture(const TextureArguments &a, int block, int t, const TextureSums &sums) {
  const int column = block % a.blocks_across * kTextureBlock + t % kTextureBlock;
  for (int q = 0; q < kTexturePixels; ++q) {
    const int row = block / a.blocks_across * kTextureBlock + row_of(t, q);
    if (row >= a.height || column >= a.width) continue;
#pragma unroll
    for (int c = 0; c < kTextureChannels; ++c) {
      if (c >= a.channels) break;
      float value = sums.value[c][q];
      if (a.mix && c < 3)
        value = a.mix[c] * sums.value[0][q] + a.mix[3 + c] * sums.value[1][q] + a.mix[6 + c] * sums.value[2][q];
      a.planes[(int64_t(c) * a.height + row) * a.width + column] = value;
    }
  }
}

}  // namespace

SGI_KERNEL(draw_cells, kTextureThreads, TextureArguments) {
  SGI_SHARED(TextureLines, lines);
  PerThread<TextureSums, kTextureThreads> sums;
  block.each([&](int t) { sums[t] = TextureSums{}; });
  for (int i = a.start[block.index()]; i < a.start[block.index() + 1]; ++i) {
    const TextureCell cell = texture_cell(a, i, block.index());
#pragma unroll
    for (int c = 0; c < kTextureChannels; ++c) {  // sums stay in registers
      if (c >= a.channels) break;
      block.each([&](int t) { draw_lines(a, cell, c, t, lines); });
      block.each([&](int t) { add_pixels(a, cell, t, lines, sums[t].value[c]); });
    }
  }
  block.each([&](int t) { write_texture(a, block.index(), t, sums[t]); });
}

}  // namespace sgi
