// Whole files as bytes: read, hash, unpack, replace atomically.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

#include "proto/result.hpp"
#include "proto/unpack_limit.hpp"

namespace odomcalib {

/// All bytes of a regular file. Error: io. Files above 4 GiB are refused.
Result<std::string> read_file_bytes(const std::filesystem::path& path);

/// SHA-256 as lower-case hex.
std::string sha256_hex(std::string_view bytes);

/// True when the bytes begin with the gzip magic.
bool is_gzip(std::string_view bytes);

/// Bytes that could be unpacked; a damaged or cut-off end leaves those before it.
struct Unpacked {
  std::string bytes;
  bool whole = true;
  std::string problem;  ///< why it is not whole
  bool over_limit = false;
};

/// Unpacks all members of a gzip file (RFC 1952), hardly more than the limit.
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

/// Writes where a user wants it: the file behind a link is replaced as above and the link stays; a device or
/// a FIFO takes the bytes; anything else that is no regular file is refused. Error: io.
Result<void> write_output(const std::filesystem::path& path, std::string_view bytes);

/// Whether write_output may write there, as far as can be told before it does: nothing is changed. Error: io.
Result<void> check_output(const std::filesystem::path& path);

}  // namespace odomcalib
