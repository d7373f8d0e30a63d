#ifndef ADAPTIVE_GRID_STEREO_TOOLS_BAG_READER_H
#define ADAPTIVE_GRID_STEREO_TOOLS_BAG_READER_H

#include <cstdint>
#include <fstream>
#include <list>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <ros/datatypes.h>
#include <ros/message_traits.h>
#include <ros/serialization.h>
#include <ros/time.h>
#include <boost/make_shared.hpp>
#include <boost/shared_ptr.hpp>

namespace adaptive_grid_stereo {

/// A topic as one publisher wrote it.
struct BagConnection {
  std::string topic;
  std::string datatype;
  std::string md5sum;
  std::string definition;
  boost::shared_ptr<ros::M_string> header;  // all fields, e.g. latching
};

/// A message as it lies in the bag; the bytes stay valid until the next call of next().
struct BagMessage {
  ros::Time time;  // of recording
  const BagConnection* connection = nullptr;
  const std::uint8_t* data = nullptr;
  std::uint32_t size = 0;
};

/// Reads a bag (format 2.0) record by record, without its index: bags that were cut off, never
/// indexed, or hold damaged chunks give what is intact. Every length is checked before it is used.
/// Not thread safe.
class BagReader {
 public:
  /// Finds all messages. Throws std::runtime_error if the file cannot be read or is no such bag.
  explicit BagReader(const std::string& path);

  /// What is wrong with the bag, in a sentence; "" if it is whole. Grows while messages are read.
  const std::string& damage() const { return damage_; }

  /// In the order of their first appearance.
  const std::vector<BagConnection>& connections() const { return connections_; }

  std::size_t messageCount() const { return entries_.size(); }
  std::size_t messageCount(const std::string& topic) const;

  /// Of the first and the last message.
  ros::Time beginTime() const;
  ros::Time endTime() const;

  /// The next message in the order of recording times; false at the end.
  bool next(BagMessage* message);

  /// Starts over with the first message.
  void rewind() { position_ = 0; }

 private:
  struct Chunk {
    std::uint64_t position = 0;  // of its data in the file
    std::uint32_t stored = 0;    // bytes in the file
    std::uint32_t size = 0;      // bytes uncompressed
    std::string compression;
  };
  struct Entry {
    ros::Time time;
    std::uint32_t connection = 0;  // index in connections_
    std::uint32_t chunk = 0;       // index in chunks_
    std::uint32_t offset = 0;      // of the data in the uncompressed chunk
    std::uint32_t size = 0;
  };
  using Bytes = std::vector<std::uint8_t>;

  void scan();
  void scanChunk(std::uint32_t index);
  void addConnection(std::uint32_t id, const std::string& topic, const std::uint8_t* data,
                     std::uint32_t size);
  Bytes loadChunk(const Chunk& chunk);
  const Bytes& cachedChunk(std::uint32_t index);
  Bytes readBytes(std::uint64_t position, std::uint32_t size);
  void noteDamage(const std::string& what);

  std::string path_;
  std::ifstream file_;
  std::uint64_t file_size_ = 0;
  std::string damage_;
  std::vector<BagConnection> connections_;
  std::map<std::uint32_t, std::uint32_t> connection_of_id_;
  std::vector<Chunk> chunks_;
  std::vector<Entry> entries_;
  std::size_t position_ = 0;
  std::list<std::pair<std::uint32_t, Bytes>> cache_;  // the latest used first
};

/// Throws std::runtime_error if an array inside the message claims to be longer than the message,
/// so that nothing large is allocated for it. Knows the types that the tools read.
void checkArrayLengths(const std::string& datatype, const std::uint8_t* data, std::uint32_t size);

/// The message as its ROS type. Throws std::runtime_error, naming the topic, if it is of another
/// type or damaged.
template <typename Type>
boost::shared_ptr<Type> deserialize(const BagMessage& message) {
  const BagConnection& connection = *message.connection;
  if (connection.md5sum != ros::message_traits::md5sum<Type>()) {
    throw std::runtime_error(connection.topic + ": holds " + connection.datatype +
                             " in another version than " + ros::message_traits::datatype<Type>() +
                             " has here");
  }
  const auto result = boost::make_shared<Type>();
  try {
    // By the type asked for: the bag may name another one of equal layout, e.g. tf/tfMessage.
    checkArrayLengths(ros::message_traits::datatype<Type>(), message.data, message.size);
    // The stream only reads, but takes no pointer to const.
    ros::serialization::IStream stream(const_cast<std::uint8_t*>(message.data), message.size);
    ros::serialization::deserialize(stream, *result);
  } catch (const std::exception& error) {
    throw std::runtime_error(connection.topic + ": a message is damaged: " + error.what());
  }
  return result;
}

}  // namespace adaptive_grid_stereo

#endif  // ADAPTIVE_GRID_STEREO_TOOLS_BAG_READER_H
