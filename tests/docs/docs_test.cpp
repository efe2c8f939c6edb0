// Runs every fenced block of README.md and docs/*.md and compares what it prints with what the page shows.
//
//   ```console   lines "$ COMMAND", continued on lines "> ...", each followed by its output, where "..." stands for
//                any lines. poise and build/poise are the built program; the commands of a page share one working
//                folder with a copy of datasets/. `make TARGET` is only looked up.
//                <!-- exits: N -->: the exit code of the last command, 0 by default
//                <!-- slow -->: runs only where POISE_SLOW_DOCS is set
//                <!-- benchmark -->: a program of benchmarks/, never run: no two runs print the same
//   ```toml      <!-- file: NAME -->: a whole file, read and saved for the commands that follow
//                <!-- added to: NAME -->: the same, saved at the end of that file
//                <!-- fragment of: NAME -->: read at the end of that scene, not saved
//   ```cpp       <!-- program: NAME -->: compiled by tests/CMakeLists.txt, runs as build/NAME
//   ```text      formulas and drawings
//   ```python    cells of notebooks, and
//   ```output    what they print: run by tests/python/test_docs.py
//
// Any other block fails. With POISE_UPDATE_DOCS set, the pages are rewritten with what the commands print now.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <map>
#include <regex>
#include <set>

#include <gtest/gtest.h>
#include <sys/wait.h>

#include "design/goals/goal_problem.hpp"
#include "identification/experiment/experiment.hpp"
#include "model/scene.hpp"
#include "motion/design.hpp"
#include "tests/app/run_poise.hpp"
#include "tests/docs/output.hpp"
#include "tests/docs/page.hpp"

namespace poise::docs_tests::docs_test {
namespace {

namespace fs = std::filesystem;
using app_tests::contents;
using app_tests::ProgramRun;
using app_tests::run_poise;
using app_tests::TempFolder;

const fs::path source = POISE_SOURCE_DIR;

bool is_set(const char* variable) { return std::getenv(variable) != nullptr; }

std::vector<std::string> all_pages() {
  std::vector<std::string> out = {"README.md"};
  for (const auto& entry : fs::directory_iterator(source / "docs")) {
    if (entry.path().extension() == ".md") out.push_back("docs/" + entry.path().filename().string());
  }
  std::sort(out.begin(), out.end());
  return out;
}

/// A folder in which the commands of a page work as in the project's own.
class Workplace {
 public:
  Workplace() {
    // A copy: commands of the pages may change their files.
    fs::copy(source / "datasets", folder_.path("datasets"), fs::copy_options::recursive);
    fs::create_directory(folder_.path("build"));
    fs::create_symlink(POISE_EXECUTABLE, folder_.path("build") / "poise");
    for (const auto& entry : fs::directory_iterator(POISE_DOCS_PROGRAMS)) {
      if (!entry.path().has_extension())
        fs::create_symlink(entry.path(), folder_.path("build") / entry.path().filename());
    }
  }

  fs::path path(const std::string& name) const { return folder_.path(name); }

  void save(const std::string& name, const std::string& text) const {
    fs::create_directories(path(name).parent_path());
    std::ofstream(path(name)) << text;
  }

  /// Standard output and error together, in the order in which they come.
  ProgramRun run(const std::string& command) const {
    const std::string line =
        "cd '" + folder_.path("").string() + "' && PATH=\"$PWD/build:$PATH\" && { " + command + "\n} 2>&1";
    FILE* pipe = ::popen(line.c_str(), "r");
    ProgramRun out;
    std::array<char, 4096> buffer{};
    for (std::size_t got = 1; got > 0;) {
      got = std::fread(buffer.data(), 1, buffer.size(), pipe);
      out.out.append(buffer.data(), got);
    }
    const int status = ::pclose(pipe);
    out.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    return out;
  }

 private:
  TempFolder folder_;
};

/// Goes through the blocks of one page in their order.
class Walk {
 public:
  Walk(const fs::path& file, bool slow) : page_(read_page(file)), slow_(slow) {}

