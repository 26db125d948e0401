// What rays see, and from when to when.
#include <algorithm>
#include <future>
#include <span>
#include <thread>

#include <kairos/cut_outs.h>
#include <kairos/tracer.h>

#include "bindings.h"
#include "shot.h"

namespace kairos::python {

namespace {

static_assert(sizeof(Ray) == 6 * sizeof(float) && sizeof(Segment) == 28 && sizeof(size_t) == sizeof(int64_t));

std::vector<Mesh> meshes_from(const py::iterable& meshes) {
  std::vector<Mesh> out;
  for (const py::handle given : meshes) {
    Mesh& mesh = out.emplace_back();
    read("name", given.attr("name"), mesh.name);
    const std::string place = "mesh '" + mesh.name + "', ";
    const auto corners = array_of<uint32_t>(place + "triangles", given.attr("triangles"), {-1, 3});
    mesh.triangles = rows_of<Triangle>(corners.data(), static_cast<size_t>(corners.shape(0)));
    const auto positions = array_of<float>(place + "positions", given.attr("positions"), {-1, -1, 3});
    const auto vertices = static_cast<size_t>(positions.shape(1));
    for (py::ssize_t k = 0; k < positions.shape(0); ++k)
      mesh.positions.push_back(rows_of<Vec3f>(positions.data(k, 0, 0), vertices));
    if (positions.shape(0) > 1) {
      const auto times = array_of<double>(place + "key_times", given.attr("key_times"), {positions.shape(0)});
      for (py::ssize_t k = 0; k < times.size(); ++k) mesh.key_times.push_back(static_cast<float>(times.at(k)));
    }
  }
  return out;
}

TracerOptions options_from(const py::dict& values, bool* cut_outs = nullptr) {
  TracerOptions options;
  bool fast = false;
  Reader reader("Tracer", values);
  reader("fast", fast);
  reader("instruction_set", options.instruction_set);
  reader("threads", options.threads);
  if (cut_outs != nullptr) reader("cut_outs", *cut_outs);
  reader.finish();
  if (fast) options.precision = Precision::fast;
  return options;
}

struct HeldTracer {
  Tracer tracer;
  int threads = 0;  ///< as for the tracer
};

std::shared_ptr<HeldTracer> tracer_of_meshes(const py::iterable& meshes, const py::dict& values) {
  const std::vector<Mesh> made = meshes_from(meshes);
  const TracerOptions options = options_from(values);
  const py::gil_scoped_release unlocked;
  return std::make_shared<HeldTracer>(HeldTracer{Tracer(made, options), options.threads});
}

std::shared_ptr<HeldTracer> tracer_of_shot(const std::shared_ptr<HeldShot>& held, const py::dict& values) {
  bool cut_outs = false;
  TracerOptions options = options_from(values, &cut_outs);
  const py::gil_scoped_release unlocked;
  if (cut_outs) {
    // They read the shot, and so keep it.
    const auto both = std::make_shared<std::pair<std::shared_ptr<HeldShot>, std::shared_ptr<const CutOuts>>>(
        held, cut_outs_of(held->shot()));
    options.cut_outs = {both, both->second.get()};
  }
  return std::make_shared<HeldTracer>(HeldTracer{Tracer(held->shot().meshes, options), options.threads});
}

/// What many rays were asked, each for itself: of ray i items[offsets[i]] to items[offsets[i + 1]].
template <class Item>
struct PerRay {
  std::vector<size_t> offsets;
  std::vector<Item> items;
};

/// ask(ray's number, workspace) gives a span of items. Rays are divided among threads; what comes out does not depend
/// on how.
template <class Item, class Ask>
std::unique_ptr<PerRay<Item>> ask_each(size_t rays, int threads, const Ask& ask) {
  constexpr size_t kLeastRays = 1024;  // of a thread
  const size_t machine = threads > 0 ? static_cast<size_t>(threads) : std::thread::hardware_concurrency();
  const size_t blocks = std::max<size_t>(1, std::min(machine, rays / kLeastRays));
  std::vector<PerRay<Item>> parts(blocks);
  const auto work = [&](size_t block) {
    Tracer::Workspace workspace;
    for (size_t ray = rays * block / blocks; ray < rays * (block + 1) / blocks; ++ray) {
      const std::span<const Item> found = ask(ray, workspace);
      parts[block].items.insert(parts[block].items.end(), found.begin(), found.end());
      parts[block].offsets.push_back(parts[block].items.size());
    }
  };
  std::vector<std::future<void>> others;
  for (size_t block = 1; block < blocks; ++block) others.push_back(std::async(std::launch::async, work, block));
  work(0);
  for (std::future<void>& other : others) other.get();
  auto all = std::make_unique<PerRay<Item>>();
  all->offsets.push_back(0);
  for (const PerRay<Item>& part : parts) {
    const size_t before = all->items.size();
    all->items.insert(all->items.end(), part.items.begin(), part.items.end());
    for (const size_t offset : part.offsets) all->offsets.push_back(before + offset);
  }
  return all;
}

/// When each ray looks: one window for all, or (N, 2).
class Windows {
 public:
  Windows(py::handle window, float max_dist, size_t rays) : max_dist_(max_dist) {
    if (py::isinstance<py::tuple>(window)) {
      read("window", window, both_);
      return;
    }
    each_ = array_of<float>("window", window, {static_cast<py::ssize_t>(rays), 2});
    for (size_t i = 0; i < rays; ++i)
      if (!(each_.data()[2 * i] >= 0 && each_.data()[2 * i] < each_.data()[2 * i + 1] && each_.data()[2 * i + 1] <= 1))
        refuse("window", "of ray " + std::to_string(i) + " is not 0 <= begin < end <= 1");
  }
  bool same_for_all() const { return each_.size() == 0; }
  TraceLimits of(size_t ray) const {
    if (same_for_all()) return {both_[0], both_[1], max_dist_};
    return {each_.data()[2 * ray], each_.data()[2 * ray + 1], max_dist_};
  }

