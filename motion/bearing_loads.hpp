#pragma once

#include <vector>

#include "model/mechanism.hpp"
#include "model/meshing.hpp"
#include "model/phasor_sum.hpp"
#include "model/scene_numbers.hpp"

namespace poise {

/// The contact forces of teeth and rollers in the coordinates of a mechanism, for joints whose friction grows with
/// their force. An effort Q on the measure g of a coupling acts by a force Q F at a point of two bodies, and teeth push
/// their wheels apart by |Q| S (statics/bodies/contact_loads.hpp), in place of the generalized force Q Dg: as both do
/// the same work in every motion that joints allow, only the forces in joints differ.
///
/// Coordinates as those of ReducedMotion: generalized forces g are negative, n values. Compiled for double, long double
/// and Real50, and but for add_change() for the numbers of a VariedModel.
template <class T, class NumbersOfScene = SceneNumbers<T>>
class BearingLoads {
 public:
  struct Contact {
    int stop = 0;     ///< index into Scene::stops
    int holding = 0;  ///< its place among the stops that hold (Stop::holds())
    int joint = 0;    ///< the first of the joints given that it loads
    bool separates = false;
    ContactPlace place;
  };

  /// Takes the couplings that load one of these joints. Scene and mechanism must outlive this.
  BearingLoads(const Scene& scene, const Mechanism<T>& mechanism, const std::vector<int>& joints)
      : BearingLoads(NumbersOfScene(scene), mechanism, joints) {}
  /// With the numbers that the mechanism has been given.
  BearingLoads(const NumbersOfScene& numbers, const Mechanism<T>& mechanism, const std::vector<int>& joints);

  const std::vector<Contact>& contacts() const { return contacts_; }
  /// Poses of all bodies, for the others; `pose` are the phasors of q. Does not allocate.
  void place(const T* q, const Planar<T>* pose);
  /// g -= generalized force of  effort F + size S. False where no finite force transmits the effort: as cam_push().
  bool add(const Contact& contact, const T& effort, const T& size, const Planar<T>* pose, T* g) const;
  /// g -= its change along dq.
  void add_change(const Contact& contact, const T& effort, const T& size, const Planar<T>* pose, const T* dq,
                  T* g) const;

 private:
  struct Body {
    PhasorSum<T> origin;  // from the ground's
    int frame = -1;       // coordinate of its angle, -1 when fixed
    T turn{};             // its angle from that, or the whole
  };
  void act(int body, const Planar<T>& force, const Planar<T>& at, const Planar<T>* pose, T* g) const;

  NumbersOfScene numbers_;
  const Phasors<T>& phasors_;
  std::vector<Contact> contacts_;
  std::vector<Body> bodies_;
  std::vector<BodyPose<T>> poses_;
  mutable std::vector<Planar<T>> derivative_;  // of an origin
};

}  // namespace poise
