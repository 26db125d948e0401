#include "scene_io/json_text.h"

#include <utility>
#include <vector>

#include <fmt/format.h>

#include <kairos/error.h>

#include "scene_io/text_numbers.h"

namespace kairos {

using nlohmann::json;

namespace {

constexpr size_t kMaxDepth = 64;  // a native scene needs 5, glTF with its extensions some more

/// Leaves of it nothing that allocates when it is destroyed: arrays and objects are emptied from the innermost out.
void take_apart(json& value) noexcept {
  if (auto* items = value.get_ptr<json::array_t*>()) {
    for (json& item : *items) take_apart(item);
    items->clear();
  } else if (auto* fields = value.get_ptr<json::object_t*>()) {
    for (auto& [name, field] : *fields) take_apart(field);
    fields->clear();
  }
}

/// Told by the library's parser of one thing after the other. (Its own callback, which could limit the depth as well,
/// makes it look through all items of an array at the end of each.)
class Builder : public nlohmann::json_sax<json> {
 public:
  Builder(json& root, const std::string& file, JsonText::Repeated repeated)
      : root_(root), file_(file), repeated_(repeated) {}

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(number_integer_t value) override { return put(value); }
  bool number_unsigned(number_unsigned_t value) override { return put(value); }
  bool number_float(number_float_t value, const string_t&) override { return put(value); }
  bool string(string_t& value) override { return put(std::move(value)); }
  bool binary(binary_t&) override { return false; }  // is no part of JSON's text
  bool start_object(std::size_t) override { return open(json::value_t::object); }
  bool start_array(std::size_t) override { return open(json::value_t::array); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    auto& fields = open_.back()->get_ref<json::object_t&>();
    const auto [found, is_new] = fields.try_emplace(name);
    if (!is_new && repeated_ == JsonText::Repeated::refused)
      throw Error(ErrorCode::bad_input, file_, "has the field '" + printable(name) + "' twice in one object");
    if (!is_new) take_apart(found->second);
    field_ = &found->second;
    return true;
  }

  bool parse_error(std::size_t, const std::string&, const json::exception& error) override {
    // "[json.exception.name.number] parse error at line 3, column 7: ...": the first part helps nobody.
    const std::string_view what = error.what();
    const size_t end = what.find("] ");
    constexpr size_t kLongest = 300;
    throw Error(ErrorCode::bad_input, file_,
                "is not valid JSON: " + printable(end == what.npos ? what : what.substr(end + 2), kLongest));
  }

 private:
  template <class Value>
  bool put(Value&& value) {
    place() = std::forward<Value>(value);
    return true;
  }

  bool open(json::value_t kind) {
    if (open_.size() == kMaxDepth)
      throw Error(ErrorCode::bad_input, file_, fmt::format("nests JSON more than {} levels deep", kMaxDepth));
    json& value = place();
    value = kind;
    open_.push_back(&value);  // stays where it is: nothing is added to what holds it until it is closed
    return true;
  }

  bool close() {
    open_.pop_back();
    return true;
  }

  /// Where the next value goes.
  json& place() {
    if (open_.empty()) return root_;
    if (open_.back()->is_object()) return *field_;
    return open_.back()->get_ref<json::array_t&>().emplace_back();
  }

  json& root_;
  const std::string& file_;
  JsonText::Repeated repeated_;
  std::vector<json*> open_;
  json* field_ = nullptr;
};

}  // namespace

JsonText::JsonText(std::string_view text, const std::string& file, Repeated repeated) {
  Builder builder(root_, file, repeated);
  try {
    json::sax_parse(text.begin(), text.end(), &builder);
  } catch (...) {  // the destructor is not called for what was never whole
    take_apart(root_);
    throw;
  }
}

JsonText::~JsonText() { take_apart(root_); }

}  // namespace kairos
