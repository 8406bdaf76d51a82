// One description of a struct serves recording, replay, comparison and hashing.
//
// A struct lists its members once:
//
//   struct ImuSample {
//     TimeNs stamp;
//     std::array<double, 3> angular_velocity_I_rad_s;
//     template <class Self, class Visitor>
//     static void fields(Self& self, Visitor& visit) {
//       visit("stamp_ns", self.stamp);
//       visit("angular_velocity_I_rad_s", self.angular_velocity_I_rad_s);
//     }
//   };
//
// A visitor derives from FieldVisitor<Derived> and defines
//   template <class T> void scalar(const char* name, T& value);   // arithmetic, bool, enum
// and may define list_size(), enter() and leave(). Canonical form: little-endian, in the order
// listed, floats as their IEEE bits; a FixedVector is its size (32 bits) and its items.
#pragma once

#include <array>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <type_traits>

#include "core/base/fixed_vector.h"
#include "core/base/hash.h"
#include "core/base/status.h"
#include "core/base/time.h"

namespace surefoot {

template <class T>
concept ScalarField =
    std::is_arithmetic_v<std::remove_cv_t<T>> || std::is_enum_v<std::remove_cv_t<T>>;

// The integer that holds a scalar's bits.
template <ScalarField T>
constexpr std::uint64_t scalar_bits(T value) {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<std::uint64_t>(value);
  } else if constexpr (std::is_same_v<T, float>) {
    return std::bit_cast<std::uint32_t>(value);
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<std::uint64_t>(static_cast<std::underlying_type_t<T>>(value));
  } else {
    return static_cast<std::uint64_t>(value);
  }
}

template <ScalarField T>
constexpr T scalar_from_bits(std::uint64_t bits) {
  if constexpr (std::is_same_v<T, double>) {
    return std::bit_cast<double>(bits);
  } else if constexpr (std::is_same_v<T, float>) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(bits));
  } else if constexpr (std::is_same_v<T, bool>) {
    return bits != 0;
  } else if constexpr (std::is_enum_v<T>) {
    return static_cast<T>(static_cast<std::underlying_type_t<T>>(bits));
  } else {
    return static_cast<T>(bits);
  }
}

template <class Derived>
class FieldVisitor {
 public:
  template <class T>
  void operator()(const char* name, T& value) {
    if constexpr (ScalarField<T>) {
      self().scalar(name, value);
    } else if constexpr (std::is_same_v<std::remove_cv_t<T>, TimeNs>) {
      self().scalar(name, value.ns);
    } else {
      self().enter(name);
      members(value);
      self().leave();
    }
  }
  // Visits the members of a struct without a name of its own (the root).
  template <class T>
  void members(T& value) {
    std::remove_cv_t<T>::fields(value, self());
  }
  template <class T, std::size_t N>
  void members(std::array<T, N>& items) {
    visit_items(items.data(), N);
  }
  template <class T, std::size_t N>
  void members(const std::array<T, N>& items) {
    visit_items(items.data(), N);
  }
  template <class T, std::size_t N>
  void members(FixedVector<T, N>& items) {
    self().list_size(items);
    visit_items(items.data(), items.size());
  }
  template <class T, std::size_t N>
  void members(const FixedVector<T, N>& items) {
    self().list_size(items);
    visit_items(items.data(), items.size());
  }

  // Defaults: a visitor that needs no path and no list handling inherits these.
  void enter(const char*) {}
  void leave() {}
  void enter_index(std::size_t) {}
  void leave_index() {}
  template <class List>
  void list_size(List& list) {
    std::uint32_t size = static_cast<std::uint32_t>(list.size());
    self().scalar("size", size);
  }

 private:
  Derived& self() { return static_cast<Derived&>(*this); }

  template <class T>
  void visit_items(T* items, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      self().enter_index(i);
      if constexpr (ScalarField<T>) {
        self().scalar("", items[i]);
      } else if constexpr (std::is_same_v<std::remove_cv_t<T>, TimeNs>) {
        self().scalar("", items[i].ns);
      } else {
        members(items[i]);
      }
      self().leave_index();
    }
  }
};

// Writes canonical bytes into a caller's buffer. status() is kExhausted when they did not fit.
class FieldWriter : public FieldVisitor<FieldWriter> {
 public:
  explicit FieldWriter(std::span<std::uint8_t> buffer) : buffer_(buffer) {}

  template <class T>
  void scalar(const char*, const T& value) {
    if (buffer_.size() - size_ < sizeof(T)) {
      status_ = Status::kExhausted;
      return;
    }
    const std::uint64_t bits = scalar_bits(value);
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      buffer_[size_++] = static_cast<std::uint8_t>(bits >> (8 * i));
    }
  }
  void raw(const std::uint8_t* data, std::size_t size) {
    if (buffer_.size() - size_ < size) {
      status_ = Status::kExhausted;
      return;
    }
    std::memcpy(buffer_.data() + size_, data, size);
    size_ += size;
  }
  Status status() const { return status_; }
  std::size_t size() const { return size_; }

 private:
  std::span<std::uint8_t> buffer_;
  std::size_t size_ = 0;
  Status status_ = Status::kOk;
};

// Reads canonical bytes back. status() is kCorrupt when they ended early or a list is longer than
// its capacity; fields read after that keep their values.
class FieldReader : public FieldVisitor<FieldReader> {
 public:
  explicit FieldReader(std::span<const std::uint8_t> buffer) : buffer_(buffer) {}

  template <class T>
  void scalar(const char*, T& value) {
    if (buffer_.size() - position_ < sizeof(T)) {
      status_ = Status::kCorrupt;
      return;
    }
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      bits |= static_cast<std::uint64_t>(buffer_[position_++]) << (8 * i);
    }
    value = scalar_from_bits<T>(bits);
  }
  template <class List>
  void list_size(List& list) {
    std::uint32_t size = 0;
    scalar("size", size);
    if (!ok(list.resize(size))) {
      status_ = Status::kCorrupt;
      list.clear();
    }
  }
  Status status() const { return status_; }
  std::size_t position() const { return position_; }

 private:
  std::span<const std::uint8_t> buffer_;
  std::size_t position_ = 0;
  Status status_ = Status::kOk;
};

// Feeds canonical bytes to a hash.
class FieldHasher : public FieldVisitor<FieldHasher> {
 public:
  explicit FieldHasher(Fnv64& hash) : hash_(hash) {}
  template <class T>
  void scalar(const char*, const T& value) {
    hash_.word(scalar_bits(value), sizeof(T));
  }

 private:
  Fnv64& hash_;
};

}  // namespace surefoot