  void run() {
    for (const Block& block : page_.blocks) {
      SCOPED_TRACE(page_.file.filename().string() + ":" + std::to_string(block.line));
      try {
        run(block);
      } catch (const std::exception& error) {
        ADD_FAILURE() << error.what();
      }
    }
    if (!updates_.empty()) write_page();
  }

  int not_run() const { return not_run_; }

 private:
  struct Update {
    std::size_t line, size;
    std::vector<std::string> output;
  };

  void run(const Block& block) {
    if (block.kind == "console") {
      run_commands(block);
    } else if (block.kind == "toml") {
      read_toml(block);
    } else if (block.kind == "cpp") {
      compare_program(block);
    } else if (block.kind == "text" || block.kind == "python" || block.kind == "output") {
      std::cout << page_.file.filename().string() << ":" << block.line << ": " << block.kind << '\n';
    } else {
      ADD_FAILURE() << "expected a block of console, toml, cpp, text, python or output, found \"" << block.kind << "\"";
    }
  }

  void run_commands(const Block& block) {
    if (block.has("benchmark") || (block.has("slow") && !slow_)) {
      std::cout << page_.file.filename().string() << ":" << block.line << ": not run: " << block.lines.front() << '\n';
      ++not_run_;
      return;
    }
    const std::vector<Command> commands = commands_of(block);
    for (const Command& command : commands) {
      const bool fails = &command == &commands.back() && block.has("exits");
      const bool is_make = command.text.starts_with("make ");
      const ProgramRun outcome = workplace_.run(
          is_make ? "make -n -C '" + source.string() + "' " + command.text.substr(5) + " > /dev/null" : command.text);
      EXPECT_EQ(outcome.exit_code, fails ? std::stoi(block.mark("exits")) : 0) << command.text << '\n' << outcome.out;
      compare(block, command, split_lines(outcome.out));
    }
  }

  void compare(const Block& block, const Command& command, const std::vector<std::string>& printed) {
    const std::string why = difference(command.output, printed);
    if (why.empty()) return;
    if (is_set("POISE_UPDATE_DOCS")) {
      updates_.push_back({block.line + command.output_line, command.output.size(), cut_like(command.output, printed)});
    } else {
      ADD_FAILURE() << "$ " << command.text << '\n' << why << "\nall of it:\n" << join_lines(printed);
    }
  }

  void read_toml(const Block& block) {
    if (const std::string frame = block.mark("fragment of"); !frame.empty()) {
      parse_scene(contents(workplace_.path(frame)) + '\n' + block.text(), frame);
      return;
    }
    const bool adds = block.has("added to");
    const std::string name = block.mark(adds ? "added to" : "file");
    if (name.empty()) throw std::runtime_error("a toml block needs <!-- file: NAME --> or another mark with a name");
    const std::string text = (adds ? contents(workplace_.path(name)) + '\n' : "") + block.text();
    workplace_.save(name, text);
    if (text.find("[[sensor]]") != std::string::npos) {
      EXPECT_FALSE(read_experiment(workplace_.path(name)).sensors.empty());
    } else if (text.find("[[goal]]") != std::string::npos) {
      EXPECT_FALSE(read_goals(workplace_.path(name)).goals.empty());
    } else if (text.find("[variables]") != std::string::npos) {
      EXPECT_FALSE(read_design(workplace_.path(name)).variables.empty());
    } else if (text.find("[[case]]") == std::string::npos && !text.starts_with("files = ") &&
               text.find("[tolerances]") == std::string::npos) {
      // Catalogues are read as a whole, by `poise stress`, and tolerances with their scene.
      EXPECT_FALSE(read_scene(workplace_.path(name)).bodies.empty());
    }
  }

  void compare_program(const Block& block) {
    const std::string name = block.mark("program");
    if (name.empty()) throw std::runtime_error("a cpp block needs <!-- program: NAME -->");
    EXPECT_EQ(contents(fs::path(POISE_DOCS_PROGRAMS) / (name + ".cpp")), block.text()) << "build the tests again";
    EXPECT_TRUE(fs::exists(workplace_.path("build") / name));
  }

