// The C interface: arguments are checked.
#include <sgi.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstring>
#include <locale>
#include <memory>
#include <optional>
#include <sstream>
#include <string>

#include "base/error.hpp"
#include "bitstream/container.hpp"
#include "capi/callback_source.hpp"
#include "capi/status.hpp"
#include "decoder/stream.hpp"

struct sgi_stream {
  sgi::Stream stream;
  std::vector<sgi::Level> levels;
};

namespace {

using sgi::Error;
using sgi::Fault;
using sgi::capi::CallbackSource;
using sgi::capi::guarded;
using sgi::capi::misuse;
using sgi::capi::require;
using sgi::capi::Stopped;

constexpr size_t kMaxStruct = 4096;  // bytes; more is a size that was never set
constexpr int kMaxThreads = 1024;
constexpr double kFarthest = double(int64_t(1) << 30);  // pixels from the picture's corner
constexpr int64_t kMaxSamples = int64_t(1) << 31;       // of one call

// Up to the last fields of the first version, 0.1: a program may know no later one.
constexpr size_t kMinOptions = offsetof(sgi_options, tile_bytes) + sizeof(sgi_options::tile_bytes);
constexpr size_t kMinInfo = offsetof(sgi_info, file_bytes) + sizeof(sgi_info::file_bytes);
constexpr size_t kMinView = offsetof(sgi_view, no_dither) + sizeof(sgi_view::no_dither);

size_t size_of(const void *given, size_t least, const char *name) {
  require(given, "a null pointer");
  size_t size;
  std::memcpy(&size, given, sizeof size);
  if (size < least || size > kMaxStruct)
    misuse(std::string(name) + ".struct_size is " + std::to_string(size) + "; set it to sizeof(" + name + ")");
  return size;
}

// What a caller gave, who may know an earlier version of the structure, or a later one: what is beyond this one must be
// 0.
template <class T>
T taken(const T *given, size_t least, const char *name) {
  const size_t size = size_of(given, least, name), known = std::min(size, sizeof(T));
  const auto *bytes = reinterpret_cast<const unsigned char *>(given);
  if (std::any_of(bytes + known, bytes + size, [](unsigned char byte) { return byte; }))
    misuse(std::string(name) + " asks for what this version of the library does not know");
  T copy{};
  std::memcpy(&copy, given, known);
  return copy;
}

// Fills what a caller wants filled, who may know an earlier or a later version.
template <class T>
void give(T *wanted, T found, size_t least, const char *name) {
  found.struct_size = size_of(wanted, least, name);
  std::memset(static_cast<void *>(wanted), 0, found.struct_size);
  std::memcpy(static_cast<void *>(wanted), &found, std::min(found.struct_size, sizeof found));
}

sgi::DecoderSettings settings_of(const sgi_options *given) {
  sgi::DecoderSettings settings;
  settings.isa = sgi::choose_isa("auto");
  if (!given) return settings;
  const sgi_options options = taken(given, kMinOptions, "sgi_options");
  require(options.threads >= 0, "options.threads must not be negative");
  settings.threads = std::min(options.threads, kMaxThreads);
  const auto bytes = [](uint64_t given) { return int64_t(std::min(given, uint64_t(INT64_MAX))); };
  if (options.cache_bytes) settings.cache_bytes = bytes(options.cache_bytes);
  if (options.tile_bytes) settings.tile_memory = bytes(options.tile_bytes);
  if (options.proceed)
    settings.between = [options] {
      if (!options.proceed(options.proceed_user)) throw Stopped{};
    };
  return settings;
}

template <class MakeSource>
sgi_status opened_by(const MakeSource &make_source, const sgi_options *options, sgi_stream **stream) noexcept {
  return guarded([&] {
    require(stream, "a null pointer for the stream");
    *stream = nullptr;
    const sgi::DecoderSettings settings = settings_of(options);
    std::unique_ptr<sgi_stream> opened(new sgi_stream{{make_source(), settings}, {}});
    const sgi::Header &header = opened->stream.header();
    opened->levels = sgi::levels_of(header.width, header.height);
    *stream = opened.release();
  });
}

sgi_stream &checked(sgi_stream *stream) {
  require(stream, "a null pointer for the stream");
  return *stream;
}

sgi_info info_of(const sgi_stream &stream) {
  const sgi::Header &header = stream.stream.header();
  sgi_info info{};
  info.width = uint32_t(header.width), info.height = uint32_t(header.height);
  info.channels = uint32_t(header.spec.channels);
  info.layout = int(header.channels), info.sample = int(header.sample_type);
  info.low = float(header.low[0]), info.high = float(header.high[0]);
  info.tiles = uint32_t(header.grid().count()), info.tile_size = uint32_t(header.tile);
  info.has_nodata = header.masked == sgi::Masked::nodata, info.nodata = header.nodata;
  info.has_overview = stream.stream.has_overview();
  info.levels = uint32_t(stream.levels.size());
  info.file_bytes = stream.stream.chunks().size();
  return info;
}

std::string region_text(const sgi_view &view) {
  std::ostringstream out;
  out.imbue(std::locale::classic());
  out.precision(12);
  out << view.x << ',' << view.y << ',' << view.width << ',' << view.height;
  return out.str();
}

// The region and the size of a view.
sgi::PictureView picture_view(const sgi_view &view, const sgi::Header &header) {
  const auto refuse = [&](const std::string &why) {
    throw Error(Fault::region, "region " + region_text(view) + " " + why);
  };
  const auto is_near = [](double place) { return std::fabs(place) <= kFarthest; };  // false for not-a-number
  if (!(is_near(view.x) && is_near(view.y) && is_near(view.width) && is_near(view.height))) refuse("is too far away");
  if (!(view.width > 0 && view.height > 0)) refuse("holds no picture");
  const double right = view.x + view.width, bottom = view.y + view.height;
  if (!view.boundless && (view.x < 0 || view.y < 0 || right > double(header.width) || bottom > double(header.height)))
    refuse("is not inside the picture of " + std::to_string(header.width) + "×" + std::to_string(header.height) +
           " pixels");
  require(view.columns && view.rows, "a view of no columns or no rows");
  const int64_t columns = view.columns, rows = view.rows;
  if (std::max(columns, rows) > sgi::kMaxSide || columns * rows > kMaxSamples / header.spec.channels)
    misuse(std::to_string(columns) + "×" + std::to_string(rows) + " pixels are too many for one call");
  const sgi::PictureView found{view.x, view.y, columns / view.width, rows / view.height, columns, rows};
  const double most = double(sgi::kMaxSide);
  if (!(found.sx <= most && found.sy <= most)) refuse("is too small");
  return found;
}

void check_buffer(const void *buffer, size_t stride, const sgi_view &view, const sgi::Header &header) {
  require(buffer, "a null pointer for the buffer");
  require(view.sample >= SGI_SAMPLE_U8 && view.sample <= SGI_SAMPLE_F32, "view.sample is no sgi_sample");
  const size_t bytes = view.sample == SGI_SAMPLE_U8 ? 1 : view.sample == SGI_SAMPLE_U16 ? 2 : 4;
  const size_t row = bytes * size_t(view.columns) * size_t(header.spec.channels);
  if (stride < row) misuse("a stride of " + std::to_string(stride) + " bytes; a row takes " + std::to_string(row));
  require(stride <= size_t(PTRDIFF_MAX) / view.rows, "a buffer larger than memory can be");
  require(reinterpret_cast<uintptr_t>(buffer) % bytes == 0 && stride % bytes == 0,
          "the buffer and its stride must be multiples of the size of a sample");
}

}  // namespace

