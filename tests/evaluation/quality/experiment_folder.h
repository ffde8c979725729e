// What an experiment leaves behind: raw data as CSV, pictures, and the JSON lists that the page is
// made from.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "shared/result.h"
#include "tests/evaluation/csv_file.h"

namespace meshfront::evaluation {

struct Figure {
  std::string table;
  std::string row;
  std::string column;
  std::optional<double> value;  // none: not reached, and the note says so
  std::string unit;
  std::string csv;
  std::string note;
  std::optional<double> goal;
  std::string goalIs;  // "at most" or "at least", with a goal
};

struct PlotLine {
  std::string label;
  std::map<std::string, std::string> where;  // column -> value of the rows that make the line
};
struct Plot {
  std::string file;  // without an extension
  std::string title;
  std::string x;
  std::string y;
  std::string csv;
  std::string xColumn;
  std::string yColumn;
  std::optional<double> yMost;  // what lies above is cut off
  std::vector<PlotLine> lines;
  std::string caption;
};

class ExperimentFolder {
 public:
  // Makes DIR/NAME. `number`: of the experiment.
  [[nodiscard]] static Result<ExperimentFolder> create(const std::filesystem::path& output,
                                                       const std::string& name, int number);

  [[nodiscard]] const std::filesystem::path& path() const { return path_; }
  // Starts a file with its header line. Then a line a call.
  void startCsv(const std::string& file, const std::vector<std::string>& columns);
  void addCsv(const std::string& file, const std::vector<std::string>& values);
  void add(Figure figure) { figures_.push_back(std::move(figure)); }
  void add(Plot plot) { plots_.push_back(std::move(plot)); }
  void addPicture(const std::string& file, const std::string& caption) {
    pictures_.emplace_back(file, caption);
  }
  // The JSON lists; an error if anything could not be written.
  Result<void> close();

 private:
  ExperimentFolder(std::filesystem::path path, int number)
      : path_(std::move(path)), number_(number) {}

  std::filesystem::path path_;
  int number_ = 0;
  std::map<std::string, CsvFile> csv_;
  std::vector<Figure> figures_;
  std::vector<Plot> plots_;
  std::vector<std::pair<std::string, std::string>> pictures_;
};

// A number for CSV: up to that many digits behind the point.
[[nodiscard]] std::string numberText(double value, int digits = 3);

}  // namespace meshfront::evaluation
