#include "proto/file_bytes.hpp"

#include <fcntl.h>
#include <openssl/evp.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <memory>
#include <system_error>
#include <utility>

namespace odomcalib {
namespace {

constexpr std::size_t kLargestFile = std::size_t{4} << 30;

Error io_error(const std::string& what, const std::filesystem::path& path, const std::string& remedy = {}) {
  return Error{ErrorCode::io, what + ": " + std::generic_category().message(errno), path.string(), remedy};
}

/// Closes a descriptor at the end of its scope.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  [[nodiscard]] int get() const { return fd_; }

 private:
  int fd_;
};

bool write_all(int fd, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(fd, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) return false;
    bytes.remove_prefix(static_cast<std::size_t>(written));
  }
  return true;
}

Result<void> write_new_file(const std::filesystem::path& path, int raw_fd, std::string_view bytes) {
  const Descriptor fd(raw_fd);
  // mkstemp makes files that only the owner can read; results are for everybody whom the umask lets in.
  const mode_t mask = ::umask(0);
  ::umask(mask);
  if (::fchmod(fd.get(), 0666 & ~mask) != 0) return io_error("cannot set the mode", path);
  if (!write_all(fd.get(), bytes)) return io_error("cannot write", path, "check free space");
  if (::fsync(fd.get()) != 0) return io_error("cannot sync", path, "check the disk");
  return {};
}

}  // namespace