const char *sgi_version(void) { return SGI_VERSION; }

int sgi_is_stream(const void *bytes, size_t size) {
  return bytes && size >= sgi::kSignatureBytes && !std::memcmp(bytes, sgi::kSignature, sgi::kSignatureBytes);
}

sgi_status sgi_open_memory(const void *bytes, size_t size, const sgi_options *options, sgi_stream **stream) {
  return opened_by(
      [&] {
        require(bytes || !size, "a null pointer for the bytes");
        return sgi::memory_source({static_cast<const uint8_t *>(bytes), size});
      },
      options, stream);
}

sgi_status sgi_open(sgi_read read, void *user, uint64_t size, const sgi_options *options, sgi_stream **stream) {
  return opened_by(
      [&]() -> std::unique_ptr<sgi::ByteSource> {
        require(read, "a null pointer for the callback");
        return std::make_unique<CallbackSource>(read, user, size);
      },
      options, stream);
}

void sgi_close(sgi_stream *stream) { delete stream; }

const char *sgi_error(void) { return sgi::capi::last_text; }

const char *sgi_status_text(sgi_status status) {
  switch (int(status)) {
    case SGI_OK: return "success";
    case SGI_ERROR_USAGE: return "an argument that makes no sense";
    case SGI_ERROR_REGION: return "a region or a level that is not in the picture";
    case SGI_ERROR_CORRUPT: return "bytes that no encoder wrote";
    case SGI_ERROR_UNSUPPORTED: return "a stream that needs a newer library";
    case SGI_ERROR_LIMIT: return "more than the caps allow";
    case SGI_ERROR_SOURCE: return "reading failed";
    case SGI_ERROR_MEMORY: return "no memory left";
    case SGI_ERROR_INTERNAL: return "a defect of the library";
    case SGI_ERROR_STOPPED: return "stopped by the caller";
  }
  return "no status of this library";
}

