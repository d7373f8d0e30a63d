#include "bag_reader.h"

#include <bzlib.h>
#include <roslz4/lz4s.h>

#include <algorithm>
#include <cstring>
#include <stdexcept>

namespace adaptive_grid_stereo {
namespace {

const char kMagic[] = "#ROSBAG V2.0\n";
constexpr std::uint32_t kLongestHeader = 1U << 20;
constexpr std::uint64_t kLargestChunk = 1ULL << 30;
constexpr std::size_t kCachedChunks = 8;

// Operations of the records, from the definition of the format.
enum Operation : std::uint8_t {
  kMessageData = 0x02,
  kBagHeader = 0x03,
  kIndexData = 0x04,
  kChunk = 0x05,
  kChunkInfo = 0x06,
  kConnection = 0x07
};

using Fields = std::map<std::string, std::string>;

std::uint32_t toU32(const void* bytes) {
  const auto* b = static_cast<const std::uint8_t*>(bytes);
  return b[0] | (b[1] << 8) | (b[2] << 16) | (static_cast<std::uint32_t>(b[3]) << 24);
}

std::uint32_t numberField(const Fields& fields, const char* name) {
  const auto found = fields.find(name);
  if (found == fields.end() || found->second.size() < 4) {
    throw std::runtime_error(std::string("a record lacks the field '") + name + "'");
  }
  return toU32(found->second.data());
}

std::string textField(const Fields& fields, const char* name) {
  const auto found = fields.find(name);
  return found == fields.end() ? "" : found->second;
}

/// Fields of a header: length, then name=value, again and again.
Fields parseFields(const std::uint8_t* data, std::uint32_t size) {
  Fields fields;
  std::uint32_t at = 0;
  while (at < size) {
    if (size - at < 4) throw std::runtime_error("a record's header is damaged");
    const std::uint32_t length = toU32(data + at);
    at += 4;
    if (length > size - at) throw std::runtime_error("a record's header is damaged");
    const auto* begin = reinterpret_cast<const char*>(data + at);
    const auto* equals = static_cast<const char*>(std::memchr(begin, '=', length));
    if (!equals) throw std::runtime_error("a record's header is damaged");
    fields[std::string(begin, equals)] = std::string(equals + 1, begin + length);
    at += length;
  }
  return fields;
}

std::uint8_t operationOf(const Fields& fields) {
  const auto found = fields.find("op");
  if (found == fields.end() || found->second.size() != 1) {
    throw std::runtime_error("a record does not say what it is");
  }
  return static_cast<std::uint8_t>(found->second[0]);
}

}  // namespace

BagReader::BagReader(const std::string& path) : path_(path), file_(path, std::ios::binary) {
  if (!file_) throw std::runtime_error(path + ": cannot be opened");
  file_.seekg(0, std::ios::end);
  const std::streamoff size = file_.tellg();
  if (size < 0) throw std::runtime_error(path + ": cannot be read; is it a file?");
  file_size_ = static_cast<std::uint64_t>(size);
  const std::size_t magic_size = sizeof(kMagic) - 1;
  char magic[sizeof(kMagic)] = {};
  file_.seekg(0);
  file_.read(magic, static_cast<std::streamsize>(magic_size));
  if (std::memcmp(magic, kMagic, magic_size) != 0) {
    const bool old = std::memcmp(magic, "#ROSBAG V1", 10) == 0;
    throw std::runtime_error(
        path + (old ? ": is a bag of format 1; rosbag fix converts it" : ": is no ROS 1 bag"));
  }
  scan();
  std::stable_sort(entries_.begin(), entries_.end(),
                   [](const Entry& a, const Entry& b) { return a.time < b.time; });
}

void BagReader::noteDamage(const std::string& what) {
  // The first cause is the one that helps; those that follow from it would only hide it.
  if (damage_.empty()) damage_ = path_ + ": " + what;
}

BagReader::Bytes BagReader::readBytes(std::uint64_t position, std::uint32_t size) {
  if (position > file_size_ || size > file_size_ - position) {
    throw std::runtime_error("the file is cut off");
  }
  Bytes bytes(size);
  file_.clear();
  file_.seekg(static_cast<std::streamoff>(position));
  if (size > 0 && !file_.read(reinterpret_cast<char*>(bytes.data()), size)) {
    throw std::runtime_error("the file cannot be read");
  }
  return bytes;
}

void BagReader::scan() {
  std::uint64_t at = sizeof(kMagic) - 1;
  bool indexed = false;
  try {
    while (at < file_size_) {
      const std::uint32_t header_size = toU32(readBytes(at, 4).data());
      if (header_size > kLongestHeader) throw std::runtime_error("a record's length is damaged");
      const Bytes header = readBytes(at + 4, header_size);
      const Fields fields = parseFields(header.data(), header_size);
      std::uint32_t data_size = toU32(readBytes(at + 4 + header_size, 4).data());
      const std::uint64_t data_at = at + 8 + header_size;
      const std::uint8_t operation = operationOf(fields);
      const bool cut_off = data_size > file_size_ - data_at;
      if (operation == kChunk) {
        Chunk chunk;
        chunk.position = data_at;
        chunk.compression = textField(fields, "compression");
        chunk.size = numberField(fields, "size");
        // Of a chunk that is cut off, the messages before the cut are intact if it is plain.
        chunk.stored =
            static_cast<std::uint32_t>(std::min<std::uint64_t>(data_size, file_size_ - data_at));
        if (cut_off) chunk.size = chunk.stored;
        chunks_.push_back(chunk);
        scanChunk(static_cast<std::uint32_t>(chunks_.size() - 1));
      } else if (operation == kConnection && !cut_off) {
        const Bytes data = readBytes(data_at, data_size);
        addConnection(numberField(fields, "conn"), textField(fields, "topic"), data.data(),
                      data_size);
      } else if (operation == kBagHeader) {
        const std::string index = textField(fields, "index_pos");
        indexed = index.size() == 8 && index != std::string(8, '\0');
        if (!indexed) noteDamage("is not indexed, since its recording did not end properly");
      }
      if (cut_off) throw std::runtime_error("the file is cut off");
      at = data_at + data_size;
    }
  } catch (const std::exception& error) {
    noteDamage(std::string(error.what()) + " at byte " + std::to_string(at) + " of " +
               std::to_string(file_size_));
  }
}

void BagReader::scanChunk(std::uint32_t index) {
  std::uint64_t at = 0;
  try {
    const Bytes& bytes = cachedChunk(index);
    const auto readable = [&](std::uint64_t position, std::uint64_t size) {
      if (size > bytes.size() - std::min<std::uint64_t>(position, bytes.size())) {
        throw std::runtime_error("its last record is cut off");
      }
      return bytes.data() + position;
    };
    while (at < bytes.size()) {
      const std::uint32_t header_size = toU32(readable(at, 4));
      const Fields fields = parseFields(readable(at + 4, header_size), header_size);
      const std::uint32_t data_size = toU32(readable(at + 4 + header_size, 4));
      const std::uint64_t data_at = at + 8 + header_size;
      const std::uint8_t* data = readable(data_at, data_size);
      const std::uint8_t operation = operationOf(fields);
      if (operation == kConnection) {
        addConnection(numberField(fields, "conn"), textField(fields, "topic"), data, data_size);
      } else if (operation == kMessageData) {
        const auto connection = connection_of_id_.find(numberField(fields, "conn"));
        const std::string time = textField(fields, "time");
        if (connection == connection_of_id_.end() || time.size() != 8) {
          throw std::runtime_error("a message belongs to no topic");
        }
        const std::uint32_t nanoseconds = toU32(time.data() + 4);
        if (nanoseconds >= 1000000000U) throw std::runtime_error("a message has no valid time");
        entries_.push_back({ros::Time(toU32(time.data()), nanoseconds), connection->second, index,
                            static_cast<std::uint32_t>(data_at), data_size});
      }
      at = data_at + data_size;
    }
  } catch (const std::exception& error) {
    noteDamage("chunk " + std::to_string(index + 1) + " is damaged: " + error.what());
  }
}

void BagReader::addConnection(std::uint32_t id, const std::string& topic, const std::uint8_t* data,
                              std::uint32_t size) {
  if (connection_of_id_.count(id) > 0) return;  // repeated in the index
  const Fields fields = parseFields(data, size);
  BagConnection connection;
  connection.topic = topic;
  connection.datatype = textField(fields, "type");
  connection.md5sum = textField(fields, "md5sum");
  connection.definition = textField(fields, "message_definition");
  if (connection.topic.empty() || connection.datatype.empty() || connection.md5sum.empty()) {
    throw std::runtime_error("a topic's description is incomplete");
  }
  connection.header = boost::make_shared<ros::M_string>(fields.begin(), fields.end());
  connection_of_id_[id] = static_cast<std::uint32_t>(connections_.size());
  connections_.push_back(connection);
}

BagReader::Bytes BagReader::loadChunk(const Chunk& chunk) {
  Bytes stored = readBytes(chunk.position, chunk.stored);
  if (chunk.compression == "none") return stored;
  const bool bz2 = chunk.compression == "bz2";
  if (!bz2 && chunk.compression != "lz4") {
    throw std::runtime_error("its compression '" + chunk.compression + "' is unknown");
  }
  // No honest chunk shrinks more than this; a forged size shall not take all memory.
  const std::uint64_t largest =
      std::min<std::uint64_t>(kLargestChunk, 1024ULL * chunk.stored + (1ULL << 20));
  if (chunk.size > largest) throw std::runtime_error("its size is impossible");
  Bytes bytes(chunk.size);
  unsigned int size = chunk.size;
  auto* from = reinterpret_cast<char*>(stored.data());
  auto* to = reinterpret_cast<char*>(bytes.data());
  const bool ok = bz2 ? BZ2_bzBuffToBuffDecompress(to, &size, from, chunk.stored, 0, 0) == BZ_OK
                      : roslz4_buffToBuffDecompress(from, chunk.stored, to, &size) == ROSLZ4_OK;
  if (!ok || size != chunk.size) throw std::runtime_error("it cannot be decompressed");
  return bytes;
}

const BagReader::Bytes& BagReader::cachedChunk(std::uint32_t index) {
  const auto found = std::find_if(cache_.begin(), cache_.end(),
                                  [&](const auto& one) { return one.first == index; });
  if (found != cache_.end()) {
    cache_.splice(cache_.begin(), cache_, found);
  } else {
    cache_.emplace_front(index, loadChunk(chunks_[index]));
    if (cache_.size() > kCachedChunks) cache_.pop_back();
  }
  return cache_.front().second;
}

std::size_t BagReader::messageCount(const std::string& topic) const {
  return static_cast<std::size_t>(std::count_if(
      entries_.begin(), entries_.end(),
      [&](const Entry& entry) { return connections_[entry.connection].topic == topic; }));
}

ros::Time BagReader::beginTime() const {
  return entries_.empty() ? ros::Time() : entries_.front().time;
}

ros::Time BagReader::endTime() const {
  return entries_.empty() ? ros::Time() : entries_.back().time;
}

bool BagReader::next(BagMessage* message) {
  while (position_ < entries_.size()) {
    const Entry& entry = entries_[position_++];
    try {
      const Bytes& bytes = cachedChunk(entry.chunk);
      message->time = entry.time;
      message->connection = &connections_[entry.connection];
      message->data = bytes.data() + entry.offset;
      message->size = entry.size;
      return true;
    } catch (const std::exception& error) {
      noteDamage(error.what());
    }
  }
  return false;
}

namespace {

/// Walks over the fields of a serialised message.
class Cursor {
 public:
  Cursor(const std::uint8_t* data, std::uint32_t size) : at_(data), left_(size) {}

