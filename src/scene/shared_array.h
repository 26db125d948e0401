// Arrays that many meshes have in common.
#pragma once

#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

namespace kairos {

/// A vector that copies share until one of them is edited.
template <class T>
class SharedArray {
 public:
  using value_type = T;
  using const_iterator = typename std::vector<T>::const_iterator;
  using iterator = const_iterator;

  SharedArray() = default;
  SharedArray(std::vector<T> values)  // NOLINT(google-explicit-constructor): a vector is one
      : values_(values.empty() ? nullptr : std::make_shared<std::vector<T>>(std::move(values))) {}

  const std::vector<T>& get() const {
    static const std::vector<T> none;
    return values_ ? *values_ : none;
  }
  operator const std::vector<T>&() const { return get(); }  // NOLINT(google-explicit-constructor): likewise
  bool empty() const { return get().empty(); }
  size_t size() const { return get().size(); }
  const_iterator begin() const { return get().begin(); }
  const_iterator end() const { return get().end(); }
  const T& operator[](size_t index) const { return get()[index]; }
  const T& at(size_t index) const { return get().at(index); }
  const T& front() const { return get().front(); }

  /// One's own copy, if others share it.
  std::vector<T>& edit() {
    if (!values_ || values_.use_count() > 1) values_ = std::make_shared<std::vector<T>>(get());
    return *values_;
  }
  friend bool operator==(const SharedArray& a, const SharedArray& b) { return a.get() == b.get(); }
  /// The same for arrays that are shared.
  const void* identity() const { return values_.get(); }

 private:
  std::shared_ptr<std::vector<T>> values_;
};

}  // namespace kairos