Result<void> read_file_pieces(const std::filesystem::path& path, const TakePiece& take) {
  const Descriptor fd(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (fd.get() < 0) return io_error("cannot open", path, "check the name and the permissions");
  struct stat info {};
  if (::fstat(fd.get(), &info) != 0) return io_error("cannot read", path);
  if (S_ISDIR(info.st_mode)) return Error{ErrorCode::io, "is a folder", path.string(), "name a file"};
  std::array<char, 1 << 16> chunk{};
  std::size_t all = 0, held = 0;  // a FIFO may give a byte at a time
  for (;;) {
    const ssize_t got = ::read(fd.get(), chunk.data() + held, chunk.size() - held);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return io_error("cannot read", path);
    held += static_cast<std::size_t>(got);
    all += static_cast<std::size_t>(got);
    if (all > kLargestFile) return Error{ErrorCode::io, "is larger than 4 GiB", path.string(), "split it"};
    if (held >= 2 || (got == 0 && held > 0)) take({chunk.data(), std::exchange(held, 0)});
    if (got == 0) return {};
  }
}

Result<std::string> read_file_bytes(const std::filesystem::path& path) {
  std::error_code unknown;
  const auto size = std::filesystem::file_size(path, unknown);
  std::string bytes;
  if (!unknown) bytes.reserve(std::min<std::size_t>(size, kLargestFile) + 1);
  const auto read = read_file_pieces(path, [&](std::string_view piece) { bytes.append(piece); });
  if (!read) return read.error();
  return bytes;
}

struct Sha256::Context {
  EVP_MD_CTX* state = EVP_MD_CTX_new();
  bool good = state != nullptr && EVP_DigestInit_ex(state, EVP_sha256(), nullptr) == 1;
  Context() = default;
  ~Context() { EVP_MD_CTX_free(state); }
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;
};

Sha256::Sha256() : context_(std::make_unique<Context>()) {}

Sha256::~Sha256() = default;

void Sha256::take(std::string_view piece) {
  context_->good = context_->good && EVP_DigestUpdate(context_->state, piece.data(), piece.size()) == 1;
}

std::string Sha256::hex() {
  std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
  unsigned int length = 0;
  if (!context_->good || EVP_DigestFinal_ex(context_->state, digest.data(), &length) != 1) return {};
  static constexpr std::string_view kDigits = "0123456789abcdef";
  std::string hex;
  for (unsigned int i = 0; i < length; ++i) {
    hex += kDigits[digest.at(i) >> 4U];
    hex += kDigits[digest.at(i) & 15U];
  }
  return hex;
}

bool is_absent(const std::filesystem::path& path) {
  std::error_code unknown;
  return std::filesystem::symlink_status(path, unknown).type() == std::filesystem::file_type::not_found;
}

std::string sha256_hex(std::string_view bytes) {
  Sha256 hash;
  hash.take(bytes);
  return hash.hex();
}

bool is_gzip(std::string_view bytes) { return bytes.size() >= 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b'; }

struct Gunzip::Stream {
  z_stream zlib{};
  bool good = inflateInit2(&zlib, 16 + MAX_WBITS) == Z_OK;
  Stream() = default;
  ~Stream() { inflateEnd(&zlib); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
};

Gunzip::Gunzip(std::size_t most, TakePiece take) : most_(most), take_(std::move(take)) {}

Gunzip::~Gunzip() = default;

void Gunzip::fail(const char* problem) {
  result_.whole = false;
  result_.problem = problem;
  stream_.reset();
}

void Gunzip::begin_member() {
  stream_ = std::make_unique<Stream>();
  if (!stream_->good) return fail("cannot start unpacking");
  inflate_member(std::exchange(between_, {}));
}

/// @return what follows the member
std::string_view Gunzip::inflate_member(std::string_view packed) {
  z_stream& zlib = stream_->zlib;
  // zlib never writes through next_in. Files are limited to 4 GiB, avail_in holds one byte less.
  zlib.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));  // NOLINT
  const auto fed = static_cast<uInt>(std::min<std::size_t>(packed.size(), UINT32_MAX));
  zlib.avail_in = fed;
  std::array<char, 1 << 16> chunk{};
  int code = Z_OK;
  while (code == Z_OK) {
    zlib.next_out = reinterpret_cast<Bytef*>(chunk.data());
    zlib.avail_out = static_cast<uInt>(chunk.size());
    code = inflate(&zlib, Z_NO_FLUSH);
    const std::string_view piece(chunk.data(), chunk.size() - zlib.avail_out);
    unpacked_ += piece.size();
    if (!piece.empty()) take_(piece);
    if (unpacked_ > most_) {
      fail("unpacks to more than the limit");
      result_.over_limit = true;
      return {};
    }
  }
  packed.remove_prefix(fed - zlib.avail_in);
  if (code == Z_STREAM_END)
    stream_.reset();
  else if (code != Z_BUF_ERROR)  // which says that more has to come
    fail("compressed data is damaged");
  return packed;
}

void Gunzip::feed(std::string_view packed) {
  while (!packed.empty() && result_.whole) {
    if (stream_) {
      packed = inflate_member(packed);
      continue;
    }
    const std::string_view wanted = packed.substr(0, 2 - between_.size());
    between_.append(wanted);
    packed.remove_prefix(wanted.size());
    if (is_gzip(between_)) begin_member();
    if (stream_ || between_.size() < 2) continue;
    more_than_zeros_ |= packed.find_first_not_of('\0') != std::string_view::npos;
    return;
  }
}

Unpacked Gunzip::finish() {
  if (stream_)
    fail("compressed data is cut off");
  else if (result_.whole && (more_than_zeros_ || between_.find_first_not_of('\0') != std::string::npos))
    fail("bytes after the compressed data");
  return std::move(result_);
}

Unpacked gunzip(std::string_view packed, const UnpackLimit& limit) {
  std::string bytes;
  Gunzip unpacking(limit.of(packed.size()), [&](std::string_view piece) { bytes.append(piece); });
  unpacking.feed(packed);
  Unpacked result = unpacking.finish();
  result.bytes = std::move(bytes);
  return result;
}

Result<std::string> gzip(std::string_view bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, 16 + MAX_WBITS, 8, Z_DEFAULT_STRATEGY) != Z_OK)
    return Error{ErrorCode::io, "cannot start compressing", "", ""};
  std::string out(deflateBound(&stream, static_cast<uLong>(bytes.size())), '\0');
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(bytes.data()));  // NOLINT
  stream.avail_in = static_cast<uInt>(bytes.size());
  stream.next_out = reinterpret_cast<Bytef*>(out.data());
  stream.avail_out = static_cast<uInt>(out.size());
  const int code = bytes.size() > UINT32_MAX ? Z_BUF_ERROR : deflate(&stream, Z_FINISH);
  out.resize(stream.total_out);
  deflateEnd(&stream);
  if (code != Z_STREAM_END) return Error{ErrorCode::io, "cannot compress", "", "write without .gz"};
  return out;
}

