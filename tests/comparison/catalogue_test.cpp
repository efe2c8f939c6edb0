#include "comparison/catalogue.hpp"

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/comparison/toy_catalogue.hpp"

namespace poise::comparison::catalogue_test {
namespace {

using test::both_equilibria;
using test::toy_case;
using test::toy_equilibrium;
using test::ToyCatalogue;

// What reading throws, without the folder; empty where it does not.
std::string objection(const ToyCatalogue& catalogue) {
  try {
    catalogue.read();
  } catch (const InputError& error) {
    std::string text = error.what();
    const std::string folder = catalogue.path().string();
    for (std::size_t at = text.find(folder); at != std::string::npos; at = text.find(folder)) {
      text.erase(at, folder.size());
    }
    return text;
  }
  return "";
}

std::string objection_to(const std::string& cases) { return objection(ToyCatalogue(cases)); }

// Lines of toy_case: [[case]] is line 2 of the file, `rest` begins in line 7.
std::string objection_to_equilibrium(const std::string& equilibrium) {
  return objection_to(toy_case("toy", "pendulum", equilibrium));
}

TEST(Catalogue, ReadsAllKeys) {
  const ToyCatalogue catalogue(
      toy_case("first", "pendulum",
               "set = { \"load.P\" = 2.5, \"start.rod\" = 0.1 }\nseek = \"stable\"\nstarts = 20\nreach = 0.5\n"
               "complete = true\nturns_count = true\n" +
                   both_equilibria()) +
      toy_case("second", "runaway", "expect = \"none\"\nwhy = \"it runs away\"\n") +
      toy_case("third", "against_the_stop",
               "[[case.equilibrium]]\ntravels = { rail = 0.25 }\nstability = \"stable\"\n"));
  const std::vector<HardCase> cases = catalogue.read();
  ASSERT_EQ(cases.size(), 3U);
  const HardCase& first = cases[0];
  EXPECT_EQ(first.name, "first");
  EXPECT_EQ(first.kind, "Toys");
  EXPECT_EQ(first.title, "Toy");
  EXPECT_EQ(first.source, "ours");
  EXPECT_EQ(first.scene, (catalogue.path() / "pendulum.toml").lexically_normal().string());
  ASSERT_EQ(first.changes.size(), 2U);
  EXPECT_EQ(first.changes[0].path, "load.P");
  EXPECT_EQ(first.changes[0].value, 2.5);
  EXPECT_EQ(first.seek, Seek::stable);
  EXPECT_EQ(first.answer, KnownAnswer::equilibrium);
  EXPECT_EQ(first.starts, 20);
  EXPECT_EQ(first.reach, 0.5);
  EXPECT_TRUE(first.complete && first.turns_count && !first.everywhere);
  ASSERT_EQ(first.known.size(), 2U);
  EXPECT_EQ(first.known[0].angles.at("rod"), -1.5707963267948966);
  EXPECT_EQ(first.known[1].stability, Stability::unstable);
  const Scene scene = scene_of(first);
  EXPECT_EQ(scene.forces[0].vector.y, -2.5);
  EXPECT_EQ(scene.start.angle[1], 0.1);

  EXPECT_EQ(cases[1].answer, KnownAnswer::none);
  EXPECT_EQ(cases[1].why, "it runs away");
  EXPECT_EQ(cases[1].seek, Seek::any);
  EXPECT_EQ(cases[1].starts, 1000);
  EXPECT_EQ(cases[1].reach, 3.2);
  EXPECT_FALSE(cases[1].complete || cases[1].turns_count || cases[1].everywhere);
  EXPECT_EQ(cases[2].known[0].travels.at("rail"), 0.25);
}

TEST(Catalogue, ReadsSeries) {
  const ToyCatalogue catalogue(
      "[[case]]\nname = \"chain\"\ntitle = \"Chain\"\nsource = \"ours\"\nseries = \"hanging chain\"\nsize = 4\n");
  const HardCase hard = catalogue.read().at(0);
  EXPECT_TRUE(hard.scene.empty());
  EXPECT_EQ(scene_of(hard).bodies.size(), 5U);
}

TEST(Catalogue, KeepsTheOrderOfItsFiles) {
  const ToyCatalogue catalogue(toy_case("toy", "pendulum"));
  catalogue.folder().write("other.cases.toml", "kind = \"Others\"\n" + toy_case("other", "pendulum"));
  catalogue.folder().write("catalogue.toml", "files = [\"other.cases.toml\", \"toy.cases.toml\"]\n");
  const std::vector<HardCase> cases = catalogue.read();
  ASSERT_EQ(cases.size(), 2U);
  EXPECT_EQ(cases[0].kind, "Others");
  EXPECT_EQ(cases[1].name, "toy");
}

TEST(Catalogue, ReportsErrorsInItsList) {
  const ToyCatalogue catalogue(toy_case("toy", "pendulum"));
  const auto with_list = [&](const std::string& text) {
    catalogue.folder().write("catalogue.toml", text);
    return objection(catalogue);
  };
  EXPECT_EQ(with_list("file = []\n"), "catalogue.toml:1: file: expected only the key files; did you mean \"files\"?");
  EXPECT_EQ(with_list("files = []\n"),
            "catalogue.toml:1: files: expected at least one file of cases; add files = [\"...\"]");
  EXPECT_EQ(with_list("files = [\n 3]\n"), "catalogue.toml:2: files: expected a list of strings [\"...\", ...]");
  EXPECT_EQ(with_list("files = [\"toy.cases.toml\",\n \"none.toml\"]\n"),
            "catalogue.toml:2: files: expected a file of cases, relative to this file; there is no \"none.toml\"");
  EXPECT_EQ(with_list("files = [\"toy.cases.toml\", \"toy.cases.toml\"]\n"),
            "toy.cases.toml:3: case \"toy\".name: expected a name of its own, it is taken in toy.cases.toml:3; rename "
            "the case");
  EXPECT_THROW(read_catalogue(catalogue.path() / "nowhere"), InputError);
}

TEST(Catalogue, ReportsErrorsInAFileOfCases) {
  const ToyCatalogue catalogue("");
  const auto with_text = [&](const std::string& text) {
    catalogue.folder().write("toy.cases.toml", text);
    return objection(catalogue);
  };
  EXPECT_TRUE(with_text("kind = \n").starts_with("toy.cases.toml:1: TOML syntax: "));
  EXPECT_EQ(with_text("kind = \"Toys\"\n"), "toy.cases.toml:1: case: expected at least one case; add [[case]]");
  EXPECT_EQ(with_text(toy_case("toy", "pendulum")), "toy.cases.toml:1: expected the key kind; add kind = \"...\"");
  EXPECT_EQ(with_text("kind = \"\"\n" + toy_case("toy", "pendulum")), "toy.cases.toml:1: kind: expected some text");
  EXPECT_EQ(with_text("kind = \"Toys\"\ncases = 1\n"),
            "toy.cases.toml:2: cases: expected one of the keys kind, case; did you mean \"case\"?");
}

TEST(Catalogue, ReportsErrorsInACase) {
  EXPECT_EQ(objection_to("[[case]]\ntitle = \"Toy\"\n"),
            "toy.cases.toml:2: case 1: expected the key name; add name = \"...\"");
  EXPECT_EQ(objection_to("[[case]]\nname = \"toy\"\n"),
            "toy.cases.toml:2: case \"toy\": expected the key title; add title = \"...\"");
  EXPECT_EQ(objection_to("[[case]]\nname = \"toy\"\ntitle = \"Toy\"\n"),
            "toy.cases.toml:2: case \"toy\": expected the key source; add source = \"...\"");
  EXPECT_TRUE(objection_to("[[case]]\nname = \"\"\n").starts_with("toy.cases.toml:3: case \"\".name: expected"));
  EXPECT_EQ(objection_to(toy_case("toy", "pendulum") + toy_case("toy", "pendulum")),
            "toy.cases.toml:9: case \"toy\".name: expected a name of its own, it is taken in toy.cases.toml:3; rename "
            "the case");
  const std::string head = "[[case]]\nname = \"toy\"\ntitle = \"Toy\"\nsource = \"ours\"\n";
  EXPECT_EQ(objection_to(head), "toy.cases.toml:2: case \"toy\": expected one of the keys scene, series");
  EXPECT_EQ(objection_to(head + "scene = \"pendulum.toml\"\nseries = \"hanging chain\"\n"),
            "toy.cases.toml:2: case \"toy\": expected one of the keys scene, series");
  EXPECT_EQ(objection_to_equilibrium("stars = 10\n"),
            "toy.cases.toml:7: case \"toy\".stars: expected one of the keys name, title, source, scene, series, size, "
            "set, seek, expect, why, starts, reach, complete, turns_count, everywhere, equilibrium; did you mean "
            "\"starts\"?");
  EXPECT_EQ(objection_to_equilibrium("starts = 0\n"),
            "toy.cases.toml:7: case \"toy\".starts: expected a whole number from 1 to 2^53");
  EXPECT_EQ(objection_to_equilibrium("starts = 3000000000\n"),
            "toy.cases.toml:7: case \"toy\".starts: expected at most 2^31 - 1");
  EXPECT_EQ(objection_to_equilibrium("reach = -1\n"),
            "toy.cases.toml:7: case \"toy\".reach: expected a finite number >= 0, found -1");
  EXPECT_EQ(objection_to_equilibrium("seek = \"stabel\"\n"),
            "toy.cases.toml:7: case \"toy\".seek: expected one of nearest, stable, found \"stabel\"; did you mean "
            "\"stable\"?");
  EXPECT_EQ(objection_to_equilibrium("expect = \"nothing\"\n"),
            "toy.cases.toml:7: case \"toy\".expect: expected one of equilibrium, locked, none, found \"nothing\"");
  EXPECT_EQ(objection_to_equilibrium("complete = \"yes\"\n"),
            "toy.cases.toml:7: case \"toy\".complete: expected true or false, without quotes");
}

TEST(Catalogue, ReportsErrorsInAScene) {
  EXPECT_EQ(objection_to(toy_case("toy", "pendulums")),
            "toy.cases.toml:6: case \"toy\".scene: expected a scene file, relative to this file; there is no "
            "\"pendulums.toml\"");
  EXPECT_EQ(objection_to_equilibrium("size = 3\n"),
            "toy.cases.toml:7: case \"toy\".size: expected no size with a scene; series have one");
  EXPECT_EQ(objection_to_equilibrium("set = { \"load.Q\" = 1 }\n").substr(0, 50),
            "toy.cases.toml:7: case \"toy\".set: load.Q: expected");
  EXPECT_EQ(objection_to_equilibrium("set = { \"load.P\" = -1 }\n"),
            "toy.cases.toml:7: case \"toy\".set: load.P: expected a finite number >= 0, found -1");
  EXPECT_EQ(objection_to_equilibrium("set = { load.P = 1 }\n"),
            "toy.cases.toml:7: case \"toy\".set.load: expected a number; put the path in quotes: \"body.NAME.mass\" = "
            "2");
  const ToyCatalogue catalogue(toy_case("toy", "pendulum"));
  catalogue.folder().write("pendulum.toml", "title = 3\n");
  EXPECT_EQ(objection(catalogue).substr(0, 15), "pendulum.toml:1");
}

TEST(Catalogue, ReportsErrorsInASeries) {
  const std::string head = "[[case]]\nname = \"toy\"\ntitle = \"Toy\"\nsource = \"ours\"\n";
  EXPECT_EQ(objection_to(head + "series = \"hanging chains\"\nsize = 3\n"),
            "toy.cases.toml:6: case \"toy\".series: expected one of hanging chain, window ladder, balanced "
            "arms, truss beside pendulums, found \"hanging chains\"; did you mean \"hanging chain\"?");
  EXPECT_EQ(objection_to(head + "series = \"hanging chain\"\n"),
            "toy.cases.toml:2: case \"toy\": expected the key size with a series; add size = NUMBER");
  EXPECT_EQ(objection_to(head + "series = \"hanging chain\"\nsize = 0\n"),
            "toy.cases.toml:7: case \"toy\".size: expected a whole number from 1 to 2^53");
  EXPECT_EQ(objection_to(head + "series = \"hanging chain\"\nsize = 3\nset = { \"gravity.y\" = 1 }\n"),
            "toy.cases.toml:8: case \"toy\".set: expected no settings with a series; write a scene file");
}

TEST(Catalogue, ReportsErrorsInAnEquilibrium) {
  const auto with = [](const std::string& text) { return objection_to_equilibrium("[[case.equilibrium]]\n" + text); };
  const std::string at = "toy.cases.toml:7: case \"toy\".equilibrium 1: ";
  EXPECT_EQ(with("stability = \"stable\"\n"), at + "expected an angle or a travel; add angles = { BODY = NUMBER }");
  EXPECT_EQ(with("angles = { rod = 1 }\n"), at + "expected the key stability; add stability = \"...\"");
  EXPECT_EQ(with("angles = { rod = 1 }\nstability = \"firm\"\n"),
            "toy.cases.toml:9: case \"toy\".equilibrium 1.stability: expected one of stable, unstable, neutral, "
            "unknown, found \"firm\"");
  EXPECT_EQ(with("angle = { rod = 1 }\n"),
            "toy.cases.toml:8: case \"toy\".equilibrium 1.angle: expected one of the keys angles, travels, stability; "
            "did you mean \"angles\"?");
  EXPECT_TRUE(with("angles = { rods = 1 }\nstability = \"stable\"\n")
                  .starts_with("toy.cases.toml:8: case \"toy\".equilibrium 1.angles.rods: expected"));
  EXPECT_TRUE(with("angles = { rods = 1 }\nstability = \"stable\"\n").ends_with("did you mean \"rod\"?"));
  EXPECT_NE(with("angles = { ground = 1 }\nstability = \"stable\"\n"), "");
  EXPECT_NE(with("travels = { hinge = 1 }\nstability = \"stable\"\n"), "");
  EXPECT_EQ(with("angles = { rod = \"up\" }\nstability = \"stable\"\n"),
            "toy.cases.toml:8: case \"toy\".equilibrium 1.angles.rod: expected a number, found a string");
  EXPECT_EQ(with("angles = { a.b = 1 }\nstability = \"stable\"\n"),
            "toy.cases.toml:8: case \"toy\".equilibrium 1.angles.a: expected a number; put a name that holds dots in "
            "quotes");
}

TEST(Catalogue, RejectsContradictions) {
  const std::string none = "expect = \"none\"\n", locked = "expect = \"locked\"\n";
  const std::string why = "why = \"because\"\n";
  EXPECT_EQ(objection_to_equilibrium(none),
            "toy.cases.toml:2: case \"toy\": expected the key why, the reason to report; add why = \"...\"");
  for (const std::string& expect : {none, locked}) {
    EXPECT_EQ(objection_to_equilibrium(expect + why), "");
    EXPECT_TRUE(objection_to_equilibrium(expect + why + both_equilibria()).ends_with("remove it or the key expect"));
    EXPECT_TRUE(objection_to_equilibrium(expect + why + "complete = true\n").ends_with("remove it or the key expect"));
    EXPECT_TRUE(
        objection_to_equilibrium(expect + why + "everywhere = true\n").ends_with("remove it or the key expect"));
  }
  EXPECT_EQ(objection_to_equilibrium(why),
            "toy.cases.toml:7: case \"toy\".why: expected no such key in a case with an equilibrium; it gives the "
            "reason why there is none");
  EXPECT_EQ(objection_to_equilibrium("complete = true\n"),
            "toy.cases.toml:7: case \"toy\".complete: expected an equilibrium in a complete list; add "
            "[[case.equilibrium]]");
  EXPECT_EQ(
      objection_to_equilibrium("complete = true\nseek = \"stable\"\n" + toy_equilibrium("rod", "1.5", "unstable")),
      "toy.cases.toml:8: case \"toy\".seek: expected at least one equilibrium in the list that is not "
      "unstable");
  EXPECT_EQ(objection_to_equilibrium("everywhere = true\ncomplete = true\n"),
            "toy.cases.toml:8: case \"toy\".complete: expected no such key if every closed position is an equilibrium");
  EXPECT_NE(objection_to_equilibrium("everywhere = true\n" + both_equilibria()), "");
}

}  // namespace
}  // namespace poise::comparison::catalogue_test