sgi_status sgi_get_info(sgi_stream *stream, sgi_info *info) {
  return guarded([&] { give(info, info_of(checked(stream)), kMinInfo, "sgi_info"); });
}

sgi_status sgi_get_level(sgi_stream *stream, uint32_t level, uint32_t *width, uint32_t *height) {
  return guarded([&] {
    const auto &levels = checked(stream).levels;
    require(width && height, "a null pointer for the size");
    if (level >= levels.size())
      throw Error(Fault::region,
                  "level " + std::to_string(level) + "; there are 0 to " + std::to_string(levels.size() - 1));
    *width = uint32_t(levels[level].width), *height = uint32_t(levels[level].height);
  });
}

sgi_status sgi_get_range(sgi_stream *stream, uint32_t channel, float *low, float *high) {
  return guarded([&] {
    const sgi::Header &header = checked(stream).stream.header();
    require(low && high, "a null pointer for the range");
    const uint32_t channels = uint32_t(header.spec.channels);
    if (channel >= channels)
      misuse("channel " + std::to_string(channel) + "; there are 0 to " + std::to_string(channels - 1));
    *low = float(header.low[channel]), *high = float(header.high[channel]);
  });
}

sgi_status sgi_get_metadata(sgi_stream *stream, sgi_metadata kind, const void **bytes, size_t *size) {
  return guarded([&] {
    require(bytes && size, "a null pointer for the metadata");
    *bytes = nullptr, *size = 0;
    const auto &blobs = checked(stream).stream.chunks().blobs();
    require(int(kind) >= SGI_METADATA_ICC && int(kind) <= SGI_METADATA_SOFTWARE, "no kind of metadata");
    const auto found = blobs.find("icxgs"[int(kind)]);
    if (found == blobs.end()) return;
    *size = found->second.size();
    *bytes = *size ? static_cast<const void *>(found->second.data()) : "";
  });
}

sgi_status sgi_draw(sgi_stream *stream, const sgi_view *view, void *buffer, size_t stride) {
  return guarded([&] {
    sgi::Stream &drawn = checked(stream).stream;
    const sgi_view wanted = taken(view, kMinView, "sgi_view");
    const sgi::PictureView shown = picture_view(wanted, drawn.header());
    check_buffer(buffer, stride, wanted, drawn.header());
    constexpr sgi::Output outputs[] = {sgi::Output::u8, sgi::Output::u16, sgi::Output::f32};
    const sgi::DrawOptions how{wanted.exact != 0, !wanted.no_dither, wanted.lossy != 0};
    drawn.draw(shown, 0, shown.rows, outputs[wanted.sample], how, buffer, int64_t(stride));
  });
}

sgi_status sgi_verify(sgi_stream *stream, uint32_t *crc) {
  return guarded([&] {
    sgi::Stream &verified = checked(stream).stream;
    const uint32_t found = verified.survey().symbol_crc;
    if (verified.has_overview()) verified.overview().survey();
    if (crc) *crc = found;
  });
}
