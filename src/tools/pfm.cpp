#include "pfm.h"

#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <locale>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace adaptive_grid_stereo {
namespace {

constexpr std::size_t kLongestToken = 32;
constexpr long kLargestSide = 65536;

bool hostIsLittleEndian() {
  const std::uint16_t probe = 1;
  std::uint8_t first_byte = 0;
  std::memcpy(&first_byte, &probe, 1);
  return first_byte == 1;
}

/// The next word of the header, together with the single white space that ends it.
std::string readToken(std::istream& stream) {
  int character = stream.get();
  while (character != EOF && std::isspace(character)) character = stream.get();
  std::string token;
  while (character != EOF && !std::isspace(character)) {
    if (token.size() == kLongestToken) throw std::runtime_error("the PFM header is no text");
    token += static_cast<char>(character);
    character = stream.get();
  }
  if (character == EOF) throw std::runtime_error("the PFM header ends too early");
  return token;
}

template <typename Number>
Number parseNumber(const std::string& token, const char* name) {
  std::istringstream text(token);
  text.imbue(std::locale::classic());
  Number number{};
  if (!(text >> number) || text.peek() != EOF) {
    throw std::runtime_error(std::string("the PFM header's ") + name + " is '" + token +
                             "', expected a number");
  }
  return number;
}

int readSide(std::istream& stream, const char* name) {
  const std::string token = readToken(stream);
  const long side = parseNumber<long>(token, name);
  if (side < 1 || side > kLargestSide) {
    throw std::runtime_error(std::string("the PFM header's ") + name + " is " + token +
                             ", expected 1 to " + std::to_string(kLargestSide));
  }
  return static_cast<int>(side);
}

std::uint64_t bytesLeft(std::istream& stream) {
  const std::istream::pos_type here = stream.tellg();
  stream.seekg(0, std::ios::end);
  const std::istream::pos_type end = stream.tellg();
  stream.seekg(here);
  if (!stream || here < 0 || end < here) throw std::runtime_error("the PFM cannot be read");
  return static_cast<std::uint64_t>(end - here);
}

void swapBytes(cv::Mat* image) {
  for (int y = 0; y < image->rows; ++y) {
    std::uint8_t* bytes = image->ptr<std::uint8_t>(y);
    for (int x = 0; x < image->cols; ++x, bytes += 4) {
      std::swap(bytes[0], bytes[3]);
      std::swap(bytes[1], bytes[2]);
    }
  }
}

}  // namespace

cv::Mat readPfm(std::istream& stream) {
  const std::string magic = readToken(stream);
  if (magic == "PF") throw std::runtime_error("the PFM has three channels (PF), expected one (Pf)");
  if (magic != "Pf") throw std::runtime_error("no PFM: it starts with neither Pf nor PF");
  const int width = readSide(stream, "width");
  const int height = readSide(stream, "height");
  // The sign tells the byte order; the magnitude is a scale that disparity files do not use.
  const double scale = parseNumber<double>(readToken(stream), "scale");
  if (!std::isfinite(scale) || scale == 0.0) {
    throw std::runtime_error("the PFM header's scale is 0 or no number");
  }
  const std::uint64_t needed = 4ULL * static_cast<std::uint64_t>(width) * height;
  const std::uint64_t found = bytesLeft(stream);
  if (found < needed) {
    throw std::runtime_error("the PFM is cut off: " + std::to_string(width) + "x" +
                             std::to_string(height) + " pixels need " + std::to_string(needed) +
                             " bytes, " + std::to_string(found) + " are there");
  }
  cv::Mat image(height, width, CV_32FC1);
  for (int y = height - 1; y >= 0; --y) {
    if (!stream.read(image.ptr<char>(y), 4 * static_cast<std::streamsize>(width))) {
      throw std::runtime_error("the PFM cannot be read to its end");
    }
  }
  if ((scale < 0.0) != hostIsLittleEndian()) swapBytes(&image);
  return image;
}

cv::Mat readPfm(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw std::runtime_error(path + ": cannot be opened");
  try {
    return readPfm(stream);
  } catch (const std::runtime_error& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

void writePfm(std::ostream& stream, const cv::Mat& image) {
  if (image.type() != CV_32FC1 || image.empty()) {
    throw std::invalid_argument("writePfm: expected a CV_32FC1 image");
  }
  cv::Mat little_endian = image;
  if (!hostIsLittleEndian()) {
    little_endian = image.clone();
    swapBytes(&little_endian);
  }
  stream << "Pf\n" << image.cols << ' ' << image.rows << "\n-1.0\n";
  for (int y = image.rows - 1; y >= 0; --y) {
    stream.write(little_endian.ptr<char>(y), 4 * static_cast<std::streamsize>(image.cols));
  }
  if (!stream) throw std::runtime_error("the PFM cannot be written; is the disk full?");
}

}  // namespace adaptive_grid_stereo
