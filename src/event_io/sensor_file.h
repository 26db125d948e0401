// A sensor's parameters as JSON, as they stand beside each recording.
#pragma once

#include <nlohmann/json.hpp>

#include <kairos/events.h>

namespace kairos {

nlohmann::ordered_json sensor_json(const EventSensor& sensor);

}  // namespace kairos
