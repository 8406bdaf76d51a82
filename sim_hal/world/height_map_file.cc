#include "sim_hal/world/height_map_file.h"

#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <opencv2/imgcodecs.hpp>
#include <optional>
#include <string_view>

#include "sim_hal/simulator_error.h"

namespace surefoot::sim {

namespace {

constexpr std::size_t kMaxCells = 25'000'000;

[[noreturn]] void fail(const std::string& file, std::size_t line, const std::string& what) {
  throw SimulatorError(file + ":" + std::to_string(line) + ": " + what);
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return result;
}

// Cuts the next blank-separated word off the front of text; empty at the end.
std::string_view next_word(std::string_view& text) {
  const std::size_t begin = text.find_first_not_of(" \t\r");
  if (begin == std::string_view::npos) return {};
  text.remove_prefix(begin);
  const std::size_t end = std::min(text.find_first_of(" \t\r"), text.size());
  const std::string_view word = text.substr(0, end);
  text.remove_prefix(end);
  return word;
}

double number(const std::string& file, std::size_t line, std::string_view word) {
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    fail(file, line, "'" + std::string(word) + "' is not a finite number");
  }
  return value;
}

std::size_t count(const std::string& file, std::size_t line, std::string_view word) {
  const double value = number(file, line, word);
  if (value < 2 || value > 20'000 || value != std::floor(value)) {
    fail(file, line, "'" + std::string(word) + "' is not a size from 2 to 20000");
  }
  return static_cast<std::size_t>(value);
}

struct AsciiHeader {
  std::optional<std::size_t> columns;
  std::optional<std::size_t> rows;
  std::optional<double> cell_m;
  std::optional<double> nodata;

  // False when the word is not a header key.
  bool take(const std::string& file, std::size_t line, const std::string& key,
            std::string_view value) {
    if (key == "ncols") {
      columns = count(file, line, value);
    } else if (key == "nrows") {
      rows = count(file, line, value);
    } else if (key == "cellsize") {
      cell_m = number(file, line, value);
    } else if (key == "nodata_value") {
      nodata = number(file, line, value);
    } else if (key == "xllcorner" || key == "xllcenter" || key == "yllcorner" ||
               key == "yllcenter") {
      static_cast<void>(number(file, line, value));  // the world has its own origin
    } else {
      return false;
    }
    return true;
  }
};

void check_header(const std::string& file, std::size_t line, const AsciiHeader& header) {
  if (!header.columns) fail(file, line, "ncols is missing before the first row");
  if (!header.rows) fail(file, line, "nrows is missing before the first row");
  if (!header.cell_m) fail(file, line, "cellsize is missing before the first row");
  if (!(*header.cell_m > 0)) fail(file, line, "cellsize must be above 0");
  if (*header.columns * *header.rows > kMaxCells) fail(file, line, "more than 25 million cells");
}

void read_row(const std::string& file, std::size_t line, std::string_view text,
              const AsciiHeader& header, std::size_t row, RawHeightMap& map) {
  for (std::size_t column = 0; column < map.columns; ++column) {
    const std::string_view word = next_word(text);
    if (word.empty()) {
      fail(
          file, line,
          "row has " + std::to_string(column) + " values, ncols is " + std::to_string(map.columns));
    }
    const double value = number(file, line, word);
    const bool known = !header.nodata || value != *header.nodata;
    map.known[map.index(row, column)] = known ? 1 : 0;
    map.z_m[map.index(row, column)] = known ? value : 0.0;
  }
  if (!next_word(text).empty()) fail(file, line, "row has more values than ncols");
}

void check_some_known(const std::string& file, const RawHeightMap& map) {
  if (std::find(map.known.begin(), map.known.end(), 1) == map.known.end()) {
    throw SimulatorError(file + ": every cell is nodata");
  }
}

double yaml_number(const std::string& file, const YAML::Node& root, const char* key,
                   std::optional<double> fallback) {
  const YAML::Node node = root[key];
  if (!node) {
    if (fallback) return *fallback;
    throw SimulatorError(file + ": key " + key + " is missing");
  }
  double value = 0;
  if (!YAML::convert<double>::decode(node, value) || !std::isfinite(value)) {
    fail(file, static_cast<std::size_t>(node.Mark().line + 1),
         std::string(key) + " is not a finite number");
  }
  return value;
}

}  // namespace

