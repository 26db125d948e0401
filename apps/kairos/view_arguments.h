// How pictures that a screen shows are made of colours: of render and expose.
#pragma once

#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include <kairos/image.h>

namespace kairos::cli {

struct ViewArguments {
  std::optional<ViewTransform> choice;  ///< unset: as what is shown asks for
  double exposure = 0;                  ///< stops
};

/// --view and --exposure.
void add_view_options(CLI::App& app, ViewArguments& out);

/// Throws CLI::ValidationError where they are given for an EXR, which holds colours as they are.
void check_view(const CLI::App& app, const std::string& path);

}  // namespace kairos::cli
