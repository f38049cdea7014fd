#include "drivers/base/vesc/buffer.hpp"

#include <algorithm>

#include "drivers/wire_table.hpp"

namespace odomcalib::drivers::vesc {

std::uint16_t checksum(Bytes bytes) {
  unsigned crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc ^= static_cast<unsigned>(byte) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000) != 0 ? (crc << 1) ^ 0x1021 : crc << 1;
    crc &= 0xFFFF;
  }
  return static_cast<std::uint16_t>(crc);
}

void ReceiveBuffer::on_piece(Bytes data, bool long_offset) {
  ByteReader reader(data);
  const std::size_t offset = reader.big_endian(long_offset ? 2 : 1);
  const Bytes piece = reader.take(reader.left());
  if (!reader.ok() || piece.empty() || offset + piece.size() > kMostBytes) {
    ++rejected_;
    return;
  }
  // Pieces come in order: one that begins at 0 begins a new packet.
  if (offset == 0) filled_.fill(false);
  std::copy(piece.begin(), piece.end(), bytes_.begin() + static_cast<std::ptrdiff_t>(offset));
  std::fill_n(filled_.begin() + static_cast<std::ptrdiff_t>(offset), piece.size(), true);
}

std::optional<std::vector<std::uint8_t>> ReceiveBuffer::on_end(Bytes data) {
  ByteReader reader(data);
  reader.take(2);  // sender, flag
  const std::size_t length = reader.big_endian(2);
  const std::uint64_t stated = reader.big_endian(2);
  const bool whole = reader.ok() && length > 0 && length <= kMostBytes &&
                     std::all_of(filled_.begin(), filled_.begin() + static_cast<std::ptrdiff_t>(length),
                                 [](bool filled) { return filled; });
  if (!whole || checksum(Bytes(bytes_).first(length)) != stated) {
    ++rejected_;
    filled_.fill(false);
    return std::nullopt;
  }
  filled_.fill(false);
  return std::vector<std::uint8_t>(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(length));
}

std::vector<CanFrame> pieces_of(Bytes packet, std::uint8_t to, std::uint8_t sender) {
  std::vector<CanFrame> frames;
  const auto add = [&](std::uint32_t command, std::size_t head, Bytes body) {
    CanFrame frame;
    frame.extended = true;
    frame.id = command << 8 | to;
    frame.length = static_cast<std::uint8_t>(head + body.size());
    std::copy(body.begin(), body.end(), frame.data.begin() + static_cast<std::ptrdiff_t>(head));
    frames.push_back(frame);
    return &frames.back();
  };
  for (std::size_t offset = 0; offset < packet.size();) {
    const std::size_t head = offset <= 0xFF ? 1 : 2;
    const Bytes piece = packet.subspan(offset, std::min(8 - head, packet.size() - offset));
    CanFrame* frame = add(head == 1 ? kFillBuffer : kFillBufferLong, head, piece);
    put_number(frame->data, 0, head, offset, Endian::big);
    offset += piece.size();
  }
  CanFrame* end = add(kProcessBuffer, 6, {});
  end->data[0] = sender;
  put_number(end->data, 2, 2, packet.size(), Endian::big);
  put_number(end->data, 4, 2, checksum(packet), Endian::big);
  return frames;
}

}  // namespace odomcalib::drivers::vesc
