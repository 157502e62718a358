// Drawing by the C interface: views and buffers are checked.
#include <sgi.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <locale>
#include <sstream>
#include <string>
#include <vector>

#include "base/error.hpp"
#include "capi/handle.hpp"
#include "capi/pixel_order.hpp"
#include "capi/structures.hpp"

namespace {

using namespace sgi::capi;
using sgi::ChannelLayout;
using sgi::Error;
using sgi::Fault;
using sgi::Header;
using sgi::PictureView;
using sgi::SampleType;

constexpr double kFarthest = double(int64_t(1) << 30);  // pixels from the picture's corner
constexpr int64_t kMaxSamples = int64_t(1) << 31;       // of one call

SampleType type_of(const sgi_view &view) { return SampleType(view.sample); }

bool has_four(const sgi_view &view) { return view.pixels != SGI_PIXELS_CHANNELS; }

// Of each pixel of the buffer.
int64_t samples_of(const sgi_view &view, const Header &header) { return has_four(view) ? 4 : header.spec.channels; }

int64_t row_count(const sgi_view &view) { return view.row_count ? view.row_count : view.rows - view.first_row; }

[[noreturn]] void refuse_region(const sgi_view &view, const std::string &why) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(12);
  out << "region " << view.x << ',' << view.y << ',' << view.width << ',' << view.height << ' ' << why;
  throw Error(Fault::region, out.str());
}

void check_region(const sgi_view &view, const Header &header) {
  const auto is_near = [](double place) { return std::fabs(place) <= kFarthest; };  // false for not-a-number
  if (!(is_near(view.x) && is_near(view.y) && is_near(view.width) && is_near(view.height)))
    refuse_region(view, "is too far away");
  if (!(view.width > 0 && view.height > 0)) refuse_region(view, "holds no picture");
  const double right = view.x + view.width, bottom = view.y + view.height;
  if (!view.boundless && (view.x < 0 || view.y < 0 || right > double(header.width) || bottom > double(header.height)))
    refuse_region(view, "is not inside the picture of " + std::to_string(header.width) + "×" +
                            std::to_string(header.height) + " pixels");
  require(view.columns && view.rows, "a view of no columns or no rows");
}

void check_pixels(const sgi_view &view, const Header &header) {
  require(view.sample >= SGI_SAMPLE_U8 && view.sample <= SGI_SAMPLE_F32, "view.sample is no sgi_sample");
  require(view.pixels >= SGI_PIXELS_CHANNELS && view.pixels <= SGI_PIXELS_BGRA, "view.pixels is no sgi_pixels");
  require(!view.premultiplied || has_four(view), "view.premultiplied goes with RGBA and BGRA");
  if (has_four(view) && header.channels == ChannelLayout::multi)
    misuse(std::to_string(header.spec.channels) + " bands without a meaning have no colours; draw the channels");
  require(view.first_row < view.rows && view.row_count <= view.rows - view.first_row, "rows that the view lacks");
  const int64_t columns = view.columns, rows = row_count(view);
  if (std::max(columns, int64_t(view.rows)) > sgi::kMaxSide || columns * rows > kMaxSamples / samples_of(view, header))
    misuse(std::to_string(columns) + "×" + std::to_string(rows) + " pixels are too many for one call");
  const double most = double(sgi::kMaxSide);
  if (!(view.columns / view.width <= most && view.rows / view.height <= most)) refuse_region(view, "is too small");
}

void check_buffer(const void *buffer, size_t stride, const sgi_view &view, const Header &header) {
  require(buffer, "a null pointer for the buffer");
  const size_t bytes = size_t(bytes_of(type_of(view))), row = bytes * view.columns * size_t(samples_of(view, header));
  if (stride < row) misuse("a stride of " + std::to_string(stride) + " bytes; a row takes " + std::to_string(row));
  require(stride <= size_t(PTRDIFF_MAX) / size_t(row_count(view)), "a buffer larger than memory can be");
  require(reinterpret_cast<uintptr_t>(buffer) % bytes == 0 && stride % bytes == 0,
          "the buffer and its stride must be multiples of the size of a sample");
}

// Makes RGBA or BGRA of rows of channels, where they lie.
template <class T>
void give_colours(const sgi_view &view, const PictureView &shown, const Header &header, void *buffer, size_t stride) {
  const PixelOrder order{header.channels, view.pixels == SGI_PIXELS_BGRA, view.premultiplied != 0};
  const bool has_nodata = header.masked == sgi::Masked::nodata;
  const double nodata = sgi::SampleFormat(header, type_of(view), header.nodata).blank;
  const sgi::InnerView inner = sgi::inner_view(shown, header.width, header.height);
  const int64_t columns = view.columns, first = view.first_row;
  std::vector<uint8_t> empty(size_t(columns), 0);
  for (int64_t row = 0; row < row_count(view); ++row) {
    T *const samples = reinterpret_cast<T *>(static_cast<unsigned char *>(buffer) + size_t(row) * stride);
    if (has_nodata) find_nodata(samples, columns, header.spec.channels, header.colours(), nodata, empty.data());
    reorder(order, samples, columns, T(sgi::largest_of(type_of(view))));
    const int64_t y = first + row - inner.top;
    const bool is_outside = y < 0 || y >= inner.view.rows;
    for (int64_t column = 0; column < columns; ++column)
      if (is_outside || empty[size_t(column)] || column < inner.left || column >= inner.left + inner.view.columns)
        std::fill_n(samples + 4 * column, 4, T(0));
  }
}

}  // namespace

sgi_status sgi_draw(sgi_stream *stream, const sgi_view *view, void *buffer, size_t stride) {
  return guarded([&] {
    sgi::Stream &drawn = checked(stream).stream;
    const sgi_view wanted = taken(view, kMinView, "sgi_view");
    const Header &header = drawn.header();
    check_region(wanted, header);
    check_pixels(wanted, header);
    check_buffer(buffer, stride, wanted, header);
    const PictureView shown{wanted.x,       wanted.y,   wanted.columns / wanted.width, wanted.rows / wanted.height,
                            wanted.columns, wanted.rows};
    const sgi::DrawOptions how{wanted.exact != 0, !wanted.no_dither, wanted.lossy != 0};
    drawn.draw(shown, wanted.first_row, row_count(wanted), type_of(wanted), how, buffer, int64_t(stride));
    if (!has_four(wanted)) return;
    sgi::with_sample(type_of(wanted),
                     [&](auto sample) { give_colours<decltype(sample)>(wanted, shown, header, buffer, stride); });
  });
}
