#include <algorithm>

#include <nlohmann/json.hpp>

#include <kairos/error.h>
#include <kairos/event_page.h>

#include "base/web_page.h"

namespace kairos {

namespace event_page_files {

// Files of src/event_page/page, put into the program when it is built.
extern const char* const page_html;
extern const char* const style_css;
extern const char* const play_js;

}  // namespace event_page_files

std::string event_page(std::span<const Event> events, int width, int height, const std::string& title,
                       std::span<const EventPagePicture> pictures) {
  if (events.empty()) throw Error(ErrorCode::bad_usage, title, "there are no events to show");
  if (events.size() > kMostPageEvents)
    throw Error(ErrorCode::bad_usage, title,
                "a page holds " + std::to_string(kMostPageEvents) + " events at most; give a part of the time");
  const int64_t begin = events.front().time;
  std::vector<uint8_t> bytes;  // of each: microseconds (4 bytes), x (2), y with the polarity in its upper bit (2)
  bytes.reserve(events.size() * 8);
  for (const Event& event : events) {
    const auto time = static_cast<uint64_t>(std::clamp<int64_t>((event.time - begin) / 1000, 0, UINT32_MAX));
    const uint64_t y = uint64_t{event.y} | (event.polarity > 0 ? 1u << 15 : 0);
    const uint64_t packed = time | uint64_t{event.x} << 32 | y << 48;
    for (int shift = 0; shift < 64; shift += 8) bytes.push_back(static_cast<uint8_t>(packed >> shift));
  }
  nlohmann::ordered_json json;
  json["title"] = title;
  json["width"] = width;
  json["height"] = height;
  json["begin"] = static_cast<double>(begin) * 1e-9;
  json["events"] = base64(bytes);
  json["pictures"] = nlohmann::json::array();
  for (const EventPagePicture& picture : pictures)
    json["pictures"].push_back({{"begin", picture.begin}, {"png", base64(picture.bytes)}});
  return web_page(event_page_files::page_html, event_page_files::style_css, event_page_files::play_js,
                  json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace kairos
