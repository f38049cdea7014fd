#include <fcntl.h>
#include <libserial/SerialPort.h>
#include <limits.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <optional>

#include "drivers/serial/custom_baud.hpp"
#include "drivers/serial/port.hpp"
#include "drivers/settings.hpp"

namespace odomcalib::drivers {
namespace {

Error port_error(const std::string& path, const std::string& what, const std::string& remedy) {
  return {ErrorCode::device, what, path, remedy};
}

Error unplugged(const std::string& path, const std::string& detail) {
  return port_error(path, "serial port is gone (" + detail + ")",
                    "check cable and power; it is reopened by itself");
}

/// Owns a file descriptor.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path)
      : fd_(::open(path.c_str(), O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC)) {}
  ~OpenFile() {
    if (fd_ >= 0) ::close(fd_);
  }
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  [[nodiscard]] int fd() const { return fd_; }

 private:
  int fd_;
};

class TtyPort final : public ByteStream {
 public:
  TtyPort(std::string path, std::unique_ptr<OpenFile> file)
      : path_(std::move(path)), file_(std::move(file)), fd_(file_->fd()) {}

  [[nodiscard]] int fd() const override { return fd_; }

  Result<std::vector<std::uint8_t>> read() override {
    std::vector<std::uint8_t> out;
    std::array<std::uint8_t, 4096> chunk{};
    while (out.size() < kReadAtMost) {
      const ssize_t n = ::read(fd_, chunk.data(), chunk.size());
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
      if (n <= 0) return out.empty() ? end_of_input(n) : Result<std::vector<std::uint8_t>>(out);
      out.insert(out.end(), chunk.begin(), chunk.begin() + n);
      if (static_cast<std::size_t>(n) < chunk.size()) break;  // that was all
    }
    return out;
  }

  /// Bytes that do not fit are dropped, but never in part: the rest of something that was begun goes first,
  /// so that no half of a line is glued to the next one.
  Result<void> write(std::span<const std::uint8_t> bytes) override {
    const auto begun = put(rest_);
    if (!begun) return begun.error();
    rest_.erase(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(begun.value()));
    if (!rest_.empty()) return full();
    const auto taken = put(bytes);
    if (!taken) return taken.error();
    if (taken.value() == 0 && !bytes.empty()) return full();
    rest_.assign(bytes.begin() + static_cast<std::ptrdiff_t>(taken.value()), bytes.end());
    return {};
  }

 private:
  /// How many bytes the port takes now.
  [[nodiscard]] Result<std::size_t> put(std::span<const std::uint8_t> bytes) const {
    std::size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = ::write(fd_, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) break;
      if (n <= 0) return unplugged(path_, n == 0 ? "write took nothing" : std::strerror(errno));
      done += static_cast<std::size_t>(n);
    }
    return done;
  }
  [[nodiscard]] Error full() const {
    return port_error(path_, "output buffer is full: the device does not take what is sent",
                      "check baud rate and flow control");
  }
  [[nodiscard]] Result<std::vector<std::uint8_t>> end_of_input(ssize_t n) const {
    return unplugged(path_, n < 0 ? std::strerror(errno) : "end of file");
  }

  std::string path_;
  std::unique_ptr<OpenFile> file_;
  int fd_;
  std::vector<std::uint8_t> rest_;  // of a write that the port took in part
};

std::optional<LibSerial::BaudRate> table_rate(unsigned baud) {
  using enum LibSerial::BaudRate;
  switch (baud) {
    case 9600:
      return BAUD_9600;
    case 19200:
      return BAUD_19200;
    case 38400:
      return BAUD_38400;
    case 57600:
      return BAUD_57600;
    case 115200:
      return BAUD_115200;
    case 230400:
      return BAUD_230400;
    case 460800:
      return BAUD_460800;
    case 500000:
      return BAUD_500000;
    case 921600:
      return BAUD_921600;
    case 1000000:
      return BAUD_1000000;
    default:
      return std::nullopt;
  }
}

/// libserial's destructor throws when the device has gone, which would end the program: such an object is
/// left alone. Its descriptor is not, or a device that comes and goes would use them all up.
void close_quietly(std::unique_ptr<LibSerial::SerialPort> port) {
  if (!port->IsOpen()) return;
  const int fd = port->GetFileDescriptor();
  try {
    port->Close();
  } catch (const std::exception&) {
    (void)port.release();  // NOLINT(bugprone-unused-return-value)
    close(fd);
  }
}

