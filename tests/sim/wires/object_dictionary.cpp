#include "tests/sim/wires/object_dictionary.hpp"

#include "tests/sim/wires/frame.hpp"

namespace odomcalib::sim {

Object& ObjectDictionary::add(ObjectKey key, Object object) { return objects_[key] = std::move(object); }

Object& ObjectDictionary::add_value(ObjectKey key, unsigned bytes, std::uint32_t value, Access access) {
  Object object;
  object.bytes = bytes;
  object.value = value;
  object.access = access;
  return add(key, std::move(object));
}

void ObjectDictionary::add_text(ObjectKey key, std::string text) {
  Object object;
  object.bytes = 0;
  object.access = Access::constant;
  object.text = std::move(text);
  add(key, std::move(object));
}

const Object* ObjectDictionary::find(ObjectKey key) const {
  const auto found = objects_.find(key);
  return found == objects_.end() ? nullptr : &found->second;
}

std::uint32_t ObjectDictionary::value(ObjectKey key) const {
  const Object* object = find(key);
  if (object == nullptr) return 0;
  return object->computed ? object->computed() : object->value;
}

void ObjectDictionary::set(ObjectKey key, std::uint32_t value) {
  const auto found = objects_.find(key);
  if (found != objects_.end()) found->second.value = value;
}

AbortCode ObjectDictionary::missing(ObjectKey key) const {
  const auto first = objects_.lower_bound({key.index, 0});
  const bool index_exists = first != objects_.end() && first->first.index == key.index;
  return index_exists ? abort_code::kNoSubIndex : abort_code::kNoObject;
}

std::variant<std::vector<std::uint8_t>, AbortCode> ObjectDictionary::read(ObjectKey key) const {
  const Object* object = find(key);
  if (object == nullptr) return missing(key);
  if (object->bytes == 0) return std::vector<std::uint8_t>(object->text.begin(), object->text.end());
  std::vector<std::uint8_t> bytes(object->bytes);
  put_u32(bytes.data(), object->bytes, value(key));
  return bytes;
}

AbortCode ObjectDictionary::write(ObjectKey key, std::span<const std::uint8_t> bytes) {
  const auto found = objects_.find(key);
  if (found == objects_.end()) return missing(key);
  Object& object = found->second;
  if (object.access != Access::read_write) return abort_code::kReadOnly;
  if (bytes.size() != object.bytes) return abort_code::kLength;
  const std::uint32_t value = get_u32(bytes.data(), object.bytes);
  if (object.before_write)
    if (const AbortCode refused = object.before_write(value); refused != abort_code::kNone) return refused;
  object.value = value;
  if (object.after_write) object.after_write(value);
  return abort_code::kNone;
}

}  // namespace odomcalib::sim
