#include "events/pixel_intensity.h"

#include <algorithm>
#include <cmath>

namespace kairos {

namespace {

/// A jump of a ray by less than this part of its light, as interior edges of smooth surfaces make, is no outline: it
/// stays a step, of a hundredth of a threshold or so.
constexpr double kLeastJump = 1e-3;
/// Triangles of a mesh whose distances differ by less than this part where a ray goes from one to the other meet there.
constexpr float kSameDist = 1e-3f;
/// Cuts closer to each other, in seconds, are one: a hundredth of what a stamp resolves.
constexpr double kSameTime = 1e-11;

/// The colour of a part at a shutter time.
Vec3f colour_at(std::span<const Knot> knots, float time) {
  if (time <= knots.front().time) return knots.front().colour;
  if (time >= knots.back().time) return knots.back().colour;
  const auto after = std::upper_bound(knots.begin(), knots.end(), time,
                                      [](float value, const Knot& knot) { return value < knot.time; });
  const Knot &from = after[-1], &to = *after;
  return from.colour + (to.colour - from.colour) * ((time - from.time) / (to.time - from.time));
}

}  // namespace

PixelIntensity::Ramp::Ramp(double when, double height, double own_rate, double begins_at, double reach,
                           const Coverage& of, size_t by)
    : time(when), jump(height), rate(own_rate), start(begins_at), near(reach / 2), coverage(of), turn(by) {
  const double side = rate * near;  // what is left of its way, in the other half of the reach
  rate_before = std::max(rate, (coverage.outer() + start - side) / (reach - near));
  rate_after = std::max(rate, (coverage.outer() - start - side) / (reach - near));
  begin = this->when(-coverage.outer());
  end = this->when(coverage.outer());
}

double PixelIntensity::Ramp::when(double at_way) const {
  const double past = at_way - start, side = rate * near;
  if (std::abs(past) <= side) return time + past / rate;
  return past < 0 ? time - near + (past + side) / rate_before : time + near + (past - side) / rate_after;
}

double PixelIntensity::light(const Vec3f& colour) const {
  const Vec3f parts = colour * channels_;
  const double sum = static_cast<double>(parts.x) + static_cast<double>(parts.y) + static_cast<double>(parts.z);
  return std::isfinite(sum) ? std::max(sum, 0.0) : 0;
}

std::span<const LightPiece> PixelIntensity::make(const PixelRecord& record, const Vec3f& channels) {
  record_ = &record;
  channels_ = channels;
  share_ = record.rays.empty() ? 0 : 1 / static_cast<double>(record.rays.size());
  lines_.clear();
  ray_ends_.clear();
  ramps_.clear();
  sights_.clear();
  turns_.clear();
  for (const PixelRay& ray : record.rays) add_ray(ray);
  cut();
  return pieces_;
}

/// Lines for what one part shows, or several on top of each other, from shutter time `begin` to `end`.
void PixelIntensity::add_parts(std::span<const SeenPart> layers, double begin, double end) {
  if (layers.size() == 1 && layers[0].opacity == 1) {
    const std::span<const Knot> knots = record_->knots_of(layers[0]);
    double time = begin, before = light(knots[0].colour);
    for (const Knot& knot : knots.subspan(1)) {
      const double next = std::clamp(static_cast<double>(knot.time), time, end), after = light(knot.colour);
      if (time < next) add_line(time, next, before, after);
      time = next;
      before = after;
    }
    if (time < end) add_line(time, end, before, before);
    return;
  }
  const auto at = [&](float time) {
    double sum = 0, open = 1;
    bool sky = false;
    for (const SeenPart& layer : layers) {
      const auto opacity = static_cast<double>(layer.opacity);
      sum += open * opacity * light(colour_at(record_->knots_of(layer), time));
      open *= 1 - opacity;
      sky = sky || layer.where.mesh == kNoMesh;
    }
    return sum + (sky ? 0 : open * light(record_->background));
  };
  knot_times_.assign({begin, end});
  for (const SeenPart& layer : layers)
    for (const Knot& knot : record_->knots_of(layer))
      knot_times_.push_back(std::clamp(static_cast<double>(knot.time), begin, end));
  std::sort(knot_times_.begin(), knot_times_.end());
  double before = at(static_cast<float>(begin));
  for (size_t i = 1; i < knot_times_.size(); ++i) {
    const double after = at(static_cast<float>(knot_times_[i]));
    if (knot_times_[i - 1] < knot_times_[i]) add_line(knot_times_[i - 1], knot_times_[i], before, after);
    before = after;
  }
}

void PixelIntensity::add_ray(const PixelRay& ray) {
  const std::span<const SeenPart> parts = record_->parts_of(ray);
  const double open = record_->window.begin, close = record_->window.end;
  const size_t first_sight = sights_.size();
  const Vec2d film{record_->x + static_cast<double>(ray.film.x), record_->y + static_cast<double>(ray.film.y)};
  double until = open;
  const auto add_background = [&](double end) {
    if (!(until < end)) return;
    Segment nothing;
    nothing.mesh = kNoMesh;
    sights_.push_back({nothing, lines_.size(), 1, film});
    const double background = light(record_->background);
    add_line(until, end, background, background);
  };
  for (size_t first = 0, next = 0; first < parts.size(); first = next) {
    for (next = first + 1; next < parts.size() && parts[next].layer > 0;) ++next;
    const Segment& where = parts[first].where;
    const double begin = std::max(static_cast<double>(where.begin), until), end = where.end;
    if (!(begin < end)) continue;
    add_background(begin);
    const size_t first_line = lines_.size();
    add_parts(parts.subspan(first, next - first), begin, end);
    sights_.push_back({where, first_line, lines_.size() - first_line, film});
    until = end;
  }
  add_background(close);
  for (size_t i = first_sight + 1; i < sights_.size(); ++i) join(ray, i);
  ray_ends_.push_back(lines_.size());
}

/// Where a ray sees something else: the exact time, and a ramp in place of the jump.
void PixelIntensity::join(const PixelRay& ray, size_t sight) {
  const Sight &before = sights_[sight - 1], &after = sights_[sight];
  if (before.where.mesh == after.where.mesh && before.where.triangle == after.where.triangle) return;
  Line &last = lines_[before.first_line + before.lines - 1], &first = lines_[after.first_line];
  const double jump = first.first - last.last;
  if (!(std::abs(jump) > kLeastJump * (std::max(first.first, last.last) + dark_))) return;
  const auto edge =
      edges_.find(after.film.x, after.film.y, clock_.shutter_time(first.begin), before.where, after.where);
  const bool outlines = before.where.mesh != after.where.mesh ||
                        std::abs(after.where.dist_begin - before.where.dist_end) > kSameDist * before.where.dist_end;
  turns_.push_back({first.begin, share_ * jump, sight, EdgeFinder::arrives(before.where, after.where), outlines});
  const double time = edge ? clock_.seconds(edge->time) : 0;
  if (!edge || !(last.begin < time && time < first.end)) {
    ++counts_.steps;
    return;
  }
  last.end = first.begin = turns_.back().time = time;
  ++counts_.edges;
  const double speed = edge->speed / (clock_.close - clock_.open);
  counts_.fastest = std::max(counts_.fastest, speed);
  if (model_ == EdgeModel::step) return;
  const double rate = speed * cells_;
  const auto past_middle = [&](float film) {
    const double place = static_cast<double>(film) * cells_;
    return place - (std::floor(place) + 0.5);
  };
  const double start = edge->normal.x * past_middle(ray.film.x) + edge->normal.y * past_middle(ray.film.y);
  const Coverage coverage(edge->normal.x, edge->normal.y);
  ramps_.emplace_back(time, share_ * jump, rate, start, clock_.reach, coverage, turns_.size() - 1);
}

/// The sum over rays and ramps. within: an instant of the piece that `time` belongs to; cursors_ and active_ fit it.
double PixelIntensity::value(double time, double within) const {
  double sum = 0;
  for (const size_t line : cursors_) sum += share_ * lines_[line].at(time);
  for (const size_t ramp : active_) sum += ramps_[ramp].at(time, within > ramps_[ramp].time);
  return sum;
}

void PixelIntensity::cut() {
  cuts_.assign({clock_.begin, clock_.end});
  const auto add_cut = [&](double time) {
    if (clock_.begin < time && time < clock_.end) cuts_.push_back(time);
  };
  cursors_.clear();
  size_t line = 0;
  for (const size_t end : ray_ends_) {
    cursors_.push_back(line);
    for (; line < end; ++line) add_cut(lines_[line].end);
  }
  std::sort(ramps_.begin(), ramps_.end(), [](const Ramp& a, const Ramp& b) { return a.begin < b.begin; });
  for (const Ramp& ramp : ramps_) {
    if (ramp.end <= clock_.begin || ramp.begin >= clock_.end) continue;
    add_cut(ramp.time);
    add_cut(ramp.begin);
    add_cut(ramp.end);
    for (const double time : {ramp.when(-ramp.coverage.inner()), ramp.when(ramp.coverage.inner()),
                              ramp.time - ramp.near, ramp.time + ramp.near})
      if (ramp.begin < time && time < ramp.end) add_cut(time);
  }
  std::sort(cuts_.begin(), cuts_.end());
  pieces_.clear();
  active_.clear();
  size_t next_ramp = 0;
  double begin = cuts_[0];
  for (const double end : std::span(cuts_).subspan(1)) {
    if (end - begin < kSameTime && end < clock_.end) continue;
    if (!(begin < end)) continue;
    const double middle = 0.5 * (begin + end);
    for (size_t ray = 0; ray < cursors_.size(); ++ray)
      while (cursors_[ray] + 1 < ray_ends_[ray] && lines_[cursors_[ray]].end <= middle) ++cursors_[ray];
    for (; next_ramp < ramps_.size() && ramps_[next_ramp].begin < middle; ++next_ramp) active_.push_back(next_ramp);
    std::erase_if(active_, [&](size_t ramp) { return ramps_[ramp].end <= middle; });
    pieces_.push_back({begin, end, std::max(value(begin, middle), 0.0), std::max(value(middle, middle), 0.0),
                       std::max(value(end, middle), 0.0)});
    begin = end;
  }
}

}  // namespace kairos
