#include "tests/app/run_poise.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fstream>
#include <iterator>
#include <set>
#include <stdexcept>

#include <fcntl.h>
#include <pty.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

namespace poise::app_tests {
namespace fs = std::filesystem;
namespace {

// Never returns: in the child process.
[[noreturn]] void become_poise(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
  std::vector<std::string> words = {POISE_EXECUTABLE};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  ::setenv("TERM", "xterm", 1);
  ::unsetenv("NO_COLOR");
  for (const std::string& variable : environment) {
    const std::size_t equals = variable.find('=');
    ::setenv(variable.substr(0, equals).c_str(), variable.substr(equals + 1).c_str(), 1);
  }
  ::execv(POISE_EXECUTABLE, argv.data());
  ::_exit(127);
}

int wait_for(pid_t child) {
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

void send_to(const fs::path& file, int stream) {
  const int opened = ::open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (opened < 0 || ::dup2(opened, stream) < 0) ::_exit(126);
  ::close(opened);
}

bool is_name_character(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' || c == '_' || c == ':' || c == '.';
}

/// Reads XML from front to back; throws where it is not well-formed.
class XmlReader {
 public:
  explicit XmlReader(std::string_view text) : rest_(text) {}

  void read() {
    if (rest_.starts_with("<?xml")) rest_.remove_prefix(rest_.find("?>") + 2);
    do {
      const std::size_t tag = rest_.find('<');
      check_text(rest_.substr(0, tag));
      if (tag == std::string_view::npos) break;
      rest_.remove_prefix(tag);
      read_tag();
    } while (!rest_.empty());
    if (!open_.empty()) throw std::runtime_error("<" + open_.back() + "> is not closed");
    if (!had_root_) throw std::runtime_error("no element");
  }

 private:
  void check_text(std::string_view text) const {
    for (std::size_t i = 0; i < text.size(); ++i) {
      const auto byte = static_cast<unsigned char>(text[i]);
      if (byte < 0x20U && byte != '\n' && byte != '\t') throw std::runtime_error("control character");
      if (text[i] != '&') continue;
      const std::string_view reference = text.substr(i, text.substr(i).find(';') + 1);
      const std::set<std::string_view> known = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
      if (!known.contains(reference)) throw std::runtime_error("bare & in \"" + std::string(text) + "\"");
    }
  }

  std::string read_name() {
    std::size_t end = 0;
    while (end < rest_.size() && is_name_character(rest_[end])) ++end;
    if (end == 0) throw std::runtime_error("a name is missing at \"" + std::string(rest_.substr(0, 20)) + "\"");
    std::string name(rest_.substr(0, end));
    rest_.remove_prefix(end);
    return name;
  }

  void skip_blanks() {
    while (!rest_.empty() && std::isspace(static_cast<unsigned char>(rest_.front())) != 0) rest_.remove_prefix(1);
  }

  void expect(std::string_view token) {
    if (!rest_.starts_with(token)) {
      throw std::runtime_error("expected " + std::string(token) + " at \"" + std::string(rest_.substr(0, 20)) + "\"");
    }
    rest_.remove_prefix(token.size());
  }

  void read_tag() {
    expect("<");
    if (rest_.starts_with('/')) {
      rest_.remove_prefix(1);
      const std::string name = read_name();
      if (open_.empty() || open_.back() != name) throw std::runtime_error("</" + name + "> closes nothing");
      open_.pop_back();
      expect(">");
      return;
    }
    if (open_.empty() && had_root_) throw std::runtime_error("a second root");
    had_root_ = true;
    const std::string name = read_name();
    std::set<std::string> attributes;
    for (skip_blanks(); !rest_.starts_with('>') && !rest_.starts_with("/>"); skip_blanks()) {
      const std::string attribute = read_name();
      if (!attributes.insert(attribute).second) throw std::runtime_error("attribute " + attribute + " twice");
      skip_blanks();
      expect("=");
      skip_blanks();
      const std::string_view quote = rest_.starts_with('\'') ? "'" : "\"";
      expect(quote);
      const std::size_t end = rest_.find(quote);
      const std::string_view value = rest_.substr(0, end);
      if (value.find('<') != std::string_view::npos) throw std::runtime_error("< in attribute " + attribute);
      check_text(value);
      rest_.remove_prefix(value.size());
      expect(quote);
    }
    if (rest_.starts_with('>')) open_.push_back(name);
    expect(rest_.starts_with('>') ? ">" : "/>");
  }

  std::string_view rest_;
  std::vector<std::string> open_;
  bool had_root_ = false;
};

}  // namespace

TempFolder::TempFolder() {
  std::string pattern = (fs::temp_directory_path() / "poise_test_XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a folder for the test");
  path_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

std::string TempFolder::write(const std::string& name, std::string_view text) const {
  std::ofstream(path(name), std::ios::binary) << text;
  return path(name).string();
}

std::vector<std::string> TempFolder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(path_)) names.push_back(entry.path().filename().string());
  std::sort(names.begin(), names.end());
  return names;
}

ProgramRun run_poise(const std::vector<std::string>& arguments, const std::vector<std::string>& environment) {
  const TempFolder folder;
  const pid_t child = ::fork();
  if (child == 0) {
    send_to(folder.path("out"), STDOUT_FILENO);
    send_to(folder.path("err"), STDERR_FILENO);
    become_poise(arguments, environment);
  }
  const int exit_code = wait_for(child);
  return {exit_code, contents(folder.path("out")), contents(folder.path("err"))};
}

ProgramRun run_poise_in_terminal(const std::vector<std::string>& arguments,
                                 const std::vector<std::string>& environment) {
  int terminal = -1;
  const pid_t child = ::forkpty(&terminal, nullptr, nullptr, nullptr);
  if (child == 0) become_poise(arguments, environment);
  ProgramRun outcome;
  std::array<char, 4096> buffer{};
  // read() fails on a terminal whose other side has closed.
  for (ssize_t got = 1; got > 0;) {
    got = ::read(terminal, buffer.data(), buffer.size());
    if (got > 0) outcome.out.append(buffer.data(), static_cast<std::size_t>(got));
  }
  outcome.exit_code = wait_for(child);
  ::close(terminal);
  return outcome;
}

std::string dataset(const std::string& name) {
  return (fs::path(POISE_SOURCE_DIR) / "datasets" / (name + ".toml")).string();
}

std::string contents(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::string objection_to_xml(std::string_view text) {
  try {
    XmlReader(text).read();
    return "";
  } catch (const std::runtime_error& error) {
    return error.what();
  }
}

}  // namespace poise::app_tests
