#include "tests/sim/wires/sdo_server.hpp"

#include <algorithm>

#include "tests/sim/wires/frame.hpp"

namespace odomcalib::sim {

namespace {

constexpr std::size_t kSegment = 7;
constexpr std::size_t kLongestWrite = 64;

}  // namespace

SdoBytes SdoServer::reply(std::uint8_t command) const {
  SdoBytes bytes{};
  bytes[0] = command;
  put_u32(&bytes[1], 2, last_key_.index + (faults.wrong_index ? 1U : 0U));
  bytes[3] = last_key_.sub;
  return bytes;
}

SdoBytes SdoServer::abort(AbortCode code) {
  transfer_ = Transfer::none;
  SdoBytes bytes = reply(0x80);
  put_u32(&bytes[4], 4, code);
  return bytes;
}

std::optional<SdoBytes> SdoServer::answer(const SdoBytes& request) {
  if (faults.silent) return std::nullopt;
  const unsigned command = request[0] >> 5U;  // client command specifier
  if (command == 4) {                         // abort by the client
    transfer_ = Transfer::none;
    return std::nullopt;
  }
  if (command == 0) return download_segment(request);
  if (command == 3) return upload_segment(request);
  last_key_ = {static_cast<std::uint16_t>(get_u32(&request[1], 2)), request[3]};
  if (command == 1) return start_download(request);
  if (command == 2) return start_upload();
  return abort(abort_code::kCommand);
}

AbortCode SdoServer::write(std::span<const std::uint8_t> bytes) {
  const auto planned = faults.abort_on_write.find(last_key_);
  if (planned != faults.abort_on_write.end()) return planned->second;
  return dictionary_.write(last_key_, bytes);
}

SdoBytes SdoServer::start_download(const SdoBytes& request) {
  const bool expedited = (request[0] & 0x02U) != 0, sized = (request[0] & 0x01U) != 0;
  if (!expedited) {
    announced_ = sized ? get_u32(&request[4], 4) : 0;
    if (announced_ > kLongestWrite) return abort(abort_code::kLength);
    transfer_ = Transfer::download;
    toggle_ = 0;
    buffer_.clear();
    return reply(0x60);
  }
  const Object* object = dictionary_.find(last_key_);
  // Without a stated size the object's own type decides.
  const std::size_t unsized = object != nullptr && object->bytes != 0 ? object->bytes : 4;
  const std::size_t size = sized ? 4U - ((request[0] >> 2U) & 3U) : unsized;
  const AbortCode refused = write(std::span(request).subspan(4, size));
  return refused == abort_code::kNone ? reply(0x60) : abort(refused);
}

SdoBytes SdoServer::download_segment(const SdoBytes& request) {
  if (transfer_ != Transfer::download) return abort(abort_code::kCommand);
  const std::uint8_t toggle = (request[0] >> 4U) & 1U;
  if (toggle != toggle_) return abort(abort_code::kToggle);
  const std::size_t size = kSegment - ((request[0] >> 1U) & 7U);
  buffer_.insert(buffer_.end(), request.begin() + 1, request.begin() + 1 + static_cast<std::ptrdiff_t>(size));
  if (buffer_.size() > kLongestWrite) return abort(abort_code::kLength);
  toggle_ ^= 1U;
  SdoBytes bytes{};
  bytes[0] = static_cast<std::uint8_t>(0x20U + (static_cast<unsigned>(toggle) << 4U));
  if ((request[0] & 1U) == 0) return bytes;
  transfer_ = Transfer::none;
  if (announced_ != 0 && announced_ != buffer_.size()) return abort(abort_code::kLength);
  const AbortCode refused = write(buffer_);
  return refused == abort_code::kNone ? bytes : abort(refused);
}

SdoBytes SdoServer::start_upload() {
  const auto planned = faults.abort_on_read.find(last_key_);
  if (planned != faults.abort_on_read.end()) return abort(planned->second);
  const auto content = dictionary_.read(last_key_);
  if (const auto* refused = std::get_if<AbortCode>(&content)) return abort(*refused);
  buffer_ = std::get<std::vector<std::uint8_t>>(content);
  const auto faked = faults.read_back.find(last_key_);
  if (faked != faults.read_back.end() && buffer_.size() <= 4)
    put_u32(buffer_.data(), static_cast<unsigned>(buffer_.size()), faked->second);
  transfer_ = Transfer::none;
  const Object* object = dictionary_.find(last_key_);
  if (object->bytes == 0) {
    transfer_ = Transfer::upload;
    toggle_ = 0;
    done_ = 0;
    SdoBytes bytes = reply(0x41);
    put_u32(&bytes[4], 4, static_cast<std::uint32_t>(buffer_.size()));
    return bytes;
  }
  SdoBytes bytes = reply(static_cast<std::uint8_t>(0x43U + ((4U - object->bytes) << 2U)));
  std::copy(buffer_.begin(), buffer_.end(), bytes.begin() + 4);
  return bytes;
}

SdoBytes SdoServer::upload_segment(const SdoBytes& request) {
  if (transfer_ != Transfer::upload) return abort(abort_code::kCommand);
  const std::uint8_t toggle = (request[0] >> 4U) & 1U;
  if (toggle != toggle_) return abort(abort_code::kToggle);
  toggle_ ^= 1U;
  const std::size_t size = std::min(kSegment, buffer_.size() - done_);
  SdoBytes bytes{};
  std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(done_), size, bytes.begin() + 1);
  done_ += size;
  const bool last = done_ == buffer_.size();
  bytes[0] = static_cast<std::uint8_t>((static_cast<unsigned>(toggle) << 4U) + ((kSegment - size) << 1U) +
                                       (last ? 1U : 0U));
  if (last) transfer_ = Transfer::none;
  return bytes;
}

}  // namespace odomcalib::sim
