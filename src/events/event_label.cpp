// What made a pixel fire: docs/events.md, "Labels".
#include <algorithm>
#include <cmath>

#include "events/pixel_intensity.h"

namespace kairos {

namespace {

/// Before a piece begins, in seconds: of jumps at its very begin this much lies in it.
constexpr double kMoment = 1e-10;

uint32_t number_of(const Segment& seen) { return seen.mesh == kNoMesh ? 0 : seen.mesh + 1; }

}  // namespace

void PixelIntensity::add_cause(size_t front, uint32_t behind, bool edge, double change) {
  const uint32_t surface = number_of(sights_[front].where);
  auto cause = std::find_if(causes_.begin(), causes_.end(), [&](const Cause& one) {
    return one.label.surface == surface && one.label.behind == behind && one.label.edge == edge;
  });
  if (cause == causes_.end()) {
    EventLabel label;
    label.surface = surface;
    label.behind = behind;
    label.edge = edge;
    causes_.push_back({label, 0, -1, front});
    cause = causes_.end() - 1;
  }
  cause->change += change;
  if (std::abs(change) > cause->most) {
    cause->most = std::abs(change);
    cause->sight = front;
  }
}

EventLabel PixelIntensity::label(size_t piece, double time, int polarity) {
  const auto begin_of = [&](const Sight& sight) { return lines_[sight.first_line].begin; };
  const auto end_of = [&](const Sight& sight) { return lines_[sight.first_line + sight.lines - 1].end; };
  const Cause* chosen = nullptr;
  for (size_t at = piece + 1; polarity != 0 && at-- > 0 && chosen == nullptr;) {
    const double begin = pieces_[at].begin - kMoment, end = pieces_[at].end;
    causes_.clear();
    const auto add_turn = [&](const Turn& turn, double change) {
      if (change == 0) return;
      const size_t front = turn.arrives ? turn.sight : turn.sight - 1,
                   back = turn.arrives ? turn.sight - 1 : turn.sight;
      add_cause(front, number_of(sights_[back].where), turn.outlines, change);
    };
    is_ramp_.assign(turns_.size(), 0);
    for (const Ramp& ramp : ramps_) {
      is_ramp_[ramp.turn] = 1;
      add_turn(turns_[ramp.turn], ramp.done(end) - ramp.done(begin));
    }
    for (size_t turn = 0; turn < turns_.size(); ++turn)
      if (is_ramp_[turn] == 0 && begin < turns_[turn].time && turns_[turn].time < end)
        add_turn(turns_[turn], turns_[turn].jump);
    for (size_t i = 0; i < sights_.size(); ++i) {
      const Sight& sight = sights_[i];
      if (end_of(sight) <= begin || begin_of(sight) >= end) continue;
      // From the first instant of it to the last, with jumps between its lines.
      const auto value = [&](double when, bool after) {
        const auto first = lines_.begin() + static_cast<std::ptrdiff_t>(sight.first_line),
                   last = first + static_cast<std::ptrdiff_t>(sight.lines - 1);
        auto line = first;
        while (line != last && (after ? line->end <= when : line->end < when)) ++line;
        return line->at(std::clamp(when, line->begin, line->end));
      };
      const double change = share_ * (value(end, false) - value(begin, true));
      if (change != 0) add_cause(i, number_of(sight.where), false, change);
    }
    for (const Cause& cause : causes_)
      if (polarity * cause.change > 0 && (chosen == nullptr || polarity * (cause.change - chosen->change) > 0))
        chosen = &cause;
  }
  EventLabel label;
  size_t seen = 0;
  if (chosen != nullptr) {
    label = chosen->label;
    seen = chosen->sight;
  } else {
    while (seen + 1 < sights_.size() && end_of(sights_[seen]) <= time) ++seen;
    label.surface = label.behind = number_of(sights_[seen].where);
  }
  const Sight& sight = sights_[seen];
  if (sight.where.mesh == kNoMesh) return label;
  const double shutter_time = clock_.shutter_time(std::clamp(time, begin_of(sight), end_of(sight)));
  const SurfacePoint point = edges_.point(sight.film.x, sight.film.y, shutter_time, sight.where);
  label.depth = static_cast<float>(point.depth);
  const double length = clock_.close - clock_.open;
  label.flow = {static_cast<float>(point.flow.x / length), static_cast<float>(point.flow.y / length)};
  return label;
}

}  // namespace kairos