  void write_page() const {
    std::vector<std::string> lines;
    std::size_t next = 0;
    for (const Update& update : updates_) {
      lines.insert(lines.end(), page_.lines.begin() + static_cast<std::ptrdiff_t>(next),
                   page_.lines.begin() + static_cast<std::ptrdiff_t>(update.line));
      lines.insert(lines.end(), update.output.begin(), update.output.end());
      next = update.line + update.size;
    }
    lines.insert(lines.end(), page_.lines.begin() + static_cast<std::ptrdiff_t>(next), page_.lines.end());
    std::ofstream(page_.file) << join_lines(lines);
    std::cout << page_.file.string() << ": " << updates_.size() << " outputs rewritten\n";
  }

  Page page_;
  bool slow_;
  Workplace workplace_;
  std::vector<Update> updates_;
  int not_run_ = 0;
};

TEST(DocsPrograms, SayHowTheyAreCalled) {
  const Workplace workplace;
  for (const std::string name : {"example", "many"}) {
    const ProgramRun run = workplace.run("build/" + name);
    EXPECT_EQ(run.exit_code, 2) << name;
    EXPECT_EQ(run.out, "usage: " + name + " SCENE.toml\n");
  }
}

class Docs : public testing::TestWithParam<std::string> {};

TEST_P(Docs, PrintWhatTheyShow) { Walk(source / GetParam(), false).run(); }

TEST_P(Docs, SlowCommandsPrintWhatTheyShow) {
  const Page page = read_page(source / GetParam());
  const auto is_left_out = [](const Block& block) { return block.has("slow") || block.has("benchmark"); };
  const auto left_out = std::count_if(page.blocks.begin(), page.blocks.end(), is_left_out);
  if (left_out == 0) return;
  if (!is_set("POISE_SLOW_DOCS")) GTEST_SKIP() << left_out << " slow blocks or benchmarks: set POISE_SLOW_DOCS";
  Walk walk(source / GetParam(), true);
  walk.run();
  if (walk.not_run() > 0) GTEST_SKIP() << walk.not_run() << " benchmarks are never run";
}

TEST_P(Docs, LinksLeadSomewhere) {
  const Page page = read_page(source / GetParam());
  for (const std::string& link : page.links) {
    if (link.starts_with("http")) continue;
    const std::size_t hash = link.find('#');
    const fs::path target = hash == 0 ? page.file : page.file.parent_path() / link.substr(0, hash);
    EXPECT_TRUE(fs::exists(target)) << link;
    if (hash == std::string::npos || !fs::exists(target)) continue;
    const std::vector<std::string> anchors = read_page(target).anchors;
    EXPECT_NE(std::find(anchors.begin(), anchors.end(), link.substr(hash + 1)), anchors.end()) << link;
  }
}

/// Commands and options that the text names in passing, `poise motion --csv FILE`, exist.
TEST_P(Docs, InlineCommandsExist) {
  static const std::regex inline_command(R"(^(build/)?poise ([a-z]+)( .*)?$)");
  static const std::regex option(R"(--[a-z][a-z-]*)");
  std::map<std::string, std::string> help;
  for (const std::string& code : read_page(source / GetParam()).inline_code) {
    std::smatch match;
    if (!std::regex_match(code, match, inline_command)) continue;
    const std::string command = match[2].str();
    if (!help.contains(command)) help[command] = run_poise({command, "--help"}).out;
    EXPECT_NE(help[command].find("poise " + command), std::string::npos) << code;
    const std::string rest = match[3].str();
    for (std::sregex_iterator it(rest.begin(), rest.end(), option); it != std::sregex_iterator(); ++it) {
      EXPECT_NE(help[command].find(it->str()), std::string::npos) << code << ": no option " << it->str();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Pages, Docs, testing::ValuesIn(all_pages()), [](const auto& page) {
  std::string name = fs::path(page.param).stem().string();
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

}  // namespace
}  // namespace poise::docs_tests::docs_test
