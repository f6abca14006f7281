// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_WALL_PLACE_H
#define AMBERFIELD_WALL_PLACE_H

#include "region.h"

namespace amberfield {

// Where a wall that moves is: the turn and the shift that bring a place of it from where it began to where
// it is.
//
// LAMMPS tells a region's velocities in a step, which are differences of its positions over the step: adding
// them up gives the positions.
class WallPlace {
  public:
    // Numbers in restart files
    static constexpr int SIZE = 12;

    // Goes along with a region in a step of the given length.
    void follow(const LAMMPS_NS::Region *region, double dt);

    void out(const double *home, double *place) const;
    void home(const double *place, double *home) const;
    void turn_out(const double *home, double *direction) const;
    void turn_home(const double *direction, double *home) const;

    double turn[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double shift[3] = {0, 0, 0};
};

}    // namespace amberfield

#endif
