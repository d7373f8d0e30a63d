#ifndef ADAPTIVE_GRID_STEREO_TOOLS_RAW_MESSAGE_H
#define ADAPTIVE_GRID_STEREO_TOOLS_RAW_MESSAGE_H

#include <cstring>

#include "bag_reader.h"

namespace adaptive_grid_stereo {

/// A recorded message of any type, for copying it into another bag unchanged. Refers to the
/// BagMessage, which must outlive it.
struct RawMessage {
  const BagMessage* message;
};

}  // namespace adaptive_grid_stereo

namespace ros {
namespace message_traits {

template <>
struct MD5Sum<adaptive_grid_stereo::RawMessage> {
  static const char* value(const adaptive_grid_stereo::RawMessage& raw) {
    return raw.message->connection->md5sum.c_str();
  }
};
template <>
struct DataType<adaptive_grid_stereo::RawMessage> {
  static const char* value(const adaptive_grid_stereo::RawMessage& raw) {
    return raw.message->connection->datatype.c_str();
  }
};
template <>
struct Definition<adaptive_grid_stereo::RawMessage> {
  static const char* value(const adaptive_grid_stereo::RawMessage& raw) {
    return raw.message->connection->definition.c_str();
  }
};

}  // namespace message_traits

namespace serialization {

template <>
struct Serializer<adaptive_grid_stereo::RawMessage> {
  template <typename Stream>
  static void write(Stream& stream, const adaptive_grid_stereo::RawMessage& raw) {
    if (raw.message->size == 0) return;
    std::memcpy(stream.advance(raw.message->size), raw.message->data, raw.message->size);
  }
  static std::uint32_t serializedLength(const adaptive_grid_stereo::RawMessage& raw) {
    return raw.message->size;
  }
};

}  // namespace serialization
}  // namespace ros

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_RAW_MESSAGE_H
