#include "image.h"

namespace kairos::python {

namespace {

const char* name_of(Channel::Storage storage) {
  switch (storage) {
    case Channel::Storage::colour:
      return "colour";
    case Channel::Storage::exact:
      return "exact";
    case Channel::Storage::integer:
      return "integer";
  }
  return "";
}

Channel::Storage storage_of(const std::string& name) {
  return name == "exact"     ? Channel::Storage::exact
         : name == "integer" ? Channel::Storage::integer
                             : Channel::Storage::colour;
}

Attribute attribute_from(const std::string& name, py::handle value) {
  if (py::isinstance<py::str>(value)) return {name, value.cast<std::string>()};
  if (py::isinstance<py::int_>(value)) return {name, cast<int>("attribute '" + name + "'", value, "of 32 bits")};
  if (py::isinstance<py::float_>(value)) return {name, value.cast<double>()};
  if (py::isinstance<py::list>(value))
    return {name, cast<std::vector<std::string>>("attribute '" + name + "'", value, "a list of text")};
  std::array<double, 2> pair{};
  read("attribute '" + name + "'", value, pair);
  return {name, pair};
}

}  // namespace

py::dict image_to(Image image) {
  py::dict channels, storage, attributes;
  for (Channel& channel : image.channels) {
    const py::str name(channel.name);
    storage[name] = name_of(channel.storage);
    channels[name] = array_from(std::move(channel.values), {image.height, image.width});
  }
  for (const Attribute& attribute : image.attributes)
    attributes[py::str(attribute.name)] = std::visit(
        [](const auto& value) -> py::object {
          if constexpr (std::is_same_v<std::decay_t<decltype(value)>, std::array<double, 2>>)
            return to_python(value);
          else
            return py::cast(value);
        },
        attribute.value);
  py::dict out;
  out["channels"] = channels;
  out["storage"] = storage;
  out["attributes"] = attributes;
  out["left"] = image.left;
  out["top"] = image.top;
  out["frame_size"] = py::make_tuple(image.frame_width, image.frame_height);
  out["pixel_aspect"] = image.pixel_aspect;
  return out;
}

Image image_from(const py::dict& values) {
  Image image;
  std::array<int, 2> frame{};
  const py::dict channels = values["channels"], storage = values["storage"];
  Reader reader("Image", values);
  reader("left", image.left);
  reader("top", image.top);
  reader("frame_size", frame);
  reader("pixel_aspect", image.pixel_aspect);
  image.frame_width = frame[0];
  image.frame_height = frame[1];
  for (const auto& [key, value] : channels) {
    const auto name = cast<std::string>("Image", key, "text");
    const bool first = image.channels.empty();
    const auto array =
        array_of<float>("channel '" + name + "'", value,
                        first ? std::vector<py::ssize_t>{-1, -1} : std::vector<py::ssize_t>{image.height, image.width});
    image.height = static_cast<int>(array.shape(0));
    image.width = static_cast<int>(array.shape(1));
    const auto kept =
        storage.contains(key) ? storage_of(py::str(storage[key]).cast<std::string>()) : Channel::Storage::colour;
    image.channels.push_back({name, kept, {array.data(), array.data() + array.size()}});
  }
  for (const auto& [key, value] : py::dict(values["attributes"]))
    image.attributes.push_back(attribute_from(py::str(key).cast<std::string>(), value));
  return image;
}

}  // namespace kairos::python
