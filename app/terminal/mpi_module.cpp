#include "app/terminal/mpi_module.hpp"

#include <chrono>
#include <exception>
#include <memory>
#include <thread>

#include <mpi.h>

namespace poise::app {
namespace {

/// Calls MPI by its second names, PMPI_: the sequential MUMPS that Ipopt brings has functions of its own under some of
/// the first ones, MPI_Comm_rank for example.
class MpiRanks : public studies::Ranks {
 public:
  MpiRanks() {
    int provided = 0;
    // The thread that runs a study is the only one that sends and receives.
    PMPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    PMPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    PMPI_Comm_size(MPI_COMM_WORLD, &size_);
  }

  ~MpiRanks() override {
    if (std::uncaught_exceptions() == 0) {
      PMPI_Finalize();
    } else if (rank_ != 0) {
      // All ranks find the same mistake in the input. Rank 0 says so, and its end is that of the others; where it found
      // none, this one still has its say.
      std::this_thread::sleep_for(std::chrono::seconds(1));
    }
  }
  MpiRanks(const MpiRanks&) = delete;
  MpiRanks& operator=(const MpiRanks&) = delete;

  int rank() const override { return rank_; }
  int size() const override { return size_; }

  void send(int to, const std::string& bytes) override {
    PMPI_Send(bytes.data(), static_cast<int>(bytes.size()), MPI_BYTE, to, 0, MPI_COMM_WORLD);
  }

  std::optional<Message> receive() override {
    int has_arrived = 0;
    MPI_Status status;
    PMPI_Iprobe(MPI_ANY_SOURCE, 0, MPI_COMM_WORLD, &has_arrived, &status);
    if (has_arrived == 0) return std::nullopt;
    int count = 0;
    PMPI_Get_count(&status, MPI_BYTE, &count);
    Message message{status.MPI_SOURCE, std::string(static_cast<std::size_t>(count), '\0')};
    PMPI_Recv(message.bytes.data(), count, MPI_BYTE, message.from, 0, MPI_COMM_WORLD, MPI_STATUS_IGNORE);
    return message;
  }

  int ranks_on_this_machine() const {
    MPI_Comm here = MPI_COMM_NULL;
    PMPI_Comm_split_type(MPI_COMM_WORLD, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &here);
    int count = 1;
    PMPI_Comm_size(here, &count);
    PMPI_Comm_free(&here);
    return count;
  }

 private:
  int rank_ = 0, size_ = 1;
};

}  // namespace
}  // namespace poise::app

poise::studies::Ranks* poise_join_mpi(int* ranks_on_this_machine) {
  auto ranks = std::make_unique<poise::app::MpiRanks>();
  *ranks_on_this_machine = ranks->ranks_on_this_machine();
  return ranks.release();
}
