#pragma once

// What the commands have in common: the scene with its settings, and the files to write.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/caller.hpp"
#include "app/commands/options.hpp"
#include "app/terminal/output_file.hpp"
#include "app/terminal/palette.hpp"
#include "app/terminal/progress.hpp"
#include "statics/equilibrium/answer.hpp"
#include "statics/sensitivity/fitted_numbers.hpp"

namespace poise::app {

/// Reads the scene, or takes the caller's, and puts the estimates of --with and the settings into it. Throws
/// InputError, also where both set one number.
Scene load_moving_scene(const Request& request);
/// The same at the time t = 0, as at_time().
Scene load_scene(const Request& request);
/// What --with says of the numbers of that scene but for `varied`, which has a value of another origin; empty where it
/// is not given. Throws InputError.
std::optional<FittedNumbers> load_fit(const Request& request, const Scene& scene, const std::string& varied = "");

/// Whether two paths name one file, of files that do not exist by their words.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// Charts as one figure; none where there are no panels.
std::vector<Figure> chart_figures(std::string title, std::vector<Panel> panels);

/// The files of a request; tested for writing here, before any work is done. Throws InputError where one cannot be
/// written, where two are the same, or where one is a file that is `read`.
class OutputFiles {
 public:
  explicit OutputFiles(const Request& request, const std::vector<std::string>& read = {});

  bool wants_svg() const;
  bool wants_html() const;
  bool wants_csv() const;
  /// Writes the result in the forms asked for, with its pictures, and the scene or experiment that was found, or, where
  /// that fails, throws InputError. A text that is empty is not written. Returns one line for each file written. A
  /// caller keeps the pictures and what was found. `exported` are the texts of Request::exported.
  std::string write(const Result& result, const Pictures& pictures, const std::string& found = "",
                    const std::vector<std::string>& exported = {});

 private:
  struct Form {
    enum Place : std::size_t { json, svg, html, csv, markdown, scene, experiment, count };
  };
  struct Output {
    std::string option, path;
    std::optional<OutputFile> file;
  };
  std::vector<Output> outputs_;  // by Form, then those of other programs
  PageOrigin origin_;
  Caller* caller_;
};

/// The end of a command: writes a result, its pictures, a scene and what is exported to the files asked for, none where
/// `files` is null (the work was interrupted), and prints it. Returns the exit code.
int finish(const Request& request, const Result& result, OutputFiles* files, const Pictures& pictures, bool is_solved,
           Progress& progress, const Palette& palette, const std::string& scene = "",
           const std::vector<std::string>& exported = {});

/// Prints a result as text, at the level of detail asked for, and the lines on the files written; or leaves it with the
/// caller.
void print(const Request& request, const Result& result, const std::string& written, const Palette& palette);

/// Searches by one method and measures what it found.
Answer search(const StaticModel& model, const SolveOptions& options, Progress& progress);

/// The picture of an answer that has readings, with the instant centres among the quantities shown.
std::string picture(const StaticModel& model, const Answer& answer, const std::vector<SoughtQuantity>& shown = {});

/// Prints on standard output. Throws InputError where that fails (the disk is full).
void print(const std::string& text);

}  // namespace poise::app
