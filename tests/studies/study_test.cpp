#include "studies/study.hpp"

#include <atomic>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "model/input_error.hpp"
#include "solvers/random_stream.hpp"
#include "studies/fingerprint.hpp"
#include "tests/app/run_poise.hpp"

namespace poise::studies::study_test {
namespace {

namespace fs = std::filesystem;
using app_tests::contents;
using app_tests::TempFolder;

Study example(std::uint64_t samples = 50) {
  Study study;
  study.name = "example";
  study.identity = {{"seed", "5"}, {"noise", "0.1"}};
  study.columns = {"normal", "uniform, \"quoted\""};
  study.samples = samples;
  study.compute = [](std::uint64_t sample) {
    solvers::RandomStream random(5, 0, sample);
    return std::vector<double>{random.normal(), sample == 7 ? NAN : random.uniform()};
  };
  return study;
}

/// What run_study() has found: sums, whose bits depend on the order, and how it ended.
struct Found {
  double sum = 0.0;
  std::vector<std::uint64_t> samples;
  StudyOutcome outcome;
};

Found found(const Study& study, const StudyOptions& options) {
  Found out;
  out.outcome = run_study(study, options, [&](std::uint64_t sample, const double* row) {
    out.samples.push_back(sample);
    out.sum = 1.1 * out.sum + row[0] + (sample == 7 ? 0.0 : row[1]);
  });
  return out;
}

std::string objection(const Study& study, const StudyOptions& options) {
  try {
    found(study, options);
    return "";
  } catch (const InputError& error) {
    return error.what();
  }
}

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(Study, ChunksDependOnTheSamplesAlone) {
  EXPECT_EQ(example(1).chunk(), 1U);
  EXPECT_EQ(example(2047).chunk(), 1U);
  EXPECT_EQ(example(10'000).chunk(), 9U);
  EXPECT_EQ(example(1'000'000).chunk(), 64U);
}

TEST(Study, DoesNotDependOnThreads) {
  const Study study = example(5000);
  const Found alone = found(study, {.jobs = 1});
  EXPECT_EQ(alone.outcome.asked, 5000U);
  EXPECT_EQ(alone.outcome.done, 5000U);
  EXPECT_EQ(alone.outcome.computed, 5000U);
  EXPECT_FALSE(alone.outcome.interrupted);
  for (std::uint64_t k = 0; k < 5000; ++k) ASSERT_EQ(alone.samples[k], k);
  for (const int jobs : {2, 4}) {
    const Found shared = found(study, {.jobs = jobs});
    EXPECT_EQ(shared.samples, alone.samples);
    EXPECT_EQ(shared.sum, alone.sum);
  }
}

TEST(Study, ThrowsWhatTheLowestSampleThrew) {
  Study study = example();
  study.compute = [](std::uint64_t sample) -> std::vector<double> {
    if (sample >= 20) throw std::runtime_error("sample " + std::to_string(sample));
    return {0.0, 0.0};
  };
  for (const int jobs : {1, 3}) {
    try {
      found(study, {.jobs = jobs});
      FAIL() << "nothing thrown";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "sample 20");
    }
  }
}

TEST(Study, InterruptKeepsWhatIsDone) {
  for (const bool has_folder : {false, true}) {
    const TempFolder folder;
    std::atomic<bool> stop = false;
    StudyOptions options;
    options.jobs = 2;
    options.interrupt = &stop;
    if (has_folder) options.folder = folder.path("study");
    options.progress = [&](std::uint64_t done) {
      if (done == 10) stop = true;
    };
    const Found part = found(example(), options);
    EXPECT_TRUE(part.outcome.interrupted);
    EXPECT_GE(part.outcome.done, 9U);
    EXPECT_LT(part.outcome.done, 50U);
    EXPECT_EQ(part.samples.size(), part.outcome.done);
    if (!has_folder) continue;
    const Found rest = found(example(), {.folder = options.folder, .resume = true});
    EXPECT_EQ(rest.outcome.computed, 50 - part.outcome.done);
    EXPECT_EQ(rest.sum, found(example(), {}).sum);
  }
}

// Processes that are threads.
class Switchboard {
 public:
  explicit Switchboard(int size) : boxes_(static_cast<std::size_t>(size)) {}

  class Rank : public Ranks {
   public:
    Rank(Switchboard& all, int rank) : all_(all), rank_(rank) {}
    int rank() const override { return rank_; }
    int size() const override { return static_cast<int>(all_.boxes_.size()); }
    void send(int to, const std::string& bytes) override {
      const std::scoped_lock lock(all_.mutex_);
      all_.boxes_[static_cast<std::size_t>(to)].push_back({rank_, bytes});
    }
    std::optional<Message> receive() override {
      const std::scoped_lock lock(all_.mutex_);
      auto& box = all_.boxes_[static_cast<std::size_t>(rank_)];
      if (box.empty()) return std::nullopt;
      Message message = box.front();
      box.pop_front();
      return message;
    }

   private:
    Switchboard& all_;
    int rank_;
  };

 private:
  std::mutex mutex_;
  std::vector<std::deque<Ranks::Message>> boxes_;
};

/// The study on ranks that have two threads each; `study_of` and `options` are those of a rank.
Found found_by_ranks(int size, const std::function<Study(int)>& study_of, const StudyOptions& options) {
  Switchboard switchboard(size);
  const auto as_rank = [&](int rank) {
    Switchboard::Rank self(switchboard, rank);
    StudyOptions own = options;
    own.jobs = 2;
    own.ranks = &self;
    return found(study_of(rank), own);
  };
  std::vector<std::jthread> others;
  for (int rank = 1; rank < size; ++rank) {
    others.emplace_back([&, rank] { EXPECT_TRUE(as_rank(rank).samples.empty()); });
  }
  return as_rank(0);
}

TEST(Study, DoesNotDependOnRanks) {
  const auto study = [](int) { return example(3000); };
  const Found alone = found(study(0), {.jobs = 1});
  for (const int ranks : {1, 2, 4}) {
    const TempFolder folder;
    for (const std::string& files : {std::string(), folder.path("study").string()}) {
      const Found shared = found_by_ranks(ranks, study, {.folder = files});
      EXPECT_EQ(shared.samples, alone.samples);
      EXPECT_EQ(shared.sum, alone.sum);
      EXPECT_EQ(shared.outcome.computed, 3000U);
    }
  }
}

TEST(Study, AFailureOnAnyRankEndsAll) {
  const auto failing = [](int) {
    Study study = example();
    study.compute = [](std::uint64_t sample) -> std::vector<double> {
      if (sample == 3) throw std::runtime_error("sample 3 failed");
      return {0.0, 0.0};
    };
    return study;
  };
  try {
    found_by_ranks(3, failing, {});
    FAIL() << "nothing thrown";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "sample 3 failed");
  }
  const TempFolder folder;
  folder.write("study.csv", "something else\n");
  EXPECT_THROW(found_by_ranks(3, failing, {.folder = folder.path("").string()}), InputError);
}

TEST(Study, RanksMustHaveTheSameStudy) {
  const auto study_of = [](int rank) {
    Study study = example();
    if (rank == 2) study.identity[0].second = "6";
    return study;
  };
  try {
    found_by_ranks(3, study_of, {});
    FAIL() << "nothing thrown";
  } catch (const InputError& error) {
    EXPECT_TRUE(has(error.what(), "rank 2 was given another study")) << error.what();
  }
}

std::string text_of(const fs::path& file) { return contents(file); }

void write(const fs::path& file, const std::string& text) { std::ofstream(file, std::ios::binary) << text; }

// A process that is killed has written a part of its last record, of any length.
TEST(StudyFolder, ATornEndIsComputedAgain) {
  const TempFolder folder;
  const std::string place = folder.path("study").string();
  const Found whole = found(example(), {.folder = place});
  const fs::path file = fs::path(place) / "study.csv";
  const std::string text = text_of(file);
  std::uint64_t last = 0;
  for (std::size_t keep = text.size(); keep > 0; keep -= std::min<std::size_t>(keep, 37)) {
    SCOPED_TRACE(keep);
    write(file, text.substr(0, keep));
    const Found again = found(example(), {.jobs = 1, .folder = place, .resume = true});
    EXPECT_EQ(again.sum, whole.sum);
    EXPECT_TRUE(again.outcome.warnings.empty());
    EXPECT_EQ(text_of(file).size(), text.size());
    EXPECT_GE(again.outcome.computed, last);
    last = again.outcome.computed;
  }
  EXPECT_EQ(last, 50U);
}

TEST(StudyFolder, ADamagedByteIsFound) {
  const TempFolder folder;
  const std::string place = folder.path("study").string();
  const Found whole = found(example(), {.jobs = 1, .folder = place});
  const fs::path file = fs::path(place) / "study.csv";
  const std::string text = text_of(file);
  const std::size_t header = text.find('\n', text.find("# header")) + 1;
  for (std::size_t at = 0; at < text.size(); at += 13) {
    SCOPED_TRACE(at);
    std::string damaged = text;
    damaged[at] = static_cast<char>(damaged[at] ^ 4);
    write(file, damaged);
    if (at < header) {
      EXPECT_NE(objection(example(), {.folder = place, .resume = true}), "");
      continue;
    }
    const Found again = found(example(), {.folder = place, .resume = true});
    EXPECT_EQ(again.sum, whole.sum);
    EXPECT_GE(again.outcome.computed, 1U);
    // A last line that is damaged is no last line: its chunk and the next one are lost.
    EXPECT_LE(again.outcome.computed, 2U);
    const bool is_torn = at >= text.rfind("# chunk");
    if (!is_torn) {
      ASSERT_FALSE(again.outcome.warnings.empty());
      EXPECT_TRUE(has(again.outcome.warnings[0], "is damaged (its checksum is wrong)")) << again.outcome.warnings[0];
    }
  }
}

TEST(StudyFolder, RefusesAnotherStudy) {
  const TempFolder folder;
  const std::string place = folder.path("study").string();
  found(example(), {.folder = place});
  EXPECT_TRUE(has(objection(example(), {.folder = place}), "exists already; expected a new folder, or --resume"));
  Study other = example();
  other.identity[0].second = "6";
  EXPECT_TRUE(has(objection(other, {.folder = place, .resume = true}),
                  "belongs to another study, with \"seed = 5\" where this one has \"seed = 6\""))
      << objection(other, {.folder = place, .resume = true});
  other = example();
  other.identity.pop_back();
  EXPECT_TRUE(
      has(objection(other, {.folder = place, .resume = true}), "\"noise = 0.1\" where this one has \"chunk = 1\""));
  write(fs::path(place) / "study.csv", "time,angle\n1,2\n");
  EXPECT_TRUE(has(objection(example(), {.folder = place, .resume = true}), "its header is damaged"));
  EXPECT_TRUE(has(objection(example(), {.folder = folder.write("file", "")}), "expected a folder"));
}

// A link that leads nowhere, one to a device, and a pipe, which would wait for a writer.
TEST(StudyFolder, RefusesWhatIsNoFile) {
  for (const char* name : {"study.csv", "shard-2-of-3.csv"}) {
    const TempFolder folder;
    const fs::path place = folder.path(name);
    const StudyOptions options{.folder = folder.path(".").string(), .resume = true};
    fs::create_symlink("nowhere", place);
    EXPECT_TRUE(has(objection(example(), options), "a link that leads nowhere")) << objection(example(), options);
    EXPECT_FALSE(fs::exists(folder.path("nowhere")));
    fs::remove(place);
    fs::create_symlink("/dev/full", place);
    EXPECT_TRUE(has(objection(example(), options), "a device or a pipe"));
    fs::remove(place);
    ASSERT_EQ(::mkfifo(place.c_str(), 0600), 0);
    EXPECT_TRUE(has(objection(example(), options), "a device or a pipe"));
  }
}

TEST(StudyFolder, OneProcessAtATimeWrites) {
  const TempFolder folder;
  const std::string place = folder.path("study").string();
  Study study = example();
  std::string refused;
  std::once_flag once;
  study.compute = [&, compute = study.compute](std::uint64_t sample) {
    std::call_once(once, [&] { refused = objection(example(), {.folder = place, .resume = true}); });
    return compute(sample);
  };
  found(study, {.folder = place});
  EXPECT_TRUE(has(refused, "another poise is writing it")) << refused;
}

TEST(StudyFolder, ShardsMeet) {
  const TempFolder folder;
  const std::string place = folder.path("study").string();
  const Found whole = found(example(), {});
  std::uint64_t sum = 0;
  for (const std::uint64_t shard : {2U, 1U}) {
    const Found part = found(example(), {.folder = place, .shard = shard, .shards = 3});
    EXPECT_EQ(part.outcome.asked, 17U);
    EXPECT_EQ(part.outcome.done, 17U);
    for (const std::uint64_t sample : part.samples) EXPECT_EQ(sample % 3, shard - 1);
    sum += part.outcome.computed;
  }
  EXPECT_NE(objection(example(), {.folder = place, .shard = 2, .shards = 3}), "") << "it is there already";
  // What no shard has is computed; the whole is that of one run.
  const Found merged = found(example(), {.folder = place, .resume = true});
  EXPECT_EQ(merged.outcome.computed, 50 - sum);
  EXPECT_EQ(merged.sum, whole.sum);
  EXPECT_EQ(merged.samples, whole.samples);
  const Found third = found(example(), {.folder = place, .shard = 3, .shards = 3});
  EXPECT_EQ(third.outcome.computed, 0U);
  EXPECT_EQ(third.outcome.done, 16U);
  fs::remove(fs::path(place) / "study.csv");
  found(example(), {.folder = place, .shard = 3, .shards = 3});
  const Found read = found(example(), {.folder = place, .resume = true});
  EXPECT_EQ(read.outcome.computed, 0U);
  EXPECT_EQ(read.sum, whole.sum);
}

TEST(Fingerprint, FollowsContentsAndWords) {
  const TempFolder folder;
  const fs::path a = folder.write("a", "one"), b = folder.write("b", "two"), copy = folder.write("copy", "one");
  const std::string first = fingerprint({a, b}, {"k=1"});
  EXPECT_EQ(first.size(), 16U);
  EXPECT_EQ(fingerprint({copy, b}, {"k=1"}), first);
  EXPECT_NE(fingerprint({b, a}, {"k=1"}), first);
  EXPECT_NE(fingerprint({a, b}, {"k=2"}), first);
  EXPECT_NE(fingerprint({a}, {"two", "k=1"}), fingerprint({a, b}, {"k=1", ""}));
  EXPECT_THROW(fingerprint({folder.path("none")}, {}), InputError);
}

}  // namespace
}  // namespace poise::studies::study_test
