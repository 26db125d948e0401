#include "study/run_log.h"

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string_view>

#include <fmt/format.h>

#include <kairos/error.h>

#include "base/file.h"

namespace kairos::study {

const char* const kRunHeader =
    "scene,shading,method,spp,tc_rays,shading_samples,seed,seconds,wall_seconds,cpu_seconds,build_seconds,mse,psnr,"
    "relative_mse,rays,segments,shaded,nodes,triangles,root_solves";
const char* const kReferenceHeader = "scene,shading,spp_of_each_half,mse,psnr,relative_mse,seconds";

namespace {

/// Takes a line's fields one by one.
class Fields {
 public:
  Fields(std::string_view line, const std::string& place) : rest_(line), place_(place) {}

  std::string_view text() {
    if (ended_) refuse();
    const size_t comma = rest_.find(',');
    const std::string_view field = rest_.substr(0, comma);
    ended_ = comma == std::string_view::npos;
    rest_.remove_prefix(ended_ ? rest_.size() : comma + 1);
    return field;
  }
  template <class Number>
  Number number() {
    const std::string_view field = text();
    if constexpr (std::is_floating_point_v<Number>) {
      if (field == "inf") return std::numeric_limits<Number>::infinity();
    }
    Number value{};
    const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
    if (error != std::errc() || end != field.data() + field.size()) refuse();
    return value;
  }
  template <class Enum>
  Enum choice() {
    const std::optional<Enum> value = parse<Enum>(text());
    if (!value) refuse();
    return *value;
  }
  void end() const {
    if (!ended_) refuse();
  }

 private:
  [[noreturn]] void refuse() const {
    throw Error(ErrorCode::bad_input, place_, "is not a line of a study's log; start anew with --force");
  }

  std::string_view rest_;
  const std::string& place_;
  bool ended_ = false;
};

Entry parse_entry(Fields& fields) {
  Entry entry;
  entry.scene = fields.text();
  entry.shading = fields.choice<ShadingKind>();
  return entry;
}
PictureError parse_error(Fields& fields) {
  PictureError error;
  error.mse = fields.number<double>();
  error.psnr = fields.number<double>();
  error.relative_mse = fields.number<double>();
  return error;
}

}  // namespace

std::string name_of(const Entry& entry) { return fmt::format("{}-{}", entry.scene, to_string(entry.shading)); }

std::string to_line(const Run& r) {
  return fmt::format("{},{},{},{},{},{},{},{:.6g},{:.6g},{:.6g},{:.6g},{:.9g},{:.9g},{:.9g},{},{},{},{},{},{}",
                     r.entry.scene, to_string(r.entry.shading), to_string(r.setting.method), r.setting.spp,
                     r.setting.tc_rays, r.setting.shading_samples, r.seed, r.seconds, r.wall_seconds, r.cpu_seconds,
                     r.build_seconds, r.error.mse, r.error.psnr, r.error.relative_mse, r.rays, r.segments, r.shaded,
                     r.nodes, r.triangles, r.root_solves);
}

std::string to_line(const ReferenceRun& r) {
  return fmt::format("{},{},{},{:.9g},{:.9g},{:.9g},{:.6g}", r.entry.scene, to_string(r.entry.shading), r.spp,
                     r.error.mse, r.error.psnr, r.error.relative_mse, r.seconds);
}

Run parse_run(const std::string& line, const std::string& place) {
  Fields fields(line, place);
  Run r;
  r.entry = parse_entry(fields);
  r.setting.method = fields.choice<Method>();
  for (int* const value : {&r.setting.spp, &r.setting.tc_rays, &r.setting.shading_samples, &r.seed})
    *value = fields.number<int>();
  for (double* const value : {&r.seconds, &r.wall_seconds, &r.cpu_seconds, &r.build_seconds})
    *value = fields.number<double>();
  r.error = parse_error(fields);
  for (uint64_t* const value : {&r.rays, &r.segments, &r.shaded, &r.nodes, &r.triangles, &r.root_solves})
    *value = fields.number<uint64_t>();
  fields.end();
  return r;
}

ReferenceRun parse_reference(const std::string& line, const std::string& place) {
  Fields fields(line, place);
  ReferenceRun r;
  r.entry = parse_entry(fields);
  r.spp = fields.number<int>();
  r.error = parse_error(fields);
  r.seconds = fields.number<double>();
  fields.end();
  return r;
}

LineLog::LineLog(std::string path, const std::string& header) : path_(std::move(path)) {
  constexpr uint64_t kMostBytes = uint64_t{1} << 30;
  if (!std::filesystem::exists(path_)) {
    append(header);
    lines_.clear();
    return;
  }
  const std::vector<uint8_t> bytes = read_file(path_, kMostBytes);
  size_t whole = 0;  // bytes of finished lines
  bool first = true;
  for (size_t i = 0; i < bytes.size(); ++i) {
    if (bytes[i] != '\n') continue;
    std::string line(bytes.begin() + static_cast<ptrdiff_t>(whole), bytes.begin() + static_cast<ptrdiff_t>(i));
    whole = i + 1;
    if (first && line != header)
      throw Error(ErrorCode::bad_input, path_, "is not a log of this study; start anew with --force");
    if (!first) lines_.push_back(std::move(line));
    first = false;
  }
  std::error_code ec;
  if (whole < bytes.size()) std::filesystem::resize_file(path_, whole, ec);
  if (ec) throw Error(ErrorCode::io, path_, "cannot be written: " + ec.message());
  if (first) {
    append(header);
    lines_.clear();
  }
}

void LineLog::append(const std::string& line) {
  std::FILE* const file = std::fopen(path_.c_str(), "ab");
  const std::string text = line + "\n";
  // In one piece: what an interruption leaves is a whole line, or one without an end.
  bool written = file != nullptr && std::fwrite(text.data(), 1, text.size(), file) == text.size();
  if (file != nullptr) written = std::fclose(file) == 0 && written;
  if (!written) throw Error(ErrorCode::io, path_, std::string("cannot be written: ") + std::strerror(errno));
  lines_.push_back(line);
}

}  // namespace kairos::study