RawHeightMap read_esri_ascii(const std::string& file) {
  std::ifstream stream(file);
  if (!stream) throw SimulatorError(file + ": cannot be opened");
  AsciiHeader header;
  RawHeightMap map;
  std::string text;
  std::size_t line = 0;
  std::size_t row = 0;
  bool in_header = true;
  while (std::getline(stream, text)) {
    ++line;
    std::string_view rest = text;
    const std::string_view first = next_word(rest);
    if (first.empty()) continue;
    if (in_header && std::isalpha(static_cast<unsigned char>(first[0])) != 0) {
      const std::string_view value = next_word(rest);
      if (value.empty()) fail(file, line, "'" + std::string(first) + "' has no value");
      if (!header.take(file, line, lower(first), value)) {
        fail(file, line, "'" + std::string(first) + "' is not a key of an ESRI ASCII grid");
      }
      continue;
    }
    if (in_header) {
      check_header(file, line, header);
      map.columns = *header.columns;
      map.rows = *header.rows;
      map.cell_m = *header.cell_m;
      map.z_m.assign(map.columns * map.rows, 0.0);
      map.known.assign(map.columns * map.rows, 0);
      in_header = false;
    }
    if (row == map.rows) fail(file, line, "more rows than nrows = " + std::to_string(map.rows));
    read_row(file, line, text, header, row, map);
    ++row;
  }
  if (in_header) fail(file, line, "ends before the first row");
  if (row < map.rows) {
    fail(file, line,
         "ends after " + std::to_string(row) + " rows, nrows is " + std::to_string(map.rows));
  }
  check_some_known(file, map);
  return map;
}

RawHeightMap read_png16(const std::string& file) {
  const std::string yaml_file = file.substr(0, file.rfind('.')) + ".yaml";
  YAML::Node root;
  try {
    root = YAML::LoadFile(yaml_file);
  } catch (const YAML::ParserException& error) {
    fail(yaml_file, static_cast<std::size_t>(error.mark.line + 1), error.msg);
  } catch (const YAML::BadFile&) {
    throw SimulatorError(yaml_file + ": cannot be opened (it describes " + file + ")");
  }
  if (!root.IsMap()) throw SimulatorError(yaml_file + ": not a map of keys");
  const double metres_per_count = yaml_number(yaml_file, root, "metres_per_count", {});
  const double offset_m = yaml_number(yaml_file, root, "offset_m", 0.0);
  const double nodata = yaml_number(yaml_file, root, "nodata", -1.0);
  RawHeightMap map;
  map.cell_m = yaml_number(yaml_file, root, "cell_size_m", {});
  if (!(map.cell_m > 0)) throw SimulatorError(yaml_file + ": cell_size_m must be above 0");
  if (!(metres_per_count > 0)) {
    throw SimulatorError(yaml_file + ": metres_per_count must be above 0");
  }
  const cv::Mat image = cv::imread(file, cv::IMREAD_UNCHANGED);
  if (image.empty()) throw SimulatorError(file + ": not a readable image");
  if (image.type() != CV_16UC1) throw SimulatorError(file + ": not 16-bit with one channel");
  if (image.rows < 2 || image.cols < 2) throw SimulatorError(file + ": smaller than 2 x 2");
  map.columns = static_cast<std::size_t>(image.cols);
  map.rows = static_cast<std::size_t>(image.rows);
  for (int row = 0; row < image.rows; ++row) {
    for (int column = 0; column < image.cols; ++column) {
      const double counts = image.at<std::uint16_t>(row, column);
      map.known.push_back(counts == nodata ? 0 : 1);
      map.z_m.push_back(offset_m + metres_per_count * counts);
    }
  }
  check_some_known(file, map);
  return map;
}

