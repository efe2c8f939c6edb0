#pragma once

#include <compare>
#include <map>
#include <string>
#include <vector>

#include "model/layout.hpp"
#include "model/scene.hpp"

namespace poise {

/// A function of the pose that vectors of a mechanism are made of: exp(i angle), 1 where there is no angle, times a
/// length where there is one. Indices of coordinates, -1 for none.
struct Phasor {
  int length = -1, angle = -1;

  friend auto operator<=>(const Phasor&, const Phasor&) = default;
};

/// A plane vector as a sum of coefficients times phasors, m.
using PhasorTerms = std::map<Phasor, Vec2>;

/// a + factor b.
PhasorTerms sum(PhasorTerms a, const PhasorTerms& b, double factor = 1.0);

/// The angle of a body as that of a coordinate and a constant, rad; the constant alone where the coordinate is -1.
struct AngleForm {
  int coordinate = -1;
  double constant = 0.0;
};

/// The poses of a scene's bodies in closed form, in coordinates that its joints leave: angles of frames (bodies that
/// slides and welds keep parallel share one) and travels. Bodies that a parallelogram keeps parallel share one too: of
/// a loop of four vectors of which two and two have the same length, and are opposite in the assembled start, the
/// angles of these are equal for good, unless the loop changes to its crossed assembly where it is flat. Other loops
/// are closures, sums of terms that are zero.
class PoseForm {
 public:
  /// Throws InputError where parts of the scene have no such form (gears and other couplings, links that bend), or
  /// where its loops do not close near the start.
  explicit PoseForm(const Scene& scene);

  /// Place of a point of a body, given in its frame, in the world, m.
  PhasorTerms place(int body, Vec2 local) const;
  PhasorTerms place(PointRef p) const { return place(p.body, scene_.local(p)); }
  AngleForm angle(int body) const;

  /// Coordinates that the terms are in; those that follow from others are left out.
  const std::vector<int>& coordinates() const { return coordinates_; }
  const std::vector<PhasorTerms>& closures() const { return closures_; }
  /// Number of parallelograms that were found.
  int parallelograms() const { return parallelograms_; }
  bool is_length(int coordinate) const { return layout_.is_length(coordinate); }
  const std::string& name(int coordinate) const { return layout_.coordinates[coordinate].name; }
  double size() const { return layout_.size; }
  const Scene& scene() const { return scene_; }

  /// The value of terms where the coordinates of the layout are q, and its derivative by one of them.
  static Vec2 value(const PhasorTerms& terms, const std::vector<double>& q);
  static Vec2 derivative(const PhasorTerms& terms, int coordinate, const std::vector<double>& q);

  /// All coordinates of the layout: those of the assembled start, or of q with those that follow from others in their
  /// places and the loops closed; empty where they cannot be closed from there.
  const std::vector<double>& start() const { return start_; }
  std::vector<double> closed(std::vector<double> q) const;
  /// The travel of a slide or pin in a slot; -1 where it is none of the coordinates.
  int travel(int joint) const { return layout_.travel[joint]; }
  /// Names and values of all coordinates, by which other models of the scene find theirs.
  std::map<std::string, double> named(const std::vector<double>& q) const;

 private:
  struct Follows {
    int coordinate = -1;
    Vec2 factor{1.0, 0.0};  // exp(i angle) = factor exp(i angle of the coordinate)
    double constant = 0.0;
    bool follows = false;
  };

  PhasorTerms terms_of(const std::vector<Arm>& arms) const;
  PhasorTerms followed(const PhasorTerms& terms) const;
  void add(PhasorTerms& out, int length, int angle, Vec2 coefficient) const;
  void find_parallelograms();
  bool follow(int angle, int coordinate, Vec2 factor);
  void update();

  const Scene& scene_;
  Layout layout_;
  std::vector<double> start_;
  std::vector<Follows> follows_;  // per coordinate
  std::vector<PhasorTerms> closures_;
  std::vector<int> coordinates_;
  int parallelograms_ = 0;
};

}  // namespace poise
