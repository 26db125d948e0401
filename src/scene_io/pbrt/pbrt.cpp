#include "scene_io/pbrt/pbrt.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include <kairos/error.h>

#include "base/file.h"
#include "scene_io/pbrt/builder.h"
#include "scene_io/pbrt/gzip.h"
#include "scene_io/text_numbers.h"

namespace kairos {

namespace pbrt {

namespace {

constexpr uint64_t kMaxFileSize = uint64_t{1} << 32;

// How pbrt renders, not what.
constexpr std::array<std::string_view, 9> kRendering = {"Accelerator", "Integrator",       "Option",
                                                        "PixelFilter", "Renderer",         "Sampler",
                                                        "Filter",      "VolumeIntegrator", "SurfaceIntegrator"};
constexpr std::array<std::string_view, 3> kMedia = {"MakeNamedMedium", "MediumInterface", "Volume"};

template <size_t N>
bool is_one_of(std::string_view word, const std::array<std::string_view, N>& list) {
  return std::find(list.begin(), list.end(), word) != list.end();
}

class Reader {
 public:
  Reader(const std::string& path, LoadContext& context, uint64_t max_triangles)
      : folder_(context.folder_of(path)), context_(context), builder_(folder_, context, max_triangles) {}

  void read(std::string_view text, const std::string& path) {
    Tokens tokens(text, path);
    while (tokens.peek().kind != Token::Kind::end) {
      const Place place = tokens.place();
      const Token statement = tokens.take();
      if (statement.kind != Token::Kind::word)
        fail(place, "'" + printable(statement.text) + "' stands where a statement should");
      if (ended_) {
        builder_.warnings.add(place, "what follows the first WorldEnd is left out");
        return;
      }
      perform(statement.text, tokens, place);
    }
  }

  Scene finish() { return builder_.finish(); }

 private:
  void perform(std::string_view statement, Tokens& tokens, const Place& place) {
    if (builder_.transform.perform(statement, tokens) || bracket(statement, tokens, place) ||
        with_parameters(statement, tokens) || is_one_of(statement, kRendering) || other(statement, tokens, place)) {
      if (is_one_of(statement, kRendering)) pass_over(tokens);
      return;
    }
    builder_.warnings.add(place, is_one_of(statement, kMedia)
                                     ? std::string("smoke and other media are left out")
                                     : "the statement '" + printable(statement) + "' is not known: left out");
    pass_over(tokens);
  }

  /// Up to the next statement.
  static void pass_over(Tokens& tokens) {
    for (;;) {
      const Token& next = tokens.peek();
      double number = 0;
      if (next.kind == Token::Kind::end) return;
      if (next.kind == Token::Kind::word && !parse_number(next.text, number) && next.text != "true" &&
          next.text != "false")
        return;
      tokens.take();
    }
  }

  /// What begins and ends.
  bool bracket(std::string_view statement, Tokens& tokens, const Place& place) {
    if (statement == "AttributeBegin")
      builder_.begin("Attribute", place);
    else if (statement == "AttributeEnd")
      builder_.end("Attribute", place);
    else if (statement == "TransformBegin")
      builder_.begin("Transform", place);
    else if (statement == "TransformEnd")
      builder_.end("Transform", place);
    else if (statement == "ObjectBegin")
      builder_.object_begin(tokens.take_string(), place);
    else if (statement == "ObjectEnd")
      builder_.object_end(place);
    else if (statement == "WorldBegin")
      builder_.world_begin();
    else if (statement == "WorldEnd")
      ended_ = true;
    else
      return false;
    return true;
  }

  /// "kind", then parameters.
  bool with_parameters(std::string_view statement, Tokens& tokens) {
    const auto read = [&](const char* target, auto&& use) {
      const std::string kind = tokens.take_string();
      Parameters parameters(tokens);
      builder_.add_defaults(target, parameters);
      use(kind, parameters);
      return true;
    };
    if (statement == "Shape") return read("shape", [&](auto& kind, auto& list) { builder_.shape(kind, list); });
    if (statement == "Material")
      return read("material", [&](auto& kind, auto& list) { builder_.material(kind, list); });
    if (statement == "MakeNamedMaterial")
      return read("material", [&](auto& name, auto& list) { builder_.materials.define(name, list); });
    if (statement == "LightSource") return read("light", [&](auto& kind, auto& list) { builder_.light(kind, list); });
    if (statement == "AreaLightSource")
      return read("light", [&](auto& kind, auto& list) { builder_.area_light(kind, list); });
    if (statement == "Camera") return read("camera", [&](auto& kind, auto& list) { builder_.camera(kind, list); });
    if (statement == "Film") return read("film", [&](auto& kind, auto& list) { builder_.film(kind, list); });
    if (statement == "Attribute") {
      const std::string target = tokens.take_string();
      builder_.defaults(target, Parameters(tokens));
      return true;
    }
    if (statement == "Texture") {
      const std::string name = tokens.take_string(), type = tokens.take_string();
      return read("texture", [&](auto& kind, auto& list) { builder_.textures.define(name, type, kind, list); });
    }
    return false;
  }

  bool other(std::string_view statement, Tokens& tokens, const Place& place) {
    if (statement == "NamedMaterial") {
      builder_.named_material(tokens.take_string(), place);
    } else if (statement == "ObjectInstance") {
      builder_.object_instance(tokens.take_string(), place);
    } else if (statement == "ReverseOrientation") {
      builder_.reverse_orientation();
    } else if (statement == "TransformTimes") {
      const double start = tokens.take_number(), end = tokens.take_number();
      builder_.transform_times(start, end, place);
    } else if (statement == "ColorSpace") {
      if (const std::string name = tokens.take_string(); name != "srgb")
        builder_.warnings.add(place, "the colour space '" + printable(name) + "' is taken as 'srgb'");
    } else if (statement == "Include") {
      include(tokens.take_string(), place);
    } else if (statement == "Import") {
      const std::string name = tokens.take_string();
      builder_.begin("Attribute", place);
      include(name, place);
      builder_.end("Attribute", place);
    } else {
      return false;
    }
    return true;
  }

  void include(const std::string& name, const Place& place) {
    constexpr size_t kMaxIncludeDepth = 16;
    const auto path = find_file(name, place, folder_, builder_.warnings);
    if (!path) return;
    if (context_.open_files.size() >= kMaxIncludeDepth)
      fail(place, fmt::format("files are nested more than {} deep; does one include itself?", kMaxIncludeDepth));
    context_.count_file(place.text());
    const std::vector<uint8_t> bytes = read_maybe_packed(*path, kMaxFileSize, context_.budget);
    context_.open_files.push_back(*path);
    read({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, *path);
    context_.open_files.pop_back();
  }

  const SceneFolder folder_;
  LoadContext& context_;
  Builder builder_;
  bool ended_ = false;  ///< has WorldEnd come?
};

}  // namespace
}  // namespace pbrt

Scene parse_pbrt(std::string_view text, const std::string& path, LoadContext& context, uint64_t max_triangles) {
  pbrt::Reader reader(path, context, max_triangles);
  reader.read(text, path);
  return reader.finish();
}

Scene load_pbrt(const std::string& path, LoadContext& context) {
  context.count_file(path);
  const std::vector<uint8_t> bytes = pbrt::read_maybe_packed(path, pbrt::kMaxFileSize, context.budget);
  return parse_pbrt({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path, context);
}

}  // namespace kairos
