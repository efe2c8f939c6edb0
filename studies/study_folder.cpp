#include "studies/study_folder.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <optional>
#include <system_error>

#include <boost/crc.hpp>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

#include "model/input_error.hpp"
#include "model/one_line.hpp"

namespace poise::studies {
namespace {
namespace fs = std::filesystem;

constexpr std::string_view before_checksum = ", crc32 ";

/// CRC-32 as of zlib, gzip and PNG.
std::uint32_t checksum(std::string_view text) {
  boost::crc_32_type crc;
  crc.process_bytes(text.data(), text.size());
  return crc.checksum();
}

/// A record of a file: lines, and a last one "# WHAT, crc32 CHECKSUM" with that of all before the checksum itself.
std::string sealed(std::string lines, std::string_view what) {
  lines += fmt::format("# {}{}", what, before_checksum);
  return lines + fmt::format("{:08x}\n", checksum(lines));
}

struct Record {
  std::string text;  // with its last line
  std::string what;  // of the last line
  bool intact = false;
};

/// The next record of a file; none where no last line follows, as after a write that was cut off.
std::optional<Record> next_record(std::istream& in) {
  Record out;
  for (std::string line; std::getline(in, line);) {
    if (in.eof()) return std::nullopt;  // no line break
    const std::size_t mark = line.rfind(before_checksum);
    out.text += line;
    if (line.starts_with("# ") && mark != std::string::npos) {
      const std::size_t digits = line.size() - mark - before_checksum.size();
      const std::string_view checked = std::string_view(out.text).substr(0, out.text.size() - digits);
      out.what = line.substr(2, mark - 2);
      out.intact = line.substr(line.size() - digits) == fmt::format("{:08x}", checksum(checked));
      out.text += '\n';
      return out;
    }
    out.text += '\n';
  }
  return std::nullopt;
}

/// A cell of a CSV line.
std::string cell(const std::string& name) {
  if (name.find_first_of(",\"") == std::string::npos) return one_line(name);
  std::string out = "\"";
  for (const char c : one_line(name)) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string file_name(const StudyOptions& options) {
  return options.shards == 1 ? "study.csv" : fmt::format("shard-{}-of-{}.csv", options.shard, options.shards);
}

/// Throws InputError for what has the name of a study's file and is none: a link that leads nowhere, a device, a pipe,
/// which would wait for a writer.
void expect_file(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status status = fs::status(path, ignored);
  if (fs::is_regular_file(status)) return;
  throw InputError(fmt::format("--output: {}: expected the file of a study, found {}; move it away", path.string(),
                               !fs::exists(status)        ? "a link that leads nowhere"
                               : fs::is_directory(status) ? "a folder"
                                                          : "a device or a pipe"));
}

/// The files of studies in a folder, sorted.
std::vector<fs::path> study_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name == "study.csv" || (name.starts_with("shard-") && name.ends_with(".csv"))) {
      expect_file(entry.path());
      files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::optional<std::uint64_t> chunk_of(std::string_view what) {
  constexpr std::string_view before = "chunk ";
  std::uint64_t chunk = 0;
  if (!what.starts_with(before)) return std::nullopt;
  const auto [end, error] = std::from_chars(what.data() + before.size(), what.data() + what.size(), chunk);
  if (error != std::errc() || end != what.data() + what.size()) return std::nullopt;
  return chunk;
}

}  // namespace

AppendedFile::AppendedFile(fs::path path) : path_(std::move(path)) {
  file_ = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);  // NOLINT
  if (file_ < 0) fail("a file that can be written");
  // Where the file system knows no locks, there is no protection.
  if (::flock(file_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(file_);
    throw InputError(
        fmt::format("--output: {}: another poise is writing it; wait until that has ended", path_.string()));
  }
  size_ = fs::file_size(path_);
}

AppendedFile::~AppendedFile() { ::close(file_); }

void AppendedFile::fail(const std::string& expected) const {
  throw InputError(
      fmt::format("--output: {}: expected {}: {}", path_.string(), expected, std::generic_category().message(errno)));
}

void AppendedFile::cut_to(std::uint64_t size) {
  if (::ftruncate(file_, static_cast<off_t>(size)) != 0) fail("a file that can be written");
  size_ = size;
}

void AppendedFile::append(std::string_view text) {
  while (!text.empty()) {
    const ssize_t written = ::write(file_, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail("a place that takes the results");
    text.remove_prefix(static_cast<std::size_t>(written));
    size_ += static_cast<std::uint64_t>(written);
  }
}

StudyFolder::StudyFolder(const Study& study, const StudyOptions& options)
    : study_(study),
      own_(fs::path(options.folder) / file_name(options)),
      places_((study.samples + study.chunk() - 1) / study.chunk()) {
  const fs::path folder = options.folder;
  std::error_code failed;
  fs::create_directories(folder, failed);
  if (!fs::is_directory(folder)) {
    throw InputError(fmt::format("--output: {}: expected a folder, or a place for a new one", folder.string()));
  }
  const bool is_begun = options.shards > 1 ? fs::exists(own_) : !fs::is_empty(folder);
  if (is_begun && !options.resume) {
    throw InputError(fmt::format("--output: {} exists already; expected a new folder, or --resume to go on with it",
                                 options.shards > 1 ? own_.string() : folder.string()));
  }
  const std::vector<fs::path> found = study_files(folder);
  if (fs::exists(own_)) file_ = std::make_unique<AppendedFile>(own_);
  for (const fs::path& file : found) {
    const std::uint64_t intact = find_chunks(file);
    if (file == own_) file_->cut_to(intact);
  }
  bool is_complete = true;
  for (std::uint64_t c = options.shard - 1; c < places_.size(); c += options.shards) is_complete &= has(c);
  if (is_complete) return;
  if (!file_) file_ = std::make_unique<AppendedFile>(own_);
  if (file_->size() == 0) file_->append(header());
  if (std::find(files_.begin(), files_.end(), own_) == files_.end()) files_.push_back(own_);
}

std::string StudyFolder::header() const {
  std::string lines = fmt::format("# poise {}, study file 1\n", study_.name);
  for (const auto& [name, value] : study_.identity) lines += fmt::format("# {} = {}\n", name, one_line(value));
  lines += fmt::format("# chunk = {}\nsample", study_.chunk());
  for (const std::string& column : study_.columns) lines += "," + cell(column);
  return sealed(lines + "\n", "header");
}

/// Returns the length of the file up to its last complete record.
std::uint64_t StudyFolder::find_chunks(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  const std::optional<Record> first = next_record(in);
  // A process that was ended while it wrote the header has left no more.
  if (!first && header().starts_with(std::string(std::istreambuf_iterator<char>(std::ifstream(file).rdbuf()), {}))) {
    return 0;
  }
  if (!first || first->what != "header" || !first->intact) {
    throw InputError(
        fmt::format("--output: {}: expected the file of a study, its header is damaged; move it away", file.string()));
  }
  expect_same_study(file, first->text);
  std::uint64_t offset = first->text.size();
  while (const std::optional<Record> record = next_record(in)) {
    const std::optional<std::uint64_t> chunk = chunk_of(record->what);
    if (!record->intact || !chunk || *chunk >= places_.size()) {
      warnings_.push_back(fmt::format("{}: a record at byte {} is damaged (its checksum is wrong) and not used",
                                      file.string(), offset));
    } else {
      places_[*chunk] = {files_.size(), offset, record->text.size()};
    }
    offset += record->text.size();
  }
  files_.push_back(file);
  return offset;
}

void StudyFolder::expect_same_study(const fs::path& file, const std::string& found) const {
  const std::string expected = header();
  if (found == expected) return;
  const auto [ours, theirs] = std::mismatch(expected.begin(), expected.end(), found.begin(), found.end());
  // The first line that differs, as "trials = 300".
  const auto line = [](const std::string& text, auto at) {
    const auto begin = std::find(std::make_reverse_iterator(at), text.rend(), '\n').base();
    std::string out(begin, std::find(begin, text.end(), '\n'));
    return out.starts_with("# ") ? out.substr(2) : out;
  };
  throw InputError(
      fmt::format("--output: {}: belongs to another study, with \"{}\" where this one has \"{}\"; expected the same, "
                  "or another folder",
                  file.string(), line(found, theirs), line(expected, ours)));
}

std::vector<double> StudyFolder::read(std::uint64_t chunk) const {
  const Place& place = places_[chunk];
  const fs::path& file = files_[place.file];
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(place.offset));
  const std::uint64_t first = chunk * study_.chunk();
  const std::uint64_t last = std::min(first + study_.chunk(), study_.samples);
  std::vector<double> rows;
  const std::optional<Record> record = next_record(in);
  const char* at = record ? record->text.data() : nullptr;
  const char* const end = record ? at + record->text.size() : nullptr;
  const auto number = [&](auto& value, char behind) {
    const auto [stopped, error] = std::from_chars(at, end, value);
    const bool fits = error == std::errc() && stopped != end && *stopped == behind;
    if (fits) at = stopped + 1;
    return fits;
  };
  for (std::uint64_t sample = first; record && sample < last; ++sample) {
    std::uint64_t index = 0;
    bool fits = number(index, ',') && index == sample;
    for (std::size_t column = 0; fits && column < study_.columns.size(); ++column) {
      fits = number(rows.emplace_back(), column + 1 < study_.columns.size() ? ',' : '\n');
    }
    if (!fits) break;
  }
  if (rows.size() != (last - first) * study_.columns.size() || !record->intact) {
    throw InputError(fmt::format("--output: {}: expected chunk {} at byte {}; the file was changed meanwhile",
                                 file.string(), chunk, place.offset));
  }
  return rows;
}

void StudyFolder::append(std::uint64_t chunk, const std::vector<double>& rows) {
  std::string lines;
  const std::size_t columns = study_.columns.size();
  for (std::size_t row = 0; row < rows.size() / columns; ++row) {
    lines += std::to_string(chunk * study_.chunk() + row);
    // As many digits as it takes to read the same number back.
    for (std::size_t column = 0; column < columns; ++column) lines += fmt::format(",{}", rows[row * columns + column]);
    lines += '\n';
  }
  const std::string record = sealed(std::move(lines), fmt::format("chunk {}", chunk));
  const auto own = std::find(files_.begin(), files_.end(), own_);
  places_[chunk] = {static_cast<std::size_t>(own - files_.begin()), file_->size(), record.size()};
  file_->append(record);
}

}  // namespace poise::studies
