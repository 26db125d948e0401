#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <kairos/error.h>
#include <kairos/names.h>
#include <kairos/time_page.h>

#include "base/web_page.h"
#include "time_page/reduced_picture.h"

namespace kairos {

namespace time_page {

// Files of src/time_page/page, put into the program when it is built.
extern const char* const page_html;
extern const char* const style_css;
extern const char* const signals_js;
extern const char* const shutter_js;
extern const char* const picture_js;
extern const char* const diagram_js;
extern const char* const main_js;

namespace {

/// Numbers of 16 bits one after the other, split into all lower bytes and all upper ones, which packs better.
void add_column(std::vector<uint8_t>& out, const std::vector<uint16_t>& numbers) {
  for (const int shift : {0, 8})
    for (const uint16_t number : numbers) out.push_back(static_cast<uint8_t>(number >> shift));
}

/// Columns, in this order: pieces of each pixel; where each begins, in 65536ths of the time; red, green and blue at its
/// beginning, and how much more they are at its end, as halves. signals.js reads them.
std::vector<uint8_t> columns_of(const ReducedPicture& picture, size_t& pieces) {
  std::vector<uint16_t> counts, begins;
  std::array<std::vector<uint16_t>, 6> values;
  for (const TimeTile& row : picture.rows) {
    for (size_t pixel = 0; pixel < row.pixels(); ++pixel) {
      const uint32_t first = row.first[pixel], last = row.first[pixel + 1];
      if (last - first > 0xffff)
        throw Error(ErrorCode::bad_usage, "", "a pixel shows too many things for a page; give a smaller --page-width");
      counts.push_back(static_cast<uint16_t>(last - first));
    }
    for (const uint32_t begin : row.begin) begins.push_back(static_cast<uint16_t>(begin >> 16));
    for (size_t c = 0; c < 3; ++c) {
      for (const auto& left : row.halves.left) values[c].push_back(left[c]);
      for (const auto& step : row.halves.step) values[3 + c].push_back(step[c]);
    }
  }
  pieces = begins.size();
  std::vector<uint8_t> out;
  add_column(out, counts);
  add_column(out, begins);
  for (const auto& column : values) add_column(out, column);
  return out;
}

std::vector<uint8_t> deflated(const std::vector<uint8_t>& bytes) {
  uLongf size = compressBound(bytes.size());
  std::vector<uint8_t> packed(size);
  // There is room enough, so memory is all that it can lack.
  if (compress2(packed.data(), &size, bytes.data(), bytes.size(), Z_BEST_COMPRESSION) != Z_OK) throw std::bad_alloc();
  packed.resize(size);
  return packed;
}

}  // namespace

}  // namespace time_page

std::string shutter_page(const TimePicture& picture, const ShutterPageOptions& options) {
  using namespace time_page;
  const TimeFrame& frame = picture.frame();
  if (!(frame.close > frame.open))
    throw Error(ErrorCode::bad_input, options.file,
                "holds a single instant; for a page render it with a --shutter that is open for a while");
  if (options.width < 1) throw Error(ErrorCode::bad_usage, "", "a page's picture must be at least a pixel wide");
  const int factor = (frame.width + options.width - 1) / options.width;
  const ReducedPicture small = reduced(picture, factor, options.tolerance, options.threads, options.progress);
  nlohmann::ordered_json json;
  size_t pieces = 0;
  const std::vector<uint8_t> columns = columns_of(small, pieces);
  json["file"] = options.file;
  json["width"] = small.width;
  json["height"] = small.height;
  json["factor"] = factor;
  json["frame"] = nlohmann::json::array({frame.frame_width, frame.frame_height});
  json["crop"] = nlohmann::json::array({frame.left, frame.left + frame.width, frame.top, frame.top + frame.height});
  json["pixel_aspect"] = frame.pixel_aspect;
  json["open"] = frame.open - frame.frame_time;  // seconds from the frame's time
  json["close"] = frame.close - frame.frame_time;
  json["fps"] = frame.fps;
  json["view"] = to_string(frame.view);
  json["tolerance"] = options.tolerance;
  json["pieces"] = pieces;
  json["packed"] = base64(deflated(columns));
  std::string script;
  for (const char* part : {signals_js, shutter_js, picture_js, diagram_js, main_js}) script += part;
  return web_page(page_html, style_css, script,
                  json.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

}  // namespace kairos
