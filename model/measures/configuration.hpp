#pragma once

#include "model/phasors.hpp"

namespace poise {

/// A configuration of a mechanism, as evaluated by Phasors::place(), with scratch memory.
template <class T>
struct Configuration {
  const Phasors<T>& phasors;
  const Planar<T>* pose;
  Planar<T>* scratch;  ///< scratch_size() entries of the measure

  const T& value(int coordinate) const { return phasors.value(pose, coordinate); }
};

// Members of a compiled measure g(q), by slots: indices into the sorted list support() of coordinates that change it.
//   value(at)                          g
//   gradient(at, use)                  use(slot, dg/dq) for every slot whose derivative may differ from zero
//   curvature(at, force, slope, add)   add(i, j, value) by slots i >= j, summed up:  force D2g + slope Dg Dg^T
//   second(at, u, v), third(at, u, v, w)   D2g[u, v], D3g[u, v, w] along directions of the coordinates
//   bend(at, u, use)                   use(slot, D2g[u, .])
//   scratch_size()
//   set_numbers(phasors)               takes what it is made of again from phasors whose numbers have been set

}  // namespace poise
