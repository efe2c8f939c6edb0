#pragma once

// What the commands have in common: the scene with its settings, and the files to write.

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/options.hpp"
#include "app/result/result.hpp"
#include "app/terminal/output_file.hpp"
#include "app/terminal/palette.hpp"
#include "app/terminal/progress.hpp"
#include "statics/answer.hpp"

namespace poise::app {

/// Reads the scene and puts the settings into it. Throws InputError.
Scene load_scene(const Request& request);

/// Whether two paths name one file, of files that do not exist by their words.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// The files of a request; tested for writing here, before any work is done. Throws InputError where one cannot be
/// written, where two are the same, or where one is a file that is `read`.
class OutputFiles {
 public:
  explicit OutputFiles(const Request& request, const std::vector<std::string>& read = {});

  bool wants_svg() const { return outputs_[Form::svg].file.has_value(); }
  bool wants_csv() const { return outputs_[Form::csv].file.has_value(); }
  /// Writes the result in the forms asked for, a picture and the scene or experiment that was found, or, where that
  /// fails, throws InputError. A text that is empty is not written. Returns one line for each file written.
  std::string write(const Result& result, const std::string& svg, const std::string& found = "");

 private:
  struct Form {
    enum Place : std::size_t { json, svg, csv, markdown, scene, experiment, count };
  };
  struct Output {
    std::string option, path;
    std::optional<OutputFile> file;
  };
  std::array<Output, Form::count> outputs_;
};

/// The end of a command: writes a result, a picture and a scene to the files asked for, none where `files` is null (the
/// work was interrupted), and prints it. Returns the exit code.
int finish(const Request& request, const Result& result, OutputFiles* files, const std::string& svg, bool is_solved,
           Progress& progress, const Palette& palette, const std::string& scene = "");

/// Prints a result as text, at the level of detail asked for, and the lines on the files written.
void print(const Request& request, const Result& result, const std::string& written, const Palette& palette);

/// Searches by one method and measures what it found.
Answer search(const StaticModel& model, const SolveOptions& options, Progress& progress);

/// The picture of an answer that has readings.
std::string picture(const StaticModel& model, const Answer& answer);

/// Prints on standard output. Throws InputError where that fails (the disk is full).
void print(const std::string& text);

}  // namespace poise::app
