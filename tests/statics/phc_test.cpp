// Known sets of equilibria and assemblies against PHCpack, which shares nothing with Poise but the scene's polynomials.

#include "tests/support/phc.hpp"

#include <string>

#include <gtest/gtest.h>

#include "model/scene.hpp"
#include "statics/model/static_model.hpp"
#include "statics/proof/certificate.hpp"
#include "tests/support/known_answers.hpp"

namespace poise::phc_test {
namespace {

using test::dataset;

struct Count {
  const char* scene;
  int complex, real;
};

class Phc : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!test::has_phc()) GTEST_SKIP() << "phc (PHCpack) is not installed: cmake/setup.sh oracles";
  }
};

TEST_F(Phc, FindsTheEquilibriaOfKnownScenes) {
  for (const Count& known :
       {Count{"four_bar_gravity.toml", 12, 4}, Count{"thesis_four_bar.toml", 12, 2}, Count{"zeeman.toml", 16, 2}}) {
    const StaticModel model(read_scene(dataset(known.scene)));
    const test::PhcSolutions found = test::solve_with_phc(model);
    ASSERT_TRUE(found.ran) << known.scene;
    EXPECT_EQ(found.complex, known.complex) << known.scene;
    EXPECT_EQ(static_cast<int>(found.real.size()), known.real) << known.scene;
    for (const auto& x : found.real) EXPECT_TRUE(certify(model, x).confirmed()) << known.scene;
  }
}

TEST_F(Phc, FindsTheAssembliesOfAPlatform) {
  const StaticModel model(read_scene(dataset("assemblies/platform_on_legs.toml")));
  const test::PhcSolutions found = test::solve_with_phc(model, true);
  ASSERT_TRUE(found.ran);
  EXPECT_EQ(found.complex, 6);
  EXPECT_EQ(static_cast<int>(found.real.size()), 6);
}

TEST(PhcPolynomials, AreRefusedWhereAnAngleItselfCounts) {
  const StaticModel model(read_scene(dataset("four_bar_torsion.toml")));
  EXPECT_EQ(test::polynomials(model).why_not, "a spring acts on something else than a distance");
}

}  // namespace
}  // namespace poise::phc_test