Error no_serial_port(const std::string& path, const std::string& problem) {
  return port_error(path, "cannot be set up as a serial port: " + problem,
                    "check that it is a serial device: ls -l " + path);
}

/// Settings as libserial makes them. It puts the old ones back when it closes; ours are applied after that,
/// on a descriptor of our own that survives an unplugged device.
Result<termios> compose_settings(const std::string& path, std::optional<LibSerial::BaudRate> rate) {
  auto port = std::make_unique<LibSerial::SerialPort>();
  std::string problem;
  termios settings{};
  try {
    port->Open(path, std::ios_base::in | std::ios_base::out);
    if (rate) port->SetBaudRate(*rate);
    port->SetCharacterSize(LibSerial::CharacterSize::CHAR_SIZE_8);
    port->SetParity(LibSerial::Parity::PARITY_NONE);
    port->SetStopBits(LibSerial::StopBits::STOP_BITS_1);
    port->SetFlowControl(LibSerial::FlowControl::FLOW_CONTROL_NONE);
    if (tcgetattr(port->GetFileDescriptor(), &settings) != 0) problem = std::strerror(errno);
  } catch (const std::exception& error) {
    problem = error.what();
  }
  close_quietly(std::move(port));
  if (problem.empty()) return settings;
  return no_serial_port(path, problem);
}

/// Raw bytes, one at least per read (0 then means end of file); closing must not drop DTR (a lidar's motor or
/// an Arduino's reset may hang on it).
bool make_raw(int fd, termios settings) {
  cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(HUPCL | CSTOPB | PARENB);
  settings.c_cc[VMIN] = 1;
  settings.c_cc[VTIME] = 0;
  return tcsetattr(fd, TCSANOW, &settings) == 0;
}

/// Other programs are kept away by a lock, and by TIOCEXCL on real ports: on a pseudo-terminal that flag
/// would outlive us. A pseudo-terminal has no modem lines either, so a refusal is tolerated.
bool claim(int fd, const std::string& path, const ModemLines& wanted) {
  if (flock(fd, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) return false;
  std::array<char, PATH_MAX> real{};
  const bool pseudo =
      realpath(path.c_str(), real.data()) != nullptr && std::strncmp(real.data(), "/dev/pts/", 9) == 0;
  ioctl(fd, pseudo ? TIOCNXCL : TIOCEXCL);
  const int on = (wanted.dtr ? TIOCM_DTR : 0) | (wanted.rts ? TIOCM_RTS : 0);
  const int off = (TIOCM_DTR | TIOCM_RTS) & ~on;
  ioctl(fd, TIOCMBIS, &on);
  ioctl(fd, TIOCMBIC, &off);
  return true;
}

Error cannot_open(const std::string& path, int cause) {
  std::string remedy = "check the cable and the name: ls /dev/serial/by-id";
  if (cause == EACCES) remedy = "let the service's user use it: usermod -aG dialout USER";
  if (cause == EBUSY) remedy = "another program has it: fuser -v " + path;
  return port_error(path, std::string("cannot open: ") + std::strerror(cause), remedy);
}

}  // namespace

Result<std::unique_ptr<ByteStream>> open_serial(const std::string& path, unsigned baud,
                                                const ModemLines& lines) {
  if (baud < 50 || baud > 4'000'000)
    return Error{ErrorCode::usage, "baud rate " + std::to_string(baud) + " is not within 50 and 4000000",
                 path, ""};
  // Held open from here on: a device that resets or leaves when its last user closes must not see a close in
  // between.
  auto file = std::make_unique<OpenFile>(path);
  const int fd = file->fd();
  if (fd < 0) return cannot_open(path, errno);
  if (isatty(fd) == 0) return no_serial_port(path, std::strerror(errno));
  const auto rate = table_rate(baud);
  const auto settings = compose_settings(path, rate);
  if (!settings) return settings.error();
  if (!make_raw(fd, settings.value()) || (!rate && !set_custom_baud(fd, baud)))
    return port_error(path, "cannot set " + std::to_string(baud) + " baud, 8N1: " + std::strerror(errno), "");
  if (!claim(fd, path, lines)) return cannot_open(path, EBUSY);
  tcflush(fd, TCIOFLUSH);
  return std::unique_ptr<ByteStream>(std::make_unique<TtyPort>(path, std::move(file)));
}

}  // namespace odomcalib::drivers
