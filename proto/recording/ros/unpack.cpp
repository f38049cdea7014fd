#include "proto/recording/ros/unpack.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>

namespace odomcalib::ros {
namespace {

constexpr std::size_t kStep = std::size_t{1} << 16;  // bytes unpacked at a time
constexpr const char* kDamaged = "compressed data is damaged";
constexpr const char* kCutOff = "compressed data is cut off";
constexpr const char* kTooLarge = "unpacks to more than it states, or than the limit";

/// Result of one turn of a decompressor.
struct Turn {
  std::size_t taken = 0;  ///< bytes of the input
  std::size_t made = 0;   ///< bytes of the output
  bool ended = false;     ///< a frame ended
  bool failed = false;
};

/// @param turn (input, output buffer) -> Turn
template <typename Decompress>
Unpacked unpack_with(Decompress turn, std::string_view packed, std::size_t limit) {
  Unpacked result;
  auto step = std::make_unique<std::array<char, kStep>>();
  bool ended = false;
  while (!packed.empty() || !ended) {
    const Turn done = turn(packed, *step);
    if (done.failed) return {std::move(result.bytes), false, kDamaged};
    if (done.made > limit - result.bytes.size()) return {std::move(result.bytes), false, kTooLarge, true};
    result.bytes.append(step->data(), done.made);
    packed.remove_prefix(done.taken);
    ended = done.ended;
    if (done.taken == 0 && done.made == 0 && !ended) return {std::move(result.bytes), false, kCutOff};
  }
  return result;
}

Unpacked unpack_bz2(std::string_view packed, std::size_t limit) {
  bz_stream stream{};
  if (BZ2_bzDecompressInit(&stream, 0, 0) != BZ_OK) return {{}, false, "cannot start unpacking"};
  const std::unique_ptr<bz_stream, int (*)(bz_stream*)> end(&stream, BZ2_bzDecompressEnd);
  bool over = false;
  return unpack_with(
      [&](std::string_view in, std::array<char, kStep>& out) -> Turn {
        if (over) return {.failed = true};  // a chunk is one stream
        // bzlib never writes through next_in.
        stream.next_in = const_cast<char*>(in.data());  // NOLINT(cppcoreguidelines-pro-type-const-cast)
        stream.avail_in = static_cast<unsigned>(std::min<std::size_t>(in.size(), UINT32_MAX));
        const unsigned given = stream.avail_in;
        stream.next_out = out.data();
        stream.avail_out = static_cast<unsigned>(out.size());
        const int code = BZ2_bzDecompress(&stream);
        over = code == BZ_STREAM_END;
        return {given - stream.avail_in, out.size() - stream.avail_out, over, code != BZ_OK && !over};
      },
      packed, limit);
}

Unpacked unpack_lz4(std::string_view packed, std::size_t limit) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION)) != 0)
    return {{}, false, "cannot start unpacking"};
  const std::unique_ptr<LZ4F_dctx, LZ4F_errorCode_t (*)(LZ4F_dctx*)> context(raw,
                                                                             LZ4F_freeDecompressionContext);
  return unpack_with(
      [&](std::string_view in, std::array<char, kStep>& out) -> Turn {
        std::size_t taken = in.size(), made = out.size();
        const std::size_t code =
            LZ4F_decompress(context.get(), out.data(), &made, in.data(), &taken, nullptr);
        return {taken, made, code == 0, LZ4F_isError(code) != 0};
      },
      packed, limit);
}

Unpacked unpack_zstd(std::string_view packed, std::size_t limit) {
  const std::unique_ptr<ZSTD_DStream, std::size_t (*)(ZSTD_DStream*)> context(ZSTD_createDStream(),
                                                                              ZSTD_freeDStream);
  if (context == nullptr) return {{}, false, "cannot start unpacking"};
  return unpack_with(
      [&](std::string_view in, std::array<char, kStep>& out) -> Turn {
        ZSTD_inBuffer from{in.data(), in.size(), 0};
        ZSTD_outBuffer to{out.data(), out.size(), 0};
        const std::size_t code = ZSTD_decompressStream(context.get(), &to, &from);
        return {from.pos, to.pos, code == 0, ZSTD_isError(code) != 0};
      },
      packed, limit);
}

}  // namespace

bool is_zstd(std::string_view bytes) { return bytes.starts_with("\x28\xB5\x2F\xFD"); }

std::optional<std::uint64_t> stated_by_frame(std::string_view begin) {
  const auto size = ZSTD_getFrameContentSize(begin.data(), begin.size());
  if (size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR) return std::nullopt;
  return size;
}

Unpacked unpack(Packing packing, std::string_view packed, std::size_t limit) {
  switch (packing) {
    case Packing::bz2:
      return unpack_bz2(packed, limit);
    case Packing::lz4:
      return unpack_lz4(packed, limit);
    case Packing::zstd:
      return unpack_zstd(packed, limit);
    case Packing::none:
      break;
  }
  if (packed.size() > limit) return {std::string(packed.substr(0, limit)), false, kTooLarge, true};
  return {std::string(packed), true, {}};
}

/// @param bounded by what is left for the whole recording
Unpacked Unpacker::taken(Unpacked piece, bool bounded) {
  unpacked_ += piece.bytes.size();
  over_limit_ = over_limit_ || (bounded && piece.over_limit);
  return piece;
}

Unpacked Unpacker::file(Packing packing, std::string_view packed) {
  return taken(unpack(packing, packed, left()), true);
}

Unpacked Unpacker::operator()(Packing packing, std::string_view packed, std::optional<std::uint64_t> stated) {
  if (stated && *stated > kLargestChunk)
    return {{},
            false,
            "states " + std::to_string(*stated) + " bytes, more than the limit of " +
                std::to_string(kLargestChunk)};
  const std::size_t limit = stated ? static_cast<std::size_t>(*stated) : kLargestChunk;
  const std::size_t most = left();
  Unpacked piece = taken(unpack(packing, packed, std::min(limit, most)), limit > most);
  if (piece.whole && stated && piece.bytes.size() < *stated) return {std::move(piece.bytes), false, kCutOff};
  return piece;
}

}  // namespace odomcalib::ros
