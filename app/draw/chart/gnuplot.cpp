#include "app/draw/chart/gnuplot.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>
#include <stdexcept>
#include <vector>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/result/numbers.hpp"
#include "model/one_line.hpp"

namespace poise::app {
namespace {

/// An unnamed temporary file, deleted when it is closed.
class PassingFile {
 public:
  PassingFile() : file_(std::tmpfile()) {
    if (!file_) throw std::runtime_error(fmt::format("cannot make a temporary file: {}", std::strerror(errno)));
  }

  int descriptor() const { return ::fileno(file_.get()); }

  void write(const std::string& text) {
    const bool written = std::fwrite(text.data(), 1, text.size(), file_.get()) == text.size();
    if (!written || std::fflush(file_.get()) != 0) {
      throw std::runtime_error(fmt::format("cannot write a temporary file: {}", std::strerror(errno)));
    }
    std::rewind(file_.get());
  }

  std::string read() {
    std::string text;
    std::vector<char> buffer(1 << 16);
    std::rewind(file_.get());
    for (std::size_t got = 0; (got = std::fread(buffer.data(), 1, buffer.size(), file_.get())) > 0;) {
      text.append(buffer.data(), got);
    }
    return text;
  }

 private:
  struct Close {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  std::unique_ptr<std::FILE, Close> file_;
};

struct Ran {
  bool well = false;
  std::string out, message;
};

Ran run(std::vector<std::string> words, const std::string& input) {
  PassingFile in, out, message;
  in.write(input);
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  posix_spawn_file_actions_t streams;
  ::posix_spawn_file_actions_init(&streams);
  ::posix_spawn_file_actions_adddup2(&streams, in.descriptor(), STDIN_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, out.descriptor(), STDOUT_FILENO);
  ::posix_spawn_file_actions_adddup2(&streams, message.descriptor(), STDERR_FILENO);
  pid_t child = 0;
  const int error = ::posix_spawnp(&child, argv.front(), &streams, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&streams);
  if (error != 0) return {false, "", std::strerror(error)};
  int status = 0;
  while (::waitpid(child, &status, 0) < 0) {
    if (errno != EINTR) return {false, "", std::strerror(errno)};
  }
  return {WIFEXITED(status) && WEXITSTATUS(status) == 0, out.read(), message.read()};
}

/// The last line of what gnuplot wrote, which states the error: it repeats the command and points at it before.
std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of(" \n");
  if (end == std::string::npos) return "no reason given";
  const std::size_t begin = text.rfind('\n', end);
  return one_line(text.substr(begin == std::string::npos ? 0 : begin + 1, end - begin));
}

}  // namespace

bool has_gnuplot() { return run({"gnuplot", "--version"}, "").well; }

std::string run_gnuplot(const std::string& script) {
  Ran ran = run({"gnuplot", "--default-settings", "-"}, script);
  if (!ran.well) throw std::runtime_error("gnuplot failed: " + last_line(ran.message));
  return std::move(ran.out);
}

std::string gnuplot_string(const std::string& text) {
  std::string out = "'";
  for (char c : one_line(text)) {
    if (c == '\'')
      out += "’";
    else
      out += c;
  }
  return out + "'";
}

}  // namespace poise::app
