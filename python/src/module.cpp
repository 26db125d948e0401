// The module kairos._kairos: what the package's Python files stand on. Nobody else should import it.
#include <kairos/error.h>
#include <kairos/tracer.h>
#include <kairos/version.h>

#include "bindings.h"

namespace kairos::python {

namespace {

/// Of kairos/_errors.py.
const char* class_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::bad_input:
      return "InputError";
    case ErrorCode::bad_usage:
      return "UsageError";
    case ErrorCode::io:
      return "FileError";
    case ErrorCode::cancelled:
      return "Cancelled";
  }
  return "Error";
}

void translate(std::exception_ptr thrown) {
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const Error& e) {
    const py::object type = py::module_::import("kairos._errors").attr(class_of(e.code()));
    PyErr_SetString(type.ptr(), e.what());
  }
}

}  // namespace

}  // namespace kairos::python

PYBIND11_MODULE(_kairos, module) {
  namespace python = kairos::python;
  python::py::register_exception_translator(&python::translate);
  module.attr("version") = kairos::version();
  module.def("instruction_sets", [] {
    std::vector<std::string> names;
    for (const auto set : kairos::supported_instruction_sets()) names.emplace_back(kairos::to_string(set));
    return names;
  });
  python::bind_scene(module);
  python::bind_render(module);
  python::bind_tracer(module);
  python::bind_time(module);
  python::bind_flow(module);
  python::bind_events(module);
}