Result<void> sync_folder(const std::filesystem::path& path) {
  const auto folder = path.has_parent_path() ? path.parent_path() : std::filesystem::path(".");
  const Descriptor fd(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (fd.get() < 0) return io_error("cannot open the folder to sync it", folder);
  // Some file systems cannot sync a folder (EINVAL); the rename itself has happened.
  if (::fsync(fd.get()) != 0 && errno != EINVAL) return io_error("cannot sync the folder", folder);
  return {};
}

Result<void> replace_file(const std::filesystem::path& path, std::string_view bytes) {
  std::string temporary = path.string() + ".XXXXXX";
  const int fd = ::mkostemp(temporary.data(), O_CLOEXEC);
  if (fd < 0) return io_error("cannot create a file beside it", path, "check the folder and its permissions");
  if (auto written = write_new_file(temporary, fd, bytes); !written) {
    ::unlink(temporary.c_str());
    return written;
  }
  if (::rename(temporary.c_str(), path.c_str()) != 0) {
    auto error = io_error("cannot replace", path);
    ::unlink(temporary.c_str());
    return error;
  }
  return sync_folder(path);
}

std::filesystem::path behind_links(std::filesystem::path path) {
  constexpr int kMostLinks = 40;  // as the kernel
  for (int hops = 0; hops < kMostLinks; ++hops) {
    std::error_code no_link;
    const auto target = std::filesystem::read_symlink(path, no_link);
    if (no_link) break;
    path = path.parent_path() / target;
  }
  return path;
}

namespace {

enum class OutputKind { replaced, written_to, standard_output };

/// Whether the file takes what this program prints: `>> log`. To replace it would lose what is in it already.
bool takes_standard_output(const struct stat& info) {
  struct stat output {};
  return ::fstat(STDOUT_FILENO, &output) == 0 && output.st_dev == info.st_dev && output.st_ino == info.st_ino;
}

Result<OutputKind> kind_of_output(const std::filesystem::path& path) {
  struct stat info {};
  if (::stat(path.c_str(), &info) != 0) {
    if (errno == ENOENT) return OutputKind::replaced;
    return io_error("cannot write", path, "check the name and the permissions");
  }
  if (S_ISREG(info.st_mode))
    return takes_standard_output(info) ? OutputKind::standard_output : OutputKind::replaced;
  if (S_ISCHR(info.st_mode) || S_ISBLK(info.st_mode) || S_ISFIFO(info.st_mode)) return OutputKind::written_to;
  return Error{ErrorCode::io, S_ISDIR(info.st_mode) ? "is a folder" : "is no regular file", path.string(),
               "name a file"};
}

Result<void> write_into(const std::filesystem::path& path, std::string_view bytes) {
  const Descriptor fd(::open(path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
  if (fd.get() < 0) return io_error("cannot open", path, "check the permissions");
  if (!write_all(fd.get(), bytes)) return io_error("cannot write", path);
  return {};
}

Result<void> write_to_standard_output(const std::filesystem::path& path, std::string_view bytes) {
  if (!write_all(STDOUT_FILENO, bytes)) return io_error("cannot write", path);
  return {};
}

}  // namespace

Result<void> write_output(const std::filesystem::path& path, std::string_view bytes) {
  const auto kind = kind_of_output(path);
  if (!kind) return kind.error();
  if (kind.value() == OutputKind::written_to) return write_into(path, bytes);
  if (kind.value() == OutputKind::standard_output) return write_to_standard_output(path, bytes);
  return replace_file(behind_links(path), bytes);
}

Result<void> check_output(const std::filesystem::path& path) {
  const auto kind = kind_of_output(path);
  if (!kind) return kind.error();
  if (kind.value() == OutputKind::standard_output) return {};
  if (kind.value() == OutputKind::written_to) {
    if (::access(path.c_str(), W_OK) == 0) return {};
    return io_error("cannot write", path, "check the permissions");
  }
  const auto file = behind_links(path);
  const auto folder = file.has_parent_path() ? file.parent_path() : std::filesystem::path(".");
  if (file.has_filename() && ::access(folder.c_str(), W_OK | X_OK) == 0) return {};
  return io_error("cannot write into its folder", path, "check the folder and its permissions");
}

}  // namespace odomcalib
