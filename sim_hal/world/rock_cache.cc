// The cache of rock fields (rock_field.h).
#include <unistd.h>

#include <array>
#include <bit>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <string>
#include <system_error>

#include "core/base/hash.h"
#include "sim_hal/simulator_error.h"
#include "sim_hal/world/rock_field.h"

namespace surefoot::sim {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kMagic = 0x31534b434f524653ull;  // "SFROCKS1", as bytes in the file
// Raised with every change that alters a field of the same options and seed.
constexpr std::uint64_t kGeneratorVersion = 1;

// Everything but the samples, as 64-bit words.
struct Header {
  std::uint64_t magic = kMagic;
  std::uint64_t version = kGeneratorVersion;
  std::uint64_t options = 0;
  std::uint64_t seed = 0;
  std::uint64_t columns = 0;
  std::uint64_t rows = 0;
  double simulated_s = 0;
  double rest_speed_m_s = 0;
  double deepest_contact_m = 0;
  double scale = 0;
  std::uint64_t lost_bodies = 0;
};
static_assert(sizeof(Header) == 11 * 8);

std::uint64_t digest(const RockFieldOptions& options) {
  Fnv64 hash;
  for (const int value : {options.bodies, options.points_per_body, options.kernel_side}) {
    hash.word(static_cast<std::uint64_t>(value), 8);
  }
  for (const double value : {options.length_m, options.width_m, options.point_deviation_m,
                             options.least_factor, options.most_factor, options.height_range_m}) {
    hash.word(std::bit_cast<std::uint64_t>(value), 8);
  }
  return hash.value();
}

std::string hex(std::uint64_t value) {
  std::array<char, 17> text{};
  std::snprintf(text.data(), text.size(), "%016llx", static_cast<unsigned long long>(value));
  return text.data();
}

std::uint64_t checksum(const Header& header, const std::vector<float>& samples) {
  Fnv64 hash;
  hash.bytes(reinterpret_cast<const std::uint8_t*>(&header), sizeof(header));
  hash.bytes(reinterpret_cast<const std::uint8_t*>(samples.data()), samples.size() * sizeof(float));
  return hash.value();
}

template <class T>
bool read_bytes(std::ifstream& file, T* to, std::size_t size) {
  file.read(reinterpret_cast<char*>(to), static_cast<std::streamsize>(size));
  return file.gcount() == static_cast<std::streamsize>(size);
}

// False: there is no such file, or it is not exactly what was once written.
bool read_field(const fs::path& path, const Header& wanted, RockField& field) {
  std::ifstream file(path, std::ios::binary);
  Header header;
  if (!read_bytes(file, &header, sizeof(header))) return false;
  if (header.magic != wanted.magic || header.version != wanted.version ||
      header.options != wanted.options || header.seed != wanted.seed ||
      header.columns != wanted.columns || header.rows != wanted.rows) {
    return false;
  }
  field.columns = header.columns;
  field.rows = header.rows;
  field.z_m.resize(field.columns * field.rows);
  std::uint64_t sum = 0;
  if (!read_bytes(file, field.z_m.data(), field.z_m.size() * sizeof(float)) ||
      !read_bytes(file, &sum, sizeof(sum)) || sum != checksum(header, field.z_m)) {
    return false;
  }
  field.simulated_s = header.simulated_s;
  field.rest_speed_m_s = header.rest_speed_m_s;
  field.deepest_contact_m = header.deepest_contact_m;
  field.scale = header.scale;
  field.lost_bodies = static_cast<std::uint32_t>(header.lost_bodies);
  return true;
}

void write_field(const fs::path& path, Header header, const RockField& field) {
  header.simulated_s = field.simulated_s;
  header.rest_speed_m_s = field.rest_speed_m_s;
  header.deepest_contact_m = field.deepest_contact_m;
  header.scale = field.scale;
  header.lost_bodies = field.lost_bodies;
  const std::uint64_t sum = checksum(header, field.z_m);
  std::error_code error;
  fs::create_directories(path.parent_path(), error);
  const fs::path aside = path.string() + "." + std::to_string(getpid());
  std::ofstream file(aside, std::ios::binary);
  file.write(reinterpret_cast<const char*>(&header), sizeof(header));
  file.write(reinterpret_cast<const char*>(field.z_m.data()),
             static_cast<std::streamsize>(field.z_m.size() * sizeof(float)));
  file.write(reinterpret_cast<const char*>(&sum), sizeof(sum));
  file.close();
  if (file.good()) fs::rename(aside, path, error);
  if (!file.good() || error) {
    fs::remove(aside, error);
    throw SimulatorError(path.string() + ": the rock field cannot be written");
  }
}

}  // namespace

fs::path rock_cache_folder() {
  const auto named = [](const char* name) {
    const char* value = std::getenv(name);
    return fs::path(value != nullptr ? value : "");
  };
  if (!named("SUREFOOT_CACHE").empty()) return named("SUREFOOT_CACHE");
  if (!named("XDG_CACHE_HOME").empty()) return named("XDG_CACHE_HOME") / "surefoot";
  if (!named("HOME").empty()) return named("HOME") / ".cache" / "surefoot";
  return fs::temp_directory_path() / "surefoot";
}

fs::path rock_field_file(const fs::path& folder, const RockFieldOptions& options,
                         std::uint64_t seed) {
  return folder / ("rocks-v" + std::to_string(kGeneratorVersion) + "-" + hex(digest(options)) +
                   "-" + std::to_string(seed) + ".bin");
}

RockField cached_rock_field(const fs::path& folder, const RockFieldOptions& options,
                            std::uint64_t seed) {
  const fs::path path = rock_field_file(folder, options, seed);
  Header header;
  header.options = digest(options);
  header.seed = seed;
  header.columns = sample_count(options.length_m);
  header.rows = sample_count(options.width_m);
  RockField field;
  if (read_field(path, header, field)) return field;
  field = make_rock_field(options, seed);
  write_field(path, header, field);
  return field;
}

}  // namespace surefoot::sim
