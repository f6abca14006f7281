// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#include "wall_place.h"

#include <algorithm>
#include <cmath>

using amberfield::WallPlace;

namespace {

// Rodrigues' turn of a vector by an angle about a unit axis.
void rotate(const double *axis, double angle, double *vector)
{
    const double cosine = std::cos(angle), sine = std::sin(angle);
    const double along = axis[0] * vector[0] + axis[1] * vector[1] + axis[2] * vector[2];
    const double across[3] = {axis[1] * vector[2] - axis[2] * vector[1],
                              axis[2] * vector[0] - axis[0] * vector[2],
                              axis[0] * vector[1] - axis[1] * vector[0]};
    for (int k = 0; k < 3; ++k) {
        vector[k] = cosine * vector[k] + sine * across[k] + (1.0 - cosine) * along * axis[k];
    }
}

}    // namespace

void WallPlace::follow(const LAMMPS_NS::Region *region, double dt)
{
    const double *omega = region->omega;
    const double speed = std::sqrt(omega[0] * omega[0] + omega[1] * omega[1] + omega[2] * omega[2]);
    if (region->rotateflag && speed > 0.0) {
        const double axis[3] = {omega[0] / speed, omega[1] / speed, omega[2] / speed};
        // The axis goes through a point that moves along with the region.
        double centre[3];
        for (int k = 0; k < 3; ++k) {
            centre[k] = region->rpoint[k] - (region->moveflag ? region->v[k] * dt : 0.0);
            shift[k] -= centre[k];
        }
        rotate(axis, speed * dt, shift);
        for (int k = 0; k < 3; ++k) shift[k] += centre[k];
        for (int column = 0; column < 3; ++column) {
            double unit[3] = {turn[0][column], turn[1][column], turn[2][column]};
            rotate(axis, speed * dt, unit);
            for (int k = 0; k < 3; ++k) turn[k][column] = unit[k];
        }
    }
    if (region->moveflag) {
        for (int k = 0; k < 3; ++k) shift[k] += region->v[k] * dt;
    }
}

void WallPlace::out(const double *home, double *place) const
{
    turn_out(home, place);
    for (int k = 0; k < 3; ++k) place[k] += shift[k];
}

void WallPlace::home(const double *place, double *home) const
{
    const double moved[3] = {place[0] - shift[0], place[1] - shift[1], place[2] - shift[2]};
    turn_home(moved, home);
}

void WallPlace::turn_out(const double *home, double *direction) const
{
    double turned[3];
    for (int k = 0; k < 3; ++k) {
        turned[k] = turn[k][0] * home[0] + turn[k][1] * home[1] + turn[k][2] * home[2];
    }
    std::copy_n(turned, 3, direction);
}

void WallPlace::turn_home(const double *direction, double *home) const
{
    double turned[3];
    for (int k = 0; k < 3; ++k) {
        turned[k] = turn[0][k] * direction[0] + turn[1][k] * direction[1] + turn[2][k] * direction[2];
    }
    std::copy_n(turned, 3, home);
}
