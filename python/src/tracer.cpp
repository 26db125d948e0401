// What rays see, and from when to when.
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

TracerOptions options_from(const py::dict& values) {
  TracerOptions options;
  bool fast = false;
  Reader reader("Tracer", values);
  reader("fast", fast);
  reader("instruction_set", options.instruction_set);
  reader("threads", options.threads);
  reader.finish();
  if (fast) options.precision = Precision::fast;
  return options;
}

std::shared_ptr<Tracer> tracer_of_meshes(const py::iterable& meshes, const py::dict& values) {
  const std::vector<Mesh> made = meshes_from(meshes);
  const TracerOptions options = options_from(values);
  const py::gil_scoped_release unlocked;
  return std::make_shared<Tracer>(made, options);
}

std::shared_ptr<Tracer> tracer_of_shot(const HeldShot& held, const py::dict& values) {
  const TracerOptions options = options_from(values);
  const py::gil_scoped_release unlocked;
  return std::make_shared<Tracer>(held.shot().meshes, options);
}

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

py::tuple query(const Tracer& tracer, py::handle rays, bool all, std::array<float, 2> window, float max_dist) {
  const auto array = array_of<float>("rays", rays, {-1, 6});
  const auto* first = reinterpret_cast<const Ray*>(array.data());
  const TraceLimits limits{window[0], window[1], max_dist};
  auto batch = std::make_unique<SegmentBatch>();
  {
    const py::gil_scoped_release unlocked;
    *batch = tracer.trace({first, static_cast<size_t>(array.shape(0))}, all ? Visibility::all : Visibility::visible,
                          nullptr, limits);
  }
  Segment* segments = batch->segments.data();
  const size_t count = batch->segments.size();
  // offsets: what is below 2^63 has the same bits with and without a sign.
  auto* offsets = reinterpret_cast<int64_t*>(batch->offsets.data());
  const size_t ends = batch->offsets.size();
  const py::capsule owner = keeper(std::move(batch));
  return py::make_tuple(py::array(segment_type(), {count}, {sizeof(Segment)}, segments, owner),
                        py::array_t<int64_t>({ends}, {sizeof(int64_t)}, offsets, owner));
}

}  // namespace

void bind_tracer(py::module_& module) {
  py::class_<Tracer, std::shared_ptr<Tracer>>(module, "Tracer")
      .def(py::init(&tracer_of_meshes))
      .def(py::init(&tracer_of_shot))
      .def("query", &query)
      .def_property_readonly("instruction_set",
                             [](const Tracer& tracer) { return std::string(to_string(tracer.instruction_set())); })
      .def_property_readonly("memory_bytes", &Tracer::memory_bytes);
  module.attr("segment_type") = segment_type();
}

}  // namespace kairos::python
