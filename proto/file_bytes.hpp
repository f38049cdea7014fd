// Whole files as bytes: read, hash, unpack, replace atomically.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <string_view>

#include "proto/result.hpp"
#include "proto/unpack_limit.hpp"

namespace odomcalib {

/// Takes bytes that follow one another; they are gone when it returns.
using TakePiece = std::function<void(std::string_view)>;

/// All bytes of a regular file. Error: io. Files above 4 GiB are refused.
Result<std::string> read_file_bytes(const std::filesystem::path& path);

/// The same, handed over piece by piece; the first has two bytes at least where the file has them.
Result<void> read_file_pieces(const std::filesystem::path& path, const TakePiece& take);

/// Whether there is nothing of that name, not even a link that leads nowhere; false where nobody can tell.
bool is_absent(const std::filesystem::path& path);

/// SHA-256 as lower-case hex.
std::string sha256_hex(std::string_view bytes);

/// SHA-256 of bytes that come in pieces.
class Sha256 {
 public:
  Sha256();
  ~Sha256();
  Sha256(const Sha256&) = delete;
  Sha256& operator=(const Sha256&) = delete;
  void take(std::string_view piece);
  /// Lower-case hex of all that was taken; asked for once.
  [[nodiscard]] std::string hex();

 private:
  struct Context;
  std::unique_ptr<Context> context_;
};

/// True when the bytes begin with the gzip magic.
bool is_gzip(std::string_view bytes);

/// Bytes that could be unpacked; a damaged or cut-off end leaves those before it.
struct Unpacked {
  std::string bytes;
  bool whole = true;
  std::string problem;  ///< why it is not whole
  bool over_limit = false;
};

/// Unpacks the members of a gzip file (RFC 1952) that comes in pieces.
class Gunzip {
 public:
  /// @param most bytes that it may unpack to; hardly more are handed over
  /// @param take gets what is unpacked
  Gunzip(std::size_t most, TakePiece take);
  ~Gunzip();
  Gunzip(const Gunzip&) = delete;
  Gunzip& operator=(const Gunzip&) = delete;
  void feed(std::string_view packed);
  /// @param most bytes from now on, those before included
  void allow(std::size_t most) { most_ = most; }
  /// When nothing more comes. @return without the bytes, which have been handed over
  [[nodiscard]] Unpacked finish();

 private:
  struct Stream;
  void begin_member();
  std::string_view inflate_member(std::string_view packed);
  void fail(const char* problem);

  std::size_t most_, unpacked_ = 0;
  TakePiece take_;
  std::unique_ptr<Stream> stream_;  ///< of the member that is being read
  std::string between_;             ///< two bytes at most: of the next member, or of what follows the last
  bool more_than_zeros_ = false;    ///< follow the last member; zeros may fill up a file
  Unpacked result_;
};

/// Unpacks all members of a gzip file, hardly more than the limit.
Unpacked gunzip(std::string_view packed, const UnpackLimit& limit = {});

/// Packs into one gzip member without a time stamp: same input, same bytes.
Result<std::string> gzip(std::string_view bytes);

/// Puts the folder of `path` on the disk: a file made or renamed in it survives a power cut. Error: io.
Result<void> sync_folder(const std::filesystem::path& path);

/// Writes to a temporary file beside `path`, syncs, renames and syncs the folder: `path` holds either the old
/// or the new content, never a part. A link of that name is replaced, not followed: for a program's own
/// folders. Error: io.
Result<void> replace_file(const std::filesystem::path& path, std::string_view bytes);

/// The path behind a chain of symbolic links, whether there is something at its end or not.
std::filesystem::path behind_links(std::filesystem::path path);

/// Writes where a user wants it: the file behind a link is replaced as above and the link stays; a device, a
/// FIFO and the file that standard output goes to take the bytes; anything else that is no regular file is
/// refused. Error: io.
Result<void> write_output(const std::filesystem::path& path, std::string_view bytes);

/// Whether write_output may write there, as far as can be told before it does: nothing is changed. Error: io.
Result<void> check_output(const std::filesystem::path& path);

}  // namespace odomcalib
