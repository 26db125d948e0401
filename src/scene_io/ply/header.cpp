#include "scene_io/ply/header.h"

#include <fmt/format.h>

#include <kairos/error.h>

#include "scene_io/text_numbers.h"

namespace kairos {

uint64_t size_of(PlyType type) {
  switch (type) {
    case PlyType::int8:
    case PlyType::uint8:
      return 1;
    case PlyType::int16:
    case PlyType::uint16:
      return 2;
    case PlyType::int32:
    case PlyType::uint32:
    case PlyType::float32:
      return 4;
    case PlyType::float64:
      return 8;
  }
  return 8;
}

namespace {

struct TypeName {
  std::string_view name;
  PlyType type;
};
constexpr TypeName kTypeNames[] = {
    {"char", PlyType::int8},      {"uchar", PlyType::uint8},    {"short", PlyType::int16},
    {"ushort", PlyType::uint16},  {"int", PlyType::int32},      {"uint", PlyType::uint32},
    {"float", PlyType::float32},  {"double", PlyType::float64}, {"int8", PlyType::int8},
    {"uint8", PlyType::uint8},    {"int16", PlyType::int16},    {"uint16", PlyType::uint16},
    {"int32", PlyType::int32},    {"uint32", PlyType::uint32},  {"float32", PlyType::float32},
    {"float64", PlyType::float64}};

class HeaderParser {
 public:
  HeaderParser(std::string_view file, const std::string& path) : file_(file), path_(path) {
    // The first line tells how lines end: a binary part may begin with any byte, also one that looks like an end.
    if (file.substr(0, 3) != "ply") fail("does not begin with 'ply'; is it a PLY file?");
    line_end_ = file.substr(3, 2) == "\r\n" ? "\r\n" : file.substr(3, 1) == "\r" ? "\r" : "\n";
  }

  PlyHeader parse() {
    if (const auto first = next_line(); first.size() != 1 || first[0] != "ply")
      fail("does not begin with a line 'ply'");
    bool has_format = false;
    for (;;) {
      const std::vector<std::string_view> words = next_line();
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format") {
        header_.format = read_format(words);
        has_format = true;
      } else if (words[0] == "element") {
        read_element(words);
      } else if (words[0] == "property") {
        read_property(words);
      } else {
        // Some exporters forget the word "comment".
        header_.warnings.push_back(
            fmt::format("{}:{}: header line '{} ...' passed over", path_, line_, printable(words[0])));
      }
    }
    if (!has_format) fail("the header has no format line");
    header_.size = position_;
    return std::move(header_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(ErrorCode::bad_input, line_ == 0 ? path_ : fmt::format("{}:{}", path_, line_), what);
  }

  std::vector<std::string_view> next_line() {
    const size_t end = file_.find(line_end_, position_);
    if (end == file_.npos) fail("the header does not end: there is no line 'end_header'");
    std::string_view line = file_.substr(position_, end - position_);
    position_ = end + line_end_.size();
    ++line_;
    std::vector<std::string_view> words;
    constexpr std::string_view kSpaces = " \t\r";
    for (;;) {
      line.remove_prefix(std::min(line.find_first_not_of(kSpaces), line.size()));
      if (line.empty()) return words;
      words.push_back(line.substr(0, line.find_first_of(kSpaces)));
      line.remove_prefix(words.back().size());
    }
  }

  PlyFormat read_format(const std::vector<std::string_view>& words) const {
    if (words.size() != 3 || words[2] != "1.0")
      fail("expected 'format ascii|binary_little_endian|binary_big_endian 1.0'");
    if (words[1] == "ascii") return PlyFormat::ascii;
    if (words[1] == "binary_little_endian") return PlyFormat::little_endian;
    if (words[1] == "binary_big_endian") return PlyFormat::big_endian;
    fail("unknown format '" + printable(words[1]) + "'");
  }

  void read_element(const std::vector<std::string_view>& words) {
    int64_t count = 0;
    if (words.size() != 3 || !parse_integer(words[2], count) || count < 0) fail("expected 'element NAME COUNT'");
    header_.elements.push_back({std::string(words[1]), static_cast<uint64_t>(count), {}});
  }

  PlyType read_type(std::string_view name) const {
    for (const TypeName& known : kTypeNames)
      if (known.name == name) return known.type;
    fail("unknown type '" + printable(name) + "'");
  }

  void read_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("a property before the first element");
    PlyProperty property;
    property.is_list = words.size() == 5 && words[1] == "list";
    if (!property.is_list && words.size() != 3) fail("expected 'property TYPE NAME' or 'property list TYPE TYPE NAME'");
    if (property.is_list) {
      property.count_type = read_type(words[2]);
      if (property.count_type == PlyType::float32 || property.count_type == PlyType::float64)
        fail("the length of a list cannot be a floating-point number");
    }
    property.type = read_type(words[words.size() - 2]);
    property.name = words.back();
    header_.elements.back().properties.push_back(property);
  }

  std::string_view file_;
  const std::string& path_;
  std::string_view line_end_;
  size_t position_ = 0, line_ = 0;
  PlyHeader header_;
};

}  // namespace

PlyHeader parse_ply_header(std::string_view file, const std::string& path) { return HeaderParser(file, path).parse(); }

}  // namespace kairos
