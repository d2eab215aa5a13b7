#include "record/mcap/codec.h"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <string>

namespace sandlot::mcap {
namespace {

/// Gives `step(to, room)` room to write until it says that all is there; `room` shrinks to what it wrote.
/// Grows by what came out so far, so that a small lie about the size costs little memory.
template <class Step>
Status grow_and_fill(std::uint64_t size, std::size_t stored, std::vector<std::byte>& out, Step&& step) {
  out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, 64 * 1024 + 8 * std::uint64_t{stored})));
  std::size_t filled = 0;
  for (;;) {
    std::size_t room = out.size() - filled;
    SL_ASSIGN(const bool done, step(out.data() + filled, room));
    filled += room;
    if (done) break;
    if (filled < out.size()) {
      if (room == 0) return Error{"the compressed records are cut short"};
      continue;
    }
    if (filled >= size) {
      // The end mark may still be to come, and then nothing more.
      std::byte beyond{};
      std::size_t one = 1;
      SL_ASSIGN(const bool ended, step(&beyond, one));
      if (!ended || one != 0) return Error{"there are more records than the chunk says"};
      break;
    }
    out.resize(static_cast<std::size_t>(std::min<std::uint64_t>(size, 2 * std::uint64_t{filled})));
  }
  if (filled != size) return Error{"there are fewer records than the chunk says"};
  return {};
}

Status decompress_lz4(std::span<const std::byte> stored, std::uint64_t size, std::vector<std::byte>& out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)))
    return Error{"there is no memory to decompress with"};
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(raw,
                                                                             LZ4F_freeDecompressionContext);
  SL_TRY(grow_and_fill(size, stored.size(), out, [&](std::byte* to, std::size_t& room) -> Result<bool> {
    std::size_t taken = stored.size();
    const std::size_t hint = LZ4F_decompress(raw, to, &room, stored.data(), &taken, nullptr);
    if (LZ4F_isError(hint)) return Error{std::string("lz4: ") + LZ4F_getErrorName(hint)};
    stored = stored.subspan(taken);
    return hint == 0;
  }));
  if (!stored.empty()) return Error{"there are bytes behind the compressed records"};
  return {};
}

Status decompress_zstd(std::span<const std::byte> stored, std::uint64_t size, std::vector<std::byte>& out) {
  const std::unique_ptr<ZSTD_DCtx, std::size_t (*)(ZSTD_DCtx*)> context(ZSTD_createDCtx(), ZSTD_freeDCtx);
  if (!context) return Error{"there is no memory to decompress with"};
  ZSTD_inBuffer in{stored.data(), stored.size(), 0};
  SL_TRY(grow_and_fill(size, stored.size(), out, [&](std::byte* to, std::size_t& room) -> Result<bool> {
    ZSTD_outBuffer part{to, room, 0};
    const std::size_t hint = ZSTD_decompressStream(context.get(), &part, &in);
    if (ZSTD_isError(hint)) return Error{std::string("zstd: ") + ZSTD_getErrorName(hint)};
    room = part.pos;
    return hint == 0;
  }));
  if (in.pos != in.size) return Error{"there are bytes behind the compressed records"};
  return {};
}

}  // namespace

const char* file_name(Compression compression) {
  return compression == Compression::lz4 ? "lz4" : compression == Compression::zstd ? "zstd" : "";
}

struct Compressor::Context {
  std::unique_ptr<ZSTD_CCtx, std::size_t (*)(ZSTD_CCtx*)> zstd{nullptr, ZSTD_freeCCtx};
};

Compressor::Compressor(Compression compression)
    : compression_(compression), context_(std::make_unique<Context>()) {
  if (compression == Compression::zstd) context_->zstd.reset(ZSTD_createCCtx());
}
Compressor::Compressor(Compressor&&) noexcept = default;
Compressor::~Compressor() = default;

Status Compressor::compress(std::span<const std::byte> raw, std::vector<std::byte>& out) {
  const std::size_t at = out.size();
  std::size_t written = raw.size();
  switch (compression_) {
    case Compression::none: out.insert(out.end(), raw.begin(), raw.end()); break;
    case Compression::lz4: {
      LZ4F_preferences_t preferences{};
      preferences.frameInfo.blockSizeID = LZ4F_max1MB;
      preferences.frameInfo.contentSize = raw.size();
      out.resize(at + LZ4F_compressFrameBound(raw.size(), &preferences));
      written = LZ4F_compressFrame(out.data() + at, out.size() - at, raw.data(), raw.size(), &preferences);
      if (LZ4F_isError(written)) return Error{std::string("lz4: ") + LZ4F_getErrorName(written)};
      break;
    }
    case Compression::zstd: {
      constexpr int level = 1;
      if (!context_->zstd) return Error{"there is no memory to compress with"};
      out.resize(at + ZSTD_compressBound(raw.size()));
      written = ZSTD_compressCCtx(context_->zstd.get(), out.data() + at, out.size() - at, raw.data(),
                                  raw.size(), level);
      if (ZSTD_isError(written)) return Error{std::string("zstd: ") + ZSTD_getErrorName(written)};
      break;
    }
  }
  out.resize(at + written);
  return {};
}

Status decompress(std::string_view compression, std::span<const std::byte> stored, std::uint64_t size,
                  std::vector<std::byte>& out) {
  if (compression == "lz4") return decompress_lz4(stored, size, out);
  if (compression == "zstd") return decompress_zstd(stored, size, out);
  if (!compression.empty())
    return Error{"the compression '" + std::string(compression.substr(0, 40)) + "' is not known",
                 "this Sandlot reads lz4, zstd and none"};
  if (stored.size() != size) return Error{"the chunk's two sizes differ although it is not compressed"};
  out.assign(stored.begin(), stored.end());
  return {};
}

}  // namespace sandlot::mcap
