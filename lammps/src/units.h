// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_UNITS_H
#define AMBERFIELD_UNITS_H

#include "lammps.h"

namespace amberfield {

// LAMMPS' units in those of the library, which are SI. In both systems a charge times a field is a force,
// and times are in seconds.
struct Units {
    double length;       // [m]
    double charge;       // [C]
    double field;        // [V/m]
    double potential;    // [V]
    double energy;       // [J]
    double pressure;     // [Pa]

    // Units of the run; others than si and cgs end it, on behalf of a fix.
    static Units of(LAMMPS_NS::LAMMPS *lmp, const char *fix);
};

}    // namespace amberfield

#endif
