#include "tags.hpp"

#include <algorithm>
#include <cstring>

namespace {

constexpr size_t kHead = 8, kRow = 12, kMax = 1 << 28;
constexpr uint16_t kAscii = 2, kShort = 3, kLong = 4;

// A little-endian or big-endian structure.
struct Order {
  bool is_little;

  uint32_t get(const uint8_t *at, int bytes) const {
    uint32_t value = 0;
    for (int i = 0; i < bytes; ++i) value |= uint32_t(at[i]) << 8 * (is_little ? i : bytes - 1 - i);
    return value;
  }
  void put(uint8_t *at, uint32_t value, int bytes) const {
    for (int i = 0; i < bytes; ++i) at[i] = uint8_t(value >> 8 * (is_little ? i : bytes - 1 - i));
  }
};

struct Row {
  uint8_t bytes[kRow];
};

Row row_of(const Order &order, uint16_t tag, uint16_t type, uint32_t value) {
  Row row{};
  order.put(row.bytes, tag, 2);
  order.put(row.bytes + 2, type, 2);
  order.put(row.bytes + 4, 1, 4);
  order.put(row.bytes + 8, value, type == kShort ? 2 : 4);
  return row;
}

bool is_tiff(const uint8_t *tags, size_t size) {
  return size >= kHead && size <= kMax && (!std::memcmp(tags, "II*\0", 4) || !std::memcmp(tags, "MM\0*", 4));
}

// The rows of the first directory; none if it does not lie inside.
std::vector<Row> rows_of(const uint8_t *tags, size_t size, const Order &order) {
  const size_t directory = order.get(tags + 4, 4);
  if (directory < kHead || directory + 2 > size) return {};
  const size_t count = order.get(tags + directory, 2);
  if (kRow * count > size - directory - 2) return {};
  std::vector<Row> rows(count);
  if (count) std::memcpy(rows.data(), tags + directory + 2, kRow * count);
  return rows;
}

// Those of a picture of one black pixel, whose samples stand at a place.
std::vector<Row> picture_rows(const Order &order, const Layout &layout, uint32_t place) {
  constexpr uint32_t kDark = 1, kColour = 2, kAlpha = 2;
  const uint32_t bands = uint32_t(layout.bands);
  std::vector<Row> rows = {
      row_of(order, 256, kShort, 1),  // width, height, bits of a sample, no compression
      row_of(order, 257, kShort, 1),     row_of(order, 258, kShort, 8),
      row_of(order, 259, kShort, 1),     row_of(order, 262, kShort, layout.is_colour ? kColour : kDark),
      row_of(order, 273, kLong, place),  // the only strip, bands, rows and bytes of it
      row_of(order, 277, kShort, bands), row_of(order, 278, kShort, 1),
      row_of(order, 279, kLong, bands)};
  if (layout.has_alpha) rows.push_back(row_of(order, 338, kShort, kAlpha));
  return rows;
}

}  // namespace

std::vector<uint8_t> as_tiff(const uint8_t *tags, size_t size, const Layout &layout,
                             std::initializer_list<uint16_t> wanted) {
  if (!is_tiff(tags, size)) return {};
  const Order order{tags[0] == 'I'};
  const auto tag_of = [&](const Row &row) { return uint16_t(order.get(row.bytes, 2)); };
  const uint32_t pixel = uint32_t(size + size % 2), directory = pixel + uint32_t(layout.bands + layout.bands % 2);
  std::vector<Row> rows = picture_rows(order, layout, pixel);
  for (const Row &row : rows_of(tags, size, order))
    if (std::find(wanted.begin(), wanted.end(), tag_of(row)) != wanted.end()) rows.push_back(row);
  std::stable_sort(rows.begin(), rows.end(), [&](const Row &a, const Row &b) { return tag_of(a) < tag_of(b); });
  std::vector<uint8_t> tiff(tags, tags + size);
  tiff.resize(directory + 2 + kRow * rows.size() + 4);
  order.put(tiff.data() + 4, directory, 4);
  order.put(tiff.data() + directory, uint32_t(rows.size()), 2);
  std::memcpy(tiff.data() + directory + 2, rows.data(), kRow * rows.size());
  return tiff;
}

std::string text_of(const std::vector<uint8_t> &tiff, uint16_t tag) {
  if (!is_tiff(tiff.data(), tiff.size())) return {};
  const Order order{tiff[0] == 'I'};
  for (const Row &row : rows_of(tiff.data(), tiff.size(), order)) {
    if (order.get(row.bytes, 2) != tag || order.get(row.bytes + 2, 2) != kAscii) continue;
    const size_t length = order.get(row.bytes + 4, 4), place = order.get(row.bytes + 8, 4);
    if (length > 4 && (place > tiff.size() || length > tiff.size() - place)) return {};
    const char *text = reinterpret_cast<const char *>(length > 4 ? tiff.data() + place : row.bytes + 8);
    return std::string(text, strnlen(text, length));
  }
  return {};
}
