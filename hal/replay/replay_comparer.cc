#include "hal/replay/replay_comparer.h"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <type_traits>
#include <vector>

#include "core/base/assert.h"
#include "core/base/fields.h"

namespace surefoot::hal {
namespace {

struct NamedValue {
  std::string path;
  std::string text;
  std::uint64_t bits = 0;
};

std::string hex(std::uint64_t bits) {
  char text[32];
  std::snprintf(text, sizeof(text), "0x%016" PRIx64, bits);
  return text;
}

std::string float_text(double value, std::uint64_t bits) {
  char text[64];
  std::snprintf(text, sizeof(text), "%.17g", value);
  return std::string(text) + " (" + hex(bits) + ")";
}

template <class T>
std::string value_text(T value) {
  if constexpr (std::is_floating_point_v<T>) {
    return float_text(static_cast<double>(value), scalar_bits(value));
  } else if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::is_enum_v<T>) {
    return std::to_string(static_cast<std::underlying_type_t<T>>(value));
  } else {
    return std::to_string(value);
  }
}

// Lists every scalar of a struct with its path.
class ListingVisitor : public FieldVisitor<ListingVisitor> {
 public:
  explicit ListingVisitor(const char* root) : path_(root) {}

  template <class T>
  void scalar(const char* name, const T& value) {
    values.push_back({scalar_path(name), value_text(value), scalar_bits(value)});
  }
  void enter(const char* name) { push("." + std::string(name)); }
  void leave() { pop(); }
  void enter_index(std::size_t index) { push("[" + std::to_string(index) + "]"); }
  void leave_index() { pop(); }

  std::vector<NamedValue> values;

 private:
  void push(const std::string& part) {
    lengths_.push_back(path_.size());
    path_ += part;
    last_name_.clear();
  }
  void pop() {
    path_.resize(lengths_.back());
    lengths_.pop_back();
    last_name_.clear();
  }
  // A member visited several times in a row (the bytes of a CAN frame) gets an index from the
  // second.
  std::string scalar_path(const std::string& name) {
    if (name.empty()) return path_;
    repeats_ = name == last_name_ ? repeats_ + 1 : 0;
    last_name_ = name;
    const std::string path = path_ + "." + name;
    return repeats_ == 0 ? path : path + "[" + std::to_string(repeats_) + "]";
  }

  std::string path_;
  std::vector<std::size_t> lengths_;
  std::string last_name_;
  std::size_t repeats_ = 0;
};

template <class T>
std::vector<NamedValue> list_of(const char* root, const T& value) {
  ListingVisitor visitor(root);
  visitor.members(value);
  return visitor.values;
}

// true: found one.
template <class T>
bool find_difference(const char* root, const T& recorded, const T& replayed,
                     ReplayDifference& out) {
  const auto before = list_of(root, recorded);
  const auto now = list_of(root, replayed);
  const std::size_t count = std::min(before.size(), now.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (before[i].path == now[i].path && before[i].bits == now[i].bits) continue;
    out.field = before[i].path;
    out.recorded = before[i].text;
    out.replayed = now[i].text;
    return true;
  }
  return false;
}

template <class T>
std::span<const std::uint8_t> encode(const autonomy::TickInputs& inputs, const T& outputs,
                                     std::span<std::uint8_t> buffer) {
  FieldWriter writer(buffer);
  writer.members(inputs);
  writer.members(outputs);
  SUREFOOT_ASSERT(ok(writer.status()));
  return buffer.first(writer.size());
}

}  // namespace

bool ReplayComparer::compare(const autonomy::TickInputs& inputs,
                             const autonomy::TickOutputs& outputs, std::uint64_t hash,
                             const runtime::TickRecord& recorded) {
  ++ticks_;
  const auto before = encode(recorded.inputs, recorded.outputs, recorded_);
  const auto now = encode(inputs, outputs, replayed_);
  if (hash == recorded.hash && std::equal(before.begin(), before.end(), now.begin(), now.end())) {
    return true;
  }
  if (different_) return false;
  different_ = true;
  difference_.tick = recorded.inputs.tick;
  if (find_difference("inputs", recorded.inputs, inputs, difference_)) return false;
  if (find_difference("outputs", recorded.outputs, outputs, difference_)) return false;
  difference_.field = "hash";
  difference_.recorded = hex(recorded.hash);
  difference_.replayed = hex(hash);
  return false;
}

}  // namespace surefoot::hal