RawHeightMap read_height_map(const std::string& file) {
  const std::size_t dot = file.rfind('.');
  const std::string extension = dot == std::string::npos ? "" : lower(file.substr(dot));
  if (extension == ".asc") return read_esri_ascii(file);
  if (extension == ".png") return read_png16(file);
  throw SimulatorError(file + ": a height map is an .asc or a .png file");
}

namespace {

// Lowest known neighbour of eight; false when there is none.
bool lowest_neighbour(const RawHeightMap& map, std::size_t row, std::size_t column,
                      double& lowest) {
  bool found = false;
  const std::size_t row_end = std::min(row + 2, map.rows);
  const std::size_t column_end = std::min(column + 2, map.columns);
  for (std::size_t r = row == 0 ? 0 : row - 1; r < row_end; ++r) {
    for (std::size_t c = column == 0 ? 0 : column - 1; c < column_end; ++c) {
      const std::size_t i = map.index(r, c);
      if (map.known[i] == 0 || (found && map.z_m[i] >= lowest)) continue;
      lowest = map.z_m[i];
      found = true;
    }
  }
  return found;
}

double known_part_of_row(const RawHeightMap& map, std::size_t row) {
  std::size_t known = 0;
  for (std::size_t c = 0; c < map.columns; ++c) known += map.known[map.index(row, c)];
  return static_cast<double>(known) / static_cast<double>(map.columns);
}

double known_part_of_column(const RawHeightMap& map, std::size_t column) {
  std::size_t known = 0;
  for (std::size_t r = 0; r < map.rows; ++r) known += map.known[map.index(r, column)];
  return static_cast<double>(known) / static_cast<double>(map.rows);
}

RawHeightMap cut(const RawHeightMap& map, std::size_t row, std::size_t column, std::size_t rows,
                 std::size_t columns) {
  RawHeightMap result;
  result.rows = rows;
  result.columns = columns;
  result.cell_m = map.cell_m;
  for (std::size_t r = 0; r < rows; ++r) {
    for (std::size_t c = 0; c < columns; ++c) {
      const std::size_t i = map.index(row + r, column + c);
      result.z_m.push_back(map.z_m[i]);
      result.known.push_back(map.known[i]);
    }
  }
  return result;
}

}  // namespace

std::uint32_t bridge_unknown(RawHeightMap& map) {
  std::uint32_t bridged = 0;
  std::vector<std::size_t> ring;
  for (bool any = true; any;) {
    ring.clear();
    for (std::size_t row = 0; row < map.rows; ++row) {
      for (std::size_t column = 0; column < map.columns; ++column) {
        const std::size_t i = map.index(row, column);
        if (map.known[i] == 0 && lowest_neighbour(map, row, column, map.z_m[i])) ring.push_back(i);
      }
    }
    for (const std::size_t i : ring) map.known[i] = 1;
    bridged += static_cast<std::uint32_t>(ring.size());
    any = !ring.empty();
  }
  return bridged;
}

void crop_to_known(RawHeightMap& map) {
  constexpr std::size_t kMinCells = 8;
  constexpr double kEnough = 0.5;
  for (;;) {
    const bool rows_left = map.rows > kMinCells;
    const bool columns_left = map.columns > kMinCells;
    const std::array<double, 4> known{
        rows_left ? known_part_of_row(map, 0) : 1.0,
        rows_left ? known_part_of_row(map, map.rows - 1) : 1.0,
        columns_left ? known_part_of_column(map, 0) : 1.0,
        columns_left ? known_part_of_column(map, map.columns - 1) : 1.0};
    const std::size_t side =
        static_cast<std::size_t>(std::min_element(known.begin(), known.end()) - known.begin());
    if (known[side] >= kEnough) return;
    if (side < 2) {
      map = cut(map, side == 0 ? 1 : 0, 0, map.rows - 1, map.columns);
    } else {
      map = cut(map, 0, side == 2 ? 1 : 0, map.rows, map.columns - 1);
    }
  }
}

}  // namespace surefoot::sim
