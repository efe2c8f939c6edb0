#include "comparison/agreement.hpp"

#include <gtest/gtest.h>

#include "tests/support/known_answers.hpp"

namespace poise::comparison::agreement_test {
namespace {

Answer found_from(const StaticModel& model, Method method, Seek seek) {
  SolveOptions options;
  options.method = method;
  options.seek = seek;
  return measure(model, solve(model, assemble(model), options));
}

TEST(Agreement, GroupsAnswersByEquilibrium) {
  const StaticModel model(read_scene(test::dataset("inverted_pendulum_torsion.toml")));
  const Answer first = found_from(model, Method::virtual_work, Seek::stable);
  const Answer second = found_from(model, Method::energy, Seek::stable);
  ASSERT_TRUE(first.equilibrium.found() && second.equilibrium.found());
  ASSERT_TRUE(error_of(first).has_value());
  EXPECT_LT(*error_of(first), 1e-12);
  const Agreement one = compare_answers(model, {first, Answer{}, second});
  EXPECT_EQ(one.confirmed, 2);
  EXPECT_TRUE(one.same);
  EXPECT_EQ(one.equilibria, (std::vector<std::vector<std::size_t>>{{0, 2}}));
  EXPECT_LT(one.difference, 1e-6);

  Answer elsewhere = first;
  elsewhere.equilibrium.reached.front() += 0.1;
  elsewhere.equilibrium.certificate.x.front() += 0.1;
  const Agreement two = compare_answers(model, {first, elsewhere});
  EXPECT_FALSE(two.same);
  EXPECT_EQ(two.equilibria, (std::vector<std::vector<std::size_t>>{{0}, {1}}));
  EXPECT_NEAR(two.difference, 0.1, 1e-12);
  EXPECT_EQ(two.coordinate, model.layout().coordinates.front().name);
}

TEST(Agreement, AnAnswerOfAMethodThatDoesNotApplyHasNoReadings) {
  const StaticModel model(read_scene(test::dataset("inverted_pendulum_torsion.toml")));
  Equilibrium refused;
  refused.status = Status::not_applicable;
  const Answer answer = measure(model, refused);
  EXPECT_FALSE(answer.readings.has_value());
  EXPECT_FALSE(error_of(answer).has_value());
}

}  // namespace
}  // namespace poise::comparison::agreement_test