  void skip(std::uint64_t bytes) {
    if (bytes > left_) {
      throw std::runtime_error("it claims " + std::to_string(bytes) + " bytes where " +
                               std::to_string(left_) + " are left");
    }
    at_ += bytes;
    left_ -= bytes;
  }
  std::uint32_t number() {
    const std::uint8_t* here = at_;
    skip(4);
    return toU32(here);
  }
  void skipText() { skip(number()); }
  void skipArray(std::uint64_t element_size) { skip(number() * element_size); }
  void skipHeader() {
    skip(12);  // seq, stamp
    skipText();
  }

 private:
  const std::uint8_t* at_;
  std::uint64_t left_;
};

}  // namespace

void checkArrayLengths(const std::string& datatype, const std::uint8_t* data, std::uint32_t size) {
  Cursor cursor(data, size);
  if (datatype == "sensor_msgs/Image") {
    cursor.skipHeader();
    cursor.skip(8);  // height, width
    cursor.skipText();
    cursor.skip(5);  // is_bigendian, step
    cursor.skipArray(1);
  } else if (datatype == "sensor_msgs/CameraInfo") {
    cursor.skipHeader();
    cursor.skip(8);
    cursor.skipText();
    cursor.skipArray(8);
  } else if (datatype == "tf2_msgs/TFMessage") {
    const std::uint32_t transforms = cursor.number();
    for (std::uint32_t i = 0; i < transforms; ++i) {
      cursor.skipHeader();
      cursor.skipText();
      cursor.skip(56);  // translation, rotation
    }
  }
}

}  // namespace adaptive_grid_stereo
