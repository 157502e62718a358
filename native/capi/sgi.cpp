// The C interface but for drawing: arguments are checked.
#include <sgi.h>

#include <algorithm>
#include <cstring>
#include <memory>
#include <string>

#include "base/error.hpp"
#include "bitstream/container.hpp"
#include "capi/callback_source.hpp"
#include "capi/handle.hpp"
#include "capi/prefix_source.hpp"
#include "capi/structures.hpp"

namespace {

using sgi::Error;
using sgi::Fault;
using namespace sgi::capi;

constexpr int kMaxThreads = 1024;

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

// What a header says, and no more.
sgi_info info_of(const sgi::Header &header) {
  sgi_info info{};
  info.width = uint32_t(header.width), info.height = uint32_t(header.height);
  info.channels = uint32_t(header.spec.channels);
  info.layout = int(header.channels), info.sample = int(header.sample_type);
  info.low = float(header.low[0]), info.high = float(header.high[0]);
  info.tiles = uint32_t(header.grid().count()), info.tile_size = uint32_t(header.tile);
  info.has_nodata = header.masked == sgi::Masked::nodata, info.nodata = header.nodata;
  info.levels = uint32_t(sgi::levels_of(header.width, header.height).size());
  return info;
}

sgi_info info_of(const sgi_stream &stream) {
  sgi_info info = info_of(stream.stream.header());
  info.has_overview = stream.stream.has_overview();
  info.file_bytes = stream.stream.chunks().size();
  return info;
}

}  // namespace

const char *sgi_version(void) { return SGI_VERSION; }

int sgi_is_stream(const void *bytes, size_t size) {
  return bytes && size >= sgi::kSignatureBytes && !std::memcmp(bytes, sgi::kSignature, sgi::kSignatureBytes);
}

sgi_status sgi_probe(const void *bytes, size_t size, sgi_info *info) {
  return guarded([&] {
    require(bytes || !size, "a null pointer for the bytes");
    const sgi::Bytes prefix{static_cast<const uint8_t *>(bytes), size};
    sgi::ChunkReader chunks(std::make_unique<PrefixSource>(prefix), "");
    sgi::Chunk header;
    chunks.next(header);
    const auto payload = chunks.payload(header);
    give(info, info_of(sgi::decode_header({payload.data(), payload.size()})), kMinInfo, "sgi_info");
  });
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

sgi_status sgi_get_max_error(sgi_stream *stream, double *max_error) {
  return guarded([&] {
    require(max_error, "a null pointer for the error");
    *max_error = checked(stream).stream.max_error();
  });
}

sgi_status sgi_get_exact_views(sgi_stream *stream, int *exact_views) {
  return guarded([&] {
    require(exact_views, "a null pointer for the exact views");
    *exact_views = checked(stream).stream.has_exact_views();
  });
}

sgi_status sgi_get_metadata(sgi_stream *stream, sgi_metadata kind, const void **bytes, size_t *size) {
  return guarded([&] {
    require(bytes && size, "a null pointer for the metadata");
    *bytes = nullptr, *size = 0;
    const auto &blobs = checked(stream).stream.chunks().blobs();
    unsigned number;  // a caller may give any, which is no value of the enumeration
    static_assert(sizeof number == sizeof kind);
    std::memcpy(&number, &kind, sizeof number);
    require(number <= SGI_METADATA_SOFTWARE, "no kind of metadata");
    const auto found = blobs.find("icxgs"[number]);
    if (found == blobs.end()) return;
    *size = found->second.size();
    *bytes = *size ? static_cast<const void *>(found->second.data()) : "";
  });
}

sgi_status sgi_verify(sgi_stream *stream, uint32_t *crc) {
  return guarded([&] {
    sgi::Stream &verified = checked(stream).stream;
    const uint32_t found = verified.survey().symbol_crc;
    if (verified.has_overview()) verified.overview().survey();
    verified.check_exact();
    if (crc) *crc = found;
  });
}
