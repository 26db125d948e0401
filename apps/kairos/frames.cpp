#include "frames.h"

#include "arguments.h"

namespace kairos::cli {

FrameRange parse_frames(const std::string& option, std::string_view text) {
  constexpr uint64_t kMostFrame = 1'000'000'000, kMostFrames = 100'000;
  const size_t dash = text.find('-');
  const auto number = [&](std::string_view part) { return static_cast<int>(parse_count(option, part, 0, kMostFrame)); };
  FrameRange range;
  range.first = number(text.substr(0, dash));
  range.last = dash == text.npos ? range.first : number(text.substr(dash + 1));
  if (range.first > range.last)
    throw CLI::ValidationError(option, fmt::format("'{}' is empty; give A-B with A <= B", text));
  if (static_cast<uint64_t>(range.last - range.first) >= kMostFrames)
    throw CLI::ValidationError(option, fmt::format("'{}' are more than {} frames", text, kMostFrames));
  return range;
}

FrameName::FrameName(const std::string& option, std::string_view text) {
  bool found = false;
  const auto refuse = [&](const char* why) {
    throw CLI::ValidationError(option,
                               fmt::format("'{}' {}; a sequence's name has one %d or %04d, and %% for a percent "
                                           "sign",
                                           text, why));
  };
  for (size_t i = 0; i < text.size(); ++i) {
    std::string& part = found ? after_ : before_;
    if (text[i] != '%') {
      part += text[i];
      continue;
    }
    if (++i == text.size()) refuse("ends in a single %");
    if (text[i] == '%') {
      part += '%';
      continue;
    }
    if (found) refuse("has more than one place for the frame's number");
    found = true;
    if (text[i] == '0' && i + 1 < text.size() && text[i + 1] >= '1' && text[i + 1] <= '9') {
      digits_ = text[i + 1] - '0';
      i += 2;
    }
    if (i >= text.size() || text[i] != 'd') refuse("has a % that stands for something else");
  }
  if (!found) refuse("has no place for the frame's number");
}

void FrameName::check(const std::string& option, std::string_view text) {
  [[maybe_unused]] const FrameName parsed(option, text);
}

std::string FrameName::at(int frame) const { return fmt::format("{}{:0{}}{}", before_, frame, digits_, after_); }

}  // namespace kairos::cli