 private:
  float max_dist_;
  std::array<float, 2> both_{0, 1};
  py::array_t<float> each_;
};

/// The segments as an array of this, whose memory is the library's own.
py::dtype segment_type() {
  const py::list names =
      py::cast(std::vector<std::string>{"begin", "end", "dist_begin", "dist_end", "mesh", "triangle", "front"});
  const py::list formats = py::cast(std::vector<std::string>{"f4", "f4", "f4", "f4", "u4", "u4", "?"});
  const py::list offsets = py::cast(std::vector<size_t>{
      offsetof(Segment, begin), offsetof(Segment, end), offsetof(Segment, dist_begin), offsetof(Segment, dist_end),
      offsetof(Segment, mesh), offsetof(Segment, triangle), offsetof(Segment, front)});
  return {names, formats, offsets, sizeof(Segment)};
}

/// The arrays of a batch, whose memory is the batch's. offsets: what is below 2^63 has the same bits with and without a
/// sign.
template <class Batch, class Item>
py::tuple arrays_of(std::unique_ptr<Batch> batch, std::vector<Item>& items, const py::dtype& type) {
  Item* const first = items.data();
  const size_t count = items.size();
  auto* offsets = reinterpret_cast<int64_t*>(batch->offsets.data());
  const size_t ends = batch->offsets.size();
  const py::capsule owner = keeper(std::move(batch));
  return py::make_tuple(py::array(type, {count}, {sizeof(Item)}, first, owner),
                        py::array_t<int64_t>({ends}, {sizeof(int64_t)}, offsets, owner));
}

py::tuple query(const HeldTracer& held, py::handle rays, bool all, py::handle window, float max_dist) {
  const auto array = array_of<float>("rays", rays, {-1, 6});
  const std::span<const Ray> each(reinterpret_cast<const Ray*>(array.data()), static_cast<size_t>(array.shape(0)));
  const Windows windows(window, max_dist, each.size());
  const Visibility visibility = all ? Visibility::all : Visibility::visible;
  if (windows.same_for_all()) {
    auto batch = std::make_unique<SegmentBatch>();
    {
      const py::gil_scoped_release unlocked;
      *batch = held.tracer.trace(each, visibility, nullptr, windows.of(0));
    }
    std::vector<Segment>& segments = batch->segments;
    return arrays_of(std::move(batch), segments, segment_type());
  }
  std::unique_ptr<PerRay<Segment>> batch;
  {
    const py::gil_scoped_release unlocked;
    batch = ask_each<Segment>(each.size(), held.threads, [&](size_t ray, Tracer::Workspace& workspace) {
      return held.tracer.trace(each[ray], visibility, workspace, windows.of(ray));
    });
  }
  std::vector<Segment>& segments = batch->items;
  return arrays_of(std::move(batch), segments, segment_type());
}

py::tuple occluded(const HeldTracer& held, py::handle rays, py::handle window, float max_dist) {
  const auto array = array_of<float>("rays", rays, {-1, 6});
  const std::span<const Ray> each(reinterpret_cast<const Ray*>(array.data()), static_cast<size_t>(array.shape(0)));
  const Windows windows(window, max_dist, each.size());
  std::unique_ptr<PerRay<TimeRange>> batch;
  {
    const py::gil_scoped_release unlocked;
    batch = ask_each<TimeRange>(each.size(), held.threads, [&](size_t ray, Tracer::Workspace& workspace) {
      return held.tracer.occluded(each[ray], workspace, windows.of(ray));
    });
  }
  std::vector<TimeRange>& ranges = batch->items;
  const py::list names = py::cast(std::vector<std::string>{"begin", "end"});
  const py::list formats = py::cast(std::vector<std::string>{"f4", "f4"});
  const py::list offsets = py::cast(std::vector<size_t>{offsetof(TimeRange, begin), offsetof(TimeRange, end)});
  return arrays_of(std::move(batch), ranges, py::dtype(names, formats, offsets, sizeof(TimeRange)));
}

}  // namespace

void bind_tracer(py::module_& module) {
  py::class_<HeldTracer, std::shared_ptr<HeldTracer>>(module, "Tracer")
      .def(py::init(&tracer_of_meshes))
      .def(py::init(&tracer_of_shot))
      .def("query", &query)
      .def("occluded", &occluded)
      .def_property_readonly(
          "instruction_set",
          [](const HeldTracer& held) { return std::string(to_string(held.tracer.instruction_set())); })
      .def_property_readonly("memory_bytes", [](const HeldTracer& held) { return held.tracer.memory_bytes(); });
  module.attr("segment_type") = segment_type();
}

}  // namespace kairos::python
