#pragma once

#include <string>
#include <vector>

#include "comparison/case_check.hpp"
#include "comparison/stress.hpp"

namespace poise::comparison {

/// Adds up the verdicts on one method.
class Tally {
 public:
  explicit Tally(Method method) { cell_.method = method; }

  void does_not_apply(const std::string& why);
  void add(const Equilibrium& equilibrium, const Verdict& verdict);

  int starts() const { return cell_.starts; }
  Cell cell() const;

 private:
  void add_converged(const Equilibrium& equilibrium, const Verdict& verdict);

  Cell cell_;
  std::vector<double> iterations_, microseconds_;
};

}  // namespace poise::comparison
