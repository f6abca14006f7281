// SPDX-License-Identifier: MIT
// Part of amberfield: the electric field of charged grains.

#ifndef AMBERFIELD_LOAD_CHECKS_H
#define AMBERFIELD_LOAD_CHECKS_H

#include "lammps.h"

namespace amberfield {

// Ends LAMMPS with a message where the plugin does not fit it: another MPI, another version or other widths
// of integers than it was compiled for, or a second copy of the library in the process.
void check_program(LAMMPS_NS::LAMMPS *lmp);

}    // namespace amberfield

#endif
