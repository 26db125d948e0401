#include "view_arguments.h"

#include <cmath>
#include <filesystem>

#include "arguments.h"

namespace kairos::cli {

void add_view_options(CLI::App& app, ViewArguments& out) {
  app.add_option_function<std::string>(
         "--view", [&out](const std::string& text) { out.choice = parse_choice<ViewTransform>("--view", text); },
         "How a PNG shows colours. standard: as they are, cut off at white; filmic: with a soft shoulder (default "
         "where the shading is lit)")
      ->type_name("standard|filmic");
  add_real(app, "--exposure", "Stops by which a PNG is brighter [0]", "EV", [&out](double v) {
    constexpr double kMost = 100;
    if (!(std::abs(v) <= kMost)) throw CLI::ValidationError("--exposure", "must be -100 to 100");
    out.exposure = v;
  });
}

void check_view(const CLI::App& app, const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (path.empty()) {
    for (const char* option : {"--view", "--exposure"})
      if (app.count(option) > 0) throw CLI::ValidationError(option, "is for a picture; give --output, too");
  }
  if (extension != ".exr") return;
  for (const char* option : {"--view", "--exposure"})
    if (app.count(option) > 0)
      throw CLI::ValidationError(option, "is for PNG: EXR holds the colours as they were rendered");
}

}  // namespace kairos::cli
