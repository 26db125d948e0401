#include "events_arguments.h"

#include <cmath>

namespace kairos::cli {

namespace {

using Time = EventFileOptions::Time;
using Polarity = EventFileOptions::Polarity;
using Header = EventFileOptions::Header;
using Evt = EventFileOptions::Evt;

constexpr std::array<Named<Time>, 3> kTimes{
    {{"s", Time::seconds}, {"us", Time::microseconds}, {"ns", Time::nanoseconds}}};
constexpr std::array<Named<Polarity>, 2> kPolarities{{{"01", Polarity::zero_one}, {"signs", Polarity::signs}}};
constexpr std::array<Named<Evt>, 3> kEvts{{{"3", Evt::evt3}, {"2.1", Evt::evt21}, {"2", Evt::evt2}}};
constexpr std::array<Named<Header>, 3> kHeaders{
    {{"none", Header::none}, {"e2vid", Header::e2vid}, {"v2e", Header::v2e}}};

/// An option whose values are named here alone.
template <class Enum, class Out>
void add_named(CLI::App& app, const std::string& name, std::span<const Named<Enum>> names, Out& out,
               const std::string& help) {
  std::string choices;
  for (const auto& choice : names) choices += (choices.empty() ? "" : "|") + std::string(choice.first);
  app.add_option_function<std::string>(
         name, [&out, name, names](const std::string& text) { out = parse_choice<Enum>(name, text, names); }, help)
      ->type_name(choices);
}

}  // namespace

void add_event_sensor_options(CLI::App& app, EventSensor& sensor) {
  // Read first: the options behind it change what it chooses.
  app.add_option_function<std::string>(
         "--sensor",
         [&sensor](const std::string& name) {
           if (name.ends_with(".json")) {
             sensor = read_event_sensor(name);
             return;
           }
           const auto preset = event_sensor(name);
           if (!preset)
             throw CLI::ValidationError(
                 "--sensor", fmt::format("'{}' is neither a .json file nor one of: {}", name, event_sensor_names()));
           sensor = *preset;
         },
         "The sensor's parameters, which the options that follow change [ideal]")
      ->type_name("ideal|v2e|v2e-clean|v2e-noisy|esim|vid2e|metavision|FILE.json")
      ->trigger_on_parse();
  app.add_option_function<std::string>(
         "--contrast",
         [&sensor](const std::string& text) {
           const size_t comma = text.find(',');
           sensor.on = sensor.off = parse_real("--contrast", std::string_view(text).substr(0, comma));
           if (comma != std::string::npos)
             sensor.off = parse_real("--contrast", std::string_view(text).substr(comma + 1));
         },
         "By how much the logarithm of the light has to rise, and fall, for an event [0.2]")
      ->type_name("ON[,OFF]");
  const auto real = [&](const char* name, const char* help, const char* type, double EventSensor::*field) {
    add_real(app, name, help, type, [&sensor, field](double value) { sensor.*field = value; });
  };
  real("--mismatch", "Standard deviation of pixels' thresholds [0]", "SIGMA", &EventSensor::mismatch);
  real("--refractory", "Seconds for which a pixel is quiet after an event [0]", "S", &EventSensor::refractory);
  add_choice(
      app, "--refractory-mode", sensor.refractory_mode,
      "What it does meanwhile. hold: what changes fires later; drop: it is lost; resample: the pixel looks anew");
  real("--cutoff", "Bandwidth of the photoreceptor in light of 1, in Hz; 0: it is infinitely fast [0]", "HZ",
       &EventSensor::cutoff);
  real("--leak", "Events of leaking per second and pixel [0]", "HZ", &EventSensor::leak);
  real("--shot-noise", "Events of shot noise per second and pixel, in the dark [0]", "HZ", &EventSensor::shot_noise);
  real("--dark", "Light that is added to all light: what a pixel sees of the dark [1/255]", "LIGHT",
       &EventSensor::dark);
  real("--white", "Light that counts as 1 [1]", "LIGHT", &EventSensor::white);
  app.add_option("--bayer", sensor.bayer, "Colour filters of each 2x2 pixels; without them pixels see luminance")
      ->type_name("RGGB|BGGR|GRBG|GBRG");
  app.add_flag("--random-level", sensor.random_level, "Pixels begin anywhere between their thresholds");
}

void add_event_file_options(CLI::App& app, EventFileOptions& file) {
  add_named<Time>(app, "--time-unit", kTimes, file.time,
                  "Of stamps in .txt (s, us, ns) and .npz (us, ns) (default: s and us)");
  add_named<Polarity>(app, "--polarity", kPolarities, file.polarity,
                      "0 and 1, or -1 and 1, in .txt and .npz (default: 01 and signs)");
  add_named<Header>(app, "--text-header", kHeaders, file.header,
                    "First lines of .txt: none, the size as E2VID's reader skips it, or v2e's [none]");
  add_named<Evt>(app, "--evt", kEvts, file.evt, "Which EVT a .raw file holds [3]");
  add_real(app, "--epoch", "Seconds that are added to all stamps [0]", "S", [&file](double value) {
    constexpr double kMost = 1e9;
    if (!(value >= 0 && value <= kMost)) throw CLI::ValidationError("--epoch", "must be 0 to 1e9");
    file.epoch = std::llround(value * 1e9);
  });
}

void add_event_folder_options(CLI::App& app, EventsArguments& arguments) {
  EventFolderOptions& folder = arguments.folder;
  CLI::Option* const layout =
      app.add_option_function<std::string>(
             "--layout",
             [&arguments](const std::string& text) {
               arguments.folder.layout = parse_choice<EventLayout>("--layout", text, kNames<EventLayout>);
               arguments.has_layout = true;
             },
             "Make the first --output a folder, laid out as a data set: events, pictures, depth, flow, poses, lens")
          ->type_name("rpg|dsec|evimo2|eventnerf");
  const auto add = [&](const std::string& name, double& out, const std::string& help) {
    add_real(app, name, help, name == "--frame-exposure" ? "S" : "HZ", [&out](double value) { out = value; });
    app.get_option(name)->needs(layout);
  };
  add("--frame-rate", folder.frame_rate, "Pictures, and depth and flow with them, a second [20]");
  add("--frame-exposure", folder.exposure,
      "How long pictures are exposed, beside sharp ones; 0: sharp ones alone [0.01]");
  add("--pose-rate", folder.pose_rate, "Poses of the camera a second [200]");
  add_count(app, "--frame-samples", folder.samples, 1, 1 << 20, "Samples per pixel of pictures")->needs(layout);
  app.add_flag("--frame-exr", folder.exr, "An EXR of linear colours beside every picture")->needs(layout);
}

}  // namespace kairos::cli
