// Lists of what a pixel's rays see, along which shading samples lie evenly.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include <kairos/tracer.h>

#include "shading/exact_mirrors.h"

namespace kairos {

/// Segments laid end to end, sorted by mesh, triangle and time, each as long as it is seen, times its weight. A mesh
/// that is seen for at least a sample's worth has a list of its own, so that no stretch of it begins on one surface and
/// ends on another; what is seen of the others is in one list. Of a mesh that rests each ray sees one point: its list
/// goes ray by ray, and has as many samples for each of them. Each list is cut into equal stretches, with a sample in
/// each. One thread's memory.
class SampleLists {
 public:
  /// What is never in one list with others: in order.
  enum Kind {
    plain,
    with_shadows,  ///< on which shadows are exact
    mirrors,       ///< that are exact: what they show is left out
    in_mirrors,    ///< what these show
  };

  struct Entry {
    const Segment* segment;
    Kind kind;
    uint32_t ray;                      ///< by which it is seen straight
    const MirrorSights::Sight* sight;  ///< by way of which it is seen; null: straight
    double weight;
    bool rests;           ///< the mesh: each ray sees one point of it
    uint32_t number = 0;  ///< in order of adding
    double before = 0;    ///< what lies before it in its list
  };

  void clear() { entries_.clear(); }
  void add(const Segment& segment, Kind kind, uint32_t ray, const MirrorSights::Sight* sight, float weight,
           bool rests) {
    entries_.push_back(
        {&segment, kind, ray, sight, static_cast<double>(weight), rests, static_cast<uint32_t>(entries_.size())});
  }

  /// rate: samples of a segment that is seen all the time with a weight of 1. Each list has at least one.
  void lay(double rate) {
    std::sort(entries_.begin(), entries_.end(), [](const Entry& a, const Entry& b) {
      const Segment &p = *a.segment, &q = *b.segment;
      if (a.kind != b.kind) return a.kind < b.kind;
      if (p.mesh != q.mesh) return p.mesh < q.mesh;
      if (a.rests) return a.number < b.number;
      if (p.triangle != q.triangle) return p.triangle < q.triangle;
      if (p.begin != q.begin) return p.begin < q.begin;
      return a.number < b.number;
    });
    lists_.clear();
    places_.resize(entries_.size());
    before_mirrors_ = count_ = 0;
    for (size_t begin = 0, end = 0; begin < entries_.size(); begin = end) {
      const Kind kind = entries_[begin].kind;
      while (end < entries_.size() && entries_[end].kind == kind) ++end;
      lay_kind(begin, end, rate);
      if (kind < mirrors) before_mirrors_ = count_;
    }
  }

  uint32_t size() const { return static_cast<uint32_t>(entries_.size()); }  ///< segments
  uint32_t count() const { return count_; }                                 ///< of samples
  uint32_t before_mirrors() const { return before_mirrors_; }               ///< of these, the first that are straight

  /// Calls use(entry, time) for each sample, in order: anywhere in its stretch with the same probability. phases: how
  /// far, evenly spread, for the first samples of a list, the next, and so on.
  template <class Use>
  void visit_samples(std::span<const float> phases, const Use& use) const {
    for (const List& list : lists_) {
      size_t at = list.begin;
      for (uint32_t i = 0; i < list.samples; ++i) {
        const auto phase = static_cast<double>(phases[static_cast<size_t>(i) * phases.size() / list.samples]);
        const double place = list.total * ((i + phase) / list.samples);
        while (at + 1 < list.end && entries_[at + 1].before <= place) ++at;
        const Entry& entry = entries_[at];
        const Segment& segment = *entry.segment;
        // Half-open: at its very end something else is seen.
        const float latest = std::max(segment.begin, std::nextafter(segment.end, 0.0f));
        const auto time = segment.begin + static_cast<float>((place - entry.before) / entry.weight);
        use(entry, std::clamp(time, segment.begin, latest));
      }
    }
  }

  /// Calls use(begin, end, sample) for the stretches of the segment that was added as number so and so.
  template <class Use>
  void visit_stretches(uint32_t number, const Use& use) const {
    const Place& place = places_[number];
    const List& list = lists_[place.list];
    const Entry& entry = entries_[place.entry];
    const Segment& segment = *entry.segment;
    const double per_sample = list.total / list.samples;
    auto sample = static_cast<uint32_t>(std::min(entry.before / per_sample, static_cast<double>(list.samples - 1)));
    for (float begin = segment.begin; begin < segment.end; ++sample) {
      const double cut = static_cast<double>(segment.begin) + ((sample + 1) * per_sample - entry.before) / entry.weight;
      const float end = sample + 1 == list.samples ? segment.end : std::min(segment.end, static_cast<float>(cut));
      if (!(begin < end)) continue;
      use(begin, end, list.first_sample + sample);
      begin = end;
    }
  }

 private:
  struct List {
    size_t begin, end;  // of its entries
    double total;
    uint32_t first_sample, samples;
  };
  struct Place {
    uint32_t list, entry;
  };

  static double length(const Entry& entry) {
    return (static_cast<double>(entry.segment->end) - static_cast<double>(entry.segment->begin)) * entry.weight;
  }

  void lay_kind(size_t begin, size_t end, double rate) {
    others_.clear();
    size_t kept = begin;
    for (size_t from = begin, to = begin; from < end; from = to) {
      double total = 0;
      for (; to < end && entries_[to].segment->mesh == entries_[from].segment->mesh; ++to)
        total += length(entries_[to]);
      if (total * rate < 1) {
        others_.insert(others_.end(), entries_.begin() + from, entries_.begin() + to);
        continue;
      }
      std::move(entries_.begin() + from, entries_.begin() + to, entries_.begin() + kept);
      lay_list(kept, kept + (to - from), rate);
      kept += to - from;
    }
    std::copy(others_.begin(), others_.end(), entries_.begin() + kept);
    if (kept < end) lay_list(kept, end, rate);
  }

  double count_rays(size_t begin, size_t end) const {
    double rays = 1;
    for (size_t i = begin + 1; i < end; ++i)
      rays += entries_[i].ray != entries_[i - 1].ray || entries_[i].sight != entries_[i - 1].sight;
    return rays;
  }

  void lay_list(size_t begin, size_t end, double rate) {
    double total = 0;
    for (size_t i = begin; i < end; ++i) {
      entries_[i].before = total;
      total += length(entries_[i]);
      places_[entries_[i].number] = {static_cast<uint32_t>(lists_.size()), static_cast<uint32_t>(i)};
    }
    // As many for each ray, if there is one: their instants are then as evenly spread as phases are.
    const double rays = entries_[begin].rests ? count_rays(begin, end) : 1;
    const double wanted = rate * total, all = std::round(wanted / rays) * rays;
    const auto samples = static_cast<uint32_t>(std::max(1.0, all > 0 ? all : std::round(wanted)));
    lists_.push_back({begin, end, total, count_, samples});
    count_ += samples;
  }

  std::vector<Entry> entries_, others_;
  std::vector<List> lists_;
  std::vector<Place> places_;  // [number of an entry]
  uint32_t count_ = 0, before_mirrors_ = 0;
};

}  // namespace kairos
