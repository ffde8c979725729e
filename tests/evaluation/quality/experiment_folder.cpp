#include "tests/evaluation/quality/experiment_folder.h"

#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>

namespace meshfront::evaluation {
namespace {

using nlohmann::ordered_json;

ordered_json numberOrNull(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? ordered_json(*value) : ordered_json(nullptr);
}

Result<void> writeJson(const std::filesystem::path& path, const ordered_json& document) {
  std::ofstream out(path, std::ios::trunc);
  out << document.dump(1) << '\n';
  out.close();
  if (out.fail()) return fail(ErrorCode::unavailable, "cannot write " + path.string());
  return {};
}

}  // namespace

std::string numberText(double value, int digits) {
  std::array<char, 64> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::fixed, digits)
          .ptr;
  return {text.data(), end};
}

Result<ExperimentFolder> ExperimentFolder::create(const std::filesystem::path& output,
                                                  const std::string& name, int number) {
  std::error_code error;
  std::filesystem::create_directories(output / name, error);
  if (error)
    return fail(ErrorCode::unavailable,
                "cannot make the folder " + (output / name).string() + ": " + error.message());
  return ExperimentFolder(output / name, number);
}

void ExperimentFolder::startCsv(const std::string& file, const std::vector<std::string>& columns) {
  csv_.try_emplace(file, path_ / file, columns);
}

void ExperimentFolder::addCsv(const std::string& file, const std::vector<std::string>& values) {
  csv_.at(file).row(values);
}

Result<void> ExperimentFolder::close() {
  for (auto& [file, csv] : csv_) {
    if (Result<void> done = csv.close(); !done) return done;
  }
  ordered_json figures = ordered_json::array();
  for (const Figure& figure : figures_) {
    figures.push_back(
        {{"experiment", number_},
         {"table", figure.table},
         {"row", figure.row},
         {"column", figure.column},
         {"value", numberOrNull(figure.value)},
         {"unit", figure.unit},
         {"published", nullptr},
         {"goal", numberOrNull(figure.goal)},
         {"goal_is", figure.goal ? ordered_json(figure.goalIs) : ordered_json(nullptr)},
         {"csv", figure.csv},
         {"note", figure.note}});
  }
  ordered_json plots = ordered_json::array();
  for (const Plot& plot : plots_) {
    ordered_json lines = ordered_json::array();
    for (const PlotLine& line : plot.lines)
      lines.push_back({{"label", line.label},
                       {"csv", plot.csv},
                       {"where", line.where},
                       {"x_column", plot.xColumn},
                       {"y_column", plot.yColumn}});
    plots.push_back({{"file", plot.file},
                     {"title", plot.title},
                     {"x", plot.x},
                     {"y", plot.y},
                     {"log_x", true},
                     {"lines", std::move(lines)},
                     {"caption", plot.caption}});
    if (plot.yMost) plots.back()["y_most"] = *plot.yMost;
  }
  ordered_json pictures = ordered_json::array();
  for (const auto& [file, caption] : pictures_)
    pictures.push_back({{"file", file}, {"caption", caption}});
  if (Result<void> done = writeJson(path_ / "figures.json", figures); !done) return done;
  if (Result<void> done = writeJson(path_ / "plots.json", plots); !done) return done;
  return writeJson(path_ / "pictures.json", pictures);
}

}  // namespace meshfront::evaluation
